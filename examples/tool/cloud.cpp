// The cloud command: its options, its input, its files.

#include "cloud_job.hpp"
#include "commands.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <io/atomic_file.hpp>
#include <io/read_particles.hpp>
#include <io/text_input.hpp>
#include <io/vdb.hpp>
#include <nlohmann/json.hpp>
#include <skybark/clouds/cumulus.hpp>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace skybark::tool {

namespace {

/// The options as they were typed.
struct cloud_words {
    common_words common;
    std::string input;
    std::string out;
    cloud_option_words more;
    bool list = false;
};

/// Turns words into a job. Errors are those of the command line.
result<void> check_words(const cloud_words& words, cloud_job& job) {
    const auto common = check(words.common);
    if (!common) {
        return failure(common.error());
    }
    if (words.input.empty()) {
        return fail(error_code::bad_input,
                    "There is no INPUT; expected a .csv or .vdb file or a built-in cloud, such as "
                    "cumulus ('skybark cloud --list' names all).");
    }
    if (words.out.empty()) {
        return fail(error_code::bad_input, "There is no -o OUT; expected a name that ends in "
                                           ".png, .vdb or, with --probe, .csv.");
    }
    const auto options = check(words.more, {words.input, words.out, words.common.size.has_value(),
                                            words.common.seed.has_value()});
    if (!options) {
        return failure(options.error());
    }
    if (auto good = check_apart({words.input, words.out, common->stats, options->probe},
                                "INPUT, -o, --probe and --stats");
        !good) {
        return good;
    }
    job.common = *common;
    job.options = *options;
    job.input = words.input;
    job.out = words.out;
    return {};
}

int list_clouds() {
    for (const cloud_entry& entry : all_clouds()) {
        std::printf("%-22.*s %.*s\n", static_cast<int>(entry.name.size()), entry.name.data(),
                    static_cast<int>(entry.title.size()), entry.title.data());
    }
    return exit_done;
}

nlohmann::ordered_json stats_of(const cloud_job& job) {
    auto stats = begin_report("cloud", job);
    const glm::uvec3 voxels = job.box.voxels;
    stats["counts"] = {{"particles", job.particles.size()},
                       {"thin_particles", job.thin.count},
                       {"densities", job.grid.density.size()},
                       {"voxels", std::uint64_t{voxels.x} * voxels.y * voxels.z},
                       {"points", job.points.size()}};
    stats["voxel"] = {job.box.grid.voxel.x, job.box.grid.voxel.y, job.box.grid.voxel.z};
    return stats;
}

void summarise(const cloud_job& job) {
    if (job.common.quiet) {
        return;
    }
    const std::size_t count = job.is_grid() ? job.grid.density.size() : job.particles.size();
    const char* what = job.is_grid() ? (count == 1 ? "density" : "densities")
                                     : (count == 1 ? "particle" : "particles");
    std::printf("%s: %zu %s, %u x %u x %u voxels, %.2f s on %s (%s)\n", job.out.c_str(), count,
                what, job.box.voxels.x, job.box.voxels.y, job.box.voxels.z, job.time.total(),
                name_of(job.common.backend), job.device.c_str());
}

/// The wider side of the volume's voxels across the light.
double width_of_voxel(const light_grid& grid) {
    return std::max(double{grid.voxel.x}, double{grid.voxel.z});
}

/// Particles of a smaller radius than a voxel, by their water: optical depth times area.
thin_particles thin_of(std::span<const cloud_particle> particles, const clouds::light_box& box) {
    const auto water = [](const cloud_particle& p) {
        return double{p.optical_depth} * double{p.radius} * double{p.radius};
    };
    const double width = width_of_voxel(box.grid);
    double all = 0;
    double missed = 0;
    std::vector<std::pair<double, double>> thin; // radius, water
    for (const cloud_particle& p : particles) {
        all += water(p);
        if (double{p.radius} < width) {
            thin.emplace_back(p.radius, water(p));
            missed += water(p);
        }
    }
    thin_particles found;
    found.count = thin.size();
    if (thin.empty() || !(all > 0)) {
        return found;
    }
    found.share = missed / all;
    // As many voxels as leave a hundredth of the water to particles of a smaller radius.
    std::sort(thin.begin(), thin.end());
    double below = 0;
    std::size_t i = 0;
    while (i + 1 < thin.size() && below + thin[i].second <= 0.01 * all) {
        below += thin[i++].second;
    }
    const double side = std::max({box.voxels.x, box.voxels.y, box.voxels.z});
    found.enough_voxels = std::ceil(side * width / thin[i].first);
    return found;
}

/// A note of particles that the volume may miss, where they are more than a hundredth of a cloud
/// that came from a file.
void note_thin(const cloud_job& job) {
    constexpr double little = 0.01;
    if (job.common.quiet || job.options.source != cloud_source::table || job.thin.share <= little) {
        return;
    }
    constexpr double most_voxels = 65536; // of --volume
    char text[320];
    std::snprintf(text, sizeof text,
                  "Note: %zu of %zu particles, with %.2g %% of the cloud's water, have a radius "
                  "below a voxel's side of %.3g m, and may fall between the middles of voxels and "
                  "cast no shadow; expected ",
                  job.thin.count, job.particles.size(), 100 * job.thin.share,
                  width_of_voxel(job.box.grid));
    std::string sentence = text;
    if (job.thin.enough_voxels <= most_voxels) {
        std::snprintf(text, sizeof text, "--volume %.0f or ", job.thin.enough_voxels);
        sentence += text;
    }
    complain(sentence + "wider particles.");
}

int run_cloud(const cloud_words& words) {
    if (words.list) {
        if (!words.input.empty() || !words.out.empty()) {
            return usage_error("cloud", "--list names the built-in clouds and does nothing else; "
                                        "expected neither INPUT nor -o with it.");
        }
        return list_clouds();
    }
    cloud_job job(words.common.quiet);
    if (auto good = check_words(words, job); !good) {
        return usage_error("cloud", good.error().message);
    }
    auto done = check_writable({job.out, job.common.stats});
    if (done) {
        done = read_cloud(job); // before there is a device: a .vdb is read in a child
    }
    if (done) {
        done = on_backend(job, make_cloud_on_cpu, make_cloud_on_opengl, make_cloud_on_vulkan);
    }
    job.time.end(); // takes the bar away before a sentence comes
    if (done) {
        job.thin = thin_of(job.particles, job.box);
        done = write_report(job, stats_of(job));
    }
    if (!done) {
        return report_failure(done.error());
    }
    note_thin(job);
    summarise(job);
    return exit_done;
}

result<void> read_grid(cloud_job& job) {
    auto grid = io::read_vdb(job.input, job.options.grid);
    if (!grid) {
        return failure(grid.error());
    }
    job.grid = std::move(*grid);
    job.low = job.grid.low;
    job.high = job.grid.low + job.grid.sides();
    return {};
}

result<std::vector<cloud_particle>> particles_of(const cloud_job& job) {
    if (job.options.source == cloud_source::table) {
        return io::read_particles(job.input);
    }
    if (job.options.source == cloud_source::cumuli) {
        clouds::cumulus_field_options field;
        field.seed = job.common.seed;
        field.clouds = clouds_of_field;
        field.extent = 9000;
        field.particles_per_cloud = job.options.particles / field.clouds;
        return clouds::cumulus_field(field);
    }
    clouds::cumulus_options one;
    one.seed = job.common.seed;
    one.particles = job.options.particles;
    return clouds::cumulus_cloud(one);
}

result<void> read_particles(cloud_job& job) {
    auto particles = particles_of(job);
    if (!particles) {
        return failure(particles.error());
    }
    if (particles->empty()) {
        return fail(error_code::bad_input,
                    io::in_quotes(job.input) + " has no particles; expected one at least.");
    }
    job.particles = std::move(*particles);
    job.low = glm::vec3(std::numeric_limits<float>::max());
    job.high = -job.low;
    for (const cloud_particle& p : job.particles) {
        job.low = glm::min(job.low, p.position - p.radius);
        job.high = glm::max(job.high, p.position + p.radius);
    }
    return {};
}

/// Places in a picture are floats: from too far away, a cloud would be drawn as something else.
result<void> check_drawable(const cloud_job& job) {
    constexpr float most = 1e6f;
    const glm::vec3 far = glm::max(glm::abs(job.low), glm::abs(job.high));
    const glm::vec3 sides = job.high - job.low;
    const float farthest = std::max({far.x, far.y, far.z});
    const float size = std::max({sides.x, sides.y, sides.z});
    if (farthest <= most * size) {
        return {};
    }
    char numbers[96];
    std::snprintf(numbers, sizeof numbers, "a cloud of %.6g m that reaches %.6g m", double{size},
                  double{farthest});
    return fail(error_code::bad_input, io::in_quotes(job.input) + " has " + numbers +
                                           " from the origin, where a picture can't show it; "
                                           "expected it within 1e6 times its size.");
}

/// From voxel coordinates to the world: the inverse of `cells = offset + rows · (p − anchor)`. The
/// rows are at right angles, each as long as one over the side of a voxel.
glm::dmat4 world_of(const light_grid& grid) {
    const glm::dvec4 rows[] = {grid.row_x, grid.row_y, grid.row_z};
    glm::dmat4 to_world(1);
    glm::dvec3 origin(glm::vec3(grid.anchor));
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 row(rows[axis]);
        const glm::dvec3 side = row / glm::dot(row, row);
        to_world[axis] = glm::dvec4(side, 0);
        origin -= side * rows[axis].w;
    }
    to_world[3] = glm::dvec4(origin, 1);
    return to_world;
}

