#pragma once
// The cloud command on a device of any backend.

#include "cloud_job.hpp"

#include <io/text_input.hpp>
#include <io/write_png.hpp>
#include <picture/cloud_picture.hpp>
#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/cloud_density.hpp>
#include <skybark/clouds/harris.hpp>
#include <skybark/clouds/light_at_points.hpp>
#include <skybark/clouds/multiple_scattering.hpp>

#include <cstdio>
#include <glm/gtc/packing.hpp>
#include <numbers>
#include <optional>

namespace skybark::tool {

/// The job's cloud on a device.
template <volume_backend B>
class cloud_maker {
  public:
    cloud_maker(B& device, cloud_job& job) : device_(device), job_(job), options_(job.options) {}

    /// Everything that the job asks for.
    [[nodiscard]] result<void> make() {
        if (auto done = upload(); !done) {
            return done;
        }
        switch (options_.output) {
        case cloud_output::volume:
            return make_volumes();
        case cloud_output::probes:
            return probe_points();
        default:
            return draw();
        }
    }

  private:
    /// A volume with the light in it, and what fits around the cloud for its sun.
    struct lit_volume {
        clouds::attenuation_volume<B> volume;
        clouds::light_box box;
    };

    // ---- The cloud, and its light --------------------------------------------------------------

    /// What the library or a device says of the cloud, with the name of the file that it came from.
    [[nodiscard]] failure about_input(const error& e) const {
        return fail(e.code, io::in_quotes(job_.input) + ": " + e.message);
    }

    /// The same with the box, which one voxel far from the others makes large.
    [[nodiscard]] failure about_densities(const error& e) const {
        const auto text = [](glm::vec3 p) {
            char numbers[64];
            std::snprintf(numbers, sizeof numbers, "(%.6g, %.6g, %.6g)", double{p.x}, double{p.y},
                          double{p.z});
            return std::string(numbers);
        };
        return about_input({e.code, e.message + " Its active voxels reach from " + text(job_.low) +
                                        " to " + text(job_.high) + " m."});
    }

    [[nodiscard]] result<void> upload() {
        job_.time.begin("build");
        if (!job_.is_grid()) {
            auto made =
                make_buffer<B, cloud_particle>(device_, std::span(std::as_const(job_.particles)));
            if (!made) {
                return failure(made.error());
            }
            particles_ = std::move(*made);
            return {};
        }
        const glm::uvec3 voxels = job_.grid.voxels;
        auto made = device_.create_volume({voxels.x, voxels.y, voxels.z, volume_format::float32});
        if (!made) {
            return about_densities(made.error());
        }
        density_ = std::move(*made);
        return device_.upload(*density_, std::as_bytes(std::span(job_.grid.density)));
    }

    [[nodiscard]] clouds::density_box where() const {
        return {job_.low, job_.high, options_.extinction, options_.albedo};
    }
    [[nodiscard]] std::uint32_t count() const {
        return static_cast<std::uint32_t>(job_.particles.size());
    }
    [[nodiscard]] glm::vec3 to_sun() const {
        return picture::direction_to_sun(options_.sun_azimuth, options_.sun_elevation);
    }

    /// A volume for light from `towards`, without any yet.
    [[nodiscard]] result<lit_volume> prepare(glm::vec3 towards) {
        job_.time.begin("build");
        const glm::uvec3 voxels(options_.volume);
        auto volume = clouds::attenuation_volume<B>::create(device_, voxels, options_.attenuation);
        if (!volume) {
            return failure(volume.error());
        }
        if (job_.is_grid()) {
            if (auto done = volume->prepare_for_grids(device_); !done) {
                return failure(done.error());
            }
        }
        auto box = job_.is_grid() ? clouds::fit_light_box(where(), towards, voxels)
                                  : clouds::fit_light_box(job_.particles, towards, voxels);
        if (!box) {
            return about_input(box.error());
        }
        return lit_volume{std::move(*volume), *box};
    }

