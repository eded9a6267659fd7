#include <io/write_glb.hpp>
#include <io/write_obj.hpp>
#include <io/write_ply.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

using namespace skybark;

namespace {

/// One triangle with numbers that are easy to get wrong.
const std::vector<surface_vertex> vertices{
    {{0.1f, -2e-7f, 3}, 0.25f, {0, 0, 1}, 1.5f, {1, 0, 0, 1}},
    {{1e6f, 0, -0.0f}, 0.5f, {0, 1, 0}, 17.25f, {0, 0, 1, -1}},
    {{1.0f / 3, 16777216, -7}, 1, {1, 0, 0}, 0, {0, 1, 0, 1}},
};
const std::vector<std::uint32_t> indices{2, 0, 1};

std::string written(const char* extension, const auto& write) {
    // One for each test: they may run at the same time.
    const std::string path =
        (std::filesystem::temp_directory_path() /
         std::string("skybark_write_mesh_")
             .append(testing::UnitTest::GetInstance()->current_test_info()->name())
             .append(extension))
            .string();
    const auto done = write(path);
    EXPECT_TRUE(done) << done.error().message;
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::filesystem::remove(path);
    return text;
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

} // namespace

TEST(write_obj, writes_the_shortest_numbers_that_read_back) {
    const std::string text = written(
        ".obj", [](const std::string& path) { return io::write_obj(path, vertices, indices); });
    EXPECT_EQ(text.substr(text.find('\n') + 1), "v 0.1 -2e-07 3\n"
                                                "v 1e+06 0 -0\n"
                                                "v 0.33333334 16777216 -7\n"
                                                "vt 0.25 1.5\n"
                                                "vt 0.5 17.25\n"
                                                "vt 1 0\n"
                                                "vn 0 0 1\n"
                                                "vn 0 1 0\n"
                                                "vn 1 0 0\n"
                                                "f 3/3/3 1/1/1 2/2/2\n");
}

TEST(write_obj, writes_more_than_its_buffer) {
    const std::vector<surface_vertex> many(100000, vertices[0]);
    const std::string text = written(
        ".obj", [&](const std::string& path) { return io::write_obj(path, many, indices); });
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 300002);
    EXPECT_EQ(text.substr(text.size() - 20), "f 3/3/3 1/1/1 2/2/2\n");
}

