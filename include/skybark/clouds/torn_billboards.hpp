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
/// nothing drifts.
template <backend B>
struct drawn_particles {
    buffer_view<B> moved; ///< cloud_particle
    buffer_view<B> rest;  ///< cloud_particle
    std::uint32_t count = 0;
};

template <volume_backend B>
requires maps<B, kernels::billboard_depth> && maps_grids<B, kernels::puff_light> && sorts<B> &&
    draws<B, kernels::torn_puff>
class torn_billboards {
  public:
    /// Room for `most_particles`: 72 bytes each. Fails with bad_input where the device cannot bind
    /// as many.
    [[nodiscard]] static result<torn_billboards> create(B& device, std::uint32_t most_particles) {
        const device_limits limits = device.limits();
        const std::uint64_t most =
            std::min({limits.max_buffer_bytes / sizeof(shared::puff_radiance), limits.max_elements,
                      std::uint64_t{0xffffffffu} / corners});
        if (most_particles > most) {
            return fail(error_code::bad_input,
                        std::string("Billboards for ")
                            .append(std::to_string(most_particles))
                            .append(" particles were asked for; this device draws up to ")
                            .append(std::to_string(most))
                            .append(" at once."));
        }
        torn_billboards made;
        made.capacity_ = most_particles;
        const std::uint64_t number = most_particles;
        for (auto& [buffer, size] :
             {std::pair{&made.keys_, number * 4}, std::pair{&made.order_, number * 4},
              std::pair{&made.lights_, number * sizeof(shared::puff_radiance)},
              std::pair{&made.lighting_, std::uint64_t{sizeof(cloud_lighting)}}}) {
            auto one = device.create_buffer(size);
            if (!one) {
                return failure(one.error());
            }
            buffer->emplace(std::move(*one));
        }
        return made;
    }

    /// Appends sorting, lighting and drawing of particles as seen from `eye`, into images that have
    /// been cleared or drawn into. `scene`: one kernels::scene_record on the device, of the same
    /// eye. `how`: of the noise. None is fine.
    void record(typename B::recorder& to, const drawn_particles<B>& particles, glm::vec3 eye,
                const buffer_view<B>& scene, const cloud_light_sources<B>& light,
                const kernels::torn_puff& how, const draw_target<B>& target) const {
        const std::uint32_t count = particles.count;
        assert(count <= capacity_ && light.sun != nullptr);
        if (count == 0) {
            return;
        }
        to.upload(view<B>(*lighting_), bytes_of_one(light.lighting));
        const auto keys = view<B, std::uint32_t>(*keys_, 0, count);
        const auto order = view<B, std::uint32_t>(*order_, 0, count);
        to.map(kernels::billboard_depth{glm::vec4(eye, 0)}, {particles.moved, keys, order},
               range{0, count});
        to.sort(keys, order);
        volume_bindings<B, kernels::puff_light> volumes;
        volumes.read = {light.sun, light.sky != nullptr ? light.sky : light.sun,
                        light.diffuse != nullptr ? light.diffuse : light.sun};
        to.map(kernels::puff_light{},
               {particles.moved, scene, view<B>(*lighting_), view<B>(*lights_)}, volumes,
               range{0, count});
        draw_geometry<B> all;
        all.count = count * corners;
        to.draw(
            how,
            {particles.moved, order, particles.rest, view<B>(*lights_), scene, view<B>(*lighting_)},
            {}, all, target, draw_state{true, false, blend_mode::alpha});
    }

    [[nodiscard]] std::uint32_t capacity() const noexcept { return capacity_; }

  private:
    torn_billboards() = default;

    static constexpr std::uint32_t corners = 6;

    std::uint32_t capacity_ = 0;
    std::optional<typename B::buffer> keys_; // all are there after create
    std::optional<typename B::buffer> order_;
    std::optional<typename B::buffer> lights_;
    std::optional<typename B::buffer> lighting_;
};

} // namespace skybark::clouds
