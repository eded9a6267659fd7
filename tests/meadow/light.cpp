// The meadow's light: sky and ground in closed form, the clouds' shadow, what moves, and what a
// frame costs besides time.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include "support/random.hpp"

#include <meadow/light.hpp>
#include <scenes/surface_list.hpp>
#include <skybark/conformance/null_backend.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr float bright = 3;   // kcd/m², of an even sky
constexpr float sunlight = 8; // irradiance over π
const meadow::land ground(1);

/// A sky without any features, of D65's white, and the sun straight above.
meadow::sky_light even(float sky = bright, float sun = sunlight, float cloud = 0) {
    meadow::sky_light light{};
    light.clear.b = vec4(-1);
    light.clear.d = vec4(-1);
    light.clear.zenith = vec4(sky, 0.3127f, 0.3290f, 0);
    light.clear.to_sun = vec4(0, 1, 0, 0);
    light.clear.sunlight = vec4(sun, sun, sun, 0);
    light.cloud = cloud;
    return light;
}

/// A roof of two triangles over the middle of the land, and a black trunk at its edge, on a vertex.
struct small_stand {
    scenes::surface_list surfaces;
    gather::scene_description what;

    small_stand() {
        const std::uint32_t black = scenes::add_paint(surfaces, vec3(0));
        const float y = ground.height(0, 0) + 2;
        scenes::add_quad(surfaces, black, {-9, y, -9}, {9, y, -9}, {9, y, 9}, {-9, y, 9});
        scenes::add_box(surfaces, black, {40, ground.height(40, 20), 20}, {0.4f, 5, 0.4f}, 0.3f);
        what.triangles = surfaces.triangles;
        what.materials = surfaces.materials;
        gather::bounds box = gather::bounds_of(what.triangles);
        box.add({-80, 25, -80});
        what.box = box;
    }
    /// With the roof somewhere else.
    [[nodiscard]] std::vector<gather_triangle> moved(vec3 by) const {
        std::vector<gather_triangle> all = surfaces.triangles;
        for (std::size_t i = 0; i < 2; ++i) {
            for (vec3* corner : {&all[i].a, &all[i].b, &all[i].c}) {
                *corner += by;
            }
        }
        return all;
    }
};

meadow::light_options few_points() {
    meadow::light_options options;
    options.directions = 24;
    options.patch_size = 4;
    options.points = {5, 3, 5};
    return options;
}

/// The light of a frame, as the picture gets it.
struct frame {
    std::vector<vec4> land;
    std::vector<float> volume;

    [[nodiscard]] vec4 at_vertex(float x, float z) const {
        const auto column = static_cast<std::size_t>(std::lround(x + 80));
        const auto row = static_cast<std::size_t>(std::lround(z + 80));
        return land[row * meadow::land::points + column];
    }
    /// Of point (x, y, z) of the volume.
    [[nodiscard]] vec3 at_point(glm::uvec3 point, vec3 normal) const {
        const glm::uvec3 n = few_points().points;
        vec4 colors[3];
        for (glm::uint k = 0; k < 12; ++k) {
            colors[k / 4][static_cast<int>(k % 4)] =
                volume[(point.z * std::size_t{12} * n.y + k * n.y + point.y) * n.x + point.x];
        }
        return shared::irradiance_of(colors[0], colors[1], colors[2], normal);
    }
};

