// Scenes as glTF, read back by tinygltf and played in double precision by the formulas of the glTF
// specification (3.7.3.3 skins, appendix C animation), which share nothing with the writer.

#include "support/temporary_name.hpp"

#include <io/branch_carriers.hpp>
#include <io/write_glb.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <tiny_gltf.h>

using namespace skybark;

namespace {

using matrix = std::array<std::array<double, 4>, 4>; ///< rows
using vector3 = std::array<double, 3>;

std::string temporary(const std::string& name) { return support::temporary_name(name).string(); }

/// Writes and reads; empty where either fails.
tinygltf::Model round_trip(const io::glb_scene& scene) {
    const std::string path = temporary("round.glb");
    const auto done = io::write_glb(path, scene);
    EXPECT_TRUE(done) << done.error().message;
    tinygltf::Model model;
    std::string error;
    std::string warning;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path)) << error;
    EXPECT_EQ(error + warning, "");
    std::filesystem::remove(path);
    return model;
}

template <class T>
std::vector<T> elements(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
    const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    const std::size_t each = static_cast<std::size_t>(
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) *
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
    EXPECT_EQ(each, sizeof(T));
    EXPECT_EQ(view.byteOffset % 4, 0u);
    EXPECT_EQ(accessor.byteOffset % 4, 0u);
    EXPECT_LE(accessor.byteOffset + accessor.count * sizeof(T), view.byteLength);
    EXPECT_LE(view.byteOffset + view.byteLength, model.buffers.at(0).data.size());
    std::vector<T> all(accessor.count);
    std::memcpy(all.data(), model.buffers.at(0).data.data() + view.byteOffset + accessor.byteOffset,
                all.size() * sizeof(T));
    return all;
}

matrix product(const matrix& a, const matrix& b) {
    matrix c{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t j = 0; j < 4; ++j) {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    return c;
}

vector3 moved(const matrix& m, const vector3& p) {
    vector3 q{};
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3];
    }
    return q;
}

/// Translation · rotation. `r` is x, y, z, w.
matrix local_matrix(const std::vector<double>& t, const std::vector<double>& r) {
    const double l = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    EXPECT_NEAR(l, 1, 1e-6);
    const double x = r[0] / l;
    const double y = r[1] / l;
    const double z = r[2] / l;
    const double w = r[3] / l;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]},
             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]},
             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]},
             {0, 0, 0, 1}}};
}

/// Plays a file: where its vertices are at a key of its animation, or at rest.
class player {
  public:
    explicit player(const tinygltf::Model& model) : model_(model) {}

