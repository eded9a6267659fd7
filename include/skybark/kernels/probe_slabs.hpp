#pragma once
// probe_slabs: an accumulation that exists to be checked.

#include <skybark/core/kernel.hpp>

#include <algorithm>

namespace skybark::kernels {

/// Slab s of a box is the layer low.z + s, from low.x + s to high.x and from low.y to high.y − s:
/// each is smaller than the one before it, and the last ones may be empty.
struct probe_box {
    glm::ivec4 low{0};  ///< xyz: the first voxel; w: what every voxel of it gets
    glm::ivec4 high{0}; ///< xyz: one past the last voxel; w: what a voxel gets besides for each y
};
static_assert(sizeof(probe_box) == 32);

/// Buffers: boxes. The amounts are whole numbers, and so is what is made for columns and rows.
struct probe_slabs {
    using buffers = buffer_list<readonly<probe_box>>;

    std::uint32_t most = 4;  ///< slabs
    std::int32_t per_x = 0;  ///< what a voxel gets besides for each x
    std::int32_t per_z = 0;  ///< the same for z
    std::int32_t factor = 1; ///< of all that

    [[nodiscard]] std::uint32_t slabs() const { return most; }
    [[nodiscard]] std::uint32_t slab_count(std::uint32_t i,
                                           std::span<const probe_box> boxes) const {
        const std::int32_t layers = std::max(boxes[i].high.z - boxes[i].low.z, 0);
        return std::min(static_cast<std::uint32_t>(layers), most);
    }
    [[nodiscard]] voxel_slab slab(std::uint32_t i, std::uint32_t s,
                                  std::span<const probe_box> boxes) const {
        const probe_box box = boxes[i];
        const auto by = static_cast<std::int32_t>(s);
        return {{box.low.x + by, box.low.y}, {box.high.x, box.high.y - by}, box.low.z + by};
    }
    /// Less than 2^24, and so exact.
    [[nodiscard]] float lateral(std::uint32_t i, std::int32_t x, std::int32_t z,
                                std::span<const probe_box> boxes) const {
        return static_cast<float>(boxes[i].low.w + per_x * x + per_z * z);
    }
    /// The same.
    [[nodiscard]] float row(std::uint32_t i, std::int32_t y,
                            std::span<const probe_box> boxes) const {
        return static_cast<float>(boxes[i].high.w * (y + 1));
    }
    /// 2 w (y + 1) − w (y + 2) is w y: a row that is taken for the one above it shows.
    [[nodiscard]] std::int32_t amount(float lateral, float row, float above) const {
        return static_cast<std::int32_t>(lateral + 2 * row - above) * factor;
    }
};

} // namespace skybark::kernels
