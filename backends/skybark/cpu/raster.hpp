#pragma once
// The CPU backend's rasteriser: clip, project, and cover pixel centres, as GPUs do.
//
// Positions are rounded to 1/256 of a pixel and the edge functions are integers, so a pixel on a
// shared edge belongs to exactly one of its triangles (the top-left rule) and the picture does not
// depend on the number of threads: triangles are set up in parallel, then each band of rows draws
// all of them in order; blended ones from the front to the back, until nothing shows through.

#include <skybark/core/backend.hpp>
#include <skybark/cpu/grids.hpp>
#include <skybark/cpu/memory.hpp>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <tuple>
#include <vector>

namespace skybark::cpu {

/// A triangle on the screen, ready to be covered.
struct screen_triangle {
    std::int32_t row_first, row_end; ///< of the picture, whose pixel centres may be covered
    std::int32_t column_first, column_end;
    std::int32_t x[3], y[3]; ///< 1/256 pixel, y down, clockwise as seen
    float z[3];              ///< depth
    float inverse_w[3];
    glm::vec3 weights[3];    ///< where each corner lies in the triangle that was clipped
    std::uint32_t vertex[3]; ///< in the batch's shaded vertices
    bool clipped = false;
    bool front = true;
};

/// Neighbouring triangles of a draw, and the rows that they touch, so that bands skip them at once.
struct screen_piece {
    detail::kept_list<screen_triangle> triangles;
    std::int32_t row_first = 0;
    std::int32_t row_end = 0;
};

/// Memory that draws use again.
struct raster_scratch {
    const detail::memory_source* source = nullptr;
    detail::scratch_memory clip{source};
    detail::scratch_memory varyings{source};
    detail::scratch_memory layer{source};
    std::vector<screen_piece> pieces = {};
};

namespace raster {

inline constexpr std::int64_t subpixels = 256;
inline constexpr std::uint32_t batch_triangles = 1u << 16;
inline constexpr std::uint32_t piece_triangles = 512;
inline constexpr std::uint32_t band_rows = 32;     ///< at least
inline constexpr std::uint32_t bands_a_worker = 8; ///< enough to share out what costs most
/// Clip-space x and y may reach this times w before they are clipped: for images up to 2^15 pixels
/// positions then stay below 2^27, and edge functions below 2^58.
inline constexpr float guard_band = 16.0f;

struct corner {
    glm::vec4 position;
    glm::vec3 weights;
};

/// A convex polygon: a triangle gains at most one corner a plane.
struct polygon {
    corner corners[9];
    int count = 0;
};

/// Signed distance of a clip-space position from plane `i`; inside is ≥ 0.
[[nodiscard]] inline float plane_distance(const glm::vec4& p, int i) {
    switch (i) {
    case 0:
        return p.z;
    case 1:
        return p.w - p.z;
    case 2:
        return guard_band * p.w - p.x;
    case 3:
        return guard_band * p.w + p.x;
    case 4:
        return guard_band * p.w - p.y;
    default:
        return guard_band * p.w + p.y;
    }
}
inline constexpr int plane_count = 6;

/// Where the edge from corner `in` (inside of a plane by `inside`) to `out` meets the plane: the
/// same bits for both triangles of a shared edge. In double precision, because on an edge from far
/// behind the eye to far before it w has lost its digits where it is small.
[[nodiscard]] inline corner cut(const corner& in, const corner& out, double inside,
                                double outside) {
    const double t = inside / (inside - outside);
    return {glm::vec4(glm::mix(glm::dvec4(in.position), glm::dvec4(out.position), t)),
            glm::vec3(glm::mix(glm::dvec3(in.weights), glm::dvec3(out.weights), t))};
}

[[nodiscard]] inline polygon clip_by_plane(const polygon& in, int plane) {
    polygon out;
    for (int i = 0; i < in.count; ++i) {
        const corner& a = in.corners[i];
        const corner& b = in.corners[(i + 1) % in.count];
        const float da = plane_distance(a.position, plane);
        const float db = plane_distance(b.position, plane);
        if (da >= 0) {
            out.corners[out.count++] = a;
        }
        if ((da >= 0) != (db >= 0)) {
            out.corners[out.count++] = da >= 0 ? cut(a, b, da, db) : cut(b, a, db, da);
        }
    }
    return out;
}

[[nodiscard]] inline bool finite(const glm::vec4& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
}

/// Which planes `p` is outside of, a bit each.
[[nodiscard]] inline unsigned outside(const glm::vec4& p) {
    unsigned bits = 0;
    for (int i = 0; i < plane_count; ++i) {
        bits |= plane_distance(p, i) < 0 ? 1u << i : 0u;
    }
    return bits;
}

struct viewport {
    std::uint32_t width;
    std::uint32_t height;
};

/// The first row (or column) whose pixels' centres lie at or beyond a place in 1/256 pixel, and the
/// one after the last whose centres lie at or before it.
[[nodiscard]] constexpr std::int32_t first_centre(std::int32_t place) { return (place + 127) >> 8; }
[[nodiscard]] constexpr std::int32_t end_centre(std::int32_t place) { return (place + 128) >> 8; }

[[nodiscard]] inline std::int64_t twice_area(const screen_triangle& t) {
    return std::int64_t{t.x[1] - t.x[0]} * (t.y[2] - t.y[0]) -
           std::int64_t{t.x[2] - t.x[0]} * (t.y[1] - t.y[0]);
}

/// Projects three corners and keeps the triangle if it covers anything.
inline void project(const corner* c0, const corner* c1, const corner* c2,
                    const std::uint32_t (&vertex)[3], viewport size, cull_mode cull, bool clipped,
                    detail::kept_list<screen_triangle>& out) {
    screen_triangle t;
    const corner* corners[3] = {c0, c1, c2};
    const auto fixed = [](float pixels) {
        return static_cast<std::int32_t>(std::lrint(pixels * static_cast<float>(subpixels)));
    };
    for (int i = 0; i < 3; ++i) {
        const glm::vec4& p = corners[i]->position;
        // Smaller ones have no inverse that is a number.
        if (!(p.w >= std::numeric_limits<float>::min())) {
            return;
        }
        const float inverse_w = 1.0f / p.w;
        // Clipping leaves coordinates within the band but for rounding, which a tiny w magnifies.
        const float x = std::clamp(p.x * inverse_w, -guard_band, guard_band);
        const float y = std::clamp(p.y * inverse_w, -guard_band, guard_band);
        t.x[i] = fixed((x * 0.5f + 0.5f) * static_cast<float>(size.width));
        t.y[i] = fixed((0.5f - y * 0.5f) * static_cast<float>(size.height));
        t.z[i] = p.z * inverse_w;
        t.inverse_w[i] = inverse_w;
        t.weights[i] = corners[i]->weights;
        t.vertex[i] = vertex[i];
    }
    // Most triangles of a meadow are smaller than a pixel, and lie between the centres.
    const auto [x_least, x_most] = std::minmax({t.x[0], t.x[1], t.x[2]});
    const auto [y_least, y_most] = std::minmax({t.y[0], t.y[1], t.y[2]});
    t.column_first = std::max(0, first_centre(x_least));
    t.column_end = std::min(static_cast<std::int32_t>(size.width), end_centre(x_most));
    t.row_first = std::max(0, first_centre(y_least));
    t.row_end = std::min(static_cast<std::int32_t>(size.height), end_centre(y_most));
    if (t.column_first >= t.column_end || t.row_first >= t.row_end) {
        return;
    }
    const std::int64_t area = twice_area(t);
    // y points down here, so a positive area is clockwise as drawn with y up: a back face.
    t.front = area < 0;
    t.clipped = clipped;
    if (area == 0 || (cull == cull_mode::back && !t.front)) {
        return;
    }
    if (area < 0) {
        std::swap(t.x[1], t.x[2]);
        std::swap(t.y[1], t.y[2]);
        std::swap(t.z[1], t.z[2]);
        std::swap(t.inverse_w[1], t.inverse_w[2]);
        if (clipped) {
            std::swap(t.weights[1], t.weights[2]);
        } else {
            std::swap(t.vertex[1], t.vertex[2]);
        }
    }
    out.push_back(t);
}

/// Whether all of a triangle lies beyond one of the picture's sides.
[[nodiscard]] inline bool beside(const glm::vec4& a, const glm::vec4& b, const glm::vec4& c) {
    return (a.x > a.w && b.x > b.w && c.x > c.w) || (a.x < -a.w && b.x < -b.w && c.x < -c.w) ||
           (a.y > a.w && b.y > b.w && c.y > c.w) || (a.y < -a.w && b.y < -b.w && c.y < -c.w);
}

/// Clips a triangle of shaded vertices and keeps what is left of it.
inline void set_up(const glm::vec4* clip, const std::uint32_t (&vertex)[3], viewport size,
                   cull_mode cull, detail::kept_list<screen_triangle>& out) {
    const glm::vec4& a = clip[vertex[0]];
    const glm::vec4& b = clip[vertex[1]];
    const glm::vec4& c = clip[vertex[2]];
    if (!finite(a) || !finite(b) || !finite(c)) {
        return;
    }
    const unsigned outside_a = outside(a);
    const unsigned outside_b = outside(b);
    const unsigned outside_c = outside(c);
    if ((outside_a & outside_b & outside_c) != 0 || beside(a, b, c)) {
        return;
    }
    polygon shape{{{a, {1, 0, 0}}, {b, {0, 1, 0}}, {c, {0, 0, 1}}}, 3};
    const unsigned crossed = outside_a | outside_b | outside_c;
    for (int plane = 0; plane < plane_count && crossed != 0; ++plane) {
        if ((crossed >> plane & 1u) != 0) {
            shape = clip_by_plane(shape, plane);
        }
    }
    for (int i = 2; i < shape.count; ++i) {
        project(&shape.corners[0], &shape.corners[i - 1], &shape.corners[i], vertex, size, cull,
                crossed != 0, out);
    }
}

/// An edge function over pixel centres: its value, and how it changes by a pixel.
struct edge {
    std::int64_t value, step_x, step_y;

