#pragma once
// exr: pictures of floats as OpenEXR files.
//
// All of OpenEXR is behind these functions, in one translation unit (exr/openexr.cpp). Where the
// library wasn't there when this was built, each is an error that says so (exr/absent.cpp).

#include <skybark/core/result.hpp>

#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <string>

namespace skybark::io {

/// Writes width · height pixels, rows from the top, as 32-bit floats R, G, B and A, compressed
/// without loss (ZIP). Values are linear; what isn't finite is kept. All of the file is there or
/// none of it. Errors: `pixels` has another size; a side is 0 or more than 65536; the file can't be
/// written; memory.
[[nodiscard]] result<void> write_exr(const std::string& path, std::span<const glm::vec4> pixels,
                                     std::uint32_t width, std::uint32_t height);

/// Whether this program was built with OpenEXR.
[[nodiscard]] bool has_exr();

} // namespace skybark::io
