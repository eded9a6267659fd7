#pragma once
// cloud_drift: carries the particles of clouds along with the wind, through a square and in again
// on the other side.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/drift.hpp>

namespace skybark::kernels {

/// Maps over particles. Buffers: particles at rest, the middle of each one's cloud (y and w are not
/// read), particles moved. All of a cloud goes round at once, where its middle does; towards the
/// border of the square its optical depth fades. Every backend makes the same bits.
struct cloud_drift {
    using buffers =
        buffer_list<readonly<cloud_particle>, readonly<glm::vec4>, writeonly<cloud_particle>>;

    glm::vec4 box{0, 0, 1, 1};   ///< x, y: x and z of the middle; z: side, m; w: 1 / side
    glm::vec4 moved{0, 0, 1, 1}; ///< x, y: offset along x and z, in [0, side); z: square of the
                                 ///< distance from the middle where a cloud is gone; w: 1 / (that −
                                 ///< the square of the one where it starts to go)

    void map(std::uint32_t i, std::span<const cloud_particle> rest,
             std::span<const glm::vec4> middles, std::span<cloud_particle> particles) const {
        const glm::vec4& middle = middles[i];
        const float x = shared::drift_shift(middle.x, moved.x, box.x, box.z, box.w);
        const float z = shared::drift_shift(middle.z, moved.y, box.y, box.z, box.w);
        cloud_particle p = rest[i];
        p.position.x += x;
        p.position.z += z;
        p.optical_depth *=
            shared::drift_weight(middle.x + x - box.x, middle.z + z - box.y, moved.z, moved.w);
        particles[i] = p;
    }
};

} // namespace skybark::kernels
