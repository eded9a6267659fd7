#pragma once
// The paper's CPU path, as one would write it down: one thread, recursion over the tree, plain
// floats, trigonometry where the equations have it, triangle after triangle into one list.
// Source: Akagi and Kitajima, sections 2.2 to 2.5. Mended where a slip would spoil the mesh:
// equation 1's sign, equation 2's divisor, and displacement along the smooth normal.

#include <skybark/trees/branch_layout.hpp>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace skybark::benchmarks {

struct paper_options {
    std::uint32_t sides = 8;
    std::uint32_t rings = 4;
    float threshold = 0; ///< m; edges that are longer are split; 0: no bark
    float relief = 0;    ///< m
    float young = 9.5e9f;
};

class paper_tree {
  public:
    paper_tree(const trees::skeleton& skeleton, std::span<const leaf> leaves,
               std::span<const float> heights, std::uint32_t height_size,
               const paper_options& options)
        : skeleton_(skeleton), leaves_(leaves), heights_(heights), size_(height_size),
          options_(options),
          layout_(trees::layout_branches(skeleton, kernels::branch_frame::slerp)),
          force_(skeleton.size()), turn_(skeleton.size()), base_(skeleton.size()),
          ends_(layout_.ends) {
        for (std::uint32_t i = 0; i <= options_.sides; ++i) {
            const float angle =
                6.2831853f * static_cast<float>(i) / static_cast<float>(options_.sides);
            circle_.emplace_back(std::cos(angle), std::sin(angle));
        }
    }

    /// One frame: forces, rotations, branches, bark, leaves.
    void generate(const glm::vec3& wind) {
        for (std::uint32_t i = 0; i < skeleton_.size(); ++i) {
            if (skeleton_.parent[i] == trees::none) {
                collect_force(i, wind);
                turn(i, glm::quat(1, 0, 0, 0), skeleton_.position[i]);
            }
        }
        pose_ends();
        triangles_.clear();
        for (std::size_t i = 0; i < layout_.segments.size(); ++i) {
            branch(i);
        }
        for (const leaf& l : leaves_) {
            blade(l);
        }
    }

    [[nodiscard]] std::uint64_t triangles() const { return triangles_.size() / 3; }

  private:
    /// The wind's force on a segment and on all that grows from it (2.5, steps 1 and 2).
    glm::vec3 collect_force(std::uint32_t i, const glm::vec3& wind) {
        const float area = 2 * skeleton_.radius[i] * skeleton_.length[i];
        glm::vec3 sum = wind * (0.5f * 1.2f * glm::length(wind) * area);
        for (std::uint32_t c = 0; c < skeleton_.child_count[i]; ++c) {
            sum += collect_force(skeleton_.first_child[i] + c, wind);
        }
        return force_[i] = sum;
    }

    /// Turns a segment about its joint, and what grows from it with it (2.5, steps 3 and 4).
    void turn(std::uint32_t i, const glm::quat& parent, const glm::vec3& base) {
        const glm::vec3 axis = parent * (skeleton_.orientation[i] * glm::vec3(0, 1, 0));
        const glm::vec3 across = force_[i] - axis * glm::dot(force_[i], axis);
        const float r = std::max(skeleton_.radius[i], 1e-4f);
        const float length = std::max(skeleton_.length[i], 1e-4f);
        const float stiffness = options_.young * 0.78539816f * r * r * r * r / length;
        const float angle = std::min(glm::length(across) * length / stiffness, 0.3f);
        const glm::vec3 about = glm::cross(axis, across);
        const float l = glm::length(about);
        turn_[i] = l > 0 ? glm::angleAxis(angle, about / l) * parent : parent;
        base_[i] = base;
        for (std::uint32_t c = 0; c < skeleton_.child_count[i]; ++c) {
            const std::uint32_t child = skeleton_.first_child[i] + c;
            turn(child, turn_[i],
                 base + turn_[i] * (skeleton_.position[child] - skeleton_.position[i]));
        }
    }

    [[nodiscard]] glm::vec3 carried(std::uint32_t by, const glm::vec3& rest) const {
        return base_[by] + turn_[by] * (rest - skeleton_.position[by]);
    }

    void pose_ends() {
        for (std::size_t e = 0; e < ends_.size(); ++e) {
            const branch_end& rest = layout_.ends[e];
            const end_carrier& by = layout_.carriers[e];
            const glm::quat q = glm::slerp(turn_[by.turned_by], turn_[by.and_by], 0.5f) *
                                glm::quat(rest.orientation.w, rest.orientation.x,
                                          rest.orientation.y, rest.orientation.z);
            ends_[e].position = carried(by.moved_by, rest.position);
            ends_[e].orientation = glm::vec4(q.x, q.y, q.z, q.w);
        }
    }

