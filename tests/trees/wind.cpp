// Wind: what the tables say against closed forms, what the device makes of them against sums in
// double, and the spectra, coherence and loads that come out.

#include "support/devices.hpp"
#include "support/random.hpp"
#include "support/test_trees.hpp"

#include <skybark/conformance/null_backend.hpp>
#include <skybark/core/validated.hpp>
#include <skybark/trees/wind.hpp>

#include <complex>
#include <cstdio>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;

namespace {

using cpu_wind = trees::wind_field<cpu::device>;
static_assert(trees::wind<cpu_wind, cpu::device>);
static_assert(trees::wind<trees::wind_grid<cpu::device>, cpu::device>);

constexpr double two_pi = 6.283185307179586;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

// ---- oracles ------------------------------------------------------------------------------------

/// Kaimal's n S / σ² at x = n L / U.
double kaimal(double x) { return 4 * x / std::pow(1 + 6 * x, 5.0 / 3); }

/// ∫ f d(ln x) from a to b by Simpson's rule.
template <class F>
double over_logarithm(double a, double b, F&& f) {
    constexpr int steps = 200;
    const double h = std::log(b / a) / steps;
    double sum = f(a) + f(b);
    for (int i = 1; i < steps; ++i) {
        sum += (i % 2 == 1 ? 4 : 2) * f(a * std::exp(h * i));
    }
    return sum * h / 3;
}

/// A table's wind at a place and time, in double.
dvec3 wind_of(const trees::gusts& table, const dvec3& place, double time) {
    const double height = (place.y - table.profile.ground) / table.profile.reference_height;
    const double exponent = table.profile.exponent;
    dvec3 u = table.mean * (exponent == 0 ? 1 : (height > 0 ? std::pow(height, exponent) : 0));
    for (const trees::wave& w : table.waves) {
        const double cycles = w.frequency * time + w.phase - glm::dot(w.wave_vector, place);
        u += w.amplitude * std::cos(two_pi * (cycles - std::round(cycles)));
    }
    return u;
}

// ---- what a device makes ------------------------------------------------------------------------

template <class T>
T value_of(result<T> made) {
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
}

template <class B, class W>
std::vector<glm::vec4> air_of(B& device, W& wind, double time) {
    std::vector<glm::vec4> air(wind.size());
    auto done = run(device, [&](auto& r) { wind.record(r, time); });
    EXPECT_TRUE(done) << done.error().message;
    auto read = read_back<B, glm::vec4>(device, *wind.air().buffer, std::span(air));
    EXPECT_TRUE(read) << read.error().message;
    return air;
}

/// The wind at places, at times 0, step, 2 step, …: one row a place.
std::vector<std::vector<dvec3>> series(const trees::gusts& table, const std::vector<vec3>& places,
                                       double step, std::size_t count) {
    cpu::device device;
    auto wind = value_of(cpu_wind::create(device, places, table));
    std::vector<std::vector<dvec3>> out(places.size(), std::vector<dvec3>(count));
    for (std::size_t i = 0; i < count; ++i) {
        const auto air = air_of(device, wind, static_cast<double>(i) * step);
        for (std::size_t p = 0; p < places.size(); ++p) {
            out[p][i] = dvec3(air[p]);
        }
    }
    return out;
}

using complex = std::complex<double>;

/// In place; the length is a power of two.
void fourier(std::vector<complex>& v) {
    const std::size_t n = v.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n / 2;
        for (; (j & bit) != 0; bit /= 2) {
            j ^= bit;
        }
        j |= bit;
        if (i < j) {
            std::swap(v[i], v[j]);
        }
    }
    for (std::size_t half = 1; half < n; half *= 2) {
        std::vector<complex> turn(half);
        for (std::size_t k = 0; k < half; ++k) {
            turn[k] =
                std::polar(1.0, -two_pi * static_cast<double>(k) / static_cast<double>(2 * half));
        }
        for (std::size_t i = 0; i < n; i += 2 * half) {
            for (std::size_t k = 0; k < half; ++k) {
                const complex a = v[i + k];
                const complex b = v[i + k + half] * turn[k];
                v[i + k] = a + b;
                v[i + k + half] = a - b;
            }
        }
    }
}

/// The transform of one component about its mean, with Hann's window of unit mean square, so that
/// the power of bin k is 2 |X_k|² / n².
std::vector<complex> spectrum(const std::vector<dvec3>& u, const dvec3& direction) {
    const auto n = static_cast<double>(u.size());
    std::vector<complex> v(u.size());
    double mean = 0;
    for (const dvec3& x : u) {
        mean += glm::dot(x, direction) / n;
    }
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double hann = 1 - std::cos(two_pi * static_cast<double>(i) / n);
        v[i] = (glm::dot(u[i], direction) - mean) * hann / std::sqrt(1.5);
    }
    fourier(v);
    return v;
}

/// Re ∫ S_ab from frequency `low` to `high`: variance for a = b.
double band(const std::vector<complex>& a, const std::vector<complex>& b, double step, double low,
            double high) {
    const auto n = static_cast<double>(a.size());
    const auto first = static_cast<std::size_t>(std::ceil(low * step * n));
    const auto last = static_cast<std::size_t>(std::ceil(high * step * n));
    double sum = 0;
    for (std::size_t k = first; k < last; ++k) {
        sum += (a[k] * std::conj(b[k])).real();
    }
    return 2 * sum / (n * n);
}

struct component {
    const char* name;
    dvec3 direction;
    double sigma;  ///< times that of the wind's own direction
    double length; ///< times that of the wind's own direction
    double low;    ///< x of its two decades
};
const component components[] = {{"along", {1, 0, 0}, 1, 1, 0.05},
                                {"across", {0, 0, 1}, 0.8, 2.7 / 8.1, 0.04},
                                {"up", {0, 1, 0}, 0.5, 0.66 / 8.1, 0.01}};

struct band_error {
    double x = 0;        ///< n L / U of the third octave's centre
    double decibels = 0; ///< against Kaimal's
};

struct spectrum_errors {
    std::vector<band_error> bands[3];
    double variance[3] = {}; ///< of the whole series, relative to σ²
    double covariance = 0;   ///< the largest of two components', over their σ
};

