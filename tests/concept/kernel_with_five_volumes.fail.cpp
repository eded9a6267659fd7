// expect: voxel_kernel[\s\S]*names_volumes
#include <skybark/core/kernel.hpp>

struct greedy {
    using buffers = skybark::buffer_list<>;
    static constexpr std::uint32_t volumes = 5;
    static constexpr std::uint32_t volume_targets = 1;
    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        grids.store(0, at, grids.load(4, at));
    }
};

template <skybark::voxel_kernel K>
void use(const K&) {}

void call() { use(greedy{}); }
