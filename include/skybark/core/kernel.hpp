#pragma once
// Kernels: what a pattern does with each element, as a value.
//
// A kernel is a trivially copyable struct. Its members are its parameters: a device backend sends
// its bytes as they are, in the layout of the block that its GLSL twin declares (32-bit scalars and
// vec4s, vec4s aligned to 16), at most `max_kernel_bytes` of them. On the CPU its member functions
// run as plain C++; a device backend finds its program by type (`opengl::program<K>`,
// `vulkan::program<K>`), made by shaders/embed.py from shaders/kernels/NAME.glsl.
//
// `using buffers = buffer_list<readonly<A>, writeonly<B>, …>` names up to eight buffers. The member
// functions take one span for each of them, in that order, after their own arguments. One buffer
// may be bound to a readonly and to a writeonly slot, if what is read and what is written are
// apart, or where nobody but the element itself reads what it writes.
//
//   map         void map(uint32 i, spans…) const
//   expand      Elements become strips of triangles, in order. `strips()` and `strip_triangles()`
//   (list)      are upper bounds for every element; `triangles(i, strip, spans…)` is the number
//   that
//               strip really has. `strip(i, strip, first, count, sink, spans…)` calls
//               `sink(vertex)` for the strip's vertices [first, first + count). Triangle t of a
//               strip is (t, t + 1, t + 2) where t is even and (t + 1, t, t + 2) where it is odd.
//   expand      Every element becomes `ring_vertices()` vertices under a shared pattern of
//   (rings)     `ring_triangles()` triangles. `ring(i, first, count, sink, spans…)` calls
//               `sink(vertex)` for vertices [first, first + count). `ring_index(k)` is the k-th of
//               3 · ring_triangles() indices into one element's vertices.
//   accumulate  Every element adds to up to `slabs()` rectangles of voxels, each in one layer of
//               constant z. `slab_count(i, spans…)` is how many it really has; `slab(i, s, spans…)`
//               is the s-th of them, and may reach beyond the volume. To the voxel (x, y, z) of it
//               goes the int32 `amount(lateral, row, above)`, which nothing else goes into: the
//               floats `lateral(i, x, z, spans…)`, made once for a column, `row(i, y, spans…)`, and
//               above = row(i, y + 1, spans…), also at a slab's last row. Where an element is
//               drawn, the slabs that it does not have are degenerate.
//   map,        A kernel that names `volumes` (≤ 4, read) and `volume_targets` (≤ 4, written) is
//   map_voxels  given them before its spans: `map(i, grids, spans…)`. With `map_voxels`,
//               `voxel(ivec3 at, grids, spans…)` runs once for every voxel of an extent.
//               `grids.size(n)`, `grids.load(n, ivec3)` (inside only), `grids.sample(n, vec3)`
//               (trilinear; 0…1 is edge to edge; clamped) read the n-th volume as a float;
//               `grids.store(n, ivec3, float)` writes the n-th target. A volume may not be both.
//   draw        `vec4 vertex(uint32 index, array<vec4, varyings>& out, spans…) const` returns the
//               clip position (x right, y up, 0 ≤ z ≤ w) and
//               `fragment_output fragment(array<vec4, varyings> const& in, vec2 pixel, bool front,
//               images, spans…) const` the colour. `images` reads the `images` bound images:
//               `images.size(n)`, `images.fetch(n, ivec2)`, `images.sample(n, vec2)`, and, where
//               the kernel names `volumes`, `images.volume_size(n)`, `images.volume_load(n, ivec3)`
//               and `images.volume(n, vec3)` as above.
//   peel        `vec4 corner(uint32 index, spans…) const` returns the clip position (as above, with
//               w = 1) of corner index % 3 of triangle index / 3.

#include <skybark/core/records.hpp>

#include <array>
#include <concepts>
#include <span>
#include <tuple>

namespace skybark {

/// 128 bytes of push constants, the least that every Vulkan device has, less the 16 that the
/// skeletons take for themselves.
inline constexpr std::size_t max_kernel_bytes = 112;
inline constexpr std::size_t max_kernel_buffers = 8;
inline constexpr std::uint32_t max_kernel_images = 8;
inline constexpr std::uint32_t max_kernel_volumes = 4;

/// A rectangle of voxels low ≤ (x, y) < high in the layer z = slice. Empty where high ≤ low.
struct voxel_slab {
    glm::ivec2 low{0, 0};
    glm::ivec2 high{0, 0};
    std::int32_t slice = 0;

