// Whole trees as the tool writes them: closed, in leaf, in the wind, frame by frame, near and far.

#include "mesh_files.hpp"
#include "pictures.hpp"

#include "../support/sample_qsm.hpp"
#include "../support/surface_topology.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <io/write_png.hpp>

using namespace skybark::tests;
using nlohmann::json;

namespace {

const char* const backends[] = {"cpu", "opengl", "vulkan"};

class tool_trees : public tool {
  protected:
    /// The scan where there is one, else one like it.
    std::string scan() {
        const char* data = std::getenv("SKYBARK_TEST_DATA");
        const std::string real = std::string(data ? data : "") + "/small_tree_qsm.csv";
        return data != nullptr && std::filesystem::exists(real) ? real : sample();
    }
    /// Some hundred segments.
    std::string sample() {
        write_file(in_folder("sample.csv"),
                   skybark::support::qsm_text(skybark::support::sample_cylinders(6)));
        return in_folder("sample.csv");
    }
    /// Runs `skybark tree INPUT -o OUT`; an outcome other than 0 is a failure.
    json make(const std::string& input, const std::string& out, const words& more = {}) {
        words arguments{"tree", input,     "-o", in_folder(out), "--sides",
                        "4",    "--rings", "3",  "--stats",      in_folder("s.json")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        last = skybark(arguments);
        EXPECT_EQ(last.code, 0) << last.err;
        return json::parse(read_file(folder / "s.json"), nullptr, false);
    }
    /// Code 1, a sentence with these parts, and nothing new in the folder.
    void expect_failed(words arguments, const words& parts) {
        const auto before = names();
        arguments.insert(arguments.begin(), {"tree", "quaking_aspen"});
        const outcome o = skybark(arguments);
        EXPECT_EQ(o.code, 1) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(names(), before);
    }
    outcome last;
};

/// Closed, by the positions that the file itself numbers.
void expect_closed(const read_mesh& mesh, const std::string& what) {
    const auto found = skybark::support::examine_surface(mesh.places, mesh.indices);
    EXPECT_EQ(found.boundary_edges, 0u) << what;
    EXPECT_EQ(found.crowded_edges, 0u) << what;
    EXPECT_EQ(found.pinched, 0u) << what;
    EXPECT_EQ(found.components.size(), 1u) << what;
    EXPECT_TRUE(found.spheres(1)) << what;
}

double height_of(const read_mesh& mesh) {
    double low = std::numeric_limits<double>::max();
    double high = -low;
    for (const vector3& p : mesh.positions) {
        low = std::min(low, p[1]);
        high = std::max(high, p[1]);
    }
    return high - low;
}

double distance(const vector3& a, const vector3& b) {
    const vector3 d = minus(a, b);
    return std::sqrt(dot(d, d));
}

struct apart {
    double mean = 0;
    double most = 0;
};
apart compare(const std::vector<vector3>& a, const std::vector<vector3>& b) {
    apart found;
    if (a.size() != b.size() || a.empty()) {
        ADD_FAILURE() << a.size() << " places and " << b.size();
        return found;
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = distance(a[i], b[i]);
        found.mean += d / static_cast<double>(a.size());
        found.most = std::max(found.most, d);
    }
    return found;
}

} // namespace

// ---- Closed surfaces ----------------------------------------------------------------------------

class tool_trees_on : public tool_trees, public testing::WithParamInterface<const char*> {};

TEST_P(tool_trees_on, closed_files_are_closed_at_rest_and_in_a_gale) {
    std::vector<std::string> inputs{scan()};
    if (GetParam() == std::string("cpu")) {
        inputs.push_back("quaking_aspen");
    }
    for (const std::string& input : inputs) {
        words more{"--backend", GetParam()};
        const outcome there =
            skybark({"tree", sample(), "-o", in_folder("a.obj"), "--backend", GetParam()});
        SKYBARK_SKIP_UNAVAILABLE(there, GetParam());
        make(input, "still.obj", more);
        more.insert(more.end(), {"--wind", "25", "--at", "3"});
        make(input, "gale.obj", more);
        const read_mesh still = read_obj(in_folder("still.obj"));
        const read_mesh gale = read_obj(in_folder("gale.obj"));
        expect_sound(still, closed_surface);
        expect_closed(still, input + " at rest");
        expect_closed(gale, input + " in a gale");
        EXPECT_EQ(still.indices, gale.indices);
        const double height = height_of(still);
        EXPECT_GT(compare(still.positions, gale.positions).most, 0.005 * height) << input;
        EXPECT_LT(compare(still.positions, gale.positions).most, 1.5 * height) << input;
    }
}

TEST_F(tool_trees, bark_adds_triangles_and_leaves_it_closed) {
    const auto plain = make(sample(), "plain.obj");
    const auto rough = make(sample(), "rough.obj", {"--bark", "0.02"});
    EXPECT_GT(rough["counts"]["triangles"].get<double>(),
              1.5 * plain["counts"]["triangles"].get<double>());
    const read_mesh mesh = read_obj(in_folder("rough.obj"));
    expect_closed(mesh, "bark");
    EXPECT_EQ(mesh.indices.size(), rough["counts"]["indices"].get<std::size_t>());
}

// ---- Leaves -------------------------------------------------------------------------------------

TEST_P(tool_trees_on, leaves_are_a_material_of_their_own) {
    words arguments{"tree",    sample(), "-o",        in_folder("a.glb"), "--leaves",
                    "--sides", "4",      "--backend", GetParam()};
    const outcome o = skybark(arguments);
    SKYBARK_SKIP_UNAVAILABLE(o, GetParam());
    ASSERT_EQ(o.code, 0) << o.err;
    const tinygltf::Model model = load_glb(in_folder("a.glb"));
    ASSERT_EQ(model.meshes.size(), 2u);
    ASSERT_EQ(model.materials.size(), 2u);
    EXPECT_EQ(model.materials[0].name, "bark");
    EXPECT_EQ(model.materials[0].alphaMode, "OPAQUE");
    EXPECT_EQ(model.materials[1].name, "leaf");
    EXPECT_EQ(model.materials[1].alphaMode, "MASK");
    EXPECT_TRUE(model.materials[1].doubleSided);
    const auto picture = [&](int texture) -> const tinygltf::Image& {
        const auto& t = model.textures.at(static_cast<std::size_t>(texture));
        return model.images.at(static_cast<std::size_t>(t.source));
    };
    const auto& bark = picture(model.materials[0].pbrMetallicRoughness.baseColorTexture.index);
    const auto& relief = picture(model.materials[0].normalTexture.index);
    const auto& blade = picture(model.materials[1].pbrMetallicRoughness.baseColorTexture.index);
    for (const tinygltf::Image* image : {&bark, &relief, &blade}) {
        ASSERT_GT(image->width, 15);
        ASSERT_GT(image->height, 15);
        ASSERT_EQ(image->component, 4);
        ASSERT_EQ(image->image.size(), static_cast<std::size_t>(4 * image->width * image->height));
    }
    // A leaf is opaque in its middle and nothing at its corners; a normal map looks outwards.
    const auto alpha = [&](int x, int y) {
        return blade.image[static_cast<std::size_t>(4 * (y * blade.width + x) + 3)];
    };
    EXPECT_EQ(alpha(blade.width / 2, blade.height / 2), 255);
    EXPECT_EQ(alpha(0, 0), 0);
    EXPECT_EQ(alpha(blade.width - 1, blade.height - 1), 0);
    for (std::size_t i = 0; i < relief.image.size(); i += 4) {
        ASSERT_GT(relief.image[i + 2], 127);
    }
    for (const std::size_t number : {0u, 1u}) {
        const read_mesh mesh = mesh_of(model, number);
        expect_sound(mesh, closed_surface);
        expect_tangents(mesh);
    }
}

TEST_F(tool_trees, leaves_of_an_obj_have_their_material) {
    const auto stats = make(sample(), "a.obj", {"--leaves"});
    const read_mesh mesh = read_obj(in_folder("a.obj"));
    expect_sound(mesh, closed_surface);
    const auto of_leaves =
        static_cast<std::size_t>(std::count(mesh.materials.begin(), mesh.materials.end(), "leaf"));
    EXPECT_EQ(of_leaves, 6 * stats["counts"]["leaves"].get<std::size_t>());
    EXPECT_EQ(of_leaves + static_cast<std::size_t>(
                              std::count(mesh.materials.begin(), mesh.materials.end(), "bark")),
              mesh.materials.size());
    EXPECT_TRUE(has(read_file(folder / "a.mtl"), {"newmtl bark", "newmtl leaf", "map_d"}));
    for (const char* name : {"a_bark.png", "a_bark_normal.png", "a_leaf.png"}) {
        EXPECT_GT(read_png(in_folder(name)).width, 0) << name;
    }
}

// ---- Frames -------------------------------------------------------------------------------------

namespace {

/// Plays an animated file by the specification's formulas (3.7.3.3, appendix C), in double.
class player {
  public:
    explicit player(tinygltf::Model model) : model_(std::move(model)) {
        for (const auto& node : model_.nodes) {
            rest_.push_back(node);
        }
    }

