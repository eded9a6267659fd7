#pragma once
// read_image, read_leaf: the heights of a bark texture, or a leaf, from a picture file.

#include <skybark/core/result.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/leaf_texture.hpp>

#include <string>

namespace skybark::io {

/// Reads a PNG, JPEG or another format that stb_image knows. Grey values are heights, 0 to 1;
/// colours count by their luma; 16-bit values are kept. Rows run along the branch, the top one at
/// v = 0. Errors: unavailable where the file can't be opened; bad_input where it is no such
/// picture, ends early, has no pixels or a side of more than 16384.
[[nodiscard]] result<trees::bark_texture> read_image(const std::string& path);

/// Reads a leaf that stands on its stalk, as people look at leaves: sRGB, with what isn't leaf
/// transparent. Row 0 of the result is the picture's bottom one. Errors as above.
[[nodiscard]] result<trees::leaf_picture> read_leaf(const std::string& path);

} // namespace skybark::io
