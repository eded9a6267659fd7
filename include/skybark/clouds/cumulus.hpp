#pragma once
// Cumulus clouds out of a random seed, as particles.
//
//     const auto cloud = clouds::cumulus_cloud({.seed = 7});
//     const auto sky = clouds::cumulus_field({.clouds = 20, .extent = 9000});
//
// A cloud is a pile of balls first: towers that rise from a level base, highest in the middle, and
// shoulders around them; every ball carries smaller balls on its upper side, those smaller ones
// again, down to what the particles can show (the cauliflower). Shreds hang around the foot.
// Then the pile is filled with particles, small and close together near its surface, where the
// eye sees them, and large within, as far apart as keeps their sum smooth. All water together is
// `extinction` times the pile's volume, however many particles there are.
//
// The same options give the same particles. Extinction: 1.5 · liquid water / (density of water ·
// radius of droplets). 0.3 g/m³ of droplets with a radius of 10 µm, as in small fair-weather
// clouds, make 0.045 1/m; 1.3 g/m³, what rising air condenses over 700 m, in droplets with a radius
// of 5 µm 0.4 1/m: that gives hard edges. phase_function::mie takes the diameter: mie(20) for a
// radius of 10 µm.

#include <skybark/core/records.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

namespace skybark::clouds {

/// As many particles are made at most, of a cloud or a field. While a cloud is made, each takes
/// about 300 bytes.
inline constexpr std::uint32_t most_cumulus_particles = 1u << 22;
/// As many clouds are in a field at most.
inline constexpr std::uint32_t most_cumulus_clouds = 4096;

/// One cloud. Width and thickness: 1 mm to 1000 km, neither more than 50 times the other. Beyond
/// that, of more than most_cumulus_particles, of numbers that are not finite and of an extinction
/// that is not above 0 and up to 10^6 1/m, no cloud is made.
struct cumulus_options {
    std::uint64_t seed = 1;
    glm::vec3 base{0, 900, 0};       ///< m, the middle of the level base
    float width = 1500;              ///< m, across the base
    float thickness = 800;           ///< m, from the base to the highest top
    std::uint32_t particles = 12000; ///< as many are made
    float extinction = 0.4f;         ///< 1/m, inside
    float albedo = 1;                ///< of a single scattering
};

/// Clouds of several sizes over a square, none on top of another where there is room. The largest
/// keeps to the limits of one cloud, all particles together to most_cumulus_particles; else, and of
/// more than most_cumulus_clouds, no cloud is made.
struct cumulus_field_options {
    std::uint64_t seed = 1;
    glm::vec3 centre{0, 900, 0}; ///< m, the middle of the square; y: altitude of the bases
    float extent = 8000;         ///< m, side of the square
    std::uint32_t clouds = 12;   ///< how many
    std::uint32_t particles_per_cloud = 4000; ///< on average: large clouds have more
    float width = 1600;                       ///< m, across the largest
    float thickness = 900;                    ///< m, of the largest
    float extinction = 0.4f;                  ///< 1/m, inside
    float albedo = 1;
};

namespace detail {

/// An endless row of random numbers that a seed has (splitmix64).
class cumulus_random {
  public:
    explicit cumulus_random(std::uint64_t seed) : state_(seed) {}

    [[nodiscard]] std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    /// In [0, 1).
    [[nodiscard]] double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    [[nodiscard]] double between(double low, double high) { return low + (high - low) * unit(); }
    [[nodiscard]] glm::dvec2 in_disc() {
        for (;;) {
            const glm::dvec2 p(between(-1, 1), between(-1, 1));
            if (glm::dot(p, p) <= 1) {
                return p;
            }
        }
    }
    /// A unit vector whose height is not below `low`.
    [[nodiscard]] glm::dvec3 direction(double low) {
        const double y = between(low, 1);
        glm::dvec2 p = in_disc();
        const double length = glm::length(p);
        p = length > 0 ? p * (std::sqrt(1 - y * y) / length) : glm::dvec2(std::sqrt(1 - y * y), 0);
        return {p.x, y, p.y};
    }

