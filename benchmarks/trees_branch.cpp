// Branches: ends and segments in, vertices out, every time anew.
//
//   trees/branch/BACKEND/TRIANGLES       ring vertices under a shared index buffer
//   trees/branch_list/BACKEND/TRIANGLES  three vertices a triangle (OpenGL: triangle strips, as in
//                                        the paper); compact
//   trees/branch_list/paper/TRIANGLES    the paper's CPU path: scalar, one thread, a triangle list
//   trees/branch/paper/TRIANGLES         the same loop over ring vertices
//   trees/branch/floor/TRIANGLES         writing the same bytes as the rings, all threads
//
// Counters: triangles and bytes a second, and `floor`, the fraction of the speed at which the same
// run's CPU writes the same number of bytes.

#include "devices.hpp"
#include "floor.hpp"

#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <benchmark/benchmark.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>

namespace skybark::benchmarks {
namespace {

constexpr std::uint32_t sides = 8;
constexpr std::uint32_t rings = 4;
constexpr std::uint64_t triangles_a_segment = 2 * sides * (rings - 1);

/// Chains of eight segments that wander, so many that their tubes have this many triangles.
const trees::skeleton& wandering_chains(std::uint64_t triangles) {
    static std::map<std::uint64_t, trees::skeleton> made;
    trees::skeleton& skeleton = made[triangles];
    if (!skeleton.empty()) {
        return skeleton;
    }
    std::mt19937 random(7);
    const auto number = [&] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
    std::vector<trees::segment> segments(triangles / triangles_a_segment);
    glm::vec3 place(0);
    glm::vec3 heading(0, 1, 0);
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
        const bool starts = i % 8 == 0;
        if (starts) {
            place = glm::vec3(number(), number(), number()) * 10.0f;
            heading = glm::vec3(number(), 2, number());
        }
        heading = glm::normalize(heading + glm::vec3(number(), number(), number()) * 0.3f);
        const float thick = 0.1f * (1.0f - 0.1f * static_cast<float>(i % 8));
        segments[i] = {place, place + heading * 0.5f, thick, thick - 0.01f,
                       starts ? trees::none : i - 1};
        place = segments[i].tip;
    }
    skeleton = std::move(*trees::build_skeleton(segments));
    return skeleton;
}

void report(benchmark::State& state, std::uint64_t triangles, std::uint64_t bytes) {
    const auto per_run = [&](std::uint64_t n) {
        return benchmark::Counter(static_cast<double>(n),
                                  benchmark::Counter::kIsIterationInvariantRate);
    };
    state.counters["triangles"] = per_run(triangles);
    state.counters["bytes"] = per_run(bytes);
    const double floor = floor_seconds(**device_of<cpu::device>::get(), bytes);
    state.counters["floor"] =
        benchmark::Counter(floor, benchmark::Counter::kIsIterationInvariantRate);
}

template <backend B>
void branch(benchmark::State& state, trees::mesh_form form) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const auto& skeleton = wandering_chains(static_cast<std::uint64_t>(state.range(0)));
    trees::branch_mesh_options options;
    options.sides = sides;
    options.rings = rings;
    options.form = form;
    const auto mesh = trees::branch_mesh<B>::create(**device, skeleton, options);
    if (!mesh) {
        state.SkipWithError(mesh.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        const auto done = run(**device, [&](auto& recorder) { mesh->record(recorder); });
        if (!done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    report(state, mesh->triangles(), mesh->vertices() * sizeof(surface_vertex));
}

/// The paper's CPU path as one would write it down: trigonometry per ring, one thread, no vectors.
class paper_mesher {
  public:
    explicit paper_mesher(const trees::branch_layout& layout) : layout_(layout) {
        for (std::uint32_t i = 0; i <= sides; ++i) {
            const float angle = 6.2831853f * static_cast<float>(i) / sides;
            cosine_[i] = std::cos(angle);
            sine_[i] = std::sin(angle);
        }
    }

    void rings_of(std::size_t segment, surface_vertex* to) const {
        const branch_end& a = layout_.ends[layout_.segments[segment].start];
        const branch_end& b = layout_.ends[layout_.segments[segment].end];
        const glm::quat q1 = quaternion(a);
        const glm::quat q2 = quaternion(b);
        const float chord = glm::distance(a.position, b.position);
        const glm::vec3 n1 = q1 * glm::vec3(0, chord, 0);
        const glm::vec3 n2 = q2 * glm::vec3(0, chord, 0);
        for (std::uint32_t k = 0; k < rings; ++k) {
            const float t = static_cast<float>(k) / (rings - 1);
            const float s = 1 - t;
            const glm::vec3 centre = a.position * ((1 + 2 * t) * s * s) + n1 * (t * s * s) +
                                     b.position * (t * t * (3 - 2 * t)) - n2 * (t * t * s);
            const glm::quat q = glm::slerp(q1, q2, t);
            const glm::vec3 x = q * glm::vec3(1, 0, 0);
            const glm::vec3 z = q * glm::vec3(0, 0, 1);
            const float radius = a.radius * s + b.radius * t;
            const float path = a.path * s + b.path * t;
            for (std::uint32_t i = 0; i <= sides; ++i) {
                const glm::vec3 outward = x * cosine_[i] - z * sine_[i];
                const glm::vec3 around = x * -sine_[i] - z * cosine_[i];
                *to++ = {centre + outward * radius, static_cast<float>(i) / sides, outward, path,
                         glm::vec4(around, 1)};
            }
        }
    }

    void triangles_of(std::size_t segment, surface_vertex* to) const {
        surface_vertex vertices[rings * (sides + 1)];
        rings_of(segment, vertices);
        for (std::uint32_t k = 0; k + 1 < rings; ++k) {
            for (std::uint32_t i = 0; i < sides; ++i) {
                const surface_vertex* lower = vertices + k * (sides + 1) + i;
                const surface_vertex* upper = lower + sides + 1;
                for (const surface_vertex* corner :
                     {upper, lower, upper + 1, upper + 1, lower, lower + 1}) {
                    *to++ = *corner;
                }
            }
        }
    }

  private:
    [[nodiscard]] static glm::quat quaternion(const branch_end& end) {
        return {end.orientation.w, end.orientation.x, end.orientation.y, end.orientation.z};
    }

    const trees::branch_layout& layout_;
    float cosine_[sides + 1];
    float sine_[sides + 1];
};

void paper(benchmark::State& state, trees::mesh_form form) {
    const auto& skeleton = wandering_chains(static_cast<std::uint64_t>(state.range(0)));
    const auto layout = trees::layout_branches(skeleton, kernels::branch_frame::slerp);
    const paper_mesher mesher(layout);
    const bool list = form == trees::mesh_form::list;
    const std::size_t each = list ? 3 * triangles_a_segment : rings * (sides + 1);
    std::vector<surface_vertex> vertices(layout.segments.size() * each);
    for (auto _ : state) {
        for (std::size_t i = 0; i < layout.segments.size(); ++i) {
            surface_vertex* to = vertices.data() + i * each;
            list ? mesher.triangles_of(i, to) : mesher.rings_of(i, to);
        }
        benchmark::ClobberMemory();
    }
    report(state, layout.segments.size() * triangles_a_segment,
           vertices.size() * sizeof(surface_vertex));
}

void floor_of_rings(benchmark::State& state) {
    const auto triangles = static_cast<std::uint64_t>(state.range(0));
    const std::uint64_t bytes =
        triangles / triangles_a_segment * rings * (sides + 1) * sizeof(surface_vertex) / 64 * 64;
    cpu::device& device = **device_of<cpu::device>::get();
    auto buffer = device.create_buffer(bytes);
    if (!buffer) {
        state.SkipWithError(buffer.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        write_floor(device, *buffer, bytes);
    }
    report(state, triangles, bytes);
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
    using trees::mesh_form;
    add("trees/branch/floor", floor_of_rings);
    add("trees/branch/cpu", branch<cpu::device>, mesh_form::rings);
    add("trees/branch/vulkan", branch<vulkan::device>, mesh_form::rings);
    add("trees/branch/opengl", branch<opengl::device>, mesh_form::rings);
    add("trees/branch/paper", paper, mesh_form::rings);
    add("trees/branch_list/cpu", branch<cpu::device>, mesh_form::list);
    add("trees/branch_list/vulkan", branch<vulkan::device>, mesh_form::list);
    add("trees/branch_list/opengl", branch<opengl::device>, mesh_form::list);
    add("trees/branch_list/paper", paper, mesh_form::list);
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
