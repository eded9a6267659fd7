#pragma once
// Peeling on the CPU: the next layer of depths, at pixel centres.
//
// Corners are made once a call and rounded to 1/256 of a pixel; edge functions of such corners are
// exact in double precision, so that a pixel on a shared edge belongs to one of its triangles.
// Triangles are sorted by the bands of rows that they reach, and each band draws its own, in order:
// of fragments of the same depth the lowest triangle's stays, whatever the number of threads.

#include <skybark/core/backend.hpp>
#include <skybark/cpu/memory.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace skybark::cpu {

/// Memory that peels use again.
struct peel_scratch {
    const detail::memory_source* source = nullptr;
    detail::scratch_memory triangles{source};
    detail::scratch_memory counts{source};
    detail::scratch_memory entries{source};
    detail::scratch_memory depths{source};
};

namespace peeling {

inline constexpr std::uint32_t band_rows = 16;
inline constexpr std::uint32_t batch_triangles = 1u << 17;
inline constexpr std::uint32_t most_pieces = 16;
inline constexpr std::uint32_t least_of_piece = 1024;
inline constexpr double subpixels = 256;
inline constexpr std::uint32_t ahead = 8; ///< triangles that are asked for before they are drawn

/// A triangle in pixels, counter-clockwise.
struct flat_triangle {
    std::array<float, 3> x;
    std::array<float, 3> y;
    std::array<float, 3> z;
    std::uint32_t number;
};

struct raster_size {
    std::uint32_t width;
    std::uint32_t height;
};

/// The pixels first … last whose centres may lie between two places; none where last < first.
struct pixel_range {
    std::int32_t first;
    std::int32_t last;

    [[nodiscard]] static pixel_range between(double low, double high, std::uint32_t count) {
        const double most = static_cast<double>(count);
        return {-floor_of(-std::clamp(low - 0.5, 0.0, most)),
                floor_of(std::clamp(high - 0.5, -1.0, most - 1.0))};
    }

    /// std::floor calls a library where the machine's own instruction may not be used.
    [[nodiscard]] static std::int32_t floor_of(double place) {
        const auto whole = static_cast<std::int32_t>(place);
        return whole - (static_cast<double>(whole) > place ? 1 : 0);
    }
};

[[nodiscard]] inline pixel_range rows_of(const flat_triangle& t, raster_size size) {
    return pixel_range::between(std::min({t.y[0], t.y[1], t.y[2]}),
                                std::max({t.y[0], t.y[1], t.y[2]}), size.height);
}
[[nodiscard]] inline pixel_range columns_of(const flat_triangle& t, raster_size size) {
    return pixel_range::between(std::min({t.x[0], t.x[1], t.x[2]}),
                                std::max({t.x[0], t.x[1], t.x[2]}), size.width);
}

/// Places a triangle; false where it covers no pixel centre for sure, or a corner is no number.
template <class K, class... Spans>
[[nodiscard]] bool place(const K& kernel, std::uint32_t number, raster_size size, flat_triangle& t,
                         Spans... spans) {
    // Exact in a float as far as 2^16 pixels.
    const auto pixels = [](float clip, std::uint32_t side) {
        const double at = (0.5 * static_cast<double>(clip) + 0.5) * static_cast<double>(side);
        return static_cast<float>(std::floor(at * subpixels + 0.5) / subpixels);
    };
    bool finite = true;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const glm::vec4 p = kernel.corner(3 * number + k, spans...);
        t.x[k] = pixels(p.x, size.width);
        t.y[k] = pixels(p.y, size.height);
        t.z[k] = p.z;
        finite = finite && std::isfinite(t.x[k]) && std::isfinite(t.y[k]) && std::isfinite(p.z);
    }
    t.number = number;
    if (!finite) {
        return false;
    }
    const pixel_range rows = rows_of(t, size);
    const pixel_range columns = columns_of(t, size);
    return rows.first <= rows.last && columns.first <= columns.last &&
           std::max({t.z[0], t.z[1], t.z[2]}) > 0.0f && std::min({t.z[0], t.z[1], t.z[2]}) <= 1.0f;
}

