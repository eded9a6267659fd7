#pragma once
// final_gather: the light that arrives at points, from all directions, one direction for all points
// at a time.
//
//     auto gather = final_gather<B>::create(device, scene, samples);
//     gather->add(1024);
//     gather->read(found);      // irradiance, and its standard error
//
// Hachisuka 2005 ("High-Quality Global Illumination Rendering Using Rasterization", GPU Gems 2,
// ch. 38). Each axis is a bundle of parallel rays, resolved for all samples at once; those whose
// normal points along it look that way, the others against it. A sample's irradiance is
//
//     E = π Σ L c / Σ c,    c = |n·d|,
//
// L what it sees along d (the surface's radiance; the sky's where there is none): a mean that knows
// its own weights, so that an even sky gives π L however few the axes are. The sums are kept in
// eight replicates of randomly turned axes (bundle_axes); how far these differ says how large the
// error is, E ± t · error with Student's t of seven degrees of freedom (2.365 for 95 %).
//
// Sums are floats, added axis after axis, sample by sample: the result has the same bits for any
// number of threads, any split into calls of `add`, and for a gather that was saved and resumed.
//
// Samples that are no numbers, and those without a normal, get no light and disturb no other.
// Rays begin off the surface by the scene's lift, along the normal: that keeps them from their own
// surface, but on the very edge of a room's wall rounding decides on which side of the next wall a
// sample is. Samples that stand on corners of the scene belong a little inside of their triangle.

#include <skybark/core/backend.hpp>
#include <skybark/gather/bundle_peeler.hpp>
#include <skybark/gather/bundle_resolver.hpp>
#include <skybark/gather/directions.hpp>
#include <skybark/gather/gathered_state.hpp>
#include <skybark/gather/scene.hpp>
#include <skybark/kernels/directional_light.hpp>
#include <skybark/kernels/gather_light.hpp>
#include <skybark/kernels/gather_sun.hpp>
#include <skybark/kernels/gathered_harmonics.hpp>
#include <skybark/kernels/gathered_irradiance.hpp>
#include <skybark/shared/irradiance_grid.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace skybark::gather {

/// What the sky sends from where a unit vector points to, W/(m² sr). Empty: nothing.
using sky_radiance = std::function<glm::vec3(glm::vec3)>;

[[nodiscard]] inline sky_radiance even_sky(glm::vec3 radiance) {
    return [radiance](glm::vec3) { return radiance; };
}

enum class gather_method {
    resolve, ///< bundle_resolver: exact
    peel,    ///< bundle_peeler: the paper's layers, for comparison
};

struct final_gather_options {
    std::uint64_t seed = 1;   ///< of the axes
    bool directional = false; ///< also keeps what read_directional gives: 48 bytes a sample
    sky_radiance sky;
    gather_method method = gather_method::resolve;
    resolver_options resolver;
    peeler_options peeler; ///< of gather_method::peel
    /// Axes that one submission takes: many where a submission costs, few to keep a screen alive.
    std::uint32_t axes_a_submission = 16;
    std::uint64_t most_bytes = std::uint64_t{16} << 30; ///< of device memory, counted beforehand
};

/// What arrives from the half space above a sample, as real spherical harmonics up to l = 1, in the
/// scene's axes: in each colour the coefficients c_m = ∫ L Y_m of Y_0 = 0.282095, and of 0.488603
/// times y, z and x, in that order, W/m². They hold the irradiance nearly (of a clamped cosine they
/// miss l ≥ 2): `irradiance`.
struct directional_irradiance {
    glm::vec4 red{0};
    glm::vec4 green{0};
    glm::vec4 blue{0};

    /// Of a surface with this unit normal: π Y_0 c_0 + 2π/3 Σ Y_m c_m.
    [[nodiscard]] glm::vec3 irradiance(glm::vec3 normal) const {
        return {shared::irradiance_of_color(red, normal),
                shared::irradiance_of_color(green, normal),
                shared::irradiance_of_color(blue, normal)};
    }
};
static_assert(sizeof(directional_irradiance) == 48);

