// expect: draw_kernel[\s\S]*functions<.*>::draw
#include <skybark/core/kernel.hpp>

struct faceless {
    using buffers = skybark::buffer_list<skybark::readonly<glm::vec4>>;
    static constexpr std::uint32_t varyings = 1;
    static constexpr std::uint32_t images = 0;
    glm::vec4 vertex(std::uint32_t, std::array<glm::vec4, 1>&, std::span<const glm::vec4>) const {
        return {};
    }
};

template <skybark::draw_kernel K>
void use(const K&) {}

void call() { use(faceless{}); }