    /// Positive inside; `bias` makes a centre on the edge belong to top and left edges only.
    [[nodiscard]] static edge between(const screen_triangle& t, int from, int to,
                                      std::int64_t pixel_x, std::int64_t pixel_y) {
        const std::int64_t dx = std::int64_t{t.x[to]} - t.x[from];
        const std::int64_t dy = std::int64_t{t.y[to]} - t.y[from];
        const std::int64_t px = pixel_x * subpixels + subpixels / 2 - t.x[from];
        const std::int64_t py = pixel_y * subpixels + subpixels / 2 - t.y[from];
        return {dx * py - dy * px, -dy * subpixels, dx * subpixels};
    }
    [[nodiscard]] static std::int64_t bias(const screen_triangle& t, int from, int to) {
        const bool top = t.y[to] == t.y[from] && t.x[to] > t.x[from];
        const bool left = t.y[to] < t.y[from];
        return top || left ? 0 : -1;
    }
};

/// Calls `pixel(x, y, b)` for each covered pixel of rows [row_first, row_end), b being the
/// barycentric weights on the screen.
template <class Pixel>
void cover(const screen_triangle& t, std::int32_t row_first, std::int32_t row_end,
           const Pixel& pixel) {
    const std::int64_t x_first = t.column_first;
    const std::int64_t x_end = t.column_end;
    const std::int64_t y_first = std::max(row_first, t.row_first);
    const std::int64_t y_end = std::min(row_end, t.row_end);
    if (y_first >= y_end) {
        return;
    }
    edge e[3] = {edge::between(t, 1, 2, x_first, y_first), edge::between(t, 2, 0, x_first, y_first),
                 edge::between(t, 0, 1, x_first, y_first)};
    const std::int64_t bias[3] = {edge::bias(t, 1, 2), edge::bias(t, 2, 0), edge::bias(t, 0, 1)};
    const float inverse_area = 1.0f / static_cast<float>(twice_area(t));
    for (std::int64_t y = y_first; y < y_end; ++y) {
        std::int64_t v0 = e[0].value;
        std::int64_t v1 = e[1].value;
        std::int64_t v2 = e[2].value;
        for (std::int64_t x = x_first; x < x_end; ++x) {
            if (((v0 + bias[0]) | (v1 + bias[1]) | (v2 + bias[2])) >= 0) {
                const float b1 = static_cast<float>(v1) * inverse_area;
                const float b2 = static_cast<float>(v2) * inverse_area;
                pixel(x, y, glm::vec3(1.0f - b1 - b2, b1, b2));
            }
            v0 += e[0].step_x;
            v1 += e[1].step_x;
            v2 += e[2].step_x;
        }
        for (edge& side : e) {
            side.value += side.step_y;
        }
    }
}

[[nodiscard]] inline glm::vec4 load_bytes(const std::byte* data) {
    std::uint8_t bytes[4];
    std::memcpy(bytes, data, sizeof bytes);
    return glm::vec4(bytes[0], bytes[1], bytes[2], bytes[3]) * (1.0f / 255.0f);
}

[[nodiscard]] inline glm::vec4 load_pixel(const image& from, std::uint64_t index) {
    const std::byte* data = from.data() + index * bytes_per_pixel(from.description().format);
    switch (from.description().format) {
    case image_format::rgba8:
        return load_bytes(data);
    case image_format::rgba32f: {
        glm::vec4 value;
        std::memcpy(&value, data, sizeof value);
        return value;
    }
    case image_format::depth32f:
        break;
    }
    float depth = 0;
    std::memcpy(&depth, data, sizeof depth);
    return {depth, 0, 0, 1};
}

inline void store_pixel(const image& to, std::uint64_t index, const glm::vec4& value) {
    std::byte* data = to.data() + index * bytes_per_pixel(to.description().format);
    if (to.description().format == image_format::rgba32f) {
        std::memcpy(data, &value, sizeof value);
        return;
    }
    std::uint8_t bytes[4];
    for (int i = 0; i < 4; ++i) {
        // The comparison is false for NaN, which becomes 0 as on GPUs.
        const float clamped = value[i] > 0.0f ? std::min(value[i], 1.0f) : 0.0f;
        bytes[i] = static_cast<std::uint8_t>(clamped * 255.0f + 0.5f);
    }
    std::memcpy(data, bytes, sizeof bytes);
}

} // namespace raster

/// How fragment functions read the bound images and volumes.
template <class Images>
class image_reader : public grids {
  public:
    image_reader(const Images& images, const grids& volumes) : grids(volumes), images_(&images) {}

