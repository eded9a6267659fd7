// expect: sizeof ?\((Vertex|thin::vertex)\) % 16 == 0
#include <skybark/core/kernel.hpp>

struct thin {
    struct vertex {
        float values[6];
    };
    using buffers = skybark::buffer_list<skybark::readonly<glm::vec4>>;
    std::uint32_t ring_vertices() const { return 3; }
    std::uint32_t ring_triangles() const { return 1; }
    std::uint32_t ring_index(std::uint32_t k) const { return k; }
    template <class Sink>
    void ring(std::uint32_t, std::uint32_t, std::uint32_t, Sink&&,
              std::span<const glm::vec4>) const {}
};

template <skybark::ring_kernel K>
void use(const K&) {}

void call() { use(thin{}); }
