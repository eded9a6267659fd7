#pragma once
// The meadow command on a device of any backend.

#include "meadow_job.hpp"

namespace skybark::tool {

namespace detail {

/// Trees sway for so long before the first frame, in s: from rest, gusts have reached all by then.
inline constexpr double settling_time = 4;

/// How far a job of many frames is, on the terminal.
inline void show_progress(meadow_job& job, std::uint32_t frame) {
    if (job.options.frames > 1) {
        job.time.advance(static_cast<double>(frame) / job.options.frames,
                         "frame " + std::to_string(frame + 1) + " of " +
                             std::to_string(job.options.frames));
    }
}

/// Each stage on its own, so that it can be timed.
template <backend B>
[[nodiscard]] result<void> make_frame(B& device, meadow::meadow<B>& scene, meadow_job& job,
                                      std::uint32_t frame) {
    scene.begin_frame(settling_time + job.options.seconds_of(frame));
    for (const meadow::stage which : meadow::stages) {
        job.time.begin(meadow::stage_names[static_cast<std::size_t>(which)]);
        show_progress(job, frame);
        bool again = true;
        while (again) {
            auto done = run(device, [&](auto& recorder) { scene.record(recorder, which); });
            if (!done) {
                return done;
            }
            again = false;
            if (which == meadow::stage::mesh) { // once more where there was too little room
                const auto grown = scene.update();
                if (!grown) {
                    return failure(grown.error());
                }
                again = *grown;
            }
        }
    }
    return {};
}

} // namespace detail

/// Grows the meadow, and draws its frames. `driver` is what the report says of the device.
template <backend B>
[[nodiscard]] result<void> make_meadow(B& device, meadow_job& job, std::string driver) {
    job.device = device.device_name();
    job.driver = std::move(driver);
    const meadow_options& wanted = job.options;
    job.time.begin("grow");
    auto scene = meadow::meadow<B>::create(device, wanted.what, wanted.now, wanted.from);
    if (!scene) {
        return failure(scene.error());
    }
    scene->look(wanted.from, wanted.lod);
    job.holds = scene->holds();
    job.time.begin("settle");
    if (auto done = scene->settle(detail::settling_time + wanted.seconds_of(0)); !done) {
        return done;
    }
    frame_files files(job.out, wanted.what.width, wanted.what.height, wanted.frames, wanted.fps);
    for (std::uint32_t frame = 0; frame < wanted.frames; ++frame) {
        auto done = detail::make_frame(device, *scene, job, frame);
        if (!done) {
            return done;
        }
        job.time.begin("write");
        const auto pixels = scene->download();
        if (!pixels) {
            return failure(pixels.error());
        }
        done = wanted.output == frame_output::together ? files.add(*pixels)
               : wanted.output == frame_output::numbered
                   ? files.write(wanted.name.of(frame), *pixels)
                   : files.write(job.out, *pixels);
        if (!done) {
            return done;
        }
    }
    const auto triangles = scene->triangles();
    if (!triangles) {
        return failure(triangles.error());
    }
    job.triangles = *triangles;
    job.traffic = device.traffic();
    return files.commit();
}

} // namespace skybark::tool