namespace {

/// A folder of its own, gone afterwards.
class write_obj_files : public testing::Test {
  protected:
    void SetUp() override {
        folder = std::filesystem::temp_directory_path() /
                 std::string("skybark_write_obj_")
                     .append(testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::remove_all(folder);
        std::filesystem::create_directory(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    [[nodiscard]] std::string path(const char* name) const { return (folder / name).string(); }
    [[nodiscard]] std::string text(const char* name) const {
        std::ifstream file(folder / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    /// The names in the folder, hidden ones as well.
    [[nodiscard]] std::set<std::string> names() const {
        std::set<std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            all.insert(entry.path().filename().string());
        }
        return all;
    }
    void expect_refused(const io::surface_mesh& mesh,
                        std::span<const io::surface_material> materials, const std::string& part) {
        const auto done = io::write_obj(path("a.obj"), {&mesh, 1}, materials);
        ASSERT_FALSE(done) << part;
        EXPECT_NE(done.error().message.find(part), std::string::npos) << done.error().message;
        EXPECT_EQ(done.error().message.back(), '.');
        EXPECT_EQ(names(), std::set<std::string>{});
    }

    std::filesystem::path folder;
    const std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(16, 200);
};

io::surface_mesh one_mesh() {
    io::surface_mesh mesh;
    mesh.vertices = vertices;
    mesh.indices = indices;
    return mesh;
}

} // namespace

TEST_F(write_obj_files, has_groups_of_materials) {
    io::surface_material bark;
    bark.base_color = {0.25f, 0.5f, 1, 1};
    bark.roughness = 0.75f;
    bark.repeats = {2, 4};
    bark.base_texture = {2, 2, pixels};
    bark.normal_texture = {2, 2, pixels};
    io::surface_material leaf;
    leaf.name = "a leaf/"; // neither one word nor harmless in a path
    leaf.base_texture = {2, 2, pixels};
    leaf.masked = true;
    const std::vector<io::surface_material> materials{bark, leaf};
    const std::vector<std::uint32_t> places{1, 0, 1};
    std::vector<io::surface_mesh> meshes{one_mesh(), one_mesh()};
    meshes[0].places = places;
    meshes[1].name = "leaves";
    meshes[1].material = 1;
    const auto done = io::write_obj(path("my tree.obj"), meshes, materials);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(names(), (std::set<std::string>{"my tree.obj", "my tree.mtl", "my tree_bark.png",
                                              "my tree_bark_normal.png", "my tree_a_leaf_.png"}));
    // Place 0 is vertex 1's and place 1 that of vertices 0 and 2, which 0 gives.
    EXPECT_EQ(text("my tree.obj"), "# Metres, +Y up. 6 vertices, 2 triangles.\n"
                                   "mtllib my tree.mtl\n"
                                   "g branches\n"
                                   "usemtl bark\n"
                                   "v 1e+06 0 -0\n"
                                   "v 0.1 -2e-07 3\n"
                                   "vt 0.5 6\n"
                                   "vt 1 69\n"
                                   "vt 2 0\n"
                                   "vn 0 0 1\n"
                                   "vn 0 1 0\n"
                                   "vn 1 0 0\n"
                                   "f 2/3/3 2/1/1 1/2/2\n"
                                   "g leaves\n"
                                   "usemtl a_leaf_\n"
                                   "v 0.1 -2e-07 3\n"
                                   "v 1e+06 0 -0\n"
                                   "v 0.33333334 16777216 -7\n"
                                   "vt 0.25 1.5\n"
                                   "vt 0.5 17.25\n"
                                   "vt 1 0\n"
                                   "vn 0 0 1\n"
                                   "vn 0 1 0\n"
                                   "vn 1 0 0\n"
                                   "f 5/6/6 3/4/4 4/5/5\n");
    EXPECT_EQ(text("my tree.mtl"), "newmtl bark\n"
                                   "Kd 0.25 0.5 1\n"
                                   "Ks 0 0 0\n"
                                   "d 1\n"
                                   "Pr 0.75\n"
                                   "illum 1\n"
                                   "map_Kd my tree_bark.png\n"
                                   "norm my tree_bark_normal.png\n"
                                   "\n"
                                   "newmtl a_leaf_\n"
                                   "Kd 0.32 0.24 0.17\n"
                                   "Ks 0 0 0\n"
                                   "d 1\n"
                                   "Pr 0.9\n"
                                   "illum 1\n"
                                   "map_Kd my tree_a_leaf_.png\n"
                                   "map_d my tree_a_leaf_.png\n"
                                   "\n");
    EXPECT_EQ(text("my tree_bark.png").substr(1, 3), "PNG");
}

// Whatever fails, no file of several is left, and what was there before is as it was.
TEST_F(write_obj_files, appear_together_or_not_at_all) {
    io::surface_material bark;
    bark.base_texture = {2, 2, pixels};
    std::vector<io::surface_material> materials{bark};
    const io::surface_mesh mesh = one_mesh();
    std::ofstream(folder / "a_bark.png") << "old";
    for (const char* obstacle : {"a.mtl", "a.obj"}) {
        std::filesystem::create_directory(folder / obstacle);
        EXPECT_FALSE(io::write_obj(path("a.obj"), {&mesh, 1}, materials));
        EXPECT_EQ(names(), (std::set<std::string>{"a_bark.png", obstacle}));
        EXPECT_EQ(text("a_bark.png"), "old");
        std::filesystem::remove(folder / obstacle);
    }
    materials[0].base_texture.width = 3;
    EXPECT_FALSE(io::write_obj(path("a.obj"), {&mesh, 1}, materials));
    EXPECT_EQ(names(), std::set<std::string>{"a_bark.png"});
}

TEST_F(write_obj_files, refuse_what_does_not_fit) {
    std::vector<io::surface_material> materials(1);
    io::surface_mesh mesh = one_mesh();
    mesh.material = 1;
    expect_refused(mesh, materials, "of material 1, but there are 1");
    const std::vector<std::uint32_t> beyond{0, 1, 3};
    mesh = one_mesh();
    mesh.indices = beyond;
    expect_refused(mesh, materials, "3 indices");
    mesh.indices = indices;
    mesh.indices = mesh.indices.first(2);
    expect_refused(mesh, materials, "2 indices");
    mesh = one_mesh();
    mesh.places = beyond;
    expect_refused(mesh, materials, "places");
    mesh.places = std::span(indices).first(2);
    expect_refused(mesh, materials, "places");
    materials = {{}, {}};
    materials[0].name = "a b";
    materials[1].name = "a/b";
    expect_refused(one_mesh(), materials, "two materials");
    EXPECT_FALSE(io::write_obj(path("a\nb.obj"), {}, materials));
    EXPECT_EQ(names(), std::set<std::string>{});
}

TEST(write_ply, writes_records_of_the_size_that_it_says) {
    const std::string bytes = written(
        ".ply", [](const std::string& path) { return io::write_ply(path, vertices, indices); });
    const std::size_t at = bytes.find("end_header\n") + 11;
    ASSERT_EQ(bytes.size(), at + 3 * 32 + 13);
    EXPECT_EQ(value_at<float>(bytes, at), 0.1f);
    EXPECT_EQ(value_at<float>(bytes, at + 32), 1e6f);
    EXPECT_EQ(value_at<float>(bytes, at + 32 + 28), 17.25f) << "t";
    EXPECT_EQ(bytes[at + 96], 3);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, at + 97), 2u);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, at + 105), 1u);
}

