// What points on a scene's surfaces meet along one direction, or against it.
//
//   gather/bundle/METHOD_BACKEND/SCENE_SAMPLES
//       METHOD   resolve    exact at each point, as the backend does it fastest
//                composed   the same, of the patterns that all backends have
//                peel       the paper's layers of depth, in pictures of 1024 by 1024 pixels
//       SCENE    cornell, park, canopy: examples/scenes
//   gather/bundle/embree_…  rays traced one by one instead: benchmarks/embree/gather_bundle.cpp
//
// Points lie evenly on the surfaces, in Morton order. Each iteration takes the next of 64 axes, the
// same for all methods, and everything that a direction needs: nothing is built beforehand but by
// Embree. Items are points: rays that somebody asked for. `cpu_ms` is what all threads of the
// process spent on an iteration: where the machine is busy, a better measure than the time.
//
// For a table, with everything in one run on a machine that does nothing else, of the preset bench:
//   skybark_benchmarks
//   --benchmark_filter='^gather/bundle/((resolve|composed|peel)_|embree_(random|shared)/)'
//       --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
//       --benchmark_enable_random_interleaving=true --benchmark_min_time=0.5

#include "devices.hpp"
#include "gather_work.hpp"

#include <skybark/gather/bundle_peeler.hpp>
#include <skybark/gather/bundle_resolver.hpp>

#include <benchmark/benchmark.h>

namespace skybark::benchmarks {
namespace {

enum class bundle_method { resolve, composed, peel };

/// What one benchmark measures.
struct bundle_row {
    std::string scene;
    std::uint32_t samples;
    bundle_method method;
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

/// `pass(turn)` resolves the bundle of that turn.
template <class Pass>
[[nodiscard]] result<void> loop(benchmark::State& state, const bundle_row& row, Pass&& pass) {
    if (auto done = pass(0); !done) { // makes programs and touches pages
        return done;
    }
    const cpu_clock clock;
    std::uint32_t turn = 0;
    for (auto _ : state) {
        if (auto done = pass(turn++); !done) {
            return done;
        }
    }
    state.counters["cpu_ms"] = clock.milliseconds() / static_cast<double>(turn);
    state.SetItemsProcessed(state.iterations() * row.samples);
    return {};
}

template <backend B>
[[nodiscard]] result<void> resolve(benchmark::State& state, B& device, const bundle_row& row,
                                   const device_work<B>& buffers) {
    const gather_work& work = work_of(row.scene, row.samples);
    gather::resolver_options options;
    options.route = row.method == bundle_method::composed ? gather::resolve_route::composed
                                                          : gather::resolve_route::fastest;
    auto resolver =
        gather::bundle_resolver<B>::create(device, work.scene.triangles.size(), options);
    if (!resolver) {
        return failure(resolver.error());
    }
    return loop(state, row, [&](std::uint32_t turn) {
        const ray_bundle bundle = resolver->bundle(work.box, axis_of(turn), work.lift);
        return run(device,
                   [&](auto& recorder) { resolver->record(recorder, bundle, buffers.views()); });
    });
}

template <backend B>
[[nodiscard]] result<void> peel(benchmark::State& state, B& device, const bundle_row& row,
                                const device_work<B>& buffers) {
    const gather_work& work = work_of(row.scene, row.samples);
    auto peeler = gather::bundle_peeler<B>::create(device);
    if (!peeler) {
        return failure(peeler.error());
    }
    return loop(state, row, [&](std::uint32_t turn) -> result<void> {
        const ray_bundle bundle = peeler->bundle(work.box, axis_of(turn), work.lift);
        const auto layers = peeler->resolve(bundle, work.box, buffers.views());
        if (!layers) {
            return failure(layers.error());
        }
        state.counters["layers"] = *layers;
        return {};
    });
}

template <backend B>
[[nodiscard]] result<void> measure_on(benchmark::State& state, B& device, const bundle_row& row) {
    const auto buffers = device_work<B>::create(device, work_of(row.scene, row.samples));
    if (!buffers) {
        return failure(buffers.error());
    }
    return row.method == bundle_method::peel ? peel(state, device, row, *buffers)
                                             : resolve(state, device, row, *buffers);
}

template <backend B>
void measure(benchmark::State& state, const bundle_row& row) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    if (const auto done = measure_on(state, **device, row); !done) {
        state.SkipWithError(done.error().message.c_str());
    }
}

template <backend B>
void add(const std::string& backend_name) {
    const std::pair<const char*, bundle_method> methods[] = {{"resolve", bundle_method::resolve},
                                                             {"composed", bundle_method::composed},
                                                             {"peel", bundle_method::peel}};
    for (const auto& [method_name, method] : methods) {
        for (const char* scene : scenes::scene_names) {
            for (const std::uint32_t samples : {65536u, 1048576u}) {
                const std::string name = std::string("gather/bundle/") + method_name + "_" +
                                         backend_name + "/" + scene + "_" + std::to_string(samples);
                benchmark::RegisterBenchmark(name.c_str(), measure<B>,
                                             bundle_row{scene, samples, method})
                    ->Unit(benchmark::kMillisecond)
                    ->UseRealTime();
            }
        }
    }
}

const bool added = [] {
    add<cpu::device>("cpu");
    add<opengl::device>("opengl");
    add<vulkan::device>("vulkan");
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