/// How a gather that was to go on to an error ended.
struct gather_progress {
    std::uint64_t axes = 0;
    double error = 0;     ///< W/m², as rms_error says
    bool reached = false; ///< whether that is as small as was asked for
};

template <class B>
concept gathers = resolves_composed<B> && maps<B, kernels::patch_samples> &&
    maps<B, kernels::surface_light> && maps<B, kernels::gather_light> &&
    maps<B, kernels::directional_light> && maps<B, kernels::gather_sun> &&
    maps<B, kernels::gathered_harmonics> && maps<B, kernels::gathered_irradiance>;

namespace detail {

/// Stands for the peeler of a backend that can't peel.
struct no_peeler {};
template <class B>
struct peeler_of {
    using type = no_peeler;
};
template <resolves_peeled B>
struct peeler_of<B> {
    using type = bundle_peeler<B>;
};

} // namespace detail

template <gathers B>
class final_gather {
  public:
    static constexpr std::uint32_t replicates = bundle_axes::replicates;

    /// Bytes of device memory that `create` takes for so many samples: given as a span (`own`), or
    /// in a buffer of the caller's.
    [[nodiscard]] static std::uint64_t required_bytes(const B& device, std::uint64_t samples,
                                                      std::uint64_t triangles,
                                                      const final_gather_options& options = {},
                                                      bool own = true) {
        const std::uint64_t part = std::min(samples, part_size(device));
        const std::uint64_t each = (own ? sizeof(gather_sample) : 0) + sum_bytes + light_bytes +
                                   (options.directional ? moment_bytes : 0);
        std::uint64_t method = bundle_resolver<B>::required_bytes(triangles, options.resolver);
        if constexpr (resolves_peeled<B>) {
            if (options.method == gather_method::peel) {
                method += bundle_peeler<B>::required_bytes(options.peeler);
            }
        }
        return samples * each + part * (sizeof(gather_hit) + light_bytes) + zero_bytes(part) +
               method;
    }

    /// Of light at `samples`. The device and the scene must outlive what is made. Errors:
    /// out_of_memory where more than options.most_bytes would be needed, or what the device has.
    [[nodiscard]] static result<final_gather> create(B& device, const gather_scene<B>& scene,
                                                     std::span<const gather_sample> samples,
                                                     const final_gather_options& options = {}) {
        auto made = start(device, scene, samples.size(), options, true);
        if (!made) {
            return made;
        }
        for (part& p : made->parts_) {
            auto buffer = make_buffer<B>(device, samples.subspan(p.first, p.count));
            if (!buffer) {
                return failure(buffer.error());
            }
            p.own.emplace(std::move(*buffer));
        }
        return made;
    }

    /// The same for samples in a buffer, which must outlive it and may change on the device, for
    /// scenes that move. The view is a whole number of gather_samples.
    [[nodiscard]] static result<final_gather> create(B& device, const gather_scene<B>& scene,
                                                     const buffer_view<B>& samples,
                                                     const final_gather_options& options = {}) {
        auto made = start(device, scene, samples.size / sizeof(gather_sample), options, false);
        if (made) {
            made->samples_ = samples;
        }
        return made;
    }

    /// Goes on by so many axes. After an error the light is undefined until `restart`.
    [[nodiscard]] result<void> add(std::uint64_t axes) {
        if (options_.method == gather_method::peel) {
            return add_peeled(axes);
        }
        while (axes > 0) {
            const std::uint64_t some =
                std::min<std::uint64_t>(axes, std::max(options_.axes_a_submission, 1u));
            if (auto done = run(*device_, [&](auto& recorder) { record(recorder, some); }); !done) {
                return done;
            }
            axes -= some;
        }
        return {};
    }

