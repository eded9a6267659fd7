#pragma once
// A fourth backend in one file: plain serial loops that say what the contract means.
//
// It shows what somebody who brings Skybark to another device has to write: a buffer, an image, a
// volume if it has volumes, a recorder with a member function for each pattern that the device can
// do, and the tag that promises to keep the contract. 02_own_backend.cpp proves it with the
// conformance suite.
//
// Nothing here is fast: each pattern is done when its call returns, one element after another.

#include <skybark/core/backend.hpp>
#include <skybark/shared/alpha_map.hpp>
#include <skybark/shared/bundle.hpp>

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

/// The number in 16 bits, to the nearest finite one, to the even one of two that are as near.
[[nodiscard]] inline std::uint16_t to_float16(float value) {
    const std::uint32_t sign = std::signbit(value) ? 0x8000 : 0;
    const float size = std::fabs(value);
    if (!(size < 65504.0f)) {
        return static_cast<std::uint16_t>(sign | (size == size ? 0x7bff : 0x7e00));
    }
    const int exponent = std::max(std::ilogb(size), -14);
    const auto steps = static_cast<std::uint32_t>(std::nearbyint(std::ldexp(size, 10 - exponent)));
    // A mantissa that is rounded up to the next power of two carries into the exponent.
    return static_cast<std::uint16_t>(sign |
                                      ((static_cast<std::uint32_t>(exponent + 14) << 10) + steps));
}
[[nodiscard]] inline float from_float16(std::uint16_t bits) {
    const int exponent = (bits >> 10) & 31;
    const auto mantissa = static_cast<float>(bits & 0x3ff);
    float size = 0;
    if (exponent == 31) {
        size = mantissa == 0 ? HUGE_VALF : NAN;
    } else if (exponent == 0) {
        size = std::ldexp(mantissa, -24);
    } else {
        size = std::ldexp(mantissa + 1024, exponent - 25);
    }
    return (bits & 0x8000) != 0 ? -size : size;
}

/// x runs fastest, then y, then z, without gaps.
class volume {
  public:
    explicit volume(skybark::volume_description what) : memory_(what.size_bytes()), what_(what) {}

    [[nodiscard]] skybark::volume_description description() const noexcept { return what_; }
    [[nodiscard]] const bytes& memory() const noexcept { return memory_; }
    [[nodiscard]] glm::ivec3 size() const noexcept {
        return {what_.width, what_.height, what_.depth};
    }

    [[nodiscard]] std::int32_t load_int(glm::ivec3 at) const { return read<std::int32_t>(at); }
    [[nodiscard]] float load(glm::ivec3 at) const {
        return what_.format == skybark::volume_format::float16
                   ? from_float16(read<std::uint16_t>(at))
                   : read<float>(at);
    }
    void store(glm::ivec3 at, std::int32_t value) const { write(at, value); }
    void store(glm::ivec3 at, float value) const {
        if (what_.format == skybark::volume_format::float16) {
            write(at, to_float16(value));
        } else {
            write(at, value);
        }
    }
    [[nodiscard]] float sample(glm::vec3 place) const {
        const glm::vec3 at = place * glm::vec3(size()) - 0.5f;
        const glm::vec3 low(std::floor(at.x), std::floor(at.y), std::floor(at.z));
        float sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            glm::ivec3 voxel;
            float share = 1;
            for (int k = 0; k < 3; ++k) {
                const int upper = corner >> k & 1;
                share *= upper != 0 ? at[k] - low[k] : 1 - (at[k] - low[k]);
                voxel[k] = std::clamp(static_cast<int>(low[k]) + upper, 0, size()[k] - 1);
            }
            sum += share == 0 ? 0 : share * load(voxel);
        }
        return sum;
    }

  private:
    template <class T>
    [[nodiscard]] T read(glm::ivec3 at) const {
        T value;
        std::memcpy(&value, memory_.data() + index(at) * sizeof(T), sizeof value);
        return value;
    }
    template <class T>
    void write(glm::ivec3 at, T value) const {
        std::memcpy(memory_.data() + index(at) * sizeof(T), &value, sizeof value);
    }
    [[nodiscard]] std::uint64_t index(glm::ivec3 at) const {
        const auto x = static_cast<std::uint64_t>(at.x);
        const auto y = static_cast<std::uint64_t>(at.y);
        const auto z = static_cast<std::uint64_t>(at.z);
        return (z * what_.height + y) * what_.width + x;
    }

    bytes memory_;
    skybark::volume_description what_;
};

