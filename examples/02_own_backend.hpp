#pragma once
// A fourth backend in one file: plain serial loops that say what the contract means.
//
// It shows what somebody who brings Skybark to another device has to write: a buffer, an image, a
// recorder with a member function for each pattern that the device can do, and the tag that
// promises to keep the contract. 02_own_backend.cpp proves it with the conformance suite.
//
// Nothing here is fast: each pattern is done when its call returns, one element after another.

#include <skybark/core/backend.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

namespace own {

class device;
class recorder;

/// Memory that starts with zeros and doesn't move when its owner does.
class bytes {
  public:
    explicit bytes(std::uint64_t size) : data_(new std::byte[size]()), size_(size) {}

    [[nodiscard]] std::byte* data() const noexcept { return data_.get(); }
    [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_; }

  private:
    std::unique_ptr<std::byte[]> data_;
    std::uint64_t size_;
};

using buffer = bytes;

/// Rows from the top, pixels without gaps.
class image {
  public:
    explicit image(skybark::image_description what)
        : memory_(std::uint64_t{what.width} * what.height * skybark::bytes_per_pixel(what.format)),
          what_(what) {}

    [[nodiscard]] skybark::image_description description() const noexcept { return what_; }
    [[nodiscard]] const bytes& memory() const noexcept { return memory_; }

    [[nodiscard]] glm::vec4 load(std::uint32_t x, std::uint32_t y) const {
        const std::byte* at = pixel(x, y);
        if (what_.format == skybark::image_format::rgba8) {
            const auto channel = [&](int i) { return static_cast<float>(at[i]) / 255.0f; };
            return {channel(0), channel(1), channel(2), channel(3)};
        }
        glm::vec4 value{0, 0, 0, 1};
        std::memcpy(&value, at, skybark::bytes_per_pixel(what_.format));
        return value;
    }
    void store(std::uint32_t x, std::uint32_t y, const glm::vec4& value) const {
        std::byte* at = pixel(x, y);
        if (what_.format != skybark::image_format::rgba8) {
            std::memcpy(at, &value, skybark::bytes_per_pixel(what_.format));
            return;
        }
        for (int i = 0; i < 4; ++i) {
            const float unit = std::fmax(0.0f, std::fmin(1.0f, value[i]));
            at[i] = static_cast<std::byte>(std::lround(unit * 255.0f));
        }
    }

  private:
    [[nodiscard]] std::byte* pixel(std::uint32_t x, std::uint32_t y) const {
        const std::uint64_t index = std::uint64_t{y} * what_.width + x;
        return memory_.data() + index * skybark::bytes_per_pixel(what_.format);
    }

    bytes memory_;
    skybark::image_description what_;
};

class device {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = own::buffer;
    using image = own::image;
    using recorder = own::recorder;

    [[nodiscard]] std::string_view name() const noexcept { return "own"; }
    [[nodiscard]] std::string device_name() const { return "one thread"; }
    [[nodiscard]] skybark::device_limits limits() const noexcept {
        return {std::uint64_t{1} << 40, 16, 0xffffffff, 16384};
    }
    [[nodiscard]] skybark::device_traffic traffic() const noexcept { return traffic_; }

    [[nodiscard]] skybark::result<buffer> create_buffer(std::uint64_t size) { return buffer(size); }
    [[nodiscard]] skybark::result<image> create_image(skybark::image_description what) {
        return image(what);
    }

    [[nodiscard]] skybark::result<void> upload(const buffer& to, std::uint64_t offset,
                                               std::span<const std::byte> in) {
        std::copy(in.begin(), in.end(), to.data() + offset);
        traffic_.up += in.size();
        return {};
    }
    [[nodiscard]] skybark::result<void> download(const buffer& from, std::uint64_t offset,
                                                 std::span<std::byte> out) {
        std::copy_n(from.data() + offset, out.size(), out.begin());
        traffic_.down += out.size();
        return {};
    }
    [[nodiscard]] skybark::result<void> upload(const image& to, std::span<const std::byte> in) {
        return upload(to.memory(), 0, in);
    }
    [[nodiscard]] skybark::result<void> download(const image& from, std::span<std::byte> out) {
        return download(from.memory(), 0, out);
    }

