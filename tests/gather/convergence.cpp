// How the error of gathered light falls with the number of axes, and what it says of itself.

#include "support/brute_force.hpp"
#include "support/devices.hpp"
#include "support/gathered.hpp"

#include <scenes/cornell.hpp>
#include <scenes/samples.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

double luminance(dvec3 light) { return dot(light, dvec3(0.2126, 0.7152, 0.0722)); }

/// The box, every triangle with a radiance of its own, under a sky that is brighter above.
struct lit_box {
    scenes::gather_scene scene = scenes::cornell();
    std::vector<gather_sample> samples;
    std::vector<double> truth; ///< luminance of the irradiance

    static vec3 sky(vec3 direction) { return vec3(1.0f, 1.2f, 1.5f) * (1.2f + direction.y); }

    explicit lit_box(std::uint32_t count) {
        const scenes::gather_scene plain = scenes::cornell();
        scene.materials.clear();
        scenes::random_numbers random(5);
        for (gather_triangle& t : scene.triangles) {
            const float light = random.between(0, 2);
            t.material = support::add_light(
                scene, light * vec3(random.between(0.5f, 1), random.between(0.5f, 1), 1));
        }
        samples = scenes::sample_surfaces(plain, count);
        const auto axes = support::fibonacci_axes(30000);
        const double lift =
            static_cast<double>(gather::default_lift(gather::bounds_of(scene.triangles)));
        for (const gather_sample& s : samples) {
            truth.push_back(luminance(support::traced_irradiance(
                scene.triangles, s, lift, axes, [&](const auto& hit, dvec3 direction) {
                    if (hit.missed()) {
                        return dvec3(sky(vec3(direction)));
                    }
                    return hit.back ? dvec3(0)
                                    : dvec3(scene.materials[scene.triangles[hit.triangle].material]
                                                .emission);
                })));
        }
    }

    [[nodiscard]] gather::final_gather_options options(std::uint64_t seed) const {
        gather::final_gather_options made;
        made.seed = seed;
        made.sky = sky;
        return made;
    }
};

const lit_box& the_box() {
    static const lit_box box(60);
    return box;
}

} // namespace

/// E ± 2.365 · error, Student's 95 % of seven degrees of freedom, holds the truth at 93–97 % of
/// the samples over 100 seeds.
TEST(convergence, intervals_hold_the_truth_as_often_as_they_say) {
    const lit_box& box = the_box();
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(box.scene));
    for (const std::uint64_t axes : {64, 256, 512}) {
        int held = 0;
        int all = 0;
        double squares = 0;
        double claimed = 0;
        for (std::uint64_t seed = 1; seed <= 100; ++seed) {
            const auto found =
                support::gathered(device, scene, box.samples, axes, box.options(seed));
            for (std::size_t i = 0; i < found.size(); ++i) {
                const double error = luminance(dvec3(found[i])) - box.truth[i];
                const double said = static_cast<double>(found[i].w);
                held += std::abs(error) <= 2.365 * said + 1e-6 ? 1 : 0;
                squares += error * error;
                claimed += said * said;
                ++all;
            }
        }
        const double share = static_cast<double>(held) / all;
               std::sqrt(squares / claimed));
        RecordProperty("held_at_" + std::to_string(axes), std::to_string(share));
        EXPECT_GE(share, 0.93) << axes;
        EXPECT_LE(share, 0.97) << axes;
    }
}
