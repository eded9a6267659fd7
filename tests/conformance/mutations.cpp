// The suite is tested itself: backends that are wrong in one way must each fail the case that is
// about it, and the right one that they are made from must fail none.

#include "run_cases.hpp"

#include "../../examples/02_own_backend.hpp"

#include <numeric>

namespace {

using namespace skybark;

enum class fault {
    none,
    loses_last_triangle,
    swaps_winding,
    rounds_to_half,
    writes_past_capacity,
    ignores_padding,
    counts_only_what_fits,
    counts_spare_triangles_of_compact,
    reverses_elements,
    reverses_ranges,
    starts_levels_early,
    ignores_first_element,
    ignores_limit_of_count,
    loses_nan,
    rings_leak_into_guard,
    flips_y,
    ignores_depth,
    ignores_culling,
    ignores_blending,
    draws_twice,
    ignores_base_vertex,
    ignores_length,
    never_clears,
    always_clears,
    takes_first_image,
    ignores_wrap,
    ignores_filter,
    uploads_late,
    loses_last_slab,
    widens_slabs,
    takes_a_row_for_the_one_above,
    sums_in_16_bits,
    sums_in_floats,
    ignores_clear_of_sums,
    accumulates_late,
    accumulates_twice,
    scans_the_other_way,
    scans_whole_instead_of_half,
    scans_whole_instead_of_none,
    scans_along_x,
    ignores_scale,
    scans_in_doubles,
    scans_whole_numbers_in_floats,
    truncates_float16,
    flushes_float16,
    overflows_float16,
    words_wrap,
    words_count_themselves,
    never_writes_total,
    sorts_unstably,
    sorts_signed,
    sorts_24_bits,
    sorts_downwards,
    sorts_all,
    ignores_top_key_bit,
    samples_nearest,
    samples_a_half_off,
    repeats_samples,
    takes_first_volume,
    voxels_too_many,
    loses_last_voxel,
    peels_nearest,
    peels_again,
    peels_upside_down,
    keeps_peeled_depths,
    peels_first_triangles,
    counts_all_pixels,
    numbers_in_16_bits,
    loses_rays_against,
    fuses_edges,
    drops_last_triangle,
    stops_at_65535_triangles,
    prefers_later_triangles,
    ignores_holes,
    ignores_lift,
    swaps_sides,
};

/// A kernel whose picture stands on its head.
template <class K>
struct flipped : K {
    template <class... Spans>
    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, K::varyings>& out,
                     Spans... spans) const {
        glm::vec4 p = K::vertex(index, out, spans...);
        p.y = -p.y;
        return p;
    }
};

/// A kernel whose layers stand on their heads.
template <class K>
struct upside_down : K {
    template <class... Spans>
    glm::vec4 corner(std::uint32_t index, Spans... spans) const {
        glm::vec4 p = K::corner(index, spans...);
        p.y = -p.y;
        return p;
    }
};

/// Volumes that are not read as they should be.
template <class Grids, fault Which>
struct misread {
    const Grids& inner;

    [[nodiscard]] glm::ivec3 size(std::uint32_t n) const { return inner.size(taken(n)); }
    [[nodiscard]] float load(std::uint32_t n, glm::ivec3 at) const {
        return inner.load(taken(n), at);
    }
    [[nodiscard]] float sample(std::uint32_t n, glm::vec3 place) const {
        const glm::vec3 sides(size(n));
        if constexpr (Which == fault::samples_nearest) {
            const glm::ivec3 at(glm::floor(place * sides));
            return load(n, glm::clamp(at, glm::ivec3(0), size(n) - 1));
        } else if constexpr (Which == fault::samples_a_half_off) {
            return inner.sample(n, place + 0.5f / sides);
        } else if constexpr (Which == fault::repeats_samples) {
            return inner.sample(n, glm::fract(place));
        } else {
            return inner.sample(taken(n), place);
        }
    }
    void store(std::uint32_t n, glm::ivec3 at, float value) const { inner.store(n, at, value); }

  private:
    [[nodiscard]] static std::uint32_t taken(std::uint32_t n) {
        return Which == fault::takes_first_volume ? 0 : n;
    }
};

/// The same for a fragment.
template <class Images, fault Which>
struct misread_images {
    struct volumes {
        const Images& images;
        [[nodiscard]] glm::ivec3 size(std::uint32_t n) const { return images.volume_size(n); }
        [[nodiscard]] float load(std::uint32_t n, glm::ivec3 at) const {
            return images.volume_load(n, at);
        }
        [[nodiscard]] float sample(std::uint32_t n, glm::vec3 at) const {
            return images.volume(n, at);
        }
    };
    const Images& inner;

    [[nodiscard]] glm::ivec2 size(std::uint32_t n) const { return inner.size(n); }
    [[nodiscard]] glm::vec4 fetch(std::uint32_t n, glm::ivec2 at) const {
        return inner.fetch(n, at);
    }
    [[nodiscard]] glm::vec4 sample(std::uint32_t n, glm::vec2 at) const {
        return inner.sample(n, at);
    }
    [[nodiscard]] glm::ivec3 volume_size(std::uint32_t n) const {
        return misread<volumes, Which>{{inner}}.size(n);
    }
    [[nodiscard]] float volume_load(std::uint32_t n, glm::ivec3 at) const {
        return misread<volumes, Which>{{inner}}.load(n, at);
    }
    [[nodiscard]] float volume(std::uint32_t n, glm::vec3 place) const {
        return misread<volumes, Which>{{inner}}.sample(n, place);
    }
};