    [[nodiscard]] constexpr bool operator==(const voxel_slab&) const noexcept = default;
};

template <record T>
struct readonly {
    using type = T;
    using span = std::span<const T>;
    static constexpr bool writes = false;
};

template <record T>
struct writeonly {
    using type = T;
    using span = std::span<T>;
    static constexpr bool writes = true;
};

/// The buffers that a kernel names, in binding order.
template <class... Slots>
struct buffer_list {
    static_assert(sizeof...(Slots) <= max_kernel_buffers, "a kernel names at most eight buffers");
    static constexpr std::size_t size = sizeof...(Slots);
    static constexpr std::array<bool, sizeof...(Slots)> writes{Slots::writes...};
    static constexpr std::array<std::size_t, sizeof...(Slots)> record_bytes{
        sizeof(typename Slots::type)...};
    using spans = std::tuple<typename Slots::span...>;
};

template <class T>
inline constexpr bool is_buffer_list = false;
template <class... Slots>
inline constexpr bool is_buffer_list<buffer_list<Slots...>> = true;

/// What every kernel is: a small trivially copyable value that names its buffers.
template <class K>
concept kernel = std::is_trivially_copyable_v<K> && std::is_standard_layout_v<K> &&
                 (std::is_empty_v<K> || sizeof(K) <= max_kernel_bytes) &&
                 is_buffer_list<typename K::buffers>;

/// Stands for the backend's sink when a concept asks whether a kernel can emit vertices.
template <class Vertex>
struct any_sink {
    void operator()(const Vertex&) const noexcept {}
};

/// Stands for the backend's image reader when a concept looks at a fragment function.
struct any_images {
    [[nodiscard]] glm::ivec2 size(std::uint32_t) const noexcept { return {1, 1}; }
    [[nodiscard]] glm::vec4 fetch(std::uint32_t, glm::ivec2) const noexcept { return {0, 0, 0, 0}; }
    [[nodiscard]] glm::vec4 sample(std::uint32_t, glm::vec2) const noexcept { return {0, 0, 0, 0}; }
    [[nodiscard]] glm::ivec3 volume_size(std::uint32_t) const noexcept { return {1, 1, 1}; }
    [[nodiscard]] float volume_load(std::uint32_t, glm::ivec3) const noexcept { return 0; }
    [[nodiscard]] float volume(std::uint32_t, glm::vec3) const noexcept { return 0; }
};

/// Stands for the backend's volumes when a concept looks at a map over records or voxels.
struct any_grids {
    [[nodiscard]] glm::ivec3 size(std::uint32_t) const noexcept { return {1, 1, 1}; }
    [[nodiscard]] float load(std::uint32_t, glm::ivec3) const noexcept { return 0; }
    [[nodiscard]] float sample(std::uint32_t, glm::vec3) const noexcept { return 0; }
    void store(std::uint32_t, glm::ivec3, float) const noexcept {}
};

/// What a fragment function returns: a colour, or nothing (`keep == false` discards it).
struct fragment_output {
    glm::vec4 color{0, 0, 0, 0};
    bool keep = true;
};

// The member functions that a pattern calls, asked for with one span a buffer.
template <class K, class... Slots>
concept has_map_function = requires(const K& k, std::uint32_t i, typename Slots::span... spans) {
    k.map(i, spans...);
};
template <class K, class... Slots>
concept has_strip_functions = requires(const K& k, std::uint32_t i, typename Slots::span... spans,
                                       any_sink<typename K::vertex>& sink) {
    { k.strips() } -> std::same_as<std::uint32_t>;
    { k.strip_triangles() } -> std::same_as<std::uint32_t>;
    { k.triangles(i, i, spans...) } -> std::same_as<std::uint32_t>;
    k.strip(i, i, i, i, sink, spans...);
};
template <class K, class... Slots>
concept has_ring_functions = requires(const K& k, std::uint32_t i, typename Slots::span... spans,
                                      any_sink<typename K::vertex>& sink) {
    { k.ring_vertices() } -> std::same_as<std::uint32_t>;
    { k.ring_triangles() } -> std::same_as<std::uint32_t>;
    { k.ring_index(i) } -> std::same_as<std::uint32_t>;
    k.ring(i, i, i, sink, spans...);
};
template <class K, class... Slots>
concept has_slab_functions = requires(const K& k, std::uint32_t i, std::int32_t at, float known,
                                      typename Slots::span... spans) {
    { k.slabs() } -> std::same_as<std::uint32_t>;
    { k.slab_count(i, spans...) } -> std::same_as<std::uint32_t>;
    { k.slab(i, i, spans...) } -> std::same_as<voxel_slab>;
    { k.lateral(i, at, at, spans...) } -> std::same_as<float>;
    { k.row(i, at, spans...) } -> std::same_as<float>;
    { k.amount(known, known, known) } -> std::same_as<std::int32_t>;
};
template <class K, class... Slots>
concept has_grid_map_function = requires(const K& k, std::uint32_t i, const any_grids& grids,
                                         typename Slots::span... spans) {
    k.map(i, grids, spans...);
};
template <class K, class... Slots>
concept has_voxel_function = requires(const K& k, const any_grids& grids,
                                      typename Slots::span... spans) {
    k.voxel(glm::ivec3{}, grids, spans...);
};
template <class K, class... Slots>
concept has_corner_function = requires(const K& k, std::uint32_t i, typename Slots::span... spans) {
    { k.corner(i, spans...) } -> std::same_as<glm::vec4>;
};
template <class K, class... Slots>
concept has_draw_functions = requires(const K& k, std::uint32_t i, typename Slots::span... spans,
                                      std::array<glm::vec4, K::varyings>& out,
                                      const std::array<glm::vec4, K::varyings>& in,
                                      const any_images& images) {
    { K::images } -> std::convertible_to<std::uint32_t>;
    { k.vertex(i, out, spans...) } -> std::same_as<glm::vec4>;
    { k.fragment(in, glm::vec2{}, true, images, spans...) } -> std::same_as<fragment_output>;
};

namespace detail {
template <class K, class List>
struct functions;
template <class K, class... Slots>
struct functions<K, buffer_list<Slots...>> {
    static constexpr bool map = has_map_function<K, Slots...>;
    static constexpr bool strip = has_strip_functions<K, Slots...>;
    static constexpr bool ring = has_ring_functions<K, Slots...>;
    static constexpr bool draw = has_draw_functions<K, Slots...>;
    static constexpr bool slab = has_slab_functions<K, Slots...>;
    static constexpr bool grid_map = has_grid_map_function<K, Slots...>;
    static constexpr bool voxel = has_voxel_function<K, Slots...>;
    static constexpr bool corner = has_corner_function<K, Slots...>;
};
} // namespace detail

/// Vertices are written as whole vec4s: floats one by one reach half the bandwidth.
template <class Vertex>
concept vertex_record = record<Vertex> && sizeof(Vertex) % 16 == 0;

template <class K>
concept map_kernel = kernel<K> && detail::functions<K, typename K::buffers>::map;
template <class K>
concept strip_kernel = kernel<K> && vertex_record<typename K::vertex> &&
    detail::functions<K, typename K::buffers>::strip;
template <class K>
concept ring_kernel = kernel<K> && vertex_record<typename K::vertex> &&
    detail::functions<K, typename K::buffers>::ring;
template <class K>
concept draw_kernel = kernel<K> && detail::functions<K, typename K::buffers>::draw;

template <class K>
concept peel_kernel = kernel<K> && detail::functions<K, typename K::buffers>::corner;

template <class K>
concept slab_kernel = kernel<K> && detail::functions<K, typename K::buffers>::slab;

/// How many volumes a kernel reads, and how many it writes: none unless it says so.
template <class K>
inline constexpr std::uint32_t volumes_of = [] {
    if constexpr (requires { K::volumes; }) {
        return std::uint32_t{K::volumes};
    } else {
        return std::uint32_t{0};
    }
}();
template <class K>
inline constexpr std::uint32_t volume_targets_of = [] {
    if constexpr (requires { K::volume_targets; }) {
        return std::uint32_t{K::volume_targets};
    } else {
        return std::uint32_t{0};
    }
}();
template <class K>
concept names_volumes = volumes_of<K>
+ volume_targets_of<K> != 0 &&
    volumes_of<K> <= max_kernel_volumes&& volume_targets_of<K> <= max_kernel_volumes;

/// A map over records that reads (or writes) volumes as well.
template <class K>
concept grid_map_kernel =
    kernel<K> && names_volumes<K> && detail::functions<K, typename K::buffers>::grid_map;
template <class K>
concept voxel_kernel =
    kernel<K> && names_volumes<K> && detail::functions<K, typename K::buffers>::voxel;

/// The most triangles that one element of `k` becomes.
template <strip_kernel K>
[[nodiscard]] constexpr std::uint64_t max_triangles(const K& k) {
    return std::uint64_t{k.strips()} * k.strip_triangles();
}

} // namespace skybark
