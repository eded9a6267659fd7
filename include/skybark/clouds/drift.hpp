#pragma once
// Clouds that drift with the wind, for ever, on the device.
//
//     auto drift = drifting_particles<B>::create(device, particles, middles, {{0, 0}, 10000});
//     const auto box = fit_light_box(reach_of(particles, middles, drift->box()), to_sun, voxels);
//     run(device, [&](auto& recorder) {
//         drift->record(recorder, wind * seconds, count);
//         sun.relight(recorder, drift->particles(), count, *box);
//     });
//
// Clouds lie in a square; what leaves it comes in on the other side. A cloud goes round as a whole,
// where its middle crosses the border, and has faded to nothing before: inside of a disc it is all
// there, outside of another nothing is. Where a particle is at a time follows from the time alone.

#include <skybark/clouds/light_box.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/cloud_drift.hpp>

#include <cassert>
#include <optional>

namespace skybark::clouds {

/// The square that clouds go round in, and where they fade.
struct drift_box {
    glm::vec2 centre{0}; ///< m, x and z
    float side = 10000;  ///< m
    float inner = 3800;  ///< m from the centre to a cloud's middle: up to here it is whole
    float outer = 5000;  ///< from here on there is nothing of it; at most side / 2
};

/// How far a cloud has moved along x and z, as the kernel wants it: in [0, side). In double, so
/// that after days a cloud still moves by millimetres.
[[nodiscard]] inline glm::vec2 drift_offset(const drift_box& box, glm::dvec2 moved) {
    const double side = double{box.side};
    glm::vec2 offset(0);
    for (int a = 0; a < 2; ++a) {
        const double turns = std::floor(moved[a] / side);
        const auto rest = static_cast<float>(moved[a] - turns * side);
        // NaN, and what rounds up to the side, is no offset.
        offset[a] = rest >= 0 && rest < box.side ? rest : 0.0f;
    }
    return offset;
}

/// The kernel's parameters for clouds that have moved so far.
[[nodiscard]] inline kernels::cloud_drift drift_by(const drift_box& box, glm::dvec2 moved) {
    const glm::vec2 offset = drift_offset(box, moved);
    const float outer2 = box.outer * box.outer;
    kernels::cloud_drift kernel;
    kernel.box = glm::vec4(box.centre, box.side, 1 / box.side);
    kernel.moved = glm::vec4(offset, outer2, 1 / (outer2 - box.inner * box.inner));
    return kernel;
}

/// What drifting particles stay inside of, wherever they are: an upright cylinder.
struct drift_bounds {
    glm::vec2 centre{0};      ///< m, x and z
    float reach = 0;          ///< m from there, with the radii
    float low = 0;            ///< m, y, with the radii
    float high = 0;           ///< m
    float largest_radius = 0; ///< m
    float deepest = 100;      ///< no straight line has more optical depth than this
};

/// The bounds of all particles that have not faded. `deepest` is twice the optical depth of a line
/// through nothing but the extinction `densest` (1/m) that is as long as the cylinder is wide and
/// high together: no line in it is longer, however the clouds lie.
[[nodiscard]] inline drift_bounds reach_of(std::span<const cloud_particle> particles,
                                           std::span<const glm::vec4> middles, const drift_box& box,
                                           float densest = 0.2f) {
    assert(particles.size() == middles.size());
    drift_bounds bounds;
    bounds.centre = box.centre;
    bounds.low = std::numeric_limits<float>::max();
    bounds.high = -bounds.low;
    float aside = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        const cloud_particle& p = particles[i];
        const float x = p.position.x - middles[i].x;
        const float z = p.position.z - middles[i].z;
        aside = std::max(aside, std::sqrt(x * x + z * z) + p.radius);
        bounds.low = std::min(bounds.low, p.position.y - p.radius);
        bounds.high = std::max(bounds.high, p.position.y + p.radius);
        bounds.largest_radius = std::max(bounds.largest_radius, p.radius);
    }
    if (!(bounds.low < bounds.high)) {
        bounds.low = 0;
        bounds.high = 1;
    }
    bounds.reach = box.outer + aside;
    bounds.deepest = 2 * densest * (2 * bounds.reach + bounds.high - bounds.low);
    return bounds;
}