    std::vector<vector3> positions(std::size_t node, int key) {
        if (key >= 0) {
            set_key(static_cast<std::size_t>(key));
        }
        global_.assign(model_.nodes.size(), {});
        for (const int root : model_.scenes.at(0).nodes) {
            place(static_cast<std::size_t>(root),
                  {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}});
        }
        return skinned(model_.nodes.at(node));
    }

  private:
    void set_key(std::size_t key) {
        const tinygltf::Animation& animation = model_.animations.at(0);
        for (const auto& channel : animation.channels) {
            const auto& sampler = animation.samplers.at(static_cast<std::size_t>(channel.sampler));
            tinygltf::Node& node = model_.nodes.at(static_cast<std::size_t>(channel.target_node));
            if (channel.target_path == "rotation") {
                const auto r = elements<std::array<float, 4>>(model_, sampler.output).at(key);
                node.rotation.assign(r.begin(), r.end());
            } else {
                const auto t = elements<std::array<float, 3>>(model_, sampler.output).at(key);
                node.translation.assign(t.begin(), t.end());
            }
        }
    }

    void place(std::size_t i, const matrix& parent) {
        const tinygltf::Node& node = model_.nodes.at(i);
        const std::vector<double> origin{0, 0, 0};
        const std::vector<double> none{0, 0, 0, 1};
        global_[i] =
            product(parent, local_matrix(node.translation.empty() ? origin : node.translation,
                                         node.rotation.empty() ? none : node.rotation));
        for (const int child : node.children) {
            place(static_cast<std::size_t>(child), global_[i]);
        }
    }

    std::vector<vector3> skinned(const tinygltf::Node& node) {
        const auto& attributes =
            model_.meshes.at(static_cast<std::size_t>(node.mesh)).primitives.at(0).attributes;
        const auto& skin = model_.skins.at(static_cast<std::size_t>(node.skin));
        const auto inverse = elements<std::array<float, 16>>(model_, skin.inverseBindMatrices);
        std::vector<matrix> joints;
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            matrix m{};
            for (std::size_t k = 0; k < 16; ++k) {
                m[k % 4][k / 4] = double{inverse.at(j)[k]}; // columns in the file
            }
            joints.push_back(product(global_.at(static_cast<std::size_t>(skin.joints[j])), m));
        }
        const auto points = elements<std::array<float, 3>>(model_, attributes.at("POSITION"));
        const auto numbers =
            elements<std::array<std::uint16_t, 4>>(model_, attributes.at("JOINTS_0"));
        const auto weights = elements<std::array<float, 4>>(model_, attributes.at("WEIGHTS_0"));
        std::vector<vector3> all;
        for (std::size_t i = 0; i < points.size(); ++i) {
            vector3 sum{};
            for (std::size_t k = 0; k < 4; ++k) {
                const vector3 p =
                    moved(joints.at(numbers.at(i)[k]), {points[i][0], points[i][1], points[i][2]});
                for (std::size_t c = 0; c < 3; ++c) {
                    sum[c] += double{weights.at(i)[k]} * p[c];
                }
            }
            all.push_back(sum);
        }
        return all;
    }

    tinygltf::Model model_;
    std::vector<matrix> global_;
};

/// Where a pose takes a point, as records.hpp says, in double.
glm::dvec3 posed(const segment_pose& pose, const glm::vec3& x) {
    const glm::dquat q = glm::normalize(
        glm::dquat(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z));
    const glm::dvec3 y = glm::dvec3(x) - glm::dvec3(pose.base);
    return glm::dvec3(x) + glm::dvec3(pose.shift) + (q * y - y);
}

/// Two roots and branches of any depth, in random directions.
struct moving_tree {
    std::vector<io::joint> joints;
    std::vector<segment_pose> poses;
    std::uint32_t frames = 0;
};

constexpr std::uint32_t straight = 5; ///< goes along with its parent, and doesn't turn by itself
constexpr std::uint32_t loose = 7;    ///< leaves its place on its parent

moving_tree random_tree(std::uint32_t count, std::uint32_t frames) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> from(-1, 1);
    const auto any_direction = [&] {
        return glm::normalize(glm::vec3(from(random), from(random), from(random)));
    };
    moving_tree tree;
    tree.frames = frames;
    for (std::uint32_t i = 0; i < count; ++i) {
        io::joint j;
        const glm::quat q = glm::angleAxis(3 * from(random), any_direction());
        j.orientation = {q.x, q.y, q.z, q.w};
        if (i >= 2) {
            j.parent = std::uniform_int_distribution<std::uint32_t>(i / 2, i - 1)(random);
            j.base = tree.joints[j.parent].base + 0.5f * any_direction();
        } else {
            j.base = {static_cast<float>(5 * i), 0, 0};
        }
        tree.joints.push_back(j);
    }
    std::vector<glm::vec3> axis(count);
    std::generate(axis.begin(), axis.end(), any_direction);
    for (std::uint32_t f = 0; f < frames; ++f) {
        std::vector<segment_pose> now(count);
        std::vector<glm::dquat> turn(count, glm::dquat(1, 0, 0, 0));
        for (std::uint32_t i = 0; i < count; ++i) {
            // The first root turns around once and a half, so that its quaternion changes its sign.
            const double angle = i == 0          ? 9.42 * f / frames
                                 : i == straight ? 0
                                                 : 0.3 * std::sin(0.7 * f + i);
            const glm::dquat own = glm::angleAxis(angle, glm::dvec3(axis[i]));
            const std::uint32_t p = tree.joints[i].parent;
            glm::dvec3 shift(0);
            if (p != trees::none) {
                shift = posed(now[p], tree.joints[i].base) - glm::dvec3(tree.joints[i].base);
                turn[i] = turn[p];
            }
            turn[i] = glm::normalize(turn[i] * own);
            shift += i == loose ? glm::dvec3(0, 0.01 * f, 0) : glm::dvec3(0);
            // Both signs are the same rotation.
            const double sign = (f + i) % 3 == 0 ? -1 : 1;
            now[i].rotation =
                glm::vec4(sign * glm::dvec4(turn[i].x, turn[i].y, turn[i].z, turn[i].w));
            // A pose turns about any point of the segment.
            const glm::dvec3 aside(0, i == 9 ? 0.25 : 0, 0);
            now[i].base = tree.joints[i].base + glm::vec3(aside);
            now[i].shift = glm::vec3(shift + turn[i] * aside - aside);
        }
        tree.poses.insert(tree.poses.end(), now.begin(), now.end());
    }
    return tree;
}

