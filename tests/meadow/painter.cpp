// The meadow's painter: light on surfaces against closed forms in double precision, on every
// backend; where shadows fall; and the same picture of a small scene everywhere.

#include "support/allocations.hpp"
#include "support/devices.hpp"

#include <meadow/painter.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/leaf_layout.hpp>
#include <skybark/trees/leaf_mesh.hpp>
#include <skybark/trees/leaf_texture.hpp>
#include <skybark/trees/species.hpp>

#include <gtest/gtest.h>
#include <numbers>

using namespace skybark;
using glm::dvec2;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using meadow::drawable;
using meadow::look;
using meadow::material;

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::array backends{"cpu", "opengl", "vulkan"};

constexpr meadow::description small_picture() {
    meadow::description what;
    what.width = 96;
    what.height = 54;
    what.supersampling = 1;
    return what;
}

/// Level triangles of `side` m around (x, y, z), which look up, with plain texture directions.
std::vector<surface_vertex> level_square(vec3 at, float side) {
    std::vector<surface_vertex> corners;
    for (const glm::vec2 c : {glm::vec2(0, 0), {0, 1}, {1, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        surface_vertex v;
        v.position = at + side * vec3(c.x - 0.5f, 0, c.y - 0.5f);
        v.u = c.x;
        v.v = c.y;
        v.normal = {0, 1, 0};
        corners.push_back(v);
    }
    return corners;
}

/// Land at height 0 that shows the first irradiance.
std::vector<surface_vertex> level_land(float side) {
    std::vector<surface_vertex> land = level_square({0, 0, 0}, side);
    for (surface_vertex& v : land) {
        v.u = v.v = 0;
    }
    return land;
}
constexpr std::array<std::uint32_t, 6> land_indices{0, 1, 2, 3, 4, 5};

material plain_bark(vec3 albedo) {
    material bark;
    bark.low = bark.high = albedo;
    return bark;
}
/// Green leaves; what is covered is the half of the picture with u < ½, or all of it.
material leaf_of(std::array<std::uint8_t, 3> color, bool half = false) {
    material leaf;
    leaf.as = look::leaf;
    leaf.width = leaf.height = 64;
    for (std::uint32_t i = 0; i < 64 * 64; ++i) {
        const bool covered = !half || i % 64 < 32;
        leaf.texels.insert(leaf.texels.end(), color.begin(), color.end());
        leaf.texels.push_back(covered ? 255 : 0);
    }
    return leaf;
}

/// The light that falls on everything: irradiance that is `even` from all around, and more by
/// `upward` · n.y on a surface of normal n; the sun through clouds of an optical depth.
struct weather_of_a_test {
    vec3 even{0};
    vec3 upward{0};
    vec3 land{0};     ///< irradiance of the land
    vec3 sunlight{0}; ///< irradiance over π
    float west = 0;   ///< attenuation of the sun where x < 0
    float east = 0;   ///< … and where it is not
    float shadow = 1; ///< strength of it
    float air = 0;    ///< 1/m
};

/// A camera, the sun, and what is drawn.
template <volume_backend B>
class stage {
  public:
    stage(B& device, const meadow::description& what, std::span<const material> materials,
          float land_side = 100)
        : device_(&device), what_(what),
          painter_(*meadow::painter<B>::create(device, what, materials, level_land(land_side),
                                               land_indices)) {}

    void add(std::span<const surface_vertex> vertices, look as, std::uint32_t number) {
        buffers_.push_back(std::make_unique<typename B::buffer>(
            *make_buffer<B, surface_vertex>(*device_, vertices)));
        drawable<B> one;
        one.vertices = view<B>(*buffers_.back());
        one.geometry.count = static_cast<std::uint32_t>(vertices.size());
        one.as = as;
        one.material = number;
        all.push_back(one);
    }

    /// RGBA32F samples, row after row from the top.
    std::vector<vec4> draw(const kernels::scene_record& from, const weather_of_a_test& now) {
        kernels::scene_record scene = from;
        scene.sky.sunlight = vec4(now.sunlight, 0);
        const kernels::surroundings_record around = light(now);
        const auto done = run(*device_, [&](typename B::recorder& r) {
            painter_.record(r, scene, around, all,
                            {now.shadow > 0 ? &*clouds_ : nullptr, &*gathered_, view<B>(*land_)},
                            [](auto&, const auto&, const auto&) {});
        });
        EXPECT_TRUE(done) << done.error().message;
        std::vector<vec4> samples(std::size_t{what_.width} * what_.height);
        EXPECT_TRUE(
            device_->download(painter_.radiance(), std::as_writable_bytes(std::span(samples))));
        return samples;
    }

    std::vector<drawable<B>> all;

  private:
    typename B::volume volume(glm::uvec3 size, const std::vector<float>& voxels) {
        auto made = device_->create_volume({size.x, size.y, size.z, volume_format::float32});
        EXPECT_TRUE(made) << made.error().message;
        EXPECT_TRUE(device_->upload(*made, std::as_bytes(std::span(voxels))));
        return std::move(*made);
    }

    /// Volumes and the record that goes with them. Irradiance of real harmonics up to l = 1 is
    /// π Y00 c0 + (2π/3) √(3/4π) c1y n.y + …, Y00 = 1/√(4π).
    kernels::surroundings_record light(const weather_of_a_test& now) {
        const double c0 = std::sqrt(4 * pi) / pi;
        const double c1 = 3 / (2 * pi) * std::sqrt(4 * pi / 3);
        constexpr std::uint32_t points = 2;
        std::vector<float> harmonics;
        for (std::uint32_t z = 0; z < points; ++z) {
            for (int color = 0; color < 3; ++color) {
                for (int k = 0; k < 4; ++k) {
                    const double value = k == 0   ? c0 * double{now.even[color]}
                                         : k == 1 ? c1 * double{now.upward[color]}
                                                  : 0.0;
                    harmonics.insert(harmonics.end(), points * points, static_cast<float>(value));
                }
            }
        }
        gathered_ = volume({points, 12 * points, points}, harmonics);
        // 64 voxels across, so that the clouds' edge is a metre wide.
        std::vector<float> attenuation;
        for (int i = 0; i < 4 * 4; ++i) {
            attenuation.insert(attenuation.end(), 32, now.west);
            attenuation.insert(attenuation.end(), 32, now.east);
        }
        clouds_ = volume({64, 4, 4}, attenuation);
        land_ = *make_buffer<B, vec4>(*device_, std::array{vec4(now.land, 0)});
        kernels::surroundings_record around{};
        around.clouds.row_x = {1, 0, 0, 32};
        around.clouds.row_y = {0, 1, 0, 2};
        around.clouds.row_z = {0, 0, 1, 2};
        around.gathered.low = {-50, -50, -50, 0};
        around.gathered.per_step = vec4(vec3(0.01f), 0);
        around.gathered.points = vec4(vec3(points), 0);
        around.cloud_shadow = now.shadow;
        around.air = now.air;
        return around;
    }

    B* device_;
    meadow::description what_;
    meadow::painter<B> painter_;
    std::vector<std::unique_ptr<typename B::buffer>> buffers_;
    std::optional<typename B::volume> clouds_, gathered_;
    std::optional<typename B::buffer> land_;
};

/// From the south and above, at the middle.
meadow::camera above() {
    meadow::camera from;
    from.eye = {0, 30, 20};
    from.target = {0, 0, 0};
    from.field = 0.7f;
    return from;
}

kernels::scene_record scene_of(const meadow::camera& from, const meadow::weather& now,
                               const meadow::shadow_box& box = {{-20, 0, -20}, {20, 10, 20}}) {
    const meadow::description what = small_picture();
    return meadow::scene_for(from, 0, now,
                             static_cast<float>(what.width) / static_cast<float>(what.height), box);
}

/// Where the ray through the middle of a pixel meets the plane y = 0, from the camera alone.
dvec3 ground_at(std::size_t pixel, const meadow::camera& from) {
    const meadow::description what = small_picture();
    const dvec3 ahead = glm::normalize(dvec3(from.target) - dvec3(from.eye));
    const dvec3 right = glm::normalize(glm::cross(ahead, dvec3(0, 1, 0)));
    const dvec3 up = glm::cross(right, ahead);
    const double reach = std::tan(double{from.field} / 2);
    const double aspect = static_cast<double>(what.width) / what.height;
    const double u = (static_cast<double>(pixel % what.width) + 0.5) / what.width * 2 - 1;
    const double v = 1 - (static_cast<double>(pixel / what.width) + 0.5) / what.height * 2;
    const dvec3 ray = ahead + right * (u * reach * aspect) + up * (v * reach);
    return dvec3(from.eye) - ray * (double{from.eye.y} / ray.y);
}

dvec3 to_sun_of(const meadow::weather& now) {
    const double azimuth = now.sun_azimuth * pi / 180;
    const double elevation = now.sun_elevation * pi / 180;
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
            -std::cos(azimuth) * std::cos(elevation)};
}

void expect_near(dvec3 expected, vec4 actual, double relative, const std::string& what) {
    for (int i = 0; i < 3; ++i) {
        ASSERT_NEAR(double{actual[i]}, expected[i], relative * std::abs(expected[i]) + 1e-6)
            << what << ", channel " << i;
    }
}

/// Linear light of an sRGB byte (IEC 61966-2-1).
double linear_of(int byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

constexpr vec3 red_light(45, 30, 15);
constexpr vec3 blue_light(7.5f, 15, 22.5f);
constexpr vec3 albedo(0.5f, 0.25f, 0.125f);

} // namespace

class painter : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(on, painter, testing::ValuesIn(backends),
                         [](const auto& each) { return std::string(each.param); });

// Radiance = albedo · (E/π + sunlight · cos · T), within 1 %: T by the clouds' attenuation on
// either side, and by half of their shadow. (Formulas round to 1e-4; the map's filter is exact
// here.)
TEST_P(painter, bark_in_the_sun_and_under_clouds_is_as_bright_as_it_should_be) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const std::array materials{plain_bark(albedo)};
        stage<B> scene(device, small_picture(), materials);
        scene.add(level_square({0, 1, 0}, 90), look::bark, 0);
        meadow::weather now;
        const double cosine = to_sun_of(now).y;
        meadow::shadow_box box{{-45, 0, -45}, {45, 10, 45}};
        const kernels::scene_record from = scene_of(above(), now, box);
        for (const float strength : {0.0f, 0.5f, 1.0f}) {
            weather_of_a_test light{red_light, blue_light, {}, {30, 28, 25}, 0.8f, 0, strength};
            const auto pixels = scene.draw(from, light);
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const double x = ground_at(i, above()).x;
                if (std::abs(x) < 2) {
                    continue; // the clouds' edge is a voxel wide
                }
                const double part = x < 0 ? 1 - double{strength} * (1 - std::exp(-0.8)) : 1.0;
                const dvec3 arriving =
                    dvec3(red_light + blue_light) / pi + dvec3(light.sunlight) * (cosine * part);
                expect_near(dvec3(albedo) * arriving, pixels[i], 0.01,
                            "strength " + std::to_string(strength) + ", x " + std::to_string(x));
                if (testing::Test::HasFatalFailure()) {
                    return;
                }
            }
        }
    });
}

