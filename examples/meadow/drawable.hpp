#pragma once
// What is drawn in a meadow: surfaces that have been made on the device, and what they look like.

#include <skybark/core/backend.hpp>

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace skybark::meadow {

/// How a surface is drawn.
enum class look {
    bark, ///< with a normal map, by kernels::meadow_bark
    leaf, ///< cut out of a picture, seen from both sides, by kernels::meadow_leaf
};

/// Bark, or leaves: with a picture of RGBA8 texels, 4 · width · height bytes. Without one bark is
/// flat, and a leaf is green and fills its blade.
struct material {
    look as = look::bark;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// Bark: trees::normal_map. Leaf: sRGB and coverage, the first row at the stalk.
    std::vector<std::uint8_t> texels;
    glm::vec3 low{0.055f, 0.042f, 0.032f}; ///< bark: albedo in the furrows
    glm::vec3 high{0.31f, 0.255f, 0.205f}; ///< bark: albedo on the ridges
    float around = 2;                      ///< bark: repeats, once around a branch
    float along = 1.4f;                    ///< bark: repeats a metre
    float through = 0.8f; ///< leaf: light that comes through over what is scattered back
};

/// Something to draw: vertices that have been made, and which of them.
template <backend B>
struct drawable {
    buffer_view<B> vertices; ///< surface_vertex
    draw_geometry<B> geometry;
    look as = look::bark;       ///< as its material has it
    std::uint32_t material = 0; ///< its number in the list that the painter was given
    bool casts = true;          ///< a shadow, in the sun
};

} // namespace skybark::meadow