/// A kernel that misreads its volumes.
template <class K, fault Which>
struct misreading : K {
    template <class Grids, class... Spans>
    void map(std::uint32_t i, const Grids& grids, Spans... spans) const {
        K::map(i, misread<Grids, Which>{grids}, spans...);
    }
    template <class Grids, class... Spans>
    void voxel(glm::ivec3 at, const Grids& grids, Spans... spans) const {
        K::voxel(at, misread<Grids, Which>{grids}, spans...);
    }
    template <class Varyings, class Images, class... Spans>
    fragment_output fragment(const Varyings& in, glm::vec2 pixel, bool front, const Images& sources,
                             Spans... spans) const {
        return K::fragment(in, pixel, front, misread_images<Images, Which>{sources}, spans...);
    }
};

/// A kernel whose elements have one slab less than they have.
template <class K>
struct fewer_slabs : K {
    template <class... Spans>
    [[nodiscard]] std::uint32_t slab_count(std::uint32_t i, Spans... spans) const {
        const std::uint32_t count = K::slab_count(i, spans...);
        return count == 0 ? 0 : count - 1;
    }
};

/// A kernel whose slabs reach one voxel too far, where they are not empty.
template <class K>
struct wider_slabs : K {
    template <class... Spans>
    [[nodiscard]] voxel_slab slab(std::uint32_t i, std::uint32_t s, Spans... spans) const {
        voxel_slab slab = K::slab(i, s, spans...);
        slab.high.x += slab.high.x > slab.low.x ? 1 : 0;
        return slab;
    }
};

/// A kernel whose amounts take a row for the one above it as well.
template <class K>
struct level_slabs : K {
    [[nodiscard]] std::int32_t amount(float lateral, float row, float) const {
        return K::amount(lateral, row, row);
    }
};

/// What a sample meets where products and sums of edge functions round once and not twice, so that
/// an edge is not the same line in both of its triangles.
[[nodiscard]] gather_hit fused_hit(const ray_bundle& bundle, const gather_sample& sample,
                                   std::span<const gather_triangle> triangles) {
    const glm::vec3 from = shared::across_bundle(bundle, shared::ray_origin(bundle, sample));
    const float side = shared::side_of_bundle(bundle, sample.normal);
    gather_hit best;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        std::array<glm::vec3, 3> p{shared::across_bundle(bundle, triangles[t].a),
                                   shared::across_bundle(bundle, triangles[t].b),
                                   shared::across_bundle(bundle, triangles[t].c)};
        std::array<float, 3> e{};
        float area = 0;
        float depth = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 a = p[(k + 1) % 3] - from;
            const glm::vec3 b = p[(k + 2) % 3] - from;
            e[k] = std::fma(a.x, b.y, -(a.y * b.x));
            area += e[k];
            depth += e[k] * p[k].z;
        }
        const auto [low, high] = std::minmax({e[0], e[1], e[2]});
        const shared::bundle_meeting met{low >= 0 || high <= 0 ? area : 0, depth / area,
                                         e[1] / area, e[2] / area};
        const float distance = shared::distance_along(met, side, from.z, bundle.right.w);
        if (distance >= 0 && distance < best.distance) {
            best = {distance, 2 * t + (side * area < 0 ? 0 : 1), met.u, met.v};
        }
    }
    return best;
}

class mutant_recorder;

/// The serial backend of the example with one fault.
class mutant {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = own::buffer;
    using image = own::image;
    using volume = own::volume;
    using recorder = mutant_recorder;

    explicit mutant(fault which) : which_(which) {}

    [[nodiscard]] std::string_view name() const { return "mutant"; }
    [[nodiscard]] std::string device_name() const { return "one thread, one fault"; }
    [[nodiscard]] device_limits limits() const { return inner_.limits(); }
    [[nodiscard]] device_traffic traffic() const { return inner_.traffic(); }
    [[nodiscard]] result<buffer> create_buffer(std::uint64_t size) {
        return inner_.create_buffer(size);
    }
    [[nodiscard]] result<image> create_image(image_description what) {
        return inner_.create_image(what);
    }
    [[nodiscard]] result<volume> create_volume(volume_description what) {
        return inner_.create_volume(what);
    }
    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> in) {
        return inner_.upload(to, offset, in);
    }
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> out) {
        return inner_.download(from, offset, out);
    }
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> in) {
        return inner_.upload(to, in);
    }
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> out) {
        return inner_.download(from, out);
    }
    [[nodiscard]] result<void> upload(const volume& to, std::span<const std::byte> in) {
        return inner_.upload(to, in);
    }
    [[nodiscard]] result<void> download(const volume& from, std::span<std::byte> out) {
        return inner_.download(from, out);
    }
    [[nodiscard]] result<mutant_recorder> begin();
    [[nodiscard]] result<void> submit(mutant_recorder& done);

  private:
    own::device inner_;
    fault which_;
};

class mutant_recorder {
  public:
    mutant_recorder(own::device& device, fault which) : inner_(device), which_(which) {}

    using view = buffer_view<mutant>;
    using volume = own::volume;

