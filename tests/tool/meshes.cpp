// Meshes as other programs read them, and as each backend makes them.

#include "mesh_files.hpp"

#include "../support/sample_qsm.hpp"

using namespace skybark::tests;

namespace {

/// How many triangle corners lie where the surface has a hole: edges that no other triangle has the
/// other way round, by position, since seams and caps have vertices of their own.
std::size_t open_edges(const read_mesh& mesh) {
    std::map<std::pair<vector3, vector3>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            const vector3& a = mesh.positions[mesh.indices[i + k]];
            const vector3& b = mesh.positions[mesh.indices[i + (k + 1) % 3]];
            if (a != b) {
                ++edges[{a, b}];
                --edges[{b, a}];
            }
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) {
        open += count != 0 ? 1 : 0;
    }
    return open;
}

class tool_meshes : public tool {
  protected:
    /// Three segments whose box is known: 2 m tall, and 1 m towards +X.
    std::string small_tree() {
        write_file(in_folder("t.csv"), "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
                                       "1,-1,0,0,0,0,0,1,0.1\n"
                                       "2,1,0,0,1,0,0,2,0.08\n"
                                       "3,1,0,0,1,1,0,1,0.02\n");
        return in_folder("t.csv");
    }
    std::string scanned_tree() {
        write_file(in_folder("scan.csv"),
                   skybark::support::qsm_text(skybark::support::sample_cylinders()));
        return in_folder("scan.csv");
    }
    nlohmann::json make(const std::string& input, const std::string& out, const words& more = {}) {
        words arguments{"tree", input, "-o", in_folder(out), "--stats", in_folder("s.json")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        last = skybark(arguments);
        EXPECT_EQ(last.code, 0) << last.err;
        return nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
    }
    outcome last;
};

/// The device may have a few vertices that no triangle of a closed surface has: where collars are.
void expect_counts(const read_mesh& mesh, const nlohmann::json& stats) {
    const auto vertices = stats["counts"]["vertices"].get<std::size_t>();
    EXPECT_LE(mesh.positions.size(), vertices);
    EXPECT_GT(mesh.positions.size(), 0.8 * static_cast<double>(vertices));
    EXPECT_EQ(mesh.indices.size(), stats["counts"]["indices"].get<std::size_t>());
}

void expect_box(const read_mesh& mesh, const vector3& low, const vector3& high, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        double least = std::numeric_limits<double>::max();
        double most = -least;
        for (const vector3& p : mesh.positions) {
            least = std::min(least, p[k]);
            most = std::max(most, p[k]);
        }
        EXPECT_NEAR(least, low[k], tolerance) << "low, axis " << k;
        EXPECT_NEAR(most, high[k], tolerance) << "high, axis " << k;
    }
}

} // namespace

TEST_F(tool_meshes, obj_is_sound) {
    const auto stats = make(small_tree(), "a.obj", {"--sides", "16"});
    const read_mesh mesh = read_obj(in_folder("a.obj"));
    expect_counts(mesh, stats);
    expect_sound(mesh);
    // Around the trunk its radius; the ends are closed by tips of half a radius.
    expect_box(mesh, {-0.1, 0, -0.1}, {1.01, 2.04, 0.1}, 0.005);
    EXPECT_EQ(open_edges(mesh), 0u);
}

TEST_F(tool_meshes, tubes_are_sound) {
    const auto stats = make(small_tree(), "a.obj", {"--sides", "16", "--tubes"});
    const read_mesh mesh = read_obj(in_folder("a.obj"));
    EXPECT_EQ(mesh.positions.size(), stats["counts"]["vertices"].get<std::size_t>());
    EXPECT_EQ(mesh.indices.size(), stats["counts"]["indices"].get<std::size_t>());
    expect_sound(mesh);
    // The side branch ends at 1 m; the ends are flat.
    expect_box(mesh, {-0.1, 0, -0.1}, {1, 2, 0.1}, 0.005);
    EXPECT_EQ(open_edges(mesh), 0u);
}