trees::kaimal_gusts gusts_of(std::uint64_t seed) {
    trees::kaimal_gusts model;
    model.turbulence.seed = seed;
    return model;
}

/// Standard third octaves (centres 10^(k/10) Hz) of hours of wind at one place.
spectrum_errors measure_spectrum(const trees::kaimal_gusts& model) {
    // Past the highest wave's Nyquist frequency, and long enough that the slowest two waves, at
    // 1.8e-3 Hz and 6 % apart, part: 2^17 steps.
    const double step = 0.45 * model.length / (model.speed * 19.953);
    const auto u = series(value_of(trees::tabulate(model)), {{3, 8, -5}}, step, 1u << 17u)[0];
    const double sigma = model.turbulence.intensity * model.speed;
    spectrum_errors errors;
    for (int c = 0; c < 3; ++c) {
        const component& of = components[c];
        const double per_x = model.speed / (model.length * of.length); // Hz
        const auto v = spectrum(u, of.direction);
        const double variance = sigma * sigma * of.sigma * of.sigma;
        const int first = static_cast<int>(std::ceil(10 * std::log10(of.low * per_x)));
        for (int k = first; k <= first + 20; ++k) {
            const double centre = std::pow(10, 0.1 * k);
            const double low = std::pow(10, 0.1 * k - 0.05);
            const double high = std::pow(10, 0.1 * k + 0.05);
            const double expected = variance * over_logarithm(low / per_x, high / per_x, kaimal);
            errors.bands[c].push_back(
                {centre / per_x, 10 * std::log10(band(v, v, step, low, high) / expected)});
        }
        const double mean = c == 0 ? model.speed : 0;
        for (const dvec3& x : u) {
            const double d = glm::dot(x, of.direction) - mean;
            errors.variance[c] += d * d / variance / static_cast<double>(u.size());
        }
    }
    for (int a = 0; a < 3; ++a) {
        const component& p = components[a];
        const component& q = components[(a + 1) % 3];
        double sum = 0;
        for (const dvec3& x : u) {
            const dvec3 d = x - dvec3(model.speed, 0, 0);
            sum += glm::dot(d, p.direction) * glm::dot(d, q.direction);
        }
        errors.covariance = std::max(
            errors.covariance,
            std::abs(sum / (static_cast<double>(u.size()) * sigma * sigma * p.sigma * q.sigma)));
    }
    return errors;
}

struct coherence_row {
    double frequency = 0; ///< Hz, the middle of a third of a decade
    double distance = 0;  ///< m, across the wind
    double measured = 0;
    double davenport = 0; ///< over the same band, by the spectrum
    double deviation = 0; ///< standard, of as many waves with random wave vectors
};

/// The coherence between places across the wind, over seeds: Re S_ab / √(S_aa S_bb) of the wind's
/// own direction, over a third of a decade.
std::vector<coherence_row> measure_coherence(std::uint32_t seeds) {
    const double distances[] = {0.25, 0.5, 1, 2, 4, 8, 16};
    const double centres[] = {0.1, 0.2154, 0.4642, 1};
    constexpr double step = 0.16; // the highest wave is at 2.8 Hz
    constexpr std::size_t count = 1u << 13u;
    const vec3 from(2, 12, 7);
    std::vector<vec3> places{from};
    for (const double d : distances) {
        // Not along an axis, in case an axis were special.
        const double a = 0.4 + d;
        places.push_back(from + vec3(0, static_cast<float>(d * std::sin(a)),
                                     static_cast<float>(d * std::cos(a))));
    }
    std::vector<coherence_row> rows;
    std::vector<double> cross(std::size(distances) * std::size(centres));
    std::vector<double> own(cross.size());
    trees::kaimal_gusts model;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        model.turbulence.seed = seed;
        const auto u = series(value_of(trees::tabulate(model)), places, step, count);
        const auto here = spectrum(u[0], {1, 0, 0});
        for (std::size_t d = 0; d < std::size(distances); ++d) {
            const auto there = spectrum(u[d + 1], {1, 0, 0});
            for (std::size_t f = 0; f < std::size(centres); ++f) {
                const double low = centres[f] * std::pow(10, -1.0 / 6);
                const double high = centres[f] * std::pow(10, 1.0 / 6);
                cross[d * std::size(centres) + f] += band(here, there, step, low, high);
                own[d * std::size(centres) + f] += std::sqrt(band(here, here, step, low, high) *
                                                             band(there, there, step, low, high));
            }
        }
    }
    for (std::size_t f = 0; f < std::size(centres); ++f) {
        for (std::size_t d = 0; d < std::size(distances); ++d) {
            const double low = centres[f] * std::pow(10, -1.0 / 6);
            const double high = centres[f] * std::pow(10, 1.0 / 6);
            const double x = model.length / model.speed;
            const double per_metre = model.turbulence.decay / model.speed;
            const double expected =
                over_logarithm(low, high,
                               [&](double n) {
                                   return kaimal(n * x) * std::exp(-per_metre * n * distances[d]);
                               }) /
                over_logarithm(low, high, [&](double n) { return kaimal(n * x); });
            // A wave contributes cos φ with mean γ and variance (1 + γ(2d)) / 2 − γ(d)², where
            // γ(2d) = γ(d)²: (1 − γ²) / 2. There are 40 waves a decade and seed.
            const double waves = 40.0 / 3 * seeds;
            rows.push_back({centres[f], distances[d],
                            cross[d * std::size(centres) + f] / own[d * std::size(centres) + f],
                            expected, std::sqrt((1 - expected * expected) / 2 / waves)});
        }
    }
    return rows;
}

// ---- loads --------------------------------------------------------------------------------------

/// All segments at rest.
std::vector<segment_pose> at_rest(const trees::skeleton& tree) {
    std::vector<segment_pose> poses(tree.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
        poses[i].base = tree.position[i];
    }
    return poses;
}

