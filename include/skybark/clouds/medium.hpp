#pragma once
// What light meets in a cloud, on the host in double: extinction and scattering (1/m) at a place,
// the exact optical depth along a ray, and upper bounds in a grid of cells to fly through.
//
//  - gaussian_medium: a cloud of particles. One particle's extinction is a Gaussian,
//        σ_t(x) = optical_depth / (σ √2π) · exp(−|x − c|² / 2σ²),  σ = radius / sigmas,
//    so that an endless straight line at distance d from its centre sees
//    optical_depth · exp(−d² / 2σ²), as the attenuation volume has it. A body has no tails cut off
//    along one line and not along another: it ends on a sphere, where |x − c| = cut · σ. At the
//    default of 4 σ, 1.1e-3 of the water lies outside, and 6e-5 of the depth through the centre.
//    (The volume ends a particle at `radius`, 3 σ, across the light only: 1.1 % of its water.)
//  - voxel_medium: extinctions at the centres of voxels, trilinear between them, and to nothing
//    half a voxel outside of the box, as a texture with a border of zero.
//
// Anything that models `medium` can be traced (clouds/path_tracer.hpp).

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace skybark::clouds {

/// 1/m: what is taken out of a beam, and what of that is scattered.
struct matter {
    double extinction = 0;
    double scattering = 0;
};

/// Upper bounds of the extinction: cell (i, j, k) reaches from low + (i, j, k) · side on.
struct majorant_cells {
    glm::dvec3 low{0};
    glm::dvec3 side{1};
    glm::ivec3 count{0};
    std::vector<double> majorant; ///< 1/m, x fastest, then y

    [[nodiscard]] std::size_t index(const glm::ivec3& cell) const {
        return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(count.y) +
                static_cast<std::size_t>(cell.y)) *
                   static_cast<std::size_t>(count.x) +
               static_cast<std::size_t>(cell.x);
    }
    [[nodiscard]] glm::dvec3 high() const { return low + side * glm::dvec3(count); }
};

namespace detail {

/// A flight takes a step for each unit of its cell's majorant: with more than this many through one
/// cell it would hardly come to an end.
inline constexpr double most_steps_through_a_cell = 1e6;

[[nodiscard]] inline result<void> check_steps(const majorant_cells& cells) {
    const double steps =
        glm::length(cells.side) * *std::max_element(cells.majorant.begin(), cells.majorant.end());
    if (!(steps <= most_steps_through_a_cell)) {
        return fail(error_code::bad_input,
                    std::string("A cloud can't be traced whose densest matter, all through a cell "
                                "of ") +
                        std::to_string(cells.side.x) + " x " + std::to_string(cells.side.y) +
                        " x " + std::to_string(cells.side.z) + " m, would have a depth of " +
                        std::to_string(steps) + "; at most 1e6 is wanted.");
    }
    return {};
}

} // namespace detail

template <class M>
concept medium = requires(const M& m, const glm::dvec3& p, std::size_t cell, double length) {
    { m.cells() } -> std::same_as<const majorant_cells&>;
    { m.at(p, cell) } -> std::same_as<matter>;                 // in cell `cell`; ≤ its majorant
    { m.optical_depth(p, p, length) } -> std::same_as<double>; // from p along a unit vector
};

/// The cells that a straight line passes, in order (Amanatides and Woo 1987): a place in cells of
/// side 1, moved by `step` for each unit of t, from t to `end`.
class cell_walk {
  public:
    cell_walk(const glm::dvec3& place, const glm::dvec3& step, double from, double to,
              const glm::ivec3& count)
        : place_(place), step_(step), count_(count), t_(from), end_(to) {
        for (int a = 0; a < 3; ++a) {
            const double high = count[a];
            if (step[a] == 0) {
                if (!(place[a] >= 0 && place[a] < high)) {
                    end_ = t_;
                }
                continue;
            }
            const double t0 = -place[a] / step[a];
            const double t1 = (high - place[a]) / step[a];
            t_ = std::max(t_, std::min(t0, t1));
            end_ = std::min(end_, std::max(t0, t1));
        }
        if (!(t_ < end_)) {
            t_ = end_;
            return;
        }
        for (int a = 0; a < 3; ++a) {
            cell_[a] = static_cast<int>(
                std::clamp(std::floor(place[a] + step[a] * t_), 0.0, double(count[a] - 1)));
            leave(a);
        }
    }