/// One edge: inside is where value + step_x · column + step_y · row is above zero, or zero and the
/// edge is a top or left one.
struct edge {
    double value;
    double step_x;
    double step_y;
    double inverse; ///< −1 / step_x
    bool owns;      ///< what lies on it

    [[nodiscard]] static edge between(double x0, double y0, double x1, double y1) {
        const double dx = x1 - x0;
        const double dy = y1 - y0;
        return {dx * (0.5 - y0) - dy * (0.5 - x0), -dy, dx, dy == 0 ? 0 : 1 / dy,
                dy < 0 || (dy == 0 && dx < 0)};
    }

    /// Whether a column is inside, in a row whose value this is.
    [[nodiscard]] bool inside(double here, std::int32_t column) const {
        const double at = here + step_x * column;
        return at > 0 || (at == 0 && owns);
    }

    /// Keeps the columns of a row that are inside.
    void clip(std::int32_t row, std::int32_t& first, std::int32_t& last) const {
        constexpr double beyond = 1 << 20; // all pictures
        const double here = value + step_y * row;
        if (step_x == 0) {
            last = inside(here, 0) ? last : first - 1;
            return;
        }
        const double crossing = std::clamp(here * inverse, -2.0, beyond);
        std::int32_t column = pixel_range::floor_of(crossing);
        const double part = crossing - column;
        // Near a whole column rounding may have put the crossing on its other side.
        if (part < 1e-6 || part > 1 - 1e-6) {
            column += part > 0.5 ? 1 : 0;
            column -= inside(here, column) == (step_x > 0) ? 1 : 0;
        }
        if (step_x > 0) {
            first = std::max(first, column + 1);
        } else {
            last = std::min(last, column);
        }
    }
};

/// What a row of a raster holds: depths of the last layer and of this, and whose those are.
struct raster_rows {
    const float* before;
    float* depth;
    std::uint32_t* triangle;
};

/// How a triangle's depth runs over the raster.
struct depth_plane {
    double middle; ///< at the first pixel's centre
    double slope_x;
    double slope_y;
    float least; ///< slivers have slopes that rounding drives beyond their corners
    float most;

    [[nodiscard]] float at(std::int32_t column, std::int32_t row) const {
        return static_cast<float>(middle + slope_x * column + slope_y * row);
    }
};

/// Up to this many rows and columns, edge functions in 1/256 of a pixel are below 2^30.
inline constexpr std::int32_t small_side = 56;
inline constexpr std::int32_t some_columns = 8;