/// The force of a steady wind on a whole rigid tree, N.
template <backend B>
dvec3 total_load(B& device, const trees::skeleton& tree, const std::vector<float>& leaf_area,
                 double speed, const trees::drag_options& options = {}) {
    const trees::steady_wind model{.speed = speed, .from = 250, .profile = {}};
    auto wind = value_of(trees::wind_field<B>::create(device, trees::segment_middles(tree), model));
    auto loads = value_of(trees::wind_loads<B>::create(device, tree, leaf_area, options));
    auto poses = value_of(make_buffer<B, segment_pose>(device, at_rest(tree)));
    auto done = run(device, [&](auto& r) {
        wind.record(r, 1.5);
        loads.record(r, view<B>(poses), wind.air());
    });
    EXPECT_TRUE(done) << done.error().message;
    std::vector<segment_load> out(tree.size());
    auto read = read_back<B, segment_load>(device, *loads.loads().buffer, std::span(out));
    EXPECT_TRUE(read) << read.error().message;
    dvec3 sum(0);
    for (const segment_load& l : out) {
        sum += dvec3(l.force);
    }
    return sum;
}

/// The least-squares slope of log force against log speed.
double exponent_of(const trees::skeleton& tree, const std::vector<float>& leaf_area, double low,
                   double high, const trees::drag_options& options = {}) {
    cpu::device device;
    constexpr int points = 12;
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = 0; i < points; ++i) {
        const double speed = low * std::pow(high / low, i / (points - 1.0));
        const double x = std::log(speed);
        const double y = std::log(glm::length(total_load(device, tree, leaf_area, speed, options)));
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (points * sxy - sx * sy) / (points * sxx - sx * sx);
}

/// So much leaf on every segment without children.
std::vector<float> leafy(const trees::skeleton& tree, float area) {
    std::vector<float> areas(tree.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
        areas[i] = tree.child_count[i] == 0 ? area : 0;
    }
    return areas;
}

const trees::skeleton& tree() {
    static const trees::skeleton grown = support::grown_trees().front().skeleton;
    return grown;
}

/// Places about a small wood.
std::vector<vec3> wood(std::uint32_t count) {
    support::random_source random(5);
    std::vector<vec3> places(count);
    for (vec3& p : places) {
        p = {random.between(-200, 200), random.between(0, 30), random.between(-200, 200)};
    }
    return places;
}

/// Software devices don't fuse multiply-adds; others may, and then the phase moves: wave vectors of
/// up to 200 cycles/m at 300 m lose 2^-24 of 6e4 cycles, of some waves.
bool promises_bits(const std::string& device) {
    return device.find("llvmpipe") != std::string::npos;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b, bool bits,
                 double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    if (bits) {
        ASSERT_TRUE(same_bits(a, b));
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_LE(glm::length(dvec3(a[i]) - dvec3(b[i])), tolerance) << i;
    }
}

/// Waves, a grid and loads on a device, as on the CPU.
template <backend B>
void check_backend(B& device) {
    cpu::device cpu;
    const bool bits = promises_bits(device.device_name());
    const auto places = wood(3000);
    for (const double time : {0.0, 3.7, 86'400.25}) {
        auto here = value_of(cpu_wind::create(cpu, places, gusts_of(42)));
        auto there = value_of(trees::wind_field<B>::create(device, places, gusts_of(42)));
        expect_same(air_of(cpu, here, time), air_of(device, there, time), bits, 0.05);
    }
    const trees::wind_grid_layout layout{{-150, 0, -180}, {30, 10, 40}, 11, 4, 9};
    support::random_source random(6);
    std::vector<vec3> nodes(layout.size());
    for (vec3& n : nodes) {
        n = vec3(random.direction() * random.between(0, 20));
    }
    auto here = value_of(trees::wind_grid<cpu::device>::create(cpu, places, layout, nodes));
    auto there = value_of(trees::wind_grid<B>::create(device, places, layout, nodes));
    expect_same(air_of(cpu, here, 0), air_of(device, there, 0), bits, 1e-4);
    const auto areas = leafy(tree(), 0.02f);
    const dvec3 load_here = total_load(cpu, tree(), areas, 12);
    const dvec3 load_there = total_load(device, tree(), areas, 12);
    EXPECT_LE(glm::length(load_here - load_there), bits ? 0 : 1e-5 * glm::length(load_here));
    auto function = value_of(trees::make_wind_function(
        device, places, [](vec3 p, double t) { return p * static_cast<float>(t); }));
    const auto air = air_of(device, function, 0.5);
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_EQ(vec3(air[i]), places[i] * 0.5f);
    }
}

template <class Model>
void expect_bad(const Model& model, std::string_view about) {
    const auto table = trees::tabulate(model);
    ASSERT_FALSE(table) << about;
    EXPECT_EQ(table.error().code, error_code::bad_input);
    EXPECT_NE(table.error().message.find(about), std::string::npos) << table.error().message;
    cpu::device device;
    EXPECT_FALSE(cpu_wind::create(device, {}, model));
}

/// The whole variance of a table, by component.
dvec3 variance_of(const trees::gusts& table) {
    dvec3 sum(0);
    for (const trees::wave& w : table.waves) {
        sum += 0.5 * w.amplitude * w.amplitude;
    }
    return sum;
}

} // namespace

// ---- tables -------------------------------------------------------------------------------------

TEST(wind, blows_where_the_compass_says) {
    struct wanted {
        double from;
        dvec3 towards;
    };
    const double h = std::sqrt(0.5);
    for (const wanted& w : {wanted{0, {0, 0, 1}}, wanted{90, {-1, 0, 0}}, wanted{180, {0, 0, -1}},
                            wanted{270, {1, 0, 0}}, wanted{225, {h, 0, -h}}, wanted{-90, {1, 0, 0}},
                            wanted{360 * 1000 + 90.0, {-1, 0, 0}}}) {
        EXPECT_LE(glm::length(trees::blowing_from(w.from) - w.towards), 1e-12) << w.from;
        const auto table = value_of(
            trees::tabulate(trees::steady_wind{.speed = 7, .from = w.from, .profile = {}}));
        EXPECT_LE(glm::length(table.mean - 7.0 * w.towards), 1e-11) << w.from;
        EXPECT_TRUE(table.waves.empty());
    }
}