  private:
    std::uint64_t state_;
};

/// A ball of the pile, in m from the middle of the base, and the part of the water that it holds.
struct cumulus_ball {
    glm::dvec3 centre{0};
    double radius = 0;
    double density = 1;
};

/// A place inside the pile: how deep below its surface, and how much water is there.
struct cumulus_place {
    glm::dvec3 position{0};
    double depth = 0;
    double density = 0;
};

/// Which of many things lie near a place: cubes of space, each with a list.
class cumulus_cells {
  public:
    cumulus_cells(glm::dvec3 low, glm::dvec3 high, double side) : low_(low) {
        // At most 2^21 cubes.
        const glm::dvec3 size = glm::max(high - low, glm::dvec3(1e-6));
        side_ = std::max(side, std::cbrt(size.x * size.y * size.z) / 100);
        for (int i = 0; i < 3; ++i) {
            count_[i] = std::clamp(static_cast<int>(size[i] / side_) + 1, 1, 1024);
        }
        lists_.resize(std::size_t(count_[0]) * std::size_t(count_[1]) * std::size_t(count_[2]));
    }

    [[nodiscard]] double side() const { return side_; }

    /// Calls `visit(list)` for each cube that the box around `p` meets.
    template <class Visit>
    void around(glm::dvec3 p, double reach, Visit&& visit) {
        std::array<int, 3> from{};
        std::array<int, 3> to{};
        for (int i = 0; i < 3; ++i) {
            from[std::size_t(i)] = at(p[i] - reach - low_[i], count_[i]);
            to[std::size_t(i)] = at(p[i] + reach - low_[i], count_[i]);
        }
        for (int z = from[2]; z <= to[2]; ++z) {
            for (int y = from[1]; y <= to[1]; ++y) {
                for (int x = from[0]; x <= to[0]; ++x) {
                    visit(lists_[std::size_t(x + count_[0] * (y + count_[1] * z))]);
                }
            }
        }
    }

  private:
    [[nodiscard]] int at(double distance, int count) const {
        return static_cast<int>(std::clamp(distance / side_, 0.0, count - 1.0));
    }

