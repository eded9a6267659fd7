// The smallest use: a tree's branches as triangles, on the CPU.

#include <skybark/cpu/cpu.hpp>
#include <skybark/skybark.hpp>

#include <cstdio>

int main() {
    using backend = skybark::cpu::device; // or skybark::vulkan::device, skybark::opengl::device
    backend device;

    // A skeleton: from your own data, or grown.
    const auto species = skybark::trees::quaking_aspen();
    const auto segments = skybark::trees::grow(species, 1);
    const auto skeleton =
        segments.and_then([](const auto& found) { return skybark::trees::build_skeleton(found); });
    if (!skeleton) {
        std::fprintf(stderr, "%s\n", skeleton.error().message.c_str());
        return 1;
    }

    // The device is sent the skeleton once; the vertices are made anew whenever they are recorded.
    const auto mesh = skybark::trees::branch_mesh<backend>::create(device, *skeleton, {});
    const auto made = mesh.and_then([&](const auto& m) {
        return skybark::run(device, [&](auto& recorder) { m.record(recorder); });
    });
    if (!made) {
        std::fprintf(stderr, "%s\n", made.error().message.c_str());
        return 1;
    }
    std::printf("%zu segments became %llu triangles\n", skeleton->size(),
                static_cast<unsigned long long>(mesh->triangles()));
}
