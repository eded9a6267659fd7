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
#include <skybark/clouds/phase.hpp>
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
    /// f of `light`: phase_function::forward_energy() for the continuum (below 1; 0 makes it the
    /// extinction), forward_value() for the product (up to 1e6), unused for extinction. `light_of`
    /// sets both.
    float forward = 0;
    float sigmas = 3; ///< standard deviations of the Gaussian in a particle's radius
    /// float16 halves the memory that is sampled. Rounding then moves A, −ln of the light, by
    /// 2^-11 |A| at most (2^-25 where |A| is below 2^-14): the light by 0.00018 of the sun's at
    /// most where A >= 0 (at A = 1), and by 2^-11 |A| of itself where the product amplifies it.
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

/// The light of droplets that scatter so, with the `forward` that belongs to it: the part of the
/// energy that goes on forward (forward_energy) for the continuum, P(0) (forward_value) for the
/// product, none for extinction.
[[nodiscard]] inline attenuation_options
light_of(const phase_function& phase, attenuation_light light = attenuation_light::continuum) {
    attenuation_options options;
    options.light = light;
    if (light == attenuation_light::continuum) {
        options.forward = static_cast<float>(phase.forward_energy());
    } else if (light == attenuation_light::product) {
        options.forward = static_cast<float>(phase.forward_value());
    }
    return options;
}

/// A backend with all that the methods of an attenuation volume need.
template <class B>
concept relights_volumes = volume_backend<B> && accumulates<B, kernels::particle_impulse> &&
    accumulates<B, kernels::shadow_slab> && expands<B, kernels::shadow_slab> &&
    accumulates<B, kernels::shadow_polygon>;

