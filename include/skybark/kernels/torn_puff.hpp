#pragma once
// torn_puff: draws the particles of a cloud as billboards in a light that puff_light has found,
// their outlines torn by noise.
//
// As lit_puff does (Shimada et al. 2008, section 2.2), but a fragment looks at no volume: over a
// particle the light is linear. The noise is at rest in the cloud, so that it drifts with it.

#include <skybark/kernels/cloud_scene.hpp>
#include <skybark/shared/puff.hpp>

#include <cmath>

namespace skybark::kernels {

/// Six vertices a particle, farthest first: two triangles that face the eye. Buffers: particles,
/// their order, the same particles at rest, lights (one puff_radiance a particle), one scene, one
/// lighting.
///
/// A particle with a number that is infinite or none, or whose radius or depth is not above 0, is
/// not drawn. An albedo below 0 counts as 0, one above 1 as 1.
///
/// For clouds that are looked at from outside: a particle that the eye is in, or nearly, and what
/// is behind it, is not drawn.
struct torn_puff {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<std::uint32_t>,
                                readonly<cloud_particle>, readonly<shared::puff_radiance>,
                                readonly<scene_record>, readonly<cloud_lighting>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t varyings = 4;

    float torn = 0.5f;   ///< how deep noise eats into a particle, below 1; 0: not at all
    float grain = 0.01f; ///< 1/m: 1 / the size of the noise's largest grains
    float shade = 0.4f;  ///< how much darker it is where noise has eaten all that it may, below 1

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const cloud_particle> particles,
                     std::span<const std::uint32_t> order, std::span<const cloud_particle> rest,
                     std::span<const shared::puff_radiance> lights,
                     std::span<const scene_record> scene,
                     std::span<const cloud_lighting> lighting) const {
        const std::uint32_t number = order[index / 6];
        const std::uint32_t which = shared::puff_corner_of(index);
        const float x = (which & 1u) != 0 ? 1.0f : -1.0f;
        const float y = (which & 2u) != 0 ? 1.0f : -1.0f;
        const cloud_particle& p = particles[number];
        const glm::vec3 c = p.position - glm::vec3(scene[0].camera);
        const float away2 = glm::dot(c, c);
        out = {};
        const glm::vec3 calm = rest[number].position;
        if (!shared::puff_drawn(p.optical_depth, p.radius, p.albedo, away2) ||
            !shared::puff_finite(glm::dot(calm, calm)) ||
            !(away2 > near_sides * p.radius * p.radius)) {
            return {0.0f, 0.0f, 2.0f, 1.0f};
        }
        const float away = std::sqrt(away2);
        const shared::puff_corner corner = shared::puff_silhouette(c, p.radius, x, y);
        const float u = x * corner.over;
        const float v = y * corner.over;
        const shared::puff_radiance& light = lights[number];
        const float hidden = shared::air_between(lighting[0].air, away);
        const glm::vec3 own =
            glm::vec3(light.middle) + glm::vec3(light.right) * u + glm::vec3(light.up) * v;
        const auto scaled =
            shared::scattering_without(shared::bounded(p.albedo, 1.0f), lighting[0].forward);
        out[0] = glm::vec4(u, v, p.optical_depth * scaled.depth, 0.0f);
        out[1] = glm::vec4(own * (1.0f - hidden), 0.0f);
        out[2] = glm::vec4(glm::vec3(light.air) * hidden, 0.0f);
        out[3] = glm::vec4(calm + corner.offset, p.radius);
        return scene[0].to_clip * glm::vec4(p.position + corner.offset, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool,
                             const Images&, std::span<const cloud_particle>,
                             std::span<const std::uint32_t>, std::span<const cloud_particle>,
                             std::span<const shared::puff_radiance>, std::span<const scene_record>,
                             std::span<const cloud_lighting> lighting) const {
        const float rho2 = in[0].x * in[0].x + in[0].y * in[0].y;
        if (rho2 >= 1.0f) {
            return {{}, false};
        }
        const float sigmas = lighting[0].sigmas;
        float body = shared::exp_minus(0.5f * sigmas * sigmas * rho2);
        float light = 1;
        if (torn > 0.0f) {
            const float noise = shared::puff_noise(glm::vec3(in[3]), grain);
            body = shared::puff_torn(body, noise, torn);
            light = 1.0f + shade * (0.5f - noise);
        }
        const float alpha = shared::one_minus_exp(in[0].z * body);
        if (alpha < least_alpha) {
            return {{}, false};
        }
        const glm::vec3 color = glm::max(glm::vec3(in[1]), glm::vec3(0)) * light + glm::vec3(in[2]);
        return {glm::vec4(color * alpha, alpha), true};
    }

    /// Squared distance of the eye, in radii, within which a particle is not drawn.
    static constexpr float near_sides = 1.3f;
    /// What is fainter is not drawn.
    static constexpr float least_alpha = 1.0f / 512.0f;
};

} // namespace skybark::kernels