class device {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = own::buffer;
    using image = own::image;
    using volume = own::volume;
    using recorder = own::recorder;

    [[nodiscard]] std::string_view name() const noexcept { return "own"; }
    [[nodiscard]] std::string device_name() const { return "one thread"; }
    [[nodiscard]] skybark::device_limits limits() const noexcept {
        skybark::device_limits most{std::uint64_t{1} << 40, 16, 0xffffffff, 16384};
        most.max_volume_size = 2048;
        return most;
    }
    [[nodiscard]] skybark::device_traffic traffic() const noexcept { return traffic_; }

    [[nodiscard]] skybark::result<buffer> create_buffer(std::uint64_t size) { return buffer(size); }
    [[nodiscard]] skybark::result<image> create_image(skybark::image_description what) {
        return image(what);
    }
    [[nodiscard]] skybark::result<volume> create_volume(skybark::volume_description what) {
        return volume(what);
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
    [[nodiscard]] skybark::result<void> upload(const volume& to, std::span<const std::byte> in) {
        return upload(to.memory(), 0, in);
    }
    [[nodiscard]] skybark::result<void> download(const volume& from, std::span<std::byte> out) {
        return download(from.memory(), 0, out);
    }

    [[nodiscard]] skybark::result<own::recorder> begin();
    [[nodiscard]] skybark::result<void> submit(own::recorder& recorder);

  private:
    friend class own::recorder;
    skybark::device_traffic traffic_;
};

/// What a kernel reads and writes volumes with.
class grids {
  public:
    grids(std::span<const volume* const> read, std::span<const volume* const> write)
        : read_(read), write_(write) {}

    [[nodiscard]] glm::ivec3 size(std::uint32_t n) const { return read_[n]->size(); }
    [[nodiscard]] float load(std::uint32_t n, glm::ivec3 at) const { return read_[n]->load(at); }
    [[nodiscard]] float sample(std::uint32_t n, glm::vec3 place) const {
        return read_[n]->sample(place);
    }
    void store(std::uint32_t n, glm::ivec3 at, float value) const { write_[n]->store(at, value); }

  private:
    std::span<const volume* const> read_;
    std::span<const volume* const> write_;
};

/// What a fragment function reads images and volumes with.
class images {
  public:
    images(std::span<const skybark::sampled_image<device>> bound,
           std::span<const volume* const> volumes)
        : bound_(bound), volumes_(volumes) {}

