#pragma once
// Height maps of bark, built in or the caller's, and the normal maps that belong to them.

#include <skybark/core/when_used.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace skybark::trees {

/// Heights of 0 … 1 in rows: x goes around the branch and y along it, and both repeat. Texel
/// (x, y) is the height at ((x + ½) / width, (y + ½) / height) of a repeat.
struct bark_texture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<float> heights; ///< width · height
};

namespace detail {

/// A hash of a lattice point as 0 … 1.
[[nodiscard]] inline double lattice_noise(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
    std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ seed * 0xc2b2ae3du;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return (h ^ (h >> 15)) * (1.0 / 4294967296.0);
}

/// Smooth noise of 0 … 1 on a lattice of columns × rows points, which repeats; x and y in cells.
[[nodiscard]] inline double repeating_noise(double x, double y, std::uint32_t columns,
                                            std::uint32_t rows, std::uint32_t seed) {
    const double left = std::floor(x);
    const double low = std::floor(y);
    const auto wrap = [](double cell, std::uint32_t n) {
        return static_cast<std::uint32_t>(cell - n * std::floor(cell / n)) % n;
    };
    const std::uint32_t x0 = wrap(left, columns), x1 = (x0 + 1) % columns;
    const std::uint32_t y0 = wrap(low, rows), y1 = (y0 + 1) % rows;
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double tx = smooth(x - left);
    const double ty = smooth(y - low);
    const double bottom = lattice_noise(x0, y0, seed) * (1 - tx) + lattice_noise(x1, y0, seed) * tx;
    const double top = lattice_noise(x0, y1, seed) * (1 - tx) + lattice_noise(x1, y1, seed) * tx;
    return bottom * (1 - ty) + top * ty;
}

/// Octaves of it, each twice as fine and half as strong; 0 … 1. `u` and `v` are 0 … 1 of a repeat.
[[nodiscard]] inline double fractal_noise(double u, double v, std::uint32_t columns,
                                          std::uint32_t rows, int octaves, std::uint32_t seed) {
    double sum = 0;
    double weight = 0.5;
    double total = 0;
    for (int i = 0; i < octaves; ++i) {
        sum += weight * repeating_noise(u * columns, v * rows, columns, rows,
                                        seed + static_cast<std::uint32_t>(i));
        total += weight;
        weight /= 2;
        columns *= 2;
        rows *= 2;
    }
    return sum / total;
}

/// How far (x, y), in cells, is from the border between the cells of one random point each in a
/// lattice that repeats (Worley 1996: second nearest less nearest), and which cell it is in.
struct cell_place {
    double border;
    double shade; ///< the cell's own number of 0 … 1
};
[[nodiscard]] inline cell_place place_in_cells(double x, double y, std::uint32_t columns,
                                               std::uint32_t rows, std::uint32_t seed) {
    double nearest = 1e9;
    double second = 1e9;
    double shade = 0;
    const double left = std::floor(x);
    const double low = std::floor(y);
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const double cx = left + dx;
            const double cy = low + dy;
            const auto wx = static_cast<std::uint32_t>(cx - columns * std::floor(cx / columns));
            const auto wy = static_cast<std::uint32_t>(cy - rows * std::floor(cy / rows));
            const double px = cx + 0.1 + 0.8 * lattice_noise(wx, wy, seed) - x;
            const double py = cy + 0.1 + 0.8 * lattice_noise(wx, wy, seed + 1) - y;
            const double d = std::sqrt(px * px + py * py);
            if (d < nearest) {
                second = nearest;
                nearest = d;
                shade = lattice_noise(wx, wy, seed + 2);
            } else {
                second = std::min(second, d);
            }
        }
    }
    return {second - nearest, shade};
}

/// A texture from a function of u and v, 0 … 1 of a repeat each; heights are stretched to 0 … 1.
template <class Height>
[[nodiscard]] bark_texture texture_of(std::uint32_t width, std::uint32_t height, Height&& at) {
    bark_texture made{width, height, std::vector<float>(std::size_t{width} * height)};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            made.heights[std::size_t{y} * width + x] =
                static_cast<float>(at((x + 0.5) / width, (y + 0.5) / height));
        }
    }
    const auto [low, high] = std::minmax_element(made.heights.begin(), made.heights.end());
    if (low == made.heights.end() || !(*high > *low)) {
        return made;
    }
    const float base = *low;
    const float scale = 1 / (*high - *low);
    for (float& h : made.heights) {
        h = std::min((h - base) * scale, 1.0f);
    }
    return made;
}

[[nodiscard]] inline double smooth_step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

} // namespace detail