// A leaf that is seen from above, lit by the sun from above or from below. What falls on its upper
// side leaves it as R, what falls on its lower side comes through as R · (1.1, 1, 0.3) · 0.8. The
// colour's sRGB is decoded by a cubic within 0.002.
TEST_P(painter, leaves_are_lit_from_both_sides) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const std::array<std::uint8_t, 3> color{188, 150, 120};
        const std::array materials{leaf_of(color)};
        stage<B> scene(device, small_picture(), materials);
        scene.add(level_square({0, 1, 0}, 90), look::leaf, 0);
        scene.all[0].casts = false; // nothing does
        for (const bool above_it : {true, false}) {
            meadow::weather now;
            kernels::scene_record from = scene_of(above(), now, {{-45, 0, -45}, {45, 10, 45}});
            if (!above_it) {
                from.sky.to_sun.y = -from.sky.to_sun.y;
                meadow::fit_shadow(from, {{-45, 0, -45}, {45, 10, 45}});
            }
            const weather_of_a_test light{red_light, blue_light, {}, {30, 28, 25}, 0.3f, 0.3f};
            const auto pixels = scene.draw(from, light);
            const double cosine = to_sun_of(now).y * std::exp(-0.3);
            for (int i = 0; i < 3; ++i) {
                const double reflected = linear_of(color[static_cast<std::size_t>(i)]);
                const double through =
                    reflected * std::array{1.1, 1.0, 0.3}[static_cast<std::size_t>(i)] * 0.8;
                const double even = double{red_light[i]};
                const double upward = double{blue_light[i]};
                const double sun = double{light.sunlight[i]} * cosine;
                const double expected =
                    reflected * ((even + upward) / pi + (above_it ? sun : 0)) +
                    through * (std::max(even - upward, 0.0) / pi + (above_it ? 0 : sun));
                // 0.002 of the linear value, and the formula's rounding.
                const double tolerance = expected * (0.002 / reflected + 0.002);
                for (const std::size_t pixel : {std::size_t{0}, pixels.size() / 2 + 48}) {
                    ASSERT_NEAR(double{pixels[pixel][i]}, expected, tolerance)
                        << (above_it ? "sun above" : "sun below") << ", channel " << i;
                }
            }
        }
    });
}

