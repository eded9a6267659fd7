// The tree command: its options, its input, its files.

#include "commands.hpp"
#include "tree_job.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <io/atomic_file.hpp>
#include <io/joint_motion.hpp>
#include <io/read_image.hpp>
#include <io/read_tree.hpp>
#include <io/text_input.hpp>
#include <io/write_glb.hpp>
#include <io/write_obj.hpp>
#include <io/write_ply.hpp>
#include <nlohmann/json.hpp>
#include <skybark/trees/species.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <unordered_map>

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
    std::string padding;
    std::string form = "rings";
    tree_option_words more;
    bool skeleton = false;
    bool list = false;
};

result<tree_output> kind_of(const std::string& out) {
    const std::string extension = extension_of(out);
    if (extension == ".png") {
        return tree_output::picture;
    }
    if (extension == ".apng") {
        return tree_output::animation;
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
                    "; expected a name that ends in .png or .apng (a picture), or in .obj, .glb "
                    "or .ply (a mesh).");
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
    const auto policy =
        one_of("--padding", words.padding.empty() ? "compact" : words.padding, paddings);
    if (!policy) {
        return failure(policy.error());
    }
    const auto form = one_of("--form", words.form, forms);
    if (!form) {
        return failure(form.error());
    }
    return trees::branch_mesh_options{*sides_number, *rings_number, *frame, *form, *policy};
}

/// One closed surface a tree, but where something is asked for that others have: lists.
tree_surface surface_of(const tree_words& words, const tree_options& more) {
    if (words.skeleton) {
        return tree_surface::sticks;
    }
    if (more.lod > 0) {
        return tree_surface::detailed;
    }
    const bool list = words.form == "list" || !words.padding.empty();
    return more.tubes || (list && more.bark_depth == 0) ? tree_surface::tubes
                                                        : tree_surface::closed;
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
                    "There is no -o OUT; expected a name that ends in .png, .apng, .obj, .glb or "
                    ".ply.");
    }
    const auto kind = kind_of(words.out);
    if (!kind) {
        return failure(kind.error());
    }
    const auto more = check(words.more, {words.out, words.skeleton, words.form == "list"});
    if (!more) {
        return failure(more.error());
    }
    if (auto good = check_apart({words.input, words.out, common->stats}, "INPUT, -o and --stats");
        !good) {
        return good;
    }
    job.common = *common;
    job.mesh = *mesh;
    job.kind = *kind;
    job.input = words.input;
    job.out = words.out;
    job.more = *more;
    job.surface = surface_of(words, *more);
    if (job.surface == tree_surface::detailed && job.kind == tree_output::glb && more->frames > 1) {
        return fail(error_code::bad_input, "--lod has no frames in a .glb, where all frames share "
                                           "their vertices; expected it without --frames.");
    }
    return {};
}

int list_species() {
    for (const trees::species_entry& entry : trees::all_species()) {
        std::printf("%-22.*s %.*s\n", static_cast<int>(entry.name.size()), entry.name.data(),
                    static_cast<int>(entry.title.size()), entry.title.data());
    }
    return exit_done;
}

/// Branches: segments that don't continue their parents.
std::size_t chains_of(const trees::skeleton& tree) {
    std::size_t chains = 0;
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
        const std::uint32_t p = tree.parent[i];
        chains += p == trees::none || tree.continuation[p] != i ? 1 : 0;
    }
    return chains;
}

nlohmann::ordered_json stats_of(const tree_job& job) {
    auto stats = begin_report("tree", job);
    stats["counts"] = {{"segments", job.tree.size()}, {"chains", chains_of(job.tree)},
                       {"leaves", job.leaves.size()}, {"frames", job.more.frames},
                       {"vertices", job.vertices},    {"indices", job.indices},
                       {"triangles", job.triangles},  {"parts", job.parts}};
    return stats;
}

void summarise(const tree_job& job) {
    if (job.common.quiet) {
        return;
    }
    std::printf("%s: %zu segments, %llu triangles, %.2f s on %s (%s)\n", job.out.c_str(),
                job.tree.size(), static_cast<unsigned long long>(job.triangles), job.time.total(),
                name_of(job.common.backend), job.device.c_str());
}

