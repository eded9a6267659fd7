// expect: is_trivially_copyable_v<(K|owner)>
#include <skybark/core/kernel.hpp>

struct owner {
    using buffers = skybark::buffer_list<skybark::writeonly<std::uint32_t>>;
    owner() = default;
    owner(const owner&) {}
    void map(std::uint32_t, std::span<std::uint32_t>) const {}
};

template <skybark::map_kernel K>
void use(const K&) {}

void call(const owner& kernel) { use(kernel); }