    [[nodiscard]] glm::ivec2 size(std::uint32_t n) const {
        const image_description what = (*images_)[n].image->description();
        return {static_cast<int>(what.width), static_cast<int>(what.height)};
    }

    /// A texel; outside the image the nearest one.
    [[nodiscard]] glm::vec4 fetch(std::uint32_t n, glm::ivec2 texel) const {
        const glm::ivec2 s = size(n);
        const glm::ivec2 t = glm::clamp(texel, glm::ivec2(0), s - 1);
        return raster::load_pixel(*(*images_)[n].image, static_cast<std::uint64_t>(t.y) *
                                                                static_cast<std::uint64_t>(s.x) +
                                                            static_cast<std::uint64_t>(t.x));
    }

    /// The image at (u, v), 0…1 from its upper left corner, by the binding's filter and wrap.
    [[nodiscard]] glm::vec4 sample(std::uint32_t n, glm::vec2 at) const {
        const auto& bound = (*images_)[n];
        const image_description what = bound.image->description();
        const glm::ivec2 s(static_cast<int>(what.width), static_cast<int>(what.height));
        const glm::vec2 texels = at * glm::vec2(s);
        const bool repeat = bound.wrap == wrap_mode::repeat;
        if (bound.filter == filter_mode::nearest) {
            const glm::ivec2 i(glm::floor(texels));
            return fetch(n, {wrapped(i.x, s.x, repeat), wrapped(i.y, s.y, repeat)});
        }
        const glm::vec2 corner = glm::floor(texels - 0.5f);
        const glm::vec2 part = texels - 0.5f - corner;
        const glm::ivec2 i(corner);
        const auto left = static_cast<std::size_t>(wrapped(i.x, s.x, repeat));
        const auto right = static_cast<std::size_t>(wrapped(i.x + 1, s.x, repeat));
        const auto width = static_cast<std::size_t>(s.x);
        const std::size_t upper = width * static_cast<std::size_t>(wrapped(i.y, s.y, repeat));
        const std::size_t lower = width * static_cast<std::size_t>(wrapped(i.y + 1, s.y, repeat));
        const auto mixed = [](const glm::vec4& a, const glm::vec4& b, float t) {
            return a * (1.0f - t) + b * t;
        };
        const auto between = [&](const auto& texel) {
            return mixed(mixed(texel(upper + left), texel(upper + right), part.x),
                         mixed(texel(lower + left), texel(lower + right), part.x), part.y);
        };
        if (what.format == image_format::rgba8) {
            return between([data = bound.image->data()](std::size_t index) {
                return raster::load_bytes(data + 4 * index);
            });
        }
        return between([&](std::size_t index) { return raster::load_pixel(*bound.image, index); });
    }