    /// Where the vertices of mesh `mesh` are at key `key`.
    std::vector<vector3> positions(int mesh, std::size_t key) {
        model_.nodes = rest_;
        for (const auto& channel : model_.animations.at(0).channels) {
            const auto& sampler =
                model_.animations[0].samplers.at(static_cast<std::size_t>(channel.sampler));
            tinygltf::Node& node = model_.nodes.at(static_cast<std::size_t>(channel.target_node));
            if (channel.target_path == "rotation") {
                const auto r = floats_of<4>(model_, sampler.output).at(key);
                node.rotation.assign(r.begin(), r.end());
            } else {
                const auto t = floats_of<3>(model_, sampler.output).at(key);
                node.translation.assign(t.begin(), t.end());
            }
        }
        global_.assign(model_.nodes.size(), glm::dmat4(1));
        for (const int root : model_.scenes.at(0).nodes) {
            place(static_cast<std::size_t>(root), glm::dmat4(1));
        }
        for (const auto& node : model_.nodes) {
            if (node.mesh == mesh) {
                return skinned(node);
            }
        }
        ADD_FAILURE() << "no node has mesh " << mesh;
        return {};
    }

  private:
    void place(std::size_t i, const glm::dmat4& parent) {
        const auto& node = model_.nodes.at(i);
        glm::dmat4 local(1);
        if (!node.translation.empty()) {
            const auto& t = node.translation;
            local = glm::translate(local, glm::dvec3(t[0], t[1], t[2]));
        }
        if (!node.rotation.empty()) {
            const auto& r = node.rotation;
            local *= glm::mat4_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
        }
        global_[i] = parent * local;
        for (const int child : node.children) {
            place(static_cast<std::size_t>(child), global_[i]);
        }
    }

