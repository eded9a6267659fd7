#pragma once
// light<B>: the meadow's light, gathered anew each frame: on the land's vertices, and in a volume
// over the stand for all that grows.
//
//     auto lit = light<B>::create(device, ground, stand_description, options);
//     run(device, [&](auto& recorder) {
//         lit->record(recorder, {sky, 0.4f}, {&attenuation, grid}, record_surfaces);
//     });
//     … draw with lit->land_irradiance() and lit->volume() …
//
// Light meets the inner land and the stand's coarse surfaces. The sun, dimmed by the clouds'
// attenuation volume at every patch, and the sky shine on them; `bounces` of light go from patch to
// patch; then what the land's vertices and the volume's points see is gathered. The sun's own beam
// is in neither: the picture adds it through its shadow map.
//
// Approximations: clouds dim the sun where their shadow is, but from the sky their light comes
// evenly, in proportion to what they cover, and they send down `cloud_light` of what shines on them
// from above. Below the horizon, and beyond the inner land's edge, is ground of the land's albedo
// in the mean light of sun, sky and clouds.
//
// Radiances in kcd/m² as in scene_record, irradiances in the same units times sr.

#include <meadow/land.hpp>
#include <meadow/solid_bodies.hpp>
#include <skybark/gather/bounces.hpp>
#include <skybark/gather/irradiance_volume.hpp>
#include <skybark/kernels/light_at_points.hpp>
#include <skybark/shared/daylight.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

namespace skybark::meadow {

struct light_options {
    std::uint32_t bounces = 2;
    std::uint32_t directions = 48; ///< that each bounce, and the last gather, look along
    std::uint64_t seed = 1;        ///< of the directions
    float patch_size = 2.6f;       ///< m: no patch has a longer edge
    glm::uvec3 points{40, 10, 40}; ///< of the volume over the stand
    float above_ground = 0.5f;     ///< m: the volume's points under the land gather so far above it
    gather::resolver_options resolver;
};

/// What shines from the sky.
struct sky_light {
    shared::daylight_sky clear; ///< sun and clear sky
    float cloud = 0;            ///< part of the sky that is covered, 0 … 1
};

/// What dims the sun: an attenuation volume, as clouds::attenuation_volume has it. None: nothing.
template <volume_backend B>
struct sun_shade {
    const typename B::volume* attenuation = nullptr;
    light_grid grid;
};

/// What the sky sends from everywhere, kcd/m².
class clouded_sky {
  public:
    /// Of what arrives on a cloud from above, this part leaves it below, evenly.
    static constexpr float cloud_light = 0.45f;

    clouded_sky() = default;
    clouded_sky(const sky_light& now, glm::vec3 ground_albedo) : clear_(now.clear) {
        cover_ = glm::clamp(now.cloud, 0.0f, 1.0f);
        const float up = glm::max(now.clear.to_sun.y, 0.0f);
        const glm::vec3 sun = std::numbers::pi_v<float> * up * glm::vec3(now.clear.sunlight);
        const glm::vec3 sky = irradiance_of(now.clear);
        constexpr float over_pi = std::numbers::inv_pi_v<float>;
        cloud_ = cloud_light * over_pi * (sun + sky);
        ground_ = ground_albedo * (over_pi * (1 - cover_) * (sun + sky) + cover_ * cloud_);
    }

    [[nodiscard]] glm::vec3 radiance(glm::vec3 to) const {
        return to.y > 0 ? glm::mix(shared::sky_radiance(clear_, to), cloud_, cover_) : ground_;
    }

  private:
    /// On level ground, of the clear sky without the sun: rings of equal π sin² of their height.
    [[nodiscard]] static glm::vec3 irradiance_of(const shared::daylight_sky& sky) {
        constexpr int rings = 12;
        constexpr int sectors = 24;
        glm::vec3 sum(0);
        for (int ring = 0; ring < rings; ++ring) {
            const float flat = std::sqrt((static_cast<float>(ring) + 0.5f) / rings);
            const float up = std::sqrt(1 - flat * flat);
            for (int sector = 0; sector < sectors; ++sector) {
                const float turn = 2 * std::numbers::pi_v<float> / sectors;
                const float angle = turn * (static_cast<float>(sector) + 0.5f);
                sum +=
                    shared::sky_radiance(sky, {flat * std::cos(angle), up, flat * std::sin(angle)});
            }
        }
        return sum * (std::numbers::pi_v<float> / (rings * sectors));
    }

