#pragma once
// Models of the wind, as tables of waves: a mean, and plane waves that run with it.
//
//     auto table = trees::tabulate(trees::kaimal_gusts{.speed = 12, .from = 250});
//
// A wave of frequency n has the wave vector n/U along the mean wind, so that what passes one place
// reaches the next one downwind unchanged (Taylor's frozen turbulence), and a random one across it,
// drawn so that winds a distance d apart across the mean have Davenport's (root) coherence
// exp(-c n d / U). In two dimensions that is the transform of the density a / (2π (a² + k²)^(3/2)),
// a = c n / U, whose radii are a √(1/q² - 1) with q uniform in (0, 1).
//
// Four waves share a band and have equal amplitudes. The signs of their components are the columns
// of a Hadamard matrix, so that the three components of the wind are uncorrelated in every band.
// Bands are even in the logarithm of the frequency, and the outer two take in what lies outside:
// variances are exact. The waves do not make a field without divergence.
//
// Sources: Kaimal et al. 1972 as in IEC 61400-1 (2005), annex B.2 (the spectrum, σ ratios 1 : 0.8 :
// 0.5, lengths 8.1, 2.7 and 0.66 times 0.7 z); Davenport 1961 (coherence); Ota et al. 2003 (1/f^β);
// Shinozuka and Jan 1972 (the sum of waves).

#include <skybark/core/result.hpp>
#include <skybark/core/when_used.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <vector>

