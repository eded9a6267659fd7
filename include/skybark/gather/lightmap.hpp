#pragma once
// lightmap: a square texture in which every triangle has texels of its own, and the points that ask
// for their light.
//
// Each triangle is a chart: laid flat as it is, its longest edge along the rows, so that a metre is
// as many texels everywhere and areas keep their proportions. Charts stand on shelves, sorted by
// height (Coffman, Garey, Johnson, Tarjan 1980, "next fit decreasing height"), upright or turned by
// 180°, each as far to the left as its texels allow: a triangle and its turned neighbour share
// their rectangle. A chart owns every texel that bilinear lookup reads anywhere on its triangle, so
// no light bleeds from one into another and there needn't be a gutter beside.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>
#include <skybark/core/when_used.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace skybark::gather {

struct lightmap_options {
    std::uint32_t size = 1024; ///< texels a side
    /// How many texels a metre of surface has; 0: as many as fit.
    float texels_per_metre = 0;
    /// More samples than these are refused before any memory is taken for them.
    std::uint64_t most_samples = std::uint64_t{1} << 28;
};

/// Where the light of triangles is kept, and where it is asked for.
struct lightmap {
    std::uint32_t size = 0; ///< texels a side; texel (x, y) is number y · size + x
    float texels_per_metre = 0;
    /// Three a triangle: texture coordinates of its corners, 0…1 edge to edge of the map, to be
    /// looked up with bilinear filtering. All 0 for a triangle without area, which has no chart.
    std::vector<glm::vec2> corners;
    /// One a texel whose centre lies on a triangle; at least one a chart, on its triangle. Normals
    /// are those of the triangles' fronts.
    std::vector<gather_sample> samples;
    std::vector<std::uint32_t> texels;    ///< of each sample
    std::vector<std::uint32_t> triangles; ///< of each sample
    /// Pairs {texel, from}: texels at the seams that lookup reads too, and a texel of the same
    /// chart that is nearest and has a sample.
    std::vector<glm::uvec2> seams;
};

namespace detail {

/// A triangle laid flat: corner 0 … 2 in texels, in the order of its own corners; the first row and
/// column that it owns are 0.
struct flat_chart {
    std::array<glm::dvec2, 3> corners{};
};

/// Which texels of a row a chart owns: first … last, both in.
struct texel_row {
    std::int32_t first = 0;
    std::int32_t last = -1;
};

/// Edge lengths and height of a triangle, in metres.
struct triangle_shape {
    std::uint32_t longest = 0; ///< the edge from this corner to the next is the longest
    double width = 0;          ///< of that edge
    double height = 0;         ///< over it
    double foot = 0;           ///< where the height meets it, from its first corner
};

[[nodiscard]] inline triangle_shape shape_of(const gather_triangle& t) {
    const glm::dvec3 p[3] = {glm::dvec3(t.a), glm::dvec3(t.b), glm::dvec3(t.c)};
    triangle_shape shape;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const double edge = glm::distance(p[i], p[(i + 1) % 3]);
        if (edge > shape.width) {
            shape.width = edge;
            shape.longest = i;
        }
    }
    if (shape.width > 0) {
        const glm::dvec3 base = p[shape.longest];
        const glm::dvec3 along = (p[(shape.longest + 1) % 3] - base) / shape.width;
        const glm::dvec3 side = p[(shape.longest + 2) % 3] - base;
        shape.foot = std::clamp(glm::dot(side, along), 0.0, shape.width);
        shape.height = glm::length(glm::cross(along, side));
    }
    return shape;
}

/// A texel is read where its centre is less than one texel away; texture coordinates are rounded to
/// floats, which a little more makes good.
inline constexpr double lookup_reach = 1.005;
/// Then this is the least coordinate at which nothing before texel 0 is read.
inline constexpr double chart_margin = 0.51;

