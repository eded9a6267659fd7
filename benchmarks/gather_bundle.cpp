// What points on a scene's surfaces meet along one direction, or against it.
//
//   gather/bundle/METHOD_BACKEND/SCENE_SAMPLES
//       METHOD   resolve    exact at each point, as the backend does it fastest
//                composed   the same of the patterns that all backends have; where resolve differs
//       SCENE    cornell, park, canopy: examples/scenes
//   gather/bundle/embree_…  rays traced one by one instead: benchmarks/embree/gather_bundle.cpp
//
// Points lie evenly on the surfaces, in Morton order. Each iteration takes the next of 64 axes, the
// same for all methods, and everything that a direction needs: nothing is built beforehand but by
// Embree. Items are points: rays that somebody asked for.
//
// For a table, with everything in one run on a machine that does nothing else, of the preset bench:
//   skybark_benchmarks
//   --benchmark_filter='^gather/bundle/((resolve|composed)_|embree_(random|shared)/)'
//       --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
//       --benchmark_enable_random_interleaving=true --benchmark_min_time=0.5

#include "devices.hpp"
#include "gather_work.hpp"

#include <skybark/gather/bundle_resolver.hpp>

#include <benchmark/benchmark.h>

namespace skybark::benchmarks {
namespace {

/// What one benchmark measures.
struct bundle_row {
    std::string scene;
    std::uint32_t samples;
    gather::resolve_route route;
};

/// A scene and its points on a device.
template <backend B>
struct device_work {
    typename B::buffer triangles;
    typename B::buffer samples;
    typename B::buffer hits;

    [[nodiscard]] static result<device_work> create(B& device, const gather_work& work) {
        auto triangles = make_buffer<B, gather_triangle>(device, work.scene.triangles);
        auto samples = make_buffer<B, gather_sample>(device, work.samples);
        auto hits = device.create_buffer(work.samples.size() * sizeof(gather_hit));
        for (const auto* made : {&triangles, &samples, &hits}) {
            if (!*made) {
                return failure(made->error());
            }
        }
        return device_work{std::move(*triangles), std::move(*samples), std::move(*hits)};
    }

    [[nodiscard]] bundle_work<B> views() const {
        return {view<B>(triangles), {}, view<B>(samples), view<B>(hits)};
    }
};

template <backend B>
result<void> resolve(benchmark::State& state, B& device, const bundle_row& row) {
    const gather_work& work = work_of(row.scene, row.samples);
    const auto buffers = device_work<B>::create(device, work);
    if (!buffers) {
        return failure(buffers.error());
    }
    gather::resolver_options options;
    options.route = row.route;
    auto resolver =
        gather::bundle_resolver<B>::create(device, work.scene.triangles.size(), options);
    if (!resolver) {
        return failure(resolver.error());
    }
    const bundle_work<B> views = buffers->views();
    const auto pass = [&](std::uint32_t turn) {
        const ray_bundle bundle = resolver->bundle(work.box, axis_of(turn), work.lift);
        return run(device, [&](auto& recorder) { resolver->record(recorder, bundle, views); });
    };
    if (auto done = pass(0); !done) { // makes programs and touches pages
        return done;
    }
    std::uint32_t turn = 0;
    for (auto _ : state) {
        if (auto done = pass(turn++); !done) {
            return done;
        }
    }
    state.SetItemsProcessed(state.iterations() * row.samples);
    return {};
}

template <backend B>
void measure(benchmark::State& state, const bundle_row& row) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    if (const auto done = resolve(state, **device, row); !done) {
        state.SkipWithError(done.error().message.c_str());
    }
}

template <backend B>
void add(const std::string& method, const std::string& backend_name, gather::resolve_route route) {
    for (const char* scene : scenes::scene_names) {
        for (const std::uint32_t samples : {65536u, 1048576u}) {
            const std::string name = std::string("gather/bundle/") + method + "_" + backend_name +
                                     "/" + scene + "_" + std::to_string(samples);
            benchmark::RegisterBenchmark(name.c_str(), measure<B>,
                                         bundle_row{scene, samples, route})
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
}

const bool added = [] {
    add<cpu::device>("resolve", "cpu", gather::resolve_route::fastest);
    add<cpu::device>("composed", "cpu", gather::resolve_route::composed);
    add<opengl::device>("resolve", "opengl", gather::resolve_route::fastest);
    add<vulkan::device>("resolve", "vulkan", gather::resolve_route::fastest);
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
