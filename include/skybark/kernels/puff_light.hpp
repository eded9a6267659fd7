#pragma once
// puff_light: lights each particle of a cloud as it is seen from an eye, in its middle and around
// it, so that what draws it need not look at any volume.

#include <skybark/kernels/cloud_scene.hpp>
#include <skybark/shared/puff.hpp>

namespace skybark::kernels {

static_assert(sizeof(shared::puff_radiance) == 64);

/// Maps over particles. Buffers: particles, one scene, one lighting, lights (one puff_radiance a
/// particle). Volumes as lit_puff has them. The light is lit_puff's at the middle of the particle's
/// front, and its slope that between places half a radius to each side. An albedo that is no number
/// or below 0 counts as 0, one above 1 as 1.
struct puff_light {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<scene_record>,
                                readonly<cloud_lighting>, writeonly<shared::puff_radiance>>;
    static constexpr std::uint32_t volumes = 3;

    template <class Grids>
    void map(std::uint32_t i, const Grids& grids, std::span<const cloud_particle> particles,
             std::span<const scene_record> scene, std::span<const cloud_lighting> lighting,
             std::span<shared::puff_radiance> lights) const {
        const cloud_particle& p = particles[i];
        shared::puff_radiance found{};
        const glm::vec3 away = p.position - glm::vec3(scene[0].camera);
        const float distance = std::sqrt(glm::dot(away, away));
        if (p.optical_depth > 0.0f && p.radius > 0.0f && distance > 0.0f) {
            const cloud_lighting& how = lighting[0];
            const reader<Grids> from{grids};
            const glm::vec3 ahead = away * (1.0f / distance);
            const auto scaled =
                shared::scattering_without(shared::bounded(p.albedo, 1.0f), how.forward);
            const float front = shared::puff_front(p.optical_depth * scaled.depth) * p.radius;
            const glm::vec3 place = p.position - ahead * glm::min(front / how.sigmas, distance);
            const auto light = [&](glm::vec3 aside) {
                return cloud_source(scene[0], how, place + aside, ahead, -1.0f, scaled.single,
                                    scaled.diffuse, from);
            };
            const glm::vec3 right = shared::puff_right(ahead) * (0.5f * p.radius);
            const glm::vec3 up = glm::cross(shared::puff_right(ahead), ahead) * (0.5f * p.radius);
            found.middle = glm::vec4(light(glm::vec3(0)), 0.0f);
            found.right = glm::vec4(light(right) - light(-right), 0.0f);
            found.up = glm::vec4(light(up) - light(-up), 0.0f);
            if (how.air > 0.0f) {
                found.air = glm::vec4(shared::sky_radiance(scene[0].sky, ahead), 0.0f);
            }
        }
        lights[i] = found;
    }

  private:
    /// A map's volumes, read as a draw's.
    template <class Grids>
    struct reader {
        const Grids& grids;
        [[nodiscard]] glm::ivec3 volume_size(std::uint32_t n) const { return grids.size(n); }
        [[nodiscard]] float volume(std::uint32_t n, glm::vec3 at) const {
            return grids.sample(n, at);
        }
    };
};

} // namespace skybark::kernels
