// Light kept on a grid of points, light that does not arrive in full, and directional light that
// stays on the device.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include "support/gathered.hpp"
#include "support/random.hpp"

#include <scenes/surface_list.hpp>
#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/conformance/null_backend.hpp>
#include <skybark/gather/irradiance_volume.hpp>
#include <skybark/kernels/light_at_points.hpp>

#include <array>
#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using support::sample_at;

namespace {

constexpr double pi = 3.14159265358979323846;
const std::array<const char*, 3> names{"cpu", "opengl", "vulkan"};

/// The voxels of a volume, and what a trilinear filter finds in them, in double precision.
struct voxels {
    glm::uvec3 size{0};
    std::vector<float> values;

    [[nodiscard]] double sample(vec3 texel) const {
        const dvec3 at = dvec3(texel) * dvec3(size) - 0.5;
        const dvec3 first = glm::floor(at);
        const dvec3 part = at - first;
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
            const glm::ivec3 voxel =
                glm::clamp(glm::ivec3(first) + step, glm::ivec3(0), glm::ivec3(size) - 1);
            double weight = 1;
            for (int a = 0; a < 3; ++a) {
                weight *= step[a] == 1 ? part[a] : 1 - part[a];
            }
            if (weight != 0) {
                sum += weight * static_cast<double>(at_voxel(glm::uvec3(voxel)));
            }
        }
        return sum;
    }
    [[nodiscard]] float at_voxel(glm::uvec3 at) const {
        return values[(std::size_t{at.z} * size.y + at.y) * size.x + at.x];
    }
};

template <class B>
[[nodiscard]] voxels read_volume(B& device, const gather::irradiance_volume<B>& volume) {
    const glm::uvec3 points = volume.points();
    voxels made{{points.x, 12 * points.y, points.z}, {}};
    made.values.resize(std::size_t{points.x} * 12 * points.y * points.z);
    const auto done =
        device.download(volume.volume(), std::as_writable_bytes(std::span(made.values)));
    EXPECT_TRUE(done) << done.error().message;
    return made;
}

/// As a draw kernel asks for it.
[[nodiscard]] vec3 irradiance_at(const voxels& all, const shared::irradiance_grid& grid, vec3 place,
                                 vec3 normal) {
    std::array<vec4, 3> colors{};
    for (int k = 0; k < 12; ++k) {
        colors[static_cast<std::size_t>(k / 4)][k % 4] = static_cast<float>(
            all.sample(shared::irradiance_texel(grid, place, static_cast<float>(k))));
    }
    return shared::irradiance_of(colors[0], colors[1], colors[2], normal);
}