  private:
    [[nodiscard]] static int wrapped(int texel, int size, bool repeat) {
        if (texel >= 0 && texel < size) {
            return texel;
        }
        return repeat ? (texel % size + size) % size : (texel < 0 ? 0 : size - 1);
    }

    const Images* images_;
};

namespace raster {

/// Fills the target where the draw asks for it.
template <class Device>
void clear(Device& device, const draw_target<Device>& target, viewport size) {
    const auto rows = [&](auto&& work) { device.for_pieces(size.height, band_rows, work); };
    if (target.color != nullptr && target.clear_color) {
        rows([&](std::uint64_t first, std::uint64_t count) {
            for (std::uint64_t i = first * size.width; i < (first + count) * size.width; ++i) {
                store_pixel(*target.color, i, *target.clear_color);
            }
        });
    }
    if (target.depth != nullptr && target.clear_depth) {
        rows([&](std::uint64_t first, std::uint64_t count) {
            float* depth = reinterpret_cast<float*>(target.depth->data());
            std::fill_n(depth + first * size.width, count * size.width, *target.clear_depth);
        });
    }
}

/// The perspective-correct weights of the triangle's vertices at a pixel.
[[nodiscard]] inline glm::vec3 vertex_weights(const screen_triangle& t, const glm::vec3& screen) {
    const glm::vec3 over_w(screen.x * t.inverse_w[0], screen.y * t.inverse_w[1],
                           screen.z * t.inverse_w[2]);
    const glm::vec3 b = over_w / (over_w.x + over_w.y + over_w.z);
    return t.clipped ? t.weights[0] * b.x + t.weights[1] * b.y + t.weights[2] * b.z : b;
}

} // namespace raster

namespace raster {

/// Blended triangles that leave the depth alone are drawn from the last one to the first, into a
/// layer of their own that goes over the picture in the end: the same sum, since "over" may be put
/// in brackets as one likes. So no fragment is shaded of which the picture would show less than
/// this part: most of a cloud lies behind other parts of it.
inline constexpr float least_seen = 1.0f / 65536;
/// Fewer triangles are not worth the layer.
inline constexpr std::uint32_t least_layered = 512;

/// One draw: batches of triangles are shaded and set up, and then drawn band by band.
template <class Device, draw_kernel K, class... Spans>
class drawing {
  public:
    drawing(Device& device, raster_scratch& scratch, const K& kernel,
            const image_bindings<Device, K>& images, const grids& volumes,
            const draw_geometry<Device>& geometry, const draw_target<Device>& target,
            draw_state state, const std::tuple<Spans...>& spans)
        : device_(device), scratch_(scratch), kernel_(kernel), reader_(images, volumes),
          geometry_(geometry),
          indices_(records_of<Device, std::span<const std::uint32_t>>(geometry.indices)),
          color_(target.color), state_(state), spans_(spans) {
        const image* sized = color_ != nullptr ? color_ : target.depth;
        size_ = {sized->description().width, sized->description().height};
        if (target.depth != nullptr) {
            depth_ = reinterpret_cast<float*>(target.depth->data());
        }
        // Each band looks at all triangles: no more of them than the workers need.
        rows_ = std::max(band_rows, size_.height / (bands_a_worker * device.workers()) + 1);
    }

