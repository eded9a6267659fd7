#pragma once
// A picture of clouds: over a country that their shadows fall on, in the sun, under a clear sky.

#include <picture/daylight.hpp>
#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/cloud_density.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/clear_sky.hpp>
#include <skybark/kernels/clouded_ground.hpp>
#include <skybark/kernels/develop.hpp>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <vector>

namespace skybark::picture {

struct cloud_picture_options {
    std::uint32_t width = 960;
    std::uint32_t height = 540;
    std::uint32_t supersampling = 1; ///< samples a pixel in each direction
    std::optional<glm::vec3> eye;    ///< m; absent: where all of it is seen from
    std::optional<glm::vec3> target; ///< m; with an eye
    float field_of_view = 40;        ///< degrees, vertical; 28 where the eye is absent
    double sun_azimuth = 120;        ///< degrees from north, clockwise
    double sun_elevation = 50;       ///< degrees
    double turbidity = 2.4;          ///< 2 very clear … 10 haze
    float air = 4e-5f;               ///< 1/m; what is 1/air away is hidden by 63 %
    std::optional<float> exposure;   ///< display value 1 over radiance; absent: by the daylight
    bool ground = true;
};

/// A camera before clouds that fill the box from `low` to `high`, and the light.
[[nodiscard]] inline kernels::scene_record cloud_scene(glm::vec3 low, glm::vec3 high,
                                                       const cloud_picture_options& options) {
    kernels::scene_record scene{};
    const glm::vec3 centre = (low + high) * 0.5f;
    const glm::vec3 half = glm::max((high - low) * 0.5f, glm::vec3(0.01f));
    const float across = std::max(half.x, half.z);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    const float field = glm::radians(options.eye ? options.field_of_view : 28.0f);
    const float reach = std::max(half.y, across / aspect) * 1.2f;
    const float distance = reach / std::tan(field * 0.5f) + across;
    // From below the base of what hangs over the ground at 0, else from its lower half.
    const float level = low.y > 0 ? std::max(0.5f * low.y, low.y - half.y) : low.y + 0.5f * half.y;
    const glm::vec3 eye = options.eye.value_or(
        glm::vec3(centre.x + 0.10f * distance, level, centre.z + 0.99f * distance));
    // Above the middle of the picture, so that something of the land is seen.
    const glm::vec3 target = options.target.value_or(centre - glm::vec3(0, 0.4f * half.y, 0));
    const glm::vec3 ahead = glm::normalize(target - eye);
    const glm::vec3 above = std::abs(ahead.y) > 0.999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    const float size = glm::length(half);
    const glm::mat4 lens =
        glm::perspectiveRH_ZO(field, aspect, 0.002f * size, 1000 * (size + distance));
    scene.to_clip = lens * glm::lookAtRH(eye, target, above);
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.to_shadow = glm::mat4(1);
    scene.camera = glm::vec4(eye, 0);
    // The sun's light is that in the middle of the clouds.
    scene.sky = daylight(direction_to_sun(options.sun_azimuth, options.sun_elevation),
                         options.turbidity, std::max(0.0f, centre.y));
    set_clear_day(scene.sky);
    // From a base at 1 km, a sixth of the land's light is lost in a day's haze, and more than a
    // third of the land that it sees lies in its own shadow.
    set_level_ambient(scene, land_below{glm::vec3(0.12f, 0.125f, 0.085f), 0.6f, 0.16f});
    return scene;
}

/// The exposure of a picture in this light, for what is white and faces the sun: less than in
/// proportion, so that evenings are darker.
[[nodiscard]] inline float exposure_for(const kernels::scene_record& scene) {
    const glm::vec3 white =
        kernels::ambient_of(scene, glm::vec3(0, 1, 0)) * 0.5f + glm::vec3(scene.sky.sunlight);
    const float luminance = 0.2126f * white.x + 0.7152f * white.y + 0.0722f * white.z;
    return 0.205f / std::pow(std::max(luminance, 0.01f), 0.45f);
}

/// Draws clouds, picture after picture, into images that it makes once.
template <volume_backend B>
class cloud_painter {
  public:
    /// For clouds of up to `most_particles`.
    [[nodiscard]] static result<cloud_painter>
    create(B& device, const cloud_picture_options& options, std::uint32_t most_particles) {
        auto puffs = clouds::cloud_billboards<B>::create(device, most_particles);
        if (!puffs) {
            return failure(puffs.error());
        }
        auto rays = clouds::cloud_density<B>::create(device);
        if (!rays) {
            return failure(rays.error());
        }
        cloud_painter made(options, std::move(*puffs), std::move(*rays));
        const std::uint32_t samples = std::max(1u, options.supersampling);
        const std::uint32_t width = options.width * samples;
        const std::uint32_t height = options.height * samples;
        const image_description wanted[] = {{width, height, image_format::rgba32f},
                                            {width, height, image_format::depth32f},
                                            {options.width, options.height, image_format::rgba8}};
        for (const image_description& what : wanted) {
            auto image = device.create_image(what);
            if (!image) {
                return failure(image.error());
            }
            made.images_.push_back(std::move(*image));
        }
        auto scene = device.create_buffer(sizeof(kernels::scene_record));
        if (!scene) {
            return failure(scene.error());
        }
        made.scene_ = std::move(*scene);
        return made;
    }