    glm::dvec3 low_;
    double side_ = 1;
    glm::ivec3 count_{1};
    std::vector<std::vector<std::uint32_t>> lists_;
};

/// Towers, each a stack of balls that narrows, and shoulders around them. The first tower stands in
/// the middle and is as high as the cloud.
inline std::vector<cumulus_ball> cumulus_towers(cumulus_random& random, double half,
                                                double thickness) {
    std::vector<cumulus_ball> balls;
    const glm::dvec2 lean = random.in_disc() * 0.18;
    const int towers = 7 + static_cast<int>(random.unit() * 4);
    for (int t = 0; t < towers; ++t) {
        const glm::dvec2 out = t == 0 ? random.in_disc() * 0.25 : random.in_disc() * 0.72;
        const double edge = glm::length(out);
        const double height =
            t == 0 ? thickness
                   : thickness * (1 - 0.45 * edge * edge * edge) * random.between(0.45, 0.97);
        const double wide =
            std::min(half * (t == 0 ? 0.36 : random.between(0.2, 0.32)), height * 0.48);
        const double narrow = wide * random.between(0.55, 0.8);
        const double lowest = wide * 0.35;
        const double highest = std::max(lowest, height - narrow);
        const int steps = 1 + static_cast<int>((highest - lowest) / (0.55 * wide));
        for (int s = 0; s <= steps; ++s) {
            const double u = static_cast<double>(s) / steps;
            const double y = lowest + (highest - lowest) * u;
            const double radius = wide + (narrow - wide) * u;
            const double wander = s == steps && t == 0 ? 0.0 : 0.35 * radius;
            const glm::dvec2 aside = random.in_disc() * wander + lean * y;
            balls.push_back({{out.x * half + aside.x, y, out.y * half + aside.y}, radius, 1});
        }
    }
    const int shoulders = 14;
    for (int s = 0; s < shoulders; ++s) {
        const double angle = 2 * std::numbers::pi * (s + random.unit()) / shoulders;
        const double radius =
            std::min(half * random.between(0.15, 0.27), thickness * random.between(0.2, 0.34));
        const double out = (half - radius) * random.between(0.62, 1);
        balls.push_back(
            {{out * std::cos(angle), radius * random.between(0.1, 0.5), out * std::sin(angle)},
             radius,
             1});
    }
    return balls;
}

/// The box around balls.
struct cumulus_bounds {
    glm::dvec3 low{0};
    glm::dvec3 high{0};
};
inline cumulus_bounds cumulus_around(const std::vector<cumulus_ball>& balls) {
    cumulus_bounds box;
    for (const cumulus_ball& b : balls) {
        box.low = glm::min(box.low, b.centre - b.radius);
        box.high = glm::max(box.high, b.centre + b.radius);
    }
    return box;
}

/// Puts the balls from number `first` on into the cubes that they reach into.
inline void cumulus_enter(cumulus_cells& cells, const std::vector<cumulus_ball>& balls,
                          std::size_t first) {
    for (std::size_t i = first; i < balls.size(); ++i) {
        cells.around(balls[i].centre, balls[i].radius, [&](std::vector<std::uint32_t>& list) {
            list.push_back(static_cast<std::uint32_t>(i));
        });
    }
}

/// Whether a new ball would only lie inside one of those in the cubes.
inline bool cumulus_buried(cumulus_cells& cells, const std::vector<cumulus_ball>& balls,
                           glm::dvec3 centre, double radius) {
    bool buried = false;
    cells.around(centre, 0, [&](const std::vector<std::uint32_t>& list) {
        for (const std::uint32_t i : list) {
            const double room = balls[i].radius - 0.35 * radius;
            const glm::dvec3 d = balls[i].centre - centre;
            buried = buried || (room > 0 && glm::dot(d, d) < room * room);
        }
    });
    return buried;
}

/// The whole pile: balls on balls down to `smallest`, then the shreds around the foot.
inline std::vector<cumulus_ball> cumulus_pile(cumulus_random& random, double half, double thickness,
                                              double smallest) {
    std::vector<cumulus_ball> balls = cumulus_towers(random, half, thickness);
    constexpr std::array<int, 4> on_each{14, 14, 12, 10};
    const cumulus_bounds box = cumulus_around(balls);
    cumulus_cells cells(box.low, box.high, 0.15 * std::min(half, thickness));
    std::size_t first = 0;
    for (const int puffs : on_each) {
        const std::size_t last = balls.size();
        cumulus_enter(cells, balls, first);
        for (std::size_t parent = first; parent < last; ++parent) {
            for (int i = 0; i < puffs; ++i) {
                const double radius = balls[parent].radius * random.between(0.26, 0.5);
                const glm::dvec3 centre =
                    balls[parent].centre + random.direction(-0.25) * (0.93 * balls[parent].radius);
                if (radius >= smallest && centre.y + radius <= thickness &&
                    !cumulus_buried(cells, balls, centre, radius)) {
                    balls.push_back({centre, radius, 1});
                }
            }
        }
        first = last;
    }
    // Each shred is a row of balls around the foot, smaller and smaller.
    const int shreds = 9;
    for (int i = 0; i < shreds; ++i) {
        const double angle = 2 * std::numbers::pi * random.unit();
        const double turn = random.unit() < 0.5 ? 1 : -1;
        const double density = random.between(0.1, 0.35);
        double radius = std::min(half * random.between(0.05, 0.1), 0.2 * thickness);
        double along = 0;
        double height = radius * random.between(0.3, 1.1);
        for (int piece = 0; piece < 4; ++piece) {
            const double at = angle + turn * along / half;
            const double out = half * random.between(0.84, 0.98);
            balls.push_back({{out * std::cos(at), height, out * std::sin(at)}, radius, density});
            along += 1.1 * radius;
            radius *= 0.72;
            height += radius * random.between(-0.3, 0.5);
            height = std::max(height, 0.2 * radius);
        }
    }
    return balls;
}

/// Random places in the pile, even over its volume, and that volume in m³.
struct cumulus_places {
    std::vector<cumulus_place> all;
    double volume = 0;
};

inline cumulus_places cumulus_inside(cumulus_random& random, const std::vector<cumulus_ball>& balls,
                                     double half, double thickness, std::size_t wanted) {
    auto [low, high] = cumulus_around(balls);
    low.y = 0;
    high.y = thickness;
    cumulus_cells cells(low, high, std::min(thickness, 2 * half) / 24);
    cumulus_enter(cells, balls, 0);
    cumulus_places places;
    std::size_t tries = 0;
    const glm::dvec3 size = high - low;
    while (places.all.size() < wanted && tries < 200 * wanted) {
        ++tries;
        cumulus_place place;
        place.position = low + size * glm::dvec3(random.unit(), random.unit(), random.unit());
        cells.around(place.position, 0, [&](const std::vector<std::uint32_t>& list) {
            for (const std::uint32_t i : list) {
                const double depth =
                    balls[i].radius - glm::distance(balls[i].centre, place.position);
                if (depth > place.depth) {
                    place.depth = depth;
                    place.density = std::max(place.density, balls[i].density);
                }
            }
        });
        if (place.depth > 0) {
            // The base is a surface as well.
            place.depth = std::min(place.depth, place.position.y);
            places.all.push_back(place);
        }
    }
    places.volume = size.x * size.y * size.z * static_cast<double>(places.all.size()) /
                    static_cast<double>(std::max<std::size_t>(tries, 1));
    return places;
}

/// Radius of a particle at a depth below the surface: what reaches one sigma below it there grows
/// with the depth, up to a limit. `finest` is the radius at the surface.
inline double cumulus_radius(double finest, double depth) {
    return std::min(finest + depth, 6 * finest);
}

/// Particles are this part of their radius apart: 1.8 sigma, where Gaussians on a cubic lattice add
/// up to what is level within 1.5 %.
inline constexpr double cumulus_spacing = 0.6;

/// The radius at the surface with which `count` particles fill the volume.
inline double cumulus_finest(const cumulus_places& places, std::uint32_t count, double largest) {
    double low = 1e-6 * largest;
    double high = largest;
    for (int step = 0; step < 40; ++step) {
        const double middle = std::sqrt(low * high);
        double needed = 0;
        for (const cumulus_place& p : places.all) {
            const double apart = cumulus_spacing * cumulus_radius(middle, p.depth);
            needed += 1 / (apart * apart * apart);
        }
        needed *= places.volume / static_cast<double>(places.all.size());
        (needed > count ? low : high) = middle;
    }
    return std::sqrt(low * high);
}

/// `count` of the places, as far apart from each other as their radii ask: of a few at random, the
/// one that lies farthest from those taken already (Mitchell 1991).
inline std::vector<std::uint32_t> cumulus_choice(cumulus_random& random,
                                                 const cumulus_places& places, double finest,
                                                 std::uint32_t count) {
    std::vector<double> sums(places.all.size());
    double sum = 0;
    glm::dvec3 low(places.all.front().position);
    glm::dvec3 high = low;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double radius = cumulus_radius(finest, places.all[i].depth);
        sum += 1 / (radius * radius * radius);
        sums[i] = sum;
        low = glm::min(low, places.all[i].position);
        high = glm::max(high, places.all[i].position);
    }
    cumulus_cells cells(low, high, finest);
    std::vector<std::uint32_t> chosen;
    chosen.reserve(count);
    constexpr int candidates = 8;
    for (std::uint32_t n = 0; n < count; ++n) {
        std::uint32_t best = 0;
        double farthest = -1;
        for (int c = 0; c < candidates; ++c) {
            const auto found = std::upper_bound(sums.begin(), sums.end(), random.unit() * sum);
            const auto i = static_cast<std::uint32_t>(
                std::min<std::ptrdiff_t>(found - sums.begin(), std::ssize(sums) - 1));
            const glm::dvec3 p = places.all[i].position;
            const double radius = cumulus_radius(finest, places.all[i].depth);
            const double reach = 0.8 * cumulus_spacing * radius;
            double nearest = reach * reach;
            cells.around(p, reach, [&](const std::vector<std::uint32_t>& list) {
                for (const std::uint32_t other : list) {
                    const glm::dvec3 d = places.all[other].position - p;
                    nearest = std::min(nearest, glm::dot(d, d));
                }
            });
            if (nearest / (radius * radius) > farthest) {
                farthest = nearest / (radius * radius);
                best = i;
            }
        }
        chosen.push_back(best);
        cells.around(places.all[best].position, 0,
                     [&](std::vector<std::uint32_t>& list) { list.push_back(best); });
    }
    return chosen;
}

/// Whether a cloud of this shape can be made: beyond it, floats run out or piles take hours.
[[nodiscard]] inline bool cumulus_shape(float width, float thickness) {
    const auto is_size = [](float x) { return x >= 1e-3f && x <= 1e6f; };
    return is_size(width) && is_size(thickness) && thickness <= 50 * width &&
           width <= 50 * thickness;
}
[[nodiscard]] inline bool cumulus_matter(float extinction, float albedo) {
    return extinction > 0 && extinction <= 1e6f && std::isfinite(albedo);
}
[[nodiscard]] inline bool cumulus_place_in_world(glm::vec3 p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A cloud of options that make sense.
[[nodiscard]] inline std::vector<cloud_particle> cumulus_filled(const cumulus_options& options) {
    std::vector<cloud_particle> particles;
    cumulus_random random(options.seed);
    const double half = 0.5 * double{options.width};
    const double thickness = double{options.thickness};
    const double smallest = 3 * half / std::sqrt(static_cast<double>(options.particles));
    const auto pile = cumulus_pile(random, half, thickness, smallest);
    const auto places =
        cumulus_inside(random, pile, half, thickness,
                       std::max<std::size_t>(20000, std::size_t{6} * options.particles));
    if (places.all.empty()) {
        return particles;
    }
    const double finest = cumulus_finest(places, options.particles, std::max(half, thickness));
    const auto chosen = cumulus_choice(random, places, finest, options.particles);

    double cubes = 0;
    for (const std::uint32_t i : chosen) {
        const double radius = cumulus_radius(finest, places.all[i].depth);
        cubes += radius * radius * radius;
    }
    particles.reserve(chosen.size());
    for (const std::uint32_t i : chosen) {
        const cumulus_place& place = places.all[i];
        const double radius = cumulus_radius(finest, place.depth);
        // Water in m²: extinction times its share of the volume. A Gaussian of depth t through its
        // centre holds t · 2π sigma², sigma = radius / 3.
        const double water = double{options.extinction} * places.volume * place.density *
                             (radius * radius * radius / cubes);
        const double depth = water * 9 / (2 * std::numbers::pi * radius * radius);
        cloud_particle particle;
        particle.position = options.base + glm::vec3(place.position);
        particle.radius = static_cast<float>(radius);
        particle.optical_depth = static_cast<float>(depth);
        particle.albedo = options.albedo;
        particles.push_back(particle);
    }
    return particles;
}

} // namespace detail

/// A cumulus cloud of `options.particles` particles, all of them centred above the base.
[[nodiscard]] inline std::vector<cloud_particle> cumulus_cloud(const cumulus_options& options) {
    if (options.particles == 0 || options.particles > most_cumulus_particles ||
        !detail::cumulus_shape(options.width, options.thickness) ||
        !detail::cumulus_matter(options.extinction, options.albedo) ||
        !detail::cumulus_place_in_world(options.base)) {
        return {};
    }
    return detail::cumulus_filled(options);
}

/// A sky of cumulus clouds: `options.clouds` of them, `clouds · particles_per_cloud` particles,
/// cloud after cloud. Many are small and few are large: the number of clouds wider than w falls
/// like 1/w, from the widest to a quarter of it.
[[nodiscard]] inline std::vector<cloud_particle>
cumulus_field(const cumulus_field_options& options) {
    std::vector<cloud_particle> particles;
    const std::uint64_t all = std::uint64_t{options.clouds} * options.particles_per_cloud;
    if (all == 0 || all > most_cumulus_particles || options.clouds > most_cumulus_clouds ||
        !std::isfinite(options.extent) || !(options.extent > 0) ||
        !detail::cumulus_shape(options.width, options.thickness) ||
        !detail::cumulus_matter(options.extinction, options.albedo) ||
        !detail::cumulus_place_in_world(options.centre)) {
        return particles;
    }
    detail::cumulus_random random(options.seed);
    std::vector<double> sizes(options.clouds); // of the largest
    double area = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const double rank = (static_cast<double>(i) + 0.5) / static_cast<double>(sizes.size());
        sizes[i] = i == 0 ? 1 : 1 / (1 + 3 * rank);
        area += sizes[i] * sizes[i];
    }
    particles.reserve(all);
    std::vector<glm::dvec3> taken; // x, z, half the width
    double before = 0;
    for (const double size : sizes) {
        const double half = 0.5 * size * double{options.width};
        const double room = std::max(0.0, 0.5 * double{options.extent} - half);
        glm::dvec3 best(0);
        double widest = -1e300;
        for (int candidate = 0; candidate < 24; ++candidate) {
            const glm::dvec3 at(random.between(-room, room), random.between(-room, room), half);
            double gap = 1e200;
            for (const glm::dvec3& other : taken) {
                gap = std::min(gap,
                               glm::distance(glm::dvec2(at), glm::dvec2(other)) - at.z - other.z);
            }
            if (gap > widest) {
                widest = gap;
                best = at;
            }
        }
        taken.push_back(best);
        cumulus_options one;
        one.seed = random.bits();
        one.base = options.centre +
                   glm::vec3(static_cast<float>(best.x), 0.0f, static_cast<float>(best.y));
        one.width = static_cast<float>(2 * half);
        one.thickness = static_cast<float>(double{options.thickness} * std::pow(size, 0.8) *
                                           random.between(0.85, 1));
        const auto first = static_cast<std::uint64_t>(before / area * static_cast<double>(all));
        before += size * size;
        const auto last =
            taken.size() == sizes.size()
                ? all
                : static_cast<std::uint64_t>(before / area * static_cast<double>(all));
        one.particles = static_cast<std::uint32_t>(last - first);
        one.extinction = options.extinction;
        one.albedo = options.albedo;
        if (one.particles == 0) {
            continue;
        }
        const auto cloud = detail::cumulus_filled(one);
        for (const cloud_particle& particle : cloud) {
            particles.push_back(particle);
        }
    }
    return particles;
}

} // namespace skybark::clouds
