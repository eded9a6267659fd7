#pragma once
// A picture of a tree: on a meadow, in the sun, with its shadow, under a clear sky.

#include <picture/daylight.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/cast_leaf_shadow.hpp>
#include <skybark/kernels/cast_shadow.hpp>
#include <skybark/kernels/clear_sky.hpp>
#include <skybark/kernels/develop.hpp>
#include <skybark/kernels/lit_bark.hpp>
#include <skybark/kernels/lit_branch.hpp>
#include <skybark/kernels/lit_leaf.hpp>
#include <skybark/kernels/meadow_ground.hpp>
#include <skybark/trees/view_detail.hpp>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace skybark::picture {

struct picture_options {
    std::uint32_t width = 1280;
    std::uint32_t height = 800;
    std::uint32_t supersampling = 3; ///< samples a pixel in each direction
    bool skeleton = false;           ///< plain wood in place of bark
    std::optional<glm::vec3> eye;    ///< m; absent: where all of it is seen from
    std::optional<glm::vec3> target; ///< m; with an eye
    double sun_azimuth = 262;        ///< degrees from north, clockwise
    double sun_elevation = 38;       ///< degrees
    float exposure = 0.046f;
};

inline constexpr std::uint32_t shadow_texels = 4096;
inline constexpr float field = 0.5934119f; ///< rad, vertical: 34 degrees

