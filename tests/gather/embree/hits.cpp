// What samples meet along bundles of rays, against Embree's watertight ray tracing.

#include "support/devices.hpp"

#include <scenes/embree_reference.hpp>
#include <scenes/samples.hpp>
#include <scenes/scenes.hpp>
#include <skybark/gather/bundle_peeler.hpp>
#include <skybark/gather/bundle_resolver.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using scenes::embree_reference;
using scenes::hit_differences;

namespace {

/// Of the rays: a ray that passes an edge within single precision's reach may end on either side.
constexpr double most_other_hits = 1e-5;
/// Of the scene's diagonal. Both sides err by some 1e-7 of it, over the sine of the angle at which
/// the ray meets the surface.
constexpr double distance_tolerance = 2e-5;
constexpr double most_other_distances = 1e-4;

/// Anywhere, and such as walls and the ground have.
const glm::dvec3 directions[] = {{0.36, 0.80, -0.48}, {-0.91, 0.13, 0.39},  {0, 1, 0},
                                 {1, 0, 0},           {0.02, -0.999, 0.04}, {0.6, 0, -0.8},
                                 {-0.44, -0.55, 0.71}};

struct hit_case {
    const char* backend;
    const char* scene;
    gather::resolve_route route;
    std::uint32_t samples;
    std::size_t directions;
};

std::string name_of(const hit_case& c) {
    return std::string(c.backend) + "_" + c.scene +
           (c.route == gather::resolve_route::fastest ? "" : "_composed");
}

void PrintTo(const hit_case& c, std::ostream* out) { *out << name_of(c); }

void expect_few(const hit_differences& all) {
    EXPECT_GT(all.share(all.met), 0.2);
    EXPECT_LE(all.share(all.other_hits), most_other_hits);
    EXPECT_LE(all.share(all.other_distances), most_other_distances);
    testing::Test::RecordProperty("rays", std::to_string(all.rays));
    testing::Test::RecordProperty("other_hits", std::to_string(all.other_hits));
    testing::Test::RecordProperty("other_distances", std::to_string(all.other_distances));
}

/// A scene and its samples on a device, and what resolves bundles there.
template <class B>
struct resolved_scene {
    gather::bounds box;
    typename B::buffer triangles;
    typename B::buffer samples;
    typename B::buffer hits;
    gather::bundle_resolver<B> resolver;

    static result<resolved_scene> create(B& device, const scenes::surface_list& scene,
                                         std::span<const gather_sample> points,
                                         gather::resolve_route route) {
        gather::resolver_options options;
        options.route = route;
        auto resolver = gather::bundle_resolver<B>::create(device, scene.triangles.size(), options);
        auto triangles =
            make_buffer<B, gather_triangle>(device, std::span(std::as_const(scene.triangles)));
        auto samples = make_buffer<B, gather_sample>(device, points);
        auto hits = device.create_buffer(points.size() * sizeof(gather_hit));
        if (!resolver) {
            return failure(resolver.error());
        }
        for (const auto* made : {&triangles, &samples, &hits}) {
            if (!*made) {
                return failure(made->error());
            }
        }
        return resolved_scene{gather::bounds_of(scene.triangles), std::move(*triangles),
                              std::move(*samples), std::move(*hits), std::move(*resolver)};
    }

    result<void> resolve(B& device, const ray_bundle& bundle, std::span<gather_hit> found) {
        const auto done = run(device, [&](auto& recorder) {
            resolver.record(recorder, bundle,
                            {view<B>(triangles), {}, view<B>(samples), view<B>(hits)});
        });
        return done ? read_back<B>(device, hits, found) : done;
    }
};

template <class B>
void expect_hits_of_embree(B& device, const hit_case& c) {
    const auto scene = scenes::scene_named(c.scene);
    const auto samples = scenes::morton_order(scenes::sample_surfaces(scene, c.samples));
    const embree_reference reference(scene.triangles);
    auto resolved = resolved_scene<B>::create(device, scene, samples, c.route);
    ASSERT_TRUE(resolved) << resolved.error().message;
    const gather::bounds& box = resolved->box;
    std::vector<gather_hit> hits(samples.size());
    hit_differences all;
    for (std::size_t i = 0; i < c.directions; ++i) {
        const ray_bundle bundle =
            resolved->resolver.bundle(box, directions[i], gather::default_lift(box));
        const auto done = resolved->resolve(device, bundle, hits);
        ASSERT_TRUE(done) << done.error().message;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            all.add(hits[k], reference.first_hit(bundle, samples[k]),
                    distance_tolerance * static_cast<double>(box.diagonal()));
        }
    }
    expect_few(all);
}

class gather_hits : public testing::TestWithParam<hit_case> {};

TEST_P(gather_hits, are_those_of_embree) {
    support::with_device(GetParam().backend,
                         [](auto& device) { expect_hits_of_embree(device, GetParam()); });
}