/// The light over a small stand, and its triangles, which can be moved.
template <class B>
class lit_meadow {
  public:
    explicit lit_meadow(B& device, const meadow::light_options& options = few_points())
        : device_(device) {
        auto light = meadow::light<B>::create(device, ground, stand_.what, options);
        auto triangles = make_buffer<B, gather_triangle>(device, stand_.what.triangles);
        EXPECT_TRUE(light && triangles);
        light_.emplace(std::move(*light));
        triangles_.emplace(std::move(*triangles));
    }
    void move_roof(vec3 by) {
        const auto all = stand_.moved(by);
        EXPECT_TRUE(device_.upload(*triangles_, 0, std::as_bytes(std::span(all))));
    }
    void shine(const meadow::sky_light& now, const meadow::sun_shade<B>& clouds = {}) {
        const auto done = run(device_, [&](auto& recorder) {
            light_->record(recorder, now, clouds, [&](auto& to, const buffer_view<B>& triangles) {
                to.copy(view<B>(*triangles_), triangles);
            });
        });
        EXPECT_TRUE(done);
    }
    [[nodiscard]] frame read() {
        frame made;
        made.land.resize(std::size_t{meadow::land::points} * meadow::land::points);
        const glm::uvec3 n = light_->volume().points();
        made.volume.resize(std::size_t{12} * n.x * n.y * n.z);
        const buffer_view<B> land = light_->land_irradiance();
        EXPECT_TRUE((read_back<B, vec4>(device_, *land.buffer, std::span(made.land))));
        EXPECT_TRUE(device_.download(light_->volume().volume(),
                                     std::as_writable_bytes(std::span(made.volume))));
        return made;
    }
    [[nodiscard]] frame lit(const meadow::sky_light& now, const meadow::sun_shade<B>& by = {}) {
        shine(now, by);
        return read();
    }
    [[nodiscard]] meadow::light<B>& light() { return *light_; }

  private:
    B& device_;
    small_stand stand_;
    std::optional<meadow::light<B>> light_;
    std::optional<typename B::buffer> triangles_;
};

void expect_near(vec3 found, dvec3 expected, double part) {
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found[c], expected[c], part * expected[c]);
    }
}

/// What leaves open ground in the light of sun and sky: irradiance over π, times its albedo.
dvec3 of_ground(double arriving) { return dvec3(meadow::land::albedo) * arriving; }

class meadow_light : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, meadow_light, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& name) { return std::string(name.param); });

bool same_bits(const frame& a, const frame& b) {
    return std::memcmp(a.land.data(), b.land.data(), a.land.size() * sizeof(vec4)) == 0 &&
           a.volume == b.volume;
}

} // namespace

/// Even sky above and ground below: their radiances, mixed with that of clouds by what they cover.
/// To 0.1 %: D65's white to four digits is a grey to four.
TEST(clouded_sky, is_mixed_of_sky_and_clouds) {
    const double above = double{bright} + double{sunlight};
    const double cloud = 0.45 * above;
    for (const float cover : {0.0f, 0.25f, 1.0f}) {
        const auto part = static_cast<double>(cover);
        const meadow::clouded_sky sky(even(bright, sunlight, cover), meadow::land::albedo);
        const double up = (1 - part) * double{bright} + part * cloud;
        for (const vec3 to : {vec3(0, 1, 0), vec3(0.8f, 0.6f, 0), vec3(0, 0.02f, -0.9998f)}) {
            expect_near(sky.radiance(to), dvec3(up), 1e-3);
        }
        expect_near(sky.radiance({0.8f, -0.6f, 0}), of_ground((1 - part) * above + part * cloud),
                    1e-3);
    }
}

/// The land is level to some ten degrees: nearly π L arrives of an even sky, wherever nothing
/// stands, and nothing of the sun's own beam. Vertices below the land that light meets would get
/// none; one under the trunk is moved to beside it, where a side wall takes up to half of the sky.
TEST_P(meadow_light, on_open_land_is_that_of_the_sky) {
    support::with_device(GetParam(), [](auto& device) {
        lit_meadow meadow(device);
        const frame found = meadow.lit(even());
        for (float z = -80; z <= 80; z += 1) {
            for (float x = -80; x <= 80; x += 1) {
                const double away = std::min(std::hypot(x, z) - 12.7f, std::hypot(x - 40, z - 20));
                if (away > 12) {
                    expect_near(found.at_vertex(x, z), dvec3(pi * double{bright}), 0.06);
                }
            }
        }
        const float at_trunk = found.at_vertex(40, 20).x;
        EXPECT_GT(at_trunk, 0.3 * pi * double{bright});
        EXPECT_LT(at_trunk, 0.9 * pi * double{bright});
    });
}