/// Some vertices around each joint, by one or two carriers, and triangles of them.
struct some_mesh {
    std::vector<surface_vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<io::vertex_carrier> carriers;
    io::surface_mesh view;
};

some_mesh mesh_on(const moving_tree& tree) {
    some_mesh mesh;
    for (std::uint32_t i = 0; i < tree.joints.size(); ++i) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            surface_vertex v;
            v.position = tree.joints[i].base + glm::vec3(k == 0, k == 1, k == 2) * 0.1f;
            v.normal = {0, 0, 1};
            v.tangent = {1, 0, 0, 1};
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(v);
            const std::uint32_t p = tree.joints[i].parent;
            mesh.carriers.push_back({i, p == trees::none ? i : p,
                                     p == trees::none ? 0 : 0.25f * static_cast<float>(k)});
        }
    }
    mesh.view.vertices = mesh.vertices;
    mesh.view.indices = mesh.indices;
    mesh.view.carriers = mesh.carriers;
    return mesh;
}

io::glb_scene scene_of(const some_mesh& mesh, const moving_tree& tree) {
    static const io::surface_material bark;
    io::glb_scene scene;
    scene.meshes = {&mesh.view, 1};
    scene.materials = {&bark, 1};
    scene.joints = tree.joints;
    scene.poses = tree.poses;
    return scene;
}

/// A triangle that nothing is wrong with.
const std::vector<surface_vertex> triangle{
    {{0, 0, 0}, 0, {0, 0, 1}, 0, {1, 0, 0, 1}},
    {{1, 0, 0}, 1, {0, 0, 1}, 0, {1, 0, 0, 1}},
    {{0, 1, 0}, 0, {0, 0, 1}, 1, {1, 0, 0, 1}},
};
const std::vector<std::uint32_t> corners{0, 1, 2};

io::surface_mesh triangle_mesh() {
    io::surface_mesh mesh;
    mesh.vertices = triangle;
    mesh.indices = corners;
    return mesh;
}

void expect_refused(const io::glb_scene& scene, const std::string& part) {
    const std::string path = temporary("refused.glb");
    const auto done = io::write_glb(path, scene);
    ASSERT_FALSE(done) << part;
    EXPECT_NE(done.error().message.find(part), std::string::npos) << done.error().message;
    EXPECT_NE(done.error().message.find(path), std::string::npos) << done.error().message;
    EXPECT_EQ(done.error().message.back(), '.');
    EXPECT_FALSE(std::filesystem::exists(path));
}

} // namespace

TEST(write_glb_scene, a_player_finds_the_poses) {
    const moving_tree tree = random_tree(60, 12);
    const some_mesh mesh = mesh_on(tree);
    const tinygltf::Model model = round_trip(scene_of(mesh, tree));
    ASSERT_EQ(model.nodes.size(), 1 + 1 + 60u);
    for (int key = -1; key < 12; ++key) {
        const auto found = player(model).positions(0, key);
        ASSERT_EQ(found.size(), mesh.vertices.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            const io::vertex_carrier& c = mesh.carriers[i];
            glm::dvec3 expected(mesh.vertices[i].position);
            if (key >= 0) {
                const segment_pose* poses = tree.poses.data() + std::size_t(key) * 60;
                expected =
                    posed(poses[c.first], mesh.vertices[i].position) * (1 - double{c.share}) +
                    posed(poses[c.second], mesh.vertices[i].position) * double{c.share};
            }
            for (std::size_t k = 0; k < 3; ++k) {
                // The extent is some 6 m: 1e-6 of it for what has no track, and half as much again
                // for floats along the chain.
                ASSERT_NEAR(found[i][k], expected[static_cast<glm::length_t>(k)], 1e-5)
                    << "vertex " << i << ", key " << key;
            }
        }
    }
}