std::vector<hit_case> cases(std::uint32_t on_cpu, std::uint32_t elsewhere, std::size_t axes) {
    using gather::resolve_route;
    std::vector<hit_case> all;
    for (const char* scene : scenes::scene_names) {
        all.push_back({"cpu", scene, resolve_route::fastest, on_cpu, axes});
        all.push_back({"cpu", scene, resolve_route::composed, on_cpu, axes});
        all.push_back({"opengl", scene, resolve_route::fastest, elsewhere, axes});
        all.push_back({"vulkan", scene, resolve_route::fastest, elsewhere, axes});
    }
    return all;
}

INSTANTIATE_TEST_SUITE_P(few, gather_hits, testing::ValuesIn(cases(65536, 16384, 3)),
                         [](const auto& of) { return name_of(of.param); });
INSTANTIATE_TEST_SUITE_P(many, gather_hits,
                         testing::ValuesIn(cases(1048576, 262144, std::size(directions))),
                         [](const auto& of) { return name_of(of.param) + "_slow"; });

// ---- The paper's layers

/// Share of the rays that meet something where Embree's meet nothing, or the other way round.
template <class B>
result<double> peeled_share(B& device, const scenes::surface_list& scene,
                            std::span<const gather_sample> samples,
                            std::span<const gather_hit> expected, const glm::dvec3& direction,
                            std::uint32_t size) {
    gather::peeler_options options;
    options.size = size;
    auto peeler = gather::bundle_peeler<B>::create(device, options);
    const auto on_device =
        resolved_scene<B>::create(device, scene, samples, gather::resolve_route::fastest);
    if (!peeler || !on_device) {
        return failure(peeler ? on_device.error() : peeler.error());
    }
    const gather::bounds& box = on_device->box;
    const auto layers = peeler->resolve(
        peeler->bundle(box, direction, gather::default_lift(box)), box,
        {view<B>(on_device->triangles), {}, view<B>(on_device->samples), view<B>(on_device->hits)});
    if (!layers) {
        return failure(layers.error());
    }
    std::vector<gather_hit> hits(samples.size());
    if (auto done = read_back<B>(device, on_device->hits, std::span(hits)); !done) {
        return failure(done.error());
    }
    hit_differences all;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        all.add(hits[i], expected[i], 1e30);
    }
    return all.share(all.other_hits);
}

struct peel_case {
    const char* backend;
    const char* scene;
    double most; ///< share of wrong hits at 1024 pixels a side
};
void PrintTo(const peel_case& c, std::ostream* out) { *out << c.backend << '_' << c.scene; }

/// A pixel's place is off by up to half of it, so that twice as many on a side are wrong half as
/// often: less than that gains where pixels are as wide as leaves.
template <class B>
void expect_errors_of_pixels(B& device, const peel_case& c) {
    const auto scene = scenes::scene_named(c.scene);
    const auto samples = scenes::sample_surfaces(scene, 16384);
    const embree_reference reference(scene.triangles);
    const gather::bounds box = gather::bounds_of(scene.triangles);
    const ray_bundle bundle = gather::make_bundle(box, directions[0], 1, gather::default_lift(box));
    std::vector<gather_hit> expected;
    for (const gather_sample& s : samples) {
        expected.push_back(reference.first_hit(bundle, s));
    }
    double before = 0;
    for (const std::uint32_t size : {256u, 512u, 1024u}) {
        const auto share = peeled_share(device, scene, samples, expected, directions[0], size);
        ASSERT_TRUE(share) << share.error().message;
        testing::Test::RecordProperty("wrong_at_" + std::to_string(size), std::to_string(*share));
        if (before != 0) {
            EXPECT_LT(*share, 0.75 * before) << size;
            EXPECT_GT(*share, 0.3 * before) << size;
        }
        before = *share;
    }
    EXPECT_LT(before, c.most);
    EXPECT_GT(before, 0.0005);
}

class peeled_hits : public testing::TestWithParam<peel_case> {};

TEST_P(peeled_hits, are_as_wrong_as_pixels_are_wide) {
    support::with_device(GetParam().backend,
                         [](auto& device) { expect_errors_of_pixels(device, GetParam()); });
}

std::string name_of(const testing::TestParamInfo<peel_case>& of) {
    return std::string(of.param.backend) + "_" + of.param.scene;
}

INSTANTIATE_TEST_SUITE_P(few, peeled_hits,
                         testing::Values(peel_case{"cpu", "cornell", 0.005},
                                         peel_case{"cpu", "park", 0.03}),
                         [](const auto& of) { return name_of(of); });
INSTANTIATE_TEST_SUITE_P(
    others, peeled_hits,
    testing::Values(peel_case{"cpu", "canopy", 0.08}, peel_case{"opengl", "cornell", 0.005},
                    peel_case{"opengl", "park", 0.03}, peel_case{"opengl", "canopy", 0.08},
                    peel_case{"vulkan", "cornell", 0.005}, peel_case{"vulkan", "park", 0.03},
                    peel_case{"vulkan", "canopy", 0.08}),
    [](const auto& of) { return name_of(of) + "_slow"; });

} // namespace