    /// Appends the drawing of a picture: the sky, the ground at the height `ground` (m), its shadow
    /// by light.sun, and `count` particles. The lighting's `air` is that of the options.
    void record(typename B::recorder& to, const kernels::scene_record& scene,
                const buffer_view<B>& particles, std::uint32_t count,
                clouds::cloud_light_sources<B> light, float ground) const {
        light.lighting.air = options_.air;
        draw_surroundings(to, scene, light, ground);
        puffs_.record(to, particles, count, glm::vec3(scene.camera), view<B>(*scene_), light,
                      draw_target<B>{&images_[0], &images_[1], {}, {}});
        show(to, scene);
    }

    /// The same with a grid of densities.
    void record(typename B::recorder& to, const kernels::scene_record& scene,
                const typename B::volume& density, const clouds::density_box& where,
                clouds::cloud_light_sources<B> light, float ground) const {
        light.lighting.air = options_.air;
        draw_surroundings(to, scene, light, ground);
        rays_.record(to, density, where, view<B>(*scene_), light, images_[0], images_[1]);
        show(to, scene);
    }

    /// The picture: RGBA8 rows from the top.
    [[nodiscard]] result<std::vector<std::uint8_t>> download(B& device) const {
        std::vector<std::uint8_t> pixels(std::size_t{4} * options_.width * options_.height);
        if (auto done = device.download(images_[2], std::as_writable_bytes(std::span(pixels)));
            !done) {
            return failure(done.error());
        }
        return pixels;
    }

    [[nodiscard]] const cloud_picture_options& options() const { return options_; }

  private:
    cloud_painter(const cloud_picture_options& options, clouds::cloud_billboards<B>&& puffs,
                  clouds::cloud_density<B>&& rays)
        : options_(options), puffs_(std::move(puffs)), rays_(std::move(rays)) {}

    void draw_surroundings(typename B::recorder& to, const kernels::scene_record& scene,
                           const clouds::cloud_light_sources<B>& light, float ground) const {
        to.upload(view<B>(*scene_), std::as_bytes(std::span(&scene, 1)));
        draw_target<B> picture{&images_[0], &images_[1], glm::vec4(0), 1.0f};
        draw_geometry<B> screen;
        screen.count = 3;
        to.draw(kernels::clear_sky{}, {view<B>(*scene_)}, {}, screen, picture, draw_state{});
        if (options_.ground) {
            picture.clear_color.reset();
            picture.clear_depth.reset();
            draw_geometry<B> plane;
            plane.count = 6;
            kernels::clouded_ground country;
            country.grid = light.lighting.sun_grid;
            country.height = ground;
            country.air = options_.air;
            volume_bindings<B, kernels::clouded_ground> shadow;
            shadow.read = {light.sun};
            to.draw(country, {view<B>(*scene_)}, {}, shadow, plane, picture, draw_state{});
        }
    }

    void show(typename B::recorder& to, const kernels::scene_record& scene) const {
        draw_geometry<B> screen;
        screen.count = 3;
        const std::uint32_t samples = std::max(1u, options_.supersampling);
        const float exposure = options_.exposure.value_or(exposure_for(scene));
        to.draw(kernels::develop{samples, exposure}, {},
                {sampled_image<B>{&images_[0], filter_mode::nearest, wrap_mode::clamp}}, screen,
                draw_target<B>{&images_[2], nullptr, {}, {}}, draw_state{false, false});
    }

    cloud_picture_options options_;
    clouds::cloud_billboards<B> puffs_;
    clouds::cloud_density<B> rays_;
    std::vector<typename B::image> images_; // samples, their depth, the picture
    std::optional<typename B::buffer> scene_;
};

} // namespace skybark::picture