    /// False where there is no memory to do it in.
    [[nodiscard]] bool record(std::uint32_t vertices) {
        const std::uint32_t triangles = vertices / 3;
        const std::uint32_t batches = (triangles + batch_triangles - 1) / batch_triangles;
        const bool is_layered = is_order_free() && triangles >= least_layered;
        if (is_layered && !begin_layer()) {
            return false;
        }
        for (std::uint32_t i = 0; i < batches; ++i) {
            const std::uint32_t done = (is_layered ? batches - 1 - i : i) * batch_triangles;
            if (!shade_vertices(geometry_.first + 3 * done,
                                std::min(batch_triangles, triangles - done)) ||
                !set_up_pieces()) {
                return false;
            }
            for_bands([&](std::int32_t first, std::int32_t end) {
                is_layered ? draw_under(first, end) : draw_over(first, end);
            });
        }
        if (is_layered) {
            end_layer();
        }
        return true;
    }

  private:
    using varyings = std::array<glm::vec4, K::varyings>;

    [[nodiscard]] bool is_order_free() const {
        return state_.blend == blend_mode::alpha && (depth_ == nullptr || !state_.depth_write) &&
               color_ != nullptr && color_->description().format == image_format::rgba32f;
    }

    template <class Work>
    void for_bands(const Work& work) {
        device_.parallel((size_.height + rows_ - 1) / rows_, [&](std::uint32_t band) {
            work(static_cast<std::int32_t>(band * rows_),
                 static_cast<std::int32_t>(std::min((band + 1) * rows_, size_.height)));
        });
    }