template <relights_volumes B>
class attenuation_volume {
  public:
    /// Volumes of `voxels` (each side 4 or more): one of `format` to sample, one of int32 to sum
    /// in. Errors: bad_input for options that make no sense, volumes that take more than
    /// most_bytes, and a list too short for the rectangles of a particle that fills the volume;
    /// what the device says.
    [[nodiscard]] static result<attenuation_volume>
    create(B& device, glm::uvec3 voxels, const attenuation_options& options = {}) {
        if (auto done = detail::check_voxels(voxels); !done) {
            return failure(done.error());
        }
        if (auto done = check(device, voxels, options); !done) {
            return failure(done.error());
        }
        attenuation_volume made(device, voxels, options);
        if (auto done = made.check_list(); !done) {
            return failure(done.error());
        }
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
            auto list = device.create_buffer(made.list_bytes());
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
    /// order; none is allowed: no attenuation). `box` was fitted to them, for as many voxels. The
    /// view may be longer than a kernel can be given of this device: it goes through in parts. Of
    /// particles that nobody has checked, a depth or an albedo that is no number, or below 0,
    /// counts as 0, and a larger one as the largest that `check_particles` takes.
    void relight(typename B::recorder& recorder, const buffer_view<B>& particles,
                 std::uint32_t count, const light_box& box) {
        assert((count == 0 || box.largest_radius > 0) && "a box that was fitted to no particles");
        take(box);
        if (options_.method == attenuation_method::impulse_scan) {
            sum_impulses(recorder, particles, count);
        } else if (options_.polygons == polygon_source::list) {
            sum_listed(recorder, particles, count);
            convert(recorder);
        } else {
            sum_slabs(recorder, kernels::shadow_slab{shade()}, particles, count);
            convert(recorder);
        }
    }

    /// The same for a density grid: the sum runs to the middle of each voxel. `density` is a volume
    /// of float32 or float16, of finite numbers from 0. After prepare_for_grids; `where` passes
    /// check_density_box, as it has when `box` was fitted to it.
    void relight(typename B::recorder& recorder, const typename B::volume& density,
                 const density_box& where,
                 const light_box& box) requires maps_voxels<B, kernels::grid_impulse> {
        assert(impulses_ && "prepare_for_grids comes before");
        assert(check_density_box(where) && "a density grid that cannot be lit");
        take(box);
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

    /// Makes what `relight` with a density grid needs beyond the rest: a volume of float32. From
    /// then on the light is extinction or the continuum; a grid has no particles to multiply.
    /// Errors: bad_input where all volumes would take more than most_bytes, or for the product's
    /// light; what the device says.
    [[nodiscard]] result<void> prepare_for_grids(B& device) {
        if (!impulses_) {
            if (auto done = check_light(options_, true); !done) {
                return done;
            }
            if (auto done = check_bytes(voxels_, options_, 4); !done) {
                return done;
            }
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
    /// Where the volume lies: that of the latest `relight`. Its voxel.w is the quantum of the sums,
    /// for the product a coarser one than the fit's where that could not hold them.
    [[nodiscard]] const light_box& box() const noexcept { return box_; }
    [[nodiscard]] const attenuation_options& options() const noexcept { return options_; }
    /// For the next `relight`. Errors: bad_input as from `create`, and for the product's light
    /// after prepare_for_grids; then nothing is changed.
    [[nodiscard]] result<void> set_light(attenuation_light light, float forward) {
        attenuation_options next = options_;
        next.light = light;
        next.forward = forward;
        if (auto done = check_light(next, impulses_.has_value()); !done) {
            return done;
        }
        options_ = next;
        return {};
    }

    /// The parameters that the kernels get for a box: for those who compose the patterns
    /// themselves.
    [[nodiscard]] static kernels::particle_shade shade_of(const attenuation_options& options,
                                                          const light_box& box) {
        kernels::particle_shade shade;
        shade.grid = box.grid;
        shade.grid.voxel.w = quantum_of(options, box);
        shade.sigmas = options.sigmas;
        shade.forward = options.forward;
        shade.light = static_cast<std::uint32_t>(options.light);
        shade.profile = options.profile == attenuation_profile::erf ? 1 : 0;
        // One more than fit: rounding may add one. No more than there are in a volume.
        shade.slices =
            static_cast<std::uint32_t>(std::min(2 * box.largest_radius / box.grid.voxel.z,
                                                static_cast<float>(box.voxels.z))) +
            2;
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
        if (auto done = check_bytes(voxels, options, 0); !done) {
            return done;
        }
        if (!(options.sigmas > 0 && options.sigmas <= 9) ||
            options.format == volume_format::int32) {
            return fail(error_code::bad_input,
                        "An attenuation volume was asked for with " +
                            std::to_string(options.sigmas) +
                            " standard deviations in a radius; expected above 0 to 9, and a format "
                            "of floats.");
        }
        return check_light(options, false);
    }

    /// Whether the volumes, of which some take `more` bytes a voxel, are not too large.
    [[nodiscard]] static result<void>
    check_bytes(glm::uvec3 voxels, const attenuation_options& options, std::uint64_t more) {
        // Three sides of at most 65,536 and 12 bytes: below 2^52.
        const std::uint64_t bytes = std::uint64_t{voxels.x} * voxels.y * voxels.z *
                                    (4 + bytes_per_voxel(options.format) + more);
        if (bytes > options.most_bytes) {
            return fail(error_code::bad_input,
                        "An attenuation volume of " + std::to_string(voxels.x) + " x " +
                            std::to_string(voxels.y) + " x " + std::to_string(voxels.z) +
                            " voxels takes " + std::to_string(bytes >> 20) + " MiB; at most " +
                            std::to_string(options.most_bytes >> 20) + " MiB are allowed.");
        }
        return {};
    }

    /// Without a forward part below 1 the continuum would leave nothing to scatter.
    [[nodiscard]] static result<void> check_light(const attenuation_options& options,
                                                  bool for_grids) {
        const bool continuum = options.light == attenuation_light::continuum;
        if (!(options.forward >= 0 && options.forward <= 1e6f) ||
            (continuum && !(options.forward < 1))) {
            return fail(error_code::bad_input,
                        std::string("An attenuation volume was asked for with a forward part of ")
                            .append(detail::number_text(options.forward))
                            .append("; expected 0 to below 1 for the continuum, and 0 to 1e6 for "
                                    "other light."));
        }
        if (for_grids && options.light == attenuation_light::product) {
            return fail(error_code::bad_input,
                        "The product's light was asked for of a density grid, which has no "
                        "particles to multiply; expected extinction or the continuum.");
        }
        return {};
    }

    /// As large as is allowed, in whole rectangles.
    [[nodiscard]] std::uint64_t list_bytes() const {
        return std::min(options_.list_bytes, limits_.max_buffer_bytes) / slab_bytes * slab_bytes;
    }

    /// Particles go through the list in multiples of this, so that views of them start where views
    /// may.
    [[nodiscard]] std::uint64_t list_step() const {
        return std::max<std::uint64_t>(1, limits_.view_alignment / sizeof(cloud_particle));
    }

    /// Whether the list holds the rectangles of a step of the largest particles.
    [[nodiscard]] result<void> check_list() const {
        if (options_.method != attenuation_method::shadow_polygons ||
            options_.polygons != polygon_source::list) {
            return {};
        }
        const std::uint64_t slices = std::uint64_t{voxels_.z} + 2;
        const std::uint64_t least = slab_bytes * slices * list_step();
        if (list_bytes() < least || limits_.max_elements < 2 * slices * list_step()) {
            return fail(error_code::bad_input,
                        std::string("A list of ")
                            .append(std::to_string(list_bytes()))
                            .append(" bytes was asked for, for the rectangles of a volume with ")
                            .append(std::to_string(voxels_.z))
                            .append(" layers; on this device it takes ")
                            .append(std::to_string(least))
                            .append(" at least."));
        }
        return {};
    }

    /// −ln G of a particle lies between −ln(1 + aτf) and τ, and so within τ max(1, f): what the
    /// product's sums need in place of Σ τ.
    [[nodiscard]] static float quantum_of(const attenuation_options& options,
                                          const light_box& box) {
        if (options.light != attenuation_light::product) {
            return box.grid.voxel.w;
        }
        const double deepest = double{box.deepest} * std::max(1.0, double{options.forward});
        return std::max(box.grid.voxel.w, detail::quantum_for(deepest));
    }

    void take(const light_box& box) {
        assert(box.voxels == voxels_ && "a box that was fitted for another volume");
        box_ = box;
        box_.grid.voxel.w = quantum_of(options_, box);
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
            if (count <= most_at_once()) {
                recorder.accumulate_scan(impulse, {particles}, range{0, count}, *sums_, *volume_,
                                         how);
                return;
            }
        }
        sum_slabs(recorder, impulse, particles, count);
        recorder.scan(*sums_, *volume_, how);
    }

    /// As many particles as a kernel can be given, and a view may begin after.
    [[nodiscard]] std::uint32_t most_at_once() const {
        const std::uint64_t fit = std::min({limits_.max_buffer_bytes / sizeof(cloud_particle),
                                            limits_.max_elements, std::uint64_t{1} << 31});
        return static_cast<std::uint32_t>(std::max(fit / list_step(), std::uint64_t{1}) *
                                          list_step());
    }
    [[nodiscard]] static buffer_view<B> part_of(const buffer_view<B>& particles,
                                                std::uint32_t first, std::uint32_t count) {
        buffer_view<B> part = particles;
        part.offset += std::uint64_t{first} * sizeof(cloud_particle);
        part.size = std::uint64_t{count} * sizeof(cloud_particle);
        return part;
    }

    /// Of as many particles at a time as a kernel can be given.
    template <class K>
    void sum_slabs(typename B::recorder& recorder, const K& kernel, const buffer_view<B>& particles,
                   std::uint32_t count) {
        bool first = true;
        for (std::uint32_t done = 0; done < count || first; first = false) {
            const std::uint32_t now = std::min(most_at_once(), count - done);
            const buffer_view<B> part =
                count <= most_at_once() ? particles : part_of(particles, done, now);
            recorder.accumulate(kernel, {part}, range{0, now}, into(first));
            done += now;
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
            const buffer_view<B> part = part_of(particles, done, now);
            recorder.expand(slabs, {part}, range{0, now}, {list, length, options_.policy});
            recorder.accumulate(polygons, {part, list}, counted<B>{length, 2 * slabs.slabs() * now},
                                into(first));
            first = false;
            done += now;
        }
    }

    /// As many particles as fit into the list: a step at least, by check_list.
    [[nodiscard]] std::uint32_t chunk_of(std::uint32_t slices) const {
        const std::uint64_t fit =
            std::min({list_->size_bytes() / (slab_bytes * slices),
                      limits_.max_elements / (std::uint64_t{2} * slices), std::uint64_t{1} << 23});
        return static_cast<std::uint32_t>(fit / list_step() * list_step());
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

    /// Along each axis of the light's voxel as many samples as it has voxels of the density grid,
    /// so that none is stepped over, but no more than 4: finer grids are sampled here and there.
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
