// The reference path tracer against published slabs, adding and doubling, closed forms, its own
// adjoint, and what no tracer may break: energy, seeds, threads.

#include "support/adding_doubling.hpp"
#include "support/random.hpp"

#include <skybark/clouds/path_tracer.hpp>

#include <cstdio>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>
#include <vector>

using namespace skybark;
using clouds::estimate;
using clouds::path_options;
using clouds::phase_function;
using glm::dvec3;

namespace {

constexpr double pi = 3.141592653589793;

path_options with_paths(std::uint64_t paths, std::uint64_t seed = 1) {
    path_options options;
    options.paths = paths;
    options.seed = seed;
    return options;
}

/// Within three standard errors; `exact` is itself known to `known`.
void expect_within_three(const estimate& found, double exact, double known,
                         const std::string& what) {
    EXPECT_GT(found.standard_error, 0) << what;
    EXPECT_NEAR(found.mean, exact, 3 * found.standard_error + known) << what;
}

/// ∫ f from a to b by Gauss's rule on equal parts.
template <class F>
double integral(double a, double b, int parts, F&& f) {
    const support::half_range_gauss gauss(12);
    double sum = 0;
    for (int p = 0; p < parts; ++p) {
        for (std::size_t i = 0; i < 12; ++i) {
            sum += gauss.weight[i] * f(a + (b - a) * (p + gauss.node[i]) / parts);
        }
    }
    return sum * (b - a) / parts;
}

/// Legendre's moments of a phase function, by quadrature that closes in on the forward lobe.
std::vector<double> moments(const phase_function& phase, std::size_t count) {
    std::vector<double> out(count, 0);
    const support::half_range_gauss gauss(32);
    double width = 2;
    const auto part = [&](double from, double to) {
        for (std::size_t i = 0; i < 32; ++i) {
            const double u = from + (to - from) * gauss.node[i];
            const double share = 2 * pi * phase(u) * gauss.weight[i] * (to - from);
            double before = 1, p = u;
            out[0] += share;
            for (std::size_t l = 1; l < count; ++l) {
                out[l] += share * p;
                const double next =
                    ((2 * double(l) + 1) * u * p - double(l) * before) / (double(l) + 1);
                before = std::exchange(p, next);
            }
        }
    };
    for (int k = 0; k < 40; ++k, width /= 2) {
        part(1 - width, 1 - width / 2);
    }
    part(1 - width, 1);
    return out;
}

struct slab_case {
    double depth, g, albedo, cosine;
};

/// Traces each; every figure within three standard errors, and all together as far off as their
/// standard errors say: the sum of squared deviations of n figures has mean n and variance 2n.
void score_slabs(std::span<const slab_case> cases, std::uint64_t paths) {
    double squares = 0;
    int figures = 0;
    for (const slab_case& c : cases) {
        const auto exact = support::adding_doubling(c.depth, c.g, c.albedo, c.cosine);
        const auto found = clouds::trace_slab(
            c.depth, c.albedo, phase_function::henyey_greenstein(c.g), c.cosine, with_paths(paths));
        ASSERT_TRUE(found);
        char what[100];
        std::snprintf(what, sizeof what, "depth %g, g %g, albedo %g, cosine %g", c.depth, c.g,
                      c.albedo, c.cosine);
        expect_within_three(found->transmission, exact.transmission, 1e-6, what);
        expect_within_three(found->reflection, exact.reflection, 1e-6, what);
        for (const auto& [f, e] : {std::pair(found->transmission, exact.transmission),
                                   std::pair(found->reflection, exact.reflection)}) {
            squares += std::pow((f.mean - e) / f.standard_error, 2);
            ++figures;
        }
    }
    EXPECT_NEAR(squares, figures, 3 * std::sqrt(2.0 * figures)) << figures << " figures";
}

cloud_particle particle(const glm::vec3& at, float radius, float depth, float albedo = 1) {
    cloud_particle p;
    p.position = at;
    p.radius = radius;
    p.optical_depth = depth;
    p.albedo = albedo;
    return p;
}

/// Blobs of radius 3 to 6 m within 10 m of the origin.
std::vector<cloud_particle> some_blobs(int count, float albedo = 1) {
    support::random_source random(7);
    std::vector<cloud_particle> out;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 at(random.direction() * random.between(0, 10));
        out.push_back(particle(at, static_cast<float>(random.between(3, 6)),
                               static_cast<float>(random.between(0.2, 1.5)), albedo));
    }
    return out;
}

