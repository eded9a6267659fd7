#pragma once
// The backend contract: what an algorithm may ask of a device, and what it may rely on.
//
// A backend is a type with a buffer, an image and a recorder. A recorder appends patterns (`map`,
// `expand`, `expand_rings`, `draw`, `sort`, `scan`, and the copies between them) to a stream that
// the device runs in order: what one pattern wrote, the next one sees. Nothing waits for the host
// in between. A backend with volumes adds `accumulate`, `map_voxels`, and scans along their axes;
// one that rasterises depths adds `peel`.
//
// What holds on every backend:
//  - Order. Output comes in input order, then strip, then triangle. Two backends' results compare
//    element by element.
//  - Capacity. Nothing is written past the end of a view. `expand` fills what fits, in order and in
//    whole triangles, and reports {written, required} in a count_record on the device.
//    `expand_rings` makes the elements that fit, whole.
//  - Padding. `padding::degenerate` gives every element strips() · strip_triangles() triangles in a
//    row; those that it does not have follow, strip by strip, as triangles whose three vertices are
//    all zero bytes. `padding::compact` leaves them out.
//  - Sums. `accumulate` adds whole numbers, so that neither the order of the elements nor the
//    threads that add them change a bit; a caller keeps every sum within an int32. A `scan` of
//    whole numbers is exact as well; one of floats goes from voxel to voxel, in order.
//  - Errors. A recorder that cannot go on remembers the first error, ignores what follows, and
//    gives the error at submit. A lost device answers every call with error_code::device_lost.
//  - Misuse (a view outside its buffer, a kernel given too few images) is not an error value. It is
//    asserted; `validated<B>` checks all of it and says what is wrong.
//  - Objects. A buffer or an image must outlive the submission that uses it, and not the recorder.
//    A device must outlive what it made. Nothing here is shared between threads without a lock of
//    the caller's.

#include <skybark/core/bytes.hpp>
#include <skybark/core/kernel.hpp>
#include <skybark/core/result.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace skybark {

/// What a device can do, in the units that algorithms need to cut their work to size.
struct device_limits {
    std::uint64_t max_buffer_bytes = 0; ///< the largest view that a kernel can be given
    std::uint64_t view_alignment = 16;  ///< offsets of views are multiples of this, bytes
    std::uint64_t max_elements = 0;     ///< the longest range that one pattern call takes
    std::uint32_t max_image_size = 0;   ///< the longest side of an image, pixels
    /// Triangles that an element of a list best becomes in one pass, where an algorithm may choose:
    /// few where many elements run at once, many where passes cost more than work in order.
    std::uint32_t amplification = 4;
    std::uint32_t max_volume_size = 0; ///< the longest side of a volume, voxels; 0: no volumes
    bool filters_float32 = true;       ///< `sample` is trilinear on volume_format::float32
    /// A bit for each accumulate_route that there is.
    std::uint32_t accumulate_routes = 1;
};

/// Bytes that crossed between host and device since the device was made.
struct device_traffic {
    std::uint64_t up = 0;
    std::uint64_t down = 0;
};

/// Buffers, images and volumes that a device has made and that are still there, and their bytes;
/// not what a backend keeps to work in, nor what was wrapped. (No part of the concept: backends may
/// have it.)
struct device_usage {
    std::uint64_t objects = 0;
    std::uint64_t bytes = 0;

    void add(std::uint64_t size) noexcept {
        ++objects;
        bytes += size;
    }
    void remove(std::uint64_t size) noexcept {
        --objects;
        bytes -= size;
    }
};

enum class image_format {
    rgba8,    ///< four unsigned normalised bytes
    rgba32f,  ///< four floats
    depth32f, ///< one float: depth, and readable as the red channel afterwards
};

[[nodiscard]] constexpr std::size_t bytes_per_pixel(image_format format) noexcept {
    return format == image_format::rgba32f ? 16 : 4;
}

struct image_description {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    image_format format = image_format::rgba8;
};