TEST(write_glb_scene, only_what_moves_has_a_channel) {
    const moving_tree tree = random_tree(60, 12);
    const some_mesh mesh = mesh_on(tree);
    const tinygltf::Model model = round_trip(scene_of(mesh, tree));
    ASSERT_EQ(model.animations.size(), 1u);
    std::size_t rotations = 0;
    std::vector<int> moving;
    for (const auto& channel : model.animations[0].channels) {
        if (channel.target_path == "translation") {
            moving.push_back(channel.target_node);
        } else {
            ++rotations;
        }
        EXPECT_NE(channel.target_node, model.skins.at(0).joints.at(straight));
    }
    EXPECT_EQ(rotations, 59u);
    EXPECT_EQ(moving, std::vector<int>{model.skins.at(0).joints.at(loose)});
}

TEST(write_glb_scene, keys_are_near_their_neighbours) {
    const moving_tree tree = random_tree(60, 12);
    const some_mesh mesh = mesh_on(tree);
    io::glb_scene scene = scene_of(mesh, tree);
    scene.frames_per_second = 30;
    const tinygltf::Model model = round_trip(scene);
    ASSERT_EQ(model.animations.size(), 1u);
    for (const auto& channel : model.animations[0].channels) {
        const auto& sampler =
            model.animations[0].samplers.at(static_cast<std::size_t>(channel.sampler));
        EXPECT_EQ(sampler.interpolation, "LINEAR");
        const auto times = elements<float>(model, sampler.input);
        ASSERT_EQ(times.size(), 12u);
        for (std::size_t i = 0; i < times.size(); ++i) {
            EXPECT_FLOAT_EQ(times[i], static_cast<float>(i) / 30);
        }
        const auto& input = model.accessors.at(static_cast<std::size_t>(sampler.input));
        EXPECT_EQ(input.minValues.at(0), 0);
        EXPECT_FLOAT_EQ(static_cast<float>(input.maxValues.at(0)), 11.0f / 30);
        if (channel.target_path != "rotation") {
            continue;
        }
        const auto keys = elements<std::array<float, 4>>(model, sampler.output);
        ASSERT_EQ(keys.size(), 12u);
        for (std::size_t i = 1; i < keys.size(); ++i) {
            float cosine = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                cosine += keys[i][k] * keys[i - 1][k];
            }
            EXPECT_GT(cosine, 0) << "the nearer of two signs";
        }
    }
}

TEST(write_glb_scene, a_tree_at_rest_has_no_animation) {
    moving_tree tree = random_tree(20, 3);
    for (std::size_t i = 0; i < tree.poses.size(); ++i) {
        tree.poses[i] = {{0, 0, 0, 1}, tree.joints[i % 20].base, 0, {0, 0, 0}, 0};
    }
    const some_mesh mesh = mesh_on(tree);
    const tinygltf::Model model = round_trip(scene_of(mesh, tree));
    EXPECT_TRUE(model.animations.empty());
    EXPECT_EQ(model.skins.size(), 1u);
}