/// Draws a small triangle into rows first … last, some columns at a time: all of them are looked
/// at, so that compilers make vectors of them. `x`, `y`: corners in pixels; columns: of its box.
inline void draw_small(const std::array<double, 3>& x, const std::array<double, 3>& y,
                       const depth_plane& plane, std::uint32_t number, raster_size size,
                       pixel_range columns, std::int32_t first, std::int32_t last,
                       const raster_rows& to) {
    const std::int32_t start =
        std::min(columns.first, static_cast<std::int32_t>(size.width) - some_columns);
    std::array<std::int32_t, 3> across;
    std::array<std::int32_t, 3> down;
    for (std::size_t k = 0; k < 3; ++k) {
        across[k] = static_cast<std::int32_t>((x[k] - start - 0.5) * subpixels);
        down[k] = static_cast<std::int32_t>((y[k] - first - 0.5) * subpixels);
    }
    std::array<std::int32_t, 3> value;
    std::array<std::int32_t, 3> step_x;
    std::array<std::int32_t, 3> step_y;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t from = (k + 1) % 3;
        const std::size_t until = (k + 2) % 3;
        const std::int32_t dx = across[until] - across[from];
        const std::int32_t dy = down[until] - down[from];
        const bool owns = dy < 0 || (dy == 0 && dx < 0);
        value[k] = dy * across[from] - dx * down[from] - (owns ? 0 : 1);
        step_x[k] = -dy * static_cast<std::int32_t>(subpixels);
        step_y[k] = dx * static_cast<std::int32_t>(subpixels);
    }
    std::array<std::int32_t, some_columns> edge_0;
    std::array<std::int32_t, some_columns> edge_1;
    std::array<std::int32_t, some_columns> edge_2;
    std::array<float, some_columns> slope;
    for (std::int32_t i = 0; i < some_columns; ++i) {
        const auto n = static_cast<std::size_t>(i);
        edge_0[n] = step_x[0] * i;
        edge_1[n] = step_x[1] * i;
        edge_2[n] = step_x[2] * i;
        slope[n] = static_cast<float>(plane.slope_x) * static_cast<float>(i);
    }
    for (std::int32_t row = first; row <= last; ++row) {
        for (std::int32_t c = start; c <= columns.last; c += some_columns) {
            // Columns that come up again at the end of a row, rather than those of the next, don't
            // count: seen from elsewhere, their depths are rounded otherwise.
            const std::int32_t column =
                std::min(c, static_cast<std::int32_t>(size.width) - some_columns);
            const std::int32_t done = c - column;
            std::array<std::int32_t, 3> here;
            for (std::size_t k = 0; k < 3; ++k) {
                here[k] = value[k] + step_x[k] * (column - start) + step_y[k] * (row - first);
            }
            const float middle = plane.at(column, row);
            const std::size_t at =
                static_cast<std::size_t>(row) * size.width + static_cast<std::size_t>(column);
            const float* const before = to.before + at;
            float* const depth = to.depth + at;
            std::uint32_t* const triangle = to.triangle + at;
            for (std::size_t i = 0; i < some_columns; ++i) {
                const std::int32_t outside = (here[0] + edge_0[i]) | (here[1] + edge_1[i]) |
                                             (here[2] + edge_2[i]) |
                                             (static_cast<std::int32_t>(i) - done);
                const float d = std::min(std::max(middle + slope[i], plane.least), plane.most);
                const bool takes = (outside >= 0) & (d < before[i]) & (d > depth[i]) & (d <= 1.0f);
                depth[i] = takes ? d : depth[i];
                triangle[i] = takes ? number : triangle[i];
            }
        }
    }
}

/// Draws a triangle into rows first … last.
inline void draw(const flat_triangle& t, raster_size size, std::int32_t first, std::int32_t last,
                 const raster_rows& to) {
    std::array<double, 3> x{t.x[0], t.x[1], t.x[2]};
    std::array<double, 3> y{t.y[0], t.y[1], t.y[2]};
    std::array<double, 3> z{t.z[0], t.z[1], t.z[2]};
    double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (area == 0) {
        return;
    }
    if (area < 0) {
        std::swap(x[1], x[2]);
        std::swap(y[1], y[2]);
        std::swap(z[1], z[2]);
        area = -area;
    }
    depth_plane plane;
    plane.slope_x = ((z[1] - z[0]) * (y[2] - y[0]) - (z[2] - z[0]) * (y[1] - y[0])) / area;
    plane.slope_y = ((z[2] - z[0]) * (x[1] - x[0]) - (z[1] - z[0]) * (x[2] - x[0])) / area;
    plane.middle = z[0] + plane.slope_x * (0.5 - x[0]) + plane.slope_y * (0.5 - y[0]);
    plane.least = std::min({t.z[0], t.z[1], t.z[2]});
    plane.most = std::max({t.z[0], t.z[1], t.z[2]});
    const pixel_range columns = columns_of(t, size);
    const auto [lowest, highest] = std::minmax({y[0], y[1], y[2]});
    const auto [leftmost, rightmost] = std::minmax({x[0], x[1], x[2]});
    if (size.width >= some_columns &&
        std::max(highest - lowest, rightmost - leftmost) < small_side) {
        draw_small(x, y, plane, t.number, size, columns, first, last, to);
        return;
    }
    const std::array<edge, 3> edges{edge::between(x[1], y[1], x[2], y[2]),
                                    edge::between(x[2], y[2], x[0], y[0]),
                                    edge::between(x[0], y[0], x[1], y[1])};
    for (std::int32_t row = first; row <= last; ++row) {
        std::int32_t left = columns.first;
        std::int32_t right = columns.last;
        for (const edge& e : edges) {
            e.clip(row, left, right);
        }
        const std::int32_t count = right - left + 1;
        if (count <= 0) {
            continue;
        }
        const float start = plane.at(left, row);
        const auto slope = static_cast<float>(plane.slope_x);
        const std::size_t at =
            static_cast<std::size_t>(row) * size.width + static_cast<std::size_t>(left);
        const float* const before = to.before + at;
        float* const depth = to.depth + at;
        std::uint32_t* const triangle = to.triangle + at;
        for (std::int32_t i = 0; i < count; ++i) {
            const float here = start + slope * static_cast<float>(i);
            const float d = std::min(std::max(here, plane.least), plane.most);
            const bool takes = d < before[i] && d > depth[i] && d <= 1.0f;
            depth[i] = takes ? d : depth[i];
            triangle[i] = takes ? t.number : triangle[i];
        }
    }
}

