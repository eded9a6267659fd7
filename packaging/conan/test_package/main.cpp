#include <skybark/cpu/cpu.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <cstdio>

int main() {
    using backend = skybark::cpu::device;
    backend device;
    const skybark::trees::segment trunk{{0, 0, 0}, {0, 2, 0}, 0.2f, 0.1f}; // base, tip, radii, m
    const auto skeleton = skybark::trees::build_skeleton(std::span(&trunk, 1));
    if (!skeleton)
        return 1; // skeleton.error().message is a sentence
    const auto mesh = skybark::trees::branch_mesh<backend>::create(device, *skeleton, {});
    if (!mesh)
        return 1;
    const auto done = skybark::run(device, [&](auto& recorder) { mesh->record(recorder); });
    std::printf("A trunk of %d triangles.\n", static_cast<int>(mesh->triangles()));
    return done ? 0 : 1;
}