int run_tree(const tree_words& words) {
    if (words.list) {
        return list_species();
    }
    tree_job job(words.common.quiet);
    if (auto good = check_words(words, job); !good) {
        return usage_error("tree", good.error().message);
    }
    auto done = check_writable({name_of(job, 0), job.common.stats});
    if (done) {
        done = on_backend(job, make_tree_on_cpu, make_tree_on_opengl, make_tree_on_vulkan);
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

} // namespace

result<void> read_skeleton(tree_job& job) {
    job.time.begin("read");
    auto segments = io::read_tree(job.input, job.common.seed);
    if (!segments) {
        return failure(segments.error());
    }
    job.time.begin("build");
    auto skeleton = trees::build_skeleton(*segments);
    if (!skeleton) {
        return fail(skeleton.error().code,
                    io::in_quotes(job.input) + ": " + skeleton.error().message);
    }
    job.tree = std::move(*skeleton);
    const trees::bounding_box box = trees::bounds(job.tree);
    job.low = box.min;
    job.high = box.max;
    return {};
}

namespace {

/// What a bark looks like: its furrows and ridges, and whether it has any.
struct bark_colors {
    glm::vec3 low{0.055f, 0.042f, 0.032f};
    glm::vec3 high{0.31f, 0.255f, 0.205f};
    bool smooth = false;
};

bark_colors bark_of(std::string_view species) {
    if (species == "quaking_aspen") {
        return {{0.36f, 0.37f, 0.30f}, {0.64f, 0.64f, 0.54f}, true};
    }
    if (species == "california_black_oak") {
        return {{0.035f, 0.030f, 0.026f}, {0.20f, 0.175f, 0.15f}, false};
    }
    if (species == "weeping_willow") {
        return {{0.07f, 0.055f, 0.035f}, {0.36f, 0.31f, 0.22f}, false};
    }
    return {};
}

/// Leaves are for pictures of the built-in species, unless the words say otherwise: a scan has
/// none.
bool has_leaves(const tree_job& job, const trees::species_entry* species) {
    const bool is_picture = job.kind == tree_output::picture || job.kind == tree_output::animation;
    const bool by_itself = species != nullptr && is_picture && job.surface != tree_surface::sticks;
    return job.more.leaves.value_or(by_itself);
}

result<void> make_leaves(tree_job& job, const trees::species_entry* species) {
    trees::leaf_options options =
        species != nullptr ? trees::leaves_of(*species) : trees::leaf_options{};
    options.seed = job.common.seed;
    job.leaves = trees::place_leaves(job.tree, options);
    if (job.more.leaf_map.empty()) {
        job.leaf_picture = trees::draw_leaf(options.shape);
    } else {
        auto read = io::read_leaf(job.more.leaf_map);
        if (!read) {
            return fail(error_code::bad_input, read.error().message); // a device is there
        }
        job.leaf_picture = std::move(*read);
    }
    job.maps.leaf_width = job.leaf_picture.width;
    job.maps.leaf_height = job.leaf_picture.height;
    job.maps.leaf = job.leaf_picture.rgba;
    return {};
}

/// The girth of the thickest root, m.
float girth_of(const trees::skeleton& tree) {
    float radius = 0;
    for (std::size_t i = 0; i < tree.size() && tree.parent[i] == trees::none; ++i) {
        radius = std::max(radius, tree.base_radius[i]);
    }
    return 2 * std::numbers::pi_v<float> * radius;
}

} // namespace

result<void> dress(tree_job& job) {
    job.time.begin("build");
    const trees::species_entry* species = trees::find_species(job.input);
    if (has_leaves(job, species)) {
        if (auto done = make_leaves(job, species); !done) {
            return done;
        }
    }
    const bark_colors colors = bark_of(species != nullptr ? species->name : "");
    if (job.more.bark_map.empty()) {
        job.bark = colors.smooth ? trees::smooth_bark(job.common.seed)
                                 : trees::furrowed_bark(job.common.seed);
    } else {
        auto read = io::read_image(job.more.bark_map);
        if (!read) {
            return fail(error_code::bad_input, read.error().message); // a device is there
        }
        job.bark = std::move(*read);
    }
    // A repeat is half a metre around a trunk and 0.7 m along it.
    constexpr float around = 0.5f;
    constexpr float along = 0.7f;
    job.maps.bark_around = std::clamp(std::round(girth_of(job.tree) / around), 1.0f, 64.0f);
    job.maps.bark_along = 1 / along;
    job.maps.bark_low = colors.low;
    job.maps.bark_high = colors.high;
    job.maps.bark_width = job.bark.width;
    job.maps.bark_height = job.bark.height;
    const float relief = colors.smooth && job.more.bark_depth == 0 ? 0.006f : job.relief();
    job.maps.bark = trees::normal_map(job.bark, relief, around, along);
    return {};
}

void remove_degenerate(trees::host_mesh& list) {
    // Padding is zero bytes, and no vertex of a surface has a normal of zero.
    std::erase_if(list.vertices, [](const surface_vertex& v) { return v.normal == glm::vec3(0); });
    list.indices.resize(list.vertices.size());
}

std::vector<std::uint32_t> weld(std::span<const surface_vertex> vertices) {
    struct hash {
        std::size_t operator()(const std::array<std::uint32_t, 3>& words) const {
            std::uint64_t h = 0;
            for (const std::uint32_t word : words) {
                h = (h ^ word) * 0x9e3779b97f4a7c15u;
                h ^= h >> 32;
            }
            return static_cast<std::size_t>(h);
        }
    };
    std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, hash> first;
    first.reserve(vertices.size());
    std::vector<std::uint32_t> places(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const glm::vec3 position = vertices[i].position + 0.0f; // −0 is 0
        std::array<std::uint32_t, 3> words;
        std::memcpy(words.data(), &position, sizeof words);
        places[i] = first.try_emplace(words, static_cast<std::uint32_t>(i)).first->second;
    }
    return places;
}

std::string name_of(const tree_job& job, std::uint32_t frame) {
    return job.more.output == frame_output::numbered ? job.more.name.of(frame) : job.out;
}

namespace {

/// The rows of a picture from the other side: a surface's v grows upwards, a file's rows go down.
std::vector<std::uint8_t> turned_over(std::span<const std::uint8_t> rgba, std::uint32_t width) {
    const std::size_t row = std::size_t{4} * width;
    std::vector<std::uint8_t> turned;
    turned.reserve(rgba.size());
    for (std::size_t end = rgba.size(); row != 0 && end >= row; end -= row) {
        turned.insert(turned.end(), rgba.begin() + static_cast<std::ptrdiff_t>(end - row),
                      rgba.begin() + static_cast<std::ptrdiff_t>(end));
    }
    return turned;
}

/// The bark's colour for each texel of its map, sRGB.
std::vector<std::uint8_t> bark_colors_of(const picture::surface_maps& maps,
                                         std::span<const std::uint8_t> normals) {
    const auto encode = [](float linear) {
        const float s =
            linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(s, 0.0f, 1.0f)));
    };
    std::vector<std::uint8_t> colors(normals.size());
    for (std::size_t i = 0; i + 3 < normals.size(); i += 4) {
        const glm::vec3 albedo =
            glm::mix(maps.bark_low, maps.bark_high, static_cast<float>(normals[i + 3]) / 255);
        for (int c = 0; c < 3; ++c) {
            colors[i + static_cast<std::size_t>(c)] = encode(albedo[c]);
        }
        colors[i + 3] = 255;
    }
    return colors;
}

