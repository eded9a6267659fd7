#pragma once
// Clouds whose light is known: sums over particles in double precision, and what a volume makes of
// them.

#include <skybark/clouds/attenuation_volume.hpp>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace skybark::support {

using namespace skybark::clouds;

/// Particles in a ball of radius 1 (m), radii in [smallest, largest].
inline std::vector<cloud_particle> ball(std::size_t count, float smallest, float largest,
                                        float depth, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::uniform_real_distribution<float> radius(smallest, largest);
    std::vector<cloud_particle> particles;
    while (particles.size() < count) {
        const glm::vec3 at(unit(random), unit(random), unit(random));
        if (glm::dot(at, at) <= 1) {
            cloud_particle p;
            p.position = at;
            p.radius = radius(random);
            p.optical_depth = depth;
            p.albedo = 0.9f + 0.1f * unit(random) * unit(random);
            particles.push_back(p);
        }
    }
    return particles;
}

/// The middle of a voxel in the world, from the grid's definition, in double precision.
inline glm::dvec3 middle_of(const light_grid& grid, glm::dvec3 cells) {
    glm::dvec3 place(glm::vec3(grid.anchor));
    const glm::vec4 rows[] = {grid.row_x, grid.row_y, grid.row_z};
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(glm::vec3(rows[a])));
        place += axis * (double(grid.voxel[a]) * (cells[a] - double(rows[a].w)));
    }
    return place;
}

/// What a particle takes out between a place and the sun, and whether the place lies so near to an
/// edge of the particle that rounding decides.
struct exact_depth {
    double tau = 0;
    bool on_edge = false;
};
inline exact_depth depth_of(const cloud_particle& p, glm::dvec3 at, glm::dvec3 sun,
                            attenuation_profile profile, double sigmas = 3) {
    const glm::dvec3 v = at - glm::dvec3(p.position);
    const double r = double(p.radius);
    const double height = glm::dot(v, sun);
    const double d2 = std::max(0.0, glm::dot(v, v) - height * height);
    const double d = std::sqrt(d2);
    exact_depth found;
    const double near = 1e-5 * r;
    found.on_edge =
        (std::abs(d - r) < near && height < r + near) ||
        (d < r + near && (std::abs(height - r) < near ||
                          (profile == attenuation_profile::erf && std::abs(height + r) < near)));
    if (d >= r || height >= r) {
        return found;
    }
    const double sigma = r / sigmas;
    double part = 1;
    if (profile == attenuation_profile::erf && height > -r) {
        part = 0.5 * std::erfc(height / (std::numbers::sqrt2 * sigma));
    }
    found.tau = double(p.optical_depth) * std::exp(-d2 / (2 * sigma * sigma)) * part;
    return found;
}

inline attenuation_options with(attenuation_method method, attenuation_profile profile,
                                attenuation_light light = attenuation_light::extinction,
                                float forward = 0) {
    attenuation_options options;
    options.method = method;
    options.profile = profile;
    options.light = light;
    options.forward = forward;
    return options;
}

template <class B>
result<std::vector<float>> lit(B& device, attenuation_volume<B>& volume,
                               std::span<const cloud_particle> particles, const light_box& box) {
    auto buffer = make_buffer<B, cloud_particle>(device, particles);
    if (!buffer) {
        return failure(buffer.error());
    }
    auto done = run(device, [&](auto& recorder) {
        volume.relight(recorder, view<B>(*buffer), static_cast<std::uint32_t>(particles.size()),
                       box);
    });
    if (!done) {
        return failure(done.error());
    }
    std::vector<float> values(std::size_t{box.voxels.x} * box.voxels.y * box.voxels.z);
    done = device.download(volume.volume(), std::as_writable_bytes(std::span(values)));
    if (!done) {
        return failure(done.error());
    }
    return values;
}

/// A fresh volume's values; fails the test where there are none.
template <class B>
std::vector<float> cold(B& device, std::span<const cloud_particle> particles, glm::vec3 sun,
                        glm::uvec3 voxels, const attenuation_options& options) {
    const auto box = fit_light_box(particles, sun, voxels);
    auto volume = attenuation_volume<B>::create(device, voxels, options);
    if (!box || !volume) {
        ADD_FAILURE() << (box ? volume.error().message : box.error().message);
        return {};
    }
    auto values = lit(device, *volume, particles, *box);
    if (!values) {
        ADD_FAILURE() << values.error().message;
        return {};
    }
    return std::move(*values);
}

inline std::size_t index_of(glm::uvec3 voxels, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (std::size_t{z} * voxels.y + y) * voxels.x + x;
}

/// Trilinear, clamped to the edges, from cell coordinates.
inline double sampled(const std::vector<float>& values, glm::uvec3 voxels, glm::dvec3 cells) {
    double sum = 0;
    const glm::dvec3 low = glm::floor(cells - 0.5);
    const glm::dvec3 t = cells - 0.5 - low;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 weight = side * t + (1.0 - side) * (1.0 - t);
        const glm::dvec3 at = glm::clamp(low + side, glm::dvec3(0), glm::dvec3(voxels) - 1.0);
        sum += weight.x * weight.y * weight.z *
               double(values[index_of(voxels, static_cast<std::uint32_t>(at.x),
                                      static_cast<std::uint32_t>(at.y),
                                      static_cast<std::uint32_t>(at.z))]);
    }
    return sum;
}

struct transmittance_errors {
    double mean = 0;  ///< of |ΔT|
    double bias = 0;  ///< of the mean T, relative
    double depth = 0; ///< mean optical depth
    double light = 0; ///< mean T of the volume
};

/// Against exact transmittance at places all over the cloud.
inline transmittance_errors errors_of(const std::vector<float>& values, const light_box& box,
                                      std::span<const cloud_particle> particles, glm::vec3 sun,
                                      std::size_t places, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> pick(0, particles.size() - 1);
    std::normal_distribution<double> normal;
    transmittance_errors found;
    double exact_sum = 0;
    for (std::size_t k = 0; k < places; ++k) {
        // Places as the cloud's water lies.
        const cloud_particle& p = particles[pick(random)];
        const glm::dvec3 at =
            glm::dvec3(p.position) +
            glm::dvec3(normal(random), normal(random), normal(random)) * (double(p.radius) / 3);
        double tau = 0;
        for (const cloud_particle& q : particles) {
            tau += depth_of(q, at, glm::normalize(glm::dvec3(sun)), attenuation_profile::erf).tau;
        }
        glm::dvec3 cells;
        const glm::vec4 rows[] = {box.grid.row_x, box.grid.row_y, box.grid.row_z};
        for (int a = 0; a < 3; ++a) {
            cells[a] = glm::dot(glm::dvec3(glm::vec3(rows[a])),
                                at - glm::dvec3(glm::vec3(box.grid.anchor))) +
                       double(rows[a].w);
        }
        const double light = std::exp(-sampled(values, box.voxels, cells));
        found.mean += std::abs(light - std::exp(-tau));
        found.light += light;
        found.depth += tau;
        exact_sum += std::exp(-tau);
    }
    const auto n = static_cast<double>(places);
    found.bias = (found.light - exact_sum) / exact_sum;
    found.mean /= n;
    found.light /= n;
    found.depth /= n;
    return found;
}

/// A cloud of 4,000 blobs: radii 4-8 % of the box's side of 2 m, mean optical depth about 7.
inline std::vector<cloud_particle> blobs(unsigned seed) {
    return ball(4000, 0.08f, 0.16f, 0.91f, seed);
}

} // namespace skybark::support