TEST(wind, tables_have_the_whole_variance) {
    for (const std::uint32_t waves : {4u, 64u, 128u, 256u}) {
        trees::kaimal_gusts k;
        k.speed = 11;
        k.turbulence.waves = waves;
        trees::power_law_gusts p;
        p.speed = 11;
        p.turbulence.waves = waves;
        for (const auto& table : {value_of(trees::tabulate(k)), value_of(trees::tabulate(p))}) {
            EXPECT_EQ(table.waves.size(), waves);
            const double sigma2 = 0.25 * 0.25 * 11 * 11;
            const dvec3 v = variance_of(table); // from the west: x along, z across
            EXPECT_NEAR(v.x, sigma2, 1e-10);
            EXPECT_NEAR(v.z, sigma2 * 0.64, 1e-10);
            EXPECT_NEAR(v.y, sigma2 * 0.25, 1e-10);
            for (std::size_t band = 0; band < waves; band += 4) {
                dvec3 covariance(0);
                for (std::size_t i = band; i < band + 4; ++i) {
                    const dvec3& a = table.waves[i].amplitude;
                    covariance += dvec3(a.x * a.y, a.y * a.z, a.z * a.x);
                }
                ASSERT_LE(glm::length(covariance), 1e-12 * sigma2) << band;
            }
        }
    }
}

TEST(wind, power_laws_share_out_their_variance) {
    for (const double beta : {0.0, 0.5, 1.0, 1.0 + 1e-9, 5.0 / 3, 3.0}) {
        trees::power_law_gusts model;
        model.beta = beta;
        model.lowest = 0.02;
        model.highest = 5;
        const auto table = value_of(trees::tabulate(model));
        const auto density = [&](double n) { return std::pow(n, 1 - beta); }; // n S
        const double whole = over_logarithm(0.02, 5, density);
        for (std::size_t i = 0; i < table.waves.size(); i += 4) {
            const double low = 0.02 * std::pow(250, static_cast<double>(i) / 128);
            const double high = 0.02 * std::pow(250, static_cast<double>(i + 4) / 128);
            double variance = 0;
            for (std::size_t j = i; j < i + 4; ++j) {
                const trees::wave& w = table.waves[j];
                variance += 0.5 * w.amplitude.x * w.amplitude.x;
                EXPECT_GT(w.frequency, low);
                EXPECT_LT(w.frequency, high);
            }
            // Simpson's rule over 200 steps of 2.8e-2 is off by 1e-8.
            const double expected = 4 * over_logarithm(low, high, density) / whole;
            ASSERT_NEAR(variance / expected, 1, 1e-6) << beta << ' ' << low;
        }
    }
}

TEST(wind, seeds_are_winds) {
    const auto a = value_of(trees::tabulate(gusts_of(1)));
    const auto again = value_of(trees::tabulate(gusts_of(1)));
    const auto b = value_of(trees::tabulate(gusts_of(2)));
    double apart = 0;
    for (std::size_t i = 0; i < a.waves.size(); ++i) {
        EXPECT_EQ(a.waves[i].phase, again.waves[i].phase);
        EXPECT_EQ(a.waves[i].wave_vector, again.waves[i].wave_vector);
        apart += std::abs(a.waves[i].phase - b.waves[i].phase);
    }
    // The mean distance of two uniform numbers is 1/3; 128 of them: 43 ± 2.7.
    EXPECT_NEAR(apart, 43, 11);
}

TEST(wind, calm_has_no_waves) {
    trees::kaimal_gusts k;
    k.speed = 0;
    EXPECT_TRUE(value_of(trees::tabulate(k)).waves.empty());
    trees::power_law_gusts p;
    p.speed = 0;
    EXPECT_TRUE(value_of(trees::tabulate(p)).waves.empty());
    p.speed = 5;
    p.turbulence.intensity = 0;
    EXPECT_TRUE(value_of(trees::tabulate(p)).waves.empty());
    cpu::device device;
    auto wind = value_of(cpu_wind::create(device, wood(5), k));
    for (const glm::vec4& u : air_of(device, wind, 10)) {
        EXPECT_EQ(u, glm::vec4(0));
    }
}