[[nodiscard]] std::vector<vec3> normals() {
    std::vector<vec3> all{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    support::random_source random(3);
    for (int i = 0; i < 20; ++i) {
        all.push_back(glm::normalize(
            vec3(random.between(-1, 1), random.between(-1, 1), random.between(0.1, 1))));
    }
    return all;
}

/// Places in the box, on its border, and beyond it.
[[nodiscard]] std::vector<vec3> places(const gather::bounds& box) {
    std::vector<vec3> all{box.low, box.high, box.low - 10.0f, box.high + 10.0f, box.middle()};
    support::random_source random(4);
    const vec3 size = box.high - box.low;
    for (int i = 0; i < 20; ++i) {
        all.push_back(box.low + size * vec3(random.between(-0.2, 1.2), random.between(-0.2, 1.2),
                                            random.between(-0.2, 1.2)));
    }
    return all;
}

/// A speck far below, so that there is a scene.
[[nodiscard]] scenes::surface_list nothing() {
    scenes::surface_list scene;
    scenes::add_triangle(scene, scenes::add_paint(scene, vec3(0)), {0, -5000, 0}, {0, -5000, 0.01f},
                         {0.01f, -5000, 0});
    return scene;
}

/// A plane of ±half m at y = 0 that sends `radiance` up, and reflects nothing.
[[nodiscard]] scenes::surface_list emitter(float half, vec3 radiance) {
    scenes::surface_list scene;
    const std::uint32_t light = support::add_light(scene, radiance);
    scenes::add_triangle(scene, light, {-half, 0, -half}, {-half, 0, half}, {half, 0, half});
    scenes::add_triangle(scene, light, {-half, 0, -half}, {half, 0, half}, {half, 0, -half});
    return scene;
}

/// Ground with boxes and balls on it, some of which shine.
[[nodiscard]] scenes::surface_list garden() {
    scenes::surface_list scene;
    const std::uint32_t light = support::add_light(scene, {2, 1, 0.5f});
    scenes::add_ground(scene, support::add_light(scene, vec3(0.1f, 0.2f, 0.05f)), 8, 12);
    for (int i = 0; i < 5; ++i) {
        const auto at = static_cast<float>(i);
        scenes::add_sphere(scene, light, {2 * at - 4, 1.5f, at - 3}, 0.8f, 9, 8);
        scenes::add_box(scene, scenes::add_paint(scene, vec3(0.5f)), {at - 2, 1, 4 - 2 * at},
                        {0.4f, 0.9f, 0.5f}, at);
    }
    return scene;
}

[[nodiscard]] gather::bounds box_of(vec3 low, vec3 high) {
    gather::bounds box;
    box.add(low);
    box.add(high);
    return box;
}
const gather::bounds over_the_plane = box_of({-4, 1, -3}, {5, 6, 8});

template <class B>
[[nodiscard]] gather::irradiance_volume<B>
make_volume(B& device, const gather::gather_scene<B>& scene, const gather::bounds& box,
            glm::uvec3 points, const gather::irradiance_volume_options& options) {
    auto made = gather::irradiance_volume<B>::create(device, scene, box, points, options);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
}

/// What a volume holds after so many axes.
struct kept_light {
    voxels all;
    shared::irradiance_grid grid;
};
template <class B>
[[nodiscard]] kept_light kept(B& device, const scenes::surface_list& scene,
                              const gather::bounds& box, glm::uvec3 points, std::uint64_t axes,
                              const gather::irradiance_volume_options& options) {
    const auto made = support::make_scene(device, support::describe(scene));
    auto volume = make_volume(device, made, box, points, options);
    const auto done = run(device, [&](auto& recorder) { volume.record(recorder, axes); });
    EXPECT_TRUE(done) << done.error().message;
    return {read_volume(device, volume), volume.grid()};
}

void expect_light(vec3 found, dvec3 expected, double within) {
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found[c], expected[c], within);
    }
}

class irradiance_volume : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, irradiance_volume, testing::ValuesIn(names),
                         [](const auto& name) { return std::string(name.param); });

} // namespace

/// π L for every normal, anywhere, however few the axes are: what points above and what points
/// below are taken along the same ones. Rounding alone: 1e-5.
TEST_P(irradiance_volume, holds_an_even_sky) {
    support::with_device(GetParam(), [](auto& device) {
        const vec3 sky(0.7f, 1.3f, 2.9f);
        gather::irradiance_volume_options options;
        options.sky = gather::even_sky(sky);
        for (const std::uint64_t axes : {1u, 5u, 16u}) {
            const auto found = kept(device, nothing(), over_the_plane, {3, 2, 4}, axes, options);
            for (const vec3 place : places(over_the_plane)) {
                for (const vec3 normal : normals()) {
                    expect_light(irradiance_at(found.all, found.grid, place, normal),
                                 pi * dvec3(sky), 1e-5 * pi * 2.9);
                }
            }
        }
    });
}

