// EXR files where OpenEXR wasn't found.

#include <io/exr.hpp>
#include <io/text_input.hpp>

namespace skybark::io {

result<void> write_exr(const std::string& path, std::span<const glm::vec4>, std::uint32_t,
                       std::uint32_t) {
    return fail(error_code::bad_input,
                in_quotes(path) + " is an EXR file, and this program was built without OpenEXR; "
                                  "expected one that was built where libopenexr-dev is installed.");
}

bool has_exr() { return false; }

} // namespace skybark::io
