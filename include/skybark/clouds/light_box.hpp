#pragma once
// The box of the attenuation volume: fitted to the cloud for each direction of the sun.
//
// The box's +y axis points to the sun (Shimada et al. 2008, 3.3). Two rules keep a picture still
// when little changes. A voxel's sides are powers of 2^(1/32) metres, the smallest that the cloud
// fits with, and the voxels' corners lie at whole multiples of the sides from the world's origin,
// so a cloud that drifts is resampled only where the grid follows it by whole voxels. There is no
// history: a box depends on the cloud and the sun of this moment alone.
//
// All around the cloud is a margin of one voxel at least: the topmost layer holds no attenuation
// and the undermost all of it, so that sampling that is clamped to the box is right below it.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <string>

namespace skybark::clouds {

/// A fitted grid, and how many voxels it has.
struct light_box {
    light_grid grid;
    glm::uvec3 voxels{0};
    float largest_radius = 0; ///< of a particle, m; 0 for a density grid
    /// No line along the light has more optical depth of particles than this. Of a density grid,
    /// whose sums are floats, it says nothing.
    float deepest = 0;
};

/// What a fit needs to know of a cloud whose particles are on the device only. A radius or a depth
/// that is less than the cloud's takes layers from the largest particles, and lets sums overflow.
struct cloud_bounds {
    glm::vec3 low{0};         ///< m, with the radii
    glm::vec3 high{0};        ///< m, with the radii
    float largest_radius = 0; ///< of a particle, m; 0: there are none, but a density grid
    float deepest = 100;      ///< no straight line has more optical depth than this
};

/// Where a density grid lies in the world: an upright box, edge to edge.
struct density_box {
    glm::vec3 low{0};     ///< m
    glm::vec3 high{1};    ///< m
    float extinction = 1; ///< 1/m that a density of 1 means
    float albedo = 1;
};

/// Light sums are whole numbers of this much attenuation, where the deepest column allows it.
inline constexpr float finest_quantum = 0x1p-22f;

namespace detail {

/// Right-handed axes whose y points to the sun: rows.
[[nodiscard]] inline std::array<glm::dvec3, 3> light_axes(glm::vec3 to_sun) {
    const glm::dvec3 y = glm::normalize(glm::dvec3(to_sun));
    const glm::dvec3 other = std::abs(y.y) > 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(other, y));
    return {x, y, glm::cross(x, y)};
}

/// The smallest power of 2^(1/32) that is not less, as a float.
[[nodiscard]] inline float round_side_up(double side) {
    const double power = std::ceil(std::log2(side) * 32.0);
    auto rounded = static_cast<float>(std::exp2(power / 32.0));
    while (static_cast<double>(rounded) < side) {
        rounded = std::nextafter(rounded, std::numeric_limits<float>::infinity());
    }
    return rounded;
}

/// The smallest power of two, at least the finest, for which a sum of `deepest` fits into an int32.
[[nodiscard]] inline float quantum_for(double deepest) {
    double quantum = static_cast<double>(finest_quantum);
    while (deepest > quantum * 2.1e9) {
        quantum *= 2;
    }
    return static_cast<float>(quantum);
}

/// A grid over [low, high] in the light's frame (m along the axes, from the world's origin).
[[nodiscard]] inline light_grid place_grid(const std::array<glm::dvec3, 3>& axes, glm::dvec3 low,
                                           glm::dvec3 high, glm::uvec3 voxels, float quantum) {
    light_grid grid;
    const glm::dvec3 middle = (low + high) * 0.5;
    const glm::vec3 anchor(axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z);
    grid.anchor = glm::vec4(anchor, 0);
    glm::vec4* const rows[] = {&grid.row_x, &grid.row_y, &grid.row_z};
    for (int a = 0; a < 3; ++a) {
        const double room = static_cast<double>(voxels[a]) - 3;
        const float side = round_side_up((high[a] - low[a]) / room);
        const double first = std::floor(low[a] / static_cast<double>(side)) - 1;
        const double at =
            glm::dot(axes[static_cast<std::size_t>(a)], glm::dvec3(anchor)) / double(side) - first;
        *rows[a] = glm::vec4(glm::vec3(axes[static_cast<std::size_t>(a)] / double(side)),
                             static_cast<float>(at));
        grid.voxel[a] = side;
    }
    grid.voxel.w = quantum;
    return grid;
}

/// The shortest text that is read as the same float.
[[nodiscard]] inline std::string number_text(float value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// "1 x 2 x 3"
[[nodiscard]] inline std::string size_text(glm::vec3 size) {
    return number_text(size.x)
        .append(" x ")
        .append(number_text(size.y))
        .append(" x ")
        .append(number_text(size.z));
}

[[nodiscard]] inline result<void> check_sun(glm::vec3 to_sun) {
    const glm::dvec3 to(to_sun); // squares of any floats are doubles
    const double size = glm::dot(to, to);
    if (!(size > 0) || !std::isfinite(size)) {
        return fail(error_code::bad_input,
                    std::string("The direction to the sun is (")
                        .append(number_text(to_sun.x))
                        .append(", ")
                        .append(number_text(to_sun.y))
                        .append(", ")
                        .append(number_text(to_sun.z))
                        .append("); expected a finite vector that is not zero."));
    }
    return {};
}

/// Particles and clouds, m: their squares and what is divided by them stay floats.
inline constexpr float smallest_cloud = 1e-6f;
inline constexpr float largest_cloud = 1e15f;

/// Whether [low, high] in the light's frame is near enough to the world's origin for its voxels to
/// have places: doubles leave 2^-12 of a voxel at this distance.
[[nodiscard]] inline result<void> check_distance(glm::dvec3 low, glm::dvec3 high,
                                                 glm::uvec3 voxels) {
    const glm::dvec3 distances = glm::max(glm::abs(low), glm::abs(high));
    const glm::dvec3 side = (high - low) / (glm::dvec3(voxels) - 3.0);
    const double farthest = std::max({distances.x, distances.y, distances.z});
    const double finest = std::min({side.x, side.y, side.z});
    if (!(farthest <= 0x1p40 * finest)) {
        return fail(error_code::bad_input,
                    std::string("The cloud reaches ")
                        .append(number_text(static_cast<float>(farthest)))
                        .append(" m from the world's origin, and its voxels would be ")
                        .append(number_text(static_cast<float>(finest)))
                        .append(" m; expected voxels of 1e-12 of that distance at least."));
    }
    return {};
}

[[nodiscard]] inline result<void> check_voxels(glm::uvec3 voxels) {
    for (int a = 0; a < 3; ++a) {
        if (voxels[a] < 4 || voxels[a] > 65536) {
            return fail(error_code::bad_input,
                        "An attenuation volume of " + std::to_string(voxels.x) + " x " +
                            std::to_string(voxels.y) + " x " + std::to_string(voxels.z) +
                            " voxels was asked for; each side must be 4 to 65536.");
        }
    }
    return {};
}

/// Sums of optical depth over 32 × 32 bundles of columns: no line through the cloud along the light
/// is deeper than the largest. In whole 1/1024ths, rounded up, so that order does not matter.
class column_depths {
  public:
    column_depths(glm::dvec2 low, glm::dvec2 high)
        : low_(low), scale_(glm::dvec2(side) / glm::max(high - low, glm::dvec2(1e-30))) {}

    void add(glm::dvec2 centre, double radius, double depth) {
        const glm::ivec2 first = cell(centre - radius);
        const glm::ivec2 last = cell(centre + radius);
        const auto more = static_cast<std::uint64_t>(std::ceil(std::min(depth, 1e12) * 1024));
        for (int z = first.y; z <= last.y; ++z) {
            for (int x = first.x; x <= last.x; ++x) {
                sums_[static_cast<std::size_t>(z * side + x)] += more;
            }
        }
    }
    [[nodiscard]] double deepest() const {
        return static_cast<double>(*std::max_element(sums_.begin(), sums_.end())) / 1024;
    }

  private:
    static constexpr int side = 32;
    [[nodiscard]] glm::ivec2 cell(glm::dvec2 at) const {
        return glm::clamp(glm::ivec2(glm::floor((at - low_) * scale_)), glm::ivec2(0),
                          glm::ivec2(side - 1));
    }
    glm::dvec2 low_;
    glm::dvec2 scale_;
    std::array<std::uint64_t, side * side> sums_{};
};

} // namespace detail

/// Whether every particle can be lit: a sentence about the first that can't, with its number.
[[nodiscard]] inline result<void> check_particles(std::span<const cloud_particle> particles) {
    if (particles.empty()) {
        return fail(error_code::bad_input, "The cloud has no particles; expected one at least.");
    }
    const auto wrong = [](std::size_t i, const char* what, float value, const char* expected) {
        return fail(error_code::bad_input, std::string("Particle ")
                                               .append(std::to_string(i))
                                               .append(" has ")
                                               .append(what)
                                               .append(" ")
                                               .append(detail::number_text(value))
                                               .append("; expected ")
                                               .append(expected)
                                               .append("."));
    };
    for (std::size_t i = 0; i < particles.size(); ++i) {
        const cloud_particle& p = particles[i];
        for (int a = 0; a < 3; ++a) {
            if (!(std::abs(p.position[a]) <= detail::largest_cloud)) {
                return wrong(i, "the coordinate", p.position[a], "a number of metres up to 1e15");
            }
        }
        if (!(p.radius >= detail::smallest_cloud && p.radius <= detail::largest_cloud)) {
            return wrong(i, "the radius", p.radius, "a number of metres from 1e-6 to 1e15");
        }
        if (!(p.optical_depth >= 0 && p.optical_depth <= 1e6f)) {
            return wrong(i, "the optical depth", p.optical_depth, "a number from 0 to 1e6");
        }
        if (!(p.albedo >= 0 && p.albedo <= 1)) {
            return wrong(i, "the albedo", p.albedo, "a number from 0 to 1");
        }
    }
    return {};
}

/// Fits a box of `voxels` (each side 4 or more) tightly around the particles, its y axis towards
/// the sun (of any length, straight up and level included). The quantum is the finest that the
/// deepest column allows. Host time: two passes over the particles.
/// Errors: bad_input for a particle, a direction or a size that makes no sense, and for a cloud so
/// far from the world's origin that its voxels have no places there.
[[nodiscard]] inline result<light_box> fit_light_box(std::span<const cloud_particle> particles,
                                                     glm::vec3 to_sun, glm::uvec3 voxels) {
    for (const result<void>& done :
         {detail::check_voxels(voxels), detail::check_sun(to_sun), check_particles(particles)}) {
        if (!done) {
            return failure(done.error());
        }
    }
    const std::array<glm::dvec3, 3> axes = detail::light_axes(to_sun);
    const auto along = [&axes](glm::dvec3 p) {
        return glm::dvec3(glm::dot(axes[0], p), glm::dot(axes[1], p), glm::dot(axes[2], p));
    };
    glm::dvec3 low(std::numeric_limits<double>::infinity());
    glm::dvec3 high = -low;
    light_box box;
    box.voxels = voxels;
    for (const cloud_particle& p : particles) {
        const glm::dvec3 at = along(p.position);
        low = glm::min(low, at - double(p.radius));
        high = glm::max(high, at + double(p.radius));
        box.largest_radius = std::max(box.largest_radius, p.radius);
    }
    if (auto done = detail::check_distance(low, high, voxels); !done) {
        return failure(done.error());
    }
    detail::column_depths columns({low.x, low.z}, {high.x, high.z});
    for (const cloud_particle& p : particles) {
        const glm::dvec3 at = along(p.position);
        columns.add({at.x, at.z}, double(p.radius), double(p.optical_depth));
    }
    box.grid = detail::place_grid(axes, low, high, voxels, detail::quantum_for(columns.deepest()));
    box.deepest = static_cast<float>(columns.deepest());
    return box;
}

/// The same around a box of the world, in no time: looser, for particles that the host never sees.
[[nodiscard]] inline result<light_box> fit_light_box(const cloud_bounds& bounds, glm::vec3 to_sun,
                                                     glm::uvec3 voxels) {
    for (const result<void>& done : {detail::check_voxels(voxels), detail::check_sun(to_sun)}) {
        if (!done) {
            return failure(done.error());
        }
    }
    const glm::vec3 size = bounds.high - bounds.low;
    const float smallest = std::min({size.x, size.y, size.z});
    const bool sizes = smallest >= detail::smallest_cloud && size.x <= detail::largest_cloud &&
                       size.y <= detail::largest_cloud && size.z <= detail::largest_cloud;
    if (!sizes || !(bounds.deepest >= 0 && bounds.deepest <= 1e12f)) {
        return fail(error_code::bad_input,
                    std::string("A cloud of ")
                        .append(detail::size_text(size))
                        .append(" m and optical depth up to ")
                        .append(detail::number_text(bounds.deepest))
                        .append(" cannot be lit; expected sides from 1e-6 to 1e15 m and a depth "
                                "from 0 to 1e12."));
    }
    if (!(bounds.largest_radius >= 0 && bounds.largest_radius <= 0.501f * smallest)) {
        return fail(error_code::bad_input,
                    std::string("A cloud of ")
                        .append(detail::size_text(size))
                        .append(" m, with the radii, has a largest radius of ")
                        .append(detail::number_text(bounds.largest_radius))
                        .append(" m; expected from 0 to half the shortest side."));
    }
    const std::array<glm::dvec3, 3> axes = detail::light_axes(to_sun);
    const glm::dvec3 middle = (glm::dvec3(bounds.low) + glm::dvec3(bounds.high)) * 0.5;
    const glm::dvec3 half = glm::dvec3(size) * 0.5;
    glm::dvec3 low(0);
    glm::dvec3 high(0);
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3& axis = axes[static_cast<std::size_t>(a)];
        const double reach = glm::dot(glm::abs(axis), half);
        low[a] = glm::dot(axis, middle) - reach;
        high[a] = glm::dot(axis, middle) + reach;
    }
    if (auto done = detail::check_distance(low, high, voxels); !done) {
        return failure(done.error());
    }
    return light_box{
        detail::place_grid(axes, low, high, voxels, detail::quantum_for(double(bounds.deepest))),
        voxels, bounds.largest_radius, bounds.deepest};
}