/// Extinction of a cloud of Gaussians, endless.
double extinction_of(std::span<const cloud_particle> cloud, const dvec3& at) {
    double sum = 0;
    for (const cloud_particle& p : cloud) {
        const double sigma = double{p.radius} / 3;
        const dvec3 d = at - dvec3(p.position);
        sum += double{p.optical_depth} / (sigma * std::sqrt(2 * pi)) *
               std::exp(-glm::dot(d, d) / (2 * sigma * sigma));
    }
    return sum;
}

/// A grid along the world's axes.
light_grid grid_of(const glm::vec3& low, const glm::vec3& side) {
    light_grid grid;
    grid.anchor = glm::vec4(low, 0);
    grid.row_x = {1 / side.x, 0, 0, 0};
    grid.row_y = {0, 1 / side.y, 0, 0};
    grid.row_z = {0, 0, 1 / side.z, 0};
    grid.voxel = {side, 0};
    return grid;
}

/// Fluence in a box by paths backwards from places spread over it, in directions spread over the
/// sphere.
template <class M>
estimate backward_fluence(const M& cloud, const phase_function& phase, const dvec3& low,
                          const dvec3& side, const dvec3& to_sun, std::size_t starts,
                          std::uint64_t paths) {
    support::random_source random(11);
    std::vector<clouds::camera_ray> rays(starts);
    for (auto& ray : rays) {
        const double x = random.between(0, 1);
        const double y = random.between(0, 1);
        const double z = random.between(0, 1);
        ray = {low + dvec3(x, y, z) * side, glm::normalize(random.direction())};
    }
    const auto light = clouds::trace_radiance(cloud, phase, to_sun, rays, 0, with_paths(paths));
    EXPECT_TRUE(light);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < starts; ++i) {
        const double fluence =
            4 * pi * (*light)[i].mean + clouds::sun_transmittance(cloud, rays[i].origin, to_sun);
        sum += fluence;
        squares += fluence * fluence;
    }
    const double n = double(starts);
    return {sum / n, std::sqrt((squares - sum * sum / n) / (n - 1) / n)};
}

} // namespace

// ---- phase functions ----------------------------------------------------------------------------

TEST(path_tracer, cosines_are_distributed_like_the_phase_function) {
    const std::vector<phase_function> phases{phase_function::isotropic(),
                                             phase_function::henyey_greenstein(0.85),
                                             phase_function::henyey_greenstein(-0.5),
                                             phase_function::draine(0, 1),
                                             phase_function::draine(0.6, 20),
                                             *phase_function::mie(10)};
    for (std::size_t which = 0; which < phases.size(); ++which) {
        const auto& phase = phases[which];
        constexpr int bins = 40;
        constexpr int draws = 400'000;
        std::vector<int> hits(bins, 0);
        clouds::path_random random(3, which);
        double mean = 0;
        for (int i = 0; i < draws; ++i) {
            const double u = clouds::sample_cosine(phase, random);
            ASSERT_LE(std::abs(u), 1);
            mean += u / draws;
            // In equal parts of the square root of 1 − u, finer where lobes are.
            ++hits[static_cast<std::size_t>(std::min(bins - 1.0, std::sqrt((1 - u) / 2) * bins))];
        }
        EXPECT_NEAR(mean, phase.mean_cosine(), 3 / std::sqrt(double{draws})) << which;
        double chi2 = 0;
        for (int b = 0; b < bins; ++b) {
            // u = 1 − 2 s², du = 4 s ds
            const double share = integral(double(b) / bins, double(b + 1) / bins, 8, [&](double s) {
                return 2 * pi * phase(1 - 2 * s * s) * 4 * s;
            });
            chi2 +=
                std::pow(hits[static_cast<std::size_t>(b)] - share * draws, 2) / (share * draws);
        }
        EXPECT_NEAR(chi2, bins - 1, 3 * std::sqrt(2.0 * (bins - 1))) << which;
    }
}