enum class volume_format {
    int32,   ///< to accumulate in and to scan
    float32, ///< to scan, load, sample, and store from kernels
    float16, ///< made from the others by `scan`; to load and sample
};

[[nodiscard]] constexpr std::size_t bytes_per_voxel(volume_format format) noexcept {
    return format == volume_format::float16 ? 2 : 4;
}

/// Voxels in memory, here and in uploads and downloads: x runs fastest, then y, then z.
struct volume_description {
    std::uint32_t width = 0;  ///< along x
    std::uint32_t height = 0; ///< along y
    std::uint32_t depth = 0;  ///< along z
    volume_format format = volume_format::float32;

    [[nodiscard]] constexpr std::uint64_t size_bytes() const noexcept {
        return std::uint64_t{width} * height * depth * bytes_per_voxel(format);
    }
};

enum class padding {
    degenerate, ///< a fixed number of triangles an element, the spare ones degenerate
    compact,    ///< only the triangles that are there
};

/// A part of a buffer, as a kernel sees it. Empty when default-constructed.
template <class B>
struct buffer_view {
    const typename B::buffer* buffer = nullptr;
    std::uint64_t offset = 0; ///< bytes, a multiple of limits().view_alignment
    std::uint64_t size = 0;   ///< bytes

    [[nodiscard]] explicit operator bool() const noexcept { return buffer != nullptr; }
};

/// All of a buffer, or the records [first, first + count) of it.
template <class B>
[[nodiscard]] buffer_view<B> view(const typename B::buffer& buffer) {
    return {&buffer, 0, buffer.size_bytes()};
}
template <class B, record T>
[[nodiscard]] buffer_view<B> view(const typename B::buffer& buffer, std::uint64_t first,
                                  std::uint64_t count) {
    return {&buffer, first * sizeof(T), count * sizeof(T)};
}

/// One view for each buffer that kernel K names, in its order.
template <class B, kernel K>
using bindings = std::array<buffer_view<B>, K::buffers::size>;

/// A length that only the device knows: `written` of a count_record, at most `limit`.
template <class B>
struct counted {
    buffer_view<B> count;
    std::uint32_t limit = 0;
};

/// Where `expand` puts its triangle list: 3 · K::vertex a triangle, and one count_record.
template <class B>
struct triangle_list {
    buffer_view<B> vertices;
    buffer_view<B> count;
    padding policy = padding::compact;
};

/// How an `accumulate` reaches the voxels. Sums are the same; a backend without the route that is
/// asked for (device_limits::accumulate_routes) takes `direct`.
enum class accumulate_route {
    direct,       ///< every slab adds to its voxels: the fastest that the backend has
    tiles_copied, ///< drawn with blending into a large image, a tile a layer, then copied
    tiles_drawn,  ///< the same, but the layers are drawn from the tiles
    layers,       ///< drawn with blending straight into the layers
};
[[nodiscard]] constexpr std::uint32_t route_bit(accumulate_route route) noexcept {
    return std::uint32_t{1} << static_cast<std::uint32_t>(route);
}

/// Where `accumulate` adds: a volume of int32.
template <class B>
struct accumulation {
    const typename B::volume* into = nullptr;
    bool clear = false; ///< from zero; else to what is there
    accumulate_route route = accumulate_route::direct;
    /// With a drawn route: every element has slabs() rectangles, the spare ones degenerate, or
    /// (compact) just those that it has, from a geometry stage.
    padding policy = padding::compact;
};

enum class scan_axis { none, x, y, z }; ///< none: every voxel is a sum of its own
enum class scan_direction { ascending, descending };
enum class scan_share {
    whole, ///< a voxel's sum has its own value in it
    half,  ///< the sum up to the voxel's middle: float(before) + 0.5f · float(own)
    none,  ///< only what came before
};

/// A running sum along an axis of a volume, times `scale`, in the format of the destination.
struct volume_scan {
    scan_axis axis = scan_axis::y;
    scan_direction direction = scan_direction::descending;
    scan_share share = scan_share::whole;
    float scale = 1;
};