TEST(wind, values_out_of_range_are_bad_input) {
    for (const double wrong : {-1.0, not_a_number, infinite, -infinite, 1001.0}) {
        expect_bad(trees::steady_wind{.speed = wrong, .from = 0, .profile = {}}, "speed");
        trees::kaimal_gusts k;
        k.speed = wrong;
        expect_bad(k, "speed");
        k = {};
        k.turbulence.intensity = wrong;
        expect_bad(k, "intensity");
        k = {};
        k.turbulence.decay = wrong;
        expect_bad(k, "decay");
        k = {};
        k.lateral_length = wrong;
        expect_bad(k, "lateral length");
        trees::power_law_gusts p;
        p.speed = wrong;
        expect_bad(p, "speed");
        p = {};
        p.beta = wrong;
        expect_bad(p, "exponent of the spectrum");
        p = {};
        p.highest = wrong;
        expect_bad(p, "highest frequency");
    }
    for (const double wrong : {not_a_number, infinite}) {
        expect_bad(trees::steady_wind{.speed = 1, .from = wrong, .profile = {}}, "direction");
        expect_bad(trees::steady_wind{.speed = 1, .from = 0, .profile = {wrong, 10, 0}},
                   "exponent of the mean");
        expect_bad(trees::steady_wind{.speed = 1, .from = 0, .profile = {0.2, wrong, 0}},
                   "reference height");
        expect_bad(trees::steady_wind{.speed = 1, .from = 0, .profile = {0.2, 10, wrong}},
                   "ground");
    }
    trees::kaimal_gusts k;
    k.length = 0;
    expect_bad(k, "length");
    for (const std::uint32_t wrong : {0u, 3u, 126u, 65'540u}) {
        k = {};
        k.turbulence.waves = wrong;
        expect_bad(k, std::to_string(wrong) + " waves");
    }
    trees::power_law_gusts p;
    p.lowest = p.highest;
    expect_bad(p, "not above the lowest");
    trees::gusts own;
    own.waves.resize(3);
    own.waves[2].amplitude.y = not_a_number;
    expect_bad(own, "Wave 2");
    own.waves[2].amplitude.y = 0;
    own.waves[1].frequency = infinite;
    expect_bad(own, "Wave 1");
    own.waves.clear();
    own.mean.x = not_a_number;
    expect_bad(own, "mean");
    own.mean.x = 0;
    own.waves.resize(65'537);
    expect_bad(own, "65537");
    cpu::device device;
    for (const float wrong : {std::nanf(""), std::numeric_limits<float>::infinity(), 2e6f}) {
        const std::vector<vec3> places{{0, 0, 0}, {0, wrong, 0}};
        const auto made = cpu_wind::create(device, places, trees::steady_wind{});
        ASSERT_FALSE(made);
        EXPECT_NE(made.error().message.find("Place 1"), std::string::npos);
    }
}

// ---- the air ------------------------------------------------------------------------------------

TEST(wind, middles_are_half_way) {
    const auto middles = trees::segment_middles(tree());
    ASSERT_EQ(middles.size(), tree().size());
    for (std::size_t i = 0; i < middles.size(); ++i) {
        const dvec3 half = (dvec3(tree().position[i]) + dvec3(tree().tip(i))) * 0.5;
        ASSERT_LE(glm::length(dvec3(middles[i]) - half), 1e-5);
    }
}

TEST(wind, air_is_the_sum_of_its_waves_for_days) {
    cpu::device device;
    const auto places = wood(200);
    auto model = gusts_of(9);
    model.profile = {0.25, 8, 2};
    const auto table = value_of(trees::tabulate(model));
    auto wind = value_of(cpu_wind::create(device, places, table));
    // What rounding does to a wave: its wave vector and the products, 2^-24 of |k||x| each, six in
    // all, and the phase; then 1e-6 of the cosine.
    double tolerance = 1e-5;
    for (const trees::wave& w : table.waves) {
        const double cycles = glm::length(w.wave_vector) * 300;
        tolerance +=
            glm::length(w.amplitude) * std::min(2.0, two_pi * (6 * cycles + 1) * 6e-8 + 1e-6);
    }
    EXPECT_LT(tolerance, 0.05);
    double worst = 0;
    for (const double time : {0.0, 1.0 / 60, 777.7, 864'000.0, 864'000.0 + 1.0 / 60, -50.0}) {
        const auto air = air_of(device, wind, time);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const dvec3 expected = wind_of(table, dvec3(places[i]), time);
            const double off = glm::length(dvec3(air[i]) - expected);
            worst = std::max(worst, off);
            ASSERT_LE(off, tolerance) << time << ' ' << i;
            ASSERT_NEAR(air[i].w, glm::length(dvec3(air[i])), 1e-5);
        }
    }
    RecordProperty("worst_mm_per_s", static_cast<int>(1000 * worst));
}

TEST(wind, ten_days_on_it_is_still_smooth) {
    cpu::device device;
    const auto table = value_of(trees::tabulate(gusts_of(3)));
    auto wind = value_of(cpu_wind::create(device, wood(20), table));
    // No faster than all waves together, and the rounding of a phase: 6e-8 cycles each way.
    double fastest = 0;
    double rounding = 0;
    for (const trees::wave& w : table.waves) {
        fastest += two_pi * w.frequency * glm::length(w.amplitude);
        rounding += glm::length(w.amplitude) * (two_pi * 6e-8 + 1e-6) * 2;
    }
    constexpr double step = 1e-4;
    const double start = 864'000;
    auto before = air_of(device, wind, start);
    double moved = 0;
    for (int i = 1; i <= 200; ++i) {
        const auto now = air_of(device, wind, start + i * step);
        for (std::size_t p = 0; p < now.size(); ++p) {
            const double change = glm::length(dvec3(now[p]) - dvec3(before[p]));
            ASSERT_LE(change, fastest * step + rounding);
            moved += change;
        }
        before = now;
    }
    EXPECT_GT(moved, 0.01); // it does blow
}

TEST(wind, gusts_run_with_the_wind) {
    cpu::device device;
    auto model = gusts_of(4);
    model.from = 215;
    const auto table = value_of(trees::tabulate(model));
    const auto places = wood(50);
    std::vector<vec3> downwind = places;
    constexpr double later = 2.5;
    for (vec3& p : downwind) {
        p += vec3(trees::blowing_from(215) * model.speed * later);
    }
    auto here = value_of(cpu_wind::create(device, places, table));
    auto there = value_of(cpu_wind::create(device, downwind, table));
    const auto now = air_of(device, here, 100);
    const auto then = air_of(device, there, 100 + later);
    for (std::size_t i = 0; i < now.size(); ++i) {
        // Places of 300 m are rounded to 1.5e-5 m, which waves of 30 cycles/m see.
        EXPECT_LE(glm::length(dvec3(now[i]) - dvec3(then[i])), 0.02);
    }
}

TEST(wind, mean_grows_with_height) {
    cpu::device device;
    trees::steady_wind model;
    model.speed = 6;
    model.profile = {0.25, 10, 2};
    const std::vector<vec3> places{{0, 12, 0}, {5, 22, 1}, {0, 4.5f, 0}, {0, 2, 0}, {0, -7, 0}};
    auto wind = value_of(cpu_wind::create(device, places, model));
    const auto air = air_of(device, wind, 0);
    const double expected[] = {6, 6 * std::pow(2, 0.25), 6 * std::pow(0.25, 0.25), 0, 0};
    for (std::size_t i = 0; i < air.size(); ++i) {
        EXPECT_NEAR(air[i].x, expected[i], 1e-5) << i;
        EXPECT_NEAR(air[i].w, expected[i], 1e-5) << i;
    }
}

TEST(wind, changes_go_on_from_the_gusts_that_there_are) {
    cpu::device device;
    const auto places = wood(20);
    trees::kaimal_gusts model = gusts_of(7);
    model.speed = 8;
    auto wind = value_of(cpu_wind::create(device, places, model));
    const double late = 5000; // s: waves of another frequency are elsewhere by then
    const auto before = air_of(device, wind, late);
    // All of Kaimal's wind is in proportion to its speed, but for the phases.
    model.speed = 10;
    ASSERT_TRUE(wind.change(device, value_of(trees::tabulate(model)), late));
    const auto after = air_of(device, wind, late);
    auto anew = value_of(cpu_wind::create(device, places, model));
    const auto other = air_of(device, anew, late);
    double jump = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_LT(glm::distance(vec3(after[i]), vec3(before[i]) * 1.25f), 1e-4f);
        jump = std::max(jump, double{glm::distance(vec3(other[i]), vec3(before[i]) * 1.25f)});
    }
    EXPECT_GT(jump, 1) << "it would have jumped";
    // From there on it is the new model's: its waves take as long as a new field's.
    const auto later = air_of(device, wind, late + 0.05);
    double moved = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        moved = std::max(moved, double{glm::distance(vec3(later[i]), vec3(after[i]))});
    }
    EXPECT_GT(moved, 0.01);
    EXPECT_LT(moved, 5);
}

