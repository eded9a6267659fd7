#pragma once
// torn_billboards: draws the particles of clouds at a distance, back to front, for a small part of
// what cloud_billboards takes, and with sharper outlines.
//
//     auto puffs = torn_billboards<B>::create(device, most_particles);
//     run(device, [&](auto& recorder) {
//         sun.relight(recorder, particles, count, box);
//         puffs->record(recorder, {particles, at_rest, count}, eye, scene, light, {}, target);
//     });
//
// Each particle is lit once, in its middle and to its sides, and its fragments by what is linear
// between; noise that drifts with the cloud eats into their outlines, which are Gaussians else.
// The attenuation volumes don't know of it: a cloud's shadow stays that of its particles.

#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/kernels/puff_light.hpp>
#include <skybark/kernels/torn_puff.hpp>

namespace skybark::clouds {

/// Particles where they are, and where they lie at rest: the noise's places. The same view where
/// nothing drifts. The picture does not depend on the order of both lists, unless two of the same
/// place, radius, depth and albedo come from different places.
template <backend B>
struct drawn_particles {
    buffer_view<B> moved; ///< cloud_particle
    buffer_view<B> rest;  ///< cloud_particle
    std::uint32_t count = 0;
};

template <volume_backend B>
requires detail::sorts_puffs<B> && maps_grids<B, kernels::puff_light> &&
    draws<B, kernels::torn_puff>
class torn_billboards {
  public:
    /// Room for `most_particles`: 72 bytes each. Fails with bad_input where the device cannot bind
    /// as many.
    [[nodiscard]] static result<torn_billboards> create(B& device, std::uint32_t most_particles) {
        constexpr std::uint64_t bytes = sizeof(shared::puff_radiance);
        auto sorted = detail::sorted_puffs<B>::create(device, most_particles, bytes);
        if (!sorted) {
            return failure(sorted.error());
        }
        auto lights = device.create_buffer(bytes * most_particles);
        if (!lights) {
            return failure(lights.error());
        }
        return torn_billboards(std::move(*sorted), std::move(*lights));
    }

    /// Appends sorting, lighting and drawing of particles as seen from `eye`, into images that have
    /// been cleared or drawn into. `scene`: one kernels::scene_record on the device, of the same
    /// eye. `how`: of the noise. None is fine. Of the lighting, by_particle, paper_form,
    /// forward_point, torn and grain are not looked at: the light comes from the volumes and is
    /// that of a particle's front, and the noise is as `how` has it.
    void record(typename B::recorder& to, const drawn_particles<B>& particles, glm::vec3 eye,
                const buffer_view<B>& scene, const cloud_light_sources<B>& light,
                const kernels::torn_puff& how, const draw_target<B>& target) const {
        const std::uint32_t count = particles.count;
        volume_bindings<B, kernels::puff_light> volumes;
        volumes.read = detail::light_volumes(light);
        if (count == 0) {
            return;
        }
        sorted_.record(to, particles.moved, count, eye, light.lighting);
        to.map(kernels::puff_light{},
               {particles.moved, scene, sorted_.lighting(), view<B>(lights_)}, volumes,
               range{0, count});
        to.draw(how,
                {particles.moved, sorted_.order(count), particles.rest, view<B>(lights_), scene,
                 sorted_.lighting()},
                {}, sorted_.squares(count), target, draw_state{true, false, blend_mode::alpha});
    }

    [[nodiscard]] std::uint32_t capacity() const noexcept { return sorted_.capacity(); }

  private:
    torn_billboards(detail::sorted_puffs<B> sorted, typename B::buffer lights)
        : sorted_(std::move(sorted)), lights_(std::move(lights)) {}

    detail::sorted_puffs<B> sorted_;
    typename B::buffer lights_;
};

} // namespace skybark::clouds