/// Lays a triangle flat.
[[nodiscard]] inline flat_chart lay_flat(const triangle_shape& shape, double scale, bool turned) {
    const double width = shape.width * scale;
    const double height = shape.height * scale;
    const double foot = shape.foot * scale;
    std::array<glm::dvec2, 3> p{glm::dvec2(0, 0), glm::dvec2(width, 0), glm::dvec2(foot, height)};
    flat_chart chart;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const glm::dvec2 q = turned ? glm::dvec2(width, height) - p[i] : p[i];
        chart.corners[(shape.longest + i) % 3] = q + chart_margin;
    }
    return chart;
}

/// The rows of texels that bilinear lookup reads on the chart; row 0 first.
template <class = when_used>
void rows_of(const flat_chart& chart, std::vector<texel_row>& rows) {
    double top = 0;
    for (const glm::dvec2& p : chart.corners) {
        top = std::max(top, p.y);
    }
    constexpr double reach = lookup_reach;
    const auto last_row = static_cast<std::int32_t>(std::floor(top - 0.5 + reach));
    rows.assign(static_cast<std::size_t>(last_row) + 1, texel_row{});
    for (std::int32_t row = 0; row <= last_row; ++row) {
        const double low = row + 0.5 - reach;
        const double high = row + 0.5 + reach;
        double left = 1e300;
        double right = -1e300;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 a = chart.corners[i];
            const glm::dvec2 b = chart.corners[(i + 1) % 3];
            const double from = std::clamp(std::min(a.y, b.y), low, high);
            const double to = std::clamp(std::max(a.y, b.y), low, high);
            if (std::max(a.y, b.y) < low || std::min(a.y, b.y) > high) {
                continue;
            }
            for (const double y : {from, to}) {
                const double part = b.y != a.y ? (y - a.y) / (b.y - a.y) : 0;
                const double x = a.x + (b.x - a.x) * part;
                left = std::min(left, x);
                right = std::max(right, x);
            }
            if (b.y == a.y) {
                left = std::min(left, b.x);
                right = std::max(right, b.x);
            }
        }
        if (left <= right) {
            auto& r = rows[static_cast<std::size_t>(row)];
            r.first = std::max(0, static_cast<std::int32_t>(std::ceil(left - 0.5 - reach)));
            r.last = static_cast<std::int32_t>(std::floor(right - 0.5 + reach));
        }
    }
}

/// Where a chart came to lie.
struct placed_chart {
    glm::uvec2 origin{0}; ///< of its first row and column
    bool turned = false;
};

/// Charts on shelves.
template <class = when_used>
class chart_packer {
  public:
    chart_packer(const std::vector<triangle_shape>& shapes, const std::vector<std::uint32_t>& order)
        : shapes_(shapes), order_(order), placed_(shapes.size()) {}

    /// Places all charts in `size` · `size` texels; false: they don't fit.
    [[nodiscard]] bool pack(double scale, std::uint32_t size) {
        free_.clear();
        top_ = 0;
        for (const std::uint32_t number : order_) {
            if (!place(number, scale, static_cast<std::int32_t>(size))) {
                return false;
            }
        }
        return true;
    }

    [[nodiscard]] const placed_chart& at(std::size_t triangle) const { return placed_[triangle]; }

  private:
    [[nodiscard]] bool place(std::uint32_t number, double scale, std::int32_t size) {
        const triangle_shape& shape = shapes_[number];
        if (shape.width * scale > size || shape.height * scale > size) {
            return false;
        }
        rows_of(lay_flat(shape, scale, false), upright_);
        rows_of(lay_flat(shape, scale, true), turned_);
        for (int attempt = 0; attempt < 2; ++attempt) {
            const std::optional<found> best = fit(size);
            if (best) {
                take(*best, placed_[number]);
                return true;
            }
            const auto height = static_cast<std::int32_t>(upright_.size());
            const std::int32_t next = top_ + static_cast<std::int32_t>(free_.size());
            if (attempt == 1 || next + height > size) {
                return false;
            }
            top_ = next; // a new shelf, as high as its first chart
            free_.assign(upright_.size(), 0);
        }
        return false;
    }

