// What Embree does in place of a bundle's resolve (benchmarks/gather_bundle.cpp): one ray for each
// point, by the threads of the CPU's device.
//
//   gather/bundle/embree_random/SCENE_SAMPLES         random directions, as many as their cosine
//   gather/bundle/embree_shared/SCENE_SAMPLES         one direction for all, or against it
//   gather/bundle/embree_random_CALL/SCENE_SAMPLES    by one call: single, packet8, packet16 or
//   gather/bundle/embree_shared_CALL/SCENE_SAMPLES    stream; those without a CALL by the fastest
//
// Its best hierarchy, which is built before the clock starts; not the robust kind; denormals off.
// Rays of a shared direction are said to be coherent, and those along and against it go apart.

#include "../devices.hpp"
#include "../gather_work.hpp"
#include "tracing.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <memory>

namespace skybark::benchmarks {
namespace {

enum class ray_directions { random, shared };

/// What one pass is made of: a ray for each point.
struct embree_pass {
    RTCScene scene;
    const gather_work* work;
    ray_directions directions;
    std::uint32_t turn; ///< which directions
};

[[nodiscard]] RTCScene embree_of(const std::string& name) {
    static std::map<std::string, std::unique_ptr<scenes::embree_scene>> built;
    auto& scene = built[name];
    if (!scene) {
        scene = std::make_unique<scenes::embree_scene>(work_of(name, 65536).scene.triangles,
                                                       scenes::embree_build::fast);
    }
    return scene->get();
}

void trace_random(const embree_pass& pass, embree_call call, std::uint32_t first,
                  std::uint32_t count, std::span<gather_hit> hits) {
    static const cosine_directions directions;
    ray_chunk rays;
    for (std::uint32_t i = first; i < first + count; ++i) {
        const gather_sample& at = pass.work->samples[i];
        rays.add(at.position + pass.work->lift * at.normal,
                 directions.about(at.normal, i, pass.turn), i);
        if (rays.is_full() || i + 1 == first + count) {
            trace(pass.scene, call, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT, rays, hits);
        }
    }
}

void trace_shared(const embree_pass& pass, embree_call call, std::uint32_t first,
                  std::uint32_t count, std::span<gather_hit> hits) {
    const glm::vec3 axis = axis_of(pass.turn);
    ray_chunk along;
    ray_chunk against;
    for (std::uint32_t i = first; i < first + count; ++i) {
        const gather_sample& at = pass.work->samples[i];
        const bool is_along = glm::dot(at.normal, axis) >= 0;
        ray_chunk& rays = is_along ? along : against;
        rays.add(at.position + pass.work->lift * at.normal, is_along ? axis : -axis, i);
        if (rays.is_full()) {
            trace(pass.scene, call, RTC_INTERSECT_CONTEXT_FLAG_COHERENT, rays, hits);
        }
    }
    trace(pass.scene, call, RTC_INTERSECT_CONTEXT_FLAG_COHERENT, along, hits);
    trace(pass.scene, call, RTC_INTERSECT_CONTEXT_FLAG_COHERENT, against, hits);
}

void run_pass(cpu::device& device, const embree_pass& pass, embree_call call,
              std::span<gather_hit> hits) {
    device.for_pieces(hits.size(), 4096, [&](std::uint64_t first, std::uint64_t count) {
        const without_denormals guard;
        const auto from = static_cast<std::uint32_t>(first);
        const auto length = static_cast<std::uint32_t>(count);
        if (pass.directions == ray_directions::random) {
            trace_random(pass, call, from, length, hits);
        } else {
            trace_shared(pass, call, from, length, hits);
        }
    });
}

/// The call that takes the least time of the processor, of the medians of five passes each.
[[nodiscard]] embree_call fastest_call(cpu::device& device, embree_pass pass,
                                       std::span<gather_hit> hits) {
    embree_call best = embree_call::single;
    double least = 1e30;
    for (const embree_call call : embree_calls) {
        std::array<double, 5> spent{};
        for (std::uint32_t i = 0; i < spent.size(); ++i) {
            pass.turn = i;
            const cpu_clock clock;
            run_pass(device, pass, call, hits);
            spent[i] = clock.milliseconds();
        }
        std::nth_element(spent.begin(), spent.begin() + 2, spent.end());
        if (spent[2] < least) {
            least = spent[2];
            best = call;
        }
    }
    return best;
}

/// What one benchmark measures.
struct embree_row {
    std::string scene;
    std::uint32_t samples;
    ray_directions directions;
    int call; ///< index of an embree_call; −1: the fastest
};

void embree(benchmark::State& state, const embree_row& row) {
    cpu::device& device = **device_of<cpu::device>::get();
    embree_pass pass{embree_of(row.scene), &work_of(row.scene, row.samples), row.directions, 0};
    std::vector<gather_hit> hits(row.samples);
    const embree_call call =
        row.call < 0 ? fastest_call(device, pass, hits) : embree_calls[row.call];
    run_pass(device, pass, call, hits); // touches pages
    const cpu_clock clock;
    for (auto _ : state) {
        run_pass(device, pass, call, hits);
        ++pass.turn;
    }
    state.counters["cpu_ms"] = clock.milliseconds() / static_cast<double>(pass.turn);
    state.SetItemsProcessed(state.iterations() * row.samples);
    state.SetLabel(embree_call_names[static_cast<int>(call)]);
}

const bool added = [] {
    for (const char* scene : scenes::scene_names) {
        for (const std::uint32_t samples : {65536u, 1048576u}) {
            for (const ray_directions directions :
                 {ray_directions::random, ray_directions::shared}) {
                for (int call = -1; call < 4; ++call) {
                    std::string name = "gather/bundle/embree_";
                    name += directions == ray_directions::random ? "random" : "shared";
                    if (call >= 0) {
                        name += std::string("_") + embree_call_names[call];
                    }
                    name += std::string("/") + scene + "_" + std::to_string(samples);
                    benchmark::RegisterBenchmark(name.c_str(), embree,
                                                 embree_row{scene, samples, directions, call})
                        ->Unit(benchmark::kMillisecond)
                        ->UseRealTime();
                }
            }
        }
    }
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
