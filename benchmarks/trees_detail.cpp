// Branches with level of detail: the same tree, meshed for pictures in which it is so many pixels
// tall.
//
//   trees/detail/BACKEND/PIXELS   PIXELS 0: full detail
//
// Counters: `triangles` that were made, and `of_full`, their fraction of full detail.

#include "devices.hpp"

#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/detail.hpp>
#include <skybark/trees/species.hpp>

#include <benchmark/benchmark.h>

namespace skybark::benchmarks {
namespace {

const trees::skeleton& grown_tree() {
    static const trees::skeleton tree =
        *trees::build_skeleton(*trees::grow(trees::all_species().front().parameters, 1));
    return tree;
}

template <backend B>
void detail(benchmark::State& state) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const trees::skeleton& tree = grown_tree();
    auto mesh = trees::detailed_branch_mesh<B>::create(**device, tree, {});
    if (!mesh) {
        state.SkipWithError(mesh.error().message.c_str());
        return;
    }
    const float height = trees::height(tree);
    trees::view_detail seen_from;
    seen_from.camera = {0, 0.5f * height, 3 * height};
    seen_from.pixels_per_radian = 3 * static_cast<float>(state.range(0));
    for (auto _ : state) {
        const auto done = run(**device, [&](auto& r) { mesh->record(r, seen_from); });
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    const auto made = mesh->made(**device);
    if (!made) {
        state.SkipWithError(made.error().message.c_str());
        return;
    }
    const auto triangles = static_cast<double>(made->written);
    state.counters["triangles"] = triangles;
    state.counters["of_full"] = triangles / static_cast<double>(mesh->triangles());
}

template <class Function>
void add(const char* name, Function function) {
    benchmark::RegisterBenchmark(name, function)
        ->Arg(0)
        ->Arg(3000)
        ->Arg(1000)
        ->Arg(300)
        ->Arg(100)
        ->Arg(30)
        ->Arg(10)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

const bool registered = [] {
    add("trees/detail/cpu", detail<cpu::device>);
    add("trees/detail/vulkan", detail<vulkan::device>);
    add("trees/detail/opengl", detail<opengl::device>);
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