    struct found {
        std::int32_t x = 0;
        std::int64_t waste = 0; ///< texels that stay free to its left
        bool turned = false;
    };

    [[nodiscard]] std::optional<found> fit(std::int32_t size) const {
        std::optional<found> best;
        for (const bool turned : {false, true}) {
            const auto& rows = turned ? turned_ : upright_;
            if (rows.size() > free_.size()) {
                continue;
            }
            std::int32_t x = 0;
            for (std::size_t r = 0; r < rows.size(); ++r) {
                x = std::max(x, free_[r] - rows[r].first);
            }
            std::int64_t waste = 0;
            bool inside = true;
            for (std::size_t r = 0; r < rows.size(); ++r) {
                waste += x + rows[r].first - free_[r];
                inside = inside && x + rows[r].last < size;
            }
            if (inside && (!best || waste < best->waste)) {
                best = found{x, waste, turned};
            }
        }
        return best;
    }

    void take(const found& where, placed_chart& chart) {
        const auto& rows = where.turned ? turned_ : upright_;
        for (std::size_t r = 0; r < rows.size(); ++r) {
            if (rows[r].first <= rows[r].last) {
                free_[r] = where.x + rows[r].last + 1;
            }
        }
        chart.origin = {static_cast<std::uint32_t>(where.x), static_cast<std::uint32_t>(top_)};
        chart.turned = where.turned;
    }

    const std::vector<triangle_shape>& shapes_;
    const std::vector<std::uint32_t>& order_; ///< the highest first
    std::vector<placed_chart> placed_;
    std::vector<std::int32_t> free_; ///< of the shelf: the first free texel of each row
    std::int32_t top_ = 0;           ///< the shelf's first row
    std::vector<texel_row> upright_;
    std::vector<texel_row> turned_;
};

/// The largest scale that fits, to 1 %.
template <class = when_used>
[[nodiscard]] std::optional<double> largest_scale(chart_packer<>& packer, double area,
                                                  double longest, std::uint32_t size) {
    double low = std::log(0.25 / longest);
    double high = std::log(size / std::max(std::sqrt(area), longest));
    if (!packer.pack(std::exp(low), size)) {
        return {};
    }
    while (high - low > 0.01) {
        const double middle = 0.5 * (low + high);
        (packer.pack(std::exp(middle), size) ? low : high) = middle;
    }
    return std::exp(low);
}

/// Barycentric weights of `p` in a flat triangle.
[[nodiscard]] inline glm::dvec3 weights_at(const std::array<glm::dvec2, 3>& t, glm::dvec2 p) {
    const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    const double area = cross(t[1] - t[0], t[2] - t[0]);
    const double b = cross(p - t[0], t[2] - t[0]) / area;
    const double c = cross(t[1] - t[0], p - t[0]) / area;
    return {1 - b - c, b, c};
}

/// Fills in the samples and the seams of one chart.
template <class = when_used>
class chart_sampler {
  public:
    explicit chart_sampler(lightmap& map) : map_(map) {}

    void add(const gather_triangle& triangle, std::uint32_t number, const flat_chart& chart,
             glm::uvec2 origin) {
        rows_of(chart, rows_);
        normal_ = glm::vec3(glm::normalize(
            glm::cross(glm::dvec3(triangle.b - triangle.a), glm::dvec3(triangle.c - triangle.a))));
        width_ = 0;
        for (const texel_row& row : rows_) {
            width_ = std::max(width_, row.last + 1);
        }
        covered_.assign(rows_.size() * static_cast<std::size_t>(width_), none);
        each_texel([&](std::int32_t x, std::int32_t y) {
            const glm::dvec3 w = weights_at(chart.corners, glm::dvec2(x + 0.5, y + 0.5));
            if (std::min({w.x, w.y, w.z}) >= 0) {
                add_sample(triangle, number, w, x, y, origin);
            }
        });
        if (std::all_of(covered_.begin(), covered_.end(),
                        [](std::uint32_t texel) { return texel == none; })) {
            const glm::dvec2 middle =
                (chart.corners[0] + chart.corners[1] + chart.corners[2]) / 3.0;
            add_sample(triangle, number, glm::dvec3(1.0 / 3), static_cast<std::int32_t>(middle.x),
                       static_cast<std::int32_t>(middle.y), origin);
        }
        add_seams(origin);
    }

