// expect: peel_kernel[\s\S]*functions<.*>::corner
#include <skybark/core/kernel.hpp>

struct flat { // a place in clip space has four numbers
    using buffers = skybark::buffer_list<skybark::readonly<glm::vec4>>;
    glm::vec3 corner(std::uint32_t, std::span<const glm::vec4>) const { return {}; }
};

template <skybark::peel_kernel K>
void use(const K&) {}

void call() { use(flat{}); }
