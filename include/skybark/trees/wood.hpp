#pragma once
// Wood: what branches are made of, and what of a skeleton the sway needs to know of it.
//
// Each segment becomes a rigid truncated cone, and each base of a segment a joint that bends as the
// two half segments at it would: 1/k = integral of dx / (E I) over both, I = pi r^4 / 4, r linear
// along the segment. For a uniform beam that is 1/k = h1 / (2 E I1) + h2 / (2 E I2), at a root
// k = 2 E I / h. Angles of a chain of such joints are those of the beam at the middles of the
// segments, so that everything converges with the square of the segments' length.
//
// The rest pose is the pose under the tree's own weight: gravity bent the wood while it grew, and
// is in no force here.
//
// Ranges of values: Niklas and Spatz, "Worldwide correlations of mechanical properties and green
// wood density" (American Journal of Botany 97, 2010); Moore and Maguire, "Natural sway frequencies
// and damping ratios of trees" (Trees 18, 2004).

#include <skybark/core/when_used.hpp>
#include <skybark/kernels/sway_records.hpp>
#include <skybark/trees/skeleton.hpp>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace skybark::trees {

/// Green wood, and how fast what it is made into stops swaying.
struct wood {
    double elasticity = 9.5e9;   ///< Pa, Young's modulus along the grain; 8e9 … 11e9
    double density = 800;        ///< kg/m³, with its water; 600 … 1000
    double damping_ratio = 0.03; ///< of each tree's first mode: 0.01 … 0.08, more in leaf; 0: none
};

/// Segments are held to be at least this thick and long where stiffness and mass are concerned
/// (descriptions have twigs without radius and joints without length). Places are as described.
inline constexpr double least_wood_radius = 0.0005; // m
inline constexpr double least_wood_length = 0.001;  // m

/// The joints of a skeleton, in its order, and the first natural frequency of each tree.
struct sway_layout {
    struct tree {
        std::uint32_t root = 0;
        double frequency = 0; ///< rad/s, of the first mode about the rest pose, undamped
    };
    std::vector<shared::sway_joint> joints;
    std::vector<tree> trees;
};

namespace detail {

/// The integral of dx / r⁴ over a length h in which r goes from a to b.
[[nodiscard]] inline double taper_compliance(double h, double a, double b) {
    return h * (a * a + a * b + b * b) / (3 * a * a * a * b * b * b);
}

/// Builds the layout, all in double precision.
template <class = when_used>
class sway_layout_builder {
  public:
    sway_layout_builder(const skeleton& from, const wood& material, std::span<const float> leaves)
        : from_(from), material_(material), leaves_(leaves) {}

    [[nodiscard]] sway_layout build() {
        layout_.joints.resize(from_.size());
        axis_.resize(from_.size());
        offset_.resize(from_.size());
        for (std::uint32_t i = 0; i < from_.size(); ++i) {
            place(i);
            weigh(i);
            layout_.joints[i].stiffness = static_cast<float>(stiffness(i));
        }
        keep_ratios();
        find_frequencies();
        for (shared::sway_joint& joint : layout_.joints) {
            const double first = layout_.trees[tree_of_[joint.root]].frequency;
            joint.relaxation = static_cast<float>(2 * material_.damping_ratio / first);
        }
        return std::move(layout_);
    }

  private:
    [[nodiscard]] double length(std::uint32_t i) const {
        return std::max(double{from_.length[i]}, least_wood_length);
    }
    [[nodiscard]] double base_radius(std::uint32_t i) const {
        return std::max(double{from_.base_radius[i]}, least_wood_radius);
    }
    [[nodiscard]] double tip_radius(std::uint32_t i) const {
        return std::max(double{from_.radius[i]}, least_wood_radius);
    }
    [[nodiscard]] double middle_radius(std::uint32_t i) const {
        return (base_radius(i) + tip_radius(i)) / 2;
    }