    [[nodiscard]] std::uint32_t vertex_number(std::uint32_t i) const {
        return geometry_.base_vertex + (indices_.empty() ? i : indices_[i]);
    }

    /// Shades each vertex once where the batch's indices are close together, as they are in meshes;
    /// else once a corner.
    [[nodiscard]] bool shade_vertices(std::uint32_t first, std::uint32_t triangles) {
        first_ = first;
        triangles_ = triangles;
        std::uint32_t most = 0;
        least_ = std::numeric_limits<std::uint32_t>::max();
        for (std::uint32_t i = first; i < first + 3 * triangles; ++i) {
            least_ = std::min(least_, vertex_number(i));
            most = std::max(most, vertex_number(i));
        }
        shared_ = most - least_ < 3 * triangles;
        const std::uint32_t vertices = shared_ ? most - least_ + 1 : 3 * triangles;
        clip_ = scratch_.clip.room_for<glm::vec4>(vertices);
        shaded_ = scratch_.varyings.room_for<glm::vec4>(std::uint64_t{vertices} * K::varyings);
        if (clip_ == nullptr || shaded_ == nullptr) {
            return false;
        }
        device_.for_pieces(vertices, 1024, [&](std::uint64_t begin, std::uint64_t n) {
            for (std::uint64_t v = begin; v < begin + n; ++v) {
                const auto i = static_cast<std::uint32_t>(v);
                const std::uint32_t number = shared_ ? least_ + i : vertex_number(first_ + i);
                varyings out{};
                clip_[v] = std::apply(
                    [&](const auto&... spans) { return kernel_.vertex(number, out, spans...); },
                    spans_);
                std::copy(out.begin(), out.end(), shaded_ + v * K::varyings);
            }
        });
        return true;
    }