namespace skybark::trees {

/// One wave: amplitude · cos 2π(frequency · t + phase − wave_vector · x).
struct wave {
    glm::dvec3 wave_vector{0}; ///< cycles/m
    double frequency = 0;      ///< Hz
    double phase = 0;          ///< cycles
    glm::dvec3 amplitude{0};   ///< m/s
};

/// How the mean wind grows with height: times ((y − ground) / reference_height)^exponent, and none
/// at and below the ground. Exponent 0, the default: the same everywhere. 0.14 is open country,
/// 0.25 woods and suburbs. Gusts are as strong at every height, and move with the mean at the
/// reference height.
struct mean_profile {
    double exponent = 0;          ///< 0 … 1
    double reference_height = 10; ///< m above the ground, where the mean is the model's speed
    double ground = 0;            ///< m, the height y of the ground
};

/// A table of waves: what a model becomes, or a caller's own.
struct gusts {
    glm::dvec3 mean{0}; ///< m/s at the profile's reference height
    mean_profile profile;
    std::vector<wave> waves; ///< at most 65,536
};

/// The same wind everywhere, always.
struct steady_wind {
    double speed = 5;  ///< m/s, 0 … 1000; 0 is calm
    double from = 270; ///< degrees clockwise from north (−Z): 90 is a wind from the east (+X)
    mean_profile profile;
};

/// What models of gusts have in common.
struct turbulence_options {
    double intensity = 0.25;   ///< σ along the wind / mean speed, 0 … 10
    double lateral = 0.8;      ///< σ across the wind, level, / σ along it, 0 … 10
    double vertical = 0.5;     ///< σ of the vertical part / σ along the wind, 0 … 10
    double decay = 10;         ///< c of the coherence exp(−c n d / U), 0 … 1000
    std::uint32_t waves = 128; ///< a multiple of 4, 4 … 65,536
    std::uint64_t seed = 1;
};

/// Gusts whose spectral density is 1/f^β between two frequencies and nothing outside.
struct power_law_gusts {
    double speed = 8;     ///< m/s, 0 … 1000; 0 is calm
    double from = 270;    ///< degrees of the compass, as in steady_wind
    double beta = 1;      ///< 0 … 4
    double lowest = 0.01; ///< Hz, 1e-6 … 1000
    double highest = 10;  ///< Hz, above the lowest, at most 1000
    turbulence_options turbulence;
    mean_profile profile;
};

/// Gusts with Kaimal's spectrum n S / σ² = 4x / (1 + 6x)^(5/3), x = n L / U, each component with
/// its own length L. The bands span 0.0126 ≤ x ≤ 19.95 of the component along the wind: third
/// octaves with 128 waves.
struct kaimal_gusts {
    double speed = 8;                    ///< m/s, 0 … 1000; 0 is calm
    double from = 270;                   ///< degrees of the compass, as in steady_wind
    double length = 56.7;                ///< m, L along the wind, 1e-3 … 1e6; 5.67 z below 60 m
    double lateral_length = 2.7 / 8.1;   ///< L across the wind, level, / length, 1e-3 … 1e3
    double vertical_length = 0.66 / 8.1; ///< L of the vertical part / length, 1e-3 … 1e3
    turbulence_options turbulence;
    mean_profile profile;
};

/// Unit vector in which a wind from `degrees` of the compass blows.
[[nodiscard]] inline glm::dvec3 blowing_from(double degrees) {
    const double a = std::remainder(degrees, 360.0) * 0.017453292519943295;
    return {-std::sin(a), 0, std::cos(a)};
}

namespace detail {

/// bad_input unless low ≤ value ≤ high; what is not a number isn't.
template <class = when_used>
[[nodiscard]] result<void> expect_range(const char* what, double value, double low, double high) {
    if (value >= low && value <= high) {
        return {};
    }
    std::string sentence("The ");
    sentence.append(what).append(" is ").append(std::to_string(value)).append("; it takes ");
    sentence.append(std::to_string(low)).append(" to ").append(std::to_string(high)).append(".");
    return fail(error_code::bad_input, std::move(sentence));
}

struct range_check {
    const char* what;
    double value;
    double low;
    double high;
};

template <class = when_used>
[[nodiscard]] result<void> expect_ranges(std::initializer_list<range_check> checks) {
    for (const range_check& c : checks) {
        if (auto valid = expect_range(c.what, c.value, c.low, c.high); !valid) {
            return valid;
        }
    }
    return {};
}

inline constexpr double most_compass = 1e6; ///< degrees
inline constexpr std::size_t most_waves = 65'536;

template <class = when_used>
[[nodiscard]] result<void> check(double speed, double from, const mean_profile& p) {
    return expect_ranges({{"wind's speed", speed, 0, 1000},
                          {"direction of the wind", from, -most_compass, most_compass},
                          {"exponent of the mean wind's profile", p.exponent, 0, 1},
                          {"reference height of the mean wind", p.reference_height, 1e-3, 1e6},
                          {"height of the ground", p.ground, -1e6, 1e6}});
}

template <class = when_used>
[[nodiscard]] result<void> check(const turbulence_options& t) {
    if (t.waves < 4 || t.waves > most_waves || t.waves % 4 != 0) {
        return fail(error_code::bad_input, std::string("Gusts cannot have ") +
                                               std::to_string(t.waves) +
                                               " waves; it takes a multiple of 4 up to 65536.");
    }
    return expect_ranges({{"turbulence intensity", t.intensity, 0, 10},
                          {"lateral part of the turbulence", t.lateral, 0, 10},
                          {"vertical part of the turbulence", t.vertical, 0, 10},
                          {"decay of the coherence", t.decay, 0, 1000}});
}

template <class = when_used>
[[nodiscard]] gusts steady(double speed, double from, const mean_profile& profile) {
    return {blowing_from(from) * speed, profile, {}};
}

/// The n-th of an endless row of random numbers in [0, 1) that a seed has (splitmix64).
[[nodiscard]] inline double random_at(std::uint64_t seed, std::uint64_t n) {
    std::uint64_t z = seed * 0xd1342543de82ef95u + (n + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30u)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27u)) * 0x94d049bb133111ebu;
    z ^= z >> 31u;
    return static_cast<double>(z >> 11u) * (1.0 / 9007199254740992.0);
}

[[nodiscard]] inline double fraction(double x) { return x - std::floor(x); }

