#pragma once
// sky<B>: cumulus clouds that drift with the wind aloft, and the light in them, made anew each
// frame on the device.
//
//     auto clouds = sky<B>::create(device, what, now);
//     run(device, [&](auto& recorder) {
//         clouds->record(recorder, now, seconds);
//         … clouds->sun_volume(), clouds->sun_grid(): their shadow, by shared/cloud_shadow.glsl
//         clouds->draw(recorder, scene, eye, air);            // into an image of their own
//         clouds->compose(recorder, {&colour, &depth, {}, {}}); // behind what has been drawn
//     });
//
// The field is a disc 13 km across around the origin. What a frame shows
// follows from weather and time alone.

#include <meadow/description.hpp>
#include <meadow/sky_field.hpp>
#include <picture/daylight.hpp>
#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/drift.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/torn_billboards.hpp>
#include <skybark/kernels/cloud_layer.hpp>

#include <numbers>
#include <optional>

namespace skybark::meadow {

/// Velocity of the clouds, m/s along x and z: the wind aloft is 1.6 times as fast as near the
/// ground, and comes from 20 degrees further clockwise.
[[nodiscard]] inline glm::dvec2 wind_aloft(const weather& now) {
    const double from = (double{now.wind_from} + 20) * std::numbers::pi / 180;
    const double speed = 1.6 * double{now.wind};
    return {-speed * std::sin(from), speed * std::cos(from)};
}

template <volume_backend B>
class sky {
  public:
    /// Grows the clouds and sends them. At second 0 of the weather `now` the sun shines on the
    /// origin, where clouds leave room enough. `field` is what grows; its seed and its clearing are
    /// those of the others. Errors: those of the device.
    [[nodiscard]] static result<sky> create(B& device, const description& what, const weather& now,
                                            sky_field_options field = {}) {
        const auto droplets = clouds::phase_function::mie(10);
        if (!droplets) {
            return failure(droplets.error());
        }
        field.seed = what.seed;
        field.clearing = clearing_for(field, now);
        sky made(make_sky_field(field), *droplets);
        if (auto done = made.prepare(device, what); !done) {
            return failure(done.error());
        }
        made.face(now);
        return made;
    }

    /// Appends a frame: clouds drift, are lit from the sun and from straight above, and scatter
    /// that light many times. Sends nothing but parameters, allocates nothing.
    void record(typename B::recorder& to, const weather& now, double seconds) {
        record_moved(to, now, wind_aloft(now) * seconds);
    }

    /// The same for clouds that have moved by so much (m along x and z): for those who sum up a
    /// wind that changes.
    void record_moved(typename B::recorder& to, const weather& now, glm::dvec2 moved) {
        face(now);
        drift_->record(to, moved, count_);
        sun_->relight(to, drift_->particles(), count_, sun_box_);
        above_->relight(to, drift_->particles(), count_, above_box_);
        scattered_->solve(to, *sun_);
    }

    /// Draws the clouds of the latest `record` into an image of their own: `scene` is one
    /// kernels::scene_record on the device, of the same `eye`; `air` the extinction of the air
    /// between, 1/m.
    void draw(typename B::recorder& to, const buffer_view<B>& scene, glm::vec3 eye,
              float air = clear_air) const {
        clouds::cloud_light_sources<B> light = light_sources();
        light.lighting.air = air;
        puffs_->record(to, {drift_->particles(), drift_->rest(), count_}, eye, scene, light, ragged,
                       draw_target<B>{&*image_, nullptr, glm::vec4(0), {}});
    }

    /// Puts that image over the target where nothing has been drawn that writes depth. The target
    /// may be of any size; its proportions are those of the description.
    void compose(typename B::recorder& to, const draw_target<B>& target) const {
        draw_geometry<B> screen;
        screen.count = 3;
        to.draw(kernels::cloud_layer{}, {},
                {sampled_image<B>{&*image_, filter_mode::linear, wrap_mode::clamp}}, screen, target,
                draw_state{true, false, blend_mode::alpha});
    }

    /// Both: what a painter calls after the clear sky and all that is solid. The target has a
    /// depth image.
    void draw_clouds(typename B::recorder& to, const buffer_view<B>& scene, glm::vec3 eye,
                     const draw_target<B>& target, float air = clear_air) const {
        if (count_ != 0) {
            draw(to, scene, eye, air);
            compose(to, target);
        }
    }