/// What a volume's grid says of itself.
std::vector<io::vdb_note> notes_of(const cloud_options& options, const finished_volume& volume) {
    std::vector<io::vdb_note> notes{{"creator", "Skybark " SKYBARK_VERSION},
                                    {"units", "1"},
                                    {"to_sun", glm::normalize(glm::vec3(volume.grid.row_y))},
                                    {"sun_azimuth", static_cast<float>(options.sun_azimuth)},
                                    {"sun_elevation", static_cast<float>(options.sun_elevation)}};
    const auto add = [&](const char* key, std::string_view text) {
        notes.emplace_back(key, std::string(text));
    };
    if (options.source != cloud_source::grid) {
        add("method", name_of(options.method));
        add("profile", name_of(options.attenuation.profile));
        notes.emplace_back("sigmas", options.attenuation.sigmas);
    }
    if (volume.name == "diffuse_fluence") {
        add("description", "Fluence of the sun's light that was scattered more than once, over the "
                           "sun's irradiance outside of the cloud, at the middles of voxels.");
        add("outside", "Not known here: it fades with the distance from the box.");
        add("light", name_of(options.light));
        return notes;
    }
    add("outside", "Above the box, towards the sun, and beside it: 0. Below it the undermost layer "
                   "(y = 0) goes on.");
    if (volume.name == "optical_depth") {
        add("description", "Optical depth of what lies between a place and the sun, at the middles "
                           "of voxels.");
        add("light", "extinction");
        return notes;
    }
    add("description",
        "-ln of the sun's light that reaches a place, at the middles of voxels; what "
        "scatters straight on is not taken out.");
    const bool product = options.light == cloud_light::product;
    add("light", product ? "product" : "continuum");
    notes.emplace_back("forward", static_cast<float>(product ? options.phase.forward_value()
                                                             : options.phase.forward_energy()));
    return notes;
}

} // namespace