    /// The same in a recording of the caller's. Not with gather_method::peel, whose layers only the
    /// host can count.
    void record(typename B::recorder& recorder, std::uint64_t axes) {
        assert(options_.method == gather_method::resolve && "layers are peeled by `add`");
        for (std::uint64_t i = 0; i < axes; ++i) {
            const ray_bundle bundle = next_bundle();
            resolver_.record_triangles(recorder, bundle, scene_->triangles());
            for (const part& p : parts_) {
                const bundle_work<B> work = work_of(p);
                resolver_.record_samples(recorder, bundle, work);
                record_light(recorder, p, work, bundle);
            }
            ++axes_;
        }
    }

    /// Adds the light of a distant source, such as the sun: `irradiance` across its beam, W/m²,
    /// wherever nothing stands in its way. It is no part of read_directional.
    [[nodiscard]] result<void> light_from(glm::vec3 towards, glm::vec3 irradiance) {
        return run(*device_,
                   [&](auto& recorder) { record_light_from(recorder, towards, irradiance); });
    }
    /// `arriving` may hold, in the y of a vec4 a sample, the part of the beam that gets to the
    /// scene at all, as kernels::light_at_points finds it under clouds. Absent: all of it.
    void record_light_from(typename B::recorder& recorder, glm::vec3 towards, glm::vec3 irradiance,
                           const buffer_view<B>& arriving = {}) {
        const ray_bundle bundle = resolver_.bundle(scene_->box(), towards, scene_->lift());
        resolver_.record_triangles(recorder, bundle, scene_->triangles());
        kernels::gather_sun sun;
        sun.direction = bundle.direction;
        sun.irradiance = glm::vec4(irradiance, 0);
        sun.dimmed = arriving ? 1 : 0;
        for (const part& p : parts_) {
            const bundle_work<B> work = work_of(p);
            resolver_.record_samples(recorder, bundle, work);
            const auto direct = view<B>(*p.direct);
            const auto here = arriving ? part_of(arriving, p, light_bytes) : direct;
            recorder.map(sun, {work.samples, work.hits, here, direct, direct}, range{0, p.count});
        }
    }

    /// Forgets all light, and begins again with the axes of this seed.
    [[nodiscard]] result<void> restart(std::uint64_t seed) {
        return run(*device_, [&](auto& recorder) { record_restart(recorder, seed); });
    }
    void record_restart(typename B::recorder& recorder, std::uint64_t seed) {
        options_.seed = seed;
        directions_ = bundle_axes(seed);
        axes_ = 0;
        for (const part& p : parts_) {
            record_zeros(recorder, *p.sums);
            record_zeros(recorder, *p.direct);
            if (p.moments) {
                record_zeros(recorder, *p.moments);
            }
        }
    }

    /// Irradiance, W/m², and in w the standard error of its luminance: a vec4 a sample, into a
    /// buffer of the caller's. Where nothing has been gathered the error is 1e30.
    void record_irradiance(typename B::recorder& recorder, const buffer_view<B>& into) const {
        for (const part& p : parts_) {
            record_found(recorder, p, part_of(into, p, light_bytes));
        }
    }

    /// The same for the host: `found` has a vec4 a sample.
    [[nodiscard]] result<void> read(std::span<glm::vec4> found) {
        assert(found.size() == samples() && "one vec4 a sample");
        for (const part& p : parts_) {
            const auto some = found.subspan(p.first, p.count);
            if (auto done = read_part(p, some); !done) {
                return done;
            }
            if (axes_ != 0) {
                for (glm::vec4& f : some) {
                    f.w = f.w < unknown ? f.w : 0; // no normal: no light, and that is known
                }
            }
        }
        return {};
    }

    /// What arrives by direction, a directional_irradiance a sample, into a buffer of the caller's.
    /// Only with options().directional.
    void record_directional(typename B::recorder& recorder, const buffer_view<B>& into) const {
        assert(options_.directional && "final_gather_options::directional");
        const kernels::gathered_harmonics harmonics{solid_angle()};
        for (const part& p : parts_) {
            recorder.map(harmonics, {view<B>(*p.moments), part_of(into, p, moment_bytes)},
                         range{0, p.count});
        }
    }
    /// The same for the host: `found` has one a sample.
    [[nodiscard]] result<void> read_directional(std::span<directional_irradiance> found) {
        assert(options_.directional && "final_gather_options::directional");
        assert(found.size() == samples() && "one a sample");
        for (const part& p : parts_) {
            const auto some = found.subspan(p.first, p.count);
            if (auto done = read_back<B, directional_irradiance>(*device_, *p.moments, some);
                !done) {
                return done;
            }
            for (directional_irradiance& f : some) {
                f.red = shared::harmonics_of(f.red, solid_angle());
                f.green = shared::harmonics_of(f.green, solid_angle());
                f.blue = shared::harmonics_of(f.blue, solid_angle());
            }
        }
        return {};
    }