    void upload(const view& to, std::span<const std::byte> in) {
        if (which_ == fault::uploads_late) {
            late_.emplace_back(to, std::vector(in.begin(), in.end()));
        } else {
            inner_.upload(convert(to), in);
        }
    }
    void copy(const view& from, const view& to) { inner_.copy(convert(from), convert(to)); }
    void finish() {
        for (const auto& [to, in] : late_) {
            inner_.upload(convert(to), in);
        }
        for (const auto& accumulate : late_sums_) {
            accumulate();
        }
    }

    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, range elements) {
        if (which_ == fault::ignores_first_element) {
            elements.first = 0;
        }
        inner_.map(kernel, convert(buffers), elements);
        if (which_ == fault::loses_nan) {
            without_nan(buffers.back());
        }
    }
    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, std::span<const range> ranges) {
        std::vector<range> order(ranges.begin(), ranges.end());
        if (which_ == fault::reverses_ranges) {
            std::reverse(order.begin(), order.end());
        }
        range late{};
        for (range r : order) {
            const range before = late;
            late = {};
            if (which_ == fault::starts_levels_early && r.count > 1) {
                --r.count; // the last element comes after the next range
                late = {r.first + r.count, 1};
            }
            inner_.map(kernel, convert(buffers), r);
            inner_.map(kernel, convert(buffers), before);
        }
        inner_.map(kernel, convert(buffers), late);
    }
    template <map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers, counted<mutant> elements) {
        inner_.map(kernel, convert(buffers), convert(elements));
    }

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<mutant, K>& buffers, range elements,
                triangle_list<mutant> out) {
        if (which_ == fault::ignores_padding) {
            out.policy = padding::compact;
        }
        inner_.expand(kernel, convert(buffers), elements, convert(out));
        spoil_list(out, 3 * sizeof(typename K::vertex), max_triangles(kernel) * elements.count);
    }
    template <strip_kernel K>
    void expand(const K& kernel, const bindings<mutant, K>& buffers, counted<mutant> elements,
                triangle_list<mutant> out) {
        inner_.expand(kernel, convert(buffers), convert(elements), convert(out));
        spoil_list(out, 3 * sizeof(typename K::vertex), max_triangles(kernel) * elements.limit);
    }
    template <ring_kernel K>
    void expand_rings(const K& kernel, const bindings<mutant, K>& buffers, range elements,
                      const view& vertices) {
        inner_.expand_rings(kernel, convert(buffers), elements, convert(vertices));
        std::byte* data = vertices.buffer->data() + vertices.offset;
        if (which_ == fault::rounds_to_half) {
            round_to_half(data, vertices.size);
        } else if (which_ == fault::rings_leak_into_guard && elements.count != 0) {
            data[vertices.size] = std::byte{0};
        }
    }

    template <draw_kernel K>
    void draw(const K& kernel, const bindings<mutant, K>& buffers,
              const image_bindings<mutant, K>& images, draw_geometry<mutant> geometry,
              const draw_target<mutant>& target, draw_state state) {
        image_bindings<own::device, K> bound{};
        for (std::size_t i = 0; i < images.size(); ++i) {
            bound[i] = {images[i].image, images[i].filter, images[i].wrap};
            if (which_ == fault::takes_first_image) {
                bound[i].image = images[0].image;
            } else if (which_ == fault::ignores_wrap) {
                bound[i].wrap = wrap_mode::clamp;
            } else if (which_ == fault::ignores_filter) {
                bound[i].filter = filter_mode::nearest;
            }
        }
        draw_target<own::device> to{target.color, target.depth, target.clear_color,
                                    target.clear_depth};
        if (which_ == fault::never_clears) {
            to.clear_color.reset();
        } else if (which_ == fault::always_clears && to.color != nullptr) {
            to.clear_color = to.clear_color.value_or(glm::vec4(0));
        }
        state.depth_test &= which_ != fault::ignores_depth;
        state.cull = which_ == fault::ignores_culling ? cull_mode::none : state.cull;
        state.blend = which_ == fault::ignores_blending ? blend_mode::none : state.blend;
        if (which_ == fault::ignores_length && geometry.length) {
            geometry.length = {};
            geometry.count = 6 * 64 - geometry.first;
        }
        const draw_geometry<own::device> what{
            convert(geometry.indices), geometry.first, geometry.count,
            which_ == fault::ignores_base_vertex ? 0 : geometry.base_vertex,
            convert(geometry.length)};
        if (which_ == fault::flips_y) {
            inner_.draw(flipped<K>{kernel}, convert(buffers), bound, what, to, state);
        } else {
            inner_.draw(kernel, convert(buffers), bound, what, to, state);
        }
        if (which_ == fault::draws_twice) {
            to.clear_color.reset();
            to.clear_depth.reset();
            inner_.draw(kernel, convert(buffers), bound, what, to, state);
        }
    }

    template <slab_kernel K, class Elements>
    void accumulate(const K& kernel, const bindings<mutant, K>& buffers, const Elements& elements,
                    const accumulation<mutant>& to) {
        accumulation<own::device> sums{to.into, to.clear, to.route, to.policy};
        const auto add = [this, kernel, views = convert(buffers),
                          which = convert(elements)](const accumulation<own::device>& into) {
            if (which_ == fault::loses_last_slab) {
                inner_.accumulate(fewer_slabs<K>{kernel}, views, which, into);
            } else if (which_ == fault::widens_slabs) {
                inner_.accumulate(wider_slabs<K>{kernel}, views, which, into);
            } else if (which_ == fault::takes_a_row_for_the_one_above) {
                inner_.accumulate(level_slabs<K>{kernel}, views, which, into);
            } else {
                inner_.accumulate(kernel, views, which, into);
            }
        };
        if (which_ == fault::accumulates_late) {
            late_sums_.emplace_back([add, sums] { add(sums); });
            return;
        }
        sums.clear &= which_ != fault::ignores_clear_of_sums;
        add(sums);
        if (which_ == fault::accumulates_twice) {
            sums.clear = false;
            add(sums);
        }
        conformance::each_voxel(to.into->size(), [&](glm::ivec3 at) {
            const std::int32_t sum = to.into->load_int(at);
            if (which_ == fault::sums_in_16_bits) {
                to.into->store(at, std::int32_t{static_cast<std::int16_t>(sum)});
            } else if (which_ == fault::sums_in_floats) {
                to.into->store(at, static_cast<std::int32_t>(static_cast<float>(sum)));
            }
        });
    }

    void scan(const volume& from, const volume& to, volume_scan how) {
        if (which_ == fault::scans_the_other_way) {
            const bool up = how.direction == scan_direction::ascending;
            how.direction = up ? scan_direction::descending : scan_direction::ascending;
        } else if (which_ == fault::scans_whole_instead_of_half) {
            how.share = how.share == scan_share::half ? scan_share::whole : how.share;
        } else if (which_ == fault::scans_whole_instead_of_none) {
            how.share = how.share == scan_share::none ? scan_share::whole : how.share;
        } else if (which_ == fault::scans_along_x) {
            how.axis = how.axis == scan_axis::none ? how.axis : scan_axis::x;
        } else if (which_ == fault::ignores_scale) {
            how.scale = 1;
        }
        inner_.scan(from, to, how);
        const bool is_whole = from.description().format == volume_format::int32;
        if ((which_ == fault::scans_in_doubles && !is_whole) ||
            (which_ == fault::scans_whole_numbers_in_floats && is_whole)) {
            scan_again(from, to, how);
        }
        if (to.description().format == volume_format::float16) {
            conformance::each_voxel(to.size(),
                                    [&](glm::ivec3 at) { spoil_float16(from, to, how, at); });
        }
    }

    void scan(const view& words, const view& total) {
        std::vector<std::uint32_t> in(words.size / 4);
        std::memcpy(in.data(), words.buffer->data() + words.offset, words.size);
        std::uint32_t before = 0;
        std::memcpy(&before, total.buffer->data() + total.offset, 4);
        inner_.scan(convert(words), convert(total));
        auto* const out = reinterpret_cast<std::uint32_t*>(words.buffer->data() + words.offset);
        if (which_ == fault::words_wrap) {
            std::exclusive_scan(in.begin(), in.end(), out, 0u);
        } else if (which_ == fault::words_count_themselves) {
            std::inclusive_scan(in.begin(), in.end(), out);
        } else if (which_ == fault::never_writes_total) {
            std::memcpy(total.buffer->data() + total.offset, &before, 4);
        }
    }

    void sort(const view& keys, const view& values, std::uint32_t key_bits = 32) {
        sort_first(keys, values, std::min(keys.size, values.size) / 4, key_bits);
    }
    void sort(const view& keys, const view& values, const counted<mutant>& pairs,
              std::uint32_t key_bits = 32) {
        count_record length;
        std::memcpy(&length, pairs.count.buffer->data() + pairs.count.offset, sizeof length);
        sort_first(keys, values,
                   which_ == fault::sorts_all ? std::min(keys.size, values.size) / 4
                                              : std::min(length.written, convert(pairs).limit),
                   key_bits);
    }

    template <grid_map_kernel K>
    void map(const K& kernel, const bindings<mutant, K>& buffers,
             const volume_bindings<mutant, K>& volumes, range elements) {
        with_fault(kernel, [&](const auto& wrong) {
            inner_.map(wrong, convert(buffers), {volumes.read, volumes.write}, elements);
        });
    }
    template <voxel_kernel K>
    void map_voxels(const K& kernel, const bindings<mutant, K>& buffers,
                    const volume_bindings<mutant, K>& volumes, glm::uvec3 extent) {
        const bool has_room = extent.x < volumes.write[0]->description().width;
        if (which_ == fault::voxels_too_many && has_room) {
            ++extent.x;
        } else if (which_ == fault::loses_last_voxel && extent.z != 0) {
            --extent.z;
        }
        with_fault(kernel, [&](const auto& wrong) {
            inner_.map_voxels(wrong, convert(buffers), {volumes.read, volumes.write}, extent);
        });
    }
    template <draw_kernel K>
    requires names_volumes<K>
    void draw(const K& kernel, const bindings<mutant, K>& buffers,
              const image_bindings<mutant, K>& images, const volume_bindings<mutant, K>& volumes,
              const draw_geometry<mutant>& geometry, const draw_target<mutant>& target,
              draw_state state) {
        image_bindings<own::device, K> bound{};
        for (std::size_t i = 0; i < images.size(); ++i) {
            bound[i] = {images[i].image, images[i].filter, images[i].wrap};
        }
        with_fault(kernel, [&](const auto& wrong) {
            inner_.draw(wrong, convert(buffers), bound, {volumes.read, volumes.write},
                        {convert(geometry.indices), geometry.first, geometry.count,
                         geometry.base_vertex, convert(geometry.length)},
                        {target.color, target.depth, target.clear_color, target.clear_depth},
                        state);
        });
    }

    template <peel_kernel K>
    void peel(const K& kernel, const bindings<mutant, K>& buffers, range triangles,
              const peeled_layer<mutant>& layer) {
        const peeled_layer<own::device> to{layer.width, layer.height, convert(layer.depth),
                                           convert(layer.triangle), convert(layer.count)};
        const auto depth = words_of<float>(layer.depth);
        const std::vector<float> before(depth.begin(), depth.end());
        if (which_ == fault::peels_again) {
            for (float& z : depth) {
                z = z == 0 ? 0 : std::nextafter(z, 2.0f); // what is as far passes as well
            }
        } else if (which_ == fault::peels_first_triangles) {
            triangles.first = 0;
        }
        if (which_ == fault::peels_upside_down) {
            inner_.peel(upside_down<K>{kernel}, convert(buffers), triangles, to);
        } else {
            inner_.peel(kernel, convert(buffers), triangles, to);
        }
        if (which_ == fault::peels_nearest) {
            peel_on([&] { inner_.peel(kernel, convert(buffers), triangles, to); }, layer);
        } else if (which_ == fault::keeps_peeled_depths) {
            for (std::size_t i = 0; i < depth.size(); ++i) {
                depth[i] = depth[i] == 0 ? before[i] : depth[i];
            }
        } else if (which_ == fault::numbers_in_16_bits) {
            for (std::uint32_t& number : words_of<std::uint32_t>(layer.triangle)) {
                number = number == no_surface ? number : number & 0xffff;
            }
        } else if (which_ == fault::counts_all_pixels) {
            words_of<std::uint32_t>(layer.count)[1] = layer.width * layer.height;
        }
    }

    void resolve(ray_bundle bundle, const bundle_work<mutant>& work) {
        bundle_work<own::device> to{convert(work.triangles), convert(work.alpha),
                                    convert(work.samples), convert(work.hits)};
        const auto triangles = words_of<gather_triangle>(work.triangles);
        const auto samples = words_of<gather_sample>(work.samples);
        const auto hits = words_of<gather_hit>(work.hits);
        if (which_ == fault::drops_last_triangle && !triangles.empty()) {
            to.triangles.size -= sizeof(gather_triangle);
        } else if (which_ == fault::stops_at_65535_triangles) {
            to.triangles.size = std::min(to.triangles.size, 65535 * sizeof(gather_triangle));
        } else if (which_ == fault::ignores_lift) {
            bundle.right.w = 0;
        }
        std::vector<gather_triangle> changed(triangles.begin(), triangles.end());
        if (which_ == fault::ignores_holes) {
            for (gather_triangle& t : changed) {
                t.alpha = 0;
            }
        } else if (which_ == fault::prefers_later_triangles) {
            std::reverse(changed.begin(), changed.end());
        }
        const own::bytes other(triangles.size_bytes());
        if (!changed.empty()) {
            std::memcpy(other.data(), changed.data(), triangles.size_bytes());
        }
        if (which_ == fault::ignores_holes || which_ == fault::prefers_later_triangles) {
            to.triangles = {&other, 0, triangles.size_bytes()};
        }
        inner_.resolve(bundle, to);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (which_ == fault::fuses_edges) {
                hits[i] = fused_hit(bundle, samples[i], triangles);
            } else if (which_ == fault::loses_rays_against &&
                       shared::side_of_bundle(bundle, samples[i].normal) < 0) {
                hits[i] = gather_hit{};
            } else if (which_ == fault::swaps_sides && hits[i].surface != no_surface) {
                hits[i].surface ^= 1;
            } else if (which_ == fault::prefers_later_triangles && hits[i].surface != no_surface) {
                const auto last = static_cast<std::uint32_t>(2 * triangles.size() - 2);
                hits[i].surface = last - (hits[i].surface & ~1u) + (hits[i].surface & 1);
            }
        }
    }

  private:
    template <class T>
    [[nodiscard]] static std::span<T> words_of(const view& v) {
        return {reinterpret_cast<T*>(v.buffer->data() + v.offset), v.size / sizeof(T)};
    }
    /// Peels until nothing is left, and keeps what was last.
    template <class Peel>
    static void peel_on(Peel&& peel, const peeled_layer<mutant>& layer) {
        const auto depth = words_of<float>(layer.depth);
        const auto triangle = words_of<std::uint32_t>(layer.triangle);
        std::vector<float> nearest(depth.begin(), depth.end());
        std::vector<std::uint32_t> whose(triangle.begin(), triangle.end());
        while (words_of<std::uint32_t>(layer.count)[0] != 0) {
            peel();
            for (std::size_t i = 0; i < depth.size(); ++i) {
                nearest[i] = depth[i] == 0 ? nearest[i] : depth[i];
                whose[i] = depth[i] == 0 ? whose[i] : triangle[i];
            }
        }
        std::copy(nearest.begin(), nearest.end(), depth.begin());
        std::copy(whose.begin(), whose.end(), triangle.begin());
        const auto left = nearest.size() - static_cast<std::size_t>(
                                               std::count(nearest.begin(), nearest.end(), 0.0f));
        words_of<std::uint32_t>(layer.count)[0] = static_cast<std::uint32_t>(left);
        words_of<std::uint32_t>(layer.count)[1] = static_cast<std::uint32_t>(left);
    }

    /// Calls `work` with the kernel, or with one that misreads its volumes.
    template <class K, class Work>
    void with_fault(const K& kernel, Work&& work) const {
        switch (which_) {
        case fault::samples_nearest:
            work(misreading<K, fault::samples_nearest>{kernel});
            break;
        case fault::samples_a_half_off:
            work(misreading<K, fault::samples_a_half_off>{kernel});
            break;
        case fault::repeats_samples:
            work(misreading<K, fault::repeats_samples>{kernel});
            break;
        case fault::takes_first_volume:
            work(misreading<K, fault::takes_first_volume>{kernel});
            break;
        default:
            work(kernel);
            break;
        }
    }

    /// The sums of a scan once more, in a type that rounds otherwise.
    void scan_again(const volume& from, const volume& to, const volume_scan& how) const {
        const bool is_whole = from.description().format == volume_format::int32;
        conformance::each_line(from.size(), how, [&](const std::vector<std::size_t>& line) {
            double before = 0;
            for (const std::size_t i : line) {
                const glm::ivec3 size = from.size();
                const auto voxel = static_cast<int>(i);
                const glm::ivec3 at(voxel % size.x, voxel / size.x % size.y,
                                    voxel / size.x / size.y);
                const double own = is_whole ? from.load_int(at) : double{from.load(at)};
                const double share = how.share == scan_share::whole  ? 1
                                     : how.share == scan_share::half ? 0.5
                                                                     : 0;
                const double sum = before + share * own;
                if (to.description().format == volume_format::int32) {
                    to.store(at, static_cast<std::int32_t>(sum));
                } else {
                    to.store(at, static_cast<float>(sum * double{how.scale}));
                }
                before += own;
                before = is_whole ? double{static_cast<float>(before)} : before;
            }
        });
    }
    /// Where a voxel was scanned alone, so that its number is at hand.
    void spoil_float16(const volume& from, const volume& to, const volume_scan& how,
                       glm::ivec3 at) const {
        const float stored = to.load(at);
        const bool is_alone =
            how.axis == scan_axis::none && from.description().format == volume_format::float32;
        if (which_ == fault::truncates_float16 && is_alone &&
            std::fabs(stored) > std::fabs(from.load(at) * how.scale) && how.scale == 1) {
            to.store(at, stored * 0.9995f); // to the next one, or nearly
        } else if (which_ == fault::flushes_float16 && std::fabs(stored) < 0x1p-14f) {
            to.store(at, 0.0f);
        } else if (which_ == fault::overflows_float16 && std::fabs(stored) == 65504.0f) {
            const auto infinite = static_cast<std::uint16_t>(stored > 0 ? 0x7c00 : 0xfc00);
            const int voxel = (at.z * to.size().y + at.y) * to.size().x + at.x;
            std::memcpy(to.memory().data() + 2 * voxel, &infinite, sizeof infinite);
        }
    }

    void sort_first(const view& keys, const view& values, std::uint64_t count,
                    std::uint32_t key_bits) const {
        auto* const key = reinterpret_cast<std::uint32_t*>(keys.buffer->data() + keys.offset);
        auto* const value = reinterpret_cast<std::uint32_t*>(values.buffer->data() + values.offset);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
        for (std::uint64_t i = 0; i < count; ++i) {
            pairs.emplace_back(key[i], value[i]);
        }
        if (which_ == fault::sorts_unstably) {
            std::reverse(pairs.begin(), pairs.end());
        }
        std::stable_sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) {
            return sorted_by(a.first, key_bits) < sorted_by(b.first, key_bits);
        });
        for (std::uint64_t i = 0; i < count; ++i) {
            key[i] = pairs[i].first;
            value[i] = pairs[i].second;
        }
    }
    [[nodiscard]] std::uint32_t sorted_by(std::uint32_t key, std::uint32_t key_bits) const {
        return which_ == fault::sorts_signed          ? key ^ 0x80000000u
               : which_ == fault::sorts_24_bits       ? key & 0x00ffffffu
               : which_ == fault::sorts_downwards     ? ~key
               : which_ == fault::ignores_top_key_bit ? key & ~(1u << (key_bits + 31) % 32)
                                                      : key;
    }

    [[nodiscard]] range convert(range elements) const {
        return {which_ == fault::ignores_first_element ? 0 : elements.first, elements.count};
    }
    [[nodiscard]] static buffer_view<own::device> convert(const view& v) {
        return {v.buffer, v.offset, v.size};
    }
    template <std::size_t N>
    [[nodiscard]] static std::array<buffer_view<own::device>, N>
    convert(const std::array<view, N>& views) {
        std::array<buffer_view<own::device>, N> out;
        std::transform(views.begin(), views.end(), out.begin(),
                       [](const view& v) { return convert(v); });
        return out;
    }
    [[nodiscard]] counted<own::device> convert(const counted<mutant>& c) const {
        return {convert(c.count), which_ == fault::ignores_limit_of_count ? c.limit + 1 : c.limit};
    }
    [[nodiscard]] static triangle_list<own::device> convert(const triangle_list<mutant>& t) {
        return {convert(t.vertices), convert(t.count), t.policy};
    }

    static void round_to_half(std::byte* data, std::uint64_t size) {
        for (std::uint64_t i = 0; i + 4 <= size; i += 4) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, data + i, 4);
            bits = (bits + 0x1000u) & ~0x1fffu; // 10 of the 23 bits of a mantissa
            std::memcpy(data + i, &bits, 4);
        }
    }
    static void without_nan(const view& v) {
        std::byte* data = v.buffer->data() + v.offset;
        for (std::uint64_t i = 0; i + 4 <= v.size; i += 4) {
            float value = 0;
            std::memcpy(&value, data + i, 4);
            if (std::isnan(value)) {
                std::memset(data + i, 0, 4);
            }
        }
    }
    void spoil_list(const triangle_list<mutant>& out, std::size_t bytes, std::uint64_t most) const {
        std::byte* data = out.vertices.buffer->data() + out.vertices.offset;
        count_record count;
        std::memcpy(&count, out.count.buffer->data() + out.count.offset, sizeof count);
        const std::uint32_t n = count.written;
        switch (which_) {
        case fault::loses_last_triangle:
            std::memset(data + (n == 0 ? 0 : n - 1) * bytes, 0, n == 0 ? 0 : bytes);
            break;
        case fault::swaps_winding:
            for (std::uint32_t t = 0; t < n; ++t) {
                std::swap_ranges(data + t * bytes, data + t * bytes + bytes / 3,
                                 data + t * bytes + bytes / 3);
            }
            break;
        case fault::rounds_to_half:
            round_to_half(data, n * bytes);
            break;
        case fault::writes_past_capacity:
            if (count.required > n) {
                std::memset(data + out.vertices.size, 0, 12);
            }
            break;
        case fault::counts_only_what_fits:
            count.required = n;
            break;
        case fault::counts_spare_triangles_of_compact:
            count.required = static_cast<std::uint32_t>(most);
            break;
        case fault::reverses_elements:
            for (std::uint32_t t = 0; t < n / 2; ++t) {
                std::swap_ranges(data + t * bytes, data + (t + 1) * bytes,
                                 data + (n - 1 - t) * bytes);
            }
            break;
        default:
            break;
        }
        std::memcpy(out.count.buffer->data() + out.count.offset, &count, sizeof count);
    }

    own::recorder inner_;
    fault which_;
    std::vector<std::pair<view, std::vector<std::byte>>> late_;
    std::vector<std::function<void()>> late_sums_;
};

