#pragma once
// A picture of a tree: on a meadow, in the sun, with its shadow, under a clear sky.

#include <picture/daylight.hpp>
#include <skybark/kernels/cast_shadow.hpp>
#include <skybark/kernels/clear_sky.hpp>
#include <skybark/kernels/develop.hpp>
#include <skybark/kernels/lit_branch.hpp>
#include <skybark/kernels/meadow_ground.hpp>
#include <skybark/trees/branch_mesh.hpp>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>

namespace skybark::picture {

struct picture_options {
    std::uint32_t width = 1280;
    std::uint32_t height = 800;
    std::uint32_t supersampling = 3; ///< samples a pixel in each direction
    bool skeleton = false;           ///< plain wood in place of bark
    double sun_azimuth = 262;        ///< degrees from north, clockwise
    double sun_elevation = 38;       ///< degrees
    float exposure = 0.046f;
};

inline constexpr std::uint32_t shadow_texels = 4096;

/// The scene around a tree that fills the box from `low` to `high`.
[[nodiscard]] inline kernels::scene_record scene_around(glm::vec3 low, glm::vec3 high,
                                                        const picture_options& options) {
    kernels::scene_record scene{};
    const glm::vec3 centre = (low + high) * 0.5f;
    const glm::vec3 half = (high - low) * 0.5f;
    const float across = std::max({half.x, half.z, 0.01f});
    const float tall = std::max(half.y, 0.01f);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    const float field = glm::radians(34.0f); // vertical
    const float reach = std::max(tall, across / aspect) * 1.12f;
    const float distance = reach / std::tan(field * 0.5f) + across;
    const glm::vec3 eye =
        glm::vec3(centre.x, low.y, centre.z) +
        glm::vec3(0.30f * distance, std::max(0.62f * tall, 0.05f), 0.95f * distance);
    const glm::vec3 target(centre.x, centre.y - 0.10f * tall, centre.z);
    const glm::mat4 look = glm::lookAtRH(eye, target, glm::vec3(0, 1, 0));
    const glm::mat4 lens =
        glm::perspectiveRH_ZO(field, aspect, distance * 0.02f, distance * 2000.0f);
    scene.to_clip = lens * look;
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(eye, 0);

    scene.sky = daylight(direction_to_sun(options.sun_azimuth, options.sun_elevation), 2.2);
    set_ambient(scene, glm::vec3(0.10f, 0.11f, 0.05f));

    const glm::vec3 to_sun(scene.sky.to_sun);
    const float radius = glm::length(half) + 0.01f;
    const glm::vec3 up = std::abs(to_sun.y) > 0.99f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::mat4 from_sun = glm::lookAtRH(centre + to_sun * (2 * radius), centre, up);
    // Far enough behind the tree for the ground that its shadow falls on.
    scene.to_shadow =
        glm::orthoRH_ZO(-radius, radius, -radius, radius, 0.0f, 12 * radius) * from_sun;
    scene.shadow = {2 * radius / shadow_texels, 1.0f / shadow_texels, 1.5f, 0};
    return scene;
}

/// Draws the branches of `mesh`, whose vertices have been made, into RGBA8 rows from the top.
/// The tree stands on the ground at y = 0, or at the bottom of its box if that is higher.
template <backend B>
[[nodiscard]] result<std::vector<std::uint8_t>>
draw_tree(B& device, const trees::branch_mesh<B>& mesh, glm::vec3 low, glm::vec3 high,
          const picture_options& options) {
    const float ground = std::clamp(0.0f, low.y, high.y);
    const kernels::scene_record scene =
        scene_around(glm::vec3(low.x, ground, low.z), high, options);
    auto scene_buffer = make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    if (!scene_buffer) {
        return failure(scene_buffer.error());
    }
    const std::uint32_t samples = std::max(1u, options.supersampling);
    const std::uint32_t width = options.width * samples;
    const std::uint32_t height = options.height * samples;
    const image_description wanted[4] = {{width, height, image_format::rgba32f},
                                         {width, height, image_format::depth32f},
                                         {shadow_texels, shadow_texels, image_format::depth32f},
                                         {options.width, options.height, image_format::rgba8}};
    std::vector<typename B::image> images;
    for (const image_description& what : wanted) {
        auto made = device.create_image(what);
        if (!made) {
            return failure(made.error());
        }
        images.push_back(std::move(*made));
    }
    const auto& color = images[0];
    const auto& depth = images[1];
    const auto& shadow = images[2];
    const auto& developed = images[3];

    const buffer_view<B> scene_view = view<B>(*scene_buffer);
    const sampled_image<B> shadow_map{&shadow, filter_mode::nearest, wrap_mode::clamp};
    const auto drawn = run(device, [&](typename B::recorder& r) {
        draw_target<B> from_sun{nullptr, &shadow, {}, 1.0f};
        for (const auto& part : mesh.parts()) {
            r.draw(kernels::cast_shadow{}, {view<B>(part.vertices), scene_view}, {},
                   mesh.geometry(part), from_sun, draw_state{});
            from_sun.clear_depth.reset();
        }
        draw_target<B> picture{&color, &depth, glm::vec4(0), 1.0f};
        const kernels::lit_branch wood{3.0f, options.skeleton ? 1u : 0u};
        for (const auto& part : mesh.parts()) {
            r.draw(wood, {view<B>(part.vertices), scene_view}, {shadow_map}, mesh.geometry(part),
                   picture, draw_state{});
            picture.clear_color.reset();
            picture.clear_depth.reset();
        }
        draw_geometry<B> plane;
        plane.count = 6;
        const float extent = 400 * (high.y - low.y);
        r.draw(kernels::meadow_ground{ground, extent}, {scene_view}, {shadow_map}, plane, picture,
               draw_state{});
        draw_geometry<B> screen;
        screen.count = 3;
        r.draw(kernels::clear_sky{}, {scene_view}, {}, screen, picture, draw_state{});
        r.draw(kernels::develop{samples, options.exposure}, {},
               {sampled_image<B>{&color, filter_mode::nearest, wrap_mode::clamp}}, screen,
               draw_target<B>{&developed, nullptr, {}, {}}, draw_state{false, false});
    });
    if (!drawn) {
        return failure(drawn.error());
    }
    std::vector<std::uint8_t> pixels(std::size_t{4} * options.width * options.height);
    if (auto done = device.download(developed, std::as_writable_bytes(std::span(pixels))); !done) {
        return failure(done.error());
    }
    return pixels;
}

} // namespace skybark::picture
