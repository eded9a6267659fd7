// Light in finite clouds of Gaussian particles: the volume's products and octaves, scored against
// the path tracer. Prints the table of docs/clouds.md.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/path_tracer.hpp>
#include <skybark/cpu/cpu.hpp>

#include <cstdio>
#include <gtest/gtest.h>
#include <random>

namespace {

using namespace skybark;
using clouds::phase_function;

struct scored_cloud {
    const char* name;
    std::vector<cloud_particle> particles;
    glm::vec3 to_sun{0, 1, 0};
    phase_function phase = phase_function::henyey_greenstein(0.85);
};

/// Particles of equal depth in a ball of radius 1 km, flattened by `height`; radii are 4 to 8 % of
/// its diameter. `depth`: of the whole, on average over vertical lines that meet the ball.
std::vector<cloud_particle> ball(int count, float depth, float height, float albedo = 1) {
    std::mt19937 random(21);
    const auto unit = [&] { return static_cast<float>(random()) / 4294967296.0f; };
    std::vector<cloud_particle> out;
    double sections = 0; // ∫ of all depths over the ground: 2 π σ² each
    while (out.size() < static_cast<std::size_t>(count)) {
        const glm::vec3 p(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1);
        const float radius = 80 + 80 * unit();
        if (glm::dot(p, p) <= 1) {
            cloud_particle one;
            one.position = glm::vec3(1000, 1000 * height, 1000) * p;
            one.radius = radius;
            one.albedo = albedo;
            out.push_back(one);
            sections += 2 * 3.14159265 * double(radius / 3) * double(radius / 3);
        }
    }
    for (cloud_particle& p : out) {
        p.optical_depth = static_cast<float>(double(depth) * 3.14159265e6 / sections);
    }
    return out;
}

std::vector<cloud_particle> blob(float depth, float albedo = 1) {
    cloud_particle p;
    p.radius = 300;
    p.optical_depth = depth;
    p.albedo = albedo;
    return {p};
}

std::vector<scored_cloud> scored_clouds() {
    const glm::vec3 slanting = glm::normalize(glm::vec3(0.7f, 0.6f, 0.3f));
    return {
        {"one particle, depth 0.3", blob(0.3f)},
        {"one particle, depth 2", blob(2)},
        {"one particle, depth 10", blob(10)},
        {"one particle, depth 40", blob(40)},
        {"one particle, depth 10, albedo 0.9", blob(10, 0.9f)},
        {"one particle, depth 10, isotropic", blob(10), {0, 1, 0}, phase_function::isotropic()},
        {"4,000 particles, mean depth 7", ball(4000, 7, 1)},
        {"the same, droplets of 10 µm", ball(4000, 7, 1), slanting, *phase_function::mie(10)},
        {"flattened to a fifth, mean depth 7", ball(4000, 7, 0.2f)},
        {"the same, sun 38° high", ball(4000, 7, 0.2f), slanting},
        {"4,000 particles, mean depth 30", ball(4000, 30, 1)},
    };
}

constexpr std::uint32_t fine = 64;   ///< voxels a side of the volume
constexpr std::uint32_t coarse = 16; ///< of the path tracer's, each over 4³ of the volume's

/// The volume's grid with voxels four times as wide.
light_grid coarsened(light_grid grid) {
    constexpr float share = float(coarse) / float(fine);
    grid.row_x *= share;
    grid.row_y *= share;
    grid.row_z *= share;
    grid.voxel = glm::vec4(glm::vec3(grid.voxel) / share, grid.voxel.w);
    return grid;
}

/// The mean over each coarse voxel of a value of the `side`³ finer ones.
template <class F>
std::vector<double> averaged(F&& value, std::uint32_t side = fine) {
    const std::uint32_t n = side / coarse;
    std::vector<double> out(coarse * coarse * coarse, 0);
    for (std::uint32_t z = 0; z < side; ++z) {
        for (std::uint32_t y = 0; y < side; ++y) {
            for (std::uint32_t x = 0; x < side; ++x) {
                out[(z / n * coarse + y / n) * coarse + x / n] +=
                    value((z * side + y) * side + x) / (n * n * n);
            }
        }
    }
    return out;
}

using volume_of_light = clouds::attenuation_volume<cpu::device>;

volume_of_light relit(cpu::device& device, const scored_cloud& cloud, const clouds::light_box& box,
                      clouds::attenuation_light light, double forward) {
    clouds::attenuation_options options;
    options.light = light;
    options.forward = static_cast<float>(forward);
    auto volume = volume_of_light::create(device, box.voxels, options).value();
    const auto particles =
        make_buffer<cpu::device, cloud_particle>(device, cloud.particles).value();
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        volume.relight(recorder, view<cpu::device>(particles),
                       static_cast<std::uint32_t>(cloud.particles.size()), box);
    }));
    return volume;
}