  private:
    static constexpr std::uint32_t none = 0xffffffffu;

    template <class Do>
    void each_texel(Do&& work) const {
        for (std::int32_t y = 0; y < static_cast<std::int32_t>(rows_.size()); ++y) {
            const texel_row row = rows_[static_cast<std::size_t>(y)];
            for (std::int32_t x = row.first; x <= row.last; ++x) {
                work(x, y);
            }
        }
    }

    [[nodiscard]] std::size_t local(std::int32_t x, std::int32_t y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }
    [[nodiscard]] std::uint32_t texel(std::int32_t x, std::int32_t y, glm::uvec2 origin) const {
        return (origin.y + static_cast<std::uint32_t>(y)) * map_.size + origin.x +
               static_cast<std::uint32_t>(x);
    }

    void add_sample(const gather_triangle& t, std::uint32_t number, const glm::dvec3& w,
                    std::int32_t x, std::int32_t y, glm::uvec2 origin) {
        gather_sample s;
        s.position =
            glm::vec3(w.x * glm::dvec3(t.a) + w.y * glm::dvec3(t.b) + w.z * glm::dvec3(t.c));
        s.normal = normal_;
        covered_[local(x, y)] = texel(x, y, origin);
        map_.samples.push_back(s);
        map_.texels.push_back(covered_[local(x, y)]);
        map_.triangles.push_back(number);
    }

    /// Rings of texels outwards, each next to one before it: what a ring takes lies nearest to it.
    void add_seams(glm::uvec2 origin) {
        bool found = true;
        while (found) {
            found = false;
            next_ = covered_;
            each_texel([&](std::int32_t x, std::int32_t y) {
                if (covered_[local(x, y)] != none) {
                    return;
                }
                const std::uint32_t from = beside(x, y);
                if (from != none) {
                    next_[local(x, y)] = from;
                    map_.seams.emplace_back(texel(x, y, origin), from);
                    found = true;
                }
            });
            covered_.swap(next_);
        }
    }