/// Half of what is around sends A, the other B: π (A + B)/2 + π/2 (A − B) cos a, as the series up
/// to l = 1 has it, however few the axes are. To 1e-5: none of these axes is so level that it
/// passes the plane's end (0.06 % of all are).
TEST_P(irradiance_volume, holds_a_half_space) {
    support::with_device(GetParam(), [](auto& device) {
        const dvec3 above(1, 2, 3);
        const dvec3 below(4, 1, 2);
        gather::irradiance_volume_options options;
        options.sky = gather::even_sky(above);
        for (const std::uint64_t axes : {1u, 7u, 48u}) {
            const auto found =
                kept(device, emitter(10000, below), over_the_plane, {3, 2, 2}, axes, options);
            for (const vec3 place : places(over_the_plane)) {
                for (const vec3 normal : normals()) {
                    const double up = static_cast<double>(normal.y);
                    const dvec3 expected = pi / 2 * ((above + below) + (above - below) * up);
                    expect_light(irradiance_at(found.all, found.grid, place, normal), expected,
                                 1e-5 * pi * 4);
                }
            }
        }
    });
}

/// Points under the ground see nothing, and stain what is beside them, unless they look elsewhere.
TEST_P(irradiance_volume, gathers_where_it_is_told_to) {
    support::with_device(GetParam(), [](auto& device) {
        gather::irradiance_volume_options options;
        options.sky = [](vec3 to) { return vec3(to.y > 0 ? 1 : 0); };
        const auto ground = emitter(10000, vec3(1));
        const auto box = box_of({-4, -3, -4}, {4, 5, 4});
        const vec3 low(1, 0.5f, 2);
        const auto stained = kept(device, ground, box, {3, 3, 3}, 32, options);
        // An eighth of the way down to the points at −3 m, which see no light at all.
        expect_light(irradiance_at(stained.all, stained.grid, low, {1, 0, 0}), dvec3(0.875 * pi),
                     0.003 * pi);
        options.gathered_at = [](vec3 place) {
            return vec3(place.x, glm::max(place.y, 1.0f), place.z);
        };
        const auto clean = kept(device, ground, box, {3, 3, 3}, 32, options);
        for (const vec3 place : places(box)) {
            // The plane's end: 0.06 % of the sphere.
            expect_light(irradiance_at(clean.all, clean.grid, place, {1, 0, 0}), dvec3(pi),
                         0.003 * pi);
        }
    });
}

/// The light of a moment has the bits of a cold start.
TEST_P(irradiance_volume, begins_anew) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const scenes::surface_list scene_of = garden();
        const auto scene = support::make_scene(device, support::describe(scene_of));
        gather::irradiance_volume_options options;
        options.sky = [](vec3 to) { return vec3(1 + to.x, 1, 1 - to.z); };
        gather::irradiance_volume<B> volume =
            make_volume(device, scene, over_the_plane, {4, 3, 5}, options);
        const auto at = [&](std::uint64_t axes) {
            const auto done = run(device, [&](auto& recorder) { volume.record(recorder, axes); });
            EXPECT_TRUE(done) << done.error().message;
            return read_volume(device, volume).values;
        };
        const auto first = at(9);
        EXPECT_NE(at(5), first);
        EXPECT_EQ(at(9), first);
    });
}