    /// Of all samples that gather: the root mean square of their standard errors, W/m². 1e30 before
    /// the first axis.
    [[nodiscard]] result<double> rms_error() {
        std::vector<glm::vec4> found;
        double squares = 0;
        std::uint64_t known = 0;
        for (const part& p : parts_) {
            found.resize(p.count);
            if (auto done = read_part(p, found); !done) {
                return failure(done.error());
            }
            for (const glm::vec4& f : found) {
                if (f.w < unknown) {
                    squares += static_cast<double>(f.w) * static_cast<double>(f.w);
                    ++known;
                }
            }
        }
        if (known == 0) {
            return axes_ == 0 && samples() != 0 ? static_cast<double>(unknown) : 0.0;
        }
        return std::sqrt(squares / static_cast<double>(known));
    }

    /// Goes on until rms_error() ≤ `error` (W/m²), or to `most` axes in all. It looks when there
    /// are `least_axes`, and whenever a fifth more has been added: fewer than eight axes a
    /// replicate may all miss a small light and agree on nothing.
    [[nodiscard]] result<gather_progress> add_until(double error, std::uint64_t most) {
        for (;;) {
            gather_progress now{axes_, 0, false};
            if (axes_ >= std::min(least_axes, most)) {
                const auto found = rms_error();
                if (!found) {
                    return failure(found.error());
                }
                now.error = *found;
                now.reached = axes_ >= least_axes && *found <= error;
                if (now.reached || axes_ >= most) {
                    return now;
                }
            }
            const std::uint64_t fifth = axes_ / (5 * replicates) * replicates;
            const std::uint64_t next =
                std::max(least_axes, axes_ + std::max<std::uint64_t>(fifth, replicates));
            if (auto done = add(std::min(next, most) - axes_); !done) {
                return failure(done.error());
            }
        }
    }
    static constexpr std::uint64_t least_axes = std::uint64_t{8} * replicates;

    /// All that has been gathered, to go on with later: 192 bytes a sample with `directional`, 144
    /// without. To be read on machines of the same byte order, by any backend.
    [[nodiscard]] result<std::vector<std::byte>> save() {
        auto header = describe();
        if (!header) {
            return failure(header.error());
        }
        std::vector<std::byte> bytes(sizeof(*header) + header->content_bytes(replicates));
        const auto content = std::span(bytes).subspan(sizeof(*header));
        auto done = for_each_run(content, [&](const auto& buffer, std::uint64_t at, auto run) {
            return device_->download(buffer, at, run);
        });
        if (!done) {
            return failure(done.error());
        }
        detail::fingerprint found;
        found.add(content);
        header->content = found.value();
        std::memcpy(bytes.data(), &*header, sizeof(*header));
        return bytes;
    }

    /// Goes on where a gather of the same scene, samples and options was saved, with its seed.
    /// Errors: bad_input where these are others, or the bytes are not whole; nothing changes then.
    [[nodiscard]] result<void> resume(std::span<const std::byte> bytes) {
        const auto mine = describe();
        if (!mine) {
            return failure(mine.error());
        }
        const auto header = detail::read_header(bytes, *mine, replicates);
        if (!header) {
            return failure(header.error());
        }
        auto done = for_each_run(bytes.subspan(sizeof(*header)),
                                 [&](const auto& buffer, std::uint64_t at, auto run) {
                                     return device_->upload(buffer, at, run);
                                 });
        if (done) {
            options_.seed = header->seed;
            directions_ = bundle_axes(header->seed);
            axes_ = header->axes;
        }
        return done;
    }