    [[nodiscard]] glm::ivec3 volume_size(std::uint32_t n) const { return volumes_[n]->size(); }
    [[nodiscard]] float volume_load(std::uint32_t n, glm::ivec3 at) const {
        return volumes_[n]->load(at);
    }
    [[nodiscard]] float volume(std::uint32_t n, glm::vec3 place) const {
        return volumes_[n]->sample(place);
    }

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
    std::span<const own::volume* const> volumes_;
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

/// Calls `visit(x, y, weights)` for each pixel whose middle a triangle covers, whichever way it
/// winds. A middle on an edge that two triangles share belongs to one of them.
template <class Corner, class Visit>
void cover(std::array<Corner, 3> c, std::uint32_t width, std::uint32_t height, Visit&& visit) {
    const auto area = [](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by,
                         std::int64_t px,
                         std::int64_t py) { return (bx - ax) * (py - ay) - (by - ay) * (px - ax); };
    const std::int64_t twice = area(c[0].x, c[0].y, c[1].x, c[1].y, c[2].x, c[2].y);
    if (twice == 0) {
        return;
    }
    const std::int64_t turn = twice < 0 ? -1 : 1;
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [top, bottom] = std::minmax({c[0].y, c[1].y, c[2].y});
    const auto pixels = [](std::int64_t from, std::int64_t to_, std::uint32_t size) {
        return std::pair{
            static_cast<std::uint32_t>(std::clamp<std::int64_t>(from / 256 - 1, 0, size)),
            static_cast<std::uint32_t>(std::clamp<std::int64_t>(to_ / 256 + 2, 0, size))};
    };
    const auto [x0, x1] = pixels(left, right, width);
    const auto [y0, y1] = pixels(top, bottom, height);
    for (std::uint32_t y = y0; y < y1; ++y) {
        for (std::uint32_t x = x0; x < x1; ++x) {
            std::array<double, 3> weight{};
            bool inside = true;
            for (std::size_t i = 0; i < 3 && inside; ++i) {
                const Corner& a = c[(i + 1) % 3];
                const Corner& b = c[(i + 2) % 3];
                const std::int64_t e =
                    turn * area(a.x, a.y, b.x, b.y, x * 256 + 128, y * 256 + 128);
                const bool top_or_left =
                    a.y == b.y ? (b.x > a.x) == (turn > 0) : (b.y < a.y) == (turn > 0);
                inside = e > 0 || (e == 0 && top_or_left);
                weight[i] = static_cast<double>(turn * e) / static_cast<double>(twice);
            }
            if (inside) {
                visit(x, y, weight);
            }
        }
    }
}

/// Fills one triangle whose corners lie in front of the camera. `shade(varyings, pixel, front)`
/// gives the fragment.
template <class Corner, class Shade>
void fill(const canvas& to, std::array<Corner, 3> c, Shade&& shade) {
    for (Corner& corner : c) {
        const glm::vec4 p = corner.position / corner.position.w;
        corner.x = std::llround((p.x * 0.5 + 0.5) * to.width * 256.0);
        corner.y = std::llround((0.5 - p.y * 0.5) * to.height * 256.0);
    }
    // y points down here.
    const bool front =
        (c[1].x - c[0].x) * (c[2].y - c[0].y) < (c[1].y - c[0].y) * (c[2].x - c[0].x);
    if (!front && to.state.cull == skybark::cull_mode::back) {
        return;
    }
    cover(c, to.width, to.height, [&](std::uint32_t x, std::uint32_t y, const auto& weight) {
        double z = 0;
        double one_over_w = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            z += weight[i] * c[i].position.z / c[i].position.w;
            one_over_w += weight[i] / c[i].position.w;
        }
        if (!to.depth_passes(x, y, static_cast<float>(z))) {
            return;
        }
        decltype(c[0].varyings) varyings{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto share = static_cast<float>(weight[i] / c[i].position.w / one_over_w);
            for (std::size_t v = 0; v < varyings.size(); ++v) {
                varyings[v] += c[i].varyings[v] * share;
            }
        }
        const glm::vec2 pixel{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        const skybark::fragment_output out = shade(varyings, pixel, front);
        if (out.keep) {
            to.write(x, y, static_cast<float>(z), out.color);
        }
    });
}

/// What one sample meets of the triangles that it is shown.
class bundle_ray {
  public:
    bundle_ray(const skybark::ray_bundle& bundle, const skybark::gather_sample& sample)
        : bundle_(bundle), from_(skybark::shared::across_bundle(
                               bundle, skybark::shared::ray_origin(bundle, sample))),
          side_(skybark::shared::side_of_bundle(bundle, sample.normal)) {}

    /// Growing numbers: the first of those that are as near stays.
    void meet(std::uint32_t number, const skybark::gather_triangle& t,
              std::span<const std::uint32_t> alpha) {
        const skybark::shared::bundle_meeting met =
            skybark::shared::meet_triangle(across(t.a), across(t.b), across(t.c), from_.x, from_.y,
                                           skybark::shared::meeting_slack(bundle_));
        const float distance =
            skybark::shared::distance_along(met, side_, from_.z, bundle_.right.w);
        if (distance >= 0 && distance < hit_.distance &&
            !(t.alpha != 0 && is_hole(alpha, t.alpha - 1, met.u, met.v))) {
            const std::uint32_t back = side_ * met.facing < 0 ? 0 : 1;
            hit_ = {distance, 2 * number + back, met.u, met.v};
        }
    }
    [[nodiscard]] const skybark::gather_hit& hit() const { return hit_; }

