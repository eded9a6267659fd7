#pragma once
// cloud_billboards: draws the particles of a cloud, back to front, lit for each fragment.
//
//     auto puffs = cloud_billboards<B>::create(device, most_particles);
//     cloud_lighting lighting = single_scattering(sun.options(), sun.box(), phase);
//     run(device, [&](auto& recorder) {
//         sun.relight(recorder, particles, count, box);
//         puffs->record(recorder, particles, count, eye, scene, {lighting, &sun.volume()}, target);
//     });
//
// Shimada, Shinya, Shiraishi, Harada 2008, section 2.2, eq. 5 and 6. Sorting happens on the device;
// `record` allocates nothing and sends nothing but the lighting. The target's depth is tested and
// not written: opaque things are drawn before.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/phase.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/billboard_depth.hpp>
#include <skybark/kernels/lit_puff.hpp>

#include <cassert>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace skybark::clouds {

using kernels::cloud_lighting;

/// The sun's light that is scattered once, by an attenuation volume of these options: with
/// `continuum` what goes on forward is part of the light. With `product`, `as_document` draws by
/// S = a τ P I as the paper does (which makes thick particles too bright).
[[nodiscard]] inline cloud_lighting single_scattering(const attenuation_options& options,
                                                      const light_box& box,
                                                      const phase_function& phase,
                                                      bool as_document = false) {
    cloud_lighting lighting{};
    lighting.sun_grid = box.grid;
    lighting.sky_grid = box.grid;
    lighting.diffuse_grid = box.grid;
    lighting.phase = phase.parameters();
    lighting.octaves = glm::vec4(1, 1, 1, 1);
    lighting.forward = options.light == attenuation_light::continuum ? options.forward : 0.0f;
    lighting.sigmas = options.sigmas;
    lighting.document = as_document ? 1 : 0;
    lighting.forward_point = as_document ? 0 : 1;
    return lighting;
}

/// Wrenninge's octaves in place of single scattering: `count` of them, each with `light`,
/// `attenuation` and `g` of the one before. The volume has to hold `extinction`.
inline void add_octaves(cloud_lighting& lighting, std::uint32_t count, float light = 0.5f,
                        float attenuation = 0.5f, float g = 0.5f) {
    lighting.octaves = glm::vec4(light, attenuation, g, static_cast<float>(count));
}

/// Light that was scattered more than once, from a volume that lies at `grid`: fluence over the
/// sun's irradiance, as multiple_scattering has it.
inline void add_diffuse(cloud_lighting& lighting, const light_grid& grid) {
    lighting.diffuse_grid = grid;
    lighting.diffuse = 0.25f * std::numbers::inv_pi_v<float>;
}

/// Light from the sky and the ground, by a volume of the same cloud whose sun stands in the zenith,
/// of `extinction` or `continuum` light. What a cloud absorbs is left out of it, and what comes in
/// from the sides: two streams go up and down in every column as in an endless layer.
inline void add_sky(cloud_lighting& lighting, const attenuation_options& options,
                    const light_box& box, const phase_function& phase) {
    const double g = phase.mean_cosine();
    const double kept =
        options.light == attenuation_light::continuum ? 1 - double{options.forward} : 1.0;
    lighting.sky_grid = box.grid;
    lighting.sky = 1;
    lighting.sky_thickness = static_cast<float>(0.75 * (1 - g) / kept);
}

/// Noise that eats into the particles' outlines, `torn` of them at most (below 1), with grains of
/// up to `grain` m: billows smaller than the particles, and edges sharper than a Gaussian's. Of the
/// picture alone: the volumes, and so the light, are those of the particles as they are.
inline void add_tears(cloud_lighting& lighting, float torn, float grain) {
    lighting.torn = torn;
    lighting.grain = 1 / grain;
}