    [[nodiscard]] bool inside() const { return t_ < end_; }
    [[nodiscard]] const glm::ivec3& cell() const { return cell_; }
    [[nodiscard]] double enters() const { return t_; }
    [[nodiscard]] double leaves() const {
        return std::max(t_, std::min({next_.x, next_.y, next_.z, end_}));
    }

    void next() {
        const int a = next_.x < next_.y ? (next_.x < next_.z ? 0 : 2) : (next_.y < next_.z ? 1 : 2);
        t_ = std::max(t_, next_[a]);
        cell_[a] += step_[a] > 0 ? 1 : -1;
        if (cell_[a] < 0 || cell_[a] >= count_[a]) {
            t_ = end_;
            return;
        }
        leave(a);
    }

  private:
    void leave(int a) {
        next_[a] = step_[a] == 0
                       ? std::numeric_limits<double>::infinity()
                       : (double(cell_[a]) + (step_[a] > 0 ? 1.0 : 0.0) - place_[a]) / step_[a];
    }

    glm::dvec3 place_, step_, next_{0};
    glm::ivec3 count_, cell_{0};
    double t_, end_;
};

/// A cloud of Gaussian particles.
class gaussian_medium {
  public:
    /// `sigmas`: radius over standard deviation, > 0…100; `cut`: where the water ends, in standard
    /// deviations, 0.1…8. Errors: bad_input where a particle is no number, its radius is below 1e-6
    /// m or a depth is negative or over 1e4, an albedo is outside of 0…1, or there is no particle;
    /// where particles are as small and deep, beside far larger ones, that a path wouldn't end.
    [[nodiscard]] static result<gaussian_medium> create(std::span<const cloud_particle> particles,
                                                        double sigmas = 3, double cut = 4) {
        if (!(sigmas > 0 && sigmas <= 100 && cut >= 0.1 && cut <= 8)) {
            return fail(error_code::bad_input,
                        std::string("A particle of ") + std::to_string(sigmas) +
                            " standard deviations that ends at " + std::to_string(cut) +
                            " of them is none: above 0 to 100, and 0.1 to 8, are wanted.");
        }
        if (particles.empty()) {
            return fail(error_code::bad_input, "A cloud to trace needs a particle.");
        }
        gaussian_medium out;
        out.blobs_.reserve(particles.size());
        for (std::size_t i = 0; i < particles.size(); ++i) {
            const cloud_particle& p = particles[i];
            const auto within = [](float v) { return std::abs(v) <= 1e7f; };
            if (!(within(p.position.x) && within(p.position.y) && within(p.position.z) &&
                  p.radius >= 1e-6f && p.radius <= 1e7f && p.optical_depth >= 0 &&
                  p.optical_depth <= 1e4f && p.albedo >= 0 && p.albedo <= 1)) {
                return fail(error_code::bad_input,
                            std::string("Particle ") + std::to_string(i) +
                                " can't be traced: within 1e7 m, a radius of 1e-6 to 1e7 m, a "
                                "depth of 0 to 1e4 and an albedo of 0 to 1 are wanted.");
            }
            const double sigma = double{p.radius} / sigmas;
            out.blobs_.push_back({glm::dvec3(p.position), -0.5 / (sigma * sigma),
                                  double{p.optical_depth} / (sigma * 2.5066282746310002),
                                  double{p.albedo}, cut * cut * sigma * sigma, sigma});
        }
        out.bin(cut);
        if (auto done = detail::check_steps(out.cells_); !done) {
            return failure(done.error());
        }
        return out;
    }

