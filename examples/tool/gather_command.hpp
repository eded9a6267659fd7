#pragma once
// The gather command on a device of any backend.

#include "gather_job.hpp"

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <io/write_png.hpp>
#include <picture/daylight.hpp>
#include <picture/gather_picture.hpp>
#include <skybark/gather/bounces.hpp>

#include <chrono>
#include <cstdio>
#include <optional>

namespace skybark::tool {

/// The job's light on a device.
template <gather::gathers B>
class light_gatherer {
  public:
    light_gatherer(B& device, gather_job& job)
        : device_(device), job_(job), options_(job.options) {}

    /// Everything that the job asks for.
    [[nodiscard]] result<void> make() {
        auto done = build();
        if (done && is_picture()) {
            done = see();
        }
        if (done && options_.bounces != 0) {
            done = bounce();
        }
        if (done) {
            done = gather();
        }
        if (!done) {
            return done;
        }
        if (is_picture()) {
            return draw();
        }
        job_.time.begin("write");
        return write_light(job_, light_);
    }

  private:
    [[nodiscard]] bool is_picture() const { return options_.places == gather_places::pixels; }

    // ---- The scene -----------------------------------------------------------------------------

    [[nodiscard]] result<void> build() {
        job_.time.begin("build");
        gather::scene_description what;
        what.triangles = job_.triangles;
        what.materials = job_.materials;
        what.alpha = job_.alpha;
        what.patch_size = job_.patch_size;
        auto made = gather::gather_scene<B>::create(device_, what);
        if (!made) {
            return failure(made.error());
        }
        scene_.emplace(std::move(*made));
        job_.patches = scene_->patch_count();
        return {};
    }

    [[nodiscard]] picture::gather_view picture_view() const {
        auto view = picture::view_around(scene_->box().low, scene_->box().high, job_.common.width,
                                         job_.common.height);
        if (options_.camera.eye) {
            view.eye = *options_.camera.eye;
            view.target = *options_.camera.target;
            view.nearest = 1e-3f * glm::distance(view.eye, view.target);
        }
        view.supersampling = options_.supersampling;
        return view;
    }

    /// Finds the places that the picture shows.
    [[nodiscard]] result<void> see() {
        job_.time.begin("build");
        auto seen = picture::see(device_, scene_->triangles(), scene_->alpha(), job_.triangles,
                                 job_.materials, picture_view());
        if (!seen) {
            return failure(seen.error());
        }
        seen_ = std::move(*seen);
        return {};
    }

    [[nodiscard]] gather::final_gather_options gather_options() const {
        gather::final_gather_options made;
        made.seed = job_.common.seed;
        made.method = options_.method;
        made.peeler.size = options_.peel_size;
        if (options_.sky != glm::vec3(0)) {
            made.sky = gather::even_sky(options_.sky);
        }
        return made;
    }
    [[nodiscard]] glm::vec3 to_sun() const {
        return picture::direction_to_sun(options_.sun_azimuth, options_.sun_elevation);
    }

    [[nodiscard]] result<void> bounce() {
        job_.time.begin("bounce");
        gather::bounce_options how;
        how.axes = options_.bounce_directions;
        how.gather = gather_options();
        how.gather.seed += 0x9e3779b9u; // axes other than those of the points
        auto light = gather::bounced_light<B>::create(device_, *scene_, how);
        if (!light) {
            return failure(light.error());
        }
        if (options_.has_sun) {
            light->light_from(to_sun(), options_.sun_irradiance);
        }
        for (std::uint32_t i = 0; i < options_.bounces; ++i) {
            if (auto done = light->bounce(); !done) {
                return done;
            }
            job_.time.advance((i + 1.0) / options_.bounces);
        }
        return {};
    }

    // ---- The light at the points ---------------------------------------------------------------

    [[nodiscard]] std::span<const gather_sample> samples() const {
        return is_picture() ? seen_.samples : job_.samples;
    }

    [[nodiscard]] result<void> gather() {
        job_.time.begin("gather");
        job_.points = samples().size();
        light_.resize(samples().size());
        if (samples().empty()) {
            return {}; // a picture of nothing but sky
        }
        auto made = gather::final_gather<B>::create(device_, *scene_, samples(), gather_options());
        if (!made) {
            return failure(made.error());
        }
        gather_.emplace(std::move(*made));
        auto done = start();
        if (done) {
            done = go_on();
        }
        if (done) {
            done = save();
        }
        if (done) {
            done = gather_->read(light_);
        }
        if (done && !options_.error) {
            done = find_error();
        }
        job_.directions = gather_->axes();
        return done;
    }

    /// From a state, or from nothing.
    [[nodiscard]] result<void> start() {
        if (options_.resume.empty()) {
            return options_.has_sun ? gather_->light_from(to_sun(), options_.sun_irradiance)
                                    : result<void>();
        }
        const auto state = state_behind_line(job_);
        if (!state) {
            return failure(state.error());
        }
        auto done = gather_->resume(std::as_bytes(std::span(state->data(), state->size())));
        job_.resumed.clear();
        if (!done) {
            return fail(done.error().code,
                        io::in_quotes(options_.resume) + ": " + done.error().message);
        }
        if (gather_->axes() > options_.directions) {
            return fail(error_code::bad_input,
                        io::in_quotes(options_.resume) + " has " + std::to_string(gather_->axes()) +
                            " directions already; expected " +
                            (options_.error ? "--max-directions" : "--directions") +
                            " to be as many at least.");
        }
        return {};
    }

