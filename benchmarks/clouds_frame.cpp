// What a frame of one cumulus takes when its light is made anew, part by part: particles and a
// cloud that stay on the device, another sun each time. On OpenGL and Vulkan with waiting for the
// device.
//
//   clouds/frame/PART_BACKEND/PARTICLES_VOLUME
//       PART    relight   the sun's attenuation volume: impulse_scan, erf
//               scatter   light that is scattered more than once, from that volume
//               draw      1280 × 720, one sample a pixel: sorting, sun, sky, scattered light
//               torn      the same by torn_billboards, a light for each particle
//               all       relight twice (sun, sky), scatter, draw
//       VOLUME  voxels along each side; scattered light has half as many
//
// `floor` is how many times as long it takes as writing the part's result once (a volume of
// floats, a picture of four floats) does on the CPU backend's device; `cpu_ms` what all threads of
// the process spent.

#include "devices.hpp"
#include "floor.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/cumulus.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/torn_billboards.hpp>

#include <benchmark/benchmark.h>
#include <ctime>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace skybark::benchmarks {
namespace {

enum class part { relight, scatter, draw, torn, all };

struct frame_row {
    part what = part::all;
    std::uint32_t particles = 0;
    std::uint32_t side = 0; ///< voxels
};

constexpr std::uint32_t width = 1280;
constexpr std::uint32_t height = 720;
constexpr glm::vec3 eye{200, 400, 2600};
constexpr glm::vec3 middle{0, 1300, 0};

[[nodiscard]] glm::vec3 sun(std::uint32_t turn) {
    const float angle = 0.7853982f * static_cast<float>(turn % 4);
    return {std::cos(angle), 0.8f, std::sin(angle)};
}

[[nodiscard]] std::vector<cloud_particle> cloud_of(std::uint32_t count) {
    clouds::cumulus_options options;
    options.particles = count;
    return clouds::cumulus_cloud(options);
}

/// A camera before the cloud, under an even sky.
[[nodiscard]] kernels::scene_record scene_of_cloud() {
    kernels::scene_record scene{};
    scene.to_clip = glm::perspectiveRH_ZO(0.7f, float{width} / float{height}, 1.0f, 1e5f) *
                    glm::lookAtRH(eye, middle, glm::vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(eye, 0);
    scene.sky.to_sun = glm::vec4(glm::normalize(sun(0)), 0);
    scene.sky.sunlight = glm::vec4(1);
    scene.ambient[0] = glm::vec4(0.3f);
    return scene;
}

/// All that a frame needs, made once.
template <volume_backend B>
class cloud_frame {
  public:
    [[nodiscard]] static result<cloud_frame> create(B& device, const frame_row& row) {
        cloud_frame made(row);
        const auto phase = clouds::phase_function::mie(10);
        made.options_.forward = static_cast<float>(phase->forward_energy());
        made.phase_ = *phase;
        clouds::multiple_scattering_options scattering;
        scattering.medium = {1, static_cast<float>(phase->mean_cosine()), made.options_.forward};
        scattering.share = clouds::share_of(scattering.medium);
        const glm::uvec3 voxels(row.side);
        const std::vector<kernels::scene_record> scene{scene_of_cloud()};
        bool done =
            keep(made.particles_, make_buffer<B, cloud_particle>(device, made.cloud_)) &&
            keep(made.scene_, make_buffer<B, kernels::scene_record>(device, scene)) &&
            keep(made.sun_, clouds::attenuation_volume<B>::create(device, voxels, made.options_)) &&
            keep(made.sky_, clouds::attenuation_volume<B>::create(device, voxels, made.options_)) &&
            keep(made.diffuse_,
                 clouds::multiple_scattering<B>::create(device, voxels, scattering)) &&
            keep(made.puffs_, clouds::cloud_billboards<B>::create(device, row.particles)) &&
            keep(made.torn_, clouds::torn_billboards<B>::create(device, row.particles)) &&
            keep(made.color_, device.create_image({width, height, image_format::rgba32f})) &&
            keep(made.depth_, device.create_image({width, height, image_format::depth32f}));
        if (!done) {
            return fail(error_code::out_of_memory, "The cloud's frame could not be made.");
        }
        return made;
    }

    /// Records one of the parts. Those after `relight` take the light of the latest one.
    void record(typename B::recorder& to, part what) {
        if (what == part::relight || what == part::all) {
            relight(to, *sun_, sun(turn_++));
        }
        if (what == part::all) {
            relight(to, *sky_, glm::vec3(0, 1, 0));
        }
        if (what == part::scatter || what == part::all) {
            diffuse_->solve(to, *sun_);
        }
        if (what == part::draw || what == part::all || what == part::torn) {
            draw(to, what == part::torn);
        }
    }

    /// What the part writes at least.
    [[nodiscard]] std::uint64_t bytes(part what) const {
        const std::uint64_t volume = std::uint64_t{row_.side} * row_.side * row_.side * 4;
        const std::uint64_t picture = std::uint64_t{width} * height * 16;
        switch (what) {
        case part::relight:
            return volume;
        case part::scatter:
            return volume / 8;
        case part::draw:
        case part::torn:
            return picture;
        case part::all:
            return 2 * volume + volume / 8 + picture;
        }
        return volume;
    }

  private:
    explicit cloud_frame(const frame_row& row) : row_(row), cloud_(cloud_of(row.particles)) {}

    template <class T>
    [[nodiscard]] static bool keep(std::optional<T>& to, result<T>&& made) {
        if (made) {
            to.emplace(std::move(*made));
        }
        return made.has_value();
    }

    void relight(typename B::recorder& to, clouds::attenuation_volume<B>& volume,
                 glm::vec3 to_sun) const {
        const auto box = clouds::fit_light_box(cloud_, to_sun, glm::uvec3(row_.side));
        volume.relight(to, view<B>(*particles_), row_.particles, *box);
    }

    void draw(typename B::recorder& to, bool is_torn) const {
        auto lighting = clouds::single_scattering(options_, sun_->box(), phase_);
        clouds::add_diffuse(lighting, diffuse_->grid(sun_->box()));
        clouds::add_sky(lighting, options_, sky_->box(), phase_);
        const clouds::cloud_light_sources<B> light{
            lighting, &sun_->volume(), &sky_->volume(), &diffuse_->fluence(), {}};
        const draw_target<B> target{&*color_, &*depth_, glm::vec4(0), 1.0f};
        const buffer_view<B> particles = view<B>(*particles_);
        if (is_torn) {
            torn_->record(to, {particles, particles, row_.particles}, eye, view<B>(*scene_), light,
                          kernels::torn_puff{}, target);
        } else {
            puffs_->record(to, particles, row_.particles, eye, view<B>(*scene_), light, target);
        }
    }

    frame_row row_;
    std::vector<cloud_particle> cloud_;
    clouds::attenuation_options options_;
    clouds::phase_function phase_;
    std::uint32_t turn_ = 0;
    std::optional<typename B::buffer> particles_; // all are there after create
    std::optional<typename B::buffer> scene_;
    std::optional<clouds::attenuation_volume<B>> sun_;
    std::optional<clouds::attenuation_volume<B>> sky_;
    std::optional<clouds::multiple_scattering<B>> diffuse_;
    std::optional<clouds::cloud_billboards<B>> puffs_;
    std::optional<clouds::torn_billboards<B>> torn_;
    std::optional<typename B::image> color_;
    std::optional<typename B::image> depth_;
};

constexpr std::pair<part, const char*> parts[] = {{part::relight, "relight"},
                                                  {part::scatter, "scatter"},
                                                  {part::draw, "draw"},
                                                  {part::torn, "torn"},
                                                  {part::all, "all"}};

template <volume_backend B>
void measure(benchmark::State& state, const frame_row& row) {
    const auto device = device_of<B>::get();
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    auto frame = cloud_frame<B>::create(**device, row);
    if (!frame) {
        state.SkipWithError(frame.error().message.c_str());
        return;
    }
    const auto once = [&](part what) {
        return run(**device, [&](auto& recorder) { frame->record(recorder, what); });
    };
    // Makes programs, and the light that the parts take.
    if (auto done = once(part::all); !done || !once(row.what)) {
        state.SkipWithError("The cloud's frame could not be drawn.");
        return;
    }
    const std::clock_t cpu = std::clock();
    const auto begin = std::chrono::steady_clock::now();
    for (auto _ : state) {
        if (auto done = once(row.what); !done) {
            state.SkipWithError(done.error().message.c_str());
            return;
        }
    }
    const double frames = static_cast<double>(state.iterations());
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / frames;
    state.counters["cpu_ms"] =
        1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / frames;
    cpu::device host;
    state.counters["floor"] = seconds / floor_seconds(host, frame->bytes(row.what));
}

template <volume_backend B>
void add(const std::string& backend_name) {
    for (const auto& [what, name] : parts) {
        for (const auto& [particles, side] : {std::pair{20000u, 128u}, std::pair{60134u, 256u}}) {
            benchmark::RegisterBenchmark(("clouds/frame/" + std::string(name) + "_" + backend_name +
                                          "/" + std::to_string(particles) + "_" +
                                          std::to_string(side))
                                             .c_str(),
                                         measure<B>, frame_row{what, particles, side})
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
}

const bool registered = [] {
    add<cpu::device>("cpu");
    add<vulkan::device>("vulkan");
    add<opengl::device>("opengl");
    return true;
}();

} // namespace
} // namespace skybark::benchmarks