std::vector<float> values_of(cpu::device& device, const cpu::device::volume& volume) {
    const auto size = volume.description();
    std::vector<float> values(std::size_t{size.width} * size.height * size.depth);
    EXPECT_TRUE(device.download(volume, std::as_writable_bytes(std::span(values))));
    return values;
}

/// Sunlight and what the cloud makes of it by diffusion.
std::vector<double> multiple(cpu::device& device, const scored_cloud& cloud,
                             const clouds::light_box& box) {
    const double forward = cloud.phase.forward_energy();
    clouds::multiple_scattering_options options;
    options.medium = {cloud.particles.front().albedo, static_cast<float>(cloud.phase.mean_cosine()),
                      static_cast<float>(forward)};
    options.share = clouds::share_of(options.medium);
    const auto sun = relit(device, cloud, box, clouds::attenuation_light::continuum, forward);
    auto diffuse =
        clouds::multiple_scattering<cpu::device>::create(device, box.voxels, options).value();
    EXPECT_TRUE(run(device, [&](auto& recorder) { diffuse.solve(recorder, sun.volume(), box); }));
    const auto depth = values_of(device, sun.volume());
    const auto fluence = values_of(device, diffuse.fluence());
    auto out = averaged([&](std::uint32_t i) { return std::exp(-double{depth[i]}); });
    const auto more =
        averaged([&](std::uint32_t i) { return double{fluence[i]}; }, diffuse.size().x);
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] += more[i];
    }
    return out;
}

/// Water in each coarse voxel, as extinction at the middles of its fine ones.
std::vector<double> water(const clouds::gaussian_medium& medium, const light_grid& grid) {
    const clouds::detail::voxel_frame frame(grid, glm::uvec3(fine));
    const glm::dvec3 low = frame.corner(0);
    const glm::dvec3 x = (frame.corner(1) - low) / double(fine);
    const glm::dvec3 y = (frame.corner(2) - low) / double(fine);
    const glm::dvec3 z = (frame.corner(4) - low) / double(fine);
    const auto& cells = medium.cells();
    return averaged([&](std::uint32_t at) {
        const glm::dvec3 p = low + (at % fine + 0.5) * x + (at / fine % fine + 0.5) * y +
                             (at / (fine * fine) + 0.5) * z;
        const glm::dvec3 in = glm::floor((p - cells.low) / cells.side);
        for (int a = 0; a < 3; ++a) {
            if (in[a] < 0 || in[a] >= double(cells.count[a])) {
                return 0.0;
            }
        }
        return medium.at(p, cells.index(glm::ivec3(in))).extinction;
    });
}

/// How far a method is off.
struct score {
    double error = 0; ///< mean |F − F₀| / F₀
    double bias = 0;  ///< mean F / mean F₀ − 1
};

/// Compares with the path tracer in the voxels that hold water: a fiftieth of the fullest's at
/// least.
struct scorer {
    std::vector<double> exact;
    std::vector<bool> counts;
    double least = 1e300, most = 0; ///< of the exact fluence
    double noise = 0; ///< the mean error that the path tracer's own has: √(2/π) standard errors

