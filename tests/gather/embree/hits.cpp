// What samples meet along bundles of rays, against Embree's watertight ray tracing.

#include "support/devices.hpp"
#include "support/embree.hpp"

#include <scenes/samples.hpp>
#include <scenes/scenes.hpp>
#include <skybark/gather/bundle_resolver.hpp>

#include <gtest/gtest.h>

using namespace skybark;

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

/// Counts of rays whose hits differ from Embree's.
struct differences {
    std::uint64_t rays = 0;
    std::uint64_t met = 0; ///< rays that meet something, in both
    std::uint64_t other_hits = 0;
    std::uint64_t other_distances = 0;

    void add(const gather_hit& hit, const gather_hit& expected, double tolerance) {
        ++rays;
        const bool is_met = hit.surface != no_surface;
        if (is_met != (expected.surface != no_surface)) {
            ++other_hits;
        } else if (is_met) {
            ++met;
            const double apart =
                static_cast<double>(hit.distance) - static_cast<double>(expected.distance);
            other_distances += std::abs(apart) <= tolerance ? 0u : 1u;
        }
    }

    void expect_few() const {
        const auto all = static_cast<double>(rays);
        EXPECT_GT(static_cast<double>(met), 0.2 * all);
        EXPECT_LE(static_cast<double>(other_hits), most_other_hits * all);
        EXPECT_LE(static_cast<double>(other_distances), most_other_distances * all);
        testing::Test::RecordProperty("rays", std::to_string(rays));
        testing::Test::RecordProperty("other_hits", std::to_string(other_hits));
        testing::Test::RecordProperty("other_distances", std::to_string(other_distances));
    }
};

/// A scene and its samples on a device, and what resolves bundles there.
template <class B>
struct resolved_scene {
    gather::bounds box;
    typename B::buffer triangles;
    typename B::buffer samples;
    typename B::buffer hits;
    gather::bundle_resolver<B> resolver;

    static result<resolved_scene> create(B& device, const scenes::gather_scene& scene,
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
    const support::embree_reference reference(scene.triangles);
    auto resolved = resolved_scene<B>::create(device, scene, samples, c.route);
    ASSERT_TRUE(resolved) << resolved.error().message;
    const gather::bounds& box = resolved->box;
    std::vector<gather_hit> hits(samples.size());
    differences all;
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
    all.expect_few();
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

} // namespace
