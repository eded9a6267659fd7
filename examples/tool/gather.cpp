// The gather command: its options, its input, its files.

#include "commands.hpp"
#include "gather_job.hpp"
#include "vertex_points.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <io/atomic_file.hpp>
#include <io/exr.hpp>
#include <io/gather_points.hpp>
#include <io/read_scene.hpp>
#include <io/text_input.hpp>
#include <io/write_glb.hpp>
#include <io/write_obj.hpp>
#include <io/write_ply.hpp>
#include <nlohmann/json.hpp>
#include <skybark/gather/scene.hpp>

#include <bit>
#include <unistd.h>

namespace skybark::tool {

namespace {

/// The options as they were typed.
struct gather_words {
    common_words common;
    std::string input;
    std::string out;
    gather_option_words more;
};

/// Turns words into a job. Errors are those of the command line.
result<void> check_words(const gather_words& words, gather_job& job) {
    const auto common = check(words.common);
    if (!common) {
        return failure(common.error());
    }
    if (words.input.empty()) {
        return fail(error_code::bad_input,
                    "There is no SCENE; expected triangles: a .obj or .glb file.");
    }
    if (words.out.empty()) {
        return fail(error_code::bad_input, "There is no -o OUT; expected a name that ends in .csv, "
                                           ".ply, .exr or .png.");
    }
    const auto options = check(words.more, {words.input, words.out});
    if (!options) {
        return failure(options.error());
    }
    // A state may be gone on with in place.
    if (auto good = check_apart({words.input, words.out, common->stats, options->points,
                                 options->unwrapped, options->save},
                                "SCENE, -o, --points, --unwrapped, --save and --stats");
        !good) {
        return good;
    }
    job.common = *common;
    job.options = *options;
    job.input = words.input;
    job.out = words.out;
    return {};
}

nlohmann::ordered_json stats_of(const gather_job& job) {
    auto stats = begin_report("gather", job);
    stats["counts"] = {{"triangles", job.triangles.size()},
                       {"materials", job.materials.size()},
                       {"patches", job.patches},
                       {"points", job.points},
                       {"directions", job.directions},
                       {"bounces", job.options.bounces}};
    stats["error"] = {{"rms", job.error}, {"reached", job.reached}};
    if (job.options.places == gather_places::texels) {
        stats["texels_per_metre"] = job.lightmap.texels_per_metre;
    }
    return stats;
}

void summarise(const gather_job& job) {
    if (job.common.quiet) {
        return;
    }
    if (!job.reached) {
        std::fprintf(stderr,
                     "skybark: After %llu directions, --max-directions, the error is %g W/m²; "
                     "expected %g.\n",
                     static_cast<unsigned long long>(job.directions), job.error,
                     job.options.error.value_or(0));
    }
    std::printf("%s: %llu points, %llu directions, %u bounces, error %.3g, %.2f s on %s (%s)\n",
                job.out.c_str(), static_cast<unsigned long long>(job.points),
                static_cast<unsigned long long>(job.directions), job.options.bounces, job.error,
                job.time.total(), name_of(job.common.backend), job.device.c_str());
}

int run_gather(const gather_words& words) {
    gather_job job(words.common.quiet);
    if (auto good = check_words(words, job); !good) {
        return usage_error("gather", good.error().message);
    }
    auto done =
        check_writable({job.out, job.options.unwrapped, job.options.save, job.common.stats});
    if (done) {
        done = read_gather(job);
    }
    if (done) {
        done = on_backend(job, gather_on_cpu, gather_on_opengl, gather_on_vulkan);
    }
    job.time.end(); // takes the bar away before a sentence comes
    if (done) {
        done = write_report(job, stats_of(job));
    }
    if (!done) {
        return report_failure(done.error());
    }
    summarise(job);
    return exit_done;
}

// ---- The scene ---------------------------------------------------------------------------------

gather_material material_of(const io::scene_material& from, bool two_sided) {
    gather_material m;
    m.diffuse = from.diffuse;
    m.emission = from.emission;
    m.transmission = from.transmission;
    m.two_sided = from.two_sided || two_sided ? 1 : 0;
    return m;
}

void append_words(std::vector<std::uint32_t>& to, const alpha_coordinates& c) {
    for (const float f : {c.a.x, c.a.y, c.b.x, c.b.y, c.c.x, c.c.y}) {
        to.push_back(std::bit_cast<std::uint32_t>(f));
    }
    to.insert(to.end(), {c.map, c.size, std::bit_cast<std::uint32_t>(c.cutoff), 0, 0, 0});
}

/// Coordinates of the triangles with holes, then the maps that they name.
result<void> add_holes(gather_job& job, const io::triangle_scene& scene) {
    constexpr std::uint64_t words_each = sizeof(alpha_coordinates) / 4;
    std::uint64_t with_holes = 0;
    for (const std::uint32_t m : scene.material_of) {
        with_holes += scene.materials[m].alpha_map != io::no_alpha_map ? 1 : 0;
    }
    if (with_holes == 0) {
        return {};
    }
    std::uint64_t words = with_holes * words_each;
    std::vector<std::uint32_t> first;
    for (const io::alpha_map& map : scene.maps) {
        if (map.width > 0xffffu || map.height > 0xffffu || words > 0x7fffffffu) {
            return fail(error_code::out_of_memory,
                        io::in_quotes(job.input) + " has alpha maps that are too large; expected "
                                                   "sides of up to 65535 texels and 2^31 in all.");
        }
        first.push_back(static_cast<std::uint32_t>(words));
        words += std::uint64_t{map.width} * map.height;
    }
    job.alpha.reserve(words);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        const io::scene_material& m = scene.materials[scene.material_of[i]];
        if (m.alpha_map == io::no_alpha_map) {
            continue;
        }
        const io::alpha_map& map = scene.maps[m.alpha_map];
        const glm::uvec3 t = scene.triangles[i];
        alpha_coordinates c;
        c.a = scene.coordinates[t.x];
        c.b = scene.coordinates[t.y];
        c.c = scene.coordinates[t.z];
        c.map = first[m.alpha_map];
        c.size = map.width + 65536 * map.height;
        c.cutoff = m.cutoff;
        append_words(job.alpha, c);
        job.triangles[i].alpha = static_cast<std::uint32_t>(job.alpha.size() / words_each);
    }
    for (const io::alpha_map& map : scene.maps) {
        for (const float value : map.values) {
            job.alpha.push_back(std::bit_cast<std::uint32_t>(value));
        }
    }
    return {};
}

result<void> read_triangles(gather_job& job) {
    const auto scene = io::read_scene(job.input);
    if (!scene) {
        return failure(scene.error());
    }
    for (std::size_t i = 0; i < scene->triangles.size(); ++i) {
        const glm::uvec3 t = scene->triangles[i];
        gather_triangle made;
        made.a = scene->positions[t.x];
        made.b = scene->positions[t.y];
        made.c = scene->positions[t.z];
        made.material = scene->material_of[i];
        job.triangles.push_back(made);
        for (const std::uint32_t v : {t.x, t.y, t.z}) {
            job.corner_normals.push_back(scene->normals[v]);
        }
    }
    for (const io::scene_material& m : scene->materials) {
        job.materials.push_back(material_of(m, job.options.two_sided));
    }
    return add_holes(job, *scene);
}

/// Bytes of this machine's memory, or what this process may have of it.
std::uint64_t machine_memory() {
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long page = ::sysconf(_SC_PAGESIZE);
    std::uint64_t bytes = pages > 0 && page > 0
                              ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
                              : std::uint64_t{1} << 34u;
    const auto limit = io::load_start("/sys/fs/cgroup/memory.max", 24);
    if (limit) {
        const auto allowed = io::parse_integer(io::trimmed(limit->substr(0, limit->find('\n'))));
        bytes =
            allowed && *allowed > 0 ? std::min(bytes, static_cast<std::uint64_t>(*allowed)) : bytes;
    }
    return bytes;
}

/// What a point takes, on a device that shares the host's memory: 176 bytes there, some here.
constexpr std::uint64_t bytes_a_point = 320;

/// Said before it is taken: a process that asks for too much is ended without a word.
result<void> check_memory(std::uint64_t points) {
    const std::uint64_t memory = machine_memory();
    if (points > memory / bytes_a_point) {
        return fail(error_code::out_of_memory,
                    "Light at " + std::to_string(points) + " points takes about " +
                        std::to_string(points * bytes_a_point >> 20u) +
                        " MiB of memory; expected at most the " + std::to_string(memory >> 20u) +
                        " MiB that there are.");
    }
    return {};
}

result<void> find_places(gather_job& job) {
    if (job.options.places == gather_places::pixels) {
        const std::uint64_t samples = job.options.supersampling;
        return check_memory(samples * samples * job.common.width * job.common.height);
    }
    if (job.options.places == gather_places::points) {
        auto points = io::read_gather_points(job.options.points);
        if (!points) {
            return failure(points.error());
        }
        job.samples = std::move(*points);
    }
    if (job.options.places == gather_places::texels) {
        const std::uint64_t most = machine_memory() / bytes_a_point;
        auto map = gather::make_lightmap(job.triangles, {job.options.lightmap, 0, most});
        if (!map) {
            return fail(map.error().code, io::in_quotes(job.input) + ": " + map.error().message);
        }
        job.lightmap = std::move(*map);
        job.samples = std::move(job.lightmap.samples);
    }
    if (job.options.places == gather_places::vertices) {
        const float lift = gather::default_lift(gather::bounds_of(job.triangles));
        auto vertices = find_vertices(job.triangles, job.corner_normals, lift);
        job.samples = std::move(vertices.samples);
        job.places = std::move(vertices.places);
        job.mesh = std::move(vertices.triangles);
        if (job.samples.empty()) {
            return fail(error_code::bad_input, io::in_quotes(job.input) +
                                                   " has no vertex with a normal: all triangles "
                                                   "are without area; expected one that has some.");
        }
    }
    return check_memory(job.samples.size());
}

// ---- What comes out ----------------------------------------------------------------------------

/// The triangles, each with corners of its own, and their places in the lightmap.
result<void> write_unwrapped(const gather_job& job) {
    std::vector<surface_vertex> vertices(3 * job.triangles.size());
    std::vector<std::uint32_t> indices(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        const gather_triangle& t = job.triangles[i / 3];
        surface_vertex& v = vertices[i];
        v.position = i % 3 == 0 ? t.a : i % 3 == 1 ? t.b : t.c;
        const glm::dvec3 across = glm::cross(glm::dvec3(t.b - t.a), glm::dvec3(t.c - t.a));
        const double size = glm::length(across);
        const glm::vec3 flat = size > 0 ? glm::vec3(across / size) : glm::vec3(0, 1, 0);
        v.normal = job.corner_normals[i] == glm::vec3(0) ? flat : job.corner_normals[i];
        v.u = job.lightmap.corners[i].x;
        v.v = job.lightmap.corners[i].y;
        v.tangent = glm::vec4(0, 0, 0, 1);
        indices[i] = i;
    }
    const std::string& name = job.options.unwrapped;
    const std::string extension = extension_of(name);
    if (extension == ".ply") {
        return io::write_ply(name, vertices, indices);
    }
    if (extension == ".obj") {
        return io::write_obj(name, vertices, indices);
    }
    io::surface_material material;
    material.name = "surface";
    return io::write_glb(name, vertices, indices, material);
}

/// Row 0 of a lightmap is at v = 0, below; that of a picture is its top.
result<void> write_lightmap(const gather_job& job, std::span<const glm::vec4> light) {
    const std::size_t size = job.lightmap.size;
    std::vector<glm::vec4> texels(size * size, glm::vec4(0));
    for (std::size_t i = 0; i < light.size(); ++i) {
        texels[job.lightmap.texels[i]] = glm::vec4(glm::vec3(light[i]), 1);
    }
    gather::dilate(job.lightmap, std::span(texels));
    std::vector<glm::vec4> rows(texels.size());
    for (std::size_t y = 0; y < size; ++y) {
        const auto from = texels.begin() + static_cast<std::ptrdiff_t>(y * size);
        std::copy(from, from + static_cast<std::ptrdiff_t>(size),
                  rows.begin() + static_cast<std::ptrdiff_t>((size - 1 - y) * size));
    }
    return io::write_exr(job.out, rows, job.lightmap.size, job.lightmap.size);
}

/// How many patches there are, if none may be longer.
std::uint64_t patches_of(const std::vector<gather_triangle>& triangles, float patch_size) {
    std::uint64_t patches = 0;
    for (const gather_triangle& t : triangles) {
        const std::uint64_t rows = gather::detail::rows_of(t, patch_size);
        patches += rows * rows;
    }
    return patches;
}

/// As was asked for; or the finest that has no more than 30,000 patches beside one a triangle.
float find_patch_size(const gather_job& job) {
    if (job.options.bounces == 0) {
        return 0; // surfaces send out what they emit, evenly
    }
    if (job.options.patch_size > 0) {
        return job.options.patch_size;
    }
    constexpr std::uint64_t more = 30000;
    float low = 0;
    float high = gather::bounds_of(job.triangles).diagonal(); // one patch a triangle
    for (int i = 0; i < 20; ++i) {
        const float middle = 0.5f * (low + high);
        const bool few =
            middle > 0 && patches_of(job.triangles, middle) <= job.triangles.size() + more;
        (few ? high : low) = middle;
    }
    return high;
}

} // namespace

