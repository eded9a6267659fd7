// Scenes from binary glTF: what our own writer makes, what tinygltf's makes, and what is broken.

#include "scene_files.hpp"

#include <io/write_glb.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <tiny_gltf.h>

using namespace skybark;

namespace {

void expect_near(glm::vec3 a, glm::vec3 b, double tolerance = 1e-6) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

tinygltf::Value number(double value) { return tinygltf::Value(value); }

class read_glb_scene : public tests::scene_files {
  protected:
    /// A triangle (0,0,0) (1,0,0) (0,1,0) under a node, with normals and texture coordinates.
    static tinygltf::Model triangle() {
        tinygltf::Model model;
        const std::array<float, 9> places{0, 0, 0, 1, 0, 0, 0, 1, 0};
        const std::array<float, 9> normals{0, 0, 1, 0, 0, 1, 0, 0, 1};
        const std::array<float, 6> coordinates{0, 0, 1, 0, 0, 1};
        const std::array<std::uint16_t, 4> indices{0, 1, 2, 0};
        auto& data = model.buffers.emplace_back().data;
        const auto add = [&](const void* from, std::size_t bytes, std::size_t count, int type,
                             int component) {
            tinygltf::BufferView view;
            view.buffer = 0;
            view.byteOffset = data.size();
            view.byteLength = bytes;
            data.resize(data.size() + bytes);
            std::memcpy(data.data() + view.byteOffset, from, bytes);
            model.bufferViews.push_back(view);
            tinygltf::Accessor accessor;
            accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
            accessor.componentType = component;
            accessor.count = count;
            accessor.type = type;
            model.accessors.push_back(accessor);
        };
        add(places.data(), sizeof places, 3, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT);
        add(normals.data(), sizeof normals, 3, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT);
        add(coordinates.data(), sizeof coordinates, 3, TINYGLTF_TYPE_VEC2,
            TINYGLTF_COMPONENT_TYPE_FLOAT);
        add(indices.data(), 6, 3, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
        tinygltf::Primitive primitive;
        primitive.attributes = {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}};
        primitive.indices = 3;
        primitive.material = 0;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        model.meshes.emplace_back().primitives.push_back(primitive);
        model.nodes.emplace_back().mesh = 0;
        model.scenes.emplace_back().nodes = {0};
        model.defaultScene = 0;
        model.asset.version = "2.0";
        auto& material = model.materials.emplace_back();
        material.name = "m";
        material.pbrMetallicRoughness.baseColorFactor = {0.2, 0.4, 0.6, 1};
        return model;
    }
    void write_model(const tinygltf::Model& model) const {
        ASSERT_TRUE(tinygltf::TinyGLTF().WriteGltfSceneToFile(&model, in_folder("a.glb"), true,
                                                              true, false, true));
    }
    /// The triangle after `change`.
    io::triangle_scene read_changed(const std::function<void(tinygltf::Model&)>& change) const {
        tinygltf::Model model = triangle();
        change(model);
        write_model(model);
        return read("a.glb");
    }
    void expect_change_refused(const std::function<void(tinygltf::Model&)>& change,
                               const std::vector<std::string>& parts) const {
        tinygltf::Model model = triangle();
        change(model);
        write_model(model);
        expect_refused("a.glb", parts);
    }
};

} // namespace

TEST_F(read_glb_scene, reads_what_our_writer_writes) {
    const std::vector<surface_vertex> vertices{{{0, 0, 0}, 0, {0, 0, 1}, 0, {1, 0, 0, 1}},
                                               {{1, 0, 0}, 1, {0, 0, 1}, 0, {1, 0, 0, 1}},
                                               {{1, 1, 0}, 1, {0, 0, 1}, 1, {1, 0, 0, 1}},
                                               {{0, 1, 0}, 0, {0, 0, 1}, 1, {1, 0, 0, 1}}};
    const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
    // Opaque at v > 1/2, as pictures have their first row at the top.
    std::vector<std::uint8_t> rgba(2 * 2 * 4, 255);
    rgba[11] = rgba[15] = 0;
    io::surface_material material;
    material.name = "leaf";
    material.base_color = {0.5f, 0.5f, 0.25f, 1};
    material.base_texture = {2, 2, rgba};
    material.masked = true;
    material.cutoff = 0.25f;
    material.double_sided = true;
    ASSERT_TRUE(io::write_glb(in_folder("a.glb"), vertices, indices, material));
    const io::triangle_scene scene = read("a.glb");
    ASSERT_EQ(scene.triangles.size(), 2u);
    ASSERT_EQ(scene.positions.size(), 4u);
    EXPECT_EQ(scene.triangles[1], glm::uvec3(0, 2, 3));
    EXPECT_EQ(scene.positions[2], glm::vec3(1, 1, 0));
    EXPECT_EQ(scene.normals[2], glm::vec3(0, 0, 1));
    ASSERT_EQ(scene.materials.size(), 1u);
    const io::scene_material& m = scene.materials[0];
    expect_near(m.diffuse, {0.5f, 0.5f, 0.25f});
    EXPECT_TRUE(m.two_sided);
    EXPECT_NEAR(m.cutoff, 0.25, 1e-6);
    ASSERT_EQ(m.alpha_map, 0u);
    EXPECT_EQ(scene.maps[0].values, (std::vector<float>{1, 1, 0, 0}));
    // Our v = 1 is the picture's top: row 0 of the map is where its own v is 0.
    EXPECT_EQ(scene.coordinates[2], glm::vec2(1, 0));
}

