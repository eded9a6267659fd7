#pragma once
// picture_means: what the readers of scenes take from pictures: one colour, or where there are
// holes.

#include <io/read_image.hpp>
#include <io/triangle_scene.hpp>

namespace skybark::io {

/// The mean of an sRGB picture, linear, each pixel as much as its alpha; 1 where all is
/// transparent.
[[nodiscard]] glm::vec3 mean_colour(const colour_picture& picture);

/// Its alpha where it has one, else how bright it is. Rows turned over: OBJ's v counts from the
/// bottom, glTF's from the top.
[[nodiscard]] alpha_map alpha_of(const colour_picture& picture, bool turned_over);

} // namespace skybark::io