    /// What a texel beside, or else across a corner, has.
    [[nodiscard]] std::uint32_t beside(std::int32_t x, std::int32_t y) const {
        constexpr std::int32_t steps[8][2] = {{-1, 0},  {1, 0},  {0, -1}, {0, 1},
                                              {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
        for (const auto& step : steps) {
            const std::int32_t u = x + step[0];
            const std::int32_t v = y + step[1];
            if (u >= 0 && v >= 0 && u < width_ && v < static_cast<std::int32_t>(rows_.size()) &&
                covered_[local(u, v)] != none) {
                return covered_[local(u, v)];
            }
        }
        return none;
    }

    lightmap& map_;
    std::vector<texel_row> rows_;
    std::vector<std::uint32_t> covered_; ///< the texel whose light this one has
    std::vector<std::uint32_t> next_;
    std::int32_t width_ = 0;
    glm::vec3 normal_{0};
};

} // namespace detail

/// Lays out the charts of `triangles` and says which points ask for light: as many as texels have
/// their centre on a triangle, size² at most. Triangles without area have none. The same input
/// gives the same map on every machine that computes doubles as IEEE 754 has it.
///
/// Errors (`bad_input`): no triangle with an area; a corner that isn't finite; a size of 0 or more
/// than 32,768; charts that don't fit, with the size that would hold them. `out_of_memory`: more
/// than options.most_samples, by the triangles' area.
template <class = when_used>
[[nodiscard]] result<lightmap> make_lightmap(std::span<const gather_triangle> triangles,
                                             const lightmap_options& options = {}) {
    constexpr std::uint32_t largest = 32768;
    if (options.size == 0 || options.size > largest ||
        !(options.texels_per_metre >= 0 && options.texels_per_metre < 1e9f)) {
        return fail(error_code::bad_input, "A lightmap of " + std::to_string(options.size) +
                                               " texels a side, " +
                                               std::to_string(options.texels_per_metre) +
                                               " a metre, isn't possible; expected 1 to 32768.");
    }
    std::vector<detail::triangle_shape> shapes(triangles.size());
    std::vector<std::uint32_t> order;
    double area = 0;
    double longest = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        shapes[i] = detail::shape_of(triangles[i]);
        const double twice = shapes[i].width * shapes[i].height;
        if (!std::isfinite(twice)) {
            return fail(error_code::bad_input, "Triangle " + std::to_string(i) +
                                                   " has a corner that isn't finite; expected "
                                                   "places in metres.");
        }
        // Thinner than what its corners' own rounding could be has no inside to look at.
        if (twice > 0 && shapes[i].height > 1e-6 * shapes[i].width) {
            order.push_back(static_cast<std::uint32_t>(i));
            area += 0.5 * twice;
            longest = std::max(longest, shapes[i].width);
        }
    }
    if (order.empty()) {
        return fail(error_code::bad_input,
                    "None of " + std::to_string(triangles.size()) +
                        " triangles has an area; expected one at least for a lightmap.");
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return shapes[a].height > shapes[b].height;
    });
    detail::chart_packer<> packer(shapes, order);
    std::optional<double> scale;
    if (options.texels_per_metre > 0) {
        scale = double{options.texels_per_metre};
    } else {
        scale = detail::largest_scale(packer, area, longest, options.size);
    }
    if (!scale || !packer.pack(*scale, options.size)) {
        std::uint32_t enough = options.size;
        const double wanted = scale.value_or(0.25 / longest);
        while (enough < largest && !packer.pack(wanted, enough)) {
            enough = std::min(2 * enough, largest);
        }
        return fail(error_code::bad_input,
                    std::to_string(order.size()) + " triangles don't fit in a lightmap of " +
                        std::to_string(options.size) + " texels a side; expected " +
                        (packer.pack(wanted, enough) ? std::to_string(enough)
                                                     : std::string("fewer triangles")) +
                        (options.texels_per_metre > 0 ? " or fewer texels a metre." : "."));
    }
    const double samples = area * *scale * *scale;
    if (samples > static_cast<double>(options.most_samples)) {
        return fail(error_code::out_of_memory,
                    "A lightmap of " + std::to_string(options.size) +
                        " texels a side asks for light at about " +
                        std::to_string(static_cast<std::uint64_t>(samples)) + " points; at most " +
                        std::to_string(options.most_samples) + " are allowed.");
    }
    lightmap map;
    map.size = options.size;
    map.texels_per_metre = static_cast<float>(*scale);
    map.corners.assign(3 * triangles.size(), glm::vec2(0));
    detail::chart_sampler<> sampler(map);
    for (const std::uint32_t number : order) {
        const detail::placed_chart& where = packer.at(number);
        const detail::flat_chart chart = detail::lay_flat(shapes[number], *scale, where.turned);
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 texel = chart.corners[i] + glm::dvec2(where.origin);
            map.corners[3 * std::size_t{number} + i] =
                glm::vec2(texel / static_cast<double>(options.size));
        }
        sampler.add(triangles[number], number, chart, where.origin);
    }
    return map;
}

/// Fills the texels at the seams of a picture in which the samples' texels have their light.
/// `image` has size² entries, rows after row.
template <class Texel>
void dilate(const lightmap& map, std::span<Texel> image) {
    for (const glm::uvec2& pair : map.seams) {
        image[pair.x] = image[pair.y];
    }
}

} // namespace skybark::gather
