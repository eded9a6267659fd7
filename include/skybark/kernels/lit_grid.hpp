#pragma once
// lit_grid: draws a cloud that is a grid of densities, ray by ray, lit at every step.

#include <skybark/kernels/cloud_scene.hpp>

namespace skybark::kernels {

/// Three vertices, the whole screen. Buffers: one scene, one lighting. Images: the depth of the
/// opaque things, where rays end (all must be of the picture's size). Volumes: as lit_puff's, then
/// the density. Colours are premultiplied. A ray through the box takes at most 512 even steps, each
/// lit at its middle.
struct lit_grid {
    using buffers = buffer_list<readonly<scene_record>, readonly<cloud_lighting>>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t volumes = 4;
    static constexpr std::uint32_t varyings = 1;

    glm::vec4 low{0};  ///< xyz: m; w: 1/m, the extinction of a density of 1
    glm::vec4 high{1}; ///< xyz: m; w: albedo
    float step = 1;    ///< m, > 0, as long as 512 of them are enough

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const scene_record> scene, std::span<const cloud_lighting>) const {
        const glm::vec4 p(index == 1 ? 3.0f : -1.0f, index == 2 ? 3.0f : -1.0f, 0.0f, 1.0f);
        out[0] = scene[0].from_clip * glm::vec4(p.x, p.y, 1.0f, 1.0f);
        return p;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2 pixel, bool,
                             const Images& from, std::span<const scene_record> scene,
                             std::span<const cloud_lighting> lighting) const {
        const cloud_lighting& how = lighting[0];
        const glm::vec3 eye(scene[0].camera);
        const glm::vec3 direction = glm::normalize(glm::vec3(in[0]) * (1.0f / in[0].w) - eye);
        const glm::vec2 part = shared::ray_in_box(eye, direction, glm::vec3(low), glm::vec3(high));
        const float opaque = from.fetch(0, glm::ivec2(pixel)).x;
        const float last =
            opaque < 1.0f ? glm::min(part.y, surface(scene[0], pixel, opaque, from)) : part.y;
        if (!(last > part.x)) {
            return {{}, false};
        }
        const int steps = glm::clamp(static_cast<int>((last - part.x) / step) + 1, 1, 512);
        const float length = (last - part.x) / static_cast<float>(steps);
        const auto scaled = shared::scattering_without(high.w, how.forward);
        const float extinction = low.w * scaled.depth * length;
        const glm::vec3 over = glm::vec3(1.0f) / (glm::vec3(high) - glm::vec3(low));
        glm::vec3 seen(0);
        float through = 1;
        float air = 0;
        for (int i = 0; i < steps && through > least_light; ++i) {
            const float at = part.x + (static_cast<float>(i) + 0.5f) * length;
            const glm::vec3 place = eye + direction * at;
            const float density = from.volume(3, (place - glm::vec3(low)) * over);
            if (density > 0.0f) {
                const float alpha = shared::one_minus_exp(extinction * density);
                const float hidden = shared::air_between(how.air, at);
                seen += cloud_source(scene[0], how, place, direction, -1.0f, scaled.single,
                                     scaled.diffuse, from) *
                        (through * alpha * (1.0f - hidden));
                air += through * alpha * hidden;
                through *= 1.0f - alpha;
            }
        }
        if (through >= 1.0f) {
            return {{}, false};
        }
        if (air > 0.0f) {
            seen += shared::sky_radiance(scene[0].sky, direction) * air;
        }
        return {glm::vec4(seen, 1.0f - through), true};
    }

    /// What is left of a ray when it ends.
    static constexpr float least_light = 1.0f / 2048.0f;

  private:
    /// How far from the eye what the pixel's depth shows is.
    template <class Images>
    [[nodiscard]] static float surface(const scene_record& scene, glm::vec2 pixel, float depth,
                                       const Images& from) {
        const glm::vec2 size(from.size(0));
        const glm::vec4 at =
            scene.from_clip *
            glm::vec4(pixel.x / size.x * 2.0f - 1.0f, 1.0f - pixel.y / size.y * 2.0f, depth, 1.0f);
        return glm::length(glm::vec3(at) * (1.0f / at.w) - glm::vec3(scene.camera));
    }
};

} // namespace skybark::kernels