/// The waves of a model. `below(n)` is, for each component (along, across, up), which part of its
/// variance lies below the frequency n.
template <class Generator>
[[nodiscard]] std::vector<wave> draw_waves(const glm::dvec3& along, double speed,
                                           const turbulence_options& t, double lowest,
                                           double highest, Generator&& below) {
    const glm::dvec3 up(0, 1, 0);
    const glm::dvec3 across = glm::cross(along, up);
    const double sigma = t.intensity * speed;
    const glm::dvec3 variance =
        sigma * sigma * glm::dvec3(1, t.lateral * t.lateral, t.vertical * t.vertical);
    const std::uint32_t bands = t.waves / 4;
    const double octave = std::log(highest / lowest) / bands;
    // Two rows that fill the unit square evenly (Roberts 2018): any run of neighbouring
    // frequencies has wave vectors of all lengths and directions.
    const double turn = random_at(t.seed, 0);
    const double stretch = random_at(t.seed, 1);
    std::vector<wave> waves;
    waves.reserve(t.waves);
    for (std::uint32_t band = 0; band < bands; ++band) {
        const glm::dvec3 from = band == 0 ? glm::dvec3(0) : below(lowest * std::exp(octave * band));
        const glm::dvec3 to =
            band + 1 == bands ? glm::dvec3(1) : below(lowest * std::exp(octave * (band + 1)));
        const glm::dvec3 each = glm::max(variance * (to - from), glm::dvec3(0)) * 0.5;
        const glm::dvec3 a(std::sqrt(each.x), std::sqrt(each.y), std::sqrt(each.z));
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t m = 4 * band + i;
            wave w;
            w.frequency = lowest * std::exp(octave * (band + (i + 0.5) / 4));
            w.phase = random_at(t.seed, 2 + m);
            // Shorter than 1/64 of the decay length nobody sees; floats would.
            const double q = std::max(fraction(stretch + m * 0.7548776662466927), 1.0 / 64);
            const double angle = 6.283185307179586 * fraction(turn + m * 0.5698402909980532);
            const double k =
                t.decay * w.frequency / (6.283185307179586 * speed) * std::sqrt(1 / (q * q) - 1);
            w.wave_vector = along * (w.frequency / speed) + across * (k * std::cos(angle)) +
                            up * (k * std::sin(angle));
            const double side = i % 2 == 0 ? 1 : -1;
            const double rise = i < 2 ? 1 : -1;
            w.amplitude = along * a.x + across * (side * a.y) + up * (rise * a.z);
            waves.push_back(w);
        }
    }
    return waves;
}

} // namespace detail

/// The table of a model. Errors: bad_input where a value is outside the range beside it above.
template <class = when_used>
[[nodiscard]] result<gusts> tabulate(const steady_wind& model) {
    if (auto valid = detail::check(model.speed, model.from, model.profile); !valid) {
        return failure(valid.error());
    }
    return detail::steady(model.speed, model.from, model.profile);
}

template <class = when_used>
[[nodiscard]] result<gusts> tabulate(const power_law_gusts& model) {
    if (auto valid = detail::check(model.speed, model.from, model.profile); !valid) {
        return failure(valid.error());
    }
    if (auto valid = detail::check(model.turbulence); !valid) {
        return failure(valid.error());
    }
    if (auto valid =
            detail::expect_ranges({{"exponent of the spectrum", model.beta, 0, 4},
                                   {"lowest frequency of the gusts", model.lowest, 1e-6, 1000},
                                   {"highest frequency of the gusts", model.highest, 1e-6, 1000}});
        !valid) {
        return failure(valid.error());
    }
    if (model.highest <= model.lowest) {
        return fail(error_code::bad_input, std::string("The highest frequency of the gusts, ") +
                                               std::to_string(model.highest) +
                                               " Hz, is not above the lowest, " +
                                               std::to_string(model.lowest) + " Hz.");
    }
    gusts table = detail::steady(model.speed, model.from, model.profile);
    if (model.speed > 0 && model.turbulence.intensity > 0) {
        // The integral of n^-β from the lowest frequency on, over what doesn't depend on its end.
        const double power = 1 - model.beta;
        const auto integral = [&](double n) {
            const double l = std::log(n / model.lowest);
            return std::abs(power * l) < 1e-12 ? l : std::expm1(power * l) / power;
        };
        const double whole = integral(model.highest);
        table.waves = detail::draw_waves(blowing_from(model.from), model.speed, model.turbulence,
                                         model.lowest, model.highest,
                                         [&](double n) { return glm::dvec3(integral(n) / whole); });
    }
    return table;
}