    /// To the number of directions, or to the error: looked at when a fifth more has been added.
    [[nodiscard]] result<void> go_on() {
        constexpr std::uint64_t eight = gather::final_gather<B>::replicates;
        const std::uint64_t most = options_.directions;
        saved_ = clock::now();
        if (!options_.error) {
            return add_to(most);
        }
        while (true) {
            const std::uint64_t now = gather_->axes();
            if (now >= std::min(gather_->least_axes, most)) {
                if (auto done = find_error(); !done) {
                    return done;
                }
                job_.reached = now >= gather_->least_axes && job_.error <= *options_.error;
                if (job_.reached || now >= most) {
                    return {};
                }
            }
            const std::uint64_t fifth = now / (5 * eight) * eight;
            const std::uint64_t next = std::max(gather_->least_axes, now + std::max(fifth, eight));
            if (auto done = add_to(std::min(next, most)); !done) {
                return done;
            }
        }
    }

    /// A few at a time: for the bar, and to save now and then.
    [[nodiscard]] result<void> add_to(std::uint64_t axes) {
        constexpr std::uint64_t few = 16;
        constexpr auto often = std::chrono::minutes(1);
        while (gather_->axes() < axes) {
            if (auto done = gather_->add(std::min(few, axes - gather_->axes())); !done) {
                return done;
            }
            show_progress();
            if (clock::now() - saved_ > often && gather_->axes() < axes) {
                if (auto done = save(); !done) {
                    return done;
                }
                saved_ = clock::now();
            }
        }
        return {};
    }

    void show_progress() {
        char note[96] = "";
        const auto axes = static_cast<double>(gather_->axes());
        double part = axes / static_cast<double>(options_.directions);
        if (options_.error && job_.error > 0) {
            // The error falls about like the square root of the directions, or faster.
            part = std::pow(std::min(1.0, *options_.error / job_.error), 2);
            std::snprintf(note, sizeof note, "%.0f directions, error %.3g W/m²", axes, job_.error);
        } else {
            std::snprintf(note, sizeof note, "%.0f directions", axes);
        }
        job_.time.advance(part, note);
    }

    [[nodiscard]] result<void> find_error() {
        const auto error = gather_->rms_error();
        if (!error) {
            return failure(error.error());
        }
        job_.error = *error;
        return {};
    }

    [[nodiscard]] result<void> save() {
        if (options_.save.empty()) {
            return {};
        }
        const auto bytes = gather_->save();
        if (!bytes) {
            return failure(bytes.error());
        }
        auto file = io::atomic_file::create(options_.save);
        if (!file) {
            return failure(file.error());
        }
        auto done = file->write(std::string_view(state_line(job_)));
        if (done) {
            done = file->write(std::span<const std::byte>(*bytes));
        }
        return done ? file->commit() : done;
    }

    // ---- A picture -----------------------------------------------------------------------------

    [[nodiscard]] result<void> draw() {
        job_.time.begin("draw");
        const picture::gather_view view = picture_view();
        const auto radiance = picture::radiance_seen(seen_, light_, job_.triangles, job_.materials,
                                                     view, [&](glm::vec3) { return options_.sky; });
        const float exposure = options_.exposure.value_or(exposure_for(radiance));
        const auto pixels = picture::develop(device_, radiance, view, exposure);
        if (!pixels) {
            return failure(pixels.error());
        }
        job_.time.begin("write");
        return io::write_png(job_.out, *pixels, view.width, view.height);
    }

    /// So that nearly all of what doesn't emit can be told apart, emitters may be white.
    [[nodiscard]] float exposure_for(std::span<const glm::vec4> radiance) const {
        std::vector<float> brightness;
        for (std::size_t i = 0; i < radiance.size(); ++i) {
            const std::uint32_t surface = seen_.places[i].surface;
            if (surface != no_surface && seen_.places[i].here != picture::no_sample &&
                job_.materials[job_.triangles[surface / 2].material].emission == glm::vec3(0)) {
                brightness.push_back(std::max({radiance[i].x, radiance[i].y, radiance[i].z}));
            }
        }
        const float white = nearly_brightest(std::move(brightness));
        return white > 0 ? 0.8f / white : 1.0f;
    }

    using clock = std::chrono::steady_clock;

    B& device_;
    gather_job& job_;
    const tool::gather_options& options_;
    std::optional<gather::gather_scene<B>> scene_;
    std::optional<gather::final_gather<B>> gather_;
    picture::seen_places seen_;
    std::vector<glm::vec4> light_;
    clock::time_point saved_;
};

/// Gathers the job's light, and writes it. `driver` is what the report says of the device.
template <gather::gathers B>
[[nodiscard]] result<void> gather_light(B& device, gather_job& job, std::string driver) {
    job.device = device.device_name();
    job.driver = std::move(driver);
    auto done = light_gatherer<B>(device, job).make();
    job.time.end();
    job.traffic = device.traffic();
    return done;
}

} // namespace skybark::tool