/// Triangles of a batch by the bands that they reach.
struct band_lists {
    const flat_triangle* triangles = nullptr;
    const std::uint32_t* entries = nullptr; ///< into the triangles
    const std::uint32_t* ends = nullptr;    ///< of each band's entries
};

/// Places triangles and sorts them by bands. False where there is no memory.
template <class Device, class K, class... Spans>
[[nodiscard]] bool sort_by_bands(Device& device, peel_scratch& scratch, const K& kernel,
                                 range numbers, raster_size size, band_lists& lists,
                                 Spans... spans) {
    const std::uint32_t bands = (size.height + band_rows - 1) / band_rows;
    const std::uint32_t pieces =
        std::clamp(numbers.count / least_of_piece, std::uint32_t{1}, most_pieces);
    const auto start = [&](std::uint32_t piece) {
        return static_cast<std::uint32_t>(std::uint64_t{numbers.count} * piece / pieces);
    };
    auto* const triangles = scratch.triangles.room_for<flat_triangle>(numbers.count);
    auto* const counts =
        scratch.counts.room_for<std::uint32_t>(std::uint64_t{pieces} * (bands + 1));
    if (triangles == nullptr || counts == nullptr) {
        return false;
    }
    std::uint32_t* const kept = counts + std::size_t{pieces} * bands;
    const auto for_bands = [&](const flat_triangle& t, auto&& each) {
        const pixel_range rows = rows_of(t, size);
        const std::uint32_t last = static_cast<std::uint32_t>(rows.last) / band_rows;
        for (std::uint32_t b = static_cast<std::uint32_t>(rows.first) / band_rows; b <= last; ++b) {
            each(b);
        }
    };
    device.parallel(pieces, [&](std::uint32_t piece) {
        std::uint32_t* const count = counts + std::size_t{piece} * bands;
        std::fill_n(count, bands, 0u);
        std::uint32_t end = start(piece);
        for (std::uint32_t i = start(piece); i < start(piece + 1); ++i) {
            if (place(kernel, numbers.first + i, size, triangles[end], spans...)) {
                for_bands(triangles[end], [&](std::uint32_t band) { ++count[band]; });
                ++end;
            }
        }
        kept[piece] = end;
    });
    std::uint32_t sum = 0;
    for (std::uint32_t band = 0; band < bands; ++band) {
        for (std::uint32_t piece = 0; piece < pieces; ++piece) {
            std::uint32_t& at = counts[std::size_t{piece} * bands + band];
            const std::uint32_t here = at;
            at = sum;
            sum += here;
        }
    }
    auto* const entries = scratch.entries.room_for<std::uint32_t>(sum);
    if (entries == nullptr) {
        return false;
    }
    device.parallel(pieces, [&](std::uint32_t piece) {
        std::uint32_t* const at = counts + std::size_t{piece} * bands;
        for (std::uint32_t i = start(piece); i < kept[piece]; ++i) {
            for_bands(triangles[i], [&](std::uint32_t band) { entries[at[band]++] = i; });
        }
    });
    // The last piece's places have moved on to where the bands end.
    lists = {triangles, entries, counts + std::size_t{pieces - 1} * bands};
    return true;
}

} // namespace peeling