    [[nodiscard]] std::uint64_t axes() const noexcept { return axes_; }
    [[nodiscard]] std::uint64_t samples() const noexcept { return count_; }
    [[nodiscard]] const final_gather_options& options() const noexcept { return options_; }

  private:
    static constexpr std::uint64_t light_bytes = sizeof(glm::vec4);
    static constexpr std::uint64_t sum_bytes = replicates * light_bytes;
    static constexpr std::uint64_t moment_bytes = 3 * light_bytes;
    static constexpr float unknown = 1e30f;

    /// Samples are cut to what one view holds.
    struct part {
        std::uint64_t first = 0;
        std::uint32_t count = 0;
        std::optional<typename B::buffer>
            own; ///< samples, where no buffer of the caller's has them
        std::optional<typename B::buffer> sums;    ///< replicate after replicate
        std::optional<typename B::buffer> direct;  ///< of distant sources
        std::optional<typename B::buffer> moments; ///< only where directional
    };

    [[nodiscard]] static std::uint64_t part_size(const B& device) {
        const device_limits limits = device.limits();
        const std::uint64_t most = std::min(
            {limits.max_buffer_bytes / sum_bytes, limits.max_elements, std::uint64_t{1} << 28});
        return std::max<std::uint64_t>(most / 64, 1) * 64;
    }
    [[nodiscard]] static std::uint64_t zero_bytes(std::uint64_t part) {
        return std::min(part * sum_bytes, std::uint64_t{1} << 20);
    }

    final_gather(B& device, const gather_scene<B>& scene, std::uint64_t samples,
                 const final_gather_options& options, bundle_resolver<B>&& resolver)
        : device_(&device), scene_(&scene), count_(samples), options_(options),
          directions_(options.seed), resolver_(std::move(resolver)) {}

    [[nodiscard]] static result<final_gather> start(B& device, const gather_scene<B>& scene,
                                                    std::uint64_t samples,
                                                    const final_gather_options& options, bool own) {
        const std::uint64_t bytes =
            required_bytes(device, samples, scene.triangle_count(), options, own);
        if (bytes > options.most_bytes) {
            return fail(error_code::out_of_memory,
                        "Light at " + std::to_string(samples) + " samples takes " +
                            std::to_string(bytes) + " bytes of device memory; at most " +
                            std::to_string(options.most_bytes) + " are allowed.");
        }
        auto resolver =
            bundle_resolver<B>::create(device, scene.triangle_count(), options.resolver);
        if (!resolver) {
            return failure(resolver.error());
        }
        final_gather made(device, scene, samples, options, std::move(*resolver));
        if (auto done = made.make_peeler(); !done) {
            return failure(done.error());
        }
        if (auto done = made.make_parts(); !done) {
            return failure(done.error());
        }
        return made;
    }

    [[nodiscard]] result<void> make_peeler() {
        if (options_.method == gather_method::resolve) {
            return {};
        }
        if constexpr (resolves_peeled<B>) {
            auto made = bundle_peeler<B>::create(*device_, options_.peeler);
            if (!made) {
                return failure(made.error());
            }
            peeler_.emplace(std::move(*made));
            return {};
        } else {
            return fail(error_code::unavailable,
                        std::string("The backend ") + std::string(device_->name()) +
                            " can't peel layers of depth; gather_method::resolve needs none.");
        }
    }

    [[nodiscard]] result<void> make_parts() {
        const std::uint64_t most = part_size(*device_);
        const std::uint64_t largest = std::min(count_, most);
        const auto make = [&](std::optional<typename B::buffer>& slot, std::uint64_t bytes) {
            auto buffer = device_->create_buffer(bytes);
            if (buffer) {
                slot.emplace(std::move(*buffer));
            } else {
                error_ = buffer.error();
            }
            return slot.has_value();
        };
        bool made = make(hits_, largest * sizeof(gather_hit)) &&
                    make(found_, largest * light_bytes) && make(zeros_, zero_bytes(largest));
        for (std::uint64_t first = 0; made && first < count_; first += most) {
            part& p = parts_.emplace_back();
            p.first = first;
            p.count = static_cast<std::uint32_t>(std::min(most, count_ - first));
            made = make(p.sums, p.count * sum_bytes) && make(p.direct, p.count * light_bytes) &&
                   (!options_.directional || make(p.moments, p.count * moment_bytes));
        }
        if (!made) {
            return failure(error_);
        }
        return {};
    }

