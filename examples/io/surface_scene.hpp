#pragma once
// What the writers of meshes are given: surfaces, what they look like, and what carries them.

#include <skybark/core/records.hpp>

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>

namespace skybark::io {

/// Somebody else's picture: RGBA, 8 bits a channel, rows from the top.
struct image_view {
    std::uint32_t width = 0; ///< 0: no picture
    std::uint32_t height = 0;
    std::span<const std::uint8_t> rgba; ///< 4 · width · height

    [[nodiscard]] bool empty() const noexcept { return width == 0 || height == 0; }
};

/// How a surface looks, in glTF's metallic-roughness terms. Nothing here is a metal.
struct surface_material {
    std::string name = "bark";
    glm::vec4 base_color{0.32f, 0.24f, 0.17f, 1}; ///< linear; a factor where there is a texture
    float roughness = 0.9f;
    image_view base_texture;   ///< sRGB; alpha is coverage
    image_view normal_texture; ///< linear, green along growing v
    glm::vec2 repeats{1};      ///< of the textures for each unit of u and of v
    bool masked = false;       ///< what is less opaque than `cutoff` isn't there
    float cutoff = 0.5f;       ///< of alpha
    bool double_sided = false;
};

/// The two segments that move a vertex: `first` with a weight of 1 − share, `second` with `share`.
struct vertex_carrier {
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    float share = 0; ///< 0 … 1
};

/// One surface of one material.
struct surface_mesh {
    std::string name = "branches";
    std::span<const surface_vertex> vertices;
    std::span<const std::uint32_t> indices; ///< three a triangle, counter-clockwise from outside
    std::uint32_t material = 0;             ///< index into the materials
    /// What moves each vertex in an animation; empty: nothing does.
    std::span<const vertex_carrier> carriers;
    /// Vertices with the same number lie at the same place, where they differ in their normals or
    /// texture coordinates alone; numbers are below that of the vertices. Empty: each has its own.
    std::span<const std::uint32_t> places;
};

} // namespace skybark::io