    scorer(const clouds::fluence_field& field, const std::vector<double>& of_water)
        : exact(field.mean) {
        const double enough = *std::max_element(of_water.begin(), of_water.end()) / 50;
        int count = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            counts.push_back(of_water[i] >= enough);
            if (counts[i]) {
                least = std::min(least, exact[i]);
                most = std::max(most, exact[i]);
                noise += 0.797884561 * field.standard_error[i] / exact[i];
                ++count;
            }
        }
        noise /= count;
    }

    [[nodiscard]] score operator()(const std::vector<double>& found) const {
        double error = 0, sum = 0, sum_exact = 0;
        int count = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            if (counts[i]) {
                error += std::abs(found[i] - exact[i]) / exact[i];
                sum += found[i];
                sum_exact += exact[i];
                ++count;
            }
        }
        return {error / count, sum / sum_exact - 1};
    }

    score print(const std::vector<double>& found) const {
        const score s = (*this)(found);
        std::printf(s.error < 100 ? " %5.0f (%+5.0f) " : " %5.0e        ", 100 * s.error,
                    100 * s.bias);
        return s;
    }
};

} // namespace

// A thin cloud among them: little light that is scattered again must not become much.
TEST(light_scores, multiple_scattering_in_one_particle) {
    cpu::device device;
    for (const float depth : {0.3f, 2.0f, 10.0f}) {
        const scored_cloud cloud{"", blob(depth)};
        const auto box = clouds::fit_light_box(cloud.particles, cloud.to_sun, glm::uvec3(fine));
        const auto medium = clouds::gaussian_medium::create(cloud.particles);
        clouds::path_options paths;
        paths.paths = 100'000;
        const auto exact = clouds::trace_fluence(*medium, cloud.phase, glm::dvec3(cloud.to_sun),
                                                 coarsened(box->grid), glm::uvec3(coarse), paths);
        const scorer against(*exact, water(*medium, box->grid));
        // 4 % at most with more paths (the table), and the noise of these.
        EXPECT_LE(against(multiple(device, cloud, *box)).error, 0.05 + against.noise) << depth;
        EXPECT_LT(against.noise, 0.05) << depth;
    }
}

TEST(light_scores, fluence_of_finite_clouds_slow) {
    cpu::device device;
    std::printf("%-36s %-13s %-6s", "mean error and bias in %", "reference", "noise");
    for (const char* name :
         {"multiple", "continuum", "octaves", "octaves/2", "e^-depth", "product"}) {
        std::printf(" %-15s", name);
    }
    std::printf("\n");
    for (const scored_cloud& cloud : scored_clouds()) {
        const auto box =
            clouds::fit_light_box(cloud.particles, cloud.to_sun, glm::uvec3(fine)).value();
        const auto medium = clouds::gaussian_medium::create(cloud.particles).value();
        clouds::path_options paths;
        paths.paths = 400'000;
        const auto exact =
            clouds::trace_fluence(medium, cloud.phase, glm::normalize(glm::dvec3(cloud.to_sun)),
                                  coarsened(box.grid), glm::uvec3(coarse), paths)
                .value();
        const scorer against(exact, water(medium, box.grid));
        std::printf("%-36s %5.2f - %5.2f  %4.1f ", cloud.name, against.least, against.most,
                    100 * against.noise);

        const score found = against.print(multiple(device, cloud, box));
        const auto light_of = [&](clouds::attenuation_light light, double forward) {
            const auto sun = relit(device, cloud, box, light, forward);
            return values_of(device, sun.volume());
        };
        const auto transmittance = [&](const std::vector<float>& depth) {
            return averaged([&](std::uint32_t i) { return std::exp(-double{depth[i]}); });
        };
        using clouds::attenuation_light;
        against.print(
            transmittance(light_of(attenuation_light::continuum, cloud.phase.forward_energy())));
        const auto depth = light_of(attenuation_light::extinction, 0);
        for (const double share : {1.0, 0.5}) {
            against.print(averaged([&](std::uint32_t i) {
                double sum = 0;
                double power = share;
                double thinner = 1;
                for (int octave = 0; octave < 12; ++octave, power /= 2, thinner /= 2) {
                    sum += power * std::exp(-thinner * double{depth[i]});
                }
                return sum;
            }));
        }
        against.print(transmittance(depth));
        const score product = against.print(
            transmittance(light_of(attenuation_light::product, cloud.phase.forward_value())));
        std::printf("\n");
        std::fflush(stdout);

        EXPECT_LE(found.error, 0.15) << cloud.name;
        EXPECT_GT(product.error, 3 * found.error) << cloud.name;
        EXPECT_LT(against.noise, 0.04) << cloud.name;
    }
}
