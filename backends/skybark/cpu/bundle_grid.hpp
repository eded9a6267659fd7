#pragma once
// The grid across a bundle of rays in which the CPU backend sorts samples and looks triangles up.
//
// Any grid gives the same hits: a place's cell grows with the place, so that a sample within a
// triangle's box lies in one of the cells from that of the box's low corner to that of its high
// one, however they were rounded. What lies beyond the grid counts to its outer cells.

#include <skybark/cpu/memory.hpp>
#include <skybark/kernels/bundle_hits.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace skybark::cpu::bundles {

/// A sample as a bundle sees it.
struct placed_sample {
    float x;
    float y;
    float z;
    std::uint32_t
        number; ///< where it is in its batch; the topmost bit: it looks against the bundle
};
inline constexpr std::uint32_t against = 0x80000000u;

[[nodiscard]] inline placed_sample place(const ray_bundle& bundle, const gather_sample& sample,
                                         std::uint32_t number) {
    const glm::vec3 at = shared::across_bundle(bundle, shared::ray_origin(bundle, sample));
    const float side = shared::side_of_bundle(bundle, sample.normal);
    return {at.x, at.y, at.z, number | (side < 0.0f ? against : 0u)};
}

inline constexpr std::uint32_t most_bands = 256;
inline constexpr std::uint32_t most_side = 4096;

/// Rows of cells; neighbouring rows are a band, which one task works on.
struct grid {
    float left = 0;   ///< m
    float bottom = 0; ///< m
    float scale = 1;  ///< cells in a metre
    std::uint32_t columns = 1;
    std::uint32_t rows = 1;
    std::uint32_t bands = 1;
    std::array<std::uint32_t, most_bands + 1> first_row{}; ///< of each band, and the end
    std::array<std::uint32_t, most_side> band_of_row{};

    [[nodiscard]] std::uint32_t column(float x) const { return cell((x - left) * scale, columns); }
    [[nodiscard]] std::uint32_t row(float y) const { return cell((y - bottom) * scale, rows); }
    [[nodiscard]] std::uint32_t rows_of(std::uint32_t band) const {
        return first_row[band + 1] - first_row[band];
    }
    [[nodiscard]] std::uint32_t most_rows() const {
        std::uint32_t most = 0;
        for (std::uint32_t band = 0; band < bands; ++band) {
            most = std::max(most, rows_of(band));
        }
        return most;
    }

    /// Negative places, and what is no number, are in the first cell.
    [[nodiscard]] static std::uint32_t cell(float place, std::uint32_t count) {
        const float most = static_cast<float>(count) - 0.5f;
        return place > 0.0f ? static_cast<std::uint32_t>(std::min(place, most)) : 0;
    }
};

/// How many bands samples get: so many samples a band that they stay in the caches of a core, and
/// so many bands that all cores have some.
inline constexpr std::size_t samples_a_band = 16384;
inline constexpr std::size_t least_of_band = 2048;
inline constexpr std::size_t wanted_bands = 32;

/// The fewer samples there are for each triangle, the more of them its cells should leave out. By
/// measurement; any number will do.
[[nodiscard]] inline float samples_a_cell(std::size_t samples, std::size_t triangles) {
    const float share = static_cast<float>(samples) / static_cast<float>(triangles + 1);
    return std::clamp(0.5f * std::pow(share, 0.2f), 0.25f, 4.0f);
}

/// A grid around samples that look for so many triangles: about as wide and high as they reach, and
/// with bands of about as many samples, as far as some of them tell.
[[nodiscard]] inline grid make_grid(const ray_bundle& bundle,
                                    std::span<const gather_sample> samples, std::size_t triangles) {
    constexpr std::size_t most_seen = 512;
    std::array<float, most_seen> heights;
    const std::size_t seen = std::min(most_seen, samples.size());
    std::size_t used = 0;
    float low_x = 0;
    float high_x = 0;
    // What is far from the scene meets nothing.
    const float horizon = 2.0f * bundle.centre.w;
    for (std::size_t i = 0; i < seen; ++i) {
        // One of each 512th, by chance: evenly picked ones of a lattice may all be of one column.
        const std::size_t first = samples.size() * i / seen;
        const std::size_t some = samples.size() * (i + 1) / seen - first;
        const std::size_t chance = (i * 0x9e3779b1u & 0xffffffffu) >> 8;
        const placed_sample at = place(bundle, samples[first + chance % some], 0);
        if (std::abs(at.x) <= horizon && std::abs(at.y) <= horizon) {
            low_x = used == 0 ? at.x : std::min(low_x, at.x);
            high_x = used == 0 ? at.x : std::max(high_x, at.x);
            heights[used++] = at.y;
        }
    }
    grid g;
    if (used == 0) {
        g.first_row[1] = 1;
        return g;
    }
    std::sort(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(used));
    const float width = high_x - low_x;
    const float height = heights[used - 1] - heights[0];
    const float cells = std::max(
        static_cast<float>(samples.size()) / samples_a_cell(samples.size(), triangles), 1.0f);
    // width · scale columns by height · scale rows.
    const float side = std::max({std::sqrt(width) * std::sqrt(height / cells),
                                 std::max(width, height) / static_cast<float>(most_side - 2),
                                 1e-6f * bundle.centre.w, 1e-30f});
    g.left = low_x;
    g.bottom = heights[0];
    g.scale = 1.0f / side;
    const auto count = [&](float reach) {
        return static_cast<std::uint32_t>(
            std::clamp(std::ceil(reach * g.scale), 1.0f, static_cast<float>(most_side)));
    };
    g.columns = count(width);
    g.rows = count(height);
    const std::size_t for_cache = samples.size() / samples_a_band;
    const std::size_t for_tasks = std::min(samples.size() / least_of_band, wanted_bands);
    const auto wanted = static_cast<std::uint32_t>(
        std::clamp<std::size_t>(std::max(for_cache, for_tasks), 1, most_bands));
    g.bands = 0;
    for (std::uint32_t b = 0; b < wanted; ++b) {
        const std::uint32_t first = b == 0 ? 0 : g.row(heights[used * b / wanted]);
        if (b == 0 || first > g.first_row[g.bands - 1]) {
            g.first_row[g.bands++] = first;
        }
    }
    g.first_row[g.bands] = g.rows;
    for (std::uint32_t b = 0; b < g.bands; ++b) {
        std::fill(g.band_of_row.begin() + g.first_row[b],
                  g.band_of_row.begin() + g.first_row[b + 1], b);
    }
    return g;
}

/// kernels::bundle_hits::is_hole. Never inlined: within functions for other instructions compilers
/// may fuse what they don't fuse in the kernel.
[[gnu::noinline]] inline bool is_hole(std::uint32_t number, float u, float v,
                                      std::span<const std::uint32_t> alpha) {
    return kernels::bundle_hits::is_hole(number, u, v, alpha);
}

/// Which bands a triangle may have samples in.
struct band_range {
    std::uint16_t first;
    std::uint16_t last;
};

/// One task's memory for the samples of a band, sorted by cell.
struct band_memory {
    std::uint32_t* cells;   ///< of samples as they come
    std::uint32_t* starts;  ///< where each cell begins, and one more
    float* places;          ///< x, y
    float* depths;          ///< z, and the distance of the nearest hit; its sign: where one looks
    std::uint32_t* nearest; ///< the triangle of that hit
    std::uint32_t* numbers; ///< of samples in the batch
};

} // namespace skybark::cpu::bundles