TEST(wind, changes_that_cannot_be_are_refused) {
    cpu::device device;
    trees::kaimal_gusts model = gusts_of(7);
    auto wind = value_of(cpu_wind::create(device, wood(20), model));
    const auto before = air_of(device, wind, 3);
    const auto refused = [&](const trees::gusts& table) {
        const auto done = wind.change(device, table, 3);
        ASSERT_FALSE(done);
        EXPECT_EQ(done.error().code, error_code::bad_input);
    };
    refused({});
    auto table = value_of(trees::tabulate(model));
    table.profile.exponent = 0.3;
    refused(table);
    table = value_of(trees::tabulate(model));
    table.waves[5].frequency = not_a_number;
    refused(table);
    EXPECT_EQ(air_of(device, wind, 3), before) << "and it blows as it did";
}

TEST(wind, own_tables_blow) {
    cpu::device device;
    trees::gusts table;
    table.mean = {1, 0, 0};
    table.waves.push_back({{0, 0.25, 0}, 0.5, 0.125, {0, 0, 3}}); // five lanes: a group and one
    for (int i = 0; i < 4; ++i) {
        table.waves.push_back({{0.1 * i, 0, 0.05}, 0.3 * i, 0.2, {0.5, 1, 0}});
    }
    auto wind = value_of(cpu_wind::create(device, wood(30), table));
    const auto places = wood(30);
    const auto air = air_of(device, wind, 12.25);
    for (std::size_t i = 0; i < air.size(); ++i) {
        // 60 cycles in six roundings of 6e-8, times 2π and amplitudes of 8 m/s.
        EXPECT_LE(glm::length(dvec3(air[i]) - wind_of(table, dvec3(places[i]), 12.25)), 1.2e-3);
    }
}

TEST(wind, spectrum_is_kaimals) {
    // At 8 m/s the table's bands happen to be standard third octaves; at 11.3 they lie half way.
    for (const double speed : {8.0, 11.3, 21.0}) {
        auto model = gusts_of(17);
        model.speed = speed;
        const spectrum_errors errors = measure_spectrum(model);
        for (int c = 0; c < 3; ++c) {
            ASSERT_EQ(errors.bands[c].size(), 21u);
            for (const band_error& b : errors.bands[c]) {
                // A third octave holds four waves wherever it begins. Their band's quarters differ
                // from the spectrum there by 0.7 % at most (cosh(0.05 ln 10 · slope) - 1, the slope
                // of n S within ±1): 0.03 dB. Hann's window leaks less.
                EXPECT_LE(std::abs(b.decibels), 0.1) << components[c].name << " at x = " << b.x;
            }
            EXPECT_NEAR(errors.variance[c], 1, 0.03) << components[c].name;
        }
        // Within a band it is exactly 0; that of neighbouring waves of two bands is the mean of
        // their beat over the series, at most 1/(2π · 2.2) of two waves in fifty.
        EXPECT_LE(errors.covariance, 0.03);
    }
}

TEST(wind, coherence_across_the_wind_is_davenports) {
    const auto rows = measure_coherence(24);
    double before = 1;
    double lean = 0;
    double squares = 0;
    for (const coherence_row& row : rows) {
        if (row.distance == 0.25) {
            before = 1;
        }
        EXPECT_LE(std::abs(row.measured - row.davenport), 3 * row.deviation + 0.01)
            << row.frequency << " Hz, " << row.distance << " m";
        EXPECT_LE(row.measured, before + 3 * row.deviation)
            << row.frequency << " Hz, " << row.distance << " m";
        before = row.measured;
        const double scaled = (row.measured - row.davenport) / (row.deviation + 0.01);
        squares += scaled * scaled / static_cast<double>(rows.size());
        lean += (row.measured - row.davenport) / static_cast<double>(rows.size());
    }
    EXPECT_LE(squares, 1.5);
    // And it doesn't lean to one side. Rows of one frequency share their waves, so these are four
    // means with deviations of at most 0.035: 0.0175, of which twice. A decay of 8 would be 0.05.
    EXPECT_LE(std::abs(lean), 0.035);
    RecordProperty("lean_per_mille", static_cast<int>(1000 * lean));
    EXPECT_GT(rows.front().measured, 0.9);
    EXPECT_LT(rows.back().measured, 0.15);
}

// ---- a caller's wind ----------------------------------------------------------------------------

TEST(wind, grids_blow_and_change) {
    cpu::device device;
    const trees::wind_grid_layout layout{{-10, 0, -10}, {5, 4, 2.5f}, 5, 3, 9};
    const auto field = [](const dvec3& p, double t) {
        return dvec3(1 + 0.1 * p.x + t, 0.2 * p.y - 0.05 * p.z, 2 - 0.1 * p.z + 0.03 * p.x);
    };
    const auto nodes_at = [&](double t) {
        std::vector<vec3> nodes;
        for (std::uint32_t k = 0; k < layout.nz; ++k) {
            for (std::uint32_t j = 0; j < layout.ny; ++j) {
                for (std::uint32_t i = 0; i < layout.nx; ++i) {
                    const dvec3 p = dvec3(layout.origin) + dvec3(layout.spacing) * dvec3(i, j, k);
                    nodes.emplace_back(field(p, t));
                }
            }
        }
        return nodes;
    };
    const auto places = wood(300); // mostly outside
    auto wind =
        value_of(trees::wind_grid<cpu::device>::create(device, places, layout, nodes_at(0)));
    EXPECT_EQ(wind.velocities().size, layout.size() * 16);
    for (const double t : {0.0, 2.0}) {
        if (t > 0) {
            const auto nodes = nodes_at(t);
            auto done = run(device, [&](auto& r) { wind.set(r, nodes); });
            ASSERT_TRUE(done);
        }
        const auto air = air_of(device, wind, t);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const dvec3 inside = glm::clamp(dvec3(places[i]), dvec3(-10, 0, -10), dvec3(10, 8, 10));
            ASSERT_LE(glm::length(dvec3(air[i]) - field(inside, t)), 1e-5) << i;
        }
    }
}