// What is left out of each joint adds up along a chain: 2000 joints, each by less than matters.
TEST(write_glb_scene, what_is_left_out_does_not_add_up) {
    moving_tree tree;
    tree.frames = 2;
    constexpr std::uint32_t count = 2000;
    for (std::uint32_t i = 0; i < count; ++i) {
        tree.joints.push_back(
            {i == 0 ? trees::none : i - 1, {0, 0.01f * static_cast<float>(i), 0}, {0, 0, 0, 1}});
    }
    for (std::uint32_t i = 0; i < 2 * count; ++i) {
        segment_pose pose;
        pose.base = tree.joints[i % count].base;
        const double turn = i < count ? 0 : 5e-7 * i;
        pose.rotation = glm::vec4(0, 0, std::sin(turn / 2), std::cos(turn / 2));
        pose.shift = {i < count ? 0.0f : 4e-6f * static_cast<float>(i - count), 0, 0};
        tree.poses.push_back(pose);
    }
    const some_mesh mesh = mesh_on(tree);
    const tinygltf::Model model = round_trip(scene_of(mesh, tree));
    const auto found = player(model).positions(0, 1);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const io::vertex_carrier& c = mesh.carriers[i];
        const glm::dvec3 expected =
            posed(tree.poses[count + c.first], mesh.vertices[i].position) * (1 - double{c.share}) +
            posed(tree.poses[count + c.second], mesh.vertices[i].position) * double{c.share};
        // 1e-6 of the extent of 20 m, as much again for a turn of 1e-6, and floats of 20 m.
        ASSERT_NEAR(found[i][0], expected.x, 6e-5) << i;
        ASSERT_NEAR(found[i][1], expected.y, 6e-5) << i;
    }
}

TEST(write_glb_scene, weights_add_up_and_name_no_joint_for_nothing) {
    moving_tree tree = random_tree(10, 2);
    some_mesh mesh = mesh_on(tree);
    mesh.carriers[0] = {3, 4, 1};    // the second alone
    mesh.carriers[1] = {5, 5, 0.5f}; // twice the same
    mesh.carriers[2] = {6, 2, 0};    // the first alone
    mesh.carriers[3] = {9, 1, 0.1f};
    const tinygltf::Model model = round_trip(scene_of(mesh, tree));
    const auto& attributes = model.meshes.at(0).primitives.at(0).attributes;
    const auto numbers = elements<std::array<std::uint16_t, 4>>(model, attributes.at("JOINTS_0"));
    const auto weights = elements<std::array<float, 4>>(model, attributes.at("WEIGHTS_0"));
    EXPECT_EQ(numbers[0], (std::array<std::uint16_t, 4>{4, 0, 0, 0}));
    EXPECT_EQ(numbers[1], (std::array<std::uint16_t, 4>{5, 0, 0, 0}));
    EXPECT_EQ(numbers[2], (std::array<std::uint16_t, 4>{6, 0, 0, 0}));
    EXPECT_EQ(numbers[3], (std::array<std::uint16_t, 4>{9, 1, 0, 0}));
    EXPECT_EQ(weights[0], (std::array<float, 4>{1, 0, 0, 0}));
    EXPECT_EQ(weights[1], (std::array<float, 4>{1, 0, 0, 0}));
    for (const auto& w : weights) {
        EXPECT_NEAR(double{w[0]} + double{w[1]}, 1, 6e-8); // half a unit in the last place
        EXPECT_EQ(w[2] + w[3], 0);
    }
}