/// Every point has its own light in its own voxels: twelve numbers, as a gather at two samples
/// there has them.
TEST_P(irradiance_volume, keeps_each_point_apart) {
    support::with_device(GetParam(), [](auto& device) {
        const scenes::surface_list scene_of = garden();
        const glm::uvec3 points(4, 3, 5);
        const auto box = box_of({-6, 0.3f, -6}, {6, 4, 6});
        gather::irradiance_volume_options options;
        options.seed = 5;
        options.sky = [](vec3 to) { return vec3(1 + to.x, 1, 1 - to.z); };
        const auto found = kept(device, scene_of, box, points, 8, options);

        std::vector<gather_sample> samples;
        for (glm::uint z = 0; z < points.z; ++z) {
            for (glm::uint y = 0; y < points.y; ++y) {
                for (glm::uint x = 0; x < points.x; ++x) {
                    const vec3 part = vec3(x, y, z) / (vec3(points) - 1.0f);
                    const vec3 place = box.low + (box.high - box.low) * part;
                    samples.push_back(sample_at(place, {0, 1, 0}));
                    samples.push_back(sample_at(place, {0, -1, 0}));
                }
            }
        }
        const auto scene = support::make_scene(device, support::describe(scene_of));
        gather::final_gather_options alone;
        alone.seed = 5;
        alone.directional = true;
        alone.sky = options.sky;
        auto gather = support::make_gather(device, scene, std::span(std::as_const(samples)), alone);
        ASSERT_TRUE(gather.add(8));
        std::vector<gather::directional_irradiance> each(samples.size());
        ASSERT_TRUE(gather.read_directional(each));
        // What an even half space above would get too much, over its coefficient of order 0.
        dvec3 lean(0, -0.5, 0);
        for (int i = 0; i < 8; ++i) {
            const dvec3 axis = gather::bundle_axes(5)[static_cast<std::uint64_t>(i)];
            lean += (axis.y < 0 ? -axis : axis) / 8.0;
        }
        const vec4 known(std::sqrt(3.0) * glm::dvec4(0, lean.y, lean.z, lean.x));
        const auto whole = [&](vec4 up, vec4 down) {
            return (up - known * up.x) + (down + known * down.x);
        };
        std::size_t point = 0;
        for (glm::uint z = 0; z < points.z; ++z) {
            for (glm::uint y = 0; y < points.y; ++y) {
                for (glm::uint x = 0; x < points.x; ++x, ++point) {
                    const auto& up = each[2 * point];
                    const auto& down = each[2 * point + 1];
                    const std::array<vec4, 3> expected{whole(up.red, down.red),
                                                       whole(up.green, down.green),
                                                       whole(up.blue, down.blue)};
                    for (glm::uint k = 0; k < 12; ++k) {
                        // Places differ in their last bits.
                        EXPECT_NEAR(found.all.at_voxel({x, k * points.y + y, z}),
                                    expected[k / 4][static_cast<int>(k % 4)], 1e-5)
                            << point << ": " << k;
                    }
                }
            }
        }
    });
}

TEST(irradiance_volume, has_the_same_light_everywhere) {
    std::vector<float> expected;
    for (const char* name : names) {
        support::with_device(name, [&](auto& device) {
            gather::irradiance_volume_options options;
            options.sky = [](vec3 to) { return vec3(1 + to.x, 1, 1 - to.z); };
            const auto found =
                kept(device, garden(), box_of({-6, 0.3f, -6}, {6, 4, 6}), {6, 4, 5}, 16, options);
            if (expected.empty()) {
                expected = found.all.values;
            }
            EXPECT_EQ(found.all.values, expected) << name;
        });
    }
}

TEST(irradiance_volume, refuses_what_is_no_grid) {
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(nothing()));
    const auto refused = [&](const gather::bounds& box, glm::uvec3 points) {
        const auto made =
            gather::irradiance_volume<cpu::device>::create(device, scene, box, points);
        return !made && made.error().code == error_code::bad_input;
    };
    EXPECT_TRUE(refused(over_the_plane, {1, 2, 2}));
    EXPECT_TRUE(refused(over_the_plane, {2, 1, 2}));
    EXPECT_TRUE(refused(over_the_plane, {2, 2, 0}));
    EXPECT_TRUE(refused(over_the_plane, {2, device.limits().max_volume_size / 12 + 1, 2}));
    EXPECT_TRUE(refused(gather::bounds{}, {2, 2, 2}));
    EXPECT_TRUE(refused(box_of({0, 0, 0}, {1, 0, 1}), {2, 2, 2}));
    EXPECT_FALSE(refused(over_the_plane, {2, 2, 2}));
}