TEST_F(tool_meshes, glb_is_sound) {
    const auto stats = make(small_tree(), "a.glb", {"--sides", "16"});
    const read_mesh mesh = read_glb(in_folder("a.glb"));
    expect_counts(mesh, stats);
    expect_sound(mesh);
    expect_tangents(mesh);
    expect_box(mesh, {-0.1, 0, -0.1}, {1.01, 2.04, 0.1}, 0.005);
}

// By the bytes of the specification, without a library.
TEST_F(tool_meshes, glb_has_the_chunks_that_it_says) {
    make(small_tree(), "a.glb");
    const std::string file = read_file(folder / "a.glb");
    const auto word = [&](std::size_t at) {
        std::uint32_t value = 0;
        std::memcpy(&value, file.data() + at, sizeof value);
        return value;
    };
    ASSERT_GT(file.size(), 28u);
    EXPECT_EQ(word(0), 0x46546C67u);
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), file.size());
    EXPECT_EQ(word(16), 0x4E4F534Au);
    const std::uint32_t text = word(12);
    ASSERT_EQ(text % 4, 0u);
    EXPECT_EQ(word(20 + text + 4), 0x004E4942u);
    EXPECT_EQ(28 + text + word(20 + text), file.size());
    const auto gltf = nlohmann::json::parse(file.substr(20, text), nullptr, false);
    ASSERT_TRUE(gltf.is_object());
    EXPECT_EQ(gltf["asset"]["version"], "2.0");
    EXPECT_EQ(gltf["accessors"].size(), 5u);
    EXPECT_EQ(gltf["buffers"][0]["byteLength"], word(20 + text));
}

TEST_F(tool_meshes, obj_and_glb_say_the_same) {
    const std::string scan = scanned_tree();
    const auto stats = make(scan, "a.obj");
    make(scan, "a.glb");
    const read_mesh obj = read_obj(in_folder("a.obj"));
    const read_mesh glb = read_glb(in_folder("a.glb"));
    expect_counts(obj, stats);
    expect_sound(obj, closed_surface);
    expect_tangents(glb);
    EXPECT_EQ(obj.indices, glb.indices);
    ASSERT_EQ(obj.positions.size(), glb.positions.size());
    for (std::size_t i = 0; i < obj.positions.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            // The shortest text of a float reads back as that float.
            ASSERT_EQ(static_cast<float>(obj.positions[i][k]),
                      static_cast<float>(glb.positions[i][k]));
            // What isn't quite a unit's length is, in glTF.
            ASSERT_NEAR(obj.normals[i][k], glb.normals[i][k], 1e-6);
        }
        ASSERT_NEAR(obj.texcoords[i][0], glb.texcoords[i][0], 1e-6);
        ASSERT_NEAR(obj.texcoords[i][1], 1 - glb.texcoords[i][1], 1e-5);
    }
}

TEST_F(tool_meshes, ply_has_the_bytes_that_it_says) {
    const auto stats = make(small_tree(), "a.ply", {"--tubes"});
    const std::string file = read_file(folder / "a.ply");
    const std::string end = "end_header\n";
    const std::size_t header = file.find(end) + end.size();
    EXPECT_TRUE(has(file.substr(0, header),
                    {"format binary_little_endian 1.0",
                     "element vertex " + stats["counts"]["vertices"].dump() + "\n",
                     "element face " + stats["counts"]["triangles"].dump() + "\n"}));
    EXPECT_EQ(file.size(), header + stats["counts"]["vertices"].get<std::size_t>() * 32 +
                               stats["counts"]["triangles"].get<std::size_t>() * 13);
}

TEST_F(tool_meshes, padding_never_reaches_a_file) {
    const std::string input = small_tree();
    make(input, "compact.obj", {"--form", "list"});
    make(input, "padded.obj", {"--form", "list", "--padding", "degenerate"});
    const read_mesh compact = read_obj(in_folder("compact.obj"));
    const read_mesh padded = read_obj(in_folder("padded.obj"));
    expect_sound(padded);
    EXPECT_EQ(compact.indices, padded.indices);
    EXPECT_EQ(compact.positions, padded.positions);
    EXPECT_EQ(compact.normals, padded.normals);
}