TEST(write_glb_scene, has_materials_with_textures) {
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < 5 * 3 * 4; ++i) {
        pixels.push_back(static_cast<std::uint8_t>(i * 37));
    }
    io::surface_material bark;
    bark.repeats = {2, 0.5f};
    bark.base_texture = {5, 3, pixels};
    bark.normal_texture = {3, 5, pixels};
    io::surface_material leaf;
    leaf.name = "leaf";
    leaf.base_color = {1, 1, 1, 1};
    leaf.base_texture = {5, 3, pixels};
    leaf.masked = true;
    leaf.cutoff = 0.25f;
    leaf.double_sided = true;
    const std::vector<io::surface_material> materials{bark, leaf};
    io::surface_mesh leaves = triangle_mesh();
    leaves.name = "leaves";
    leaves.material = 1;
    io::surface_mesh nothing;
    const std::vector<io::surface_mesh> meshes{triangle_mesh(), nothing, leaves};
    io::glb_scene scene;
    scene.meshes = meshes;
    scene.materials = materials;
    const tinygltf::Model model = round_trip(scene);
    ASSERT_EQ(model.meshes.size(), 2u);
    ASSERT_EQ(model.materials.size(), 2u);
    EXPECT_EQ(model.meshes[1].name, "leaves");
    EXPECT_EQ(model.meshes[1].primitives.at(0).material, 1);
    EXPECT_TRUE(model.skins.empty());
    EXPECT_TRUE(model.animations.empty());
    const tinygltf::Material& first = model.materials[0];
    const tinygltf::Material& second = model.materials[1];
    EXPECT_EQ(first.alphaMode, "OPAQUE");
    EXPECT_FALSE(first.doubleSided);
    EXPECT_EQ(second.alphaMode, "MASK");
    EXPECT_EQ(second.alphaCutoff, 0.25);
    EXPECT_TRUE(second.doubleSided);
    EXPECT_EQ(second.normalTexture.index, -1);
    EXPECT_EQ(second.pbrMetallicRoughness.metallicFactor, 0);
    const auto image_of = [&](int texture) {
        return model.images.at(
            static_cast<std::size_t>(model.textures.at(static_cast<std::size_t>(texture)).source));
    };
    for (const int texture : {first.pbrMetallicRoughness.baseColorTexture.index,
                              second.pbrMetallicRoughness.baseColorTexture.index}) {
        EXPECT_EQ(image_of(texture).width, 5);
        EXPECT_EQ(image_of(texture).image, pixels);
        EXPECT_EQ(image_of(texture).mimeType, "image/png");
    }
    EXPECT_EQ(image_of(first.normalTexture.index).width, 3);
    EXPECT_EQ(image_of(first.normalTexture.index).image, pixels);
    const auto texcoords = elements<std::array<float, 2>>(
        model, model.meshes[0].primitives.at(0).attributes.at("TEXCOORD_0"));
    EXPECT_EQ(texcoords[1], (std::array<float, 2>{2, 1}));
    EXPECT_EQ(texcoords[2], (std::array<float, 2>{0, 0.5f}));
}

TEST(write_glb_scene, mends_normals_and_tangents) {
    std::vector<surface_vertex> vertices = triangle;
    vertices[0].tangent = {0, 0, 0, 0};
    vertices[1].tangent = {0, 3, 0, -0.5f};
    vertices[2].normal = {0, 0, 0};
    vertices[2].tangent = {std::numeric_limits<float>::quiet_NaN(), 0, 0, 0};
    io::surface_mesh mesh = triangle_mesh();
    mesh.vertices = vertices;
    const io::surface_material material;
    io::glb_scene scene;
    scene.meshes = {&mesh, 1};
    scene.materials = {&material, 1};
    const tinygltf::Model model = round_trip(scene);
    const auto& attributes = model.meshes.at(0).primitives.at(0).attributes;
    const auto normals = elements<std::array<float, 3>>(model, attributes.at("NORMAL"));
    const auto tangents = elements<std::array<float, 4>>(model, attributes.at("TANGENT"));
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& n = normals[i];
        const auto& t = tangents[i];
        EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-6);
        EXPECT_NEAR(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], 1, 1e-6);
        EXPECT_NEAR(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0, 1e-6);
        EXPECT_EQ(t[3], i == 1 ? -1 : 1);
    }
    EXPECT_EQ(tangents[1][1], 1);
}

TEST(write_glb_scene, refuses_what_does_not_fit) {
    const io::surface_material material;
    const moving_tree tree = random_tree(4, 2);
    io::surface_mesh mesh = triangle_mesh();
    io::glb_scene good;
    good.meshes = {&mesh, 1};
    good.materials = {&material, 1};
    good.joints = tree.joints;
    good.poses = tree.poses;

    expect_refused({}, "without triangles");
    io::glb_scene bad = good;
    bad.materials = {};
    expect_refused(bad, "of material 0, but there are 0");
    bad = good;
    bad.poses = bad.poses.first(7);
    expect_refused(bad, "7 poses");
    for (const double rate : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        bad = good;
        bad.frames_per_second = rate;
        expect_refused(bad, "frames a second");
    }
    std::vector<segment_pose> poses = tree.poses;
    poses[6].shift.y = std::numeric_limits<float>::quiet_NaN();
    bad = good;
    bad.poses = poses;
    expect_refused(bad, "segment 2 in frame 1");
    poses[6].shift.y = 0;
    poses[6].rotation = {0, 0, 0, 0};
    expect_refused(bad, "segment 2 in frame 1");
    std::vector<io::joint> joints = tree.joints;
    joints[1].parent = 1;
    bad = good;
    bad.joints = joints;
    expect_refused(bad, "Joint 1");
    bad.poses = {};
    joints.assign(65536, io::joint{});
    bad.joints = joints;
    expect_refused(bad, "65536 segments");
}