// The land's albedo is noise: what light makes of it goes by ratios of two pictures.
TEST_P(painter, land_shows_its_irradiance_the_sun_and_the_clouds) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> scene(device, small_picture(), {});
        meadow::weather now;
        const kernels::scene_record from = scene_of(above(), now);
        weather_of_a_test light;
        light.land = vec3(static_cast<float>(pi));
        const auto reflectance = scene.draw(from, light);
        light = {{}, {}, red_light, {30, 28, 25}, 1.5f, -0.25f};
        const auto pixels = scene.draw(from, light);
        double least = 1;
        double most = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const double x = ground_at(i, above()).x;
            if (std::abs(x) < 2) {
                continue;
            }
            least = std::min(least, double{reflectance[i].y});
            most = std::max(most, double{reflectance[i].y});
            const double part = std::exp(x < 0 ? -1.5 : 0.25); // negative attenuation amplifies
            const dvec3 arriving =
                dvec3(red_light) / pi + dvec3(light.sunlight) * (to_sun_of(now).y * part);
            expect_near(dvec3(reflectance[i]) * arriving, pixels[i], 0.01,
                        "x " + std::to_string(x));
            if (testing::Test::HasFatalFailure()) {
                return;
            }
        }
        EXPECT_GT(least, 0.01); // grass
        EXPECT_LT(most, 0.3);
        EXPECT_GT(most, least * 1.2);
    });
}

