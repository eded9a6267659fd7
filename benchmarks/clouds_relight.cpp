// Changes of a cloud's light (Shimada et al. 2008, table 1): particles and another sun in, the
// whole attenuation volume out, every time anew. On OpenGL and Vulkan with waiting for the device.
//
//   clouds/relight/METHOD_BACKEND/PARTICLES_VOLUME
//       METHOD  harris                 Harris's pass: one particle after another, read back
//               shadow_polygons        the paper's, step profile, a list of rectangles, compact
//               impulse_scan           an impulse for each particle and one running sum, step
//               impulse_scan_erf       the same through the Gaussian body
//               and others: shadow_polygons_erf, _list_degenerate, _stage; OpenGL's
//               _ROUTE_PADDING, drawn with blending; impulse_scan_erf_float16
//       VOLUME  voxels along each side
//   clouds/by_particles/METHOD_BACKEND/N   against the number of particles, 128 voxels a side
//   clouds/by_radius/METHOD_BACKEND/R      against the radius, in thousandths of the box
//   clouds/by_volume/METHOD_BACKEND/V      against the voxels a side; both of 16,000 particles
//   clouds/floor/BACKEND/VOLUME            writing the volume once: all that any method must do
//   clouds/fit/PARTICLES                   fitting the box on the host, which the others leave out
//
// Particles lie evenly in a ball that fills the box, their radius 3 % of it, the mean depth 7.
// Counters: particles a second; `floor`, how many times the floor of the same device it takes; and
// `harris`, how many times faster it is than Harris's pass on the same device: of up to 3,000 of
// the particles, and taken in proportion. Both are of the median of the iterations. `cpu_ms` is
// what all threads of the process spent on one: where the machine is busy, a better measure of a
// device in software than the time.
//
// What takes long without need runs only if the filter names its particles and volume, such as
// --benchmark_filter='clouds/relight/.*/1000000_128'. docs/figures/make draws the results.

#include "devices.hpp"
#include "floor.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/harris.hpp>

#include <benchmark/benchmark.h>
#include <ctime>
#include <functional>
#include <map>
#include <random>
#include <tuple>