    [[nodiscard]] skybark::result<own::recorder> begin();
    [[nodiscard]] skybark::result<void> submit(own::recorder& recorder);

  private:
    friend class own::recorder;
    skybark::device_traffic traffic_;
};

/// What a fragment function reads images with.
class images {
  public:
    explicit images(std::span<const skybark::sampled_image<device>> bound) : bound_(bound) {}

    [[nodiscard]] glm::ivec2 size(std::uint32_t n) const {
        const skybark::image_description what = bound_[n].image->description();
        return {what.width, what.height};
    }
    [[nodiscard]] glm::vec4 fetch(std::uint32_t n, glm::ivec2 texel) const {
        return bound_[n].image->load(static_cast<std::uint32_t>(texel.x),
                                     static_cast<std::uint32_t>(texel.y));
    }
    [[nodiscard]] glm::vec4 sample(std::uint32_t n, glm::vec2 uv) const {
        const glm::vec2 at = uv * glm::vec2(size(n));
        if (bound_[n].filter == skybark::filter_mode::nearest) {
            return wrapped(n, std::floor(at.x), std::floor(at.y));
        }
        const float x = std::floor(at.x - 0.5f);
        const float y = std::floor(at.y - 0.5f);
        const float s = at.x - 0.5f - x;
        const float t = at.y - 0.5f - y;
        const glm::vec4 upper = wrapped(n, x, y) * (1 - s) + wrapped(n, x + 1, y) * s;
        const glm::vec4 lower = wrapped(n, x, y + 1) * (1 - s) + wrapped(n, x + 1, y + 1) * s;
        return upper * (1 - t) + lower * t;
    }

  private:
    [[nodiscard]] glm::vec4 wrapped(std::uint32_t n, float x, float y) const {
        const glm::ivec2 sides = size(n);
        return fetch(n, {wrapped(x, sides.x, bound_[n].wrap), wrapped(y, sides.y, bound_[n].wrap)});
    }
    [[nodiscard]] static int wrapped(float x, int size, skybark::wrap_mode mode) {
        const int i = static_cast<int>(x);
        return mode == skybark::wrap_mode::clamp ? std::clamp(i, 0, size - 1)
                                                 : (i % size + size) % size;
    }

    std::span<const skybark::sampled_image<device>> bound_;
};

/// A vertex on its way to the pixels.
template <std::size_t Varyings>
struct corner {
    glm::vec4 position{0};
    std::array<glm::vec4, Varyings> varyings{};
    std::int64_t x = 0; ///< in the image, in 1/256 pixel
    std::int64_t y = 0;

    [[nodiscard]] friend corner mix(const corner& a, const corner& b, float t) {
        corner c;
        c.position = a.position * (1 - t) + b.position * t;
        for (std::size_t i = 0; i < Varyings; ++i) {
            c.varyings[i] = a.varyings[i] * (1 - t) + b.varyings[i] * t;
        }
        return c;
    }
};

/// The part of a convex polygon in front of a plane of clip space.
template <class Corner>
[[nodiscard]] std::vector<Corner> clipped(const std::vector<Corner>& polygon, glm::vec4 plane) {
    std::vector<Corner> inside;
    const auto height = [&](const Corner& c) {
        const glm::vec4 p = c.position * plane;
        return p.x + p.y + p.z + p.w;
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner& a = polygon[i];
        const Corner& b = polygon[(i + 1) % polygon.size()];
        const float ha = height(a);
        const float hb = height(b);
        if (ha >= 0) {
            inside.push_back(a);
        }
        if ((ha >= 0) != (hb >= 0)) {
            inside.push_back(mix(a, b, ha / (ha - hb)));
        }
    }
    return inside;
}

/// 0 ≤ z ≤ w, and |x|, |y| ≤ 4 w, which keeps clear of a division by w = 0.
inline constexpr glm::vec4 clip_planes[] = {{0, 0, 1, 0},  {0, 0, -1, 1}, {1, 0, 0, 4},
                                            {-1, 0, 0, 4}, {0, 1, 0, 4},  {0, -1, 0, 4}};

/// Where a draw goes, and how.
struct canvas {
    const image* color;
    const image* depth;
    skybark::draw_state state;
    std::uint32_t width;
    std::uint32_t height;