// Black things far away are as bright as 1 − e^(−air · distance) of the air before them.
TEST_P(painter, air_hides_by_its_extinction) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        stage<B> scene(device, small_picture(), {}, 40000);
        meadow::weather now;
        meadow::camera from = above();
        from.eye = {0, 100, 100};
        from.target = {0, 85, 0};
        const kernels::scene_record seen = scene_of(from, now);
        weather_of_a_test thin;
        thin.air = 1e-4f;
        weather_of_a_test thick;
        thick.air = 1e-3f;
        const auto a = scene.draw(seen, thin);
        const auto b = scene.draw(seen, thick);
        std::size_t seen_far = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            const dvec3 place = ground_at(i, from);
            const double distance = glm::length(place - dvec3(from.eye));
            if (place.z > 0 || std::max(std::abs(place.x), std::abs(place.z)) > 19000 ||
                distance > 1e5 || distance < 100 || place.z != place.z) {
                continue;
            }
            ++seen_far;
            const double expected = -std::expm1(-1e-4 * distance) / -std::expm1(-1e-3 * distance);
            ASSERT_NEAR(double{a[i].y} / double{b[i].y}, expected, 0.01 * expected)
                << distance << " m";
            ASSERT_GT(a[i].y, 0);
        }
        EXPECT_GT(seen_far, 500u);
    });
}

