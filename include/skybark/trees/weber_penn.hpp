#pragma once
// grow: trees from parameters.
//
// Source: Jason Weber and Joseph Penn, "Creation and Rendering of Realistic Trees", SIGGRAPH 1995,
// section 4 and the appendix. The parameters keep the paper's names (nDownAngleV is
// `level[n].down_angle_v`) and, unlike the rest of this library, its degrees, so that published
// tables can be typed in as they stand. The paper's z is our +Y.
//
// Where the paper leaves something open:
// - every tree gets a random heading, or all trunks would lean in one plane;
// - a stem's children are shared out among its clones by turns, so that `branches` is the number
//   of children however often the stem splits;
// - a helix (negative curve_v) makes one turn over the stem's length;
// - the lower half of the pruning envelope is divided by prune_width_peak, which makes it meet the
//   upper half (as printed it doesn't, unless the peak is at 0.5);
// - lobes shape a cross-section, which a segment hasn't got: the numbers are kept for meshers, and
//   their mean over the angle is the radius here.

#include <skybark/core/when_used.hpp>
#include <skybark/trees/skeleton.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

namespace skybark::trees {

/// The paper's parameters with a leading n: one set for each level of branching. Angles in degrees.
struct weber_penn_level {
    float down_angle = 0;   ///< degrees from the parent's axis
    float down_angle_v = 0; ///< negative: varies along the parent instead of at random
    float rotate = 0;       ///< degrees around the parent since the last child; negative: by sides
    float rotate_v = 0;
    int branches = 0; ///< children of one parent at most; unused at level 0
    float length = 1; ///< of the parent's length; at level 0 of the tree's scale
    float length_v = 0;
    float taper = 1;      ///< 0…1 cone, …2 rounded end, …3 a string of balls
    float seg_splits = 0; ///< clones a segment, on average
    float split_angle = 0;
    float split_angle_v = 0;
    int curve_res = 1;    ///< segments a stem
    float curve = 0;      ///< degrees over the whole stem, or over its lower half
    float curve_back = 0; ///< degrees over the upper half, where not 0
    float curve_v = 0;    ///< negative: a helix of this declination
};

/// The paper's parameters for a whole tree. Lengths in metres.
struct weber_penn_parameters {
    int shape = 0; ///< ShapeRatio of level 1: 0 conical … 7 tend flame, 8 the pruning envelope
    float base_size = 0.1f; ///< bare part of the trunk, of the tree's scale
    float scale = 10;       ///< m
    float scale_v = 0;
    float z_scale = 1; ///< stretches the finished tree upwards
    float z_scale_v = 0;
    int levels = 1;      ///< 1: only a trunk. From the fifth on, levels are like the fourth
    float ratio = 0.02f; ///< trunk radius / trunk length
    float ratio_power = 1;
    int lobes = 0;
    float lobe_depth = 0;
    float flare = 0;
    int leaves = 0; ///< leaves of one stem of the last level; placed elsewhere
    int leaf_shape = 0;
    float leaf_scale = 0.1f;       ///< m, leaf length
    float leaf_scale_x = 1;        ///< leaf width / leaf length
    float attraction_up = 0;       ///< from level 2 on; negative: weeping
    float prune_ratio = 0;         ///< 0 none … 1 full
    float prune_width = 0.5f;      ///< of the scale
    float prune_width_peak = 0.5f; ///< height of the widest place, of the crown
    float prune_power_low = 0.5f;
    float prune_power_high = 0.5f;
    int base_splits = 0;     ///< clones at the end of the trunk's first segment
    float trunk_scale = 1;   ///< 0Scale: factor of the trunk's radius
    float trunk_scale_v = 0; ///< 0ScaleV
    std::array<weber_penn_level, 4> level{};
};

/// What `grow` makes at most unless it is told otherwise.
inline constexpr std::size_t default_most_segments = 50'000'000;

namespace detail::weber_penn {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double degrees = pi / 180;
inline constexpr int most_levels = 9;

/// PCG32 (O'Neill 2014, XSH-RR): the standard's engines are portable, its distributions are not.
class pcg32 {
  public:
    explicit pcg32(std::uint64_t seed) {
        next();
        state_ += seed;
        next();
    }
    std::uint32_t next() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005u + 1442695040888963407u;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
        const auto turn = static_cast<std::uint32_t>(old >> 59u);
        return (shifted >> turn) | (shifted << ((32u - turn) & 31u));
    }
    /// Uniform in [0, 1).
    double uniform() { return next() * (1.0 / 4294967296.0); }
    /// Uniform in [-v, v): the paper's "± v".
    double vary(double v) { return v * (2 * uniform() - 1); }

