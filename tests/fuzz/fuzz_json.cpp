// Any bytes as our own description: an error in a sentence, or segments that build_skeleton takes.

#include <io/read_skeleton_json.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace skybark;
    const auto segments = io::parse_skeleton_json(
        std::string_view(reinterpret_cast<const char*>(data), size), "fuzz", 1, 20'000);
    if (!segments && segments.error().message.empty())
        std::abort();
    if (segments && !trees::build_skeleton(*segments))
        std::abort();
    return 0;
}
