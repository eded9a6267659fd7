#pragma once
// merge_chains: how many segments of a chain can be drawn as one.

#include <skybark/kernels/branch_detail.hpp>

namespace skybark::kernels {

using shared::chain_detail;
static_assert(sizeof(chain_detail) == 16);

/// Ends first … last in a row: those of consecutive segments.
struct end_chain {
    std::uint32_t first = 0; ///< index of a branch_end
    std::uint32_t last = 0;  ///< index of a branch_end, after first
    std::uint32_t caps = 0;  ///< of the last segment
    std::uint32_t reserved = 0;
};
static_assert(sizeof(end_chain) == 16);

/// Buffers: chains, ends, the chains' detail. Maps over chains.
///
/// Pieces are doubled as long as no end that is left out is farther than the error from the curve
/// between its neighbours. One that is farther by up to as much again is on its way. A doubling
/// counts as twice the one before at least, so that one is done before the next begins.
struct merge_chains {
    using buffers = buffer_list<readonly<end_chain>, readonly<branch_end>, writeonly<chain_detail>>;

    glm::vec4 camera{0}; ///< xyz: the eye, m; w: pixels a radian there
    float error = 0;     ///< pixels that an end may be off by; 0: nothing is merged

    void map(std::uint32_t i, std::span<const end_chain> chains, std::span<const branch_end> ends,
             std::span<chain_detail> details) const {
        const end_chain& chain = chains[i];
        const auto own = ends.subspan(chain.first, chain.last - chain.first + 1);
        std::uint32_t stride = 1;
        float fraction = 1;
        if (error > 0 && own.size() > 2) {
            const float scale = camera.w / (nearest_end(own) * error);
            float off = 0;
            bool more = true;
            while (more && stride < own.size() - 1) {
                off = std::max(2.0f * off, longest_way(own, stride) * scale);
                more = off <= 1;
                stride = more ? 2 * stride : stride;
            }
            fraction = !more && off < 2 ? off - 1 : 1;
        }
        details[i] = {chain.last, chain.caps, stride, fraction};
    }

  private:
    [[nodiscard]] float nearest_end(std::span<const branch_end> ends) const {
        float least = 1e30f;
        for (const branch_end& e : ends) {
            const glm::vec3 away = e.position - glm::vec3(camera);
            least = std::min(least, shared::dot3(away, away));
        }
        return std::max(std::sqrt(least), 1e-6f);
    }

    /// The longest way of the ends that pieces of twice the length leave out.
    [[nodiscard]] static float longest_way(std::span<const branch_end> ends, std::uint32_t stride) {
        const auto last = static_cast<std::uint32_t>(ends.size() - 1);
        float most = 0;
        for (std::uint32_t i = stride; i < last; i += 2 * stride) {
            most = std::max(most, shared::way_between(ends[i - stride],
                                                      ends[std::min(i + stride, last)], ends[i]));
        }
        return most;
    }
};

} // namespace skybark::kernels