/// The volumes that kernel K names, in its order.
template <class B, names_volumes K>
struct volume_bindings {
    std::array<const typename B::volume*, volumes_of<K>> read{};
    std::array<const typename B::volume*, volume_targets_of<K>> write{}; ///< of float32
};

enum class blend_mode {
    none,
    /// Premultiplied: source + (1 − source alpha) · destination. What would show by less than
    /// 1/65536 behind all that is drawn after it may be left out.
    alpha,
};
enum class cull_mode { none, back }; ///< front faces wind counter-clockwise
enum class filter_mode { nearest, linear };
enum class wrap_mode { clamp, repeat };

struct draw_state {
    bool depth_test = true;  ///< nearer or equal passes; without it all do
    bool depth_write = true; ///< of what passes
    blend_mode blend = blend_mode::none;
    cull_mode cull = cull_mode::none;
};

/// An image that a draw kernel reads, and how `sample` reads it (`fetch` takes texels as they are).
template <class B>
struct sampled_image {
    const typename B::image* image = nullptr;
    filter_mode filter = filter_mode::linear;
    wrap_mode wrap = wrap_mode::clamp;
};

/// What is drawn into. Either may be absent, not both; both have the same size. Row 0 is the top.
template <class B>
struct draw_target {
    const typename B::image* color = nullptr; ///< rgba8 or rgba32f
    const typename B::image* depth = nullptr; ///< depth32f
    std::optional<glm::vec4> clear_color;     ///< before the draw; absent: keep what is there
    std::optional<float> clear_depth;
};

/// What is drawn: `count` vertices, or indices where there is an index buffer (32-bit), as
/// triangles. Where `length` is given, the device's own count of triangles replaces `count`.
template <class B>
struct draw_geometry {
    buffer_view<B> indices;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t base_vertex = 0; ///< added to each index, or to each vertex number
    buffer_view<B> length;         ///< a count_record
};

/// What `peel` takes and gives: one word a pixel, row after row, the first row at clip y = −1.
template <class B>
struct peeled_layer {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    /// Floats. Before: the depth of the layer that was peeled last, 1 where none was; a pixel that
    /// had no fragment left is 0. After: of this one, 0 where there is none.
    buffer_view<B> depth;
    /// Numbers of triangles; all bits where there is none.
    buffer_view<B> triangle;
    /// A count_record: `written` and `required` become the number of pixels that have a fragment.
    buffer_view<B> count;
};

template <class B, draw_kernel K>
using image_bindings = std::array<sampled_image<B>, K::images>;

/// A backend opts in by `using backend_tag = skybark::backend_tag`, so that modelling the concept
/// is a promise to keep the contract above and no coincidence of syntax.
struct backend_tag {};

template <class B>
concept backend = std::same_as<typename B::backend_tag, backend_tag> &&
    std::movable<typename B::buffer> && std::movable<typename B::image> &&
    std::movable<typename B::recorder> &&
    requires(B& b, const B& c, const typename B::buffer& buffer, const typename B::image& image,
             typename B::recorder& recorder, std::uint64_t bytes, std::span<const std::byte> in,
             std::span<std::byte> out) {
    { c.name() } -> std::convertible_to<std::string_view>;   // "cpu", "opengl", "vulkan", …
    { c.device_name() } -> std::convertible_to<std::string>; // what runs it, for reports
    { c.limits() } -> std::convertible_to<device_limits>;
    { c.traffic() } -> std::convertible_to<device_traffic>;
    { buffer.size_bytes() } -> std::convertible_to<std::uint64_t>;
    { image.description() } -> std::convertible_to<image_description>;
    // A new buffer holds zeros; zero bytes are allowed. A new image's content is undefined.
    { b.create_buffer(bytes) } -> std::same_as<result<typename B::buffer>>;
    { b.create_image(image_description{}) } -> std::same_as<result<typename B::image>>;
    // Upload, download: at once; they wait for what has been submitted.
    { b.upload(buffer, bytes, in) } -> std::same_as<result<void>>;
    { b.download(buffer, bytes, out) } -> std::same_as<result<void>>;
    { b.upload(image, in) } -> std::same_as<result<void>>;
    { b.download(image, out) } -> std::same_as<result<void>>;
    // begin → record → submit, which hands the work to the device and waits until it is done.
    { b.begin() } -> std::same_as<result<typename B::recorder>>;
    { b.submit(recorder) } -> std::same_as<result<void>>;
    // In the stream: new contents (copied when called), a copy between buffers, and labels
    // that debuggers show.
    {recorder.upload(buffer_view<B>{}, in)};
    {recorder.copy(buffer_view<B>{}, buffer_view<B>{})};
};

