#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>

#include <cstdio>

int main() {
    using backend = skybark::cpu::device;
    backend device;
    // One straight segment: three gaps of 2 · 8 triangles, and two caps of 6.
    const skybark::trees::segment trunk{{0, 0, 0}, {0, 2, 0}, 0.2f, 0.1f};
    const auto skeleton = skybark::trees::build_skeleton(std::span(&trunk, 1));
    const auto mesh = skybark::trees::branch_mesh<backend>::create(device, *skeleton, {});
    const auto done = skybark::run(device, [&](auto& recorder) { mesh->record(recorder); });
    std::printf("A tree of %zu segment has %d triangles.\n", skeleton->size(),
                static_cast<int>(mesh->triangles()));
    return done && mesh->triangles() == 60 ? 0 : 1;
}
