// Leaves: leaves, poses and air in, vertices out, every time anew, in wind.
//
//   trees/leaves/BACKEND/LEAVES        ten vertices and six triangles a leaf, shared indices
//   trees/leaves_list/BACKEND/LEAVES   three vertices a triangle; compact
//   trees/leaves_far/BACKEND/LEAVES    the list from so far that about one leaf in eight is left
//   trees/leaves/plain/LEAVES          the plain kernel on one thread, without vectors
//   trees/leaves/floor/LEAVES          writing the same bytes as the rings, all threads
//
// Counters: triangles a second (of full blades) and `floor`, the fraction of the speed at which the
// same run's CPU writes the same number of bytes.

#include "devices.hpp"
#include "floor.hpp"

#include <skybark/trees/leaf_mesh.hpp>

#include <benchmark/benchmark.h>
#include <glm/geometric.hpp>
#include <random>

namespace skybark::benchmarks {
namespace {

constexpr std::uint64_t triangles_a_leaf = 6;
constexpr std::uint64_t ring_bytes = 10 * sizeof(surface_vertex);

/// Ten leaves on each segment, in gusts.
struct crown {
    std::vector<leaf> leaves;
    std::vector<segment_pose> poses;
    std::vector<glm::vec4> air;

    explicit crown(std::size_t count) : leaves(count), poses(count / 10 + 1), air(poses.size()) {
        std::mt19937 random(7);
        const auto number = [&] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
        for (std::size_t i = 0; i < poses.size(); ++i) {
            poses[i].base = glm::vec3(number(), number(), number()) * 4.0f;
            poses[i].shift = glm::vec3(number(), number(), number()) * 0.1f;
            poses[i].rotation = glm::normalize(glm::vec4(number(), number(), number(), 8));
            const glm::vec3 wind(4 + number(), number(), number());
            air[i] = glm::vec4(wind, glm::length(wind));
        }
        for (std::size_t i = 0; i < count; ++i) {
            leaf& l = leaves[i];
            l.carrier = static_cast<std::uint32_t>(i / 10);
            l.position = poses[l.carrier].base + glm::vec3(number(), number(), number()) * 0.1f;
            l.orientation =
                glm::normalize(glm::vec4(number(), number(), number(), number() + 1.1f));
            l.length = 0.07f + 0.02f * number();
            l.width = 0.7f * l.length;
            l.fold = 0.2f;
            l.seed = static_cast<std::uint32_t>(random());
        }
    }
};

void report(benchmark::State& state, std::uint64_t leaves, std::uint64_t bytes) {
    state.counters["triangles"] = benchmark::Counter(static_cast<double>(leaves * triangles_a_leaf),
                                                     benchmark::Counter::kIsIterationInvariantRate);
    const double floor = floor_seconds(**device_of<cpu::device>::get(), bytes);
    state.counters["floor"] =
        benchmark::Counter(floor, benchmark::Counter::kIsIterationInvariantRate);
}

/// Carries an error out of the parts that a run needs.
template <backend B>
[[nodiscard]] result<void> run_leaves(benchmark::State& state, trees::mesh_form form, bool far) {
    const auto device = device_of<B>::get();
    if (!device) {
        return failure(device.error());
    }
    const crown on(static_cast<std::size_t>(state.range(0)));
    const auto poses = make_buffer<B, segment_pose>(**device, on.poses);
    if (!poses) {
        return failure(poses.error());
    }
    const auto air = make_buffer<B, glm::vec4>(**device, on.air);
    if (!air) {
        return failure(air.error());
    }
    trees::leaf_mesh_options options;
    options.form = form;
    const auto mesh = trees::leaf_mesh<B>::create(**device, on.leaves, options);
    if (!mesh) {
        return failure(mesh.error());
    }
    trees::view_detail view;
    view.camera = {0, 0, 80};
    view.pixels_per_radian = far ? 1000.0f : 0.0f; // 0.06 m there are 0.7 pixels
    double time = 0;
    for (auto _ : state) {
        const auto done = run(**device, [&](auto& recorder) {
            mesh->record(recorder, {skybark::view<B>(*poses), skybark::view<B>(*air), time}, view);
        });
        time += 1.0 / 60;
        if (!done) {
            return done;
        }
    }
    report(state, on.leaves.size(), on.leaves.size() * ring_bytes);
    return {};
}

template <backend B>
void leaves(benchmark::State& state, trees::mesh_form form, bool far) {
    if (auto done = run_leaves<B>(state, form, far); !done) {
        state.SkipWithError(done.error().message.c_str());
    }
}

void plain(benchmark::State& state) {
    const crown on(static_cast<std::size_t>(state.range(0)));
    std::vector<surface_vertex> vertices(10 * on.leaves.size());
    kernels::leaf_blade kernel;
    for (auto _ : state) {
        surface_vertex* to = vertices.data();
        for (std::uint32_t i = 0; i < on.leaves.size(); ++i) {
            kernel.ring(
                i, 0, 10, [&](const surface_vertex& v) { *to++ = v; },
                std::span<const leaf>(on.leaves), std::span<const segment_pose>(on.poses),
                std::span<const glm::vec4>(on.air));
        }
        kernel.time += 1u << 20;
        benchmark::ClobberMemory();
    }
    report(state, on.leaves.size(), on.leaves.size() * ring_bytes);
}

void floor_of_leaves(benchmark::State& state) {
    const auto count = static_cast<std::uint64_t>(state.range(0));
    const std::uint64_t bytes = count * ring_bytes / 64 * 64;
    cpu::device& device = **device_of<cpu::device>::get();
    auto buffer = device.create_buffer(bytes);
    if (!buffer) {
        state.SkipWithError(buffer.error().message.c_str());
        return;
    }
    for (auto _ : state) {
        write_floor(device, *buffer, bytes);
    }
    report(state, count, bytes);
}

template <class Function, class... Arguments>
void add(const std::string& name, Function function, Arguments... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
        ->Arg(10000)
        ->Arg(100000)
        ->Arg(1000000)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

template <backend B>
void add_backend(const std::string& name) {
    add("trees/leaves/" + name, leaves<B>, trees::mesh_form::rings, false);
    add("trees/leaves_list/" + name, leaves<B>, trees::mesh_form::list, false);
    add("trees/leaves_far/" + name, leaves<B>, trees::mesh_form::list, true);
}

const bool registered = [] {
    add("trees/leaves/floor", floor_of_leaves);
    add("trees/leaves/plain", plain);
    add_backend<cpu::device>("cpu");
    add_backend<vulkan::device>("vulkan");
    add_backend<opengl::device>("opengl");
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