    [[nodiscard]] bundle_work<B> work_of(const part& p) const {
        const auto samples = p.own ? view<B>(*p.own) : part_of(samples_, p, sizeof(gather_sample));
        return {scene_->triangles(), scene_->alpha(), samples,
                view<B, gather_hit>(*hits_, 0, p.count)};
    }

    [[nodiscard]] ray_bundle next_bundle() const {
        return resolver_.bundle(scene_->box(), directions_[axes_], scene_->lift());
    }

    [[nodiscard]] result<void> add_peeled(std::uint64_t axes) {
        if constexpr (resolves_peeled<B>) {
            for (; axes > 0; --axes) {
                const ray_bundle bundle = next_bundle();
                for (const part& p : parts_) {
                    const bundle_work<B> work = work_of(p);
                    const auto layers = peeler_->resolve(bundle, scene_->box(), work);
                    if (!layers) {
                        return failure(layers.error());
                    }
                    auto done = run(
                        *device_, [&](auto& recorder) { record_light(recorder, p, work, bundle); });
                    if (!done) {
                        return done;
                    }
                }
                ++axes_;
            }
        }
        return {};
    }

    /// Adds what part p has met along the bundle of the axis that is next.
    void record_light(typename B::recorder& recorder, const part& p, const bundle_work<B>& work,
                      const ray_bundle& bundle) const {
        const glm::vec3 along(bundle.direction);
        const auto sky = [&](glm::vec3 d) {
            return options_.sky ? glm::vec4(options_.sky(d), 0) : glm::vec4(0);
        };
        const auto fill = [&](auto kernel) {
            kernel.direction = bundle.direction;
            kernel.sky_along = sky(along);
            kernel.sky_against = sky(-along);
            kernel.first = static_cast<std::uint32_t>(axes_ % replicates) * p.count;
            return kernel;
        };
        const auto sums = view<B>(*p.sums);
        const range all{0, p.count};
        if (p.moments) {
            const auto moments = view<B>(*p.moments);
            recorder.map(fill(kernels::directional_light{}),
                         {work.samples, work.hits, scene_->tables(), scene_->radiance(), sums, sums,
                          moments, moments},
                         all);
        } else {
            recorder.map(
                fill(kernels::gather_light{}),
                {work.samples, work.hits, scene_->tables(), scene_->radiance(), sums, sums}, all);
        }
    }

    void record_found(typename B::recorder& recorder, const part& p,
                      const buffer_view<B>& into) const {
        recorder.map(kernels::gathered_irradiance{p.count, replicates},
                     {view<B>(*p.sums), view<B>(*p.direct), into}, range{0, p.count});
    }

    [[nodiscard]] result<void> read_part(const part& p, std::span<glm::vec4> found) {
        const auto into = view<B, glm::vec4>(*found_, 0, p.count);
        auto done = run(*device_, [&](auto& recorder) { record_found(recorder, p, into); });
        if (!done) {
            return done;
        }
        return read_back<B, glm::vec4>(*device_, *found_, found);
    }

    void record_zeros(typename B::recorder& recorder, const typename B::buffer& buffer) const {
        const std::uint64_t piece = zeros_->size_bytes();
        for (std::uint64_t at = 0; at < buffer.size_bytes(); at += piece) {
            const std::uint64_t bytes = std::min(piece, buffer.size_bytes() - at);
            recorder.copy(buffer_view<B>{&*zeros_, 0, bytes}, buffer_view<B>{&buffer, at, bytes});
        }
    }