/// At points over open land, light from below is what the ground reflects of sun and sky, and light
/// from above that of the sky: half spaces, which the series up to l = 1 has exactly. To 5 %: the
/// land rolls, and there are 24 directions.
TEST_P(meadow_light, over_land_comes_from_the_ground_as_well) {
    support::with_device(GetParam(), [](auto& device) {
        lit_meadow meadow(device);
        const frame found = meadow.lit(even());
        for (const glm::uvec3 point : {glm::uvec3(1, 0, 1), glm::uvec3(1, 0, 3)}) {
            expect_near(found.at_point(point, {0, 1, 0}), dvec3(pi * double{bright}), 0.05);
            expect_near(found.at_point(point, {0, -1, 0}),
                        pi * of_ground(double{bright} + double{sunlight}), 0.05);
            const dvec3 both = dvec3(double{bright}) + of_ground(double{bright} + double{sunlight});
            expect_near(found.at_point(point, {1, 0, 0}), pi / 2 * both, 0.05);
        }
    });
}

/// Clouds of optical depth 1.2 above the western half of the land leave e^−1.2 of the sun to what
/// the ground reflects there, and all of the sky.
TEST_P(meadow_light, is_shaded_by_clouds) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        std::vector<float> depth(4 * 4 * 4);
        for (std::size_t i = 0; i < depth.size(); ++i) {
            depth[i] = i % 4 < 2 ? 1.2f : 0.0f;
        }
        auto volume = device.create_volume({4, 4, 4, volume_format::float32});
        ASSERT_TRUE(volume);
        ASSERT_TRUE(device.upload(*volume, std::as_bytes(std::span(depth))));
        meadow::sun_shade<B> clouds;
        clouds.attenuation = &*volume;
        clouds.grid.anchor = vec4(0, 1000, 0, 0); // 4 × 4 × 4 voxels of 40 and 500 m around it
        clouds.grid.row_x = vec4(0.025f, 0, 0, 2);
        clouds.grid.row_y = vec4(0, 0.002f, 0, 2);
        clouds.grid.row_z = vec4(0, 0, 0.002f, 2);
        clouds.grid.voxel = vec4(40, 500, 500, 1);
        lit_meadow meadow(device);
        const frame found = meadow.lit(even(), clouds);
        const double sun = std::exp(-1.2) * double{sunlight};
        // 2 % of the half space below is the other half of the land, or beyond its edge.
        expect_near(found.at_point({1, 0, 1}, {0, -1, 0}), pi * of_ground(double{bright} + sun),
                    0.06);
        const frame clear = meadow.lit(even());
        expect_near(found.at_point({3, 0, 1}, {0, -1, 0}),
                    dvec3(clear.at_point({3, 0, 1}, {0, -1, 0})), 0.06);
        expect_near(found.at_point({1, 0, 1}, {0, 1, 0}), dvec3(pi * double{bright}), 0.05);
    });
}

/// Without a bounce the ground is black, as far as there is land that light meets.
TEST_P(meadow_light, has_the_bounces_that_are_asked_for) {
    support::with_device(GetParam(), [](auto& device) {
        lit_meadow meadow(device);
        meadow.light().bounce(0);
        const float none = meadow.lit(even()).at_point({1, 0, 1}, {0, -1, 0}).y;
        meadow.light().bounce(1);
        const float one = meadow.lit(even()).at_point({1, 0, 1}, {0, -1, 0}).y;
        EXPECT_LT(none, 0.06f * one);
        EXPECT_GT(one, 0);
    });
}

/// Where the roof is now, there is shade, and where it was there is none; and a frame has the bits
/// of a first one, whatever was before.
TEST_P(meadow_light, goes_by_where_things_are_now) {
    support::with_device(GetParam(), [](auto& device) {
        lit_meadow meadow(device);
        const frame first = meadow.lit(even());
        EXPECT_LT(first.at_vertex(0, 0).x, 0.25 * pi * double{bright});
        meadow.move_roof({-40, 0, 0});
        const frame moved = meadow.lit(even(1, 2, 0.5f));
        EXPECT_LT(moved.at_vertex(-40, 0).x, 0.4f * moved.at_vertex(0, 0).x);
        meadow.move_roof({0, 0, 0});
        EXPECT_TRUE(same_bits(meadow.lit(even()), first));
        EXPECT_FALSE(same_bits(moved, first));
    });
}

