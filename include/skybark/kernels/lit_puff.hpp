#pragma once
// lit_puff: draws the particles of a cloud as billboards, lit for each fragment.
//
// Source: Shimada et al. 2008, section 2.2, equations 5 and 6: E_k = S_k + T_k E_{k−1}, back to
// front, with the light sampled from the attenuation volume where the fragment is. With
// premultiplied alpha, S is the colour and 1 − T the alpha.

#include <skybark/kernels/cloud_scene.hpp>
#include <skybark/shared/puff.hpp>

#include <cmath>

namespace skybark::kernels {

/// Six vertices a particle, farthest first: two triangles that face the eye. Buffers: particles,
/// their order, one light value a particle (read only where the lighting says so), one scene, one
/// lighting. Volumes: the attenuation of the sun, that straight up, and diffuse light; all three
/// have to be bound, to any volume where the lighting doesn't use them.
///
/// With lighting.torn, noise that is at rest in space eats into each particle's optical depth where
/// its billboard is; what is left is lit as it would be.
///
/// A particle with a number that is infinite or none, or whose radius or depth is not above 0, is
/// not drawn. An albedo below 0 counts as 0, one above 1 as 1.
///
/// A particle that the eye is in, or nearly, covers the screen, and shows what of it lies before
/// the eye. What is behind the eye isn't drawn.
struct lit_puff {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<std::uint32_t>, readonly<float>,
                                readonly<scene_record>, readonly<cloud_lighting>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t volumes = 3;
    static constexpr std::uint32_t varyings = 4;

    /// Where the corner lies, from the particle's centre; and the clip position.
    struct corner {
        glm::vec3 offset{0};
        glm::vec4 clip{0, 0, 2, 1}; ///< outside: not drawn
    };

    [[nodiscard]] static corner corner_of(std::uint32_t which, const cloud_particle& p,
                                          const scene_record& scene) {
        const float x = (which & 1u) != 0 ? 1.0f : -1.0f;
        const float y = (which & 2u) != 0 ? 1.0f : -1.0f;
        const glm::vec3 eye(scene.camera);
        const glm::vec3 c = p.position - eye;
        const float away2 = glm::dot(c, c);
        if (!shared::puff_drawn(p.optical_depth, p.radius, p.albedo, away2)) {
            return {};
        }
        if (away2 < near_sides * p.radius * p.radius) {
            const glm::vec4 screen(x, y, 0, 1);
            const glm::vec4 at = scene.from_clip * screen;
            return {glm::vec3(at) * (1.0f / at.w) - p.position, screen};
        }
        const glm::vec3 offset = shared::puff_silhouette(c, p.radius, x, y).offset;
        return {offset, scene.to_clip * glm::vec4(p.position + offset, 1.0f)};
    }

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const cloud_particle> particles,
                     std::span<const std::uint32_t> order, std::span<const float> light,
                     std::span<const scene_record> scene,
                     std::span<const cloud_lighting> lighting) const {
        const std::uint32_t number = order[index / 6];
        const cloud_particle& p = particles[number];
        const corner at = corner_of(shared::puff_corner_of(index), p, scene[0]);
        const glm::vec3 c = p.position - glm::vec3(scene[0].camera);
        const float away = std::sqrt(glm::dot(c, c));
        const glm::vec3 air = lighting[0].air > 0.0f && away > 0.0f
                                  ? shared::sky_radiance(scene[0].sky, c * (1.0f / away))
                                  : glm::vec3(0);
        const auto scaled =
            shared::scattering_without(shared::bounded(p.albedo, 1.0f), lighting[0].forward);
        out[0] = glm::vec4(at.offset, p.optical_depth * scaled.depth);
        out[1] = glm::vec4(c, p.radius);
        out[2] = glm::vec4(air, 0);
        out[3] = glm::vec4(lighting[0].by_particle != 0 ? light[number] : -1.0f, scaled.single,
                           scaled.diffuse, 0);
        return at.clip;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool,
                             const Images& from, std::span<const cloud_particle>,
                             std::span<const std::uint32_t>, std::span<const float>,
                             std::span<const scene_record> scene,
                             std::span<const cloud_lighting> lighting) const {
        const cloud_lighting& how = lighting[0];
        const glm::vec3 offset(in[0]);
        const float radius = in[1].w;
        const glm::vec3 along = glm::vec3(in[1]) + offset;
        const float reach = std::sqrt(glm::dot(along, along));
        const glm::vec3 direction = along * (1.0f / reach);
        const float past = glm::dot(offset, direction);
        const float rho2 = glm::dot(offset, offset) - past * past;
        const float ahead = reach - past;
        float depth = shared::puff_depth(in[0].w, rho2, ahead, radius, how.sigmas);
        if (how.torn > 0.0f && depth > least_alpha) {
            const glm::vec3 there = glm::vec3(scene[0].camera) + along;
            depth = in[0].w * shared::puff_torn(depth / in[0].w,
                                                shared::puff_noise(there, how.grain), how.torn);
        }
        const float alpha = shared::one_minus_exp(depth);
        if (alpha < least_alpha) {
            return {{}, false};
        }
        float at = ahead;
        if (how.forward_point != 0) {
            at = glm::max(at - shared::puff_front(depth) * radius / how.sigmas, 0.0f);
        }
        const glm::vec3 place = glm::vec3(scene[0].camera) + direction * at;
        const glm::vec3 source =
            cloud_source(scene[0], how, place, direction, in[3].x, in[3].y, in[3].z, from) *
            (how.paper_form != 0 ? depth : alpha);
        const float hidden = shared::air_between(how.air, at);
        return {shared::behind_air(source, alpha, hidden, glm::vec3(in[2])), true};
    }

    /// Squared distance of the eye, in radii, within which a particle covers the screen.
    static constexpr float near_sides = 1.3f;
    /// What is fainter is not drawn.
    static constexpr float least_alpha = 1.0f / 4096.0f;
};

} // namespace skybark::kernels