TEST(wind, grids_that_cannot_be_are_refused) {
    cpu::device device;
    using grid = trees::wind_grid<cpu::device>;
    const std::vector<vec3> four(4);
    const auto message = [&](const trees::wind_grid_layout& layout) {
        const auto made = grid::create(device, {}, layout, four);
        return made ? std::string() : made.error().message;
    };
    EXPECT_EQ(message({{0, 0, 0}, {1, 1, 1}, 2, 2, 1}), "");
    EXPECT_NE(message({{0, 0, 0}, {1, 1, 1}, 2, 2, 2}).find("4 velocities"), std::string::npos);
    EXPECT_NE(message({{0, 0, 0}, {1, 1, 1}, 4, 0, 1}).find("along y"), std::string::npos);
    EXPECT_NE(message({{0, 0, 0}, {1, 0, 1}, 2, 2, 1}).find("spacing"), std::string::npos);
    EXPECT_NE(message({{0, 0, 0}, {1, 1, std::nanf("")}, 2, 2, 1}).find("along z"),
              std::string::npos);
    EXPECT_NE(message({{std::nanf(""), 0, 0}, {1, 1, 1}, 2, 2, 1}).find("origin"),
              std::string::npos);
    cpu::device_options options;
    options.limits.max_buffer_bytes = 1000;
    cpu::device small(options);
    const auto made =
        grid::create(small, {}, {{0, 0, 0}, {1, 1, 1}, 8, 8, 1}, std::vector<vec3>(64));
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::out_of_memory);
}

TEST(wind, functions_blow) {
    cpu::device device;
    const auto places = wood(40);
    int calls = 0;
    auto wind = value_of(trees::make_wind_function(device, places, [&](vec3 p, double t) {
        ++calls;
        return vec3(p.x, static_cast<float>(t), -p.z);
    }));
    static_assert(trees::wind<decltype(wind), cpu::device>);
    EXPECT_EQ(calls, 0);
    const auto air = air_of(device, wind, 3.5);
    EXPECT_EQ(calls, 40);
    for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(vec3(air[i]), vec3(places[i].x, 3.5f, -places[i].z));
        EXPECT_NEAR(air[i].w, glm::length(dvec3(air[i])), 1e-4);
    }
}

// ---- loads --------------------------------------------------------------------------------------

TEST(wind, bare_trees_drag_as_the_square) {
    EXPECT_NEAR(exponent_of(tree(), {}, 1, 40), 2, 1e-3);
    trees::drag_options rigid;
    rigid.vogel = 0;
    EXPECT_NEAR(exponent_of(tree(), leafy(tree(), 0.05f), 1, 40, rigid), 2, 1e-3);
}

TEST(wind, leafy_trees_drag_less_than_the_square) {
    const auto areas = leafy(tree(), 0.05f);
    for (const double vogel : {-1.0, -0.7, -0.5}) {
        trees::drag_options options;
        options.vogel = vogel;
        // Above the speed where leaves yield; bare wood adds a little of a 2.
        const double with_wood = exponent_of(tree(), areas, 6, 30, options);
        EXPECT_GE(with_wood, 2 + vogel - 1e-3) << vogel;
        if (vogel < -0.5) {
            EXPECT_GE(with_wood, 1);
            EXPECT_LE(with_wood, 1.5) << vogel;
        }
        options.wood = options.sheltered = 0; // leaves alone
        EXPECT_NEAR(exponent_of(tree(), areas, 6, 30, options), 2 + vogel, 1e-3) << vogel;
        EXPECT_NEAR(exponent_of(tree(), areas, 0.5, 3.9, options), 2, 1e-3) << vogel;
    }
}

TEST(wind, loads_point_downwind_and_have_their_size) {
    // One upright pole of 0.2 m on 5 m, 3 m² of leaves: in double, by hand.
    trees::skeleton pole = support::built({{{0, 0, 0}, {0, 5, 0}, 0.1f, 0.1f, trees::none}});
    cpu::device device;
    const dvec3 f = total_load(device, pole, {3}, 10);
    const dvec3 towards = trees::blowing_from(250);
    const double wood = 0.5 * 1.2 * 0.4 * (5 * 0.2) * 100;
    const double leaves = 0.5 * 1.2 * 0.4 * 3 * 100 * std::pow(10 / 4.0, -0.7);
    EXPECT_LE(glm::length(f - towards * (wood + leaves)), 1e-5 * (wood + leaves));
    const dvec3 bare = total_load(device, pole, {}, 10);
    EXPECT_LE(glm::length(bare - towards * (wood * 1.1 / 0.4)), 1e-5 * wood);
    // Beside it a bare one of the same size: only the one in leaf is sheltered.
    const trees::skeleton both = support::built({{{0, 0, 0}, {0, 5, 0}, 0.1f, 0.1f, trees::none},
                                                 {{9, 0, 0}, {9, 5, 0}, 0.1f, 0.1f, trees::none}});
    EXPECT_LE(glm::length(total_load(device, both, {3, 0}, 10) - f - bare), 1e-5 * wood);
}