/// What a draw of clouds is lit by. Volumes that the lighting does not use may be absent, that of
/// the sun not.
template <volume_backend B>
struct cloud_light_sources {
    cloud_lighting lighting;
    const typename B::volume* sun = nullptr;     ///< attenuation
    const typename B::volume* sky = nullptr;     ///< attenuation straight up
    const typename B::volume* diffuse = nullptr; ///< light scattered more than once
    buffer_view<B> by_particle; ///< floats: with lighting.by_particle, the light of each particle
};

template <volume_backend B>
requires maps<B, kernels::billboard_depth> && sorts<B> && draws_volumes<B, kernels::lit_puff>
class cloud_billboards {
  public:
    /// Room for `most_particles`. Fails with bad_input where the device cannot bind as many.
    [[nodiscard]] static result<cloud_billboards> create(B& device, std::uint32_t most_particles) {
        const device_limits limits = device.limits();
        const std::uint64_t most =
            std::min({limits.max_buffer_bytes / sizeof(cloud_particle), limits.max_elements,
                      std::uint64_t{0xffffffffu} / corners});
        if (most_particles > most) {
            return fail(error_code::bad_input,
                        std::string("Billboards for ")
                            .append(std::to_string(most_particles))
                            .append(" particles were asked for; this device draws up to ")
                            .append(std::to_string(most))
                            .append(" at once."));
        }
        cloud_billboards made;
        made.capacity_ = most_particles;
        const std::uint64_t bytes = std::uint64_t{most_particles} * 4;
        for (auto& [buffer, size] :
             {std::pair{&made.keys_, bytes}, std::pair{&made.order_, bytes},
              std::pair{&made.lighting_, std::uint64_t{sizeof(cloud_lighting)}}}) {
            auto one = device.create_buffer(size);
            if (!one) {
                return failure(one.error());
            }
            buffer->emplace(std::move(*one));
        }
        return made;
    }

    /// Appends sorting and drawing of `count` particles as seen from `eye`, into images that have
    /// been cleared or drawn into. `scene`: one kernels::scene_record on the device, of the same
    /// eye. None is fine.
    void record(typename B::recorder& to, const buffer_view<B>& particles, std::uint32_t count,
                glm::vec3 eye, const buffer_view<B>& scene, const cloud_light_sources<B>& light,
                const draw_target<B>& target) const {
        assert(count <= capacity_ && light.sun != nullptr);
        if (count == 0) {
            return;
        }
        to.upload(view<B>(*lighting_), bytes_of_one(light.lighting));
        const auto keys = view<B, std::uint32_t>(*keys_, 0, count);
        const auto order = view<B, std::uint32_t>(*order_, 0, count);
        to.map(kernels::billboard_depth{glm::vec4(eye, 0)}, {particles, keys, order},
               range{0, count});
        to.sort(keys, order);
        volume_bindings<B, kernels::lit_puff> volumes;
        volumes.read = {light.sun, light.sky != nullptr ? light.sky : light.sun,
                        light.diffuse != nullptr ? light.diffuse : light.sun};
        draw_geometry<B> all;
        all.count = count * corners;
        to.draw(kernels::lit_puff{},
                {particles, order, light.by_particle ? light.by_particle : order, scene,
                 view<B>(*lighting_)},
                {}, volumes, all, target, draw_state{true, false, blend_mode::alpha});
    }

    [[nodiscard]] std::uint32_t capacity() const noexcept { return capacity_; }
    /// The particles' numbers, back to front, after a `record` of `count`.
    [[nodiscard]] buffer_view<B> order(std::uint32_t count) const {
        return view<B, std::uint32_t>(*order_, 0, count);
    }

  private:
    cloud_billboards() = default;

    static constexpr std::uint32_t corners = 6;

    std::uint32_t capacity_ = 0;
    std::optional<typename B::buffer> keys_; // all are there after create
    std::optional<typename B::buffer> order_;
    std::optional<typename B::buffer> lighting_;
};

} // namespace skybark::clouds