  private:
    [[nodiscard]] glm::vec3 across(glm::vec3 place) const {
        return skybark::shared::across_bundle(bundle_, place);
    }
    [[nodiscard]] static bool is_hole(std::span<const std::uint32_t> words, std::size_t number,
                                      float u, float v) {
        skybark::alpha_coordinates at;
        std::memcpy(static_cast<void*>(&at), words.data() + number * sizeof at / 4, sizeof at);
        const std::uint32_t width = at.size & 0xffff;
        const std::uint32_t x = skybark::shared::alpha_texel(
            skybark::shared::alpha_place(at.a.x, at.b.x, at.c.x, u, v), width);
        const std::uint32_t y = skybark::shared::alpha_texel(
            skybark::shared::alpha_place(at.a.y, at.b.y, at.c.y, u, v), at.size >> 16);
        float opacity = 0;
        std::memcpy(&opacity, words.data() + at.map + std::size_t{y} * width + x, sizeof opacity);
        return opacity < at.cutoff;
    }

    skybark::ray_bundle bundle_;
    glm::vec3 from_;
    float side_;
    skybark::gather_hit hit_;
};

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
    requires(!skybark::names_volumes<K>) void draw(const K& kernel,
                                                   const skybark::bindings<device, K>& buffers,
                                                   const skybark::image_bindings<device, K>& bound,
                                                   const skybark::draw_geometry<device>& geometry,
                                                   const skybark::draw_target<device>& target,
                                                   skybark::draw_state state) {
        draw_reading(kernel, buffers, images(bound, {}), geometry, target, state);
    }
    template <skybark::draw_kernel K>
    requires skybark::names_volumes<K>
    void draw(const K& kernel, const skybark::bindings<device, K>& buffers,
              const skybark::image_bindings<device, K>& bound,
              const skybark::volume_bindings<device, K>& volumes,
              const skybark::draw_geometry<device>& geometry,
              const skybark::draw_target<device>& target, skybark::draw_state state) {
        draw_reading(kernel, buffers, images(bound, volumes.read), geometry, target, state);
    }