namespace skybark::benchmarks {
namespace {

enum class method { harris, shadow_polygons, impulse_scan };

/// What one benchmark measures.
struct relight_row {
    method by = method::impulse_scan;
    std::uint32_t particles = 0;
    std::uint32_t side = 0;      ///< voxels
    std::uint32_t permille = 30; ///< the radius over the box
    clouds::attenuation_options options;
    bool only_if_named = false;
    bool against_harris = false;
};

/// A cloud, and its boxes for some suns.
struct lit_cloud {
    std::vector<cloud_particle> particles;
    std::vector<clouds::light_box> boxes;
};

/// Particles evenly in a ball of diameter 1 that they fill.
[[nodiscard]] std::vector<cloud_particle> ball_of(std::uint32_t count, std::uint32_t permille) {
    std::mt19937 random(7);
    const auto number = [&] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
    const float radius = static_cast<float>(permille) / 1000;
    const float reach = 0.5f - radius;
    const float sigma = radius / 3;
    // A particle's depth over the plane comes to 2 pi sigma^2, the ball's disk to pi reach^2.
    const float depth = 7 * reach * reach / (2 * sigma * sigma * static_cast<float>(count));
    std::vector<cloud_particle> particles(count);
    for (cloud_particle& p : particles) {
        glm::vec3 at;
        do {
            at = {number(), number(), number()};
        } while (glm::dot(at, at) > 1);
        p.position = at * reach;
        p.radius = radius;
        p.optical_depth = depth;
        p.albedo = 0.99f;
    }
    return particles;
}

[[nodiscard]] glm::vec3 sun(std::uint32_t i) {
    const float angle = 0.7853982f * static_cast<float>(i);
    return {std::cos(angle), 0.3f + 0.2f * static_cast<float>(i), std::sin(angle)};
}

[[nodiscard]] const lit_cloud& cloud_of(const relight_row& row) {
    static std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, lit_cloud> made;
    lit_cloud& cloud = made[{row.particles, row.permille, row.side}];
    if (cloud.particles.empty()) {
        cloud.particles = ball_of(row.particles, row.permille);
        for (std::uint32_t i = 0; i < 4; ++i) {
            cloud.boxes.push_back(
                *clouds::fit_light_box(cloud.particles, sun(i), glm::uvec3(row.side)));
        }
    }
    return cloud;
}

[[nodiscard]] double seconds_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// The first time makes what later ones have; the median of the others.
[[nodiscard]] double median_seconds(int times, const std::function<void()>& work) {
    work();
    std::vector<double> seconds;
    for (int i = 0; i < times; ++i) {
        seconds.push_back(seconds_of(work));
    }
    std::nth_element(seconds.begin(), seconds.begin() + times / 2, seconds.end());
    return seconds[static_cast<std::size_t>(times / 2)];
}

/// Writes every voxel once, as the backend does it fastest: an accumulation of nothing, from zero.
template <volume_backend B>
[[nodiscard]] result<void> clear_volume(B& device, const typename B::volume& volume,
                                        const typename B::buffer& unused) {
    return run(device, [&](auto& recorder) {
        recorder.accumulate(kernels::particle_impulse{}, {view<B>(unused)}, range{0, 0},
                            accumulation<B>{&volume, true});
    });
}

/// Seconds of the floor.
template <volume_backend B>
[[nodiscard]] double volume_floor(B& device, std::uint32_t side) {
    static std::map<std::uint32_t, double> known;
    double& seconds = known[side];
    if (seconds != 0) {
        return seconds;
    }
    if constexpr (std::same_as<B, cpu::device>) {
        seconds = floor_seconds(device, std::uint64_t{side} * side * side * 4);
    } else {
        const auto volume = device.create_volume({side, side, side, volume_format::int32});
        const auto unused = device.create_buffer(sizeof(cloud_particle));
        if (volume && unused) {
            seconds = median_seconds(9, [&] { (void)clear_volume(device, *volume, *unused); });
        }
    }
    return seconds;
}

/// Seconds that a particle takes in Harris's pass.
template <volume_backend B>
[[nodiscard]] double harris_seconds(B& device, const relight_row& row) {
    static std::map<std::pair<std::uint32_t, std::uint32_t>, double> known;
    double& seconds = known[{row.side, row.permille}];
    if (seconds != 0) {
        return seconds;
    }
    const lit_cloud& cloud = cloud_of(row);
    const std::uint32_t count = std::min(row.particles, 3000u);
    const auto particles =
        make_buffer<B, cloud_particle>(device, std::span(cloud.particles).first(count));
    auto light = clouds::harris_light<B>::create(device, row.side, row.side, count);
    if (particles && light) {
        seconds =
            median_seconds(
                3, [&] { (void)light->relight(view<B>(*particles), count, cloud.boxes[0]); }) /
            count;
    }
    return seconds;
}

/// Seconds of a change, the median of the iterations.
template <class Change>
[[nodiscard]] result<double> loop(benchmark::State& state, Change&& change) {
    std::vector<double> seconds;
    const std::clock_t before = std::clock();
    for (auto _ : state) {
        result<void> done;
        seconds.push_back(seconds_of([&] { done = change(); }));
        if (!done) {
            return failure(done.error());
        }
    }
    state.counters["cpu_ms"] = 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC /
                               static_cast<double>(seconds.size());
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
}

template <volume_backend B>
[[nodiscard]] result<double> run_harris(benchmark::State& state, B& device,
                                        const relight_row& row) {
    const lit_cloud& cloud = cloud_of(row);
    const auto particles = make_buffer<B, cloud_particle>(device, cloud.particles);
    if (!particles) {
        return failure(particles.error());
    }
    auto light = clouds::harris_light<B>::create(device, row.side, row.side, row.particles);
    if (!light) {
        return failure(light.error());
    }
    std::size_t turn = 0;
    const auto change = [&](std::uint32_t count) {
        const clouds::light_box& box = cloud.boxes[turn++ % cloud.boxes.size()];
        return light->relight(view<B>(*particles), count, box);
    };
    if (auto done = change(1); !done) { // makes programs
        return failure(done.error());
    }
    return loop(state, [&] { return change(row.particles); });
}

template <volume_backend B>
[[nodiscard]] result<double> run_volume(benchmark::State& state, B& device,
                                        const relight_row& row) {
    const lit_cloud& cloud = cloud_of(row);
    const auto particles = make_buffer<B, cloud_particle>(device, cloud.particles);
    if (!particles) {
        return failure(particles.error());
    }
    auto volume = clouds::attenuation_volume<B>::create(device, glm::uvec3(row.side), row.options);
    if (!volume) {
        return failure(volume.error());
    }
    std::size_t turn = 0;
    const auto change = [&](std::uint32_t count) {
        const clouds::light_box& box = cloud.boxes[turn++ % cloud.boxes.size()];
        return run(device, [&](auto& recorder) {
            volume->relight(recorder, view<B, cloud_particle>(*particles, 0, count), count, box);
        });
    };
    if (auto done = change(1); !done) { // makes programs and touches pages
        return failure(done.error());
    }
    return loop(state, [&] { return change(row.particles); });
}

template <volume_backend B>
void report(benchmark::State& state, B& device, const relight_row& row, double seconds) {
    state.SetItemsProcessed(state.iterations() * row.particles);
    state.counters["floor"] = seconds / volume_floor(device, row.side);
    if (row.against_harris) {
        state.counters["harris"] = harris_seconds(device, row) * row.particles / seconds;
    }
}

[[nodiscard]] bool is_named(const relight_row& row) {
    const std::string size = std::to_string(row.particles) + "_" + std::to_string(row.side);
    return benchmark::GetBenchmarkFilter().find(size) != std::string::npos;
}

template <volume_backend B>
void relight(benchmark::State& state, const relight_row& row) {
    if (row.only_if_named && !is_named(row)) {
        state.SkipWithError("takes long: runs if the filter names the particles and the volume");
        return;
    }
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const result<double> seconds = row.by == method::harris ? run_harris(state, **device, row)
                                                            : run_volume(state, **device, row);
    if (!seconds) {
        state.SkipWithError(seconds.error().message.c_str());
        return;
    }
    report(state, **device, row, *seconds);
}

template <volume_backend B>
void floor_of_volume(benchmark::State& state, std::uint32_t side) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    const std::uint64_t bytes = std::uint64_t{side} * side * side * 4;
    if constexpr (std::same_as<B, cpu::device>) {
        const auto buffer = (*device)->create_buffer(bytes);
        if (!buffer) {
            state.SkipWithError(buffer.error().message.c_str());
            return;
        }
        write_floor(**device, *buffer, bytes);
        for (auto _ : state) {
            write_floor(**device, *buffer, bytes);
        }
    } else {
        const auto volume = (*device)->create_volume({side, side, side, volume_format::int32});
        const auto unused = (*device)->create_buffer(sizeof(cloud_particle));
        if (!volume || !unused || !clear_volume(**device, *volume, *unused)) {
            state.SkipWithError("The volume could not be made.");
            return;
        }
        for (auto _ : state) {
            (void)clear_volume(**device, *volume, *unused);
        }
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void fit(benchmark::State& state, std::uint32_t count) {
    const auto particles = ball_of(count, 30);
    std::uint32_t turn = 0;
    for (auto _ : state) {
        auto box = clouds::fit_light_box(particles, sun(turn++ % 4), glm::uvec3(256));
        benchmark::DoNotOptimize(box);
    }
    state.SetItemsProcessed(state.iterations() * count);
}

template <class Function, class... Arguments>
void add(const std::string& name, Function function, Arguments... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

/// A method by name.
struct named_method {
    std::string name;
    relight_row row;
};

[[nodiscard]] named_method with(std::string name, method by,
                                const std::function<void(clouds::attenuation_options&)>& change) {
    named_method m{std::move(name), {}};
    m.row.by = by;
    m.row.options.profile = clouds::attenuation_profile::step;
    m.row.options.forward = 0.72f;
    m.row.options.method = by == method::impulse_scan ? clouds::attenuation_method::impulse_scan
                                                      : clouds::attenuation_method::shadow_polygons;
    change(m.row.options);
    return m;
}

/// Those that every table has.
[[nodiscard]] std::vector<named_method> main_methods() {
    using options = clouds::attenuation_options;
    return {with("harris", method::harris, [](options&) {}),
            with("shadow_polygons", method::shadow_polygons, [](options&) {}),
            with("impulse_scan", method::impulse_scan, [](options&) {}),
            with("impulse_scan_erf", method::impulse_scan,
                 [](options& o) { o.profile = clouds::attenuation_profile::erf; })};
}

[[nodiscard]] std::vector<named_method> other_methods(bool drawn) {
    using options = clouds::attenuation_options;
    std::vector<named_method> all{
        with("impulse_scan_erf_float16", method::impulse_scan,
             [](options& o) {
                 o.profile = clouds::attenuation_profile::erf;
                 o.format = volume_format::float16;
             }),
        with("shadow_polygons_erf", method::shadow_polygons,
             [](options& o) { o.profile = clouds::attenuation_profile::erf; }),
        with("shadow_polygons_list_degenerate", method::shadow_polygons,
             [](options& o) { o.policy = padding::degenerate; }),
        with("shadow_polygons_stage", method::shadow_polygons,
             [](options& o) { o.polygons = clouds::polygon_source::stage; })};
    const std::pair<const char*, accumulate_route> routes[] = {
        {"tiles_copied", accumulate_route::tiles_copied},
        {"tiles_drawn", accumulate_route::tiles_drawn},
        {"layers", accumulate_route::layers}};
    for (const auto& named : routes) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            if (drawn) {
                const char* padded = policy == padding::compact ? "_compact" : "_degenerate";
                all.push_back(with(std::string("shadow_polygons_") + named.first + padded,
                                   method::shadow_polygons, [&](options& o) {
                                       o.polygons = clouds::polygon_source::stage;
                                       o.route = named.second;
                                       o.policy = policy;
                                   }));
            }
        }
    }
    return all;
}

constexpr std::uint32_t particle_counts[] = {9382, 32914, 60134, 1000000};
constexpr std::uint32_t volume_sides[] = {128, 256, 384};

/// Voxels under the rectangles of a row: twice the radius wide and deep, and half as high as the
/// volume.
[[nodiscard]] double covered_voxels(const relight_row& row) {
    const double wide = 0.002 * row.permille * row.side;
    return 0.5 * row.particles * wide * wide * row.side;
}

template <volume_backend B>
void add_table(const std::string& backend_name, named_method m, bool is_main) {
    for (const std::uint32_t count : particle_counts) {
        for (const std::uint32_t side : volume_sides) {
            m.row.particles = count;
            m.row.side = side;
            m.row.against_harris = true;
            const bool is_slow =
                (m.row.by == method::harris && count == 1000000) ||
                (m.row.by == method::shadow_polygons && covered_voxels(m.row) > 2e9);
            const bool is_typical =
                (count == 60134 && side == 256) || (count == 9382 && side == 128);
            m.row.only_if_named = is_slow || !(is_main || is_typical);
            add("clouds/relight/" + m.name + "_" + backend_name + "/" + std::to_string(count) +
                    "_" + std::to_string(side),
                relight<B>, m.row);
        }
    }
}

/// Rows for curves: one of particles, radius and voxels varies.
template <volume_backend B>
void add_curves(const std::string& backend_name, const named_method& m) {
    const auto add_row = [&](const char* by, std::uint32_t value, const relight_row& row) {
        const std::uint32_t most = std::same_as<B, cpu::device> ? 256000 : 16000;
        const bool takes_long = (row.by == method::harris && row.particles > most) ||
                                (row.by == method::shadow_polygons && covered_voxels(row) > 3e8);
        if (!takes_long) {
            add("clouds/by_" + std::string(by) + "/" + m.name + "_" + backend_name + "/" +
                    std::to_string(value),
                relight<B>, row);
        }
    };
    relight_row row = m.row;
    row.side = 128;
    for (const std::uint32_t count : {1000u, 4000u, 16000u, 64000u, 256000u, 1000000u}) {
        row.particles = count;
        add_row("particles", count, row);
    }
    row.particles = 16000;
    for (const std::uint32_t permille : {10u, 15u, 20u, 30u, 45u, 60u, 80u}) {
        row.permille = permille;
        add_row("radius", permille, row);
    }
    row.permille = 30;
    for (const std::uint32_t side : {64u, 96u, 128u, 192u, 256u, 384u}) {
        row.side = side;
        add_row("volume", side, row);
    }
}

template <volume_backend B>
void add_backend(const std::string& name, bool drawn) {
    for (const std::uint32_t side : volume_sides) {
        add("clouds/floor/" + name + "/" + std::to_string(side), floor_of_volume<B>, side);
    }
    for (const named_method& m : main_methods()) {
        add_table<B>(name, m, true);
        add_curves<B>(name, m);
    }
    for (const named_method& m : other_methods(drawn)) {
        add_table<B>(name, m, false);
    }
}

const bool registered = [] {
    add_backend<cpu::device>("cpu", false);
    add_backend<vulkan::device>("vulkan", false);
    add_backend<opengl::device>("opengl", true);
    for (const std::uint32_t count : particle_counts) {
        add("clouds/fit/" + std::to_string(count), fit, count);
    }
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
