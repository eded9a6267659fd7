// expect: max_kernel_bytes
#include <skybark/core/kernel.hpp>

struct large {
    using buffers = skybark::buffer_list<skybark::writeonly<std::uint32_t>>;
    float parameters[29];
    void map(std::uint32_t, std::span<std::uint32_t>) const {}
};

template <skybark::map_kernel K>
void use(const K&) {}

void call() { use(large{}); }
