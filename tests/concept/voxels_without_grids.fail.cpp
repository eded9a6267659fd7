// expect: voxel_kernel[\s\S]*functions<.*>::voxel
#include <skybark/core/kernel.hpp>

struct blind { // names volumes and takes none
    using buffers = skybark::buffer_list<skybark::writeonly<std::uint32_t>>;
    static constexpr std::uint32_t volumes = 1;
    void voxel(glm::ivec3, std::span<std::uint32_t>) const {}
};

template <skybark::voxel_kernel K>
void use(const K&) {}

void call() { use(blind{}); }
