#pragma once
// leaf_blade: a leaf becomes two half octagons folded along the midrib.
// Source: Akagi and Kitajima, section 3.4. Level of detail: Cook, Halstead, Planck and Ryu,
// "Stochastic Simplification of Aggregate Detail", SIGGRAPH 2007.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/leaf.hpp>

#include <cmath>

namespace skybark::kernels {

/// The flutter repeats after so many seconds; a leaf oscillates two to four times a second.
inline constexpr double flutter_period = 64;

/// Seconds as leaf_blade takes them, without loss however late it is.
[[nodiscard]] inline std::uint32_t flutter_time(double seconds) {
    const double periods = seconds / flutter_period;
    const double phase = (periods - std::floor(periods)) * 4294967296.0;
    return phase >= 0 && phase < 4294967296.0 ? static_cast<std::uint32_t>(phase) : 0;
}

/// Buffers: leaves, poses of the segments, and the air at the segments: xyz its velocity, w its
/// speed, m/s. Leaf positions are at rest.
///
/// As rings: ten vertices a leaf, five a half from the stalk to the tip, the right half (+X) first,
/// and six triangles. A leaf that level of detail drops has no size.
/// As a list: two strips a leaf of three triangles, or of one where the leaf is a quadrilateral, or
/// of none where it is dropped.
///
/// u goes across and v along the midrib, 0…1 over the leaf; the quadrilateral reaches 0.095 beyond.
/// Normals are the upper faces'. The blade's area is width · length / √2.
struct leaf_blade {
    using vertex = surface_vertex;
    using buffers = buffer_list<readonly<leaf>, readonly<segment_pose>, readonly<glm::vec4>>;
    using leaves_span = std::span<const leaf>;
    using poses_span = std::span<const segment_pose>;
    using air_span = std::span<const glm::vec4>;

    glm::vec4 camera{0};         ///< xyz: the eye; w: pixels a radian there, 0: all leaves in full
    std::uint32_t time = 0;      ///< flutter_time(seconds)
    float flutter = 0.5f;        ///< tangent of half the largest twist
    float flutter_speed = 3.0f;  ///< m/s where half of it is reached, > 0
    float lean = 0.6f;           ///< tangent of half the largest lean with the wind
    float lean_speed = 10.0f;    ///< m/s where half of it is reached, > 0
    float full = 3.0f;           ///< pixels: leaves that are smaller are thinned out
    float quad = 4.0f;           ///< pixels: leaves that are smaller are quadrilaterals
    std::uint32_t pose_step = 1; ///< 0: poses[0] carries every leaf
    std::uint32_t air_step = 1;  ///< 0: air[0] blows everywhere

    [[nodiscard]] std::uint32_t ring_vertices() const { return 10; }
    [[nodiscard]] std::uint32_t ring_triangles() const { return 6; }
    [[nodiscard]] std::uint32_t ring_index(std::uint32_t k) const {
        const std::uint32_t t = k / 3 % 3;
        const bool left = k >= 9;
        const std::uint32_t corner = k % 3;
        const std::uint32_t j = t + (corner < 2 && t % 2 == 1 ? 1 - corner : corner);
        return (left ? 5 : 0) + shared::leaf_corner(j, left, false);
    }

    template <class Sink>
    void ring(std::uint32_t i, std::uint32_t first, std::uint32_t count, Sink&& sink,
              leaves_span leaves, poses_span poses, air_span air) const {
        const shared::leaf_frame f = frame(leaves[i], poses, air);
        for (std::uint32_t k = first; k < first + count; ++k) {
            sink(shared::leaf_vertex(f, k >= 5, k % 5));
        }
    }

    [[nodiscard]] std::uint32_t strips() const { return 2; }
    [[nodiscard]] std::uint32_t strip_triangles() const { return 3; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t, leaves_span leaves,
                                          poses_span poses, air_span) const {
        const leaf& l = leaves[i];
        return triangles_of(
            detail(l, shared::posed_point(poses[l.carrier * pose_step], l.position)));
    }

    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t strip, std::uint32_t first, std::uint32_t count,
               Sink&& sink, leaves_span leaves, poses_span poses, air_span air) const {
        const shared::leaf_frame f = frame(leaves[i], poses, air);
        const bool left = strip == 1;
        const bool quadrilateral = triangles(i, strip, leaves, poses, air) == 1;
        for (std::uint32_t j = first; j < first + count; ++j) {
            sink(shared::leaf_vertex(f, left, shared::leaf_corner(j, left, quadrilateral)));
        }
    }

    /// How much of a leaf is drawn whose stalk begins at `base` now.
    [[nodiscard]] shared::leaf_detail detail(const leaf& l, const glm::vec3& base) const {
        if (!(camera.w > 0.0f)) {
            return {1.0f, 0.0f};
        }
        const glm::vec3 d = base - glm::vec3(camera);
        const float distance = std::max(std::sqrt(shared::dot3(d, d)), 1e-6f);
        const float seen = camera.w * std::sqrt(l.width * l.length) / distance;
        return shared::leaf_detail_of(seen, full, quad, l.seed);
    }

  private:
    [[nodiscard]] static std::uint32_t triangles_of(const shared::leaf_detail& d) {
        return d.scale > 0.0f ? (d.morph < 1.0f ? 3 : 1) : 0;
    }

    [[nodiscard]] shared::leaf_frame frame(const leaf& l, poses_span poses, air_span air) const {
        const shared::leaf_response response{time, flutter, flutter_speed, lean, lean_speed};
        const shared::leaf_at_rest rest{l.position, l.width, l.orientation, l.length,
                                        l.carrier,  l.seed,  l.fold};
        const segment_pose& pose = poses[l.carrier * pose_step];
        const glm::vec3 base = shared::posed_point(pose, l.position);
        const glm::vec4 turn = shared::leaf_turn(rest, pose, air[l.carrier * air_step], response);
        return shared::leaf_frame_of(rest, base, turn, detail(l, base));
    }
};
static_assert(sizeof(leaf_blade) == 52 && offsetof(leaf_blade, time) == 16);

} // namespace skybark::kernels