    /// That a direction stands for: of D axes, 2π / D of the half sphere.
    [[nodiscard]] float solid_angle() const {
        return axes_ == 0 ? 0.0f
                          : static_cast<float>(6.283185307179586 / static_cast<double>(axes_));
    }

    /// Of a view with so many bytes a sample, those of part p.
    [[nodiscard]] static buffer_view<B> part_of(const buffer_view<B>& all, const part& p,
                                                std::uint64_t bytes) {
        return {all.buffer, all.offset + p.first * bytes, p.count * bytes};
    }

    /// Calls `transfer(buffer, offset in it, run of bytes)` for the sums, replicate after
    /// replicate, the direct light and the moments of all samples in their order, as `bytes` holds
    /// them.
    template <class Bytes, class Transfer>
    [[nodiscard]] result<void> for_each_run(Bytes bytes, const Transfer& transfer) {
        const auto take = [&](const typename B::buffer& buffer, std::uint64_t at,
                              std::uint64_t size) -> result<void> {
            const auto run = bytes.subspan(0, size);
            bytes = bytes.subspan(size);
            return transfer(buffer, at, run);
        };
        for (std::uint64_t r = 0; r <= replicates; ++r) {
            for (const part& p : parts_) {
                const std::uint64_t size = p.count * light_bytes;
                auto done =
                    r < replicates ? take(*p.sums, r * size, size) : take(*p.direct, 0, size);
                if (!done) {
                    return done;
                }
            }
        }
        for (const part& p : parts_) {
            if (p.moments) {
                if (auto done = take(*p.moments, 0, p.count * moment_bytes); !done) {
                    return done;
                }
            }
        }
        return {};
    }

    /// A header for what is here, without its content.
    [[nodiscard]] result<detail::state_header> describe() {
        detail::fingerprint found;
        found.add_value(scene_->box());
        found.add_value(scene_->lift());
        found.add_value(static_cast<std::uint32_t>(options_.method));
        if (options_.method == gather_method::peel) {
            found.add_value(options_.peeler.size);
        }
        const bundle_axes places(0);
        for (std::uint64_t k = 0; options_.sky && k < 32; ++k) {
            found.add_value(options_.sky(glm::vec3(places[k])));
            found.add_value(options_.sky(-glm::vec3(places[k])));
        }
        for (const buffer_view<B>& v :
             {scene_->triangles(), scene_->alpha(), scene_->tables(), scene_->radiance()}) {
            found.add_value(v.size);
            if (auto done = add_content(found, v); !done) {
                return failure(done.error());
            }
        }
        for (const part& p : parts_) {
            if (auto done = add_content(found, work_of(p).samples); !done) {
                return failure(done.error());
            }
        }
        detail::state_header header;
        header.directional = options_.directional ? 1 : 0;
        header.asked = found.value();
        header.samples = count_;
        header.axes = axes_;
        header.seed = options_.seed;
        return header;
    }

    [[nodiscard]] result<void> add_content(detail::fingerprint& found, const buffer_view<B>& v) {
        constexpr std::uint64_t piece = std::uint64_t{1} << 20;
        std::vector<std::byte> bytes;
        for (std::uint64_t at = 0; v && at < v.size; at += piece) {
            bytes.resize(std::min(piece, v.size - at));
            if (auto done = device_->download(*v.buffer, v.offset + at, bytes); !done) {
                return done;
            }
            found.add(bytes);
        }
        return {};
    }

    B* device_;
    const gather_scene<B>* scene_;
    std::uint64_t count_;
    final_gather_options options_;
    bundle_axes directions_;
    std::uint64_t axes_ = 0;
    bundle_resolver<B> resolver_;
    std::optional<typename detail::peeler_of<B>::type> peeler_;
    buffer_view<B> samples_; ///< the caller's
    std::vector<part> parts_;
    std::optional<typename B::buffer> hits_;
    std::optional<typename B::buffer> found_;
    std::optional<typename B::buffer> zeros_;
    error error_; ///< of a buffer that couldn't be made
};

} // namespace skybark::gather
