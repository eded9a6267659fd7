// expect: grid_map_kernel[\s\S]*names_volumes
#include <skybark/core/kernel.hpp>

struct nameless { // takes volumes and doesn't say how many
    using buffers = skybark::buffer_list<skybark::writeonly<float>>;
    template <class Grids>
    void map(std::uint32_t i, const Grids& grids, std::span<float> out) const {
        out[i] = grids.load(0, glm::ivec3{0});
    }
};

template <skybark::grid_map_kernel K>
void use(const K&) {}

void call() { use(nameless{}); }
