#pragma once
// attenuation_volume: how much light is left at every place of a cloud and behind it, made anew
// whenever the sun or the cloud moves.
//
// Shimada, Shinya, Shiraishi, Harada 2008, "Fast Rendering of Dynamic Clouds Using GPU Shader". A
// particle between a place and the sun multiplies the sun's light by G, and a product has no order:
// the volume holds −ln of it, a sum (eq. 7, 4.2). Sums are made of whole quanta, so that neither
// the order of the particles nor the threads that add them change a bit.
//
//   impulse_scan     each particle adds to the voxels of its own body alone, and one running sum
//                    against the light spreads that downwards. Its cost does not grow with the
//                    length of the shadows.
//   shadow_polygons  the paper's way: every layer of the volume that a particle cuts gets a
//                    rectangle from the particle down to the bottom, drawn additively (3.3, 4.1).
//
// Both give the same volume. Nothing of an earlier frame is used, nothing is allocated by
// `relight`, and nothing but the particles has to come from the host.

#include <skybark/clouds/light_box.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/grid_impulse.hpp>
#include <skybark/kernels/particle_impulse.hpp>
#include <skybark/kernels/shadow_polygon.hpp>
#include <skybark/kernels/shadow_slab.hpp>

#include <cassert>
#include <optional>

namespace skybark::clouds {

enum class attenuation_method { impulse_scan, shadow_polygons };

/// How a particle's depth lies along the light.
enum class attenuation_profile {
    step, ///< the paper's: all of it from a radius above the centre; each pays for itself in full
    erf,  ///< integrated through its Gaussian body
};

/// What is summed. τ is the particle's optical depth along the line, a its albedo.
enum class attenuation_light {
    extinction, ///< τ: the optical depth
    continuum, ///< τ (1 − a f), f the part of scattered energy that goes on forward (δ-Eddington:
               ///< g²); does not depend on how the cloud is cut into particles
    product, ///< −ln(e^−τ + a τ f), f the phase function straight on, 1 over the sphere (eq. 7)
};

/// Where the rectangles of shadow_polygons come from.
enum class polygon_source {
    list,  ///< `expand` makes a list of them, `accumulate` adds it
    stage, ///< `accumulate` makes them where it draws them
};

struct attenuation_options {
    attenuation_method method = attenuation_method::impulse_scan;
    attenuation_profile profile = attenuation_profile::erf;
    attenuation_light light = attenuation_light::continuum;
    float forward = 0; ///< f of `light`
    float sigmas = 3;  ///< standard deviations of the Gaussian in a particle's radius
    /// float16 halves the memory that is sampled. Rounding then moves −ln of the light by 2^-11 of
    /// itself at most, so the light by 0.00018 (at an attenuation of 1).
    volume_format format = volume_format::float32;

    // Of shadow_polygons alone:
    padding policy = padding::compact;
    polygon_source polygons = polygon_source::list;
    accumulate_route route = accumulate_route::direct;
    std::uint64_t list_bytes = std::uint64_t{64} << 20; ///< more rectangles go through in chunks

    /// What all volumes together may take. Beside it: `list_bytes` for a list, and for drawn routes
    /// about 8 bytes a voxel (layers) or 16 (tiles), in textures that the device keeps for all its
    /// volumes and that are as large as the largest of them.
    std::uint64_t most_bytes = std::uint64_t{4} << 30;
};

/// Where a density grid lies in the world: an upright box, edge to edge.
struct density_box {
    glm::vec3 low{0};     ///< m
    glm::vec3 high{1};    ///< m
    float extinction = 1; ///< 1/m that a density of 1 means
    float albedo = 1;
};

template <volume_backend B>
requires accumulates<B, kernels::particle_impulse>
class attenuation_volume {
  public:
    /// Volumes of `voxels` (each side 4 or more): one of `format` to sample, one of int32 to sum
    /// in. Fails with bad_input where they would take more than most_bytes, and as the device does.
    [[nodiscard]] static result<attenuation_volume>
    create(B& device, glm::uvec3 voxels, const attenuation_options& options = {}) {
        if (auto done = detail::check_voxels(voxels); !done) {
            return failure(done.error());
        }
        if (auto done = check(device, voxels, options); !done) {
            return failure(done.error());
        }
        attenuation_volume made(device, voxels, options);
        auto sums = device.create_volume({voxels.x, voxels.y, voxels.z, volume_format::int32});
        if (!sums) {
            return failure(sums.error());
        }
        made.sums_.emplace(std::move(*sums));
        auto volume = device.create_volume({voxels.x, voxels.y, voxels.z, options.format});
        if (!volume) {
            return failure(volume.error());
        }
        made.volume_.emplace(std::move(*volume));
        if (options.method == attenuation_method::shadow_polygons &&
            options.polygons == polygon_source::list) {
            auto list = device.create_buffer(
                std::min(options.list_bytes, device.limits().max_buffer_bytes) / slab_bytes *
                slab_bytes);
            if (!list) {
                return failure(list.error());
            }
            made.list_.emplace(std::move(*list));
            auto count = device.create_buffer(sizeof(count_record));
            if (!count) {
                return failure(count.error());
            }
            made.count_.emplace(std::move(*count));
        }
        return made;
    }