    [[nodiscard]] const majorant_cells& cells() const { return cells_; }

    [[nodiscard]] matter at(const glm::dvec3& p, std::size_t cell) const {
        matter out;
        for (std::size_t k = first_[cell]; k < first_[cell + 1]; ++k) {
            const blob& b = blobs_[list_[k]];
            const glm::dvec3 d = p - b.centre;
            const double distance2 = glm::dot(d, d);
            if (distance2 < b.reach2) {
                const double extinction = b.peak * std::exp(b.exponent * distance2);
                out.extinction += extinction;
                out.scattering += b.albedo * extinction;
            }
        }
        return out;
    }

    /// Each particle's is A σ √(π/2) e^{−ρ²/2σ²} [erf((t1 − b)/√2σ) − erf((t0 − b)/√2σ)] with b
    /// where the ray is closest, at distance ρ, and t0, t1 where it is in the particle.
    [[nodiscard]] double optical_depth(const glm::dvec3& origin, const glm::dvec3& to,
                                       double length = 1e300) const {
        double sum = 0;
        for (const blob& p : blobs_) {
            const glm::dvec3 away = p.centre - origin;
            const double b = glm::dot(away, to);
            const glm::dvec3 aside = away - b * to;
            const double rho2 = glm::dot(aside, aside);
            if (rho2 >= p.reach2) {
                continue;
            }
            const double half = std::sqrt(p.reach2 - rho2);
            const double t0 = std::max(0.0, b - half);
            const double t1 = std::min(length, b + half);
            if (t0 < t1) {
                const double scale = 0.7071067811865476 / p.sigma;
                sum += p.peak * p.sigma * 1.2533141373155001 * std::exp(p.exponent * rho2) *
                       (std::erf((t1 - b) * scale) - std::erf((t0 - b) * scale));
            }
        }
        return sum;
    }

  private:
    struct blob {
        glm::dvec3 centre;
        double exponent; ///< −1 / 2σ²
        double peak;     ///< 1/m
        double albedo;
        double reach2; ///< (cut σ)²
        double sigma;
    };