    std::vector<vector3> skinned(const tinygltf::Node& node) {
        const auto& skin = model_.skins.at(static_cast<std::size_t>(node.skin));
        const auto inverse = floats_of<16>(model_, skin.inverseBindMatrices);
        std::vector<glm::dmat4> joints;
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            glm::dmat4 m;
            for (int k = 0; k < 16; ++k) {
                m[k / 4][k % 4] = inverse.at(j)[static_cast<std::size_t>(k)];
            }
            joints.push_back(global_[static_cast<std::size_t>(skin.joints[j])] * m);
        }
        const auto& attributes =
            model_.meshes.at(static_cast<std::size_t>(node.mesh)).primitives.at(0).attributes;
        const auto bound = floats_of<3>(model_, attributes.at("POSITION"));
        const auto which =
            elements<std::array<std::uint16_t, 4>>(model_, attributes.at("JOINTS_0"));
        const auto weight = floats_of<4>(model_, attributes.at("WEIGHTS_0"));
        std::vector<vector3> all;
        for (std::size_t i = 0; i < bound.size(); ++i) {
            glm::dvec4 sum(0);
            for (std::size_t k = 0; k < 4; ++k) {
                sum += weight[i][k] * (joints.at(which[i][k]) *
                                       glm::dvec4(bound[i][0], bound[i][1], bound[i][2], 1));
            }
            all.push_back({sum.x, sum.y, sum.z});
        }
        return all;
    }

    tinygltf::Model model_;
    std::vector<tinygltf::Node> rest_;
    std::vector<glm::dmat4> global_;
};

} // namespace