    /// Rings along a Hermite curve, stitched (2.2, equations 1 and 2).
    void branch(std::size_t segment) {
        const branch_end& a = ends_[layout_.segments[segment].start];
        const branch_end& b = ends_[layout_.segments[segment].end];
        const glm::quat q1(a.orientation.w, a.orientation.x, a.orientation.y, a.orientation.z);
        const glm::quat q2(b.orientation.w, b.orientation.x, b.orientation.y, b.orientation.z);
        const float chord = glm::distance(a.position, b.position);
        const glm::vec3 n1 = q1 * glm::vec3(0, chord, 0);
        const glm::vec3 n2 = q2 * glm::vec3(0, chord, 0);
        ring_.clear();
        for (std::uint32_t k = 0; k < options_.rings; ++k) {
            const float t = static_cast<float>(k) / static_cast<float>(options_.rings - 1);
            const float s = 1 - t;
            const glm::vec3 centre = a.position * ((1 + 2 * t) * s * s) + n1 * (t * s * s) +
                                     b.position * (t * t * (3 - 2 * t)) - n2 * (t * t * s);
            const glm::quat q = glm::slerp(q1, q2, t);
            const glm::vec3 x = q * glm::vec3(1, 0, 0);
            const glm::vec3 z = q * glm::vec3(0, 0, 1);
            const float radius = a.radius * s + b.radius * t;
            for (std::uint32_t i = 0; i <= options_.sides; ++i) {
                const glm::vec3 outward = x * circle_[i].x - z * circle_[i].y;
                const glm::vec3 around = x * -circle_[i].y - z * circle_[i].x;
                ring_.push_back({centre + outward * radius,
                                 static_cast<float>(i) / static_cast<float>(options_.sides),
                                 outward, a.path * s + b.path * t, glm::vec4(around, 1)});
            }
        }
        for (std::uint32_t k = 0; k + 1 < options_.rings; ++k) {
            for (std::uint32_t i = 0; i < options_.sides; ++i) {
                const surface_vertex* lower = ring_.data() + k * (options_.sides + 1) + i;
                const surface_vertex* upper = lower + options_.sides + 1;
                bark(upper[0], lower[0], upper[1]);
                bark(upper[1], lower[0], lower[1]);
            }
        }
    }

    /// Splits a triangle at its edges' midpoints as long as it is large (2.3).
    void bark(const surface_vertex& a, const surface_vertex& b, const surface_vertex& c) {
        const float longest =
            std::max({glm::distance(a.position, b.position), glm::distance(b.position, c.position),
                      glm::distance(c.position, a.position)});
        if (options_.threshold <= 0 || longest <= options_.threshold) {
            triangles_.push_back(a);
            triangles_.push_back(b);
            triangles_.push_back(c);
            return;
        }
        const surface_vertex ab = middle(a, b);
        const surface_vertex bc = middle(b, c);
        const surface_vertex ca = middle(c, a);
        bark(a, ab, ca);
        bark(ab, b, bc);
        bark(ca, bc, c);
        bark(ab, bc, ca);
    }

    [[nodiscard]] surface_vertex middle(const surface_vertex& a, const surface_vertex& b) const {
        surface_vertex m;
        m.u = 0.5f * (a.u + b.u);
        m.v = 0.5f * (a.v + b.v);
        m.normal = glm::normalize(a.normal + b.normal);
        m.tangent = glm::vec4(glm::normalize(glm::vec3(a.tangent) + glm::vec3(b.tangent)), 1);
        const float lift = height(m.u, m.v) - 0.5f * (height(a.u, a.v) + height(b.u, b.v));
        m.position = 0.5f * (a.position + b.position) + m.normal * (options_.relief * lift);
        return m;
    }

    /// The height map, bilinear and periodic.
    [[nodiscard]] float height(float u, float v) const {
        const float x = (u - std::floor(u)) * static_cast<float>(size_);
        const float y = (v - std::floor(v)) * static_cast<float>(size_);
        const std::uint32_t i = static_cast<std::uint32_t>(x) % size_;
        const std::uint32_t j = static_cast<std::uint32_t>(y) % size_;
        const std::uint32_t right = (i + 1) % size_;
        const std::uint32_t below = (j + 1) % size_;
        const float s = x - std::floor(x);
        const float t = y - std::floor(y);
        const float upper = glm::mix(heights_[j * size_ + i], heights_[j * size_ + right], s);
        const float lower =
            glm::mix(heights_[below * size_ + i], heights_[below * size_ + right], s);
        return glm::mix(upper, lower, t);
    }

    /// Two half discs that meet at the midrib (2.4).
    void blade(const leaf& l) {
        const glm::quat q = turn_[l.carrier] * glm::quat(l.orientation.w, l.orientation.x,
                                                         l.orientation.y, l.orientation.z);
        const glm::vec3 root = carried(l.carrier, l.position);
        for (const float side : {-1.0f, 1.0f}) {
            const glm::quat half = q * glm::angleAxis(-side * l.fold, glm::vec3(0, 1, 0));
            const glm::vec3 normal = half * glm::vec3(0, 0, 1);
            const glm::vec4 tangent(half * glm::vec3(1, 0, 0), 1);
            surface_vertex rim[5];
            for (int i = 0; i < 5; ++i) {
                const float angle = 0.78539816f * static_cast<float>(i);
                const float across = side * std::sin(angle);
                const float along = 0.5f - 0.5f * std::cos(angle);
                rim[i] = {root + half * glm::vec3(0.5f * l.width * across, l.length * along, 0),
                          0.5f + 0.5f * across, normal, along, tangent};
            }
            for (int i = 1; i < 4; ++i) {
                const bool right = side > 0;
                triangles_.push_back(rim[0]);
                triangles_.push_back(rim[right ? i : i + 1]);
                triangles_.push_back(rim[right ? i + 1 : i]);
            }
        }
    }

    const trees::skeleton& skeleton_;
    std::span<const leaf> leaves_;
    std::span<const float> heights_;
    std::uint32_t size_;
    paper_options options_;
    trees::branch_layout layout_;
    std::vector<glm::vec3> force_;
    std::vector<glm::quat> turn_;
    std::vector<glm::vec3> base_;
    std::vector<branch_end> ends_;
    std::vector<glm::vec2> circle_;
    std::vector<surface_vertex> ring_;
    std::vector<surface_vertex> triangles_;
};

} // namespace skybark::benchmarks