    template <skybark::slab_kernel K>
    void accumulate(const K& kernel, const skybark::bindings<device, K>& buffers,
                    skybark::range elements, const skybark::accumulation<device>& to) {
        if (to.clear) {
            std::memset(to.into->memory().data(), 0, to.into->memory().size_bytes());
        }
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t i = elements.first; i - elements.first < elements.count; ++i) {
                for (std::uint32_t s = 0; s < kernel.slab_count(i, spans...); ++s) {
                    add_slab(kernel, i, kernel.slab(i, s, spans...), *to.into, spans...);
                }
            }
        });
    }
    template <skybark::slab_kernel K>
    void accumulate(const K& kernel, const skybark::bindings<device, K>& buffers,
                    const skybark::counted<device>& elements,
                    const skybark::accumulation<device>& to) {
        accumulate(kernel, buffers, skybark::range{0, length_of(elements)}, to);
    }

    /// The voxels of a line are numbered from the end where its sum begins.
    void scan(const volume& from, const volume& to, skybark::volume_scan how) {
        const glm::ivec3 size = from.size();
        const int axis = how.axis == skybark::scan_axis::none
                             ? -1
                             : static_cast<int>(how.axis) - static_cast<int>(skybark::scan_axis::x);
        glm::ivec3 lines = size;
        if (axis >= 0) {
            lines[axis] = 1;
        }
        for (int z = 0; z < lines.z; ++z) {
            for (int y = 0; y < lines.y; ++y) {
                for (int x = 0; x < lines.x; ++x) {
                    const auto voxel = [&](int i) {
                        glm::ivec3 at{x, y, z};
                        if (axis >= 0) {
                            const bool up = how.direction == skybark::scan_direction::ascending;
                            at[axis] = up ? i : size[axis] - 1 - i;
                        }
                        return at;
                    };
                    scan_line(from, to, how, voxel, axis < 0 ? 1 : size[axis]);
                }
            }
        }
    }

    void scan(const view& words, const view& total) {
        std::uint64_t sum = 0;
        for (std::uint32_t& word : records<std::uint32_t>(words)) {
            sum = std::min<std::uint64_t>(
                sum + std::exchange(word, static_cast<std::uint32_t>(sum)), 0xffffffff);
        }
        records<std::uint32_t>(total)[0] = static_cast<std::uint32_t>(sum);
    }

    /// Sorting by all 32 bits is right however few of them differ.
    void sort(const view& keys, const view& values, std::uint32_t = 32) {
        sort_first(keys, values, std::min(keys.size, values.size) / 4);
    }
    void sort(const view& keys, const view& values, const skybark::counted<device>& pairs,
              std::uint32_t = 32) {
        sort_first(keys, values, length_of(pairs));
    }

    template <skybark::grid_map_kernel K>
    void map(const K& kernel, const skybark::bindings<device, K>& buffers,
             const skybark::volume_bindings<device, K>& volumes, skybark::range elements) {
        const grids all(volumes.read, volumes.write);
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t i = 0; i < elements.count; ++i) {
                kernel.map(elements.first + i, all, spans...);
            }
        });
    }
    template <skybark::voxel_kernel K>
    void map_voxels(const K& kernel, const skybark::bindings<device, K>& buffers,
                    const skybark::volume_bindings<device, K>& volumes, glm::uvec3 extent) {
        const grids all(volumes.read, volumes.write);
        const glm::ivec3 size(extent);
        with_spans<K>(buffers, [&](auto... spans) {
            for (int z = 0; z < size.z; ++z) {
                for (int y = 0; y < size.y; ++y) {
                    for (int x = 0; x < size.x; ++x) {
                        kernel.voxel({x, y, z}, all, spans...);
                    }
                }
            }
        });
    }

    template <skybark::peel_kernel K>
    void peel(const K& kernel, const skybark::bindings<device, K>& buffers,
              skybark::range triangles, const skybark::peeled_layer<device>& layer) {
        const auto depth = records<float>(layer.depth).first(layer.width * layer.height);
        const auto triangle =
            records<std::uint32_t>(layer.triangle).first(layer.width * layer.height);
        const std::vector<float> before(depth.begin(), depth.end());
        std::fill(depth.begin(), depth.end(), 0.0f);
        std::fill(triangle.begin(), triangle.end(), skybark::no_surface);
        with_spans<K>(buffers, [&](auto... spans) {
            for (std::uint32_t t = triangles.first; t - triangles.first < triangles.count; ++t) {
                const auto keep = [&](std::uint32_t x, std::uint32_t y, float z) {
                    const std::size_t at = std::size_t{y} * layer.width + x;
                    if (z < before[at] && z > depth[at]) {
                        depth[at] = z;
                        triangle[at] = t;
                    }
                };
                peel_triangle({kernel.corner(3 * t, spans...), kernel.corner(3 * t + 1, spans...),
                               kernel.corner(3 * t + 2, spans...)},
                              layer.width, layer.height, keep);
            }
        });
        const auto left = static_cast<std::uint32_t>(
            std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; }));
        write_count(layer.count, {left, left});
    }

    void resolve(const skybark::ray_bundle& bundle, const skybark::bundle_work<device>& work) {
        const auto triangles = records<skybark::gather_triangle>(work.triangles);
        const auto samples = records<skybark::gather_sample>(work.samples);
        const auto alpha = records<std::uint32_t>(work.alpha);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            bundle_ray ray(bundle, samples[i]);
            for (std::uint32_t t = 0; t < triangles.size(); ++t) {
                ray.meet(t, triangles[t], alpha);
            }
            records<skybark::gather_hit>(work.hits)[i] = ray.hit();
        }
    }

  private:
    /// Calls `keep(x, y, z)` for each pixel whose middle the triangle covers. Row 0 is at y = −1.
    template <class Keep>
    static void peel_triangle(const std::array<glm::vec4, 3>& corners, std::uint32_t width,
                              std::uint32_t height, Keep&& keep) {
        std::vector<corner<0>> polygon;
        for (const glm::vec4& position : corners) {
            const bool is_finite =
                std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z);
            if (!is_finite) {
                return;
            }
            polygon.push_back({position, {}});
        }
        for (const glm::vec4& plane : clip_planes) {
            polygon = clipped(polygon, plane);
        }
        for (corner<0>& c : polygon) {
            c.x = std::llround((c.position.x * 0.5 + 0.5) * width * 256.0);
            c.y = std::llround((c.position.y * 0.5 + 0.5) * height * 256.0);
        }
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            const std::array c{polygon[0], polygon[k - 1], polygon[k]};
            cover(c, width, height, [&](std::uint32_t x, std::uint32_t y, const auto& weight) {
                keep(x, y,
                     static_cast<float>(weight[0] * c[0].position.z + weight[1] * c[1].position.z +
                                        weight[2] * c[2].position.z));
            });
        }
    }

    template <class K>
    void draw_reading(const K& kernel, const skybark::bindings<device, K>& buffers,
                      const images& read, const skybark::draw_geometry<device>& geometry,
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

    template <class K, class... Spans>
    static void add_slab(const K& kernel, std::uint32_t i, const skybark::voxel_slab& slab,
                         const volume& to, Spans... spans) {
        const glm::ivec3 size = to.size();
        if (slab.slice < 0 || slab.slice >= size.z) {
            return;
        }
        for (int x = std::max(slab.low.x, 0); x < std::min(slab.high.x, size.x); ++x) {
            const float lateral = kernel.lateral(i, x, slab.slice, spans...);
            for (int y = std::max(slab.low.y, 0); y < std::min(slab.high.y, size.y); ++y) {
                const glm::ivec3 at{x, y, slab.slice};
                const float row = kernel.row(i, y, spans...);
                const float above = kernel.row(i, y + 1, spans...);
                to.store(at, to.load_int(at) + kernel.amount(lateral, row, above));
            }
        }
    }

    template <class Voxel>
    static void scan_line(const volume& from, const volume& to, skybark::volume_scan how,
                          Voxel&& voxel, int count) {
        if (from.description().format == skybark::volume_format::int32) {
            std::int64_t before = 0; // twice, so that a half is whole
            for (int i = 0; i < count; ++i) {
                const std::int64_t own = from.load_int(voxel(i));
                const std::int64_t twice = before + own * halves_of(how.share);
                if (to.description().format == skybark::volume_format::int32) {
                    to.store(voxel(i), static_cast<std::int32_t>(twice / 2));
                } else {
                    to.store(voxel(i), static_cast<float>(twice) * (0.5f * how.scale));
                }
                before += 2 * own;
            }
            return;
        }
        float before = 0;
        for (int i = 0; i < count; ++i) {
            const float own = from.load(voxel(i));
            const auto share = 0.5f * static_cast<float>(halves_of(how.share));
            to.store(voxel(i), (before + own * share) * how.scale);
            before += own;
        }
    }
    [[nodiscard]] static int halves_of(skybark::scan_share share) {
        switch (share) {
        case skybark::scan_share::whole:
            return 2;
        case skybark::scan_share::half:
            return 1;
        case skybark::scan_share::none:
            break;
        }
        return 0;
    }

    static void sort_first(const view& keys, const view& values, std::uint64_t count) {
        const auto key = records<std::uint32_t>(keys);
        const auto value = records<std::uint32_t>(values);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
        for (std::uint64_t i = 0; i < count; ++i) {
            pairs.emplace_back(key[i], value[i]);
        }
        std::stable_sort(pairs.begin(), pairs.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (std::uint64_t i = 0; i < count; ++i) {
            key[i] = pairs[i].first;
            value[i] = pairs[i].second;
        }
    }

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