    void place(std::uint32_t i) {
        shared::sway_joint& joint = layout_.joints[i];
        const std::uint32_t p = from_.parent[i];
        axis_[i] = glm::normalize(glm::dquat(from_.orientation[i]) * glm::dvec3(0, 1, 0));
        offset_[i] = p == none ? glm::dvec3(0)
                               : glm::dvec3(from_.position[i]) - glm::dvec3(from_.position[p]);
        joint.axis = axis_[i];
        joint.extent = from_.length[i];
        joint.offset = offset_[i];
        joint.base = from_.position[i];
        joint.parent = p == none ? static_cast<std::uint32_t>(from_.size()) : p;
        joint.first_child = from_.child_count[i] == 0 ? 0 : from_.first_child[i];
        joint.child_count = from_.child_count[i];
        joint.root = p == none ? i : layout_.joints[p].root;
    }

    /// A truncated cone of wood, and leaves spread evenly along it. Moments of x^n r^2 and r^4 over
    /// the length, r = a + (b - a) x / h.
    void weigh(std::uint32_t i) {
        constexpr double pi = 3.14159265358979323846;
        const double h = length(i), a = base_radius(i), b = tip_radius(i);
        const double unit = material_.density * pi * h;
        const double leaf = leaves_.empty() ? 0 : double{leaves_[i]};
        const double bulk = (a * a + a * b + b * b) / 3;
        const double first = (a * a + 2 * a * b + 3 * b * b) / 12;
        const double second = (a * a + 3 * a * b + 6 * b * b) / 30;
        const double fourth =
            (a * a * a * a + a * a * a * b + a * a * b * b + a * b * b * b + b * b * b * b) / 5;
        shared::sway_joint& joint = layout_.joints[i];
        joint.mass = static_cast<float>(unit * bulk + leaf);
        joint.lever = static_cast<float>(h * (unit * first + leaf / 2));
        joint.across = static_cast<float>(h * h * (unit * second + leaf / 3) + unit * fourth / 4);
        joint.along = static_cast<float>(unit * fourth / 2 + leaf * b * b / 2);
    }

    [[nodiscard]] double stiffness(std::uint32_t i) const {
        constexpr double pi = 3.14159265358979323846;
        double compliance = taper_compliance(length(i) / 2, base_radius(i), middle_radius(i));
        if (const std::uint32_t p = from_.parent[i]; p != none) {
            compliance += taper_compliance(length(p) / 2, middle_radius(p), tip_radius(p));
        }
        return material_.elasticity * pi / 4 / compliance;
    }

    /// Lets no segment weigh less than 5e-5 of what it carries, nor resist turns less: thin links
    /// below heavy wood, or the twist of a long thin pole, would be lost in the rounding of single
    /// precision. Beams in less than some hundred segments and real trees are not touched.
    void keep_ratios() {
        constexpr double least = 5e-5;
        const std::size_t n = from_.size();
        // Of all that the joint carries, about its base, stretched out as far as it goes.
        std::vector<double> mass(n), lever(n), square(n);
        for (std::size_t i = n; i-- > 0;) {
            shared::sway_joint& joint = layout_.joints[i];
            mass[i] += joint.mass;
            lever[i] += joint.lever;
            square[i] += joint.across;
            joint.mass = std::max(joint.mass, static_cast<float>(least * mass[i]));
            joint.across = std::max(joint.across, static_cast<float>(least * square[i]));
            joint.along = std::max(joint.along, static_cast<float>(least * square[i]));
            if (const std::uint32_t p = from_.parent[i]; p != none) {
                const double r = glm::length(offset_[i]);
                mass[p] += mass[i];
                square[p] += square[i] + 2 * r * lever[i] + mass[i] * r * r;
                lever[p] += lever[i] + mass[i] * r;
            }
        }
    }

    struct motion {
        glm::dvec3 turn{0}, speed{0};
    };

    /// Inverse iteration x ← K⁻¹ M x: two passes over the joints each, from the static bend under a
    /// force along `dvec3(0.8, 0, 0.6)` that is proportional to the mass.
    void find_frequencies() {
        const std::size_t n = from_.size();
        tree_of_.resize(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            if (from_.parent[i] == none) {
                tree_of_[i] = static_cast<std::uint32_t>(layout_.trees.size());
                layout_.trees.push_back({i, 0});
            }
        }
        std::vector<glm::dvec3> rate(n), spin(n);
        std::vector<motion> moves(n, motion{glm::dvec3(0), glm::dvec3(0.8, 0, 0.6)});
        momenta(moves, spin);
        constexpr int most = 24;
        for (int round = 0; round < most; ++round) {
            next_rates(spin, rate);
            velocities(rate, moves);
            momenta(moves, spin);
            if (update_frequencies(rate, spin) < 1e-6) {
                break;
            }
        }
    }