/// Each i of a range once; or of consecutive ranges, each seeing what the ones before it wrote; or
/// of a length that the device knows.
template <class B, class K>
concept maps = backend<B> && map_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b) {
    {r.map(k, b, range{})};
    {r.map(k, b, std::span<const range>{})};
    {r.map(k, b, counted<B>{})};
};

/// Each element of a range becomes an ordered run of triangles in a list.
template <class B, class K>
concept expands = backend<B> && strip_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b) {
    {r.expand(k, b, range{}, triangle_list<B>{})};
    {r.expand(k, b, counted<B>{}, triangle_list<B>{})};
};

/// Each element of a range becomes ring_vertices() vertices, element after element.
template <class B, class K>
concept expands_rings = backend<B> && ring_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b) {
    {r.expand_rings(k, b, range{}, buffer_view<B>{})};
};

template <class B, class K>
concept draws =
    backend<B> && draw_kernel<K> && !names_volumes<K> &&
    requires(typename B::recorder & r, const K& k, bindings<B, K> b, image_bindings<B, K> images) {
    {r.draw(k, b, images, draw_geometry<B>{}, draw_target<B>{}, draw_state{})};
};

/// Running sums of 32-bit words, each word's own value left out, in place; the sum of all goes to
/// the first word of `total`. Sums stop at 2^32 − 1.
template <class B>
concept scans = backend<B> &&
    requires(typename B::recorder& r, buffer_view<B> words, buffer_view<B> total) {
    {r.scan(words, total)};
};

/// Pairs of a 32-bit key and a 32-bit value, in place, by growing key; equal keys keep their order.
/// As many pairs as both views have, or the first ones, of a number that the device knows. A caller
/// who knows that keys are below 2^key_bits may say so: fewer bits take less time.
template <class B>
concept sorts = backend<B> &&
    requires(typename B::recorder& r, buffer_view<B> keys, buffer_view<B> values, counted<B> pairs,
             std::uint32_t key_bits) {
    {r.sort(keys, values)};
    {r.sort(keys, values, pairs)};
    {r.sort(keys, values, key_bits)};
    {r.sort(keys, values, pairs, key_bits)};
};

/// Volumes: 3-D images of numbers. A new volume's content is undefined. `scan` takes int32 or
/// float32 to float32 or float16 of the same size, or int32 to int32 (with scale 1, and without
/// halves); the two may not be the same volume. A float16 is the finite one that is nearest to the
/// value, the even one of two: from 65,504 on that is 65,504, and likewise below 0. So whatever is
/// summed, between two voxels there is a number.
template <class B>
concept volume_backend = backend<B> && std::movable<typename B::volume> &&
    requires(B& b, const typename B::volume& volume, typename B::recorder& r,
             std::span<const std::byte> in, std::span<std::byte> out) {
    { volume.description() } -> std::convertible_to<volume_description>;
    { b.create_volume(volume_description{}) } -> std::same_as<result<typename B::volume>>;
    { b.upload(volume, in) } -> std::same_as<result<void>>;
    { b.download(volume, out) } -> std::same_as<result<void>>;
    {r.scan(volume, volume, volume_scan{})};
};