/// Fits a box of `voxels` (each side 4 or more) around the cylinder, its y axis towards the sun: in
/// no time, and the same however the clouds have drifted. Errors: bad_input for a direction or
/// sizes that make no sense.
[[nodiscard]] inline result<light_box> fit_light_box(const drift_bounds& bounds, glm::vec3 to_sun,
                                                     glm::uvec3 voxels) {
    for (const result<void>& done : {detail::check_voxels(voxels), detail::check_sun(to_sun)}) {
        if (!done) {
            return failure(done.error());
        }
    }
    const float height = bounds.high - bounds.low;
    if (!(bounds.reach >= detail::smallest_cloud && bounds.reach <= 1e9f &&
          height >= detail::smallest_cloud && height <= 1e9f && bounds.deepest >= 0 &&
          bounds.deepest <= 1e12f && bounds.largest_radius >= 0 &&
          bounds.largest_radius <= 0.501f * std::min(height, 2 * bounds.reach))) {
        return fail(error_code::bad_input,
                    std::string("Clouds within ")
                        .append(detail::number_text(bounds.reach))
                        .append(" m, ")
                        .append(detail::number_text(height))
                        .append(" m high, of optical depth up to ")
                        .append(detail::number_text(bounds.deepest))
                        .append(" and of particles up to ")
                        .append(detail::number_text(bounds.largest_radius))
                        .append(" m cannot be lit; expected sizes from 1e-6 to 1e9 m, a depth from "
                                "0 to 1e12 and radii of half the height at most."));
    }
    const std::array<glm::dvec3, 3> axes = detail::light_axes(to_sun);
    const glm::dvec3 middle(bounds.centre.x, 0.5 * (double{bounds.low} + double{bounds.high}),
                            bounds.centre.y);
    glm::dvec3 low(0);
    glm::dvec3 high(0);
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3& axis = axes[static_cast<std::size_t>(a)];
        const double level = std::sqrt(axis.x * axis.x + axis.z * axis.z);
        const double reach = level * double{bounds.reach} +
                             std::abs(axis.y) * 0.5 * (double{bounds.high} - double{bounds.low});
        low[a] = glm::dot(axis, middle) - reach;
        high[a] = glm::dot(axis, middle) + reach;
    }
    if (auto done = detail::check_distance(low, high, voxels); !done) {
        return failure(done.error());
    }
    return light_box{
        detail::place_grid(axes, low, high, voxels, detail::quantum_for(double{bounds.deepest})),
        voxels, bounds.largest_radius, bounds.deepest};
}

template <backend B>
requires maps<B, kernels::cloud_drift>
class drifting_particles {
  public:
    /// Sends the particles and the middle of each one's cloud (m; y and w are not read), as many,
    /// to the device. Each middle must lie in the square. Errors: bad_input where sizes make no
    /// sense; those of the device.
    [[nodiscard]] static result<drifting_particles>
    create(B& device, std::span<const cloud_particle> particles, std::span<const glm::vec4> middles,
           const drift_box& box) {
        if (particles.size() != middles.size() || particles.size() > 0xffffffffu) {
            return fail(error_code::bad_input, std::string("Of ")
                                                   .append(std::to_string(particles.size()))
                                                   .append(" particles ")
                                                   .append(std::to_string(middles.size()))
                                                   .append(" have a middle; expected all."));
        }
        if (!(std::abs(box.centre.x) <= 1e9f && std::abs(box.centre.y) <= 1e9f)) {
            return fail(error_code::bad_input, std::string("Clouds cannot drift around (")
                                                   .append(detail::number_text(box.centre.x))
                                                   .append(", ")
                                                   .append(detail::number_text(box.centre.y))
                                                   .append("); expected metres up to 1e9."));
        }
        if (!(box.side > 0 && box.side <= 1e7f && box.inner >= 0 && box.inner < box.outer &&
              box.outer <= 0.5f * box.side)) {
            return fail(error_code::bad_input,
                        std::string("Clouds cannot drift in a square of ")
                            .append(std::to_string(box.side))
                            .append(" m and fade from ")
                            .append(std::to_string(box.inner))
                            .append(" to ")
                            .append(std::to_string(box.outer))
                            .append(" m; expected growing distances, up to half a side."));
        }
        drifting_particles made(box, static_cast<std::uint32_t>(particles.size()));
        auto rest = make_buffer<B, cloud_particle>(device, particles);
        if (!rest) {
            return failure(rest.error());
        }
        auto centres = make_buffer<B, glm::vec4>(device, middles);
        if (!centres) {
            return failure(centres.error());
        }
        auto moved = device.create_buffer(particles.size_bytes());
        if (!moved) {
            return failure(moved.error());
        }
        made.rest_.emplace(std::move(*rest));
        made.middles_.emplace(std::move(*centres));
        made.moved_.emplace(std::move(*moved));
        return made;
    }

    /// Moves the first `count` particles to where they are when their clouds have drifted by
    /// `moved`, m along x and z: the wind's velocity times the time.
    void record(typename B::recorder& to, glm::dvec2 moved, std::uint32_t count) const {
        assert(count <= capacity_);
        if (count == 0) {
            return;
        }
        to.map(drift_by(box_, moved), {view<B>(*rest_), view<B>(*middles_), view<B>(*moved_)},
               range{0, count});
    }

    /// cloud_particle: where the latest `record` has moved them.
    [[nodiscard]] buffer_view<B> particles() const { return view<B>(*moved_); }
    /// cloud_particle: where they are when nothing has drifted.
    [[nodiscard]] buffer_view<B> rest() const { return view<B>(*rest_); }
    [[nodiscard]] std::uint32_t capacity() const noexcept { return capacity_; }
    [[nodiscard]] const drift_box& box() const noexcept { return box_; }

  private:
    drifting_particles(const drift_box& box, std::uint32_t capacity)
        : box_(box), capacity_(capacity) {}

    drift_box box_;
    std::uint32_t capacity_ = 0;
    std::optional<typename B::buffer> rest_; // all are there after create
    std::optional<typename B::buffer> middles_;
    std::optional<typename B::buffer> moved_;
};

} // namespace skybark::clouds