    [[nodiscard]] result<void> relight(lit_volume& lit, clouds::attenuation_light light) {
        job_.time.begin("light");
        if (auto done = lit.volume.set_light(light, forward_of(light)); !done) {
            return done;
        }
        return run(device_, [&](typename B::recorder& to) {
            if (job_.is_grid()) {
                lit.volume.relight(to, *density_, where(), lit.box);
            } else {
                lit.volume.relight(to, view<B>(*particles_), count(), lit.box);
            }
        });
    }

    [[nodiscard]] result<lit_volume> lit_from(glm::vec3 towards, clouds::attenuation_light light) {
        auto lit = prepare(towards);
        if (lit) {
            if (auto done = relight(*lit, light); !done) {
                return failure(done.error());
            }
        }
        return lit;
    }

    [[nodiscard]] float forward_of(clouds::attenuation_light light) const {
        return clouds::light_of(options_.phase, light).forward;
    }

    /// What the attenuation volume holds for the light that is asked for.
    [[nodiscard]] clouds::attenuation_light light_of_volume() const {
        switch (options_.light) {
        case cloud_light::product:
            return clouds::attenuation_light::product;
        case cloud_light::octaves:
            return clouds::attenuation_light::extinction;
        default:
            return clouds::attenuation_light::continuum;
        }
    }

    /// Light that was scattered more than once, by the continuum's volume.
    [[nodiscard]] result<clouds::multiple_scattering<B>> scatter(const lit_volume& lit) {
        job_.time.begin("build");
        clouds::multiple_scattering_options options;
        options.medium = clouds::medium_of(
            options_.phase, job_.is_grid() ? options_.albedo : clouds::mean_albedo(job_.particles));
        options.voxel = glm::vec3(lit.box.grid.voxel);
        auto made = clouds::multiple_scattering<B>::create(device_, lit.box.voxels, options);
        if (!made) {
            return made;
        }
        job_.time.begin("light");
        auto done = run(device_, [&](typename B::recorder& to) { made->solve(to, lit.volume); });
        if (!done) {
            return failure(done.error());
        }
        return made;
    }

    // ---- Places --------------------------------------------------------------------------------

    [[nodiscard]] result<void> probe_points() {
        auto lit = lit_from(to_sun(), clouds::attenuation_light::extinction);
        if (!lit) {
            return failure(lit.error());
        }
        job_.box = lit->box;
        std::vector<io::probed_light> found(job_.points.size());
        auto done = look_up(lit->volume, nullptr, {},
                            [&](std::size_t i, glm::vec4 at) { found[i].optical_depth = at.x; });
        if (done && light_of_volume() != clouds::attenuation_light::extinction) {
            done = relight(*lit, light_of_volume());
        }
        std::optional<clouds::multiple_scattering<B>> diffuse;
        if (done && options_.light == cloud_light::multiple) {
            auto made = scatter(*lit);
            if (!made) {
                return failure(made.error());
            }
            diffuse.emplace(std::move(*made));
        }
        if (done) {
            clouds::light_at_options how;
            how.octaves = options_.light == cloud_light::octaves ? options_.octaves : 1;
            done = look_up(lit->volume, diffuse ? &*diffuse : nullptr, how,
                           [&](std::size_t i, glm::vec4 at) { found[i].light = at.y; });
        }
        if (!done) {
            return done;
        }
        job_.time.begin("write");
        return io::write_probes(job_.out, job_.points, found);
    }

    /// Calls `take(i, {attenuation, light, …})` for each point.
    template <class Take>
    [[nodiscard]] result<void> look_up(const clouds::attenuation_volume<B>& sun,
                                       const clouds::multiple_scattering<B>* diffuse,
                                       const clouds::light_at_options& how, Take&& take) {
        job_.time.begin("draw");
        constexpr std::size_t most = std::size_t{1} << 20u;
        const std::size_t chunk = std::min(job_.points.size(), most);
        auto places = device_.create_buffer(chunk * sizeof(glm::vec4));
        auto found = device_.create_buffer(chunk * sizeof(glm::vec4));
        if (!places || !found) {
            return failure(!places ? places.error() : found.error());
        }
        std::vector<glm::vec4> some;
        for (std::size_t first = 0; first < job_.points.size(); first += chunk) {
            some.clear();
            for (std::size_t i = first; i < std::min(first + chunk, job_.points.size()); ++i) {
                some.emplace_back(job_.points[i], 0.0f);
            }
            auto done = device_.upload(*places, 0, std::as_bytes(std::span(some)));
            if (done) {
                result<void> recorded;
                done = run(device_, [&](typename B::recorder& to) {
                    recorded = clouds::record_light_at(
                        to, device_.limits(), sun, diffuse, view<B>(*places),
                        static_cast<std::uint32_t>(some.size()), view<B>(*found), how);
                });
                done = recorded ? done : recorded;
            }
            if (done) {
                done = read_back<B, glm::vec4>(device_, *found, std::span(some));
            }
            if (!done) {
                return done;
            }
            for (std::size_t i = 0; i < some.size(); ++i) {
                take(first + i, some[i]);
            }
        }
        return {};
    }