result<mutant_recorder> mutant::begin() { return mutant_recorder(inner_, which_); }
result<void> mutant::submit(mutant_recorder& done) {
    done.finish();
    return {};
}

/// Whether a case is worth its time here: large ones find nothing that small ones don't.
[[nodiscard]] bool is_small(const std::string& name) {
    const std::string_view of_case = std::string_view(name).substr(name.find('.'));
    for (const char* large : {"groups", "huge", "range_scan", "_scan_", ".scan", "long_chain",
                              "many", "million", "same_random"}) {
        if (of_case.find(large) != std::string_view::npos) {
            return false;
        }
    }
    return true;
}

/// Those of the wanted cases that a mutant fails, and what they say.
template <class Wanted>
[[nodiscard]] std::map<std::string, std::string> failed_cases(fault which, Wanted&& wanted) {
    std::optional<mutant> device;
    return conformance::failed_cases<mutant>([&]() -> mutant& { return device.emplace(which); },
                                             wanted);
}

[[nodiscard]] std::string listed(const std::map<std::string, std::string>& failed) {
    std::string all;
    for (const auto& [name, why] : failed) {
        all += "\n  " + name;
    }
    return all.empty() ? " none" : all;
}

/// What is wrong with a backend, and the cases that must notice.
struct mutation {
    fault which;
    const char* name;
    std::vector<std::string> must_fail;
};