    /// Records the whole volume for `count` particles (`cloud_particle`s on the device, in any
    /// order; none is allowed: no attenuation). `box` was fitted to them, for as many voxels.
    void relight(typename B::recorder& recorder, const buffer_view<B>& particles,
                 std::uint32_t count, const light_box& box) {
        assert_box(box);
        box_ = box;
        if (options_.method == attenuation_method::impulse_scan) {
            sum_impulses(recorder, particles, count);
        } else if (options_.polygons == polygon_source::list) {
            sum_listed(recorder, particles, count);
            convert(recorder);
        } else {
            const kernels::shadow_slab slabs{shade()};
            recorder.accumulate(slabs, {particles}, range{0, count}, into(true));
            convert(recorder);
        }
    }

    /// The same for a density grid: the sum runs to the middle of each voxel. `density` is a volume
    /// of float32 or float16.
    void relight(typename B::recorder& recorder, const typename B::volume& density,
                 const density_box& where,
                 const light_box& box) requires maps_voxels<B, kernels::grid_impulse> {
        assert_box(box);
        box_ = box;
        kernels::grid_impulse impulse;
        impulse.grid = box.grid;
        const glm::vec3 size = where.high - where.low;
        impulse.low = glm::vec4(where.low, where.extinction * kept_of(where.albedo));
        impulse.inverse = glm::vec4(1.0f / size, samples_for(density.description(), size));
        volume_bindings<B, kernels::grid_impulse> bound;
        bound.read = {&density};
        bound.write = {&*impulses_};
        recorder.map_voxels(impulse, {}, bound, box.voxels);
        volume_scan how;
        how.share = scan_share::half;
        recorder.scan(*impulses_, *volume_, how);
    }

    /// Makes what `relight` with a density grid needs beyond the rest: a volume of float32.
    [[nodiscard]] result<void> prepare_for_grids(B& device) {
        if (!impulses_) {
            auto made =
                device.create_volume({voxels_.x, voxels_.y, voxels_.z, volume_format::float32});
            if (!made) {
                return failure(made.error());
            }
            impulses_.emplace(std::move(*made));
        }
        return {};
    }

    /// −ln of the light at the middle of every voxel. Light at a place is e^−sample, at
    /// cells_of(grid, place) / voxels; above the box and beside it there is no attenuation, below
    /// it the undermost layer goes on.
    [[nodiscard]] const typename B::volume& volume() const { return *volume_; }
    /// Where the volume lies: that of the latest `relight`.
    [[nodiscard]] const light_box& box() const noexcept { return box_; }
    [[nodiscard]] const attenuation_options& options() const noexcept { return options_; }
    /// For the next `relight`.
    void set_light(attenuation_light light, float forward) {
        options_.light = light;
        options_.forward = forward;
    }

    /// The parameters that the kernels get for a box: for those who compose the patterns
    /// themselves.
    [[nodiscard]] static kernels::particle_shade shade_of(const attenuation_options& options,
                                                          const light_box& box) {
        kernels::particle_shade shade;
        shade.grid = box.grid;
        shade.sigmas = options.sigmas;
        shade.forward = options.forward;
        shade.light = static_cast<std::uint32_t>(options.light);
        shade.profile = options.profile == attenuation_profile::erf ? 1 : 0;
        // One more than fit: rounding may add one.
        shade.slices = static_cast<std::uint32_t>(2 * box.largest_radius / box.grid.voxel.z) + 2;
        return shade;
    }

  private:
    /// A rectangle of the list: two triangles of three corners.
    static constexpr std::uint64_t slab_bytes = 6 * sizeof(kernels::shadow_corner);

    attenuation_volume(B& device, glm::uvec3 voxels, const attenuation_options& options)
        : options_(options), voxels_(voxels), limits_(device.limits()) {}

