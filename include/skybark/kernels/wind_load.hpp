#pragma once
// wind_load: what moving air does to segments and the leaves that they carry.
// Source: drag of a cylinder in crossflow by the independence principle (Hoerner 1965, chapter 3);
// leaves by F ~ U^(2 + V) (Vogel 1984).

#include <skybark/core/kernel.hpp>
#include <skybark/shared/wind.hpp>

namespace skybark::kernels {

static_assert(record<shared::wind_segment> && sizeof(shared::wind_segment) == 32);

/// Buffers: what the wind sees of the segments, their poses, air (xyz m/s, w: speed), loads. Maps
/// over segments.
struct wind_load {
    using buffers = buffer_list<readonly<shared::wind_segment>, readonly<segment_pose>,
                                readonly<glm::vec4>, writeonly<segment_load>>;

    float half_density = 0; ///< kg/m³, half of the air's
    float vogel = 0;        ///< the exponent V of the leaves, −1 … 0
    float reference = 1;    ///< m/s > 0, where leaves begin to yield

    void map(std::uint32_t i, std::span<const shared::wind_segment> segments,
             std::span<const segment_pose> poses, std::span<const glm::vec4> air,
             std::span<segment_load> loads) const {
        loads[i] = shared::wind_load_on(segments[i], poses[i].rotation, air[i], half_density, vogel,
                                        reference);
    }
};

} // namespace skybark::kernels
