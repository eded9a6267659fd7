#pragma once
// Built-in pictures of leaves: an outline, a stalk, a midrib and side veins, computed.

#include <skybark/core/when_used.hpp>
#include <skybark/shared/noise.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace skybark::trees {

enum class leaf_shape {
    ovate,      ///< an entire margin and a short tip: tupelo
    lanceolate, ///< long and pointed: willow
    round,      ///< as broad as long, blunt teeth, a long stalk: aspen
    lobed,      ///< seven pointed lobes: black oak
};

/// A picture for leaves: sRGB and coverage, 4 bytes a pixel. Row 0 is at the stalk and the last row
/// at the tip, as the mesh's v grows; u runs along the rows. Outside the leaf the colour goes on
/// and the coverage is 0.
struct leaf_picture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgba;

    /// The part of the blade's octagon (2 √2 / 4 of the square) that the leaf covers.
    [[nodiscard]] double cover() const {
        double sum = 0;
        for (std::size_t i = 3; i < rgba.size(); i += 4) {
            sum += rgba[i] >= 128 ? 1 : 0;
        }
        const double pixels = static_cast<double>(width) * height;
        return pixels > 0 ? sum / pixels / 0.70710678118654752 : 0;
    }
};

/// The picture with its rows the other way round: for one that stands on its stalk, as people look
/// at leaves and as image files mostly show them.
template <class = when_used>
[[nodiscard]] leaf_picture turned_over(const leaf_picture& picture) {
    leaf_picture turned = picture;
    const std::size_t row = std::size_t{4} * picture.width;
    for (std::size_t y = 0; y < picture.height; ++y) {
        const auto from = picture.rgba.begin() + static_cast<std::ptrdiff_t>(y * row);
        std::copy(from, from + static_cast<std::ptrdiff_t>(row),
                  turned.rgba.begin() +
                      static_cast<std::ptrdiff_t>((picture.height - 1 - y) * row));
    }
    return turned;
}

namespace detail {

/// What a leaf of a shape looks like. Lengths in units of the picture's side.
struct leaf_look {
    float stalk;                ///< its length
    float width;                ///< of one half
    float belly;                ///< below 1: widest near the stalk; above 1: near the tip
    float blunt;                ///< below 1: rounder ends
    float shear;                ///< how far margin and veins run up towards the side
    int veins;                  ///< on each side
    float lobes;                ///< how deep the bays between the veins are, 0…1
    float teeth;                ///< how deep the margin's teeth are
    std::array<float, 3> color; ///< sRGB 0…1
};

[[nodiscard]] inline const leaf_look& look_of(leaf_shape shape) {
    static const std::array<leaf_look, 4> looks{{
        {0.10f, 0.42f, 0.95f, 0.90f, 0.35f, 7, 0, 0, {0.31f, 0.41f, 0.20f}},
        {0.07f, 0.44f, 0.75f, 1.05f, 0.60f, 12, 0, 0, {0.39f, 0.46f, 0.29f}},
        {0.26f, 0.42f, 0.78f, 0.60f, 0.40f, 5, 0, 0.03f, {0.36f, 0.45f, 0.24f}},
        {0.14f, 0.40f, 1.00f, 0.50f, 0.60f, 4, 0.75f, 0.03f, {0.31f, 0.40f, 0.19f}},
    }};
    return looks[static_cast<std::size_t>(shape)];
}

/// Half the leaf's width a part `t` of the way from stalk to tip; lobes and teeth go by `slanted`.
[[nodiscard]] inline float half_width(const leaf_look& look, float t, float slanted) {
    constexpr float pi = 3.14159265f;
    if (t <= 0 || t >= 1) {
        return 0;
    }
    const float bulge = std::pow(std::sin(pi * std::pow(t, look.belly)), look.blunt);
    const float bay = 0.5f - 0.5f * std::cos(2 * pi * static_cast<float>(look.veins) * slanted);
    const float lobe = 1 - look.lobes * (1 - std::sqrt(bay));
    const float tooth = 1 - look.teeth * (0.5f + 0.5f * std::cos(2 * pi * 26 * slanted));
    return look.width * bulge * lobe * tooth;
}

struct leaf_sample {
    bool inside;
    float vein; ///< 0…1
};

/// The leaf at x (−½…½ across) and y (0…1 from stalk to tip).
[[nodiscard]] inline leaf_sample leaf_at(const leaf_look& look, float x, float y) {
    const float side = std::abs(x);
    const float t = (y - look.stalk) / (0.985f - look.stalk);
    const float slanted = t - look.shear * side * std::clamp(2 * t, 0.0f, 1.0f);
    const bool on_stalk = y < look.stalk + 0.06f && side < 0.014f;
    const bool in_blade = side < half_width(look, t, std::max(slanted, 0.0f));
    const float rib = 1 - side / (0.012f * (1.3f - t));
    // Half way between two bays, where a lobe is widest.
    const float vein_at = slanted * static_cast<float>(look.veins) + 0.5f;
    const float off = std::abs(vein_at - std::floor(vein_at));
    const float nearest = std::min(off, 1 - off) / static_cast<float>(look.veins);
    const float lateral = 0.7f * (1 - nearest / 0.006f);
    return {on_stalk || in_blade, std::clamp(std::max(rib, lateral), 0.0f, 1.0f)};
}

} // namespace detail

/// A picture of a leaf with `side` × `side` pixels (at least 1); 16 samples a pixel.
template <class = when_used>
[[nodiscard]] leaf_picture draw_leaf(leaf_shape shape, std::uint32_t side = 256) {
    const detail::leaf_look& look = detail::look_of(shape);
    const std::uint32_t n = std::max(side, 1u);
    leaf_picture picture{n, n, std::vector<std::uint8_t>(std::size_t{4} * n * n)};
    constexpr std::uint32_t grid = 4;
    const float step = 1.0f / static_cast<float>(n * grid);
    for (std::uint32_t row = 0; row < n; ++row) {
        for (std::uint32_t column = 0; column < n; ++column) {
            int inside = 0;
            float vein = 0;
            for (std::uint32_t s = 0; s < grid * grid; ++s) {
                const float x = (static_cast<float>(column * grid + s % grid) + 0.5f) * step;
                const float y = (static_cast<float>(row * grid + s / grid) + 0.5f) * step;
                const detail::leaf_sample sample = detail::leaf_at(look, x - 0.5f, y);
                inside += sample.inside ? 1 : 0;
                vein += sample.vein / (grid * grid);
            }
            const float u = static_cast<float>(column) / static_cast<float>(n);
            const float v = static_cast<float>(row) / static_cast<float>(n);
            const float mottle = 0.90f + 0.12f * shared::value_noise(u * 6, v * 6, 1, 6) +
                                 0.08f * shared::value_noise(u * 40, v * 40, 2, 40);
            std::uint8_t* to = &picture.rgba[(std::size_t{row} * n + column) * 4];
            for (std::size_t c = 0; c < 3; ++c) {
                const float pale = c == 2 ? 0.09f : 0.14f;
                const float value = look.color[c] * mottle + pale * vein;
                to[c] = static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f);
            }
            to[3] = static_cast<std::uint8_t>(inside * 255 / static_cast<int>(grid * grid));
        }
    }
    return picture;
}

} // namespace skybark::trees