float nearly_brightest(std::vector<float> values) {
    if (values.empty()) {
        return 0;
    }
    const auto at = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

result<void> read_gather(gather_job& job) {
    job.time.begin("read");
    auto done = io::within_memory(job.input, [&]() -> result<void> {
        auto read = read_triangles(job);
        return read ? find_places(job) : read;
    });
    job.patch_size = find_patch_size(job);
    if (done && !job.options.resume.empty()) {
        auto state = io::load_text(job.options.resume);
        if (!state) {
            return failure(state.error());
        }
        job.resumed = std::move(*state);
        const auto behind = state_behind_line(job);
        done = behind ? result<void>() : failure(behind.error());
    }
    return done;
}

result<void> write_light(const gather_job& job, std::span<const glm::vec4> light) {
    if (job.options.output == gather_output::lightmap) {
        if (auto done = write_lightmap(job, light); !done) {
            return done;
        }
    }
    if (!job.options.unwrapped.empty()) {
        if (auto done = write_unwrapped(job); !done) {
            return done;
        }
    }
    std::vector<gather_sample> points = job.samples;
    for (std::size_t i = 0; i < job.places.size(); ++i) {
        points[i].position = job.places[i];
    }
    if (job.options.output == gather_output::table) {
        return io::write_gathered(job.out, points, light);
    }
    if (job.options.output == gather_output::mesh) {
        constexpr float pi = 3.14159265f;
        std::vector<float> brightness;
        for (const glm::vec4& e : light) {
            brightness.push_back(std::max({e.x, e.y, e.z}));
        }
        // A white surface with an irradiance of π has a radiance of 1.
        const float white = job.options.exposure ? pi / *job.options.exposure
                                                 : nearly_brightest(std::move(brightness));
        return io::write_gathered_ply(job.out, points, light, white, job.mesh);
    }
    return {};
}

command add_gather_command(CLI::App& to) {
    const auto words = std::make_shared<gather_words>();
    CLI::App* gather = to.add_subcommand(
        "gather", "Gather the light that arrives at the surfaces of a scene, from all directions");
    gather->add_option("SCENE", words->input,
                       "Triangles with diffuse colours and emission (.obj with .mtl, or .glb)");
    gather
        ->add_option(
            "-o,--output", words->out,
            "Irradiance and its error at points (.csv), a coloured mesh (.ply), a lightmap "
            "(.exr) or a picture (.png); required")
        ->type_name("OUT");
    add_gather_options(*gather, words->more);
    add_common_options(*gather, words->common);
    return {"gather", [words] { return run_gather(*words); }};
}

} // namespace skybark::tool