    // ---- Volumes -------------------------------------------------------------------------------

    [[nodiscard]] result<void> make_volumes() {
        auto lit = lit_from(to_sun(), clouds::attenuation_light::extinction);
        if (!lit) {
            return failure(lit.error());
        }
        job_.box = lit->box;
        std::vector<finished_volume> volumes;
        auto done = keep("optical_depth", lit->volume.volume(), lit->box.grid, volumes);
        if (done && light_of_volume() != clouds::attenuation_light::extinction) {
            done = relight(*lit, light_of_volume());
            if (done) {
                done = keep("attenuation", lit->volume.volume(), lit->box.grid, volumes);
            }
        }
        if (done && options_.light == cloud_light::multiple) {
            const auto diffuse = scatter(*lit);
            if (!diffuse) {
                return failure(diffuse.error());
            }
            done = keep("diffuse_fluence", diffuse->fluence(), diffuse->grid(lit->box), volumes);
        }
        if (!done) {
            return done;
        }
        job_.time.begin("write");
        return write_volumes(job_, volumes);
    }

    /// Brings a volume from the device, as floats.
    [[nodiscard]] result<void> keep(const char* name, const typename B::volume& volume,
                                    const light_grid& grid, std::vector<finished_volume>& in) {
        job_.time.begin("draw");
        const volume_description what = volume.description();
        in.push_back({name,
                      grid,
                      {what.width, what.height, what.depth},
                      {},
                      what.format == volume_format::float16});
        std::vector<float>& values = in.back().values;
        values.resize(std::size_t{what.width} * what.height * what.depth);
        if (what.format == volume_format::float32) {
            return device_.download(volume, std::as_writable_bytes(std::span(values)));
        }
        std::vector<std::uint16_t> halves(values.size());
        auto done = device_.download(volume, std::as_writable_bytes(std::span(halves)));
        for (std::size_t i = 0; done && i < values.size(); ++i) {
            values[i] = glm::unpackHalf1x16(halves[i]);
        }
        return done;
    }

    // ---- A picture -----------------------------------------------------------------------------

    [[nodiscard]] picture::cloud_picture_options picture_options() const {
        picture::cloud_picture_options options;
        options.width = job_.common.width;
        options.height = job_.common.height;
        options.eye = options_.camera.eye;
        options.target = options_.camera.target;
        options.sun_azimuth = options_.sun_azimuth;
        options.sun_elevation = options_.sun_elevation;
        return options;
    }