TEST_F(read_glb_scene, places_nodes) {
    const io::triangle_scene scene = read_changed([](tinygltf::Model& model) {
        model.nodes[0].translation = {0, 0, 5};
        auto& parent = model.nodes.emplace_back();
        parent.children = {0};
        parent.rotation = {0, std::sqrt(0.5), 0, std::sqrt(0.5)}; // 90° about y: z becomes x
        parent.scale = {2, 3, 1};
        model.scenes[0].nodes = {1};
    });
    ASSERT_EQ(scene.triangles.size(), 1u);
    expect_near(scene.positions[0], {5, 0, 0}, 1e-5);
    expect_near(scene.positions[1], {5, 0, -2}, 1e-5);
    expect_near(scene.positions[2], {5, 3, 0}, 1e-5);
    expect_near(scene.normals[0], {1, 0, 0}, 1e-6);
    const glm::uvec3 t = scene.triangles[0];
    const glm::vec3 face = glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                      scene.positions[t.z] - scene.positions[t.x]);
    EXPECT_GT(face.x, 0);
}

TEST_F(read_glb_scene, turns_mirrored_triangles) {
    const io::triangle_scene scene = read_changed([](tinygltf::Model& model) {
        model.nodes[0].scale = {-1, 1, 1};
    });
    const glm::uvec3 t = scene.triangles.at(0);
    const glm::vec3 face = glm::cross(scene.positions[t.y] - scene.positions[t.x],
                                      scene.positions[t.z] - scene.positions[t.x]);
    EXPECT_GT(face.z, 0) << "its front is where it was";
    EXPECT_EQ(scene.normals[0], glm::vec3(0, 0, 1));
}

TEST_F(read_glb_scene, reads_strips_fans_and_instances) {
    const auto count = [&](int mode) {
        return read_changed([mode](tinygltf::Model& model) {
                   model.meshes[0].primitives[0].mode = mode;
                   model.nodes.emplace_back().mesh = 0; // another instance
                   model.scenes[0].nodes = {0, 1};
               })
            .triangles.size();
    };
    EXPECT_EQ(count(TINYGLTF_MODE_TRIANGLES), 2u);
    EXPECT_EQ(count(TINYGLTF_MODE_TRIANGLE_STRIP), 2u);
    EXPECT_EQ(count(TINYGLTF_MODE_TRIANGLE_FAN), 2u);
    expect_change_refused(
        [](tinygltf::Model& model) { model.meshes[0].primitives[0].mode = TINYGLTF_MODE_POINTS; },
        {"no triangles"});
}

TEST_F(read_glb_scene, reads_materials) {
    const auto scene = read_changed([](tinygltf::Model& model) {
        auto& m = model.materials[0];
        m.emissiveFactor = {1, 0.5, 0};
        m.doubleSided = true;
        m.extensions["KHR_materials_emissive_strength"] =
            tinygltf::Value(tinygltf::Value::Object{{"emissiveStrength", number(8)}});
        m.extensions["KHR_materials_diffuse_transmission"] =
            tinygltf::Value(tinygltf::Value::Object{
                {"diffuseTransmissionFactor", number(0.25)},
                {"diffuseTransmissionColorFactor",
                 tinygltf::Value(tinygltf::Value::Array{number(1), number(0.5), number(0)})}});
        model.extensionsUsed = {"KHR_materials_emissive_strength",
                                "KHR_materials_diffuse_transmission"};
        model.extensionsRequired = {"KHR_materials_emissive_strength"};
    });
    ASSERT_EQ(scene.materials.size(), 1u);
    const io::scene_material& m = scene.materials[0];
    expect_near(m.diffuse, {0.15f, 0.3f, 0.45f});
    expect_near(m.transmission, {0.25f, 0.125f, 0});
    expect_near(m.emission, {8, 4, 0});
    EXPECT_TRUE(m.two_sided);
    const auto glass = read_changed([](tinygltf::Model& model) {
        model.materials[0].extensions["KHR_materials_transmission"] =
            tinygltf::Value(tinygltf::Value::Object{{"transmissionFactor", number(0.5)}});
    });
    expect_near(glass.materials.at(0).transmission, {0.1f, 0.2f, 0.3f});
    EXPECT_TRUE(glass.materials.at(0).two_sided);
    const auto blend = read_changed([](tinygltf::Model& model) {
        model.materials[0].alphaMode = "BLEND";
        model.materials[0].pbrMetallicRoughness.baseColorFactor[3] = 0.5;
    });
    expect_near(blend.materials.at(0).diffuse, {0.1f, 0.2f, 0.3f});
    expect_near(blend.materials.at(0).transmission, glm::vec3(0.5f));
    const auto none =
        read_changed([](tinygltf::Model& model) { model.meshes[0].primitives[0].material = -1; });
    EXPECT_EQ(none.materials.at(none.material_of.at(0)).diffuse, glm::vec3(1)) << "glTF's default";
}