    /// cloud_particle: count() of them, where the latest `record` has moved them.
    [[nodiscard]] buffer_view<B> particles() const {
        return view<B, cloud_particle>(*drift_->particles().buffer, 0, count_);
    }
    /// Those that make up the sky of the latest `record`; at most capacity().
    [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
    [[nodiscard]] std::uint32_t capacity() const noexcept { return drift_->capacity(); }

    /// What clouds are drawn with, in the latest `record`'s light.
    [[nodiscard]] clouds::cloud_light_sources<B> light_sources() const {
        clouds::cloud_light_sources<B> light;
        light.lighting = clouds::single_scattering(sun_->options(), sun_box_, phase_);
        clouds::add_sky(light.lighting, above_->options(), above_box_, phase_);
        clouds::add_diffuse(light.lighting, scattered_->grid(sun_box_));
        light.lighting.air = clear_air;
        light.sun = &sun_->volume();
        light.sky = &above_->volume();
        light.diffuse = &scattered_->fluence();
        return light;
    }
    /// Attenuation of the sun's light, everywhere in the world: shared::cloud_texel with sun_grid()
    /// of the latest `record`, then shared::cloud_light.
    [[nodiscard]] const typename B::volume& sun_volume() const { return sun_->volume(); }
    [[nodiscard]] const light_grid& sun_grid() const noexcept { return sun_box_.grid; }
    /// The part of the sky that clouds cover, straight up: within a particle's worth of what the
    /// weather asked for.
    [[nodiscard]] float cover() const noexcept { return cover_; }

    [[nodiscard]] const sky_field& field() const noexcept { return field_; }

    /// 1/m: of a fine day's air, between the eye and a cloud.
    static constexpr float clear_air = 2.5e-5f;
    /// How outlines are torn: grains of 120 m and half as large.
    static constexpr kernels::torn_puff ragged{0.62f, 1.0f / 130, 0.5f};

  private:
    sky(sky_field&& field, const clouds::phase_function& phase)
        : field_(std::move(field)), phase_(phase),
          bounds_(clouds::reach_of(field_.particles, field_.middles, field_.box)) {}

    /// Where no cloud is to be, so that the sun is seen from the origin.
    [[nodiscard]] static glm::dvec3 clearing_for(const sky_field_options& field,
                                                 const weather& now) {
        const glm::vec3 to_sun =
            picture::direction_to_sun(now.sun_azimuth, std::max(now.sun_elevation, 20.0));
        const float middle = field.base + 0.4f * field.thickness;
        const glm::dvec3 at = glm::dvec3(to_sun * (middle / std::max(to_sun.y, 0.1f)));
        const bool finite = std::isfinite(at.x) && std::isfinite(at.z);
        return finite ? glm::dvec3(at.x, at.z, 0.6 * double{field.width}) : glm::dvec3(0);
    }

    [[nodiscard]] result<void> prepare(B& device, const description& what) {
        const glm::uvec3 voxels(what.cloud_voxels);
        voxels_ = voxels;
        const clouds::attenuation_options light = clouds::light_of(phase_);
        clouds::multiple_scattering_options scattering;
        scattering.medium = clouds::medium_of(phase_, 1);
        scattering.cycles = 2;
        auto drift = clouds::drifting_particles<B>::create(
            device, std::span<const cloud_particle>(field_.particles),
            std::span<const glm::vec4>(field_.middles), field_.box);
        if (!drift) {
            return failure(drift.error());
        }
        drift_.emplace(std::move(*drift));
        auto puffs = clouds::torn_billboards<B>::create(device, drift_->capacity());
        if (!puffs) {
            return failure(puffs.error());
        }
        puffs_.emplace(std::move(*puffs));
        for (std::optional<clouds::attenuation_volume<B>>* volume : {&sun_, &above_}) {
            auto made = clouds::attenuation_volume<B>::create(device, voxels, light);
            if (!made) {
                return failure(made.error());
            }
            volume->emplace(std::move(*made));
        }
        auto scattered = clouds::multiple_scattering<B>::create(device, voxels, scattering);
        if (!scattered) {
            return failure(scattered.error());
        }
        scattered_.emplace(std::move(*scattered));
        auto image = device.create_image(
            {std::max(1u, what.width), std::max(1u, what.height), image_format::rgba32f});
        if (!image) {
            return failure(image.error());
        }
        image_.emplace(std::move(*image));
        for (const auto& [box, towards] : {std::pair{&sun_box_, glm::vec3(0, 1, 0)},
                                           std::pair{&above_box_, glm::vec3(0, 1, 0)}}) {
            const auto fitted = clouds::fit_light_box(bounds_, towards, voxels);
            if (!fitted) {
                return failure(fitted.error());
            }
            *box = *fitted;
        }
        return {};
    }

    /// Chooses as many clouds as the weather has, and turns the sun's box to the sun. A sun that
    /// is nowhere leaves it as it is.
    void face(const weather& now) {
        count_ = now.cloud > 0 ? field_.count_for(now.cloud) : 0;
        cover_ = field_.cover_of(count_);
        const auto fitted = clouds::fit_light_box(
            bounds_, picture::direction_to_sun(now.sun_azimuth, now.sun_elevation), voxels_);
        if (fitted) {
            sun_box_ = *fitted;
        }
    }

    sky_field field_;
    clouds::phase_function phase_;
    clouds::drift_bounds bounds_;
    glm::uvec3 voxels_{0};
    clouds::light_box sun_box_;
    clouds::light_box above_box_;
    std::uint32_t count_ = 0;
    float cover_ = 0;
    std::optional<clouds::drifting_particles<B>> drift_; // all are there after create
    std::optional<clouds::attenuation_volume<B>> sun_;
    std::optional<clouds::attenuation_volume<B>> above_;
    std::optional<clouds::multiple_scattering<B>> scattered_;
    std::optional<clouds::torn_billboards<B>> puffs_;
    std::optional<typename B::image> image_;
};

} // namespace skybark::meadow
