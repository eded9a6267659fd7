// expect: map_kernel[\s\S]*functions<.*>::map
#include <skybark/core/kernel.hpp>

struct forgetful { // names two buffers and takes one span
    using buffers =
        skybark::buffer_list<skybark::readonly<std::uint32_t>, skybark::writeonly<std::uint32_t>>;
    void map(std::uint32_t, std::span<std::uint32_t>) const {}
};

template <skybark::map_kernel K>
void use(const K&) {}

void call() { use(forgetful{}); }
