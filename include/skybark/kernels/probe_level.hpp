#pragma once
// probe_level: a map over levels that exists to be checked. Each element reads its parent's result.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// An element of a tree. A root is its own parent.
struct probe_node {
    std::uint32_t parent = 0;
    std::uint32_t weight = 0;
};
static_assert(sizeof(probe_node) == 8);

/// Buffers: nodes, and one buffer of values bound twice: to read the parents' and to write one's
/// own. A child's value is 3 · parent's + weight modulo 2³², so that it tells the way to its root.
struct probe_level {
    using buffers =
        buffer_list<readonly<probe_node>, readonly<std::uint32_t>, writeonly<std::uint32_t>>;

    void map(std::uint32_t i, std::span<const probe_node> nodes,
             std::span<const std::uint32_t> parents, std::span<std::uint32_t> values) const {
        const probe_node node = nodes[i];
        values[i] = node.parent == i ? node.weight : parents[node.parent] * 3 + node.weight;
    }
};

} // namespace skybark::kernels
