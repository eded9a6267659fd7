// expect: no type named .buffers. in
#include <skybark/core/kernel.hpp>

struct nameless {
    void map(std::uint32_t) const {}
};

template <skybark::map_kernel K>
void use(const K&) {}

void call() { use(nameless{}); }