/// Whether a density grid can be lit there: sides from 1e-6 to 1e15 m, an extinction from 0 to 1e15
/// 1/m, an albedo from 0 to 1. Errors: bad_input.
[[nodiscard]] inline result<void> check_density_box(const density_box& where) {
    const glm::vec3 size = where.high - where.low;
    bool sides = true;
    for (int a = 0; a < 3; ++a) {
        sides = sides && size[a] >= detail::smallest_cloud && size[a] <= detail::largest_cloud;
    }
    if (!sides || !(where.extinction >= 0 && where.extinction <= 1e15f) ||
        !(where.albedo >= 0 && where.albedo <= 1)) {
        return fail(error_code::bad_input,
                    std::string("A density grid of ")
                        .append(detail::size_text(size))
                        .append(" m, extinction ")
                        .append(detail::number_text(where.extinction))
                        .append(" 1/m and albedo ")
                        .append(detail::number_text(where.albedo))
                        .append(" cannot be lit; expected sides from 1e-6 to 1e15 m, an extinction "
                                "from 0 to 1e15 and an albedo from 0 to 1."));
    }
    return {};
}

/// The same around a density grid. Errors: also those of check_density_box.
[[nodiscard]] inline result<light_box> fit_light_box(const density_box& where, glm::vec3 to_sun,
                                                     glm::uvec3 voxels) {
    if (auto done = check_density_box(where); !done) {
        return failure(done.error());
    }
    cloud_bounds bounds;
    bounds.low = where.low;
    bounds.high = where.high;
    return fit_light_box(bounds, to_sun, voxels);
}

} // namespace skybark::clouds