// A level square 6 m above the ground darkens what lies beneath it along the sun's rays, and
// nothing else. The shadow's edge is 4 texels of at most 3 cm wide, and its bias is 1.5 texels.
TEST_P(painter, shadows_fall_where_the_sun_does_not_reach) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        for (const look as : {look::bark, look::leaf}) {
            const std::array materials{plain_bark(albedo), leaf_of({120, 150, 80}, true)};
            stage<B> scene(device, small_picture(), materials);
            constexpr float height = 6;
            scene.add(level_square({0, height, 0}, 8), as, as == look::leaf ? 1 : 0);
            meadow::weather now;
            now.sun_azimuth = 300; // so that the square does not hide its shadow
            now.sun_elevation = 40;
            const dvec3 sun = to_sun_of(now);
            const meadow::camera from = above();
            const kernels::scene_record seen = scene_of(from, now);
            const weather_of_a_test light{{}, {}, red_light, {30, 30, 30}};
            weather_of_a_test shade = light;
            shade.sunlight = vec3(0);
            const auto in_sun = scene.draw(seen, light);
            const auto without = scene.draw(seen, shade);
            // A leaf's picture covers u < ½: the western half.
            const double east = as == look::leaf ? 0.0 : 4.0;
            std::size_t dark = 0;
            std::size_t bright = 0;
            for (std::size_t i = 0; i < in_sun.size(); ++i) {
                const dvec3 place = ground_at(i, from);
                const dvec3 back = dvec3(from.eye) - place; // towards the eye
                const dvec3 crossing = place + back * (height / back.y);
                if (std::max(std::abs(crossing.x), std::abs(crossing.z)) < 4.2) {
                    continue; // the square itself is in front
                }
                const dvec3 above_it = place + sun * (height / sun.y);
                const double outside =
                    std::max({-4 - above_it.x, above_it.x - east, std::abs(above_it.z) - 4});
                if (std::abs(outside) < 0.25) {
                    continue;
                }
                const double direct = double{in_sun[i].y} - double{without[i].y};
                const double full = double{without[i].y} / double{red_light.y} * pi * 30 * sun.y;
                (outside < 0 ? dark : bright)++;
                ASSERT_NEAR(direct, outside < 0 ? 0.0 : full, 0.01 * full)
                    << "at " << place.x << ", " << place.z << ", " << outside << " m outside";
            }
            EXPECT_GT(dark, 50u);
            EXPECT_GT(bright, 1000u);
        }
    });
}