TEST_P(meadow_light, sends_nothing_but_parameters) {
    support::with_device(GetParam(), [](auto& device) {
        lit_meadow meadow(device);
        meadow.shine(even());
        const device_traffic before = device.traffic();
        meadow.shine(even());
        EXPECT_EQ(device.traffic().down, before.down);
        // A bundle's passes are told some kilobyte: 4 · 24 + 2 bundles. Triangles would be 100 kB
        // each time, patches and samples megabytes.
        EXPECT_LE(device.traffic().up - before.up, 98 * 2048u);
    });
}

/// Backends agree: hits have the same bits, and so have sums. 1e-5 of the sky's light.
TEST(meadow_light, is_the_same_everywhere) {
    std::optional<frame> expected;
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        support::with_device(name, [&](auto& device) {
            lit_meadow meadow(device);
            const frame found = meadow.lit(even(bright, sunlight, 0.3f));
            if (!expected) {
                expected = found;
            }
            for (std::size_t i = 0; i < found.land.size(); ++i) {
                ASSERT_LT(glm::length(vec3(found.land[i] - expected->land[i])), 1e-4f) << name;
            }
            for (std::size_t i = 0; i < found.volume.size(); ++i) {
                ASSERT_NEAR(found.volume[i], expected->volume[i], 1e-4) << name;
            }
        });
    }
}

TEST(meadow_light, allocates_nothing_when_it_is_recorded) {
    conformance::null_device counting;
    lit_meadow counted(counting);
    const auto before = counting.counts();
    counted.shine(even());
    EXPECT_EQ(counting.counts().buffers_made, before.buffers_made);
    EXPECT_EQ(counting.counts().images_made, before.images_made);
    EXPECT_GT(counting.counts().maps, before.maps);

    if (SKYBARK_TEST_COUNTS_ALLOCATIONS == 0) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    cpu::device device;
    lit_meadow meadow(device);
    meadow.shine(even());
    meadow.shine(even());
    const std::uint64_t allocated = support::allocations;
    meadow.shine(even());
    EXPECT_EQ(support::allocations, allocated);
}

/// Places in a ball end up outside of it, to the east; others, and those in a leaf, stay.
TEST(solid_bodies, are_left_eastwards) {
    scenes::surface_list scene;
    const std::uint32_t wood = scenes::add_paint(scene, vec3(0.2f));
    scenes::add_sphere(scene, wood, {1, 2, 3}, 2, 40, 40);
    scenes::add_sphere(scene, wood, {3.5f, 2, 3}, 2, 40, 40); // overlaps it
    gather_material leaf;
    leaf.two_sided = 1;
    scenes::add_box(scene, scenes::add_material(scene, leaf), {-5, 2, 3}, vec3(1), 0);
    const meadow::solid_bodies bodies(scene.triangles, scene.materials);
    support::random_source random(9);
    int moved = 0;
    for (int i = 0; i < 2000; ++i) {
        const vec3 place(random.between(-7, 7), random.between(-1, 5), random.between(0, 6));
        const auto inside = [&](float x) { return glm::length(place - vec3(x, 2, 3)) < 2; };
        const vec3 found = bodies.outside(place, 0.25f);
        EXPECT_EQ(found.y, place.y);
        EXPECT_EQ(found.z, place.z);
        // The facets lie up to 1.3 cm inside of the balls.
        const float across = 4 - (place.y - 2) * (place.y - 2) - (place.z - 3) * (place.z - 3);
        const float edge = across > 0 ? std::sqrt(across) : 0.0f;
        if (across < 0.1f || std::abs(glm::length(place - vec3(1, 2, 3)) - 2) < 0.05f ||
            std::abs(glm::length(place - vec3(3.5f, 2, 3)) - 2) < 0.05f) {
            continue;
        }
        if (!inside(1) && !inside(3.5f)) {
            EXPECT_EQ(found.x, place.x);
            continue;
        }
        ++moved;
        const bool joined = edge > 1.25f + 0.05f;
        const bool apart = edge < 1.25f - 0.05f;
        if (joined || (apart && inside(3.5f))) {
            EXPECT_NEAR(found.x, 3.5f + edge + 0.25f, 0.06f);
        } else if (apart) {
            EXPECT_NEAR(found.x, 1 + edge + 0.25f, 0.06f);
        }
    }
    EXPECT_GT(moved, 200);
}