TEST(irradiance_volume, allocates_nothing_when_it_is_recorded) {
    conformance::null_device counting;
    const auto counted = support::make_scene(counting, support::describe(nothing()));
    auto empty = make_volume(counting, counted, over_the_plane, {3, 3, 3}, {});
    const auto before = counting.counts();
    ASSERT_TRUE(run(counting, [&](auto& recorder) { empty.record(recorder, 8); }));
    EXPECT_EQ(counting.counts().buffers_made, before.buffers_made);
    EXPECT_GT(counting.counts().maps, before.maps);

    if (SKYBARK_TEST_COUNTS_ALLOCATIONS == 0) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(nothing()));
    gather::irradiance_volume_options options;
    options.sky = gather::even_sky(vec3(1));
    auto volume = make_volume(device, scene, over_the_plane, {3, 3, 3}, options);
    const auto once = [&] {
        ASSERT_TRUE(run(device, [&](auto& recorder) { volume.record(recorder, 8); }));
    };
    once();
    once();
    const std::uint64_t allocated = support::allocations;
    once();
    EXPECT_EQ(support::allocations, allocated);
}

/// All twelve coefficients hold their own number everywhere: what is found of one is exactly that,
/// wherever it is looked up, with a filter that has all digits and with one that has eight bits.
TEST(irradiance_texel, never_mixes_coefficients) {
    const auto box = over_the_plane;
    for (const glm::uvec3 points : {glm::uvec3(2, 2, 2), glm::uvec3(40, 10, 40),
                                    glm::uvec3(3, 37, 5), glm::uvec3(2, 170, 2)}) {
        shared::irradiance_grid grid{};
        grid.low = vec4(box.low, 0);
        grid.per_step = vec4((vec3(points) - 1.0f) / (box.high - box.low), 0);
        grid.points = vec4(vec3(points), 0);
        auto all = places(box);
        for (const float y : {box.low.y, box.high.y}) {
            for (const float off : {-1e30f, -1.0f, -1e-3f, -1e-6f, 0.0f, 1e-6f, 1e-3f, 1e30f}) {
                all.emplace_back(0, y + off, 0);
            }
        }
        for (const vec3 place : all) {
            for (int k = 0; k < 12; ++k) {
                const vec3 texel = shared::irradiance_texel(grid, place, static_cast<float>(k));
                const double at = static_cast<double>(texel.y) * 12.0 * points.y - 0.5;
                const double rounded = std::round(at * 256) / 256;
                for (const double y : {at, rounded}) {
                    EXPECT_GE(std::floor(y), k * static_cast<double>(points.y));
                    EXPECT_LE(std::ceil(y), k * static_cast<double>(points.y) + points.y - 1);
                }
                for (int a = 0; a < 3; ++a) {
                    EXPECT_GT(texel[a], 0);
                    EXPECT_LT(texel[a], 1);
                }
            }
        }
    }
}

/// In the grid, what is sampled is linear between the points: a coefficient that is x + 2y + 3z at
/// them is that between. To a 512th of a step along y, where the texels of coefficients end.
TEST(irradiance_texel, is_linear_between_the_points) {
    const auto box = box_of({-4, 1, -3}, {5, 6, 8});
    const glm::uvec3 points(4, 6, 5);
    shared::irradiance_grid grid{};
    grid.low = vec4(box.low, 0);
    grid.per_step = vec4((vec3(points) - 1.0f) / (box.high - box.low), 0);
    grid.points = vec4(vec3(points), 0);
    voxels all{{points.x, 12 * points.y, points.z}, {}};
    for (glm::uint z = 0; z < points.z; ++z) {
        for (glm::uint row = 0; row < 12 * points.y; ++row) {
            for (glm::uint x = 0; x < points.x; ++x) {
                const vec3 at(x, row % points.y, z);
                const vec3 place = box.low + at / vec3(grid.per_step);
                all.values.push_back(place.x + 2 * place.y + 3 * place.z +
                                     100 * static_cast<float>(row / points.y));
            }
        }
    }
    for (const vec3 place : places(box)) {
        const dvec3 inside = glm::clamp(dvec3(place), dvec3(box.low), dvec3(box.high));
        for (int k = 0; k < 12; ++k) {
            const double expected = inside.x + 2 * inside.y + 3 * inside.z + 100 * k;
            const auto texel = shared::irradiance_texel(grid, place, static_cast<float>(k));
            EXPECT_NEAR(all.sample(texel), expected, 2.0 / 512 + 1e-3);
        }
    }
}

