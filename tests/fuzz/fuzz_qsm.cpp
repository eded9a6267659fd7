// Any bytes as a QSM: an error in a sentence, or segments that build_skeleton takes.

#include <io/read_qsm.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace skybark;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto where = size % 2 == 0 ? io::placement::as_given : io::placement::settled;
    const auto segments = io::parse_qsm(text, "fuzz", where);
    if (!segments && segments.error().message.empty())
        std::abort();
    if (segments && !trees::build_skeleton(*segments))
        std::abort();
    return 0;
}