    [[nodiscard]] static result<void> check(B& device, glm::uvec3 voxels,
                                            const attenuation_options& options) {
        const std::string size = std::to_string(voxels.x) + " x " + std::to_string(voxels.y) +
                                 " x " + std::to_string(voxels.z);
        const std::uint32_t longest = std::max({voxels.x, voxels.y, voxels.z});
        if (longest > device.limits().max_volume_size) {
            return fail(error_code::bad_input, "An attenuation volume of " + size +
                                                   " voxels was asked for; the sides "
                                                   "of a volume of this device end at " +
                                                   std::to_string(device.limits().max_volume_size) +
                                                   ".");
        }
        // Three sides of at most 65,536 and 8 bytes: below 2^51.
        const std::uint64_t bytes =
            std::uint64_t{voxels.x} * voxels.y * voxels.z * (4 + bytes_per_voxel(options.format));
        if (bytes > options.most_bytes) {
            return fail(error_code::bad_input,
                        "An attenuation volume of " + size + " voxels takes " +
                            std::to_string(bytes >> 20) + " MiB; at most " +
                            std::to_string(options.most_bytes >> 20) + " MiB are allowed.");
        }
        if (!(options.sigmas > 0 && options.sigmas <= 9) ||
            !(options.forward >= 0 && options.forward <= 1e6f) ||
            (options.light == attenuation_light::continuum && options.forward > 1) ||
            options.format == volume_format::int32) {
            return fail(error_code::bad_input,
                        "An attenuation volume was asked for with " +
                            std::to_string(options.sigmas) +
                            " standard deviations in a radius "
                            "and a forward part of " +
                            std::to_string(options.forward) +
                            "; expected above 0 to 9, 0 to 1 (with the product 0 to 1e6), and a "
                            "format of floats.");
        }
        return {};
    }

    void assert_box([[maybe_unused]] const light_box& box) const {
        assert(box.voxels == voxels_ && "a box that was fitted for another volume");
    }

    [[nodiscard]] kernels::particle_shade shade() const { return shade_of(options_, box_); }

    [[nodiscard]] accumulation<B> into(bool clear) const {
        return {&*sums_, clear, options_.route, options_.policy};
    }

    void sum_impulses(typename B::recorder& recorder, const buffer_view<B>& particles,
                      std::uint32_t count) {
        const kernels::particle_impulse impulse{shade()};
        volume_scan how;
        how.scale = box_.grid.voxel.w;
        if constexpr (fuses_accumulate_scan<B, kernels::particle_impulse>) {
            recorder.accumulate_scan(impulse, {particles}, range{0, count}, *sums_, *volume_, how);
        } else {
            recorder.accumulate(impulse, {particles}, range{0, count},
                                accumulation<B>{&*sums_, true});
            recorder.scan(*sums_, *volume_, how);
        }
    }

    /// Chunk by chunk: rectangles of as many particles as the list holds, then their sum.
    void sum_listed(typename B::recorder& recorder, const buffer_view<B>& particles,
                    std::uint32_t count) {
        const kernels::shadow_slab slabs{shade()};
        const kernels::shadow_polygon polygons{shade()};
        const std::uint32_t chunk = chunk_of(slabs.slabs());
        const buffer_view<B> list = view<B>(*list_);
        const buffer_view<B> length = view<B>(*count_);
        bool first = true;
        for (std::uint32_t done = 0; done < count || first;) {
            const std::uint32_t now = std::min(chunk, count - done);
            buffer_view<B> part = particles;
            part.offset += std::uint64_t{done} * sizeof(cloud_particle);
            part.size = std::uint64_t{now} * sizeof(cloud_particle);
            recorder.expand(slabs, {part}, range{0, now}, {list, length, options_.policy});
            recorder.accumulate(polygons, {part, list}, counted<B>{length, 2 * slabs.slabs() * now},
                                into(first));
            first = false;
            done += now;
        }
    }

    /// As many particles as fit into the list, so that views of them start where views may.
    [[nodiscard]] std::uint32_t chunk_of(std::uint32_t slices) const {
        const std::uint64_t step =
            std::max<std::uint64_t>(1, limits_.view_alignment / sizeof(cloud_particle));
        const std::uint64_t fit = list_->size_bytes() / (slab_bytes * slices) / step * step;
        return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
            fit, step, std::min<std::uint64_t>(limits_.max_elements / (2 * slices), 1u << 23)));
    }

    void convert(typename B::recorder& recorder) {
        volume_scan how;
        how.axis = scan_axis::none;
        how.scale = box_.grid.voxel.w;
        recorder.scan(*sums_, *volume_, how);
    }

    /// What a unit of extinction takes out of the light.
    [[nodiscard]] float kept_of(float albedo) const {
        return options_.light == attenuation_light::continuum ? 1 - albedo * options_.forward : 1;
    }

    /// So many that no voxel of the density grid is stepped over: 1 to 4.
    [[nodiscard]] float samples_for(const volume_description& density, glm::vec3 size) const {
        const glm::vec3 step = size / glm::vec3(density.width, density.height, density.depth);
        const float finest = std::min({step.x, step.y, step.z});
        const glm::vec4& v = box_.grid.voxel;
        return std::clamp(std::ceil(std::max({v.x, v.y, v.z}) / finest), 1.0f, 4.0f);
    }

    attenuation_options options_;
    glm::uvec3 voxels_;
    device_limits limits_;
    light_box box_;
    std::optional<typename B::volume> sums_;
    std::optional<typename B::volume> volume_;
    std::optional<typename B::volume> impulses_;
    std::optional<typename B::buffer> list_;
    std::optional<typename B::buffer> count_;
};

} // namespace skybark::clouds