TEST(write_glb, writes_what_gltf_wants) {
    const std::string bytes = written(
        ".glb", [](const std::string& path) { return io::write_glb(path, vertices, indices); });
    ASSERT_GT(bytes.size(), 20u);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), bytes.size());
    const std::size_t text = value_at<std::uint32_t>(bytes, 12);
    const auto gltf = nlohmann::json::parse(bytes.substr(20, text), nullptr, false);
    ASSERT_TRUE(gltf.is_object());
    const std::size_t binary = 20 + text + 8;
    const auto& primitive = gltf["meshes"][0]["primitives"][0];
    const auto offset_of = [&](const nlohmann::json& accessor) {
        const auto& view =
            gltf["bufferViews"]
                [gltf["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
        return binary + view.value("byteOffset", std::size_t{0});
    };
    const auto& positions =
        gltf["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_EQ(positions["min"][1].get<float>(), -2e-7f);
    EXPECT_EQ(positions["max"][0].get<float>(), 1e6f);
    EXPECT_EQ(positions["count"], 3);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["POSITION"]) + 24),
              1.0f / 3);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["TANGENT"]) + 28), -1.0f);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["TEXCOORD_0"]) + 4), -0.5f)
        << "1 - v";
    EXPECT_EQ(value_at<std::uint32_t>(bytes, offset_of(primitive["indices"])), 2u);
    const auto& pbr = gltf["materials"][0]["pbrMetallicRoughness"];
    EXPECT_EQ(pbr["baseColorFactor"].size(), 4u);
    EXPECT_EQ(pbr.value("metallicFactor", 1.0), 0.0);
}

TEST(write_glb, has_no_mesh_without_triangles) {
    const auto done = io::write_glb("/nowhere/a.glb", {}, {});
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("without triangles"), std::string::npos);
}