// ---- slabs --------------------------------------------------------------------------------------

// Van de Hulst 1980, as quoted by Wang, Jacques and Zheng 1995, table 1; the last figure ± ½.
TEST(path_tracer, slab_of_van_de_hulst) {
    const auto found =
        clouds::trace_slab(2, 0.9, phase_function::henyey_greenstein(0.75), 1, with_paths(400'000));
    ASSERT_TRUE(found);
    expect_within_three(found->transmission, 0.66096, 5e-6, "T");
    expect_within_three(found->reflection, 0.09739, 5e-6, "R");
    EXPECT_LT(found->transmission.standard_error, 1e-3);
}

// Thick, isotropic and conservative: T = 4/3 K(1) / (τ + 2 q) but for terms like e^{−τ}, with
// K(1) = √3/4 H(1), H(1) = 2.90781 (Chandrasekhar 1950) and Hopf's q = 0.710446.
TEST(path_tracer, thick_slab_of_published_constants) {
    const auto found =
        clouds::trace_slab(12, 1, phase_function::isotropic(), 1, with_paths(100'000));
    const double exact = 4.0 / 3 * std::sqrt(3.0) / 4 * 2.90781 / (12 + 2 * 0.710446);
    expect_within_three(found->transmission, exact, 1e-5 * exact, "T");
}

// A cloud lets through like 1/τ: 0.958 at depth 1, 0.641 at 8 (g = 0.85, nothing absorbed).
TEST(path_tracer, clouds_let_through_far_more_than_an_exponential) {
    const auto phase = phase_function::henyey_greenstein(0.85);
    const auto thin = clouds::trace_slab(1, 1, phase, 1, with_paths(200'000));
    const auto thick = clouds::trace_slab(8, 1, phase, 1, with_paths(100'000));
    expect_within_three(thin->transmission, 0.958, 5e-4, "depth 1");
    expect_within_three(thick->transmission, 0.641, 1e-3, "depth 8");
}

TEST(path_tracer, slabs_are_those_of_adding_and_doubling) {
    const slab_case cases[] = {{0.5, 0, 1, 1},      {2, 0, 1, 1},         {8, 0, 1, 1},
                               {1, 0, 0.9, 0.5},    {4, 0.75, 0.9, 1},    {8, 0.75, 1, 0.7},
                               {0.5, 0.85, 1, 1},   {4, 0.85, 0.999, 1},  {16, 0.85, 1, 1},
                               {8, 0.85, 0.9, 0.3}, {3, -0.5, 0.95, 0.8}, {0.01, 0.85, 1, 0.2}};
    score_slabs(cases, 40'000);
}

TEST(path_tracer, slabs_are_those_of_adding_and_doubling_slow) {
    std::vector<slab_case> cases;
    for (const double depth : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0}) {
        for (const double g : {0.0, 0.75, 0.85}) {
            for (const double albedo : {0.9, 0.999, 1.0}) {
                if (support::adding_doubling(depth, g, albedo).transmission > 1e-4) {
                    cases.push_back({depth, g, albedo, 1});
                }
            }
        }
    }
    score_slabs(cases, 200'000);
}

TEST(path_tracer, slabs_of_droplets_are_those_of_adding_and_doubling) {
    for (const auto& phase : {*phase_function::mie(10), phase_function::draine(0.5, 5)}) {
        const auto exact = support::slab_solver(moments(phase, 129), 0.99).fluxes(6);
        const auto found = clouds::trace_slab(6, 0.99, phase, 1, with_paths(60'000));
        expect_within_three(found->transmission, exact.transmission, 1e-5, "T");
        expect_within_three(found->reflection, exact.reflection, 1e-5, "R");
    }
}

// Light that was scattered once at most, in closed form but for one integral over the cosine.
TEST(path_tracer, slabs_scatter_once_as_the_closed_form_says) {
    for (const double depth : {1e-4, 0.3, 5.0}) {
        const auto phase = phase_function::henyey_greenstein(0.4);
        path_options once = with_paths(200'000);
        once.most_scatterings = 1;
        const auto found = clouds::trace_slab(depth, 0.8, phase, 1, once);
        const double reflection = integral(0, 1, 40, [&](double mu) {
            return 2 * pi * 0.8 * phase(-mu) * mu / (1 + mu) * -std::expm1(-depth * (1 + 1 / mu));
        });
        const double transmission = integral(0, 1, 40, [&](double mu) {
            return 2 * pi * 0.8 * phase(mu) * mu / (1 - mu) * std::exp(-depth) *
                   -std::expm1(-depth * (1 / mu - 1));
        });
        expect_within_three(found->reflection, reflection, 1e-9, std::to_string(depth));
        expect_within_three(found->transmission, transmission + std::exp(-depth), 1e-9,
                            std::to_string(depth));
        // To a part in a hundred even where one path in ten thousand would meet anything.
        EXPECT_LT(found->reflection.standard_error, 0.01 * found->reflection.mean);
    }
}

TEST(path_tracer, slabs_lose_no_energy) {
    const auto phase = phase_function::henyey_greenstein(0.85);
    const auto all = clouds::trace_slab(8, 1, phase, 0.6, with_paths(20'000));
    EXPECT_NEAR(all->transmission.mean + all->reflection.mean, 1, 1e-12);
    EXPECT_EQ(all->absorption.mean, 0);
    // Roulette keeps energy on average: each path ends with an error of 0.1 at most.
    const auto some = clouds::trace_slab(8, 0.5, phase, 0.6, with_paths(100'000));
    EXPECT_NEAR(some->transmission.mean + some->reflection.mean + some->absorption.mean, 1,
                3 * 0.1 / std::sqrt(100'000.0));
    EXPECT_GT(some->absorption.mean, 0.8);
    const auto none = clouds::trace_slab(8, 0, phase, 1, with_paths(1'000));
    EXPECT_NEAR(none->absorption.mean, 1 - std::exp(-8.0), 1e-12);
    EXPECT_EQ(none->reflection.mean, 0);
}

TEST(path_tracer, a_slab_of_nothing_lets_everything_through) {
    const auto found = clouds::trace_slab(0, 0.9, phase_function::isotropic());
    EXPECT_EQ(found->transmission.mean, 1);
    EXPECT_EQ(found->reflection.mean, 0);
    EXPECT_EQ(found->absorption.mean, 0);
}

// ---- media --------------------------------------------------------------------------------------

TEST(path_tracer, particles_have_the_depth_of_their_closed_form) {
    const auto cloud = some_blobs(40);
    const auto medium = clouds::gaussian_medium::create(cloud);
    const auto whole = clouds::gaussian_medium::create(cloud, 3, 8);
    ASSERT_TRUE(medium && whole);
    support::random_source random(5);
    for (int i = 0; i < 50; ++i) {
        const dvec3 origin = random.direction() * random.between(0, 12);
        const dvec3 to = glm::normalize(random.direction());
        const double length = i % 3 == 0 ? 1e300 : random.between(1, 20);
        // Endless Gaussians, by quadrature over 40 m: beyond lies nothing that counts.
        const double exact = integral(0, std::min(length, 40.0), 60, [&](double t) {
            return extinction_of(cloud, origin + t * to);
        });
        EXPECT_NEAR(whole->optical_depth(origin, to, length), exact, 1e-9 * (1 + exact));
        // Ended at 4 σ, a line at distance d from a centre lacks at most what it has beyond:
        // τ e^{−d²/2σ²} erfc(√(16 − d²/σ²) / √2) ≤ τ e^{−8}, of each of the 40.
        EXPECT_NEAR(medium->optical_depth(origin, to, length), exact, 40 * 1.5 * std::exp(-8.0));
        EXPECT_LE(medium->optical_depth(origin, to, length), exact + 1e-12);
    }
    const auto one =
        clouds::gaussian_medium::create(std::vector<cloud_particle>{particle({0, 0, 0}, 3, 10)});
    EXPECT_NEAR(one->optical_depth({0, 50, 0}, {0, -1, 0}), 10, 10 * 6.4e-5);
}

TEST(path_tracer, grids_have_the_depth_of_their_trilinear_values) {
    support::random_source random(9);
    const glm::uvec3 voxels(5, 4, 3);
    std::vector<float> values(60);
    for (float& v : values) {
        v = static_cast<float>(random.between(0, 2));
    }
    const dvec3 low(1, -2, 3), side(0.5, 0.75, 1.25);
    const auto grid = clouds::voxel_medium::create(values, voxels, low, side, 1);
    ASSERT_TRUE(grid);
    // A sum of hats about the centres of the voxels.
    const auto value = [&](const dvec3& p) {
        double sum = 0;
        for (unsigned z = 0; z < 3; ++z) {
            for (unsigned y = 0; y < 4; ++y) {
                for (unsigned x = 0; x < 5; ++x) {
                    const dvec3 d = glm::abs((p - low) / side - (dvec3(x, y, z) + 0.5));
                    sum += double{values[(z * 4 + y) * 5 + x]} * std::max(0.0, 1 - d.x) *
                           std::max(0.0, 1 - d.y) * std::max(0.0, 1 - d.z);
                }
            }
        }
        return sum;
    };
    for (int i = 0; i < 40; ++i) {
        const dvec3 origin = low + dvec3(1.2, 1.5, 1.9) + random.direction() * random.between(0, 4);
        const dvec3 to = i == 0 ? dvec3(0, 1, 0) : glm::normalize(random.direction());
        const double exact =
            integral(0, 10, 2000, [&](double t) { return value(origin + t * to); });
        // Gauss's rule meets kinks in the 5 mm between its parts: 1e-4 at most of 2 · 0.2 steps.
        EXPECT_NEAR(grid->optical_depth(origin, to), exact, 1e-4);
        const auto& cells = grid->cells();
        const auto in = (origin - cells.low) / cells.side;
        if (glm::all(glm::greaterThan(in, dvec3(0))) &&
            glm::all(glm::lessThan(in, dvec3(cells.count)))) {
            const auto at = cells.index(glm::ivec3(in));
            EXPECT_NEAR(grid->at(origin, at).extinction, value(origin), 1e-12);
            EXPECT_LE(value(origin), cells.majorant[at]);
        }
    }
}

// Flown through, black particles leave e^{−τ}: the average over each voxel by its own quadrature.
TEST(path_tracer, black_clouds_leave_the_direct_light) {
    const auto cloud = some_blobs(30, 0);
    const auto medium = clouds::gaussian_medium::create(cloud);
    const auto to_sun = glm::normalize(dvec3(0.3, 0.8, -0.4));
    const glm::uvec3 voxels(6, 6, 6);
    const auto found =
        clouds::trace_fluence(*medium, phase_function::isotropic(), to_sun,
                              grid_of({-12, -12, -12}, {4, 4, 4}), voxels, with_paths(300'000));
    ASSERT_TRUE(found);
    const support::half_range_gauss gauss(4);
    double squares = 0;
    for (unsigned v = 0; v < 216; ++v) {
        double exact = 0;
        for (unsigned s = 0; s < 64; ++s) {
            const dvec3 in(gauss.node[s % 4], gauss.node[s / 4 % 4], gauss.node[s / 16]);
            const dvec3 p = dvec3(-12) + 4.0 * (dvec3(v % 6, v / 6 % 6, v / 36) + in);
            exact += gauss.weight[s % 4] * gauss.weight[s / 4 % 4] * gauss.weight[s / 16] *
                     clouds::sun_transmittance(*medium, p, to_sun);
        }
        // The quadrature is good to 1e-4 where the light falls by half within a voxel.
        const double error = std::hypot(found->standard_error[v], 1e-4);
        EXPECT_NEAR(found->mean[v], exact, 4 * error) << v;
        squares += std::pow((found->mean[v] - exact) / error, 2);
    }
    // Deviations of neighbours go together: far from 216 independent ones, so a wide margin.
    EXPECT_NEAR(squares / 216, 1, 0.5);
    EXPECT_NEAR(found->escaped.mean + found->absorbed.mean, found->incident,
                1e-9 * found->incident);
}

// ---- light that scatters ------------------------------------------------------------------------

TEST(path_tracer, clouds_lose_no_energy) {
    const auto phase = phase_function::henyey_greenstein(0.85);
    const auto white = clouds::gaussian_medium::create(some_blobs(30));
    const auto grid = grid_of({-12, -12, -12}, {8, 8, 8});
    const auto all = clouds::trace_fluence(*white, phase, dvec3(0, 1, 0), grid, glm::uvec3(3),
                                           with_paths(20'000));
    EXPECT_NEAR(all->escaped.mean / all->incident, 1, 1e-12);
    EXPECT_EQ(all->absorbed.mean, 0);
    const auto grey = clouds::gaussian_medium::create(some_blobs(30, 0.7f));
    const auto some = clouds::trace_fluence(*grey, phase, dvec3(0, 1, 0), grid, glm::uvec3(3),
                                            with_paths(50'000));
    EXPECT_NEAR((some->escaped.mean + some->absorbed.mean) / some->incident, 1, 1e-3);
    EXPECT_GT(some->absorbed.mean / some->incident, 0.05);
}

// In a cloud that absorbs nothing under a sky of one radiance everything has that radiance.
TEST(path_tracer, a_white_cloud_vanishes_in_a_white_furnace) {
    const auto cloud = clouds::gaussian_medium::create(some_blobs(30));
    const auto phase = *phase_function::mie(10);
    const clouds::camera_ray rays[] = {{{-30, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 0, 1}}};
    const dvec3 to_sun(0, 1, 0);
    const auto dark = clouds::trace_radiance(*cloud, phase, to_sun, rays, 0, with_paths(500));
    const auto light = clouds::trace_radiance(*cloud, phase, to_sun, rays, 2, with_paths(500));
    ASSERT_TRUE(dark && light);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_GT((*dark)[i].mean, 0);
        EXPECT_NEAR((*light)[i].mean - (*dark)[i].mean, 2, 1e-12);
    }
}

// Two estimators that share only the flight from collision to collision: lengths of paths from the
// sun in a voxel, and paths backwards from places in it that look at the sun.
TEST(path_tracer, light_is_the_same_forwards_and_backwards) {
    auto cloud = some_blobs(30, 0.95f);
    cloud.push_back(particle({2, 3, 1}, 6, 4));
    const auto medium = clouds::gaussian_medium::create(cloud);
    const auto phase = phase_function::henyey_greenstein(0.6);
    const auto to_sun = glm::normalize(dvec3(0.2, 0.9, 0.3));
    const dvec3 side(4, 3, 4);
    for (const dvec3 low : {dvec3(0, 0, 0), dvec3(2, -8, -1), dvec3(-8, 4, 1)}) {
        const auto forwards =
            clouds::trace_fluence(*medium, phase, to_sun, grid_of(glm::vec3(low), glm::vec3(side)),
                                  glm::uvec3(1), with_paths(300'000));
        const auto backwards = backward_fluence(*medium, phase, low, side, to_sun, 20'000, 2);
        const double error = std::hypot(forwards->standard_error[0], backwards.standard_error);
        EXPECT_NEAR(forwards->mean[0], backwards.mean, 3 * error);
        EXPECT_LT(error, 0.02 * backwards.mean);
    }
}

// In the middle of a slab of voxels far wider than thick: adding and doubling's fluence, at
// several depths. The extinction varies with height only, and light knows optical depth alone.
TEST(path_tracer, wide_grids_are_slabs) {
    const std::vector<float> values{1, 1, 1, 2, 2, 2, 0.5f, 0.5f, 0.5f};
    // Three voxels of 400 m by three of 1 m, by one of 400 m that thins out to both sides.
    std::vector<float> all;
    for (int z = 0; z < 3; ++z) {
        all.insert(all.end(), values.begin(), values.end());
    }
    const double albedo = 0.95;
    const auto grid =
        clouds::voxel_medium::create(all, {3, 3, 3}, {-600, 0, -600}, {400, 1, 400}, albedo);
    ASSERT_TRUE(grid);
    const dvec3 to_sun(0, 1, 0);
    const support::slab_solver exact(support::henyey_greenstein_moments(0.5, 65), albedo);
    const double depth = grid->optical_depth({0, 10, 0}, {0, -1, 0});
    EXPECT_NEAR(depth, 3.5, 1e-12);
    for (const double height : {2.5, 1.2, 0.3}) {
        const dvec3 place(0, height, 0);
        const auto found = backward_fluence(*grid, phase_function::henyey_greenstein(0.5), place,
                                            dvec3(0), to_sun, 20'000, 2);
        expect_within_three(found, exact.fluence(depth, grid->optical_depth(place, to_sun)), 1e-5,
                            std::to_string(height));
    }
}

// ---- the machinery ------------------------------------------------------------------------------

TEST(path_tracer, threads_change_no_bit_and_seeds_do) {
    const auto cloud = clouds::gaussian_medium::create(some_blobs(10, 0.9f));
    const auto phase = phase_function::henyey_greenstein(0.5);
    const auto trace = [&](std::uint32_t threads, std::uint64_t seed) {
        path_options options = with_paths(5'000, seed);
        options.threads = threads;
        return *clouds::trace_fluence(*cloud, phase, dvec3(0, 1, 0),
                                      grid_of({-12, -12, -12}, {8, 8, 8}), glm::uvec3(3), options);
    };
    const auto one = trace(1, 1);
    const auto three = trace(3, 1);
    EXPECT_EQ(one.mean, three.mean);
    EXPECT_EQ(one.standard_error, three.standard_error);
    EXPECT_EQ(one.escaped.mean, three.escaped.mean);
    EXPECT_NE(one.mean, trace(1, 2).mean);
    path_options two = with_paths(5'000);
    two.threads = 2;
    path_options five = two;
    five.threads = 5;
    EXPECT_EQ(clouds::trace_slab(2, 0.9, phase, 1, two)->transmission.mean,
              clouds::trace_slab(2, 0.9, phase, 1, five)->transmission.mean);
    const clouds::camera_ray rays[] = {{{-30, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 0, 1}}};
    const auto a = clouds::trace_radiance(*cloud, phase, dvec3(0, 1, 0), rays, 0, two);
    const auto b = clouds::trace_radiance(*cloud, phase, dvec3(0, 1, 0), rays, 0, five);
    EXPECT_EQ((*a)[0].mean, (*b)[0].mean);
    EXPECT_EQ((*a)[1].mean, (*b)[1].mean);
}

TEST(path_tracer, standard_errors_are_those_of_repetitions) {
    const auto phase = phase_function::henyey_greenstein(0.85);
    double sum = 0, squares = 0, said = 0;
    constexpr int times = 60;
    for (int i = 0; i < times; ++i) {
        const auto r = clouds::trace_slab(4, 1, phase, 1, with_paths(2'000, 100 + std::uint64_t(i)))
                           ->reflection;
        sum += r.mean;
        squares += r.mean * r.mean;
        said += r.standard_error / times;
    }
    const double seen = std::sqrt((squares - sum * sum / times) / (times - 1));
    // The spread of 60 figures is itself known to 1 / √(2 · 59) = 9 %.
    EXPECT_NEAR(said / seen, 1, 0.27);
}

TEST(path_tracer, bad_input_is_refused_in_a_sentence) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto isotropic = phase_function::isotropic();
    EXPECT_FALSE(clouds::trace_slab(-1, 1, isotropic));
    EXPECT_FALSE(clouds::trace_slab(none, 1, isotropic));
    EXPECT_FALSE(clouds::trace_slab(1e9, 1, isotropic));
    EXPECT_FALSE(clouds::trace_slab(1, 1.1, isotropic));
    EXPECT_FALSE(clouds::trace_slab(1, none, isotropic));
    EXPECT_FALSE(clouds::trace_slab(1, 1, isotropic, 0));
    EXPECT_FALSE(clouds::trace_slab(1, 1, isotropic, 1, with_paths(0)));
    path_options one_batch;
    one_batch.batches = 1;
    EXPECT_FALSE(clouds::trace_slab(1, 1, isotropic, 1, one_batch));

    const auto make = [](const cloud_particle& p) {
        return clouds::gaussian_medium::create(std::vector<cloud_particle>{p});
    };
    EXPECT_TRUE(make(particle({0, 0, 0}, 1, 1)));
    EXPECT_FALSE(make(particle({0, float(none), 0}, 1, 1)));
    EXPECT_FALSE(make(particle({0, 0, 0}, 0, 1)));
    EXPECT_FALSE(make(particle({0, 0, 0}, -1, 1)));
    EXPECT_FALSE(make(particle({0, 0, 0}, 1, -1)));
    EXPECT_FALSE(make(particle({0, 0, 0}, 1, float(none))));
    EXPECT_FALSE(make(particle({0, 0, 0}, 1, 1, 1.5f)));
    EXPECT_FALSE(clouds::gaussian_medium::create({}));
    const auto refused = make(particle({0, 0, 0}, -1, 1));
    EXPECT_EQ(refused.error().code, error_code::bad_input);
    EXPECT_NE(refused.error().message.find("Particle 0"), std::string::npos);

    const std::vector<float> eight(8, 1.0f);
    const std::vector<float> broken{1, 1, 1, float(none), 1, 1, 1, 1};
    EXPECT_TRUE(clouds::voxel_medium::create(eight, {2, 2, 2}, dvec3(0), dvec3(1), 1));
    EXPECT_FALSE(clouds::voxel_medium::create(eight, {2, 2, 3}, dvec3(0), dvec3(1), 1));
    EXPECT_FALSE(clouds::voxel_medium::create(eight, {65536, 65536, 0}, dvec3(0), dvec3(1), 1));
    EXPECT_FALSE(clouds::voxel_medium::create(eight, {2, 2, 2}, dvec3(0), dvec3(1, 0, 1), 1));
    EXPECT_FALSE(clouds::voxel_medium::create(eight, {2, 2, 2}, dvec3(0), dvec3(1), -0.1));
    EXPECT_FALSE(clouds::voxel_medium::create(broken, {2, 2, 2}, dvec3(0), dvec3(1), 1));

    const auto cloud = make(particle({0, 0, 0}, 1, 1));
    const auto grid = grid_of({-1, -1, -1}, {1, 1, 1});
    EXPECT_FALSE(clouds::trace_fluence(*cloud, isotropic, dvec3(0, 2, 0), grid, glm::uvec3(2)));
    EXPECT_FALSE(clouds::trace_fluence(*cloud, isotropic, dvec3(none), grid, glm::uvec3(2)));
    EXPECT_FALSE(clouds::trace_fluence(*cloud, isotropic, dvec3(0, 1, 0), grid, glm::uvec3(0)));
    const auto large =
        clouds::trace_fluence(*cloud, isotropic, dvec3(0, 1, 0), grid, glm::uvec3(1000));
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, error_code::out_of_memory);
    EXPECT_FALSE(clouds::trace_fluence(*cloud, isotropic, dvec3(0, 1, 0),
                                       light_grid{.row_x = {0, 0, 0, 0}}, glm::uvec3(2)));
    const clouds::camera_ray rays[] = {{dvec3(0), dvec3(0, 0, 0)}};
    EXPECT_FALSE(clouds::trace_radiance(*cloud, isotropic, dvec3(0, 1, 0), rays));
    const clouds::camera_ray nowhere[] = {{dvec3(none), dvec3(0, 0, 1)}};
    EXPECT_FALSE(clouds::trace_radiance(*cloud, isotropic, dvec3(0, 1, 0), nowhere));
    EXPECT_TRUE(clouds::trace_radiance(*cloud, isotropic, dvec3(0, 1, 0), {})->empty());
    light_grid lost = grid;
    lost.anchor.x = float(none);
    EXPECT_FALSE(clouds::trace_fluence(*cloud, isotropic, dvec3(0, 1, 0), lost, glm::uvec3(2)));
}