/// The scene around a tree that fills the box from `low` to `high`.
[[nodiscard]] inline kernels::scene_record scene_around(glm::vec3 low, glm::vec3 high,
                                                        const picture_options& options) {
    kernels::scene_record scene{};
    const glm::vec3 centre = (low + high) * 0.5f;
    const glm::vec3 half = (high - low) * 0.5f;
    const float across = std::max({half.x, half.z, 0.01f});
    const float tall = std::max(half.y, 0.01f);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    const float reach = std::max(tall, across / aspect) * 1.12f;
    const float distance = reach / std::tan(field * 0.5f) + across;
    const glm::vec3 away(0.30f * distance, std::max(0.62f * tall, 0.05f), 0.95f * distance);
    const glm::vec3 eye = options.eye.value_or(glm::vec3(centre.x, low.y, centre.z) + away);
    const glm::vec3 target =
        options.target.value_or(glm::vec3(centre.x, centre.y - 0.10f * tall, centre.z));
    const glm::vec3 ahead = glm::normalize(target - eye);
    const glm::vec3 above = std::abs(ahead.y) > 0.999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    const glm::mat4 look = glm::lookAtRH(eye, target, above);
    const float near = 0.02f * (options.eye ? glm::distance(eye, target) : distance);
    const glm::mat4 lens = glm::perspectiveRH_ZO(field, aspect, near, distance * 2000.0f);
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

/// Level of detail for a picture of what fills the box from `low` to `high`.
[[nodiscard]] inline trees::view_detail view_of(glm::vec3 low, glm::vec3 high,
                                                const picture_options& options) {
    const kernels::scene_record scene =
        scene_around(glm::vec3(low.x, std::clamp(0.0f, low.y, high.y), low.z), high, options);
    trees::view_detail view;
    view.camera = glm::vec3(scene.camera);
    view.pixels_per_radian = static_cast<float>(options.height) / (2 * std::tan(field / 2));
    return view;
}

/// How something looks.
enum class look {
    plain, ///< one colour: the skeleton's sticks
    bark,  ///< by the painter's bark map
    leaf,  ///< cut out of the painter's leaf picture
};

/// Something to draw: vertices that have been made, and which of them.
template <backend B>
struct drawable {
    buffer_view<B> vertices;
    draw_geometry<B> geometry;
    look as = look::bark;
};

/// Pictures as they are laid over surfaces: RGBA, 4 bytes a texel.
struct surface_maps {
    std::uint32_t bark_width = 0;
    std::uint32_t bark_height = 0;
    std::vector<std::uint8_t> bark;             ///< trees::normal_map
    float bark_around = 2;                      ///< repeats, once around a branch
    float bark_along = 1.4f;                    ///< repeats a metre
    glm::vec3 bark_low{0.055f, 0.042f, 0.032f}; ///< albedo in the furrows
    glm::vec3 bark_high{0.31f, 0.255f, 0.205f}; ///< albedo on the ridges
    std::uint32_t leaf_width = 0;
    std::uint32_t leaf_height = 0;
    std::vector<std::uint8_t> leaf; ///< sRGB and coverage, first row at the stalk
};

/// Draws trees on a meadow, in the sun, with their shadows, under a clear sky: picture after
/// picture, into images that it makes once.
template <backend B>
class tree_painter {
  public:
    [[nodiscard]] static result<tree_painter> create(B& device, const picture_options& options,
                                                     const surface_maps& maps) {
        tree_painter made(options, maps);
        const std::uint32_t samples = std::max(1u, options.supersampling);
        const std::uint32_t width = options.width * samples;
        const std::uint32_t height = options.height * samples;
        const image_description wanted[] = {
            {width, height, image_format::rgba32f},
            {width, height, image_format::depth32f},
            {shadow_texels, shadow_texels, image_format::depth32f},
            {options.width, options.height, image_format::rgba8},
            {std::max(1u, maps.bark_width), std::max(1u, maps.bark_height), image_format::rgba8},
            {std::max(1u, maps.leaf_width), std::max(1u, maps.leaf_height), image_format::rgba8}};
        for (const image_description& what : wanted) {
            auto image = device.create_image(what);
            if (!image) {
                return failure(image.error());
            }
            made.images_.push_back(std::move(*image));
        }
        // Without a map: a flat one. Without a leaf's picture: a green that covers all.
        const std::vector<std::uint8_t> flat{128, 128, 255, 128};
        const std::vector<std::uint8_t> green{90, 130, 60, 255};
        const auto& bark = maps.bark.empty() ? flat : maps.bark;
        const auto& leaf = maps.leaf.empty() ? green : maps.leaf;
        if (auto done = device.upload(made.images_[4], std::as_bytes(std::span(bark))); !done) {
            return failure(done.error());
        }
        if (auto done = device.upload(made.images_[5], std::as_bytes(std::span(leaf))); !done) {
            return failure(done.error());
        }
        auto scene = device.create_buffer(sizeof(kernels::scene_record));
        if (!scene) {
            return failure(scene.error());
        }
        made.scene_ = std::move(*scene);
        return made;
    }

    /// Appends the drawing of a picture: the scene, what stands in it, and the ground's height and
    /// extent in m.
    void record(typename B::recorder& to, const kernels::scene_record& scene,
                std::span<const drawable<B>> all, float ground, float extent) const {
        to.upload(view<B>(*scene_), std::as_bytes(std::span(&scene, 1)));
        cast_shadows(to, all);
        draw_target<B> picture{&images_[0], &images_[1], glm::vec4(0), 1.0f};
        for (const drawable<B>& one : all) {
            draw_surface(to, one, picture);
            picture.clear_color.reset();
            picture.clear_depth.reset();
        }
        draw_geometry<B> plane;
        plane.count = 6;
        to.draw(kernels::meadow_ground{ground, extent}, {view<B>(*scene_)}, {shadow_map()}, plane,
                picture, draw_state{});
        picture.clear_color.reset();
        picture.clear_depth.reset();
        draw_geometry<B> screen;
        screen.count = 3;
        to.draw(kernels::clear_sky{}, {view<B>(*scene_)}, {}, screen, picture, draw_state{});
        const std::uint32_t samples = std::max(1u, options_.supersampling);
        to.draw(kernels::develop{samples, options_.exposure}, {},
                {sampled_image<B>{&images_[0], filter_mode::nearest, wrap_mode::clamp}}, screen,
                draw_target<B>{&images_[3], nullptr, {}, {}}, draw_state{false, false});
    }

    /// The picture: RGBA8 rows from the top.
    [[nodiscard]] result<std::vector<std::uint8_t>> download(B& device) const {
        std::vector<std::uint8_t> pixels(std::size_t{4} * options_.width * options_.height);
        if (auto done = device.download(images_[3], std::as_writable_bytes(std::span(pixels)));
            !done) {
            return failure(done.error());
        }
        return pixels;
    }

    [[nodiscard]] const picture_options& options() const { return options_; }

  private:
    tree_painter(const picture_options& options, const surface_maps& maps)
        : options_(options), wood_{glm::vec4(maps.bark_low, 0), glm::vec4(maps.bark_high, 0),
                                   maps.bark_around, maps.bark_along, 1} {}

    [[nodiscard]] sampled_image<B> shadow_map() const {
        return {&images_[2], filter_mode::nearest, wrap_mode::clamp};
    }
    [[nodiscard]] sampled_image<B> leaf_picture() const {
        return {&images_[5], filter_mode::linear, wrap_mode::clamp};
    }

    void cast_shadows(typename B::recorder& to, std::span<const drawable<B>> all) const {
        draw_target<B> from_sun{nullptr, &images_[2], {}, 1.0f};
        for (const drawable<B>& one : all) {
            if (one.as == look::leaf) {
                to.draw(kernels::cast_leaf_shadow{}, {one.vertices, view<B>(*scene_)},
                        {leaf_picture()}, one.geometry, from_sun, draw_state{});
            } else {
                to.draw(kernels::cast_shadow{}, {one.vertices, view<B>(*scene_)}, {}, one.geometry,
                        from_sun, draw_state{});
            }
            from_sun.clear_depth.reset();
        }
    }

    void draw_surface(typename B::recorder& to, const drawable<B>& one,
                      const draw_target<B>& picture) const {
        const buffer_view<B> scene = view<B>(*scene_);
        switch (one.as) {
        case look::plain:
            return to.draw(kernels::lit_branch{3.0f, 1u}, {one.vertices, scene}, {shadow_map()},
                           one.geometry, picture, draw_state{});
        case look::leaf:
            return to.draw(kernels::lit_leaf{}, {one.vertices, scene},
                           {shadow_map(), leaf_picture()}, one.geometry, picture, draw_state{});
        case look::bark:
            return to.draw(wood_, {one.vertices, scene},
                           {shadow_map(),
                            sampled_image<B>{&images_[4], filter_mode::linear, wrap_mode::repeat}},
                           one.geometry, picture, draw_state{});
        }
    }

    picture_options options_;
    kernels::lit_bark wood_;
    std::vector<typename B::image> images_; // samples, their depth, shadow, picture, bark, leaf
    std::optional<typename B::buffer> scene_;
};

/// Draws the branches of `mesh`, whose vertices have been made, into RGBA8 rows from the top.
/// The tree stands on the ground at y = 0, or at the bottom of its box if that is higher.
template <backend B, class Mesh>
[[nodiscard]] result<std::vector<std::uint8_t>>
draw_tree(B& device, const Mesh& mesh, glm::vec3 low, glm::vec3 high,
          const picture_options& options, const surface_maps& maps = {}) {
    const auto painter = tree_painter<B>::create(device, options, maps);
    if (!painter) {
        return failure(painter.error());
    }
    std::vector<drawable<B>> wood;
    for (const auto& part : mesh.parts()) {
        wood.push_back({view<B>(part.vertices), mesh.geometry(part),
                        options.skeleton ? look::plain : look::bark});
    }
    const float ground = std::clamp(0.0f, low.y, high.y);
    const auto scene = scene_around(glm::vec3(low.x, ground, low.z), high, options);
    if (auto drawn = run(device,
                         [&](typename B::recorder& r) {
                             painter->record(r, scene, wood, ground, 400 * (high.y - low.y));
                         });
        !drawn) {
        return failure(drawn.error());
    }
    return painter->download(device);
}

} // namespace skybark::picture
