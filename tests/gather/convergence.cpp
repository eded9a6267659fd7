// How the error of gathered light falls with the number of axes, and what it says of itself.

#include "support/brute_force.hpp"
#include "support/devices.hpp"
#include "support/gathered.hpp"

#include <scenes/samples.hpp>
#include <scenes/scenes.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

double luminance(dvec3 light) { return dot(light, dvec3(0.2126, 0.7152, 0.0722)); }

/// The box, every triangle with a radiance of its own, under a sky that is brighter above.
struct lit_box {
    scenes::surface_list scene = scenes::cornell();
    std::vector<gather_sample> samples;
    std::vector<double> truth; ///< luminance of the irradiance

    static vec3 sky(vec3 direction) { return vec3(1.0f, 1.2f, 1.5f) * (1.2f + direction.y); }

    explicit lit_box(std::uint32_t count) {
        const scenes::surface_list plain = scenes::cornell();
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
    for (const std::uint64_t axes : {64u, 256u, 512u}) {
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
        RecordProperty("held_at_" + std::to_string(axes), std::to_string(share));
        RecordProperty("true_over_said_at_" + std::to_string(axes),
                       std::to_string(std::sqrt(squares / claimed)));
        EXPECT_GE(share, 0.93) << axes;
        EXPECT_LE(share, 0.97) << axes;
    }
}

namespace {

constexpr std::uint64_t counts[] = {64, 128, 256, 512, 1024};

/// The root mean square error of gathers over their samples and `seeds` seeds, at each of `counts`.
std::vector<double> errors(cpu::device& device, const gather::gather_scene<cpu::device>& scene,
                           std::span<const gather_sample> samples, std::span<const double> truth,
                           gather::final_gather_options options, std::uint64_t seeds) {
    std::vector<double> squares(std::size(counts));
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        options.seed = seed;
        auto gather = support::make_gather(device, scene, samples, options);
        for (std::size_t k = 0; k < std::size(counts); ++k) {
            EXPECT_TRUE(gather.add(counts[k] - gather.axes()));
            const auto found = support::read(gather);
            for (std::size_t i = 0; i < found.size(); ++i) {
                const double error = luminance(dvec3(found[i])) - truth[i];
                squares[k] += error * error / static_cast<double>(seeds * found.size());
            }
        }
    }
    for (double& s : squares) {
        s = std::sqrt(s);
    }
    return squares;
}

/// p of error ~ axes^p, by least squares of the logarithms.
double exponent(std::span<const double> errors) {
    double xs = 0;
    double ys = 0;
    double xx = 0;
    double xy = 0;
    const auto n = static_cast<double>(errors.size());
    for (std::size_t k = 0; k < errors.size(); ++k) {
        const double x = std::log(static_cast<double>(counts[k]));
        const double y = std::log(errors[k]);
        xs += x;
        ys += y;
        xx += x * x;
        xy += x * y;
    }
    return (n * xy - xs * ys) / (n * xx - xs * xs);
}

/// Of the share of an even sky that points of a scene see, against 16,384 axes of another seed.
double exponent_under_the_sky(const scenes::surface_list& of, const char* name) {
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(of));
    const std::vector<vec4> none(scene.patch_count());
    EXPECT_TRUE(device.upload(*scene.radiance().buffer, 0, std::as_bytes(std::span(none))));
    const auto samples = scenes::sample_surfaces(of, 200);
    gather::final_gather_options options;
    options.sky = gather::even_sky(vec3(1));
    options.seed = 1000;
    std::vector<double> truth;
    for (const vec4& found : support::gathered(device, scene, samples, 16384, options)) {
        truth.push_back(luminance(dvec3(found)));
    }
    const auto found = errors(device, scene, samples, truth, options, 4);
    for (std::size_t k = 0; k < found.size(); ++k) {
        testing::Test::RecordProperty(std::string(name) + "_at_" + std::to_string(counts[k]),
                                      std::to_string(found[k]));
    }
    return exponent(found);
}

} // namespace

/// −0.75 is what borders that are smooth allow; chance alone has −0.5.
TEST(convergence, in_the_box_is_that_of_lattices) {
    const lit_box& box = the_box();
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(box.scene));
    const auto found = errors(device, scene, box.samples, box.truth, box.options(1), 16);
    const double p = exponent(found);
    RecordProperty("exponent", std::to_string(p));
    EXPECT_LE(p, -0.70);
    // Small sets over and over again, each turned anew, have chance's exponent.
    std::vector<double> squares(std::size(counts));
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        std::vector<dvec3> sum(box.samples.size());
        std::uint64_t sets = 0;
        for (std::size_t k = 0; k < std::size(counts); ++k) {
            for (; sets < counts[k] / 64; ++sets) {
                const auto set = support::gathered(device, scene, box.samples, 64,
                                                   box.options(seed * 1000 + sets));
                for (std::size_t i = 0; i < set.size(); ++i) {
                    sum[i] += dvec3(set[i]);
                }
            }
            for (std::size_t i = 0; i < sum.size(); ++i) {
                const double error = luminance(sum[i]) / static_cast<double>(sets) - box.truth[i];
                squares[k] += error * error;
            }
        }
    }
    for (double& s : squares) {
        s = std::sqrt(s);
    }
    EXPECT_GT(exponent(squares), -0.6);
}

TEST(convergence, in_the_park_is_that_of_lattices_slow) {
    const double p = exponent_under_the_sky(scenes::park(), "park");
    RecordProperty("exponent", std::to_string(p));
    EXPECT_LE(p, -0.70);
}

/// Leaves are nearly noise to a lattice, and still it is no worse than chance.
TEST(convergence, under_leaves_is_no_worse_than_chance_slow) {
    const double p = exponent_under_the_sky(scenes::canopy(), "canopy");
    RecordProperty("exponent", std::to_string(p));
    EXPECT_LE(p, -0.50);
}