TEST(painter, shadow_maps_hold_their_box_and_begin_at_whole_texels) {
    for (const double azimuth : {10.0, 100.0, 235.0}) {
        for (const double elevation : {3.0, 34.0, 89.0, 90.0}) {
            meadow::weather now;
            now.sun_azimuth = azimuth;
            now.sun_elevation = elevation;
            const meadow::shadow_box box{{-70, -1, -75}, {81, 24, 60}};
            const auto scene = scene_of(above(), now, box);
            double widest = 0;
            for (unsigned corner = 0; corner < 8; ++corner) {
                const vec3 at((corner & 1) != 0 ? box.high.x : box.low.x,
                              (corner & 2) != 0 ? box.high.y : box.low.y,
                              (corner & 4) != 0 ? box.high.z : box.low.z);
                const vec4 p = scene.to_shadow * vec4(at, 1);
                EXPECT_LE(std::abs(p.x), 1) << azimuth << ", " << elevation;
                EXPECT_LE(std::abs(p.y), 1);
                EXPECT_GE(p.z, 0);
                EXPECT_LE(p.z, 1);
                widest = std::max({widest, std::abs(double{p.x}), std::abs(double{p.y})});
            }
            EXPECT_GT(widest, 0.97); // and little else
            // The sun sees its rays as points, nearer ones at smaller depths.
            const dvec3 sun = to_sun_of(now);
            const vec4 low = scene.to_shadow * vec4(1, 2, 3, 1);
            const vec4 high = scene.to_shadow * vec4(vec3(dvec3(1, 2, 3) + 4.0 * sun), 1);
            EXPECT_NEAR(low.x, high.x, 1e-4);
            EXPECT_NEAR(low.y, high.y, 1e-4);
            EXPECT_LT(high.z, low.z);
            // Another place of the same box moves the map by whole texels.
            const vec3 step(0.37f, 0, -0.21f);
            const auto moved = scene_of(above(), now, {box.low + step, box.high + step}).to_shadow *
                               vec4(1, 2, 3, 1);
            for (int a = 0; a < 2; ++a) {
                const double texels = (double{moved[a]} - double{low[a]}) * 0.5 * 4096;
                EXPECT_NEAR(texels, std::round(texels), 0.05) << azimuth << ", " << elevation;
            }
        }
    }
}

TEST(painter, the_camera_sees_its_target_from_above_the_ground) {
    meadow::camera from;
    const auto scene = meadow::scene_for(from, 1.5f, {}, 16.0f / 9, {});
    EXPECT_FLOAT_EQ(scene.camera.y, from.eye.y + 1.5f);
    const vec4 seen = scene.to_clip * vec4(from.target, 1);
    EXPECT_NEAR(seen.x / seen.w, 0, 1e-5);
    EXPECT_NEAR(seen.y / seen.w, 0, 1e-5);
    const vec3 eye(scene.camera);
    const vec3 ahead = glm::normalize(from.target - eye);
    const vec4 first = scene.to_clip * vec4(eye + 0.31f * ahead, 1);
    const vec4 last = scene.to_clip * vec4(eye + 59000.0f * ahead, 1);
    EXPECT_GT(first.z, 0);
    EXPECT_LT(last.z, last.w);
    // A tree's thickness apart at 200 m: more than a few steps of a float.
    const vec4 front = scene.to_clip * vec4(eye + 200.0f * ahead, 1);
    const vec4 back = scene.to_clip * vec4(eye + 200.3f * ahead, 1);
    EXPECT_GT(back.z / back.w - front.z / front.w, 16 * 0x1p-24f);
}

TEST(painter, air_of_a_turbidity) {
    // Of the molecules alone 1.2e-5 per metre; each of haze as thick as they adds 7.3 times as much
    // near the ground, where it lies.
    EXPECT_NEAR(meadow::extinction_of_air(1), 1.2e-5, 1e-7);
    EXPECT_NEAR(meadow::extinction_of_air(2), 1.2e-5 * 8.336, 1e-7);
}

TEST(painter, materials_without_all_their_texels_are_refused) {
    cpu::device device;
    material broken = leaf_of({1, 2, 3});
    broken.texels.pop_back();
    const auto made = meadow::painter<cpu::device>::create(
        device, small_picture(), std::array{broken}, level_land(10), land_indices);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::bad_input);
    EXPECT_NE(made.error().message.find("64 x 64"), std::string::npos) << made.error().message;
}

