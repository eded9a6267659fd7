// Bark: a coarse tube in, all edges split twice, every time anew.
//
//   trees/bark/BACKEND/TRIANGLES       two levels into lists of so many triangles, compact
//   trees/bark_padded/BACKEND/TRIANGLES  the same with degenerate padding
//
// Counters: triangles and bytes written a second (of the last list), and `floor`, the fraction of
// the speed at which the same run's CPU writes the same number of bytes.

#include "devices.hpp"
#include "floor.hpp"

#include <skybark/trees/bark_mesh.hpp>

#include <benchmark/benchmark.h>
#include <cmath>

namespace skybark::benchmarks {
namespace {

constexpr std::uint32_t sides = 32;
constexpr float edge = 0.1f; ///< m

/// A straight tube whose quads have sides of `edge`, as bark_mesh takes it.
template <backend B>
struct tube {
    struct part {
        typename B::buffer vertices;
        typename B::buffer indices;
        std::uint32_t index_count = 0;
    };
    std::vector<part> all;

    [[nodiscard]] std::span<const part> parts() const { return all; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        return {view<B>(p.indices), 0, p.index_count, 0, {}};
    }

    [[nodiscard]] static result<tube> make(B& device, std::uint64_t triangles) {
        const auto gaps = static_cast<std::uint32_t>(triangles / (2 * sides));
        const float radius = edge * static_cast<float>(sides) / 6.2831853f;
        std::vector<surface_vertex> vertices;
        std::vector<std::uint32_t> indices;
        for (std::uint32_t k = 0; k <= gaps; ++k) {
            for (std::uint32_t i = 0; i <= sides; ++i) {
                const double angle = 6.283185307179586 * (i % sides) / sides;
                surface_vertex v;
                v.normal = glm::vec3(glm::dvec3(std::cos(angle), 0, -std::sin(angle)));
                v.position = v.normal * radius + glm::vec3(0, edge * static_cast<float>(k), 0);
                v.u = static_cast<float>(i) / sides;
                v.v = v.position.y;
                v.tangent = {v.normal.z, 0, -v.normal.x, 1};
                vertices.push_back(v);
            }
        }
        for (std::uint32_t k = 0; k < gaps; ++k) {
            for (std::uint32_t i = 0; i < sides; ++i) {
                const std::uint32_t lower = k * (sides + 1) + i;
                const std::uint32_t upper = lower + sides + 1;
                indices.insert(indices.end(),
                               {upper, lower, upper + 1, upper + 1, lower, lower + 1});
            }
        }
        auto vertex_buffer = make_buffer<B, surface_vertex>(device, vertices);
        if (!vertex_buffer) {
            return failure(vertex_buffer.error());
        }
        auto index_buffer = make_buffer<B, std::uint32_t>(device, indices);
        if (!index_buffer) {
            return failure(index_buffer.error());
        }
        tube made;
        made.all.push_back({std::move(*vertex_buffer), std::move(*index_buffer),
                            static_cast<std::uint32_t>(indices.size())});
        return made;
    }
};

template <backend B>
void bark(benchmark::State& state, padding policy) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const auto mesh = tube<B>::make(**device, static_cast<std::uint64_t>(state.range(0)) / 16);
    if (!mesh) {
        state.SkipWithError(mesh.error().message.c_str());
        return;
    }
    trees::bark_options options;
    options.threshold = 0.45f * edge;
    options.most_passes = 2;
    options.policy = policy;
    const auto refined =
        trees::bark_mesh<B>::create(**device, *mesh, options, trees::furrowed_bark(1));
    if (!refined) {
        state.SkipWithError(refined.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        const auto done = run(**device, [&](auto& recorder) { refined->record(recorder, *mesh); });
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    const auto count = refined->count(**device);
    if (!count) {
        state.SkipWithError(count.error().message.c_str());
        return;
    }
    const std::uint64_t bytes = 3 * sizeof(surface_vertex) * count->written;
    const auto per_run = [](std::uint64_t n) {
        return benchmark::Counter(static_cast<double>(n),
                                  benchmark::Counter::kIsIterationInvariantRate);
    };
    state.counters["triangles"] = per_run(count->written);
    state.counters["bytes"] = per_run(bytes);
    const double floor = floor_seconds(**device_of<cpu::device>::get(), bytes);
    state.counters["floor"] =
        benchmark::Counter(floor, benchmark::Counter::kIsIterationInvariantRate);
}

template <class Function, class... Arguments>
void add(const std::string& name, Function function, Arguments... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
        ->Arg(100000)
        ->Arg(1000000)
        ->Arg(4000000)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

const bool registered = [] {
    add("trees/bark/cpu", bark<cpu::device>, padding::compact);
    add("trees/bark/vulkan", bark<vulkan::device>, padding::compact);
    add("trees/bark/opengl", bark<opengl::device>, padding::compact);
    add("trees/bark_padded/cpu", bark<cpu::device>, padding::degenerate);
    add("trees/bark_padded/vulkan", bark<vulkan::device>, padding::degenerate);
    add("trees/bark_padded/opengl", bark<opengl::device>, padding::degenerate);
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