// A file that plays, beside the same frames as files of their own. Tubes agree to a micrometre; a
// point of a collar is carried as the nearest corner of the triangle that it lies on, which with
// two rings a segment is off by up to a sixth of the largest motion, and by a thousandth in the
// mean.
TEST_P(tool_trees_on, an_animated_file_plays_the_frames) {
    const words wind{"--frames", "12", "--fps",   "4", "--wind",    "20",
                     "--sides",  "3",  "--rings", "2", "--backend", GetParam()};
    const auto tree = [&](const std::string& out) {
        words arguments{"tree",         "quaking_aspen", "-o",
                        in_folder(out), "--stats",       in_folder("s.json")};
        arguments.insert(arguments.end(), wind.begin(), wind.end());
        return skybark(arguments);
    };
    const outcome o = tree("a.glb");
    SKYBARK_SKIP_UNAVAILABLE(o, GetParam());
    ASSERT_EQ(o.code, 0) << o.err;
    const json stats = json::parse(read_file(folder / "s.json"), nullptr, false);
    EXPECT_EQ(stats["counts"]["frames"], 12);
    const tinygltf::Model model = load_glb(in_folder("a.glb"));
    ASSERT_EQ(model.animations.size(), 1u);
    ASSERT_EQ(model.skins.size(), 1u);
    EXPECT_EQ(model.skins[0].joints.size(), stats["counts"]["segments"].get<std::size_t>());
    ASSERT_FALSE(model.animations[0].channels.empty());
    for (const auto& sampler : model.animations[0].samplers) {
        const auto keys = floats_of<1>(model, sampler.input);
        ASSERT_EQ(keys.size(), 12u);
        for (std::size_t k = 0; k < 12; ++k) {
            ASSERT_NEAR(keys[k][0], static_cast<double>(k) / 4, 1e-6);
        }
    }

    ASSERT_EQ(tree("f_%02d.obj").code, 0);
    const auto all = names();
    for (int k = 0; k < 12; ++k) {
        EXPECT_TRUE(all.count("f_" + std::string(k < 10 ? "0" : "") + std::to_string(k) + ".obj"));
    }
    player plays(model);
    const read_mesh first = read_obj(in_folder("f_00.obj"));
    const double height = height_of(first);
    EXPECT_LT(compare(plays.positions(0, 0), first.positions).most, 1e-5 * height) << "at rest";
    for (const char* key : {"04", "11"}) {
        const read_mesh frame = read_obj(in_folder("f_" + std::string(key) + ".obj"));
        const apart moved = compare(frame.positions, first.positions);
        const apart off =
            compare(plays.positions(0, static_cast<std::size_t>(std::stoi(key))), frame.positions);
        EXPECT_GT(moved.most, 1e-3 * height);
        EXPECT_LT(off.mean, 0.005 * moved.mean);
        EXPECT_LT(off.most, 0.2 * moved.most);
    }
}

TEST_F(tool_trees, an_apng_has_its_frames) {
    make(sample(), "a.apng", {"--frames", "5", "--fps", "10", "--wind", "8", "--size", "48x32"});
    const std::string file = read_file(folder / "a.apng");
    const auto word = [&](std::size_t at) { // big end first
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            value = value << 8u | static_cast<unsigned char>(file.at(at + i));
        }
        return value;
    };
    ASSERT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
    std::size_t controls = 0;
    std::uint32_t said = 0;
    for (std::size_t at = 8; at + 12 <= file.size(); at += 12 + word(at)) {
        const std::string type = file.substr(at + 4, 4);
        controls += type == "fcTL" ? 1 : 0;
        said = type == "acTL" ? word(at + 8) : said;
    }
    EXPECT_EQ(said, 5u);
    EXPECT_EQ(controls, 5u);
    EXPECT_EQ(file.substr(file.size() - 8, 4), "IEND");
    EXPECT_EQ(names(), (std::set<std::string>{"a.apng", "s.json", "sample.csv"}));
}

