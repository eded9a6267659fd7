// The tree command: its options, its input, its files.

#include "commands.hpp"
#include "skeleton_layout.hpp"
#include "tree_job.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <io/atomic_file.hpp>
#include <io/read_tree.hpp>
#include <io/text_input.hpp>
#include <io/write_glb.hpp>
#include <io/write_obj.hpp>
#include <io/write_ply.hpp>
#include <io/write_png.hpp>
#include <nlohmann/json.hpp>
#include <skybark/trees/species.hpp>

namespace skybark::tool {

namespace {

/// The options as they were typed.
struct tree_words {
    common_words common;
    std::string input;
    std::string out;
    std::string sides;
    std::string rings;
    std::string frame = "slerp";
    std::string padding = "compact";
    std::string form = "rings";
    bool skeleton = false;
    bool list = false;
};

result<tree_output> kind_of(const std::string& out) {
    const std::string extension = extension_of(out);
    if (extension == ".png") {
        return tree_output::picture;
    }
    if (extension == ".obj") {
        return tree_output::obj;
    }
    if (extension == ".glb") {
        return tree_output::glb;
    }
    if (extension == ".ply") {
        return tree_output::ply;
    }
    return fail(error_code::bad_input,
                "-o is " + io::in_quotes(out) +
                    "; expected a name that ends in .png (a picture) or in .obj, .glb or .ply (a "
                    "mesh).");
}

result<trees::branch_mesh_options> check_mesh(const tree_words& words) {
    static constexpr named<kernels::branch_frame> frames[] = {
        {"slerp", kernels::branch_frame::slerp},
        {"rmf", kernels::branch_frame::rotation_minimising}};
    static constexpr named<padding> paddings[] = {{"degenerate", padding::degenerate},
                                                  {"compact", padding::compact}};
    static constexpr named<trees::mesh_form> forms[] = {{"rings", trees::mesh_form::rings},
                                                        {"list", trees::mesh_form::list}};
    constexpr std::uint32_t most = 1024;
    // A stick of the skeleton is straight and thin, so that it needs no more.
    const std::string sides = !words.sides.empty() ? words.sides : words.skeleton ? "4" : "8";
    const std::string rings = !words.rings.empty() ? words.rings : words.skeleton ? "2" : "4";
    const auto sides_number = whole_number("--sides", sides, 3, most);
    if (!sides_number) {
        return failure(sides_number.error());
    }
    const auto rings_number = whole_number("--rings", rings, 2, most);
    if (!rings_number) {
        return failure(rings_number.error());
    }
    const auto frame = one_of("--frame", words.frame, frames);
    if (!frame) {
        return failure(frame.error());
    }
    const auto policy = one_of("--padding", words.padding, paddings);
    if (!policy) {
        return failure(policy.error());
    }
    const auto form = one_of("--form", words.form, forms);
    if (!form) {
        return failure(form.error());
    }
    return trees::branch_mesh_options{*sides_number, *rings_number, *frame, *form, *policy};
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, error));
}

/// Turns words into a job. Errors are those of the command line.
result<void> check_words(const tree_words& words, tree_job& job) {
    const auto common = check(words.common);
    if (!common) {
        return failure(common.error());
    }
    const auto mesh = check_mesh(words);
    if (!mesh) {
        return failure(mesh.error());
    }
    if (words.input.empty()) {
        return fail(error_code::bad_input,
                    "There is no INPUT; expected a .csv, .mtg or .json file or a species, such as "
                    "quaking_aspen ('skybark tree --list' names all).");
    }
    if (words.out.empty()) {
        return fail(error_code::bad_input,
                    "There is no -o OUT; expected a name that ends in .png, .obj, .glb or .ply.");
    }
    const auto kind = kind_of(words.out);
    if (!kind) {
        return failure(kind.error());
    }
    if (same_file(words.out, words.common.stats) || same_file(words.input, words.common.stats) ||
        same_file(words.input, words.out)) {
        return fail(error_code::bad_input, "Two of INPUT, -o and --stats are the same file; "
                                           "expected each its own.");
    }
    job.common = *common;
    job.mesh = *mesh;
    job.kind = *kind;
    job.input = words.input;
    job.out = words.out;
    job.skeleton = words.skeleton;
    return {};
}

int list_species() {
    for (const trees::species_entry& entry : trees::all_species()) {
        std::printf("%-22.*s %.*s\n", static_cast<int>(entry.name.size()), entry.name.data(),
                    static_cast<int>(entry.title.size()), entry.title.data());
    }
    return exit_done;
}

result<void> make_on_backend(tree_job& job) {
    switch (job.common.backend) {
    case backend_kind::opengl:
        return make_tree_on_opengl(job);
    case backend_kind::vulkan:
        return make_tree_on_vulkan(job);
    default:
        return make_tree_on_cpu(job);
    }
}

constexpr const char* backend_names[] = {"cpu", "opengl", "vulkan"};

const char* backend_name(const tree_job& job) {
    return backend_names[static_cast<std::size_t>(job.common.backend)];
}