  private:
    std::uint64_t state_ = 0;
};

/// The paper's ShapeRatio(shape, ratio): how long a branch is, `ratio` from 0 at the top to 1 at
/// the bottom of the crown. Section 4.3; shape 8 is section 4.6's envelope.
[[nodiscard]] inline double shape_ratio(const weber_penn_parameters& p, int shape, double ratio) {
    switch (shape) {
    case 0: // conical
        return 0.2 + 0.8 * ratio;
    case 1: // spherical
        return 0.2 + 0.8 * std::sin(pi * ratio);
    case 2: // hemispherical
        return 0.2 + 0.8 * std::sin(0.5 * pi * ratio);
    case 3: // cylindrical
        return 1;
    case 4: // tapered cylindrical
        return 0.5 + 0.5 * ratio;
    case 5: // flame
        return ratio <= 0.7 ? ratio / 0.7 : (1 - ratio) / 0.3;
    case 6: // inverse conical
        return 1 - 0.8 * ratio;
    case 7: // tend flame
        return ratio <= 0.7 ? 0.5 + 0.5 * ratio / 0.7 : 0.5 + 0.5 * (1 - ratio) / 0.3;
    default:
        break;
    }
    if (ratio < 0 || ratio > 1)
        return 0;
    const double peak = p.prune_width_peak;
    if (ratio < 1 - peak)
        return std::pow(ratio / (1 - peak), static_cast<double>(p.prune_power_high));
    return peak > 0 ? std::pow((1 - ratio) / peak, static_cast<double>(p.prune_power_low)) : 1;
}

/// Radius at `z` (0 base … 1 tip) of a stem. Section 4.7.
[[nodiscard]] inline double stem_radius(double taper, double radius, double length, double z) {
    const double unit_taper = taper <= 1 ? taper : std::max(0.0, 2 - taper);
    const double taper_z = radius * (1 - unit_taper * z);
    if (taper <= 1 || taper_z <= 0)
        return std::max(taper_z, 0.0);
    const double from_tip = (1 - z) * length;
    const double depth = taper < 2 || from_tip < taper_z ? 1 : taper - 2;
    const double z3 =
        taper < 2 ? from_tip
                  : std::abs(from_tip - 2 * taper_z * std::floor(from_tip / (2 * taper_z) + 0.5));
    if (taper < 2 && z3 >= taper_z)
        return taper_z;
    const double off = z3 - taper_z;
    return (1 - depth) * taper_z + depth * std::sqrt(std::max(0.0, taper_z * taper_z - off * off));
}

/// Factor of the trunk's radius at `z`. Section 4.7.
[[nodiscard]] inline double flare_factor(double flare, double z) {
    const double y = std::max(0.0, 1 - 8 * z);
    return 1 + flare * (std::pow(100.0, y) - 1) / 100;
}

/// Declares a limit of a parameter in one line.
template <class T>
struct parameter_limit {
    const char* name;
    T value;
    T low;
    T high;
};

template <class = when_used>
[[nodiscard]] std::string value_text(double value) {
    char buffer[32];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

/// A sentence if `limit` is violated (NaN violates every limit), else an empty string.
template <class T>
[[nodiscard]] std::string limit_complaint(const parameter_limit<T>& limit, int level) {
    if (limit.value >= limit.low && limit.value <= limit.high)
        return {};
    const std::string where = level < 0 ? "" : " of level " + std::to_string(level);
    const auto text = [](T v) { return value_text(static_cast<double>(v)); };
    return "The tree parameter " + std::string(limit.name) + where + " is " + text(limit.value) +
           "; expected a number from " + text(limit.low) + " to " + text(limit.high) + ".";
}

template <class = when_used>
[[nodiscard]] std::string complaint_of_level(const weber_penn_level& l, int n) {
    const std::array<parameter_limit<float>, 13> reals{{
        {"down_angle", l.down_angle, -360, 360},
        {"down_angle_v", l.down_angle_v, -360, 360},
        {"rotate", l.rotate, -360, 360},
        {"rotate_v", l.rotate_v, -360, 360},
        {"length", l.length, 0, 1000},
        {"length_v", l.length_v, 0, 1000},
        {"taper", l.taper, 0, 3},
        {"seg_splits", l.seg_splits, 0, 100},
        {"split_angle", l.split_angle, -360, 360},
        {"split_angle_v", l.split_angle_v, -360, 360},
        {"curve", l.curve, -36000, 36000},
        {"curve_back", l.curve_back, -36000, 36000},
        {"curve_v", l.curve_v, -36000, 36000},
    }};
    for (const auto& limit : reals)
        if (std::string complaint = limit_complaint(limit, n); !complaint.empty())
            return complaint;
    const std::array<parameter_limit<int>, 2> counts{{
        {"branches", l.branches, 0, 10'000'000},
        {"curve_res", l.curve_res, 1, 10'000'000},
    }};
    for (const auto& limit : counts)
        if (std::string complaint = limit_complaint(limit, n); !complaint.empty())
            return complaint;
    return {};
}

/// What is wrong with the parameters, or an empty string.
template <class = when_used>
[[nodiscard]] std::string complaint_of(const weber_penn_parameters& p) {
    const std::array<parameter_limit<int>, 6> counts{{
        {"shape", p.shape, 0, 8},
        {"levels", p.levels, 1, most_levels},
        {"lobes", p.lobes, 0, 10'000},
        {"leaves", p.leaves, -1'000'000, 1'000'000}, // negative: a fan, in the paper
        {"leaf_shape", p.leaf_shape, 0, 100},
        {"base_splits", p.base_splits, 0, 10'000},
    }};
    for (const auto& limit : counts)
        if (std::string complaint = limit_complaint(limit, -1); !complaint.empty())
            return complaint;
    const std::array<parameter_limit<float>, 19> reals{{
        {"base_size", p.base_size, 0, 0.999f},
        {"scale", p.scale, 1e-6f, 1e6f},
        {"scale_v", p.scale_v, 0, 1e6f},
        {"z_scale", p.z_scale, 1e-6f, 1e6f},
        {"z_scale_v", p.z_scale_v, 0, 1e6f},
        {"ratio", p.ratio, 0, 100},
        {"ratio_power", p.ratio_power, -100, 100},
        {"lobe_depth", p.lobe_depth, 0, 1},
        {"flare", p.flare, -1, 100},
        {"leaf_scale", p.leaf_scale, 0, 1e6f},
        {"leaf_scale_x", p.leaf_scale_x, 0, 1e6f},
        {"attraction_up", p.attraction_up, -1000, 1000},
        {"prune_ratio", p.prune_ratio, 0, 1},
        {"prune_width", p.prune_width, 0, 1000},
        {"prune_width_peak", p.prune_width_peak, 0, 1},
        {"prune_power_low", p.prune_power_low, 0, 1000},
        {"prune_power_high", p.prune_power_high, 0, 1000},
        {"trunk_scale", p.trunk_scale, 0, 1e6f},
        {"trunk_scale_v", p.trunk_scale_v, 0, 1e6f},
    }};
    for (const auto& limit : reals)
        if (std::string complaint = limit_complaint(limit, -1); !complaint.empty())
            return complaint;
    for (std::size_t n = 0; n < p.level.size(); ++n)
        if (std::string complaint = complaint_of_level(p.level[n], static_cast<int>(n));
            !complaint.empty())
            return complaint;
    return {};
}

[[nodiscard]] inline const weber_penn_level& level_of(const weber_penn_parameters& p, int n) {
    return p.level[static_cast<std::size_t>(std::min(n, 3))];
}

/// An estimate from above of how many segments the parameters make: every stem with all its
/// children and an average of clones.
[[nodiscard]] inline double segment_estimate(const weber_penn_parameters& p, double most) {
    double stems = 1;
    double segments = 0;
    for (int n = 0; n < p.levels; ++n) {
        const weber_penn_level& l = level_of(p, n);
        if (n > 0)
            stems *= l.branches;
        const double growth = 1 + static_cast<double>(l.seg_splits);
        double clones = n == 0 ? 1 + p.base_splits : 1;
        double one_stem = 1;
        for (int i = 1; i < l.curve_res && one_stem <= most; ++i) {
            one_stem += clones;
            clones *= growth;
        }
        segments += stems * one_stem;
    }
    return segments;
}

/// One stem to grow: where it starts and what it has from its parent.
struct stem {
    glm::dvec3 base{0};           ///< m, z up
    glm::dquat frame{1, 0, 0, 0}; ///< its z runs along the stem
    double length = 0;            ///< m
    double radius = 0;            ///< m, at the base
    double parent_length = 0;     ///< m
    double offset = 0;            ///< m, along the parent
    double length_max = 0;        ///< this stem's nLength ± nLengthV
    std::uint64_t seed = 0;       ///< of everything random in it
    std::uint32_t parent = none;  ///< the segment that bears it
    int level = 0;
};

/// A run of segments of one stem between splits. A clone starts as a copy of its original.
struct run {
    glm::dvec3 at{0};
    glm::dquat frame{1, 0, 0, 0};  ///< of the stem's axis
    double bend_back = 0;          ///< radians a segment, undoing the splits so far
    double turned = 0;             ///< radians about the axis of the last child
    double side = 1;               ///< where children alternate
    std::uint64_t clone_count = 1; ///< children k with k mod count = index belong to this run
    std::uint64_t clone_index = 0;
    std::uint32_t parent = none;
    int segment = 0; ///< the next one to grow
};

/// A straight piece of a stem as it is grown.
struct piece {
    glm::dvec3 from{0};
    glm::dvec3 to{0};
    glm::dquat frame{1, 0, 0, 0}; ///< its z runs along the piece
    int segment = 0;
};

template <class = when_used>
class grower {
  public:
    grower(const weber_penn_parameters& parameters, std::uint32_t seed, std::size_t most)
        : p_(parameters), most_(most), random_(seed) {
        // a published table has scale 10 ± 10: keep the tree from vanishing
        scale_ = std::max(p_.scale + random_.vary(p_.scale_v), 0.1 * p_.scale);
        z_scale_ = std::max(p_.z_scale + random_.vary(p_.z_scale_v), 0.1 * p_.z_scale);
    }

    [[nodiscard]] result<std::vector<segment>> grow() {
        pending_.push_back(trunk());
        // a stack: the order is deterministic, and memory stays with the depth of the tree
        while (!pending_.empty()) {
            const stem s = pending_.back();
            pending_.pop_back();
            grow_stem(s);
            if (segments_.size() > most_)
                return fail(error_code::bad_input,
                            "These tree parameters make more than " + std::to_string(most_) +
                                " segments; expected fewer branches, segments or splits.");
        }
        if (segments_.empty())
            return fail(error_code::bad_input, "These tree parameters leave the trunk no length (" +
                                                   value_text(p_.level[0].length) + " ± " +
                                                   value_text(p_.level[0].length_v) +
                                                   " of the scale); expected a trunk.");
        if (too_far_)
            return fail(error_code::bad_input, "These tree parameters make a tree of more than "
                                               "1e9 metres; expected smaller lengths.");
        return std::move(segments_);
    }

  private:
    [[nodiscard]] stem trunk() {
        const weber_penn_level& l = p_.level[0];
        stem s;
        s.length_max = std::max(0.0, l.length + random_.vary(l.length_v));
        s.length = s.length_max * scale_;
        const double thickness = std::max(0.0, p_.trunk_scale + random_.vary(p_.trunk_scale_v));
        s.radius = s.length * p_.ratio * thickness;
        s.frame = about_z(random_.uniform() * 2 * pi);
        s.seed = next_seed(random_);
        return s;
    }

    [[nodiscard]] static std::uint64_t next_seed(pcg32& random) {
        const std::uint64_t high = random.next();
        return high << 32u | random.next();
    }
    [[nodiscard]] static glm::dquat about_x(double angle) {
        return {std::cos(angle / 2), std::sin(angle / 2), 0, 0};
    }
    [[nodiscard]] static glm::dquat about_z(double angle) {
        return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    }
    [[nodiscard]] static glm::dvec3 axis_of(const glm::dquat& frame) {
        return frame * glm::dvec3(0, 0, 1);
    }
    /// The angle from straight up, in radians.
    [[nodiscard]] static double declination(const glm::dquat& frame) {
        return std::acos(std::clamp(axis_of(frame).z, -1.0, 1.0));
    }

    /// Radius at `z` = 0…1 of a stem's length.
    [[nodiscard]] double radius_at(const stem& s, double z) const {
        const double radius = stem_radius(level_of(p_, s.level).taper, s.radius, s.length, z);
        return s.level == 0 ? radius * std::max(0.0, flare_factor(p_.flare, z)) : radius;
    }

    /// Inside the pruning envelope. Section 4.6.
    [[nodiscard]] bool inside_envelope(const glm::dvec3& at) const {
        const double ratio = (scale_ - at.z) / (scale_ * (1 - static_cast<double>(p_.base_size)));
        const double r = std::sqrt(at.x * at.x + at.y * at.y);
        return r <= scale_ * p_.prune_width * shape_ratio(p_, 8, ratio);
    }

    /// Shortens a stem until it fits the envelope. A shorter stem is grown from the same random
    /// numbers, so that its form stays.
    void prune(stem& s) const {
        if (p_.prune_ratio <= 0 || s.level == 0)
            return;
        const double whole = s.length;
        constexpr double step = 0.9;
        constexpr double shortest = 0.01;
        double part = 1;
        const auto outside = [this](const run&, const piece& grown, pcg32&) {
            return inside_envelope(grown.to);
        };
        while (part > shortest) {
            s.length = whole * part;
            auto errors = split_error_; // a trial must not spend the real run's splits
            if (walk(s, errors, outside))
                break;
            part *= step;
        }
        if (part <= shortest)
            part = 0;
        s.length = whole * (1 - p_.prune_ratio * (1 - part));
    }

    void grow_stem(stem s) {
        prune(s);
        if (!(s.length > 0))
            return;
        const weber_penn_level& l = level_of(p_, s.level);
        const int children = s.level + 1 < p_.levels ? child_count(s) : 0;
        pcg32 child_random(s.seed ^ 0x9e3779b97f4a7c15u);
        walk(s, split_error_, [&](run& r, const piece& grown, pcg32&) {
            append(s, r, grown);
            const double part = s.length / l.curve_res;
            bear(s, r, grown, grown.segment * part, part, children, child_random);
            return segments_.size() <= most_;
        });
    }

    /// Grows all segments of a stem and its clones, calling visit(run&, piece, random) for each;
    /// stops and returns false where visit does.
    template <class Visit>
    bool walk(const stem& s, std::array<double, most_levels>& errors, const Visit& visit) const {
        const weber_penn_level& l = level_of(p_, s.level);
        const double part = s.length / l.curve_res;
        pcg32 random(s.seed);
        const double helix_start = random.uniform() * 2 * pi;
        std::vector<run> runs(1);
        runs[0].at = s.base;
        runs[0].frame = s.frame;
        runs[0].parent = s.parent;
        while (!runs.empty()) {
            run r = runs.back();
            runs.pop_back();
            while (r.segment < l.curve_res) {
                if (r.segment > 0)
                    bend(s, r, random);
                piece grown;
                grown.segment = r.segment;
                grown.frame = r.frame;
                if (l.curve_v < 0)
                    grown.frame = r.frame *
                                  about_z(helix_start + 2 * pi * r.segment / l.curve_res) *
                                  about_x(-l.curve_v * degrees);
                grown.from = r.at;
                grown.to = r.at + part * axis_of(grown.frame);
                if (!visit(r, std::as_const(grown), random))
                    return false;
                r.at = grown.to;
                ++r.segment;
                if (r.segment < l.curve_res)
                    split(s, r, runs, random, errors[static_cast<std::size_t>(s.level)]);
            }
        }
        return true;
    }

    /// Turns the axis between two segments: curve, split's undoing, attraction. Sections 4.1, 4.8.
    void bend(const stem& s, run& r, pcg32& random) const {
        const weber_penn_level& l = level_of(p_, s.level);
        double angle = l.curve;
        if (l.curve_back != 0)
            angle = 2 * (2 * r.segment < l.curve_res ? l.curve : l.curve_back);
        angle = angle / l.curve_res;
        if (l.curve_v > 0)
            angle += random.vary(l.curve_v) / l.curve_res;
        angle *= degrees;
        angle -= r.bend_back;
        if (s.level >= 2 && p_.attraction_up != 0) {
            const glm::dvec3 y = r.frame * glm::dvec3(0, 1, 0);
            // a positive turn about x leads away from y, hence the sign
            angle -= p_.attraction_up * declination(r.frame) * y.z / l.curve_res;
        }
        r.frame = glm::normalize(r.frame * about_x(angle));
    }

    /// Clones the stem at the end of a segment. Section 4.2.
    void split(const stem& s, run& r, std::vector<run>& runs, pcg32& random, double& error) const {
        const weber_penn_level& l = level_of(p_, s.level);
        int clones = p_.base_splits;
        if (s.level > 0 || r.segment != 1) {
            const double wanted = l.seg_splits + error;
            clones = static_cast<int>(std::floor(wanted + 0.5));
            error = wanted - clones;
        } else if (clones == 0) {
            return;
        }
        if (clones <= 0 || runs.size() > most_)
            return;
        const int remaining = l.curve_res - r.segment;
        const run original = r;
        for (int j = 0; j <= clones; ++j) {
            run clone = original;
            const double from_up = declination(original.frame);
            const double wide = (l.split_angle + random.vary(l.split_angle_v)) * degrees;
            const double angle = std::max(0.0, wide - from_up);
            clone.frame = clone.frame * about_x(angle);
            clone.bend_back += angle / remaining;
            if (j > 0)
                clone.frame = glm::normalize(spread(j, clones, from_up, random) * clone.frame);
            clone.clone_count = original.clone_count * (static_cast<std::uint64_t>(clones) + 1);
            clone.clone_index =
                original.clone_index + static_cast<std::uint64_t>(j) * original.clone_count;
            if (j == 0)
                r = clone;
            else
                runs.push_back(clone);
        }
    }

    /// How a clone is turned about the vertical, away from its original. Section 4.2.
    [[nodiscard]] static glm::dquat spread(int j, int clones, double from_up, pcg32& random) {
        const double u = random.uniform();
        const double off = std::abs(from_up / degrees - 90);
        const double angle = (20 + 0.75 * (30 + off) * u * u) * degrees;
        if (clones > 1) // several clones stand evenly around, as far as the angle above lets them
            return about_z(2 * pi * j / (clones + 1) + (angle - 20 * degrees) / (clones + 1));
        return about_z(random.next() % 2 == 0 ? angle : -angle);
    }

    /// How many children a stem has. Section 4.3.
    [[nodiscard]] int child_count(const stem& s) const {
        const double most = level_of(p_, s.level + 1).branches;
        double factor = 1;
        if (s.level == 1 && s.parent_length > 0 && s.length_max > 0)
            factor = 0.2 + 0.8 * (s.length / s.parent_length) / s.length_max;
        else if (s.level > 1 && s.parent_length > 0)
            factor = 1 - 0.5 * s.offset / s.parent_length;
        return static_cast<int>(std::floor(most * std::clamp(factor, 0.0, 1.0) + 0.5));
    }

    /// Puts the children of one piece of a stem on the list. They stand at even steps over the
    /// stem, the trunk's bare base left out.
    void bear(const stem& s, run& r, const piece& grown, double start, double part, int children,
              pcg32& random) {
        if (children <= 0)
            return;
        const double bare =
            s.level == 0 ? std::min(static_cast<double>(p_.base_size) * scale_, s.length) : 0;
        const double step = (s.length - bare) / children;
        if (!(step > 0))
            return;
        const auto first_after = [&](double offset) {
            return std::clamp(std::ceil((offset - bare) / step - 0.5), 0.0,
                              static_cast<double>(children));
        };
        const auto last = static_cast<std::uint64_t>(
            grown.segment + 1 == level_of(p_, s.level).curve_res ? children
                                                                 : first_after(start + part));
        for (auto k = static_cast<std::uint64_t>(first_after(start)); k < last; ++k) {
            if (k % r.clone_count != r.clone_index)
                continue;
            const double offset = bare + (static_cast<double>(k) + 0.5) * step;
            const double along = std::clamp((offset - start) / part, 0.0, 1.0);
            const glm::dvec3 base = grown.from + along * (grown.to - grown.from);
            pending_.push_back(child(s, r, grown, base, offset, bare, random));
        }
    }

    [[nodiscard]] stem child(const stem& s, run& r, const piece& grown, const glm::dvec3& base,
                             double offset, double bare, pcg32& random) const {
        const weber_penn_level& l = level_of(p_, s.level + 1);
        stem c;
        c.level = s.level + 1;
        c.base = base;
        c.parent = bearer(r, offset / s.length);
        c.offset = offset;
        c.parent_length = s.length;
        c.seed = next_seed(random);
        c.length_max = std::max(0.0, l.length + random.vary(l.length_v));
        const double ratio = s.length > bare ? (s.length - offset) / (s.length - bare) : 0;
        if (s.level == 0)
            c.length = s.length * c.length_max * shape_ratio(p_, p_.shape, ratio);
        else
            c.length = c.length_max * (s.length - 0.6 * offset);
        const double thinner = std::pow(c.length / s.length, static_cast<double>(p_.ratio_power));
        c.radius = radius_at(s, offset / s.length);
        if (s.radius * thinner < c.radius) // false for 0 · ∞
            c.radius = s.radius * thinner;

        double turn = random.vary(l.rotate_v);
        if (l.rotate < 0) { // by turns on either side
            turn += 180 + l.rotate;
            r.turned = r.side * turn * degrees;
            r.side = -r.side;
        } else {
            r.turned += (turn + l.rotate) * degrees;
        }
        double down = l.down_angle;
        if (l.down_angle_v < 0)
            down += l.down_angle_v * (1 - 2 * shape_ratio(p_, 0, ratio));
        else
            down += random.vary(l.down_angle_v);
        c.frame = glm::normalize(grown.frame * about_z(r.turned) * about_x(down * degrees));
        return c;
    }

    /// The segment of the piece just emitted that holds `z` = 0…1 of the stem's length.
    [[nodiscard]] std::uint32_t bearer(const run& r, double z) const {
        std::uint32_t last = r.parent;
        for (std::size_t i = piece_ends_.size() - 1; i > 0 && z < piece_ends_[i - 1]; --i)
            --last;
        return last;
    }

    /// Writes one piece as a segment; the foot of a flared trunk as several, since its radius
    /// changes within an eighth of its length.
    void append(const stem& s, run& r, const piece& grown) {
        const int res = level_of(p_, s.level).curve_res;
        const double z0 = static_cast<double>(grown.segment) / res;
        const double z1 = static_cast<double>(grown.segment + 1) / res;
        glm::dvec3 from = grown.from;
        double z_from = z0;
        piece_ends_.clear();
        const auto write = [&](double z_to) {
            const double along = (z_to - z0) / (z1 - z0);
            const glm::dvec3 to = grown.from + along * (grown.to - grown.from);
            segment piece_of_wood;
            piece_of_wood.base = to_world(from);
            piece_of_wood.tip = to_world(to);
            piece_of_wood.base_radius = static_cast<float>(radius_at(s, z_from));
            piece_of_wood.radius = static_cast<float>(radius_at(s, z_to));
            piece_of_wood.parent = r.parent;
            r.parent = static_cast<std::uint32_t>(segments_.size());
            constexpr double farthest = 1e9;
            too_far_ = too_far_ || !(glm::length(to) < farthest) ||
                       !(std::abs(to.z * z_scale_) < farthest);
            segments_.push_back(piece_of_wood);
            piece_ends_.push_back(z_to);
            from = to;
            z_from = z_to;
        };
        if (s.level == 0 && p_.flare != 0)
            for (const double cut : {1 / 64.0, 1 / 32.0, 1 / 16.0, 1 / 8.0})
                if (cut > z0 && cut < z1)
                    write(cut);
        write(z1);
    }

    /// From the paper's z up to +Y up, right-handed.
    [[nodiscard]] glm::vec3 to_world(const glm::dvec3& v) const {
        return glm::vec3(glm::dvec3(v.x, v.z * z_scale_, -v.y));
    }

    weber_penn_parameters p_;
    std::size_t most_;
    pcg32 random_;
    double scale_ = 0; ///< m, the paper's scale_tree
    double z_scale_ = 1;
    /// What splitting owes at each level: a fraction a segment adds up to whole clones.
    std::array<double, most_levels> split_error_{};
    bool too_far_ = false;           ///< floats would lose the tree, or overflow
    std::vector<double> piece_ends_; ///< z at the tip of each segment of the piece just emitted
    std::vector<stem> pending_;
    std::vector<segment> segments_;
};

} // namespace detail::weber_penn

/// Grows a tree with its foot at the origin, +Y up, in metres; parents before children, ready for
/// `build_skeleton`. The same parameters and seed give the same tree on every compiler, as far as
/// its mathematical library rounds alike.
///
/// A stem starts on its parent's axis, inside its parent. Leaves are not placed here.
///
/// Errors (`bad_input`, naming the parameter and its value): NaN, a negative count, a value out of
/// range, no trunk, or numbers that would make more than `most` segments or 1e9 m.
template <class = when_used>
[[nodiscard]] result<std::vector<segment>> grow(const weber_penn_parameters& parameters,
                                                std::uint32_t seed,
                                                std::size_t most = default_most_segments) {
    if (std::string complaint = detail::weber_penn::complaint_of(parameters); !complaint.empty())
        return fail(error_code::bad_input, std::move(complaint));
    const auto limit = static_cast<double>(most);
    const double estimate = detail::weber_penn::segment_estimate(parameters, limit);
    if (estimate > limit)
        return fail(error_code::bad_input,
                    "These tree parameters could make about " +
                        detail::weber_penn::value_text(std::floor(estimate)) +
                        " segments; expected at most " + std::to_string(most) + ".");
    return detail::weber_penn::grower<>(parameters, seed, most).grow();
}

} // namespace skybark::trees