    [[nodiscard]] bool depth_passes(std::uint32_t x, std::uint32_t y, float z) const {
        return depth == nullptr || !state.depth_test || z <= depth->load(x, y).x;
    }
    void write(std::uint32_t x, std::uint32_t y, float z, glm::vec4 value) const {
        if (depth != nullptr && state.depth_test && state.depth_write) {
            depth->store(x, y, {z, 0, 0, 0});
        }
        if (color != nullptr) {
            if (state.blend == skybark::blend_mode::alpha) {
                value += color->load(x, y) * (1 - value.w);
            }
            color->store(x, y, value);
        }
    }
};

/// Fills one triangle whose corners lie in front of the camera. `shade(varyings, pixel, front)`
/// gives the fragment.
template <class Corner, class Shade>
void fill(const canvas& to, std::array<Corner, 3> c, Shade&& shade) {
    for (Corner& corner : c) {
        const glm::vec4 p = corner.position / corner.position.w;
        corner.x = std::llround((p.x * 0.5 + 0.5) * to.width * 256.0);
        corner.y = std::llround((0.5 - p.y * 0.5) * to.height * 256.0);
    }
    const auto area = [](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by,
                         std::int64_t px,
                         std::int64_t py) { return (bx - ax) * (py - ay) - (by - ay) * (px - ax); };
    std::int64_t twice = area(c[0].x, c[0].y, c[1].x, c[1].y, c[2].x, c[2].y);
    const bool front = twice < 0; // y points down here
    if (twice == 0 || (!front && to.state.cull == skybark::cull_mode::back)) {
        return;
    }
    if (front) {
        std::swap(c[1], c[2]);
        twice = -twice;
    }
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [top, bottom] = std::minmax({c[0].y, c[1].y, c[2].y});
    const auto pixels = [](std::int64_t from, std::int64_t to_, std::uint32_t size) {
        return std::pair{
            static_cast<std::uint32_t>(std::clamp<std::int64_t>(from / 256 - 1, 0, size)),
            static_cast<std::uint32_t>(std::clamp<std::int64_t>(to_ / 256 + 2, 0, size))};
    };
    const auto [x0, x1] = pixels(left, right, to.width);
    const auto [y0, y1] = pixels(top, bottom, to.height);
    for (std::uint32_t y = y0; y < y1; ++y) {
        for (std::uint32_t x = x0; x < x1; ++x) {
            std::array<double, 3> weight{};
            bool inside = true;
            for (std::size_t i = 0; i < 3 && inside; ++i) {
                const Corner& a = c[(i + 1) % 3];
                const Corner& b = c[(i + 2) % 3];
                const std::int64_t e = area(a.x, a.y, b.x, b.y, x * 256 + 128, y * 256 + 128);
                const bool top_or_left = a.y == b.y ? b.x > a.x : b.y < a.y;
                inside = e > 0 || (e == 0 && top_or_left);
                weight[i] = static_cast<double>(e) / static_cast<double>(twice);
            }
            if (!inside) {
                continue;
            }
            double z = 0;
            double one_over_w = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                z += weight[i] * c[i].position.z / c[i].position.w;
                one_over_w += weight[i] / c[i].position.w;
            }
            if (!to.depth_passes(x, y, static_cast<float>(z))) {
                continue;
            }
            decltype(c[0].varyings) varyings{};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto share = static_cast<float>(weight[i] / c[i].position.w / one_over_w);
                for (std::size_t v = 0; v < varyings.size(); ++v) {
                    varyings[v] += c[i].varyings[v] * share;
                }
            }
            const skybark::fragment_output out =
                shade(varyings,
                      glm::vec2{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, front);
            if (out.keep) {
                to.write(x, y, static_cast<float>(z), out.color);
            }
        }
    }
}