    /// Cells about a standard deviation wide: smaller ones bound the Gaussians better, larger ones
    /// are fewer to pass.
    void bin(double cut) {
        glm::dvec3 low(1e300), high(-1e300);
        double mean_sigma = 0;
        for (const blob& b : blobs_) {
            low = glm::min(low, b.centre - cut * b.sigma);
            high = glm::max(high, b.centre + cut * b.sigma);
            mean_sigma += b.sigma / double(blobs_.size());
        }
        high = glm::max(high, low + 1e-6); // far away rounding may leave nothing of a particle
        cells_.low = low;
        for (int a = 0; a < 3; ++a) {
            cells_.count[a] =
                static_cast<int>(std::clamp(std::ceil((high[a] - low[a]) / mean_sigma), 1.0, 64.0));
        }
        cells_.side = (high - low) / glm::dvec3(cells_.count);
        const std::size_t cells = static_cast<std::size_t>(cells_.count.x) *
                                  static_cast<std::size_t>(cells_.count.y) *
                                  static_cast<std::size_t>(cells_.count.z);
        cells_.majorant.assign(cells, 0);
        first_.assign(cells + 1, 0);
        for (const blob& b : blobs_) {
            each_cell(b, [&](std::size_t cell, double distance2) {
                ++first_[cell + 1];
                // A billionth more, for the roundings of a sum in another order.
                cells_.majorant[cell] += (1 + 1e-9) * b.peak * std::exp(b.exponent * distance2);
            });
        }
        for (std::size_t c = 0; c < cells; ++c) {
            first_[c + 1] += first_[c];
        }
        list_.resize(first_[cells]);
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t i = 0; i < blobs_.size(); ++i) {
            each_cell(blobs_[i], [&](std::size_t cell, double) {
                list_[next[cell]++] = static_cast<std::uint32_t>(i);
            });
        }
    }

    /// visit(cell, squared distance to its nearest point) for the cells that a particle reaches.
    template <class F>
    void each_cell(const blob& b, F&& visit) const {
        const double reach = std::sqrt(b.reach2);
        glm::ivec3 from, to;
        for (int a = 0; a < 3; ++a) {
            const double in = (b.centre[a] - cells_.low[a]) / cells_.side[a];
            const double wide = reach / cells_.side[a];
            const double last = double(cells_.count[a] - 1);
            // A hair wider: a point on a face may be looked up in either cell.
            from[a] = static_cast<int>(std::clamp(std::floor(in - wide - 1e-9), 0.0, last));
            to[a] = static_cast<int>(std::clamp(std::floor(in + wide + 1e-9), 0.0, last));
        }
        for (int z = from.z; z <= to.z; ++z) {
            for (int y = from.y; y <= to.y; ++y) {
                for (int x = from.x; x <= to.x; ++x) {
                    const glm::dvec3 corner = cells_.low + cells_.side * glm::dvec3(x, y, z);
                    const glm::dvec3 nearest =
                        glm::clamp(b.centre, corner, corner + cells_.side) - b.centre;
                    const double distance2 = glm::dot(nearest, nearest);
                    if (distance2 < b.reach2 * (1 + 1e-9)) {
                        visit(cells_.index({x, y, z}), distance2);
                    }
                }
            }
        }
    }

    std::vector<blob> blobs_;
    majorant_cells cells_;
    std::vector<std::size_t> first_; ///< of a cell's particles in list_
    std::vector<std::uint32_t> list_;
};

/// A cloud as a grid of extinctions.
class voxel_medium {
  public:
    /// `extinction`: 1/m, x fastest, then y; `low`: the corner of the box; `side`: of a voxel, m.
    /// Errors: bad_input where the sizes disagree, a value is negative or no number, a side is
    /// below 1e-6 m or the albedo is outside of 0…1, or a voxel's depth is above 1e6 / √3.
    [[nodiscard]] static result<voxel_medium> create(std::span<const float> extinction,
                                                     const glm::uvec3& voxels,
                                                     const glm::dvec3& low, const glm::dvec3& side,
                                                     double albedo) {
        constexpr std::uint64_t most = 4096;
        if (!(voxels.x > 0 && voxels.y > 0 && voxels.z > 0 && voxels.x <= most &&
              voxels.y <= most && voxels.z <= most) ||
            std::uint64_t{voxels.x} * voxels.y * voxels.z != extinction.size()) {
            return fail(error_code::bad_input,
                        std::string("A grid of ") + std::to_string(voxels.x) + " x " +
                            std::to_string(voxels.y) + " x " + std::to_string(voxels.z) +
                            " voxels with " + std::to_string(extinction.size()) +
                            " values can't be traced.");
        }
        constexpr double finest = 1e-6;
        if (!(side.x >= finest && side.y >= finest && side.z >= finest && side.x < 1e7 &&
              side.y < 1e7 && side.z < 1e7 && glm::dot(low, low) < 1e14 && albedo >= 0 &&
              albedo <= 1)) {
            return fail(error_code::bad_input,
                        "A grid to trace needs voxels with sides from 1e-6 to 1e7 m, a corner "
                        "within 1e7 m and an albedo of 0 to 1.");
        }
        for (std::size_t i = 0; i < extinction.size(); ++i) {
            if (!(extinction[i] >= 0 && extinction[i] < 1e10f)) {
                return fail(error_code::bad_input, std::string("Voxel ") + std::to_string(i) +
                                                       " has an extinction that can't be traced.");
            }
        }
        voxel_medium out;
        out.voxels_ = voxels;
        out.albedo_ = albedo;
        out.extinction_.assign(extinction.begin(), extinction.end());
        out.bound(low, side);
        if (auto done = detail::check_steps(out.cells_); !done) {
            return failure(done.error());
        }
        return out;
    }

