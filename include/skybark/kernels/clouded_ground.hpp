#pragma once
// clouded_ground: draws level country up to the horizon, in the shadow of clouds.
//
// The shadow is the attenuation volume that lights the clouds, read where the ground is: the second
// use of it that Shimada et al. 2008 name (section 5). Any kernel or shader can do the same, by
// skybark/glsl/cloud_shadow.glsl.

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/cloud_shadow.hpp>
#include <skybark/shared/country.hpp>

namespace skybark::kernels {

/// Six vertices, two triangles. Buffers: one scene. Volumes: the attenuation of the sun.
struct clouded_ground {
    using buffers = buffer_list<readonly<scene_record>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t varyings = 1;

    light_grid grid;      ///< of the volume
    float height = 0;     ///< m, y of the ground
    float extent = 60000; ///< m from under the eye to each side
    float air = 0;        ///< 1/m, extinction of the air up to the eye
    float shadow = 1;     ///< 0: no shadow, and the volume is not looked at

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>& out,
                     std::span<const scene_record> scene) const {
        const std::uint32_t corner = index < 3 ? index : (index == 3 ? 2 : (index == 4 ? 1 : 3));
        const glm::vec3 p(scene[0].camera.x + ((corner & 1) != 0 ? extent : -extent), height,
                          scene[0].camera.z + ((corner & 2) != 0 ? -extent : extent));
        out[0] = glm::vec4(p, 0.0f);
        return scene[0].to_clip * glm::vec4(p, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>& in, glm::vec2, bool,
                             const Images& from, std::span<const scene_record> scene) const {
        const glm::vec3 p(in[0]);
        float sun = 1;
        if (shadow > 0) {
            const glm::vec3 at = shared::cloud_texel(grid, glm::vec3(from.volume_size(0)), p);
            sun = shared::cloud_light(from.volume(0, at));
        }
        const glm::vec3 up(0, 1, 0);
        const glm::vec3 away = p - glm::vec3(scene[0].camera);
        const float distance = glm::length(away);
        const glm::vec3 light = shared::lit(shared::country_albedo(p.x, p.z, distance), up,
                                            scene[0].sky, sun, ambient_of(scene[0], up));
        const glm::vec3 before = shared::sky_radiance(scene[0].sky, away * (1.0f / distance));
        return {glm::vec4(glm::mix(light, before, shared::one_minus_exp(air * distance)), 1.0f),
                true};
    }
};

} // namespace skybark::kernels