/// Appends patterns; on this backend each is done when its call returns.
class recorder {
  public:
    explicit recorder(device& on) : device_(&on) {}

    using view = skybark::buffer_view<device>;

    void upload(const view& to, std::span<const std::byte> in) {
        (void)device_->upload(*to.buffer, to.offset, in);
    }
    void copy(const view& from, const view& to) {
        std::memmove(to.buffer->data() + to.offset, from.buffer->data() + from.offset, from.size);
    }

    template <skybark::map_kernel K>
    void map(const K& kernel, const skybark::bindings<device, K>& buffers,
             skybark::range elements) {
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t i = 0; i < elements.count; ++i) {
                kernel.map(elements.first + i, spans...);
            }
        });
    }
    template <skybark::map_kernel K>
    void map(const K& kernel, const skybark::bindings<device, K>& buffers,
             std::span<const skybark::range> ranges) {
        for (const skybark::range elements : ranges) {
            map(kernel, buffers, elements);
        }
    }
    template <skybark::map_kernel K>
    void map(const K& kernel, const skybark::bindings<device, K>& buffers,
             const skybark::counted<device>& elements) {
        map(kernel, buffers, skybark::range{0, length_of(elements)});
    }

    template <skybark::strip_kernel K>
    void expand(const K& kernel, const skybark::bindings<device, K>& buffers,
                skybark::range elements, const skybark::triangle_list<device>& out) {
        list<typename K::vertex> to{records<typename K::vertex>(out.vertices)};
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t i = 0; i < elements.count; ++i) {
                for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
                    const std::uint32_t n = kernel.triangles(elements.first + i, s, spans...);
                    std::vector<typename K::vertex> strip;
                    if (n != 0) {
                        const auto sink = [&](const auto& vertex) { strip.push_back(vertex); };
                        kernel.strip(elements.first + i, s, 0, n + 2, sink, spans...);
                    }
                    for (std::uint32_t t = 0; t < n; ++t) {
                        const std::uint32_t odd = t % 2;
                        to.add(strip[t + odd], strip[t + 1 - odd], strip[t + 2]);
                    }
                    if (out.policy == skybark::padding::degenerate) {
                        to.add_spare(kernel.strip_triangles() - n);
                    }
                }
            }
        });
        write_count(out.count, {to.written, to.required});
    }
    template <skybark::strip_kernel K>
    void expand(const K& kernel, const skybark::bindings<device, K>& buffers,
                const skybark::counted<device>& elements,
                const skybark::triangle_list<device>& out) {
        expand(kernel, buffers, skybark::range{0, length_of(elements)}, out);
    }

    template <skybark::ring_kernel K>
    void expand_rings(const K& kernel, const skybark::bindings<device, K>& buffers,
                      skybark::range elements, const view& vertices) {
        std::byte* to = vertices.buffer->data() + vertices.offset;
        const auto sink = [&](const typename K::vertex& vertex) {
            std::memcpy(to, &vertex, sizeof vertex);
            to += sizeof vertex;
        };
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t i = 0; i < elements.count; ++i) {
                kernel.ring(elements.first + i, 0, kernel.ring_vertices(), sink, spans...);
            }
        });
    }

    template <skybark::draw_kernel K>
    void draw(const K& kernel, const skybark::bindings<device, K>& buffers,
              const skybark::image_bindings<device, K>& bound,
              const skybark::draw_geometry<device>& geometry,
              const skybark::draw_target<device>& target, skybark::draw_state state) {
        const skybark::image_description what =
            (target.color != nullptr ? target.color : target.depth)->description();
        const canvas to{target.color, target.depth, state, what.width, what.height};
        clear(target, what);
        std::uint32_t count = geometry.count;
        if (geometry.length) {
            count = 3 * records<skybark::count_record>(geometry.length)[0].written;
        }
        const auto indices = records<std::uint32_t>(geometry.indices);
        with_spans<K>(buffers, [&](auto... spans) {
            const images read(bound);
            using point = corner<K::varyings>;
            const auto shade = [&](const auto& varyings, glm::vec2 pixel, bool front) {
                return kernel.fragment(varyings, pixel, front, read, spans...);
            };
            const auto vertex = [&](std::uint32_t i) {
                i += geometry.first;
                point p;
                p.position =
                    kernel.vertex((geometry.indices ? indices[i] : i) + geometry.base_vertex,
                                  p.varyings, spans...);
                return p;
            };
            for (std::uint32_t i = 0; i + 2 < count; i += 3) {
                std::vector<point> polygon{vertex(i), vertex(i + 1), vertex(i + 2)};
                for (const glm::vec4& plane : clip_planes) {
                    polygon = clipped(polygon, plane);
                }
                for (std::size_t k = 2; k < polygon.size(); ++k) {
                    fill(to, std::array{polygon[0], polygon[k - 1], polygon[k]}, shade);
                }
            }
        });
    }

  private:
    /// Triangles as far as there is room, and how many there would have been.
    template <class Vertex>
    struct list {
        std::span<Vertex> out;
        std::uint32_t written = 0;
        std::uint32_t required = 0;

        void add(const Vertex& a, const Vertex& b, const Vertex& c) {
            if (3 * (std::size_t{written} + 1) <= out.size()) {
                const std::size_t at = 3 * std::size_t{written};
                out[at] = a;
                out[at + 1] = b;
                out[at + 2] = c;
                ++written;
            }
            ++required;
        }
        void add_spare(std::uint32_t triangles) {
            Vertex zero;
            std::memset(static_cast<void*>(&zero), 0, sizeof zero);
            for (std::uint32_t i = 0; i < triangles; ++i) {
                add(zero, zero, zero);
            }
        }
    };

    template <class T>
    [[nodiscard]] static std::span<T> records(const view& view) {
        if (!view) {
            return {};
        }
        return {reinterpret_cast<T*>(view.buffer->data() + view.offset), view.size / sizeof(T)};
    }
    template <class K, class Work>
    static void with_spans(const skybark::bindings<device, K>& buffers, Work&& work) {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
            using spans = typename K::buffers::spans;
            work(std::tuple_element_t<I, spans>(
                records<std::remove_const_t<typename std::tuple_element_t<I, spans>::element_type>>(
                    buffers[I]))...);
        }
        (std::make_index_sequence<K::buffers::size>{});
    }
    [[nodiscard]] static std::uint32_t length_of(const skybark::counted<device>& elements) {
        return std::min(records<skybark::count_record>(elements.count)[0].written, elements.limit);
    }
    static void write_count(const view& to, skybark::count_record count) {
        std::memcpy(to.buffer->data() + to.offset, &count, sizeof count);
    }
    static void clear(const skybark::draw_target<device>& target, skybark::image_description what) {
        for (std::uint32_t y = 0; y < what.height; ++y) {
            for (std::uint32_t x = 0; x < what.width; ++x) {
                if (target.color != nullptr && target.clear_color) {
                    target.color->store(x, y, *target.clear_color);
                }
                if (target.depth != nullptr && target.clear_depth) {
                    target.depth->store(x, y, glm::vec4(*target.clear_depth));
                }
            }
        }
    }

    device* device_;
};

inline skybark::result<recorder> device::begin() { return own::recorder(*this); }
inline skybark::result<void> device::submit(own::recorder&) { return {}; }

} // namespace own
