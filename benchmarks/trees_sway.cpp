// Sway: loads in, poses out, one dynamic step of 1/60 s.
//
//   trees/sway/BACKEND/JOINTS
//   trees/sway/one_core/JOINTS   the CPU backend on a single thread
//
// Counter: joints a second. The stand is as many trees of 500 segments as it takes, each some 60
// levels deep, in a breeze.

#include "devices.hpp"

#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/sway.hpp>

#include <benchmark/benchmark.h>
#include <glm/geometric.hpp>
#include <random>

namespace skybark::benchmarks {
namespace {

constexpr std::uint32_t segments_a_tree = 500;

/// A trunk of thirty segments, and boughs and twigs that each go on from one of the last fifty
/// segments or start at it.
trees::skeleton stand_of(std::uint32_t joints) {
    std::mt19937 random(7);
    const auto number = [&] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
    std::vector<trees::segment> segments(joints);
    for (std::uint32_t i = 0; i < joints; ++i) {
        const std::uint32_t k = i % segments_a_tree;
        trees::segment& s = segments[i];
        const float trunk = k < 30 ? 0 : 1;
        s.parent = k == 0   ? trees::none
                   : k < 30 ? i - 1
                            : i - 1 - static_cast<std::uint32_t>(random()) % 50 % k;
        s.base = k == 0 ? glm::vec3(number(), 0, number()) * 100.0f : segments[s.parent].tip;
        s.tip = s.base + glm::normalize(glm::vec3(number() * trunk, 1, number() * trunk)) * 0.25f;
        s.base_radius = k == 0 ? 0.15f : segments[s.parent].radius;
        s.radius = std::max(0.004f, s.base_radius * (k < 30 ? 0.97f : 0.85f));
    }
    return std::move(*trees::build_skeleton(segments));
}

template <backend B>
void sway_on(benchmark::State& state, B& device) {
    const auto joints = static_cast<std::uint32_t>(state.range(0));
    auto sway = trees::sway<B>::create(device, stand_of(joints));
    if (!sway) {
        state.SkipWithError(sway.error().message.c_str());
        return;
    }
    const std::vector<segment_load> breeze(joints, segment_load{{0.05f, 0, 0.02f}, 0.02f});
    const auto loads = make_buffer<B, segment_load>(device, breeze);
    if (!loads) {
        state.SkipWithError(loads.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        const auto done =
            run(device, [&](auto& r) { sway->record(r, view<B>(*loads), 1 / 60.0f); });
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    state.counters["joints"] = benchmark::Counter(static_cast<double>(joints),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

template <backend B>
void sway(benchmark::State& state) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    sway_on(state, **device);
}

void one_core(benchmark::State& state) {
    cpu::device_options options;
    options.threads = 1;
    cpu::device device(options);
    sway_on(state, device);
}

void add(const std::string& name, void (*function)(benchmark::State&)) {
    benchmark::RegisterBenchmark(name.c_str(), function)
        ->Arg(1000)
        ->Arg(10000)
        ->Arg(15000)
        ->Arg(100000)
        ->Arg(1000000)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

const bool registered = [] {
    add("trees/sway/one_core", one_core);
    add("trees/sway/cpu", sway<cpu::device>);
    add("trees/sway/vulkan", sway<vulkan::device>);
    add("trees/sway/opengl", sway<opengl::device>);
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