TEST_F(tool_meshes, skeleton_is_a_thin_stick_for_each_segment) {
    make(small_tree(), "a.obj", {"--skeleton"});
    const read_mesh mesh = read_obj(in_folder("a.obj"));
    expect_sound(mesh);
    EXPECT_EQ(open_edges(mesh), 0u);
    const double thin = 0.0012 * 2 * 1.001; // of the height
    expect_box(mesh, {-thin, 0, -thin}, {1, 2, thin}, thin);
    for (const vector3& p : mesh.positions) {
        const double from_trunk = std::hypot(p[0], p[2]);
        const double from_branch = std::hypot(p[1] - 1, p[2]);
        EXPECT_LE(std::min(from_trunk, from_branch), thin);
    }
}

TEST_F(tool_meshes, a_seed_grows_the_same_tree_again) {
    make("quaking_aspen", "a.obj", {"--seed", "7", "--sides", "3", "--rings", "2"});
    make("quaking_aspen", "b.obj", {"--seed", "7", "--sides", "3", "--rings", "2"});
    make("quaking_aspen", "c.obj", {"--seed", "8", "--sides", "3", "--rings", "2"});
    const read_mesh a = read_obj(in_folder("a.obj"));
    const read_mesh b = read_obj(in_folder("b.obj"));
    EXPECT_EQ(a.library, "a.mtl");
    EXPECT_TRUE(a.positions == b.positions && a.normals == b.normals && a.indices == b.indices);
    EXPECT_FALSE(a.positions == read_obj(in_folder("c.obj")).positions);
}

namespace {

void expect_same(const read_mesh& a, const read_mesh& b, double height) {
    ASSERT_EQ(a.positions.size(), b.positions.size());
    EXPECT_EQ(a.indices, b.indices);
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(a.positions[i][k], b.positions[i][k], 1e-5 * height) << "vertex " << i;
            ASSERT_NEAR(a.normals[i][k], b.normals[i][k], 1e-3) << "normal " << i;
        }
    }
}

} // namespace

class tool_meshes_on : public tool_meshes, public testing::WithParamInterface<const char*> {};

TEST_P(tool_meshes_on, agrees_with_the_cpu) {
    const std::string backend = GetParam();
    const std::string scan = scanned_tree();
    for (const words& options :
         {words{}, words{"--tubes"}, words{"--sides", "5", "--rings", "9", "--frame", "rmf"},
          words{"--form", "list"}, words{"--form", "list", "--padding", "degenerate"},
          words{"--skeleton"}}) {
        const auto expected = make(scan, "cpu.glb", options);
        words arguments{
            "tree",      scan,   "-o", in_folder("b.glb"), "--stats", in_folder("b.json"),
            "--backend", backend};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const outcome o = skybark(arguments);
        SKYBARK_SKIP_UNAVAILABLE(o, backend);
        ASSERT_EQ(o.code, 0) << o.err;
        const auto stats = nlohmann::json::parse(read_file(folder / "b.json"), nullptr, false);
        EXPECT_EQ(stats["backend"], backend);
        for (const char* count : {"segments", "chains", "vertices", "indices", "triangles"}) {
            EXPECT_EQ(stats["counts"][count], expected["counts"][count]) << count;
        }
        // 10 m and more: the sample's height.
        expect_same(read_glb(in_folder("b.glb")), read_glb(in_folder("cpu.glb")), 10);
    }
}

TEST_P(tool_meshes_on, draws_a_picture) {
    const outcome o = skybark({"tree", scanned_tree(), "-o", in_folder("a.png"), "--size",
                               "160x100", "--backend", GetParam()});
    SKYBARK_SKIP_UNAVAILABLE(o, GetParam());
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_GT(std::filesystem::file_size(folder / "a.png"), 2000u) << "more than one colour";
}

INSTANTIATE_TEST_SUITE_P(backends, tool_meshes_on, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& p) { return std::string(p.param); });