/// The pictures and materials of a job's mesh files.
struct file_materials {
    explicit file_materials(const tree_job& job) {
        const picture::surface_maps& maps = job.maps;
        normals = turned_over(maps.bark, maps.bark_width);
        colors = bark_colors_of(maps, normals);
        for (std::size_t i = 3; i < normals.size(); i += 4) {
            normals[i] = 255; // heights are no opacity
        }
        io::surface_material bark;
        bark.name = "bark";
        if (job.surface != tree_surface::sticks) {
            bark.base_color = glm::vec4(1);
            bark.base_texture = {maps.bark_width, maps.bark_height, colors};
            bark.normal_texture = {maps.bark_width, maps.bark_height, normals};
            bark.repeats = {maps.bark_around, maps.bark_along};
        }
        materials.push_back(bark);
        if (!job.leaves.empty()) {
            leaf = turned_over(maps.leaf, maps.leaf_width);
            io::surface_material blade;
            blade.name = "leaf";
            blade.base_color = glm::vec4(1);
            blade.base_texture = {maps.leaf_width, maps.leaf_height, leaf};
            blade.masked = true;
            blade.double_sided = true;
            blade.roughness = 0.6f;
            materials.push_back(blade);
        }
    }
    std::vector<std::uint8_t> normals, colors, leaf;
    std::vector<io::surface_material> materials;
};