/// On the device as on the host: with samples in more than one direction, under a sky of any light.
TEST_P(irradiance_volume, has_directional_light_that_stays_on_the_device) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const scenes::surface_list scene_of = garden();
        const auto scene = support::make_scene(device, support::describe(scene_of));
        std::vector<gather_sample> samples;
        for (const vec3 normal : normals()) {
            samples.push_back(sample_at({normal.x, 2, normal.z}, normal));
        }
        gather::final_gather_options options;
        options.directional = true;
        options.sky = [](vec3 to) { return vec3(1 + to.x, 1, 1 - to.z); };
        auto gather =
            support::make_gather(device, scene, std::span(std::as_const(samples)), options);
        auto into = device.create_buffer(samples.size() * sizeof(gather::directional_irradiance));
        ASSERT_TRUE(into);
        for (const std::uint64_t axes : {0u, 11u}) {
            ASSERT_TRUE(gather.add(axes));
            ASSERT_TRUE(run(device, [&](auto& recorder) {
                gather.record_directional(recorder, view<B>(*into));
            }));
            std::vector<vec4> found(3 * samples.size());
            ASSERT_TRUE((read_back<B, vec4>(device, *into, found)));
            std::vector<gather::directional_irradiance> expected(samples.size());
            ASSERT_TRUE(gather.read_directional(expected));
            EXPECT_EQ(std::memcmp(found.data(), expected.data(), expected.size() * 48), 0) << axes;
            EXPECT_EQ(found[0].x > 0, axes > 0);
        }
    });
}

/// A quarter, a half … of the beam arrives at samples on open ground: what is found is as much of
/// the light that is found without. And with no more than one source that has such a view.
TEST_P(irradiance_volume, knows_how_much_of_a_beam_arrives) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto scene = support::make_scene(device, support::describe(emitter(10, vec3(0))));
        const vec3 towards = glm::normalize(vec3(1, 2, 0.5f));
        const vec3 sunlight(3, 2, 1);
        std::vector<gather_sample> samples;
        std::vector<vec4> arriving;
        for (int i = 0; i <= 8; ++i) {
            samples.push_back(sample_at({static_cast<float>(i) - 4, 0, 1}, {0, 1, 0}));
            arriving.emplace_back(77, static_cast<float>(i) / 8, 77, 77);
        }
        auto part = make_buffer<B, vec4>(device, arriving);
        ASSERT_TRUE(part);
        auto gather = support::make_gather(device, scene, std::span(std::as_const(samples)), {});
        const auto lit = [&](const buffer_view<B>& by) {
            EXPECT_TRUE(run(device, [&](auto& recorder) {
                gather.record_restart(recorder, 1);
                gather.record_light_from(recorder, towards, sunlight, by);
            }));
            return support::read(gather);
        };
        const auto all = lit({});
        const auto some = lit(view<B>(*part));
        for (std::size_t i = 0; i < samples.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(all[i][c], sunlight[c] * towards.y, 1e-6);
                EXPECT_NEAR(some[i][c], all[i][c] * arriving[i].y, 1e-6);
            }
        }
    });
}