/// Peels one layer: see the contract in skybark/core/backend.hpp. False where there is no memory.
template <class Device, peel_kernel K, class... Spans>
[[nodiscard]] bool peel_layer(Device& device, peel_scratch& scratch, const K& kernel,
                              range triangles, const peeled_layer<Device>& layer, Spans... spans) {
    using namespace peeling;
    const raster_size size{layer.width, layer.height};
    const std::uint64_t pixels = std::uint64_t{size.width} * size.height;
    const std::uint32_t bands = (size.height + band_rows - 1) / band_rows;
    auto* const depths = scratch.depths.room_for<float>(pixels + bands);
    if (depths == nullptr) {
        return false;
    }
    const auto before = records_of<Device, std::span<float>>(layer.depth);
    const auto numbers = records_of<Device, std::span<std::uint32_t>>(layer.triangle);
    const auto start = [&](std::uint32_t band) {
        return std::min<std::uint64_t>(std::uint64_t{band} * band_rows * size.width, pixels);
    };
    device.parallel(bands, [&](std::uint32_t band) {
        std::fill(depths + start(band), depths + start(band + 1), 0.0f);
        std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(start(band)),
                  numbers.begin() + static_cast<std::ptrdiff_t>(start(band + 1)), 0xffffffffu);
    });
    const raster_rows rows{before.data(), depths, numbers.data()};
    for (std::uint32_t done = 0; done < triangles.count;) {
        const std::uint32_t count = std::min(batch_triangles, triangles.count - done);
        band_lists lists;
        if (!sort_by_bands(device, scratch, kernel, range{triangles.first + done, count}, size,
                           lists, spans...)) {
            return false;
        }
        device.parallel(bands, [&](std::uint32_t band) {
            const auto first = static_cast<std::int32_t>(band * band_rows);
            const auto last = static_cast<std::int32_t>(band * band_rows + band_rows - 1);
            const std::uint32_t end = lists.ends[band];
            for (std::uint32_t e = band == 0 ? 0 : lists.ends[band - 1]; e < end; ++e) {
                detail::fetch(&lists.triangles[lists.entries[std::min(e + ahead, end - 1)]]);
                const flat_triangle& t = lists.triangles[lists.entries[e]];
                const pixel_range its = rows_of(t, size);
                draw(t, size, std::max(its.first, first), std::min(its.last, last), rows);
            }
        });
        done += count;
    }
    // How many fragments a band has goes behind the depths, as the bits of a word.
    device.parallel(bands, [&](std::uint32_t band) {
        std::uint32_t fragments = 0;
        for (std::uint64_t i = start(band); i < start(band + 1); ++i) {
            before[i] = depths[i];
            fragments += depths[i] > 0.0f ? 1 : 0;
        }
        std::memcpy(depths + pixels + band, &fragments, sizeof fragments);
    });
    count_record record;
    for (std::uint32_t band = 0; band < bands; ++band) {
        std::uint32_t fragments = 0;
        std::memcpy(&fragments, depths + pixels + band, sizeof fragments);
        record.written += fragments;
    }
    record.required = record.written;
    std::memcpy(layer.count.buffer->data() + layer.count.offset, &record, sizeof record);
    return true;
}

} // namespace skybark::cpu