    shared::daylight_sky clear_{};
    glm::vec3 cloud_{0};
    glm::vec3 ground_{0};
    float cover_ = 0;
};

template <class B>
concept lights_meadows = gather::gathers_volumes<B> && maps_grids<B, kernels::light_at_points>;

template <lights_meadows B>
class light {
  public:
    /// On the inner land and the stand's surfaces: triangles as they are at rest (or will be at
    /// first), their materials and alpha maps, as gather_scene takes them; the box, if given, is
    /// where the stand's triangles will be. Errors: those of gather_scene and final_gather.
    [[nodiscard]] static result<light> create(B& device, const land& ground,
                                              const gather::scene_description& stand,
                                              const light_options& options = {}) {
        light made(options);
        if (auto done = made.make_scene(device, ground, stand); !done) {
            return failure(done.error());
        }
        const solid_bodies wood(stand.triangles, stand.materials);
        if (auto done = made.make_gathers(device, ground, wood); !done) {
            return failure(done.error());
        }
        return made;
    }

    /// Everything of a frame. `record_surfaces(recorder, triangles)` writes the stand's triangles
    /// as they are now, in their number and order, to the start of a view of gather_triangles. What
    /// is found depends on nothing that was before. Allocates nothing but at the first time.
    template <class RecordSurfaces>
    void record(typename B::recorder& recorder, const sky_light& now, const sun_shade<B>& clouds,
                const RecordSurfaces& record_surfaces) {
        *sky_ = clouded_sky(now, land::albedo);
        record_surfaces(recorder, stand_triangles());
        scene_->record_samples(recorder);
        record_sun(recorder, now, clouds);
        bounces_->record_restart(recorder);
        for (std::uint32_t i = 0; i < options_.bounces; ++i) {
            bounces_->record(recorder);
        }
        land_gather_->record_restart(recorder, options_.seed);
        land_gather_->record(recorder, options_.directions);
        land_gather_->record_irradiance(recorder, land_irradiance());
        volume_->record(recorder, options_.directions);
    }

    /// From the next frame on.
    void bounce(std::uint32_t bounces) { options_.bounces = bounces; }

    /// Irradiance of each of the land's inner vertices, without the sun's beam: a vec4 each.
    [[nodiscard]] buffer_view<B> land_irradiance() const { return view<B>(*land_light_); }
    /// The light over the stand, without the sun's beam.
    [[nodiscard]] const gather::irradiance_volume<B>& volume() const { return *volume_; }

    /// What light meets. The stand's triangles come first, then the land's.
    [[nodiscard]] const gather::gather_scene<B>& scene() const { return *scene_; }
    /// At which light is gathered for the picture: vertices and points.
    [[nodiscard]] std::uint64_t gather_points() const {
        const glm::uvec3 n = options_.points;
        return land_gather_->samples() + std::uint64_t{n.x} * n.y * n.z;
    }

  private:
    explicit light(const light_options& options)
        : options_(options), sky_(std::make_unique<clouded_sky>()) {}

    [[nodiscard]] buffer_view<B> stand_triangles() const {
        return {scene_->triangles().buffer, 0,
                std::uint64_t{stand_count_} * sizeof(gather_triangle)};
    }

    [[nodiscard]] result<void> make_scene(B& device, const land& ground,
                                          const gather::scene_description& stand) {
        std::vector<gather_triangle> triangles(stand.triangles.begin(), stand.triangles.end());
        std::vector<gather_material> materials(stand.materials.begin(), stand.materials.end());
        stand_count_ = static_cast<std::uint32_t>(triangles.size());
        ground.add_light_triangles(triangles, static_cast<std::uint32_t>(materials.size()));
        lowest_ = gather::bounds_of(std::span(triangles).subspan(stand_count_)).low.y;
        gather_material grass;
        grass.diffuse = land::albedo;
        materials.push_back(grass);

        gather::bounds box = gather::bounds_of(triangles);
        if (stand.box) {
            box.add(stand.box->low);
            box.add(stand.box->high);
        }
        gather::scene_description what;
        what.triangles = triangles;
        what.materials = materials;
        what.alpha = stand.alpha;
        what.patch_size = options_.patch_size;
        what.box = box;
        auto made = gather::gather_scene<B>::create(device, what);
        if (!made) {
            return failure(made.error());
        }
        scene_ = std::make_unique<gather::gather_scene<B>>(std::move(*made));
        return {};
    }