TEST(write_glb_scene, refuses_meshes_that_are_none) {
    const io::surface_material material;
    const moving_tree tree = random_tree(4, 2);
    const auto refuse = [&](const io::surface_mesh& mesh, const std::string& part) {
        io::glb_scene scene;
        scene.meshes = {&mesh, 1};
        scene.materials = {&material, 1};
        scene.joints = tree.joints;
        expect_refused(scene, part);
    };
    io::surface_mesh mesh = triangle_mesh();
    const std::vector<std::uint32_t> beyond{0, 1, 3};
    mesh.indices = beyond;
    refuse(mesh, "an index of 3");
    mesh.indices = mesh.indices.first(2);
    refuse(mesh, "2 indices");
    for (const io::vertex_carrier& c : {io::vertex_carrier{4, 0, 0},
                                        {0, 4, 0.5f},
                                        {0, 1, 1.5f},
                                        {0, 1, -0.5f},
                                        {0, 1, std::numeric_limits<float>::quiet_NaN()}}) {
        mesh = triangle_mesh();
        const std::vector<io::vertex_carrier> carriers{{0, 0, 0}, {0, 0, 0}, c};
        mesh.carriers = carriers;
        refuse(mesh, "carried by");
        mesh.carriers = mesh.carriers.first(2);
        refuse(mesh, "2 carriers");
    }
    std::vector<surface_vertex> vertices = triangle;
    vertices[1].position.z = std::numeric_limits<float>::infinity();
    mesh = triangle_mesh();
    mesh.vertices = vertices;
    refuse(mesh, "vertex 1");
    std::vector<std::uint8_t> pixels(3);
    io::surface_material broken;
    broken.base_texture = {2, 2, pixels};
    io::glb_scene scene;
    mesh = triangle_mesh();
    scene.meshes = {&mesh, 1};
    scene.materials = {&broken, 1};
    expect_refused(scene, "2 x 2 pixels");
}

// Along a segment from half the one before it to half the one after it, and alone in the middle.
TEST(branch_carriers, hand_over_from_segment_to_segment) {
    const std::vector<branch_segment> segments{{0, 1, cap_start, 0}, {1, 2, cap_end, 0}};
    const std::vector<end_carrier> ends{{0, 0, 0, 0}, {0, 0, 1, 0}, {1, 1, 1, 0}};
    trees::branch_mesh_options options;
    options.sides = 3;
    options.rings = 5;
    const auto carriers = io::branch_carriers(segments, ends, options);
    ASSERT_EQ(carriers.size(), 2 * 5 * 4 + 2 * 3u);
    const auto share_of = [&](std::uint32_t vertex, std::uint32_t segment) {
        const io::vertex_carrier& c = carriers[vertex];
        return (c.first == segment ? 1 - c.share : 0) + (c.second == segment ? c.share : 0);
    };
    const float first[] = {1, 1, 1, 0.75f, 0.5f};
    const float second[] = {0.5f, 0.75f, 1, 1, 1};
    for (std::uint32_t ring = 0; ring < 5; ++ring) {
        for (std::uint32_t side = 0; side < 4; ++side) {
            EXPECT_EQ(share_of(4 * ring + side, 0), first[ring]) << ring;
            EXPECT_EQ(share_of(20 + 4 * ring + side, 1), second[ring]) << ring;
            EXPECT_EQ(share_of(20 + 4 * ring + side, 0), 1 - second[ring]) << ring;
        }
    }
    for (std::uint32_t side = 0; side < 3; ++side) {
        EXPECT_EQ(share_of(40 + side, 0), 1);
        EXPECT_EQ(share_of(43 + side, 1), 1);
    }
}
