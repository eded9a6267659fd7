#pragma once
// A picture of bark from close by, in the scene of tree_picture.hpp.

#include <picture/tree_picture.hpp>
#include <skybark/kernels/lit_bark.hpp>
#include <skybark/trees/bark_mesh.hpp>

namespace skybark::picture {

struct close_up {
    glm::vec3 eye{0, 1.6f, 2};
    glm::vec3 target{0, 1.4f, 0};
    float field = 40; ///< degrees, vertical
};

/// Draws the mesh with its bark, both made, into RGBA8 rows from the top. `map` is what
/// make_bark_image gives; `low` and `high` bound the tree, for its shadow.
template <backend B, class Mesh>
[[nodiscard]] result<std::vector<std::uint8_t>>
draw_bark(B& device, const Mesh& mesh, const trees::bark_mesh<B>& bark,
          const typename B::image& map, kernels::lit_bark wood, glm::vec3 low, glm::vec3 high,
          const close_up& camera, const picture_options& options) {
    const float ground = std::clamp(0.0f, low.y, high.y);
    kernels::scene_record scene = scene_around(glm::vec3(low.x, ground, low.z), high, options);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    const float distance = glm::distance(camera.eye, camera.target);
    scene.to_clip = glm::perspectiveRH_ZO(glm::radians(camera.field), aspect, distance * 0.05f,
                                          distance * 5000.0f) *
                    glm::lookAtRH(camera.eye, camera.target, glm::vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(camera.eye, 0);
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
    wood.repeats_around = static_cast<float>(bark.options().repeats_around);
    wood.repeats_along = bark.options().repeats_per_metre;
    const buffer_view<B> scene_view = view<B>(*scene_buffer);
    const sampled_image<B> shadow_map{&images[2], filter_mode::nearest, wrap_mode::clamp};
    const sampled_image<B> bark_map{&map, filter_mode::linear, wrap_mode::repeat};
    const auto drawn = run(device, [&](typename B::recorder& r) {
        draw_target<B> from_sun{nullptr, &images[2], {}, 1.0f};
        bark.for_each_draw(mesh, [&](buffer_view<B> vertices, const draw_geometry<B>& geometry) {
            r.draw(kernels::cast_shadow{}, {vertices, scene_view}, {}, geometry, from_sun,
                   draw_state{});
            from_sun.clear_depth.reset();
        });
        draw_target<B> picture{&images[0], &images[1], glm::vec4(0), 1.0f};
        bark.for_each_draw(mesh, [&](buffer_view<B> vertices, const draw_geometry<B>& geometry) {
            r.draw(wood, {vertices, scene_view}, {shadow_map, bark_map}, geometry, picture,
                   draw_state{});
            picture.clear_color.reset();
            picture.clear_depth.reset();
        });
        draw_geometry<B> plane;
        plane.count = 6;
        r.draw(kernels::meadow_ground{ground, 400 * (high.y - low.y)}, {scene_view}, {shadow_map},
               plane, picture, draw_state{});
        draw_geometry<B> screen;
        screen.count = 3;
        r.draw(kernels::clear_sky{}, {scene_view}, {}, screen, picture, draw_state{});
        r.draw(kernels::develop{samples, options.exposure}, {},
               {sampled_image<B>{&images[0], filter_mode::nearest, wrap_mode::clamp}}, screen,
               draw_target<B>{&images[3], nullptr, {}, {}}, draw_state{false, false});
    });
    if (!drawn) {
        return failure(drawn.error());
    }
    std::vector<std::uint8_t> pixels(std::size_t{4} * options.width * options.height);
    auto done = device.download(images[3], std::as_writable_bytes(std::span(pixels)));
    if (!done) {
        return failure(done.error());
    }
    return pixels;
}

} // namespace skybark::picture