    [[nodiscard]] result<void> make_gathers(B& device, const land& ground,
                                            const solid_bodies& wood) {
        gather::bounce_options bounced;
        bounced.axes = options_.directions;
        bounced.gather.seed = options_.seed;
        bounced.gather.resolver = options_.resolver;
        bounced.gather.sky = [sky = sky_.get()](glm::vec3 to) { return sky->radiance(to); };
        auto bounces = gather::bounced_light<B>::create(device, *scene_, bounced);
        const auto vertices = inner_vertices(ground, wood);
        auto land_gather =
            gather::final_gather<B>::create(device, *scene_, vertices, bounced.gather);
        auto volume = make_volume(device, ground, wood, bounced.gather);
        auto land_light = device.create_buffer(vertices.size() * sizeof(glm::vec4));
        auto arriving = device.create_buffer(scene_->patch_count() * sizeof(glm::vec4));
        for (const result<void>& done :
             {keep(bounces_, bounces), keep(land_gather_, land_gather), keep(volume_, volume),
              keep(land_light_, land_light), keep(arriving_, arriving)}) {
            if (!done) {
                return done;
            }
        }
        return {};
    }

    template <class T>
    [[nodiscard]] static result<void> keep(std::optional<T>& slot, result<T>& made) {
        if (!made) {
            return failure(made.error());
        }
        slot.emplace(std::move(*made));
        return {};
    }

    /// The land's inner vertices, on the coarser land that light meets: many of them lie below it,
    /// and would be in the dark. Those that a tree stands on are moved to beside it.
    [[nodiscard]] static std::vector<gather_sample> inner_vertices(const land& ground,
                                                                   const solid_bodies& wood) {
        constexpr std::size_t count = std::size_t{land::points} * land::points;
        // Trees need not reach down to the ground, and are widest there.
        constexpr float heights[] = {0.3f, 0.1f, 0};
        std::vector<gather_sample> samples(count);
        const land_mesh mesh = ground.mesh();
        for (std::size_t i = 0; i < count; ++i) {
            glm::vec3 at = mesh.vertices[i].position;
            for (const float height : heights) {
                at.x = wood.outside(at + glm::vec3(0, height, 0)).x;
            }
            samples[i].position = {at.x, ground.light_height(at.x, at.z), at.z};
            samples[i].normal = ground.normal(at.x, at.z);
        }
        return samples;
    }

    /// Over the stand, up to its top: points that would lie under the land gather above it, those
    /// in wood beside it.
    [[nodiscard]] result<gather::irradiance_volume<B>>
    make_volume(B& device, const land& ground, const solid_bodies& wood,
                const gather::final_gather_options& like) const {
        gather::irradiance_volume_options how;
        how.seed = like.seed;
        how.sky = like.sky;
        how.resolver = like.resolver;
        how.gathered_at = [&](glm::vec3 place) {
            const float least = ground.light_height(place.x, place.z) + options_.above_ground;
            return wood.outside({place.x, std::max(place.y, least), place.z});
        };
        constexpr float half = 0.5f * land::side;
        gather::bounds box;
        box.low = {-half, lowest_, -half};
        box.high = {half, std::max(scene_->box().high.y, lowest_ + 10), half};
        return gather::irradiance_volume<B>::create(device, *scene_, box, options_.points, how);
    }

    /// The part of the sun's beam that arrives at each patch, and the beam.
    void record_sun(typename B::recorder& recorder, const sky_light& now,
                    const sun_shade<B>& clouds) {
        bounces_->forget_sources();
        if (now.clear.to_sun.y <= 0) {
            return;
        }
        buffer_view<B> arriving;
        if (clouds.attenuation != nullptr) {
            arriving = view<B>(*arriving_);
            kernels::light_at_points shade;
            shade.grid = clouds.grid;
            shade.stride = sizeof(gather_sample) / sizeof(glm::vec4);
            volume_bindings<B, kernels::light_at_points> volumes;
            volumes.read = {clouds.attenuation, clouds.attenuation};
            recorder.map(shade, {scene_->patch_samples(), arriving}, volumes,
                         range{0, scene_->patch_count()});
        }
        bounces_->light_from(glm::vec3(now.clear.to_sun),
                             std::numbers::pi_v<float> * glm::vec3(now.clear.sunlight), arriving);
    }

    light_options options_;
    std::uint32_t stand_count_ = 0;
    float lowest_ = 0;                 ///< of the inner land, m
    std::unique_ptr<clouded_sky> sky_; ///< what the gathers look at: where they know it
    std::unique_ptr<gather::gather_scene<B>> scene_;
    std::optional<gather::bounced_light<B>> bounces_;
    std::optional<gather::final_gather<B>> land_gather_;
    std::optional<gather::irradiance_volume<B>> volume_;
    std::optional<typename B::buffer> land_light_;
    std::optional<typename B::buffer> arriving_;
};

} // namespace skybark::meadow