    void next_rates(const std::vector<glm::dvec3>& spin, std::vector<glm::dvec3>& rate) const {
        std::vector<double> norm(layout_.trees.size(), 0.0);
        for (std::size_t i = 0; i < rate.size(); ++i) {
            rate[i] = spin[i] / double{layout_.joints[i].stiffness};
            double& most = norm[tree_of_[layout_.joints[i].root]];
            most = std::max(most, glm::length(rate[i]));
        }
        for (std::size_t i = 0; i < rate.size(); ++i) {
            rate[i] /= norm[tree_of_[layout_.joints[i].root]];
        }
    }

    void velocities(const std::vector<glm::dvec3>& rate, std::vector<motion>& moves) const {
        for (std::size_t i = 0; i < rate.size(); ++i) {
            const std::uint32_t p = from_.parent[i];
            const motion before = p == none ? motion{} : moves[p];
            moves[i] = {before.turn + rate[i], before.speed + glm::cross(before.turn, offset_[i])};
        }
    }

    /// Angular momentum about each joint of all that it carries.
    void momenta(const std::vector<motion>& moves, std::vector<glm::dvec3>& spin) const {
        std::vector<glm::dvec3> straight(spin.size(), glm::dvec3(0));
        std::fill(spin.begin(), spin.end(), glm::dvec3(0));
        for (std::size_t i = spin.size(); i-- > 0;) {
            const shared::sway_joint& joint = layout_.joints[i];
            const motion& m = moves[i];
            const glm::dvec3 lever = axis_[i] * double{joint.lever};
            straight[i] += double{joint.mass} * m.speed + glm::cross(m.turn, lever);
            spin[i] += double{joint.across} * m.turn + glm::cross(lever, m.speed) +
                       axis_[i] * ((double{joint.along} - double{joint.across}) *
                                   glm::dot(axis_[i], m.turn));
            if (const std::uint32_t p = from_.parent[i]; p != none) {
                straight[p] += straight[i];
                spin[p] += spin[i] + glm::cross(offset_[i], straight[i]);
            }
        }
    }

    /// Rayleigh's quotient of each tree. Returns the largest relative change.
    double update_frequencies(const std::vector<glm::dvec3>& rate,
                              const std::vector<glm::dvec3>& spin) {
        std::vector<glm::dvec2> sums(layout_.trees.size(), glm::dvec2(0));
        for (std::size_t i = 0; i < rate.size(); ++i) {
            const shared::sway_joint& joint = layout_.joints[i];
            sums[tree_of_[joint.root]] += glm::dvec2(
                double{joint.stiffness} * glm::dot(rate[i], rate[i]), glm::dot(rate[i], spin[i]));
        }
        double change = 0;
        for (std::size_t t = 0; t < sums.size(); ++t) {
            const double now = std::sqrt(sums[t].x / sums[t].y);
            change = std::max(change, std::abs(now - layout_.trees[t].frequency) / now);
            layout_.trees[t].frequency = now;
        }
        return change;
    }

    const skeleton& from_;
    const wood& material_;
    std::span<const float> leaves_;
    sway_layout layout_;
    std::vector<glm::dvec3> axis_;       ///< unit, of each segment at rest
    std::vector<glm::dvec3> offset_;     ///< m, from the parent's base
    std::vector<std::uint32_t> tree_of_; ///< of each root
};

} // namespace detail

/// The joints that `sway` works on. `leaf_mass`: kg that each segment carries beyond its wood,
/// spread along it; empty, or one entry a segment. Linear time.
template <class = when_used>
[[nodiscard]] sway_layout layout_sway(const skeleton& from, const wood& material = {},
                                      std::span<const float> leaf_mass = {}) {
    return detail::sway_layout_builder<>(from, material, leaf_mass).build();
}

} // namespace skybark::trees