namespace {

/// Two trees with leaves on level land under a slab of cloud that ends above them, some of it in
/// the shadow, drawn into RGBA8.
template <volume_backend B>
class grove {
  public:
    explicit grove(B& device) {
        meadow::description what = small_picture();
        what.width = 192;
        what.height = 108;
        what.supersampling = 2;
        std::vector<material> materials{plain_bark({0.2f, 0.16f, 0.13f})};
        const trees::leaf_picture picture = trees::draw_leaf(trees::leaf_shape::round, 64);
        material leaf;
        leaf.as = look::leaf;
        leaf.width = picture.width;
        leaf.height = picture.height;
        leaf.texels = picture.rgba;
        materials.push_back(leaf);
        plant(device);
        land_.emplace(*make_buffer<B, vec4>(device, std::array{vec4(24, 28, 34, 0)}));
        make_volumes(device);
        painter_.emplace(
            *meadow::painter<B>::create(device, what, materials, level_land(4000), land_indices));
        meadow::camera from;
        from.eye = {4, 2, 26};
        from.target = {0, 6, 0};
        scene_ = meadow::scene_for(from, 0, {}, 16.0f / 9, {{-30, 0, -30}, {30, 16, 30}});
        for (const auto& part : wood_->parts()) {
            all_.push_back({view<B>(part.vertices), wood_->geometry(part), look::bark, 0, true});
        }
        for (const auto& part : leaves_->parts()) {
            all_.push_back({view<B>(part.vertices), leaves_->geometry(part), look::leaf, 1, true});
        }
    }

    void record(typename B::recorder& to) {
        wood_->record(to);
        leaves_->record(to);
        painter_->record(to, scene_, around_, all_, {&*clouds_, &*gathered_, view<B>(*land_)},
                         [](auto&, const auto&, const auto&) {});
    }
    [[nodiscard]] std::vector<std::uint8_t> picture(B& device) {
        const auto done = run(device, [&](typename B::recorder& r) { record(r); });
        EXPECT_TRUE(done) << done.error().message;
        return *painter_->download(device);
    }

  private:
    void plant(B& device) {
        std::vector<trees::segment> segments;
        for (const float x : {-4.0f, 5.0f}) {
            const auto first = static_cast<std::uint32_t>(segments.size());
            const auto* species = trees::find_species("quaking_aspen");
            const auto grown = *trees::grow(species->parameters, x < 0 ? 1 : 2);
            for (trees::segment s : grown) {
                s.base += vec3(x, 0, 0);
                s.tip += vec3(x, 0, 0);
                s.parent += s.parent == trees::none ? 0 : first;
                segments.push_back(s);
            }
        }
        const auto skeleton = *trees::build_skeleton(segments);
        trees::branch_mesh_options tubes;
        tubes.sides = 6;
        tubes.rings = 2;
        wood_.emplace(*trees::branch_mesh<B>::create(device, skeleton, tubes));
        const auto every =
            trees::place_leaves(skeleton, trees::leaves_of(*trees::find_species("quaking_aspen")));
        std::vector<leaf> blades; // few and large
        for (std::size_t i = 0; i < every.size(); i += 16) {
            blades.push_back(every[i]);
            blades.back().width *= 3;
            blades.back().length *= 3;
        }
        leaves_.emplace(*trees::leaf_mesh<B>::create(device, blades, {}));
    }

    typename B::volume volume(B& device, glm::uvec3 size, const std::vector<float>& voxels) {
        auto made = *device.create_volume({size.x, size.y, size.z, volume_format::float32});
        EXPECT_TRUE(device.upload(made, std::as_bytes(std::span(voxels))));
        return made;
    }