void PrintTo(const mutation& m, std::ostream* out) { *out << m.name; }

class mutations : public testing::TestWithParam<mutation> {};

TEST_P(mutations, fails_its_case) {
    const std::vector<std::string>& names = GetParam().must_fail;
    const auto failed = failed_cases(GetParam().which, [&](const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    });
    for (const std::string& name : names) {
        EXPECT_TRUE(failed.contains(name))
            << name
            << " should fail. What fails:" << listed(failed_cases(GetParam().which, is_small));
    }
}

TEST(mutations_of_nothing, fail_nothing) {
    const auto failed = failed_cases(fault::none, is_small);
    EXPECT_TRUE(failed.empty()) << "What failed:" << listed(failed);
}

const mutation all_mutations[] = {
    {fault::loses_last_triangle,
     "loses_last_triangle",
     {"expand.compact_one", "expand.compact_limit", "branch.volume_compact"}},
    {fault::swaps_winding,
     "swaps_winding",
     {"expand.compact_limit", "expand.degenerate_limit", "branch.volume_degenerate"}},
    {fault::rounds_to_half, "rounds_to_half", {"branch.rings_slerp", "branch.list_compact_slerp"}},
    {fault::writes_past_capacity,
     "writes_past_capacity",
     {"expand.compact_short_by_one_triangle", "expand.degenerate_short_by_one_triangle"}},
    {fault::ignores_padding, "ignores_padding", {"expand.degenerate_limit_plus_1"}},
    {fault::counts_only_what_fits,
     "counts_only_what_fits",
     {"expand.compact_short_by_one_triangle", "expand.compact_room_for_none"}},
    {fault::counts_spare_triangles_of_compact,
     "counts_spare_triangles_of_compact",
     {"expand.compact_no_triangles"}},
    {fault::reverses_elements, "reverses_elements", {"expand.compact_block"}},
    {fault::reverses_ranges, "reverses_ranges", {"map.levels_deep", "map.levels_tree"}},
    {fault::starts_levels_early, "starts_levels_early", {"map.levels_deep", "map.levels_limit"}},
    {fault::ignores_first_element,
     "ignores_first_element",
     {"map.range_part", "accumulate.direct_compact_adds"}},
    {fault::ignores_limit_of_count,
     "ignores_limit_of_count",
     {"map.counted_above_limit", "expand.compact_counted_above_limit"}},
    {fault::loses_nan, "loses_nan", {"map.nan"}},
    {fault::rings_leak_into_guard, "rings_leak_into_guard", {"rings.one", "rings.limit"}},
    {fault::flips_y, "flips_y", {"draw.orientation", "draw.shapes"}},
    {fault::ignores_depth, "ignores_depth", {"draw.depth_order"}},
    {fault::ignores_culling, "ignores_culling", {"draw.cull_back"}},
    {fault::ignores_blending, "ignores_blending", {"draw.blend_one_layer"}},
    {fault::draws_twice, "draws_twice", {"draw.shared_edges", "draw.shared_edges_on_centres"}},
    {fault::ignores_base_vertex,
     "ignores_base_vertex",
     {"draw.base_vertex", "draw.indexed_base_vertex"}},
    {fault::ignores_length, "ignores_length", {"draw.by_length", "chain.counts_go_on_compact"}},
    {fault::never_clears, "never_clears", {"draw.clear_rgba8", "draw.clear_rgba32f"}},
    {fault::always_clears, "always_clears", {"draw.keeps_what_is_there"}},
    {fault::takes_first_image, "takes_first_image", {"images.fetch_second", "images.size"}},
    {fault::ignores_wrap, "ignores_wrap", {"images.sample_rgba8_nearest_repeat"}},
    {fault::ignores_filter, "ignores_filter", {"images.sample_rgba8_linear_clamp"}},
    {fault::uploads_late, "uploads_late", {"buffers.upload_in_the_stream"}},
    {fault::loses_last_slab,
     "loses_last_slab",
     {"accumulate.direct_compact_one", "accumulate.layers_degenerate_slabs_one"}},
    {fault::widens_slabs,
     "widens_slabs",
     {"accumulate.direct_compact_limit_plus_1", "accumulate.tiles_drawn_compact_outside"}},
    {fault::takes_a_row_for_the_one_above,
     "takes_a_row_for_the_one_above",
     {"accumulate.direct_compact_one", "accumulate.layers_degenerate_limit_plus_1"}},
    {fault::sums_in_16_bits,
     "sums_in_16_bits",
     {"accumulate.direct_compact_large_sums", "accumulate.tiles_copied_compact_large_sums"}},
    {fault::sums_in_floats, "sums_in_floats", {"accumulate.direct_compact_large_sums"}},
    {fault::ignores_clear_of_sums,
     "ignores_clear_of_sums",
     {"accumulate.direct_compact_nothing", "accumulate.direct_compact_one"}},
    {fault::accumulates_late,
     "accumulates_late",
     {"accumulate.direct_compact_twice_in_one_recorder"}},
    {fault::accumulates_twice, "accumulates_twice", {"accumulate.direct_compact_adds"}},
    {fault::ignores_limit_of_count,
     "ignores_limit_of_count_of_sums_and_sorts",
     {"accumulate.direct_compact_counted_above_limit", "sort.counted_above_limit"}},
    {fault::scans_the_other_way,
     "scans_the_other_way",
     {"scan.volume_x_ascending", "scan.volume_y_descending", "scan.volume_z_descending"}},
    {fault::scans_whole_instead_of_half,
     "scans_whole_instead_of_half",
     {"scan.volume_none_ascending", "scan.volume_y_descending", "scan.volume_z_sizes"}},
    {fault::scans_whole_instead_of_none,
     "scans_whole_instead_of_none",
     {"scan.volume_none_descending", "scan.volume_x_ascending_float_order"}},
    {fault::scans_along_x,
     "scans_along_x",
     {"scan.volume_y_ascending", "scan.volume_z_ascending", "scan.volume_of_a_scan"}},
    {fault::ignores_scale, "ignores_scale", {"scan.volume_y_descending"}},
    {fault::scans_in_doubles, "scans_in_doubles", {"scan.volume_y_descending_float_order"}},
    {fault::scans_whole_numbers_in_floats,
     "scans_whole_numbers_in_floats",
     {"scan.volume_large_sums_int32"}},
    {fault::truncates_float16, "truncates_float16", {"scan.volume_rounds_to_float16"}},
    {fault::flushes_float16, "flushes_float16", {"scan.volume_rounds_to_subnormal_float16"}},
    {fault::overflows_float16,
     "overflows_float16",
     {"scan.volume_rounds_to_float16", "scan.volume_ends_of_float16"}},
    {fault::words_wrap, "words_wrap", {"scan.words_saturated"}},
    {fault::words_count_themselves,
     "words_count_themselves",
     {"scan.words_one", "scan.words_level_plus_1", "scan.words_in_a_view"}},
    {fault::never_writes_total, "never_writes_total", {"scan.words_empty", "scan.words_twice"}},
    {fault::sorts_unstably, "sorts_unstably", {"sort.equal_keys", "sort.orders_limit_plus_1"}},
    {fault::sorts_signed, "sorts_signed", {"sort.limit", "sort.bits"}},
    {fault::sorts_24_bits, "sorts_24_bits", {"sort.limit", "sort.bits"}},
    {fault::sorts_downwards, "sorts_downwards", {"sort.limit", "sort.bits"}},
    {fault::sorts_all, "sorts_all", {"sort.counted", "sort.counted_empty"}},
    {fault::ignores_top_key_bit,
     "ignores_top_key_bit",
     {"sort.bits", "sort.key_bits_1", "sort.key_bits_19", "sort.key_bits_31", "sort.key_bits_32",
      "sort.key_bits_counted"}},
    {fault::samples_nearest,
     "samples_nearest",
     {"map.grids_thousand", "map.grids_anywhere_float16", "voxels.samples_between",
      "draw.volumes_float32"}},
    {fault::samples_a_half_off,
     "samples_a_half_off",
     {"map.grids_one", "voxels.sizes", "draw.volumes_float16"}},
    {fault::repeats_samples, "repeats_samples", {"map.grids_thousand", "voxels.samples_between"}},
    {fault::takes_first_volume,
     "takes_first_volume",
     {"map.grids_one", "voxels.sizes", "draw.volumes_float32"}},
    {fault::voxels_too_many, "voxels_too_many", {"voxels.part"}},
    {fault::loses_last_voxel, "loses_last_voxel", {"voxels.sizes"}},
    {fault::peels_nearest,
     "peels_nearest",
     {"peel.planes", "peel.random", "peel.intersecting", "peel.twice_in_one_recorder"}},
    {fault::peels_again,
     "peels_again",
     {"peel.one", "peel.planes", "peel.equal_depths", "peel.limits", "peel.interleaved"}},
    {fault::peels_upside_down, "peels_upside_down", {"peel.one", "peel.planes", "peel.random"}},
    {fault::keeps_peeled_depths, "keeps_peeled_depths", {"peel.nothing", "peel.one"}},
    {fault::peels_first_triangles, "peels_first_triangles", {"peel.part"}},
    {fault::counts_all_pixels, "counts_all_pixels", {"peel.nothing", "peel.one"}},
    {fault::numbers_in_16_bits, "numbers_in_16_bits", {"peel.many"}},
    {fault::loses_rays_against,
     "loses_rays_against",
     {"resolve.fused_planes", "resolve.fused_random", "resolve.same_mesh"}},
    {fault::fuses_edges, "fuses_edges", {"resolve.fused_watertight"}},
    {fault::drops_last_triangle,
     "drops_last_triangle",
     {"resolve.fused_sizes", "resolve.fused_shared_edges"}},
    {fault::stops_at_65535_triangles, "stops_at_65535_triangles", {"resolve.fused_crowd_many"}},
    {fault::prefers_later_triangles,
     "prefers_later_triangles",
     {"resolve.fused_duplicates", "resolve.fused_shared_edges"}},
    {fault::ignores_holes, "ignores_holes", {"resolve.fused_alpha", "resolve.same_mesh"}},
    {fault::ignores_lift,
     "ignores_lift",
     {"resolve.fused_own_surface", "resolve.fused_box_corners", "resolve.same_mesh"}},
    {fault::swaps_sides,
     "swaps_sides",
     {"resolve.fused_planes", "resolve.fused_random", "resolve.fused_in_views"}},
    {fault::ignores_top_key_bit,
     "composes_of_a_sort_without_the_top_bit",
     {"resolve.composed_any_grid"}},
    {fault::sorts_downwards, "composes_of_a_sort_downwards", {"resolve.composed_random"}},
    {fault::words_count_themselves,
     "composes_of_sums_with_themselves",
     {"resolve.composed_random", "resolve.composed_sizes"}},
};

INSTANTIATE_TEST_SUITE_P(suite, mutations, testing::ValuesIn(all_mutations),
                         [](const auto& each) { return std::string(each.param.name); });

} // namespace