TEST_F(read_glb_scene, names_what_is_not_there) {
    using model = tinygltf::Model;
    const auto& refused = [&](const std::function<void(model&)>& change,
                              const std::vector<std::string>& parts) {
        expect_change_refused(change, parts);
    };
    refused([](model& m) { m.meshes[0].primitives[0].attributes["POSITION"] = 9; },
            {"accessor 9", "expected one of 4"});
    refused([](model& m) { m.accessors[0].bufferView = 7; }, {"buffer view 7"});
    refused([](model& m) { m.bufferViews[0].buffer = 3; }, {"buffer 3"});
    refused([](model& m) { m.accessors[0].count = 1000; }, {"1000 elements"});
    refused([](model& m) { m.accessors[0].count = std::size_t{1} << 61u; }, {"beyond the end"});
    refused([](model& m) { m.accessors[3].byteOffset = 6; }, {"beyond the end"});
    refused([](model& m) { m.bufferViews[0].byteLength = 4000; }, {"beyond the end"});
    refused([](model& m) { m.meshes[0].primitives[0].material = 4; }, {"material 4"});
    refused([](model& m) { m.nodes[0].mesh = 4; }, {"mesh 4"});
    refused([](model& m) { m.scenes[0].nodes = {0, 5}; }, {"node 5"});
    refused([](model& m) { m.nodes[0].children = {0}; }, {"node 0", "under itself"});
    refused([](model& m) { m.accessors[1].count = 2; }, {"3 positions with 2 normals"});
    refused([](model& m) { m.accessors[3].count = 2; }, {"2 corners"});
    refused([](model& m) { m.meshes[0].primitives[0].indices = 0; }, {"indices of another type"});
    refused([](model& m) { m.meshes[0].primitives[0].attributes["NORMAL"] = 3; }, {"NORMAL"});
    refused(
        [](model& m) {
            const std::uint16_t far = 3;
            std::memcpy(m.buffers[0].data.data() + m.bufferViews[3].byteOffset, &far, sizeof far);
        },
        {"the index 3", "3 vertices"});
    refused(
        [](model& m) {
            const float nan = std::numeric_limits<float>::quiet_NaN();
            std::memcpy(m.buffers[0].data.data(), &nan, sizeof nan);
        },
        {"nan", "1e9 metres"});
    refused([](model& m) { m.nodes[0].scale = {1e30, 1, 1}; }, {"1e9 metres"});
    refused([](model& m) { m.materials[0].pbrMetallicRoughness.baseColorFactor[1] = 2; },
            {"base colour", "\"m\""});
    refused([](model& m) { m.extensionsRequired = {"KHR_draco_mesh_compression"}; },
            {"KHR_draco_mesh_compression"});
    refused([](model& m) { m.nodes[0].mesh = -1, m.nodes[0].name = "n"; }, {"no triangles"});
}

TEST_F(read_glb_scene, names_what_is_cut_off) {
    write_model(triangle());
    std::ifstream file(folder / "a.glb", std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(file), {}};
    for (std::size_t size = 0; size < whole.size(); size += 13) {
        write("b.glb", whole.substr(0, size));
        const auto scene = io::read_scene(in_folder("b.glb"));
        ASSERT_FALSE(scene) << size;
        EXPECT_EQ(scene.error().code, error_code::bad_input) << scene.error().message;
        EXPECT_EQ(scene.error().message.back(), '.') << scene.error().message;
    }
    write("b.glb", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_refused("b.glb", {"no binary glTF"});
}

// Whatever bytes are wrong, there is a scene or a sentence.
TEST_F(read_glb_scene, survives_wrong_bytes) {
    write_model(triangle());
    std::ifstream file(folder / "a.glb", std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(file), {}};
    std::uint32_t random = 1;
    for (int turn = 0; turn < 400; ++turn) {
        std::string bytes = whole;
        for (int change = 0; change < 3; ++change) {
            random = random * 1664525u + 1013904223u;
            bytes[(random >> 8u) % bytes.size()] = static_cast<char>(random >> 3u);
        }
        write("b.glb", bytes);
        const auto scene = io::read_scene(in_folder("b.glb"));
        if (!scene) {
            EXPECT_EQ(scene.error().message.back(), '.') << scene.error().message;
            EXPECT_EQ(scene.error().code, error_code::bad_input) << scene.error().message;
        }
    }
}