// When the disk is full in the middle, there are whole frames or none, and nothing half-written.
TEST_F(tool_trees, failing_frames_leave_no_file_behind) {
    const words more{"--frames", "3", "--size", "160x120"};
    for (const std::string out : {"a.apng", "a.glb", "f_%d.png", "f_%d.obj"}) {
        words arguments{"tree", "quaking_aspen", "--sides", "4", "-o", in_folder(out)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const outcome o = skybark_after("ulimit -f 1", arguments);
        EXPECT_EQ(o.code, 1) << out;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_EQ(names(), std::set<std::string>{}) << out;
    }
}

// ---- Pictures -----------------------------------------------------------------------------------

// Leaves and twigs are thinner than a pixel here, and three samples a pixel in each direction find
// them on one side of an edge or the other.
TEST_F(tool_trees, the_backends_draw_the_same_tree_in_the_wind) {
    std::vector<read_picture> pictures;
    for (const char* backend : backends) {
        const std::string name = std::string(backend) + ".png";
        const outcome o = skybark({"tree", "quaking_aspen", "-o", in_folder(name), "--wind", "8",
                                   "--at", "1", "--size", "160x120", "--backend", backend});
        if (o.code == 3 && !is_required(backend)) {
            continue;
        }
        ASSERT_EQ(o.code, 0) << o.err;
        pictures.push_back(read_png(in_folder(name)));
        ASSERT_EQ(pictures.back().width, 160);
        const auto found = compare(pictures.back(), pictures.front());
        EXPECT_LT(found.mean, 1) << backend;
        EXPECT_LE(found.far, 0.005) << backend;
        RecordProperty(std::string(backend) + "_mean", std::to_string(found.mean));
        RecordProperty(std::string(backend) + "_far", std::to_string(found.far));
    }
    // That it sees a difference: the tree at rest.
    const outcome o =
        skybark({"tree", "quaking_aspen", "-o", in_folder("still.png"), "--size", "160x120"});
    ASSERT_EQ(o.code, 0);
    EXPECT_GT(compare(read_png(in_folder("still.png")), pictures.front()).mean, 1);
}

// Fewer triangles, and a picture that hardly shows it.
TEST_F(tool_trees, less_detail_looks_nearly_the_same) {
    const words size{"--size", "160x120"};
    const auto full = make("quaking_aspen", "full.png", size);
    const auto less = make("quaking_aspen", "less.png", {"--size", "160x120", "--lod", "1"});
    EXPECT_LT(less["counts"]["triangles"].get<double>(),
              0.7 * full["counts"]["triangles"].get<double>());
    const auto found = compare(read_png(in_folder("full.png")), read_png(in_folder("less.png")));
    EXPECT_LT(found.mean, 4);
    EXPECT_GT(found.mean, 0);
}

// ---- Maps ---------------------------------------------------------------------------------------

TEST_F(tool_trees, maps_change_the_picture) {
    // A leaf that is red all over.
    std::vector<std::uint8_t> red;
    for (int i = 0; i < 16 * 16; ++i) {
        red.insert(red.end(), {255, 0, 0, 255});
    }
    ASSERT_TRUE(skybark::io::write_png(in_folder("red.png"), red, 16, 16));
    make("quaking_aspen", "a.png", {"--leaf-map", in_folder("red.png"), "--size", "64x48"});
    make("quaking_aspen", "b.png", {"--size", "64x48"});
    const auto redness = [](const read_picture& p) {
        std::size_t count = 0;
        for (std::size_t i = 0; i + 3 < p.rgba.size(); i += 4) {
            count += p.rgba[i] > 2 * p.rgba[i + 1] ? 1 : 0;
        }
        return count;
    };
    EXPECT_GT(redness(read_png(in_folder("a.png"))),
              10 * redness(read_png(in_folder("b.png"))) + 20);
    // Steps in the bark.
    for (std::size_t i = 0; i < red.size(); ++i) {
        red[i] = (i / 32) % 2 == 0 ? 255 : 0;
    }
    ASSERT_TRUE(skybark::io::write_png(in_folder("steps.png"), red, 16, 16));
    make(sample(), "a.obj", {"--bark", "0.03", "--bark-map", in_folder("steps.png")});
    make(sample(), "b.obj", {"--bark", "0.03"});
    EXPECT_NE(read_obj(in_folder("a.obj")).positions, read_obj(in_folder("b.obj")).positions);
}

TEST_F(tool_trees, maps_that_are_no_images_are_named) {
    std::vector<std::uint8_t> grey(std::size_t{4} * 64 * 64);
    for (std::size_t i = 0; i < grey.size(); ++i) {
        grey[i] = static_cast<std::uint8_t>(i * i % 251);
    }
    ASSERT_TRUE(skybark::io::write_png(in_folder("whole.png"), grey, 64, 64));
    const std::string whole = read_file(folder / "whole.png");
    write_file(in_folder("empty.png"), "");
    write_file(in_folder("text.png"), "This is no picture, whatever its name says.");
    write_file(in_folder("cut.png"), whole.substr(0, whole.size() / 2));
    std::filesystem::create_directory(folder / "folder.png");
    for (const char* name : {"none.png", "empty.png", "text.png", "cut.png", "folder.png"}) {
        const std::string map = in_folder(name);
        const std::string out = in_folder("a.obj");
        expect_failed({"-o", out, "--bark", "0.02", "--bark-map", map}, {name});
        expect_failed({"-o", out, "--leaf-map", map}, {name});
        expect_failed({"-o", in_folder("f_%d.png"), "--frames", "2", "--leaf-map", map}, {name});
    }
}

// ---- Seeds --------------------------------------------------------------------------------------

TEST_F(tool_trees, runs_are_the_same_and_seeds_are_winds) {
    const std::string input = sample();
    const words wind{"--wind", "10", "--at", "1", "--leaves", "--bark", "0.02"};
    for (const std::string name : {"a.glb", "a.ply", "a.png"}) {
        words more = wind;
        more.insert(more.end(), {"--size", "64x48"});
        make(input, name, more);
        const std::string first = read_file(folder / name);
        make(input, name, more);
        EXPECT_TRUE(read_file(folder / name) == first) << name;
    }
    make(input, "calm_1.obj", {"--seed", "1"});
    make(input, "calm_2.obj", {"--seed", "2"});
    EXPECT_EQ(read_obj(in_folder("calm_1.obj")).positions,
              read_obj(in_folder("calm_2.obj")).positions)
        << "a scan grows from no seed";
    make(input, "wind_1.obj", {"--seed", "1", "--wind", "10", "--at", "1"});
    make(input, "wind_2.obj", {"--seed", "2", "--wind", "10", "--at", "1"});
    const apart found = compare(read_obj(in_folder("wind_1.obj")).positions,
                                read_obj(in_folder("wind_2.obj")).positions);
    EXPECT_GT(found.most, 1e-3);
    make(input, "steady_1.obj", {"--seed", "1", "--wind", "10", "--at", "1", "--gusts", "none"});
    make(input, "steady_2.obj", {"--seed", "2", "--wind", "10", "--at", "1", "--gusts", "none"});
    EXPECT_EQ(read_obj(in_folder("steady_1.obj")).positions,
              read_obj(in_folder("steady_2.obj")).positions);
}

// The wind blows where the compass says: from the west a mast leans east, +X.
TEST_F(tool_trees, trees_lean_away_from_the_wind) {
    std::string mast = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n";
    for (int i = 0; i < 10; ++i) {
        mast += std::to_string(i) + "," + std::to_string(i - 1) + ",0,0," + std::to_string(i) +
                ",0,0," + std::to_string(i + 1) + ",0.03\n";
    }
    write_file(in_folder("mast.csv"), mast);
    for (const auto& [from, axis, sign] :
         {std::tuple{"270", 0, 1.0}, std::tuple{"90", 0, -1.0}, std::tuple{"0", 2, 1.0}}) {
        make(in_folder("mast.csv"), "a.obj",
             {"--wind", "15", "--wind-from", from, "--gusts", "none", "--sway", "quasi_static",
              "--at", "0.5"});
        const read_mesh mesh = read_obj(in_folder("a.obj"));
        vector3 top{};
        for (const vector3& p : mesh.positions) {
            top = p[1] > top[1] ? p : top;
        }
        const auto along = static_cast<std::size_t>(axis);
        EXPECT_GT(sign * top[along], 0.05) << from;
        EXPECT_LT(std::abs(top[2 - along]), 0.04) << from;
    }
}

INSTANTIATE_TEST_SUITE_P(backends, tool_trees_on, testing::ValuesIn(backends),
                         [](const auto& p) { return std::string(p.param); });