    void make_volumes(B& device) {
        // Gathered light that grows with the height, and to the south.
        const glm::uvec3 points(3, 4, 5);
        std::vector<float> harmonics;
        for (std::uint32_t z = 0; z < points.z; ++z) {
            for (std::uint32_t k = 0; k < 12; ++k) {
                for (std::uint32_t y = 0; y < points.y; ++y) {
                    const float even = 12 + 4 * static_cast<float>(y + z);
                    const float first = k % 4 == 1 ? 0.4f : (k % 4 == 2 ? 0.2f : -0.1f);
                    harmonics.insert(harmonics.end(), points.x, k % 4 == 0 ? even : first * even);
                }
            }
        }
        gathered_.emplace(volume(device, {points.x, 12 * points.y, points.z}, harmonics));
        around_.gathered.low = {-12, 0, -12, 0};
        around_.gathered.per_step = {2 / 24.0f, 3 / 18.0f, 4 / 24.0f, 0};
        around_.gathered.points = vec4(points, 0);
        // A slab: 1.2 below it in the west, nothing in the east, and half of each between.
        std::vector<float> attenuation;
        for (int i = 0; i < 8 * 8; ++i) {
            for (int x = 0; x < 8; ++x) {
                attenuation.push_back(x < 4 ? 1.2f : 0.0f);
            }
        }
        clouds_.emplace(volume(device, {8, 8, 8}, attenuation));
        around_.clouds.row_x = {0.1f, 0, 0, 4};
        around_.clouds.row_y = {0, 0.01f, 0, 4};
        around_.clouds.row_z = {0, 0, 0.01f, 4};
        around_.cloud_shadow = 1;
        around_.air = 1e-4f;
    }

    std::optional<meadow::painter<B>> painter_;
    std::optional<trees::branch_mesh<B>> wood_;
    std::optional<trees::leaf_mesh<B>> leaves_;
    std::optional<typename B::volume> clouds_, gathered_;
    std::optional<typename B::buffer> land_;
    std::vector<drawable<B>> all_;
    kernels::scene_record scene_{};
    kernels::surroundings_record around_{};
};

/// The picture of the CPU backend, once.
const std::vector<std::uint8_t>& cpu_picture() {
    static const std::vector<std::uint8_t> made = [] {
        cpu::device device;
        return grove<cpu::device>(device).picture(device);
    }();
    return made;
}

} // namespace

// Drivers sample, interpolate and round as they please within a step or two; an edge that falls on
// the other side of a sample changes a quarter of a pixel.
TEST_P(painter, pictures_of_a_grove_are_the_same_to_the_eye) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        grove<B> scene(device);
        const auto first = scene.picture(device);
        const auto second = scene.picture(device);
        EXPECT_TRUE(first == second);
        const auto& expected = cpu_picture();
        ASSERT_EQ(first.size(), expected.size());
        double sum = 0;
        std::size_t far_off = 0;
        for (std::size_t i = 0; i < expected.size(); i += 4) {
            int most = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const int off = std::abs(int{first[i + c]} - int{expected[i + c]});
                most = std::max(most, off);
                sum += off;
            }
            far_off += most > 24 ? 1 : 0;
        }
        const double pixels = static_cast<double>(expected.size()) / 4;
        EXPECT_LE(sum / (3 * pixels), 2);
        EXPECT_LE(static_cast<double>(far_off) / pixels, 0.01);
    });
}

TEST_P(painter, a_steady_frame_allocates_nothing_and_brings_nothing_back) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        grove<B> scene(device);
        for (int i = 0; i < 2; ++i) {
            ASSERT_TRUE(run(device, [&](typename B::recorder& r) { scene.record(r); }));
        }
        const auto before = device.traffic();
        ASSERT_TRUE(run(device, [&](typename B::recorder& r) {
            const std::uint64_t allocations = support::allocations;
            scene.record(r);
            if constexpr (SKYBARK_TEST_COUNTS_ALLOCATIONS != 0) {
                if (device.name() == std::string_view("cpu")) {
                    EXPECT_EQ(support::allocations - allocations, 0u);
                }
            }
        }));
        EXPECT_LT(device.traffic().up - before.up, 2048u);
        EXPECT_EQ(device.traffic().down, before.down);
    });
}