/// Each element adds its slabs to a volume.
template <class B, class K>
concept accumulates = volume_backend<B> && slab_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b) {
    {r.accumulate(k, b, range{}, accumulation<B>{})};
    {r.accumulate(k, b, counted<B>{}, accumulation<B>{})};
};

/// A backend may do an accumulation from zero and the scan of it in one go, without the volume in
/// between: `scratch` is an int32 volume of the same size that may or may not be used. The result
/// has the same bits.
template <class B, class K>
concept fuses_accumulate_scan = accumulates<B, K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b,
             const typename B::volume& volume) {
    {r.accumulate_scan(k, b, range{}, volume, volume, volume_scan{})};
};

/// A map over records that has volumes.
template <class B, class K>
concept maps_grids = volume_backend<B> && grid_map_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b, volume_bindings<B, K> v) {
    {r.map(k, b, v, range{})};
};

/// Each voxel (x, y, z) below an extent once, in no order.
template <class B, class K>
concept maps_voxels = volume_backend<B> && voxel_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b, volume_bindings<B, K> v) {
    {r.map_voxels(k, b, v, glm::uvec3{})};
};

/// A draw whose fragments sample volumes.
template <class B, class K>
concept draws_volumes = volume_backend<B> && draw_kernel<K> && names_volumes<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b, image_bindings<B, K> images,
             volume_bindings<B, K> v) {
    {r.draw(k, b, images, v, draw_geometry<B>{}, draw_target<B>{}, draw_state{})};
};

/// The next layer of depths: of the fragments of triangles [first, first + count) at the middle of
/// each pixel that are nearer than the layer before (clip z below its depth), the farthest, and
/// whose it is: of fragments of the same depth, any. Depths are 0…1, near to far; what is beyond
/// them is not drawn; triangles have no back here. A fragment of depth 0 is not drawn either.
template <class B, class K>
concept peels = backend<B> && peel_kernel<K> &&
    requires(typename B::recorder& r, const K& k, bindings<B, K> b) {
    {r.peel(k, b, range{}, peeled_layer<B>{})};
};

/// What a bundle is resolved from and into. Triangles are numbered from the start of their view.
template <class B>
struct bundle_work {
    buffer_view<B> triangles; ///< gather_triangle
    buffer_view<B> alpha;     ///< words: alpha_coordinates and maps; empty: no holes anywhere
    buffer_view<B> samples;   ///< gather_sample
    buffer_view<B> hits;      ///< gather_hit, one a sample
};

/// A backend may resolve a bundle of rays in one go: what each sample meets first along the
/// direction, or against it where its normal points that way. gather/bundle_resolver.hpp says it in
/// full, and does it with the patterns above where this is missing. The result has the same bits.
template <class B>
concept resolves_bundles = backend<B> &&
    requires(typename B::recorder& r, const ray_bundle& bundle, const bundle_work<B>& work) {
    {r.resolve(bundle, work)};
};

/// Records with `record(recorder)`, submits and waits.
template <backend B, class Record>
[[nodiscard]] result<void> run(B& device, Record&& record) {
    auto recorder = device.begin();
    if (!recorder) {
        return failure(recorder.error());
    }
    record(*recorder);
    return device.submit(*recorder);
}

/// A buffer with these records in it.
template <backend B, record T>
[[nodiscard]] result<typename B::buffer> make_buffer(B& device, std::span<const T> records) {
    auto buffer = device.create_buffer(records.size_bytes());
    if (!buffer) {
        return buffer;
    }
    if (auto done = device.upload(*buffer, 0, std::as_bytes(records)); !done) {
        return failure(done.error());
    }
    return buffer;
}

/// `records.size()` records from the start of a buffer, or from record `first`.
template <backend B, record T>
[[nodiscard]] result<void> read_back(B& device, const typename B::buffer& buffer,
                                     std::span<T> records, std::uint64_t first = 0) {
    return device.download(buffer, first * sizeof(T), std::as_writable_bytes(records));
}

} // namespace skybark
