// expect: slab_kernel[\s\S]*functions<.*>::slab
#include <skybark/core/kernel.hpp>

struct fractions { // amounts are whole numbers: floats would depend on the order
    using buffers = skybark::buffer_list<skybark::readonly<float>>;
    std::uint32_t slabs() const { return 1; }
    std::uint32_t slab_count(std::uint32_t, std::span<const float>) const { return 1; }
    skybark::voxel_slab slab(std::uint32_t, std::uint32_t, std::span<const float>) const {
        return {};
    }
    float lateral(std::uint32_t, std::int32_t, std::int32_t, std::span<const float>) const {
        return 0;
    }
    float row(std::uint32_t, std::int32_t, std::span<const float>) const { return 0; }
    float amount(float, float, float) const { return 0.5f; }
};

template <skybark::slab_kernel K>
void use(const K&) {}

void call() { use(fractions{}); }
