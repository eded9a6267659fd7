#pragma once
// branch_detail: how much of each end of a branch is to be seen from a place.
// Source: thin branches by Cook, Halstead, Planck and Ryu, "Stochastic Simplification of Aggregate
// Detail", SIGGRAPH 2007.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/detail.hpp>

namespace skybark::kernels {

using shared::chain_share;
using shared::end_detail;
using shared::segment_detail;
static_assert(sizeof(chain_share) == 16 && sizeof(end_detail) == 16);
static_assert(sizeof(segment_detail) == 16);

/// The corners that a polygon of so many sides can do with: halved as often as three or more and
/// whole ones are left. 8 and 16 go down to 4, 12 and 24 to 3.
[[nodiscard]] constexpr std::uint32_t least_sides(std::uint32_t sides) noexcept {
    while (sides % 2 == 0 && sides >= 6) {
        sides /= 2;
    }
    return sides;
}

/// Buffers: ends, their chains' shares, their detail. Maps over ends.
struct branch_detail {
    using buffers = buffer_list<readonly<branch_end>, readonly<chain_share>, writeonly<end_detail>>;

    glm::vec4 camera{0};            ///< xyz: the eye, m; w: pixels a radian there
    float error = 0;                ///< pixels that a surface may be off by; 0: full detail
    float thin = 0;                 ///< pixels: thinner radii are thinned out; 0: none are
    std::uint32_t fewest_sides = 4; ///< least_sides(sides)
    std::uint32_t sides = 8;        ///< of full detail

    void map(std::uint32_t i, std::span<const branch_end> ends, std::span<const chain_share> shares,
             std::span<end_detail> details) const {
        details[i] =
            shared::detail_of_end(ends[i], shares[i], camera, error, thin, fewest_sides, sides);
    }
};

} // namespace skybark::kernels