template <class = when_used>
[[nodiscard]] result<gusts> tabulate(const kaimal_gusts& model) {
    if (auto valid = detail::check(model.speed, model.from, model.profile); !valid) {
        return failure(valid.error());
    }
    if (auto valid = detail::check(model.turbulence); !valid) {
        return failure(valid.error());
    }
    if (auto valid = detail::expect_ranges(
            {{"length of the gusts", model.length, 1e-3, 1e6},
             {"lateral length of the gusts", model.lateral_length, 1e-3, 1e3},
             {"vertical length of the gusts", model.vertical_length, 1e-3, 1e3}});
        !valid) {
        return failure(valid.error());
    }
    gusts table = detail::steady(model.speed, model.from, model.profile);
    if (model.speed > 0 && model.turbulence.intensity > 0) {
        // Kaimal's spectrum from 0 to n: 1 − (1 + 6x)^(−2/3).
        const glm::dvec3 times =
            model.length / model.speed * glm::dvec3(1, model.lateral_length, model.vertical_length);
        const auto below = [&](double n) {
            const auto part = [](double x) { return -std::expm1(std::log1p(6 * x) * (-2.0 / 3)); };
            return glm::dvec3(part(n * times.x), part(n * times.y), part(n * times.z));
        };
        const double hertz = model.speed / model.length;
        table.waves =
            detail::draw_waves(blowing_from(model.from), model.speed, model.turbulence,
                               hertz * std::pow(10, -1.9), hertz * std::pow(10, 1.3), below);
    }
    return table;
}

/// A caller's own table. Errors: bad_input where it has too many waves, or a number in it is not
/// finite or beyond 1e6 (frequencies and wave vectors) or 1000 m/s.
template <class = when_used>
[[nodiscard]] result<gusts> tabulate(const gusts& table) {
    if (auto valid = detail::check(0, 0, table.profile); !valid) {
        return failure(valid.error());
    }
    if (table.waves.size() > detail::most_waves) {
        return fail(error_code::bad_input, std::string("A table of ") +
                                               std::to_string(table.waves.size()) +
                                               " waves is too long; it takes at most 65536.");
    }
    const auto at_most = [](const glm::dvec3& v, double most) { // false for what is not a number
        return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
    };
    if (!at_most(table.mean, 1000)) {
        return fail(error_code::bad_input, "The mean of a table of waves is beyond 1000 m/s.");
    }
    for (std::size_t i = 0; i < table.waves.size(); ++i) {
        const wave& w = table.waves[i];
        if (!at_most(w.wave_vector, 1e6) || !at_most(w.amplitude, 1000) ||
            !at_most({w.frequency, w.phase, 0}, 1e6)) {
            return fail(error_code::bad_input,
                        std::string("Wave ") + std::to_string(i) +
                            " of a table has an amplitude beyond 1000 m/s, or a frequency, phase "
                            "or wave vector beyond 1e6.");
        }
    }
    return table;
}

/// A model of the wind: a value that `tabulate`, found beside its type, makes a table of.
template <class M>
concept gust_model = requires(const M& model) {
    { tabulate(model) } -> std::same_as<result<gusts>>;
};

} // namespace skybark::trees