    [[nodiscard]] bool set_up_pieces() {
        pieces_ = (triangles_ + piece_triangles - 1) / piece_triangles;
        // Room for as many as there can be unless some are clipped: later frames need no more.
        while (scratch_.pieces.size() < pieces_) {
            scratch_.pieces.push_back(
                {detail::kept_list<screen_triangle>(scratch_.source, piece_triangles)});
        }
        device_.parallel(pieces_, [&](std::uint32_t p) { set_up_piece(p); });
        for (std::uint32_t p = 0; p < pieces_; ++p) {
            if (!scratch_.pieces[p].triangles.complete()) {
                scratch_.pieces.clear();
                return false;
            }
        }
        return true;
    }

    void set_up_piece(std::uint32_t p) {
        screen_piece& piece = scratch_.pieces[p];
        piece.triangles.clear();
        const std::uint32_t end = std::min(triangles_, (p + 1) * piece_triangles);
        for (std::uint32_t t = p * piece_triangles; t < end; ++t) {
            std::uint32_t vertex[3];
            for (std::uint32_t k = 0; k < 3; ++k) {
                vertex[k] = shared_ ? vertex_number(first_ + 3 * t + k) - least_ : 3 * t + k;
            }
            set_up(clip_, vertex, size_, state_.cull, piece.triangles);
        }
        piece.row_first = std::numeric_limits<std::int32_t>::max();
        piece.row_end = 0;
        for (const screen_triangle& t : piece.triangles) {
            piece.row_first = std::min(piece.row_first, t.row_first);
            piece.row_end = std::max(piece.row_end, t.row_end);
        }
    }

    /// In the order that they come.
    void draw_over(std::int32_t row_first, std::int32_t row_end) {
        for (std::uint32_t p = 0; p < pieces_; ++p) {
            const screen_piece& piece = scratch_.pieces[p];
            if (piece.row_end <= row_first || piece.row_first >= row_end) {
                continue;
            }
            for (const screen_triangle& t : piece.triangles) {
                cover(t, row_first, row_end,
                      [&](std::int64_t x, std::int64_t y, const glm::vec3& b) {
                          shade_over(t, x, y, b);
                      });
            }
        }
    }

    /// From the last to the first.
    void draw_under(std::int32_t row_first, std::int32_t row_end) {
        for (std::uint32_t p = pieces_; p-- > 0;) {
            const screen_piece& piece = scratch_.pieces[p];
            if (piece.row_end <= row_first || piece.row_first >= row_end) {
                continue;
            }
            for (auto t = piece.triangles.end(); t != piece.triangles.begin();) {
                --t;
                cover(*t, row_first, row_end,
                      [&](std::int64_t x, std::int64_t y, const glm::vec3& b) {
                          shade_under(*t, x, y, b);
                      });
            }
        }
    }

    [[nodiscard]] std::uint64_t index_of(std::int64_t x, std::int64_t y) const {
        return static_cast<std::uint64_t>(y) * size_.width + static_cast<std::uint64_t>(x);
    }

    /// Exact where the triangle is parallel to the screen; rounding never leaves 0 … 1.
    [[nodiscard]] static float depth_at(const screen_triangle& t, const glm::vec3& b) {
        return std::clamp(t.z[0] + (t.z[1] - t.z[0]) * b.y + (t.z[2] - t.z[0]) * b.z, 0.0f, 1.0f);
    }

    [[nodiscard]] bool is_hidden(float z, std::uint64_t index) const {
        return depth_ != nullptr && state_.depth_test && !(z <= depth_[index]);
    }

    [[nodiscard]] fragment_output shade(const screen_triangle& t, std::int64_t x, std::int64_t y,
                                        const glm::vec3& b) const {
        varyings in;
        const glm::vec3 w = vertex_weights(t, b);
        const glm::vec4* corner[3];
        for (int i = 0; i < 3; ++i) {
            corner[i] = shaded_ + std::size_t{t.vertex[i]} * K::varyings;
        }
        for (std::size_t i = 0; i < K::varyings; ++i) {
            in[i] = corner[0][i] * w.x + corner[1][i] * w.y + corner[2][i] * w.z;
        }
        const glm::vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        return std::apply(
            [&](const auto&... spans) {
                return kernel_.fragment(in, pixel, t.front, reader_, spans...);
            },
            spans_);
    }