TEST(wind, loads_that_cannot_be_are_refused) {
    cpu::device device;
    using loads = trees::wind_loads<cpu::device>;
    const auto message = [&](const trees::drag_options& o, std::vector<float> areas) {
        const auto made = loads::create(device, tree(), areas, o);
        return made ? std::string() : made.error().message;
    };
    EXPECT_EQ(message({}, {}), "");
    EXPECT_NE(message({}, {1, 2}).find("2 leaf areas"), std::string::npos);
    auto areas = leafy(tree(), 1);
    areas[3] = -1;
    EXPECT_NE(message({}, areas).find("Segment 3"), std::string::npos);
    areas[3] = std::nanf("");
    EXPECT_NE(message({}, areas).find("Segment 3"), std::string::npos);
    for (const double wrong : {-1.5, not_a_number, infinite}) {
        trees::drag_options o;
        o.air_density = wrong;
        EXPECT_NE(message(o, {}).find("density"), std::string::npos);
        o = {};
        o.wood = wrong;
        EXPECT_NE(message(o, {}).find("coefficient of wood"), std::string::npos);
        o = {};
        o.leaves = wrong;
        EXPECT_NE(message(o, {}).find("coefficient of leaves"), std::string::npos);
        o = {};
        o.sheltered = wrong;
        EXPECT_NE(message(o, {}).find("coefficient of sheltered"), std::string::npos);
        o = {};
        o.vogel = wrong;
        EXPECT_NE(message(o, {}).find("Vogel"), std::string::npos);
        o = {};
        o.reference = wrong;
        EXPECT_NE(message(o, {}).find("reference"), std::string::npos);
    }
    cpu::device_options options;
    options.limits.max_buffer_bytes = 47 * tree().size();
    cpu::device small(options);
    const auto made = loads::create(small, tree(), {}, {});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::out_of_memory);
}

// ---- devices ------------------------------------------------------------------------------------

TEST(wind, short_ranges_change_nothing) {
    cpu::device device;
    cpu::device_options options;
    options.limits.max_elements = 7;
    cpu::device narrow(options);
    auto a = value_of(cpu_wind::create(device, wood(50), gusts_of(5)));
    auto b = value_of(cpu_wind::create(narrow, wood(50), gusts_of(5)));
    EXPECT_TRUE(same_bits(air_of(device, a, 3), air_of(narrow, b, 3)));
}

TEST(wind, nothing_is_made_while_it_blows) {
    conformance::null_device device;
    using null = conformance::null_device;
    auto field = value_of(trees::wind_field<null>::create(device, wood(50), gusts_of(5)));
    const trees::wind_grid_layout layout{{0, 0, 0}, {1, 1, 1}, 2, 2, 2};
    const std::vector<vec3> nodes(8);
    auto grid = value_of(trees::wind_grid<null>::create(device, wood(50), layout, nodes));
    auto loads = value_of(trees::wind_loads<null>::create(device, tree(), {}, {}));
    auto poses = value_of(make_buffer<null, segment_pose>(device, at_rest(tree())));
    auto air = value_of(device.create_buffer(16 * tree().size()));
    const auto before = device.counts();
    for (int frame = 0; frame < 3; ++frame) {
        auto done = run(device, [&](auto& r) {
            field.record(r, frame);
            grid.set(r, nodes);
            grid.record(r, frame);
            loads.record(r, view<null>(poses), view<null>(air));
        });
        ASSERT_TRUE(done);
    }
    EXPECT_EQ(device.counts().buffers_made, before.buffers_made);
    EXPECT_EQ(device.counts().maps, before.maps + 9);
    EXPECT_EQ(device.counts().downloads, before.downloads);
}

TEST(wind, calls_are_valid_and_nothing_is_no_trouble) {
    cpu::device inner;
    std::vector<std::string> misuses;
    using checked = validated<cpu::device>;
    checked device(inner, [&](std::string_view s) { misuses.emplace_back(s); });
    for (const std::uint32_t count : {0u, 1u, 9u}) {
        const auto places = wood(count);
        auto field =
            value_of(trees::wind_field<checked>::create(device, places, trees::steady_wind{}));
        auto grid = value_of(trees::wind_grid<checked>::create(
            device, places, trees::wind_grid_layout{}, std::vector<vec3>(1)));
        auto function = value_of(
            trees::make_wind_function(device, places, [](vec3, double) { return vec3(1); }));
        EXPECT_EQ(air_of(device, field, 1).size(), count);
        EXPECT_EQ(air_of(device, grid, 1).size(), count);
        EXPECT_EQ(air_of(device, function, 1).size(), count);
    }
    EXPECT_LE(glm::length(total_load(device, trees::skeleton{}, {}, 5)), 0);
    EXPECT_GT(glm::length(total_load(device, tree(), {}, 5)), 0);
    EXPECT_TRUE(misuses.empty()) << misuses.front();
}

TEST(wind, opengl_has_the_same_wind) {
    support::with_device("opengl", [](auto& device) { check_backend(device); });
}

TEST(wind, vulkan_has_the_same_wind) {
    support::with_device("vulkan", [](auto& device) { check_backend(device); });
}

// The tables of docs/wind.md.
TEST(wind, tables_slow) {
    auto model = gusts_of(17);
    model.speed = 11.3;
    const spectrum_errors errors = measure_spectrum(model);
    for (int c = 0; c < 3; ++c) {
        std::printf("\n%s, variance %+.2f %%\n\n| x = n L / U | error (dB) |\n|---|---|\n",
                    components[c].name, 100 * (errors.variance[c] - 1));
        for (const band_error& b : errors.bands[c]) {
            std::printf("| %.3f | %+.2f |\n", b.x, b.decibels);
        }
    }
    std::printf("\n| frequency (Hz) | distance (m) | measured | Davenport | standard deviation |\n"
                "|---|---|---|---|---|\n");
    for (const coherence_row& r : measure_coherence(64)) {
        std::printf("| %.2f | %.2f | %.3f | %.3f | %.3f |\n", r.frequency, r.distance, r.measured,
                    r.davenport, r.deviation);
    }
    std::printf("\n| tree | exponent of U |\n|---|---|\n");
    std::printf("| bare | %.4f |\n", exponent_of(tree(), {}, 6, 30));
    for (const double vogel : {-0.5, -0.7, -1.0}) {
        trees::drag_options options;
        options.vogel = vogel;
        std::printf("| in leaf, V = %.1f | %.3f |\n", vogel,
                    exponent_of(tree(), leafy(tree(), 0.05f), 6, 30, options));
        options.wood = options.sheltered = 0;
        std::printf("| leaves alone, V = %.1f | %.4f |\n", vogel,
                    exponent_of(tree(), leafy(tree(), 0.05f), 6, 30, options));
    }
}
