#pragma once
// write_png: a picture as a PNG file.

#include <skybark/core/result.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace skybark::io {

/// Writes width · height pixels of four bytes (red, green, blue, alpha; sRGB, not premultiplied),
/// rows from the top. Errors: `pixels` has another size, a side is 0 or more than 16384, the file
/// can't be written.
[[nodiscard]] result<void> write_png(const std::string& path, std::span<const std::uint8_t> pixels,
                                     std::uint32_t width, std::uint32_t height);

/// The bytes of that file, for what holds a PNG inside. `name` is for the sentences.
[[nodiscard]] result<std::string> encode_png(const std::string& name,
                                             std::span<const std::uint8_t> pixels,
                                             std::uint32_t width, std::uint32_t height);

} // namespace skybark::io