    void shade_over(const screen_triangle& t, std::int64_t x, std::int64_t y, const glm::vec3& b) {
        const std::uint64_t index = index_of(x, y);
        const float z = depth_at(t, b);
        if (is_hidden(z, index)) {
            return;
        }
        const fragment_output out = shade(t, x, y, b);
        if (!out.keep) {
            return;
        }
        if (depth_ != nullptr && state_.depth_write) {
            depth_[index] = z;
        }
        if (color_ != nullptr) {
            const bool blend = state_.blend == blend_mode::alpha;
            store_pixel(*color_, index,
                        blend ? out.color + load_pixel(*color_, index) * (1.0f - out.color.a)
                              : out.color);
        }
    }

    void shade_under(const screen_triangle& t, std::int64_t x, std::int64_t y, const glm::vec3& b) {
        const std::uint64_t index = index_of(x, y);
        glm::vec4& front = layer_[index];
        const float seen = 1.0f - front.a;
        if ((seen >= 0.0f && seen < least_seen) || is_hidden(depth_at(t, b), index)) {
            return;
        }
        const fragment_output out = shade(t, x, y, b);
        if (out.keep) {
            front = front + out.color * seen;
        }
    }

    [[nodiscard]] bool begin_layer() {
        layer_ = scratch_.layer.room_for<glm::vec4>(std::uint64_t{size_.width} * size_.height);
        if (layer_ == nullptr) {
            return false;
        }
        for_bands([&](std::int32_t first, std::int32_t end) {
            std::fill(layer_ + index_of(0, first), layer_ + index_of(0, end), glm::vec4(0));
        });
        return true;
    }

    void end_layer() {
        for_bands([&](std::int32_t first, std::int32_t end) {
            for (std::uint64_t i = index_of(0, first); i < index_of(0, end); ++i) {
                store_pixel(*color_, i, layer_[i] + load_pixel(*color_, i) * (1.0f - layer_[i].a));
            }
        });
    }

    Device& device_;
    raster_scratch& scratch_;
    const K& kernel_;
    image_reader<image_bindings<Device, K>> reader_;
    const draw_geometry<Device>& geometry_;
    std::span<const std::uint32_t> indices_;
    const image* color_;
    float* depth_ = nullptr;
    draw_state state_;
    std::tuple<Spans...> spans_;
    viewport size_{};
    std::uint32_t rows_ = 0; ///< of a band

    // The batch that is drawn.
    std::uint32_t first_ = 0;
    std::uint32_t triangles_ = 0;
    std::uint32_t pieces_ = 0;
    std::uint32_t least_ = 0; ///< number of a vertex
    bool shared_ = false;
    glm::vec4* clip_ = nullptr;
    glm::vec4* shaded_ = nullptr; ///< varyings, vertex by vertex
    glm::vec4* layer_ = nullptr;  ///< light and opacity of what is in front, a pixel
};

} // namespace raster

/// Draws triangles with kernel `K`: see the contract in skybark/core/backend.hpp. False where there
/// is no memory to do it in.
template <class Device, draw_kernel K, class... Spans>
[[nodiscard]] bool rasterise(Device& device, raster_scratch& scratch, const K& kernel,
                             const image_bindings<Device, K>& images, const grids& volumes,
                             const draw_geometry<Device>& geometry,
                             const draw_target<Device>& target, draw_state state, Spans... spans) {
    const image* sized = target.color != nullptr ? target.color : target.depth;
    raster::clear(device, target, {sized->description().width, sized->description().height});
    std::uint32_t count = geometry.count;
    if (geometry.length) {
        count_record length;
        std::memcpy(&length, geometry.length.buffer->data() + geometry.length.offset,
                    sizeof length);
        count = 3 * length.written;
    }
    raster::drawing<Device, K, Spans...> all(device, scratch, kernel, images, volumes, geometry,
                                             target, state, std::tuple<Spans...>(spans...));
    return all.record(count);
}

} // namespace skybark::cpu