nlohmann::ordered_json stats_of(const tree_job& job) {
    nlohmann::ordered_json stats;
    stats["command"] = "tree";
    stats["version"] = SKYBARK_VERSION;
    stats["input"] = job.input;
    stats["output"] = job.out;
    stats["backend"] = backend_name(job);
    stats["device"] = job.device;
    stats["driver"] = job.driver;
    // A chain shares an end between neighbours, so that it has one more than segments.
    const std::size_t segments = job.layout.segments.size();
    stats["counts"] = {{"segments", segments},       {"chains", job.layout.ends.size() - segments},
                       {"vertices", job.vertices},   {"indices", job.indices},
                       {"triangles", job.triangles}, {"parts", job.parts}};
    for (const auto& [name, seconds] : job.time.seconds()) {
        stats["seconds"][name] = seconds;
    }
    stats["seconds"]["total"] = job.time.total();
    stats["bytes"] = {{"up", job.traffic.up}, {"down", job.traffic.down}};
    return stats;
}

result<void> write_stats(const tree_job& job) {
    if (job.common.stats.empty()) {
        return {};
    }
    // What isn't UTF-8 in a file's name is replaced, where the default would throw.
    const auto replace = nlohmann::ordered_json::error_handler_t::replace;
    return io::write_file(job.common.stats, stats_of(job).dump(2, ' ', false, replace) + "\n");
}

void summarise(const tree_job& job) {
    if (job.common.quiet) {
        return;
    }
    std::printf("%s: %zu segments, %llu triangles, %.2f s on %s (%s)\n", job.out.c_str(),
                job.layout.segments.size(), static_cast<unsigned long long>(job.triangles),
                job.time.total(), backend_name(job), job.device.c_str());
}

/// What can be known to fail is told before the work is done.
result<void> check_files(const tree_job& job) {
    if (auto good = io::check_writable(job.out); !good) {
        return good;
    }
    return job.common.stats.empty() ? result<void>() : io::check_writable(job.common.stats);
}

int run_tree(const tree_words& words) {
    if (words.list) {
        return list_species();
    }
    tree_job job(words.common.quiet);
    if (auto good = check_words(words, job); !good) {
        return usage_error("tree", good.error().message);
    }
    auto done = check_files(job);
    if (done) {
        done = make_on_backend(job);
    }
    job.time.end(); // takes the bar away before a sentence comes
    if (done) {
        done = write_stats(job);
    }
    if (!done) {
        return report_failure(done.error());
    }
    summarise(job);
    return exit_done;
}

} // namespace

result<void> read_layout(tree_job& job) {
    job.time.begin("read");
    auto segments = io::read_tree(job.input, job.common.seed);
    if (!segments) {
        return failure(segments.error());
    }
    job.time.begin("build");
    const auto skeleton = trees::build_skeleton(*segments);
    if (!skeleton) {
        return fail(skeleton.error().code,
                    io::in_quotes(job.input) + ": " + skeleton.error().message);
    }
    segments = {};
    const trees::bounding_box box = trees::bounds(*skeleton);
    job.low = box.min;
    job.high = box.max;
    if (!job.skeleton) {
        job.layout = trees::layout_branches(*skeleton, job.mesh.frame);
        return {};
    }
    // As thin as a pencil's line beside the tree; one that lies on the ground has no height.
    const float height = trees::height(*skeleton);
    const float size = height > 0 ? height : glm::distance(box.min, box.max);
    job.layout = skeleton_layout(*skeleton, 0.0012f * size);
    return {};
}

void remove_degenerate(trees::host_mesh& list) {
    // Padding is zero bytes, and no vertex of a surface has a normal of zero.
    std::erase_if(list.vertices, [](const surface_vertex& v) { return v.normal == glm::vec3(0); });
    list.indices.resize(list.vertices.size());
}

result<void> write_mesh(const tree_job& job, const trees::host_mesh& mesh) {
    switch (job.kind) {
    case tree_output::glb:
        return io::write_glb(job.out, mesh.vertices, mesh.indices);
    case tree_output::ply:
        return io::write_ply(job.out, mesh.vertices, mesh.indices);
    default:
        return io::write_obj(job.out, mesh.vertices, mesh.indices);
    }
}

result<void> write_picture(const tree_job& job, std::span<const std::uint8_t> rgba) {
    return io::write_png(job.out, rgba, job.common.width, job.common.height);
}

command add_tree_command(CLI::App& to) {
    const auto words = std::make_shared<tree_words>();
    CLI::App* tree = to.add_subcommand("tree", "Mesh the branches of a tree");
    tree->add_option("INPUT", words->input,
                     "Cylinders (.csv), a multiscale tree graph (.mtg), our own description "
                     "(.json) or a built-in species (--list)");
    tree->add_option("-o,--output", words->out,
                     "A picture (.png) or a mesh (.obj, .glb, .ply); required")
        ->type_name("OUT");
    tree->add_option("--sides", words->sides, "Of a ring around a branch, 3 to 1024 (8)")
        ->type_name("N");
    tree->add_option("--rings", words->rings, "Along a segment, 2 to 1024 (4)")->type_name("N");
    tree->add_option("--frame", words->frame,
                     "How rings turn along a segment: slerp or rmf, rotation-minimising (slerp)")
        ->type_name("F");
    tree->add_option("--padding", words->padding,
                     "Of a triangle list: degenerate or compact (compact)")
        ->type_name("P");
    tree->add_option("--form", words->form,
                     "How a device holds the mesh: rings under an index buffer, or a triangle "
                     "list (rings)")
        ->type_name("F");
    tree->add_flag("--skeleton", words->skeleton, "The segments alone, as thin sticks");
    tree->add_flag("--list", words->list, "Name the built-in species, and do nothing else");
    add_common_options(*tree, words->common);
    return {"tree", [words] { return run_tree(*words); }};
}

} // namespace skybark::tool