io::surface_mesh as_surface(const char* name, const finished_surface& from,
                            std::uint32_t material) {
    io::surface_mesh surface;
    surface.name = name;
    surface.vertices = from.mesh.vertices;
    surface.indices = from.mesh.indices;
    surface.material = material;
    surface.places = from.places;
    surface.carriers = from.carriers;
    return surface;
}

/// Takes out the vertices that no triangle has: those where a closed surface has a branch's collar.
void remove_unused(finished_surface& from) {
    constexpr std::uint32_t unused = trees::none;
    trees::host_mesh& mesh = from.mesh;
    std::vector<std::uint32_t> now(mesh.vertices.size(), unused);
    for (const std::uint32_t index : mesh.indices) {
        now[index] = 0;
    }
    std::vector<std::uint32_t> place(from.places.size(), unused);
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (now[i] == unused) {
            continue;
        }
        now[i] = kept;
        mesh.vertices[kept] = mesh.vertices[i];
        if (!from.carriers.empty()) {
            from.carriers[kept] = from.carriers[i];
        }
        if (!from.places.empty()) {
            // A place's number is that of the first vertex there.
            std::uint32_t& own = place[from.places[i]];
            own = own == unused ? kept : own;
            from.places[kept] = own;
        }
        ++kept;
    }
    mesh.vertices.resize(kept);
    from.carriers.resize(from.carriers.empty() ? 0 : kept);
    from.places.resize(from.places.empty() ? 0 : kept);
    for (std::uint32_t& index : mesh.indices) {
        index = now[index];
    }
}

/// Both surfaces as one, for a file that knows no materials.
trees::host_mesh joined(const finished_tree& made) {
    trees::host_mesh all = made.wood.mesh;
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), made.leaves.mesh.vertices.begin(),
                        made.leaves.mesh.vertices.end());
    for (const std::uint32_t index : made.leaves.mesh.indices) {
        all.indices.push_back(first + index);
    }
    return all;
}

} // namespace

result<void> write_mesh(const tree_job& job, finished_tree made, std::uint32_t frame) {
    const std::string name = name_of(job, frame);
    remove_unused(made.wood);
    if (job.kind == tree_output::ply) {
        const trees::host_mesh all = joined(made);
        return io::write_ply(name, all.vertices, all.indices);
    }
    const file_materials look(job);
    std::vector<io::surface_mesh> meshes{as_surface("branches", made.wood, 0)};
    if (!job.leaves.empty()) {
        meshes.push_back(as_surface("leaves", made.leaves, 1));
    }
    if (job.kind == tree_output::obj) {
        return io::write_obj(name, meshes, look.materials);
    }
    io::glb_scene scene;
    scene.meshes = meshes;
    scene.materials = look.materials;
    std::vector<io::joint> joints;
    if (!made.poses.empty()) {
        joints = io::joints_of(job.tree);
        scene.joints = joints;
        scene.poses = made.poses;
        scene.frames_per_second = job.more.fps;
    }
    return io::write_glb(name, scene);
}

command add_tree_command(CLI::App& to) {
    const auto words = std::make_shared<tree_words>();
    CLI::App* tree =
        to.add_subcommand("tree", "Mesh a tree: branches, bark and leaves, at rest or in the wind");
    tree->add_option("INPUT", words->input,
                     "Cylinders (.csv), a multiscale tree graph (.mtg), our own description "
                     "(.json) or a built-in species (--list)");
    tree->add_option("-o,--output", words->out,
                     "A picture (.png, .apng) or a mesh (.obj, .glb, .ply); required")
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
    add_tree_options(*tree, words->more);
    tree->add_flag("--skeleton", words->skeleton, "The segments alone, as thin sticks");
    tree->add_flag("--list", words->list, "Name the built-in species, and do nothing else");
    add_common_options(*tree, words->common);
    return {"tree", [words] { return run_tree(*words); }};
}

} // namespace skybark::tool