    /// Cell (i, j, k) lies between the centres of the voxels i − 1 and i, and so on.
    [[nodiscard]] const majorant_cells& cells() const { return cells_; }

    [[nodiscard]] matter at(const glm::dvec3& p, std::size_t) const {
        const double extinction = value((p - cells_.low) / cells_.side);
        return {extinction, albedo_ * extinction};
    }

    /// Between two cell faces the extinction along a line is a cubic, and Simpson's rule is exact.
    [[nodiscard]] double optical_depth(const glm::dvec3& origin, const glm::dvec3& to,
                                       double length = 1e300) const {
        const glm::dvec3 place = (origin - cells_.low) / cells_.side;
        const glm::dvec3 step = to / cells_.side;
        double sum = 0;
        for (cell_walk walk(place, step, 0, length, cells_.count); walk.inside(); walk.next()) {
            const double a = walk.enters();
            const double b = walk.leaves();
            if (cells_.majorant[cells_.index(walk.cell())] > 0) {
                sum += (b - a) / 6 *
                       (in_cell(walk.cell(), place + a * step) +
                        4 * in_cell(walk.cell(), place + (a + b) / 2 * step) +
                        in_cell(walk.cell(), place + b * step));
            }
        }
        return sum;
    }

  private:
    void bound(const glm::dvec3& low, const glm::dvec3& side) {
        cells_.low = low - side / 2.0;
        cells_.side = side;
        cells_.count = glm::ivec3(voxels_) + 1;
        cells_.majorant.assign(static_cast<std::size_t>(cells_.count.x) *
                                   static_cast<std::size_t>(cells_.count.y) *
                                   static_cast<std::size_t>(cells_.count.z),
                               0);
        for (int z = 0; z < cells_.count.z; ++z) {
            for (int y = 0; y < cells_.count.y; ++y) {
                for (int x = 0; x < cells_.count.x; ++x) {
                    double most = 0;
                    for (int corner = 0; corner < 8; ++corner) {
                        most =
                            std::max(most, voxel({x - 1 + (corner & 1), y - 1 + (corner >> 1 & 1),
                                                  z - 1 + (corner >> 2)}));
                    }
                    cells_.majorant[cells_.index({x, y, z})] = most * (1 + 1e-9);
                }
            }
        }
    }

    [[nodiscard]] double voxel(const glm::ivec3& v) const {
        if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= static_cast<int>(voxels_.x) ||
            v.y >= static_cast<int>(voxels_.y) || v.z >= static_cast<int>(voxels_.z)) {
            return 0;
        }
        return double{extinction_[(static_cast<std::size_t>(v.z) * voxels_.y +
                                   static_cast<std::size_t>(v.y)) *
                                      voxels_.x +
                                  static_cast<std::size_t>(v.x)]};
    }

    [[nodiscard]] double value(const glm::dvec3& in_cells) const {
        return in_cell(glm::ivec3(glm::floor(in_cells)), in_cells);
    }

    [[nodiscard]] double in_cell(const glm::ivec3& cell, const glm::dvec3& in_cells) const {
        const glm::dvec3 s = in_cells - glm::dvec3(cell);
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 up(corner & 1, corner >> 1 & 1, corner >> 2);
            sum += (up.x != 0 ? s.x : 1 - s.x) * (up.y != 0 ? s.y : 1 - s.y) *
                   (up.z != 0 ? s.z : 1 - s.z) * voxel(cell - 1 + up);
        }
        return sum;
    }

    glm::uvec3 voxels_{0};
    double albedo_ = 1;
    std::vector<float> extinction_;
    majorant_cells cells_;
};

static_assert(medium<gaussian_medium> && medium<voxel_medium>);

} // namespace skybark::clouds