/// A white floor under half of a beam: what leaves it is half of E cos / π.
TEST_P(irradiance_volume, bounces_what_arrives) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        scenes::surface_list floor;
        scenes::add_ground(floor, scenes::add_paint(floor, vec3(0.8f, 0.4f, 0.2f)), 4, 4);
        const auto scene = support::make_scene(device, support::describe(floor));
        const std::vector<vec4> half(scene.patch_count(), vec4(0, 0.5f, 0, 0));
        auto part = make_buffer<B, vec4>(device, std::span(half));
        ASSERT_TRUE(part);
        gather::bounce_options options;
        options.axes = 2;
        auto light = gather::bounced_light<B>::create(device, scene, options);
        ASSERT_TRUE(light);
        const vec3 towards = glm::normalize(vec3(1, 2, 0.5f));
        std::vector<vec4> radiance(scene.patch_count());
        for (const float factor : {1.0f, 0.5f}) {
            light->forget_sources();
            light->light_from(towards, vec3(3), factor < 1 ? view<B>(*part) : buffer_view<B>{});
            ASSERT_TRUE(run(device, [&](auto& recorder) {
                light->record_restart(recorder);
                light->record(recorder);
            }));
            ASSERT_EQ(light->bounces(), 1u);
            ASSERT_TRUE(light->read_radiance(radiance));
            for (const vec4& found : radiance) {
                const double each = static_cast<double>(factor * 3 * towards.y) / pi;
                expect_light(vec3(found), each * dvec3(0.8, 0.4, 0.2), 1e-5);
            }
        }
    });
}

/// Below a slab of cloud of optical depth 1.5 straight through, e^(−1.5 / cos a) of the beam
/// arrives; above it all. Within a hundredth of the depth: the attenuation is summed in voxels.
TEST_P(irradiance_volume, is_dimmed_by_clouds) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const std::vector<float> density(8 * 8 * 8, 1.0f);
        auto cloud = device.create_volume({8, 8, 8, volume_format::float32});
        ASSERT_TRUE(cloud);
        ASSERT_TRUE(device.upload(*cloud, std::as_bytes(std::span(density))));
        clouds::density_box where;
        where.low = {-200, 30, -200};
        where.high = {200, 40, 200};
        where.extinction = 0.15f;
        clouds::attenuation_options how;
        how.light = clouds::attenuation_light::extinction;
        const glm::uvec3 size(48, 48, 48);
        auto shade = clouds::attenuation_volume<B>::create(device, size, how);
        ASSERT_TRUE(shade) << shade.error().message;
        ASSERT_TRUE(shade->prepare_for_grids(device));
        const vec3 towards = glm::normalize(vec3(0.4f, 1, -0.2f));
        const auto box = clouds::fit_light_box(clouds::cloud_bounds{where.low, where.high, 0, 100},
                                               towards, size);
        ASSERT_TRUE(box) << box.error().message;

        std::vector<gather_sample> samples;
        for (const float y : {0.0f, 10.0f, 60.0f}) {
            for (const float x : {-30.0f, 0.0f, 40.0f}) {
                samples.push_back(sample_at({x, y, 0.3f * x}, {0, 1, 0}));
            }
        }
        auto places = make_buffer<B, gather_sample>(device, std::span(std::as_const(samples)));
        auto arriving = device.create_buffer(samples.size() * sizeof(vec4));
        ASSERT_TRUE(places && arriving);
        const auto scene = support::make_scene(device, support::describe(nothing()));
        auto gather = support::make_gather(device, scene, view<B>(*places), {});
        ASSERT_TRUE(run(device, [&](auto& recorder) {
            shade->relight(recorder, *cloud, where, *box);
            kernels::light_at_points look{box->grid};
            look.stride = 2;
            volume_bindings<B, kernels::light_at_points> volumes;
            volumes.read = {&shade->volume(), &shade->volume()};
            recorder.map(look, {view<B>(*places), view<B>(*arriving)}, volumes,
                         range{0, static_cast<std::uint32_t>(samples.size())});
            gather.record_light_from(recorder, towards, vec3(2), view<B>(*arriving));
        }));
        const auto found = support::read(gather);
        const double cosine = static_cast<double>(towards.y);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const bool below = samples[i].position.y < 20;
            const double through = below ? std::exp(-1.5 / cosine) : 1.0;
            EXPECT_NEAR(found[i].x, 2 * cosine * through, 0.015 * 2 * through) << i;
        }
    });
}