result<void> read_cloud(cloud_job& job) {
    job.time.begin("read");
    auto done = job.is_grid() ? read_grid(job) : read_particles(job);
    if (done && !job.options.probe.empty()) {
        auto points = io::read_points(job.options.probe);
        if (!points) {
            return failure(points.error());
        }
        job.points = std::move(*points);
    }
    if (done && job.options.output == cloud_output::picture) {
        done = check_drawable(job);
    }
    return done;
}

result<void> write_volumes(const cloud_job& job, const std::vector<finished_volume>& volumes) {
    std::vector<io::vdb_volume> all;
    for (const finished_volume& volume : volumes) {
        all.push_back({volume.name,
                       volume.values,
                       {volume.voxels.x, volume.voxels.y, volume.voxels.z},
                       world_of(volume.grid),
                       volume.half,
                       notes_of(job.options, volume)});
    }
    return io::write_vdb(job.out, all);
}

command add_cloud_command(CLI::App& to) {
    const auto words = std::make_shared<cloud_words>();
    CLI::App* cloud =
        to.add_subcommand("cloud", "Light a cloud: a picture, its volume, or single places in it");
    cloud->add_option("INPUT", words->input,
                      "Particles (.csv: x,y,z,radius,optical_depth,albedo), a density (.vdb) or a "
                      "built-in cloud (--list)");
    cloud
        ->add_option("-o,--output", words->out,
                     "A picture (.png), the optical depth towards the sun as a volume (.vdb, whose "
                     "grids say what they hold in their metadata), or with --probe a table "
                     "(.csv); required")
        ->type_name("OUT");
    add_cloud_options(*cloud, words->more);
    cloud->add_flag("--list", words->list, "Name the built-in clouds, and do nothing else");
    add_common_options(*cloud, words->common);
    return {"cloud", [words] { return run_cloud(*words); }};
}

} // namespace skybark::tool