    [[nodiscard]] result<void> draw() {
        auto sun = lit_from(to_sun(), light_of_volume());
        if (!sun) {
            return failure(sun.error());
        }
        job_.box = sun->box;
        auto sky = lit_from(glm::vec3(0, 1, 0), clouds::attenuation_light::continuum);
        if (!sky) {
            return failure(sky.error());
        }
        // The product with the paper's profile is drawn by the paper's S = a τ P I as well.
        const bool paper_form = options_.light == cloud_light::product &&
                                options_.attenuation.profile == clouds::attenuation_profile::step;
        clouds::cloud_light_sources<B> light;
        light.lighting =
            clouds::single_scattering(sun->volume.options(), sun->box, options_.phase, paper_form);
        if (options_.light == cloud_light::octaves) {
            clouds::add_octaves(light.lighting, options_.octaves);
        }
        clouds::add_sky(light.lighting, sky->volume.options(), sky->box, options_.phase);
        tear(light.lighting);
        light.sun = &sun->volume.volume();
        light.sky = &sky->volume.volume();
        std::optional<clouds::multiple_scattering<B>> diffuse;
        if (options_.light == cloud_light::multiple) {
            auto made = scatter(*sun);
            if (!made) {
                return failure(made.error());
            }
            diffuse.emplace(std::move(*made));
            light.diffuse = &diffuse->fluence();
            light.lighting.diffuse_grid = diffuse->grid(sun->box);
            light.lighting.diffuse = 0.25f * std::numbers::inv_pi_v<float>;
        }
        std::optional<typename B::buffer> by_particle;
        if (options_.method == cloud_method::harris) {
            if (auto done = light_particles(sun->box, by_particle); !done) {
                return done;
            }
            light.by_particle = view<B>(*by_particle);
            light.lighting.by_particle = 1;
        }
        return paint(light);
    }

    /// Built-in clouds have torn outlines, with grains as wide as their smallest particles. Those
    /// of the paper's light are as the paper has them.
    void tear(clouds::cloud_lighting& lighting) const {
        const bool is_made =
            options_.source == cloud_source::cumulus || options_.source == cloud_source::cumuli;
        if (!is_made || job_.particles.empty() || options_.light == cloud_light::product) {
            return;
        }
        float smallest = job_.particles.front().radius;
        for (const cloud_particle& p : job_.particles) {
            smallest = std::min(smallest, p.radius);
        }
        clouds::add_tears(lighting, 0.6f, 2 * smallest);
    }

    /// Harris's light of each particle.
    [[nodiscard]] result<void> light_particles(const clouds::light_box& box,
                                               std::optional<typename B::buffer>& to) {
        job_.time.begin("light");
        clouds::harris_options options;
        options.sigmas = options_.attenuation.sigmas;
        options.forward = forward_of(clouds::attenuation_light::product);
        auto harris =
            clouds::harris_light<B>::create(device_, box.voxels.x, box.voxels.z, count(), options);
        if (!harris) {
            return failure(harris.error());
        }
        if (auto done = harris->relight(view<B>(*particles_), count(), box); !done) {
            return done;
        }
        auto made = make_buffer<B, float>(device_, harris->lights());
        if (!made) {
            return failure(made.error());
        }
        to.emplace(std::move(*made));
        return {};
    }

    [[nodiscard]] result<void> paint(const clouds::cloud_light_sources<B>& light) {
        job_.time.begin("draw");
        const picture::cloud_picture_options options = picture_options();
        auto painter = picture::cloud_painter<B>::create(device_, options, count());
        if (!painter) {
            return failure(painter.error());
        }
        const kernels::scene_record scene = picture::cloud_scene(job_.low, job_.high, options);
        auto done = run(device_, [&](typename B::recorder& to) {
            if (job_.is_grid()) {
                painter->record(to, scene, *density_, where(), light, ground());
            } else {
                painter->record(to, scene, view<B>(*particles_), count(), light, ground());
            }
        });
        if (!done) {
            return done;
        }
        const auto pixels = painter->download(device_);
        if (!pixels) {
            return failure(pixels.error());
        }
        job_.time.begin("write");
        return io::write_png(job_.out, *pixels, options.width, options.height);
    }

    /// The height of the ground: at 0, or below what hangs lower.
    [[nodiscard]] float ground() const {
        return std::min(0.0f, job_.low.y - 0.5f * (job_.high.y - job_.low.y));
    }

    B& device_;
    cloud_job& job_;
    const cloud_options& options_;
    std::optional<typename B::buffer> particles_;
    std::optional<typename B::volume> density_;
};

/// Lights the job's cloud, and draws or saves. `driver` is what the report says of it.
template <volume_backend B>
[[nodiscard]] result<void> make_cloud(B& device, cloud_job& job, std::string driver) {
    job.device = device.device_name();
    job.driver = std::move(driver);
    auto done = cloud_maker<B>(device, job).make();
    job.time.end();
    job.traffic = device.traffic();
    return done;
}

} // namespace skybark::tool
