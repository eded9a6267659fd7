#pragma once
// cloud_billboards: draws the particles of a cloud, back to front, lit for each fragment.
//
//     auto puffs = cloud_billboards<B>::create(device, most_particles);
//     // sun: an attenuation_volume of light_of(phase)
//     cloud_lighting lighting = single_scattering(sun.options(), box, phase);
//     run(device, [&](auto& recorder) {
//         sun.relight(recorder, particles, count, box);
//         puffs->record(recorder, particles, count, eye, scene, {lighting, &sun.volume()}, target);
//     });
//
// Shimada, Shinya, Shiraishi, Harada 2008, section 2.2, eq. 5 and 6. Sorting happens on the device;
// `record` allocates nothing and sends nothing but the lighting. The picture does not depend on the
// order of the particles. The target's depth is tested and not written: opaque things are drawn
// before.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/phase.hpp>
#include <skybark/clouds/sorted_puffs.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/lit_puff.hpp>

#include <array>
#include <cassert>
#include <numbers>
#include <utility>

namespace skybark::clouds {

using kernels::cloud_lighting;

/// The sun's light that is scattered once, by an attenuation volume of these options: with
/// `continuum` what goes on forward is part of the light. With `product`, `paper_form` draws by
/// S = a τ P I as the paper does (which makes thick particles too bright).
[[nodiscard]] inline cloud_lighting single_scattering(const attenuation_options& options,
                                                      const light_box& box,
                                                      const phase_function& phase,
                                                      bool paper_form = false) {
    cloud_lighting lighting{};
    lighting.sun_grid = box.grid;
    lighting.sky_grid = box.grid;
    lighting.diffuse_grid = box.grid;
    lighting.phase = phase.parameters();
    lighting.octaves = glm::vec4(1, 1, 1, 1);
    lighting.forward = options.light == attenuation_light::continuum ? options.forward : 0.0f;
    lighting.sigmas = options.sigmas;
    lighting.paper_form = paper_form ? 1 : 0;
    lighting.forward_point = paper_form ? 0 : 1;
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
/// the sun not; what it uses has to be there.
template <volume_backend B>
struct cloud_light_sources {
    cloud_lighting lighting;
    const typename B::volume* sun = nullptr;     ///< attenuation
    const typename B::volume* sky = nullptr;     ///< attenuation straight up
    const typename B::volume* diffuse = nullptr; ///< light scattered more than once
    buffer_view<B> by_particle; ///< floats: with lighting.by_particle, the light of each particle
};

namespace detail {

/// What the kernels that draw clouds bind: where the lighting uses no volume, any.
template <volume_backend B>
[[nodiscard]] std::array<const typename B::volume*, 3>
light_volumes(const cloud_light_sources<B>& light) {
    assert(light.sun != nullptr);
    assert(light.sky != nullptr || !(light.lighting.sky > 0));
    assert(light.diffuse != nullptr || !(light.lighting.diffuse > 0));
    return {light.sun, light.sky != nullptr ? light.sky : light.sun,
            light.diffuse != nullptr ? light.diffuse : light.sun};
}

} // namespace detail

template <volume_backend B>
requires detail::sorts_puffs<B> && draws_volumes<B, kernels::lit_puff>
class cloud_billboards {
  public:
    /// Room for `most_particles`: 8 bytes each. Fails with bad_input where the device cannot bind
    /// as many.
    [[nodiscard]] static result<cloud_billboards> create(B& device, std::uint32_t most_particles) {
        auto sorted =
            detail::sorted_puffs<B>::create(device, most_particles, sizeof(cloud_particle));
        if (!sorted) {
            return failure(sorted.error());
        }
        return cloud_billboards(std::move(*sorted));
    }

    /// Appends sorting and drawing of `count` particles as seen from `eye`, into images that have
    /// been cleared or drawn into. `scene`: one kernels::scene_record on the device, of the same
    /// eye. None is fine.
    void record(typename B::recorder& to, const buffer_view<B>& particles, std::uint32_t count,
                glm::vec3 eye, const buffer_view<B>& scene, const cloud_light_sources<B>& light,
                const draw_target<B>& target) const {
        volume_bindings<B, kernels::lit_puff> volumes;
        volumes.read = detail::light_volumes(light);
        assert(light.by_particle || light.lighting.by_particle == 0);
        if (count == 0) {
            return;
        }
        sorted_.record(to, particles, count, eye, light.lighting);
        const buffer_view<B> order = sorted_.order(count);
        to.draw(kernels::lit_puff{},
                {particles, order, light.by_particle ? light.by_particle : order, scene,
                 sorted_.lighting()},
                {}, volumes, sorted_.squares(count), target,
                draw_state{true, false, blend_mode::alpha});
    }

    [[nodiscard]] std::uint32_t capacity() const noexcept { return sorted_.capacity(); }
    /// The particles' numbers, back to front, after a `record` of `count`. Where two are equally
    /// far from the eye, what they are decides, not where they are in the list.
    [[nodiscard]] buffer_view<B> order(std::uint32_t count) const { return sorted_.order(count); }

  private:
    explicit cloud_billboards(detail::sorted_puffs<B> sorted) : sorted_(std::move(sorted)) {}

    detail::sorted_puffs<B> sorted_;
};

} // namespace skybark::clouds
