#pragma once
// scatter_limit: how hard it is for diffuse light to pass each cell.

#include <skybark/kernels/scatter_cells.hpp>

#include <cmath>

namespace skybark::kernels {

/// No buffers. Volumes: fluence, extinction. Target 0: resistance, 1/m.
struct scatter_limit {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t volume_targets = 1;

    glm::vec4 sides{1, 1, 1, 0}; ///< as in scatter_equation
    float transport = 1;         ///< 1 − albedo · mean cosine
    float spreading = 0;         ///< factor of what the fluence loses sideways
    float assumed = -1;          ///< what it loses, 1/m, where no fluence is known; below 0: it is

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const float across = assumed < 0 ? sideways(at, grids) : assumed;
        grids.store(
            0, at,
            shared::scatter_resistance(transport * grids.load(1, at), sides.w, spreading, across));
    }

  private:
    template <class Grids>
    [[nodiscard]] float sideways(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 last = grids.size(0) - 1;
        const int left = glm::max(at.x - 1, 0);
        const int right = glm::min(at.x + 1, last.x);
        const int back = glm::max(at.z - 1, 0);
        const int front = glm::min(at.z + 1, last.z);
        const float to_left = grids.load(0, {left, at.y, at.z});
        const float to_right = grids.load(0, {right, at.y, at.z});
        const float to_back = grids.load(0, {at.x, at.y, back});
        const float to_front = grids.load(0, {at.x, at.y, front});
        const float x =
            (to_right - to_left) / (static_cast<float>(glm::max(right - left, 1)) * sides.x);
        const float z =
            (to_front - to_back) / (static_cast<float>(glm::max(front - back, 1)) * sides.z);
        // The mean around stands in for a dark cell between bright ones, so that the loss is of the
        // order of one over a side at most.
        const float around = 0.25f * ((to_left + to_right) + (to_back + to_front));
        const float here = glm::max(glm::max(grids.load(0, at), around), 1e-12f);
        return std::sqrt(x * x + z * z) / here;
    }
};

} // namespace skybark::kernels
