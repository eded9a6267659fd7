#pragma once
// read_image, read_leaf, read_colours: the heights of a bark texture, a leaf, or any picture, from
// a file.

#include <skybark/core/result.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/leaf_texture.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace skybark::io {

/// Reads a PNG, JPEG or another format that stb_image knows. Grey values are heights, 0 to 1;
/// colours count by their luma; 16-bit values are kept. Rows run along the branch, the top one at
/// v = 0. Errors: unavailable where the file can't be opened; bad_input where it is no such
/// picture, ends early, has no pixels or a side of more than 16384.
[[nodiscard]] result<trees::bark_texture> read_image(const std::string& path);

/// Reads a leaf that stands on its stalk, as people look at leaves: sRGB, with what isn't leaf
/// transparent. Row 0 of the result is the picture's bottom one. Errors as above.
[[nodiscard]] result<trees::leaf_picture> read_leaf(const std::string& path);

/// A picture as it is in a file: RGBA, 8 bits a channel, rows from the top.
struct colour_picture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgba; ///< 4 · width · height
    bool has_alpha = false;         ///< otherwise alpha is 255
};

/// Reads any picture. Errors as above.
[[nodiscard]] result<colour_picture> read_colours(const std::string& path);

} // namespace skybark::io