/// Bark of oaks and ashes: long plates with rough tops between deep furrows that join and part.
/// A repeat is about 0.5 m around and 0.7 m along.
template <class = when_used>
[[nodiscard]] bark_texture furrowed_bark(std::uint32_t seed, std::uint32_t width = 512,
                                         std::uint32_t height = 512) {
    return detail::texture_of(width, height, [seed](double u, double v) {
        constexpr std::uint32_t plates_around = 10;
        constexpr std::uint32_t plates_along = 4;
        const double bend = detail::fractal_noise(u, v, 4, 6, 3, seed) - 0.5;
        const double jitter = detail::fractal_noise(u, v, 24, 24, 3, seed + 10) - 0.5;
        const double x = u * plates_around + 1.5 * bend + 0.30 * jitter;
        const double y = v * plates_along + 0.5 * bend + 0.25 * jitter;
        const auto plate = detail::place_in_cells(x, y, plates_around, plates_along, seed + 20);
        const double furrow = detail::smooth_step(0.02, 0.42, plate.border);
        const double crack = detail::fractal_noise(u, v, 20, 48, 3, seed + 30);
        const double grain = detail::fractal_noise(u, v, 64, 16, 3, seed + 40);
        const double top = 0.72 + 0.12 * plate.shade + 0.16 * (crack - 0.5) + 0.18 * (grain - 0.5);
        return furrow * top + (1 - furrow) * 0.12 * grain;
    });
}

/// Bark of aspens and beeches: smooth, with low swells, short level lenticels that stand out, and
/// fine wrinkles around. A repeat is about 0.5 m around and 0.7 m along.
template <class = when_used>
[[nodiscard]] bark_texture smooth_bark(std::uint32_t seed, std::uint32_t width = 512,
                                       std::uint32_t height = 512) {
    return detail::texture_of(width, height, [seed](double u, double v) {
        const double swell = detail::fractal_noise(u, v, 4, 3, 3, seed);
        const double wrinkle = detail::fractal_noise(u, v, 6, 64, 3, seed + 10);
        // Lenticels: level lenses, one in every third cell of a lattice.
        constexpr std::uint32_t columns = 14;
        constexpr std::uint32_t rows = 40;
        double lens = 0;
        const double x = u * columns;
        const double y = v * rows;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const double cx = std::floor(x) + dx;
                const double cy = std::floor(y) + dy;
                const auto wx = static_cast<std::uint32_t>(cx - columns * std::floor(cx / columns));
                const auto wy = static_cast<std::uint32_t>(cy - rows * std::floor(cy / rows));
                if (detail::lattice_noise(wx, wy, seed + 20) > 0.3) {
                    continue;
                }
                const double px = cx + detail::lattice_noise(wx, wy, seed + 21) - x;
                const double py = cy + detail::lattice_noise(wx, wy, seed + 22) - y;
                const double wide = 0.25 + 0.35 * detail::lattice_noise(wx, wy, seed + 23);
                const double d = px * px / (wide * wide) + py * py / (0.35 * 0.35);
                lens = std::max(lens, 1 - d);
            }
        }
        return 0.45 * swell + 0.12 * wrinkle + 0.4 * std::max(lens, 0.0);
    });
}

/// The normal map of a texture whose repeat is so many metres around and along, and whose heights
/// stand for 0 … relief metres: RGBA8 rows of width · height texels like the heights'. Red, green
/// and blue are the normal in tangent space (x towards growing u, y towards growing v) from
/// [−1, 1]; alpha is the height. Slopes are central differences.
template <class = when_used>
[[nodiscard]] std::vector<std::uint8_t> normal_map(const bark_texture& of, float relief,
                                                   float metres_around, float metres_along) {
    std::vector<std::uint8_t> rows(std::size_t{4} * of.width * of.height);
    const auto height_of = [&](std::uint32_t x, std::uint32_t y) {
        return of.heights[std::size_t{y % of.height} * of.width + x % of.width];
    };
    const auto byte = [](float x) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0f, 1.0f)));
    };
    const float across = relief * static_cast<float>(of.width) / (2 * metres_around);
    const float up = relief * static_cast<float>(of.height) / (2 * metres_along);
    for (std::uint32_t y = 0; y < of.height; ++y) {
        for (std::uint32_t x = 0; x < of.width; ++x) {
            const float dx = across * (height_of(x + 1, y) - height_of(x + of.width - 1, y));
            const float dy = up * (height_of(x, y + 1) - height_of(x, y + of.height - 1));
            const float scale = 0.5f / std::sqrt(1 + dx * dx + dy * dy);
            std::uint8_t* texel = rows.data() + 4 * (std::size_t{y} * of.width + x);
            texel[0] = byte(0.5f - dx * scale);
            texel[1] = byte(0.5f - dy * scale);
            texel[2] = byte(0.5f + scale);
            texel[3] = byte(height_of(x, y));
        }
    }
    return rows;
}

} // namespace skybark::trees
