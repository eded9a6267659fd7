#pragma once
// Mesh files as other programs read them: readers that share nothing with the tool's writers.

#include "support.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <tiny_gltf.h>

namespace skybark::tests {

using vector3 = std::array<double, 3>;

/// What any mesh file has, one entry a vertex.
struct read_mesh {
    std::vector<vector3> positions;
    std::vector<vector3> normals;
    std::vector<std::array<double, 2>> texcoords;
    std::vector<std::array<double, 4>> tangents;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> places;  ///< of an .obj: which of its positions a vertex has
    std::vector<std::string> materials; ///< of an .obj: of each triangle
    std::string library;                ///< of an .obj: the file of its materials
};

template <std::size_t N>
std::array<double, N> numbers(std::istream& from) {
    std::array<double, N> all{};
    for (double& one : all) {
        from >> one;
    }
    return all;
}

/// As much of OBJ as is needed. Texture coordinates and normals must go in pairs; what has a
/// position of its own need not.
inline read_mesh read_obj(const std::string& path) {
    read_mesh mesh;
    std::vector<vector3> positions;
    std::istringstream file(read_file(path));
    std::string line, material;
    constexpr std::uint32_t unseen = 0xffffffffu;
    while (std::getline(file, line)) {
        std::istringstream text(line);
        std::string keyword;
        text >> keyword;
        if (keyword == "v") {
            positions.push_back(numbers<3>(text));
        } else if (keyword == "vt") {
            mesh.texcoords.push_back(numbers<2>(text));
        } else if (keyword == "vn") {
            mesh.normals.push_back(numbers<3>(text));
        } else if (keyword == "mtllib") {
            text >> mesh.library;
        } else if (keyword == "usemtl") {
            text >> material;
        } else if (keyword == "f") {
            mesh.positions.resize(mesh.normals.size());
            mesh.places.resize(mesh.normals.size(), unseen);
            for (int corner = 0; corner < 3; ++corner) {
                std::uint32_t v = 0;
                std::uint32_t t = 0;
                std::uint32_t n = 0;
                char slash = 0;
                text >> v >> slash >> t >> slash >> n;
                const bool good = text && t == n && v > 0 && n > 0 && v <= positions.size() &&
                                  n <= mesh.normals.size() && t <= mesh.texcoords.size() &&
                                  (mesh.places[n - 1] == unseen || mesh.places[n - 1] == v - 1);
                if (!good) {
                    ADD_FAILURE() << line;
                    return {};
                }
                mesh.positions[n - 1] = positions[v - 1];
                mesh.places[n - 1] = v - 1;
                mesh.indices.push_back(n - 1);
            }
            mesh.materials.push_back(material);
        } else {
            EXPECT_TRUE(keyword == "#" || keyword == "g" || keyword == "o") << line;
            continue;
        }
        EXPECT_FALSE(text.fail()) << line;
    }
    return mesh;
}

/// Numbers as they lie in the file. `T` is an array of them.
template <class T>
std::vector<T> elements(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
    const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    const auto each = static_cast<std::size_t>(
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) *
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
    EXPECT_EQ(each, sizeof(T));
    EXPECT_EQ(view.byteOffset % 4, 0u);
    EXPECT_LE(accessor.byteOffset + accessor.count * sizeof(T), view.byteLength);
    EXPECT_LE(view.byteOffset + view.byteLength, model.buffers.at(0).data.size());
    std::vector<T> all(each == sizeof(T) ? accessor.count : 0);
    std::memcpy(all.data(), model.buffers.at(0).data.data() + view.byteOffset + accessor.byteOffset,
                all.size() * sizeof(T));
    return all;
}

template <std::size_t N>
std::vector<std::array<double, N>> floats_of(const tinygltf::Model& model, int index) {
    EXPECT_EQ(model.accessors.at(static_cast<std::size_t>(index)).componentType,
              TINYGLTF_COMPONENT_TYPE_FLOAT);
    std::vector<std::array<double, N>> all;
    for (const auto& from : elements<std::array<float, N>>(model, index)) {
        std::array<double, N> to{};
        std::copy(from.begin(), from.end(), to.begin());
        all.push_back(to);
    }
    return all;
}

/// Reads a file without a complaint; an empty model where there is one.
inline tinygltf::Model load_glb(const std::string& path) {
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool loaded = tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path);
    EXPECT_TRUE(loaded) << error;
    EXPECT_EQ(error + warning, "");
    return loaded ? model : tinygltf::Model{};
}

/// The mesh of that number, which must be one primitive of the material of the same number.
inline read_mesh mesh_of(const tinygltf::Model& model, std::size_t number) {
    read_mesh mesh;
    if (number >= model.meshes.size()) {
        ADD_FAILURE() << "no mesh " << number;
        return mesh;
    }
    EXPECT_EQ(model.meshes[number].primitives.size(), 1u);
    const tinygltf::Primitive& primitive = model.meshes[number].primitives.at(0);
    EXPECT_EQ(primitive.mode, TINYGLTF_MODE_TRIANGLES);
    EXPECT_EQ(primitive.material, static_cast<int>(number));
    mesh.positions = floats_of<3>(model, primitive.attributes.at("POSITION"));
    mesh.normals = floats_of<3>(model, primitive.attributes.at("NORMAL"));
    mesh.tangents = floats_of<4>(model, primitive.attributes.at("TANGENT"));
    mesh.texcoords = floats_of<2>(model, primitive.attributes.at("TEXCOORD_0"));
    EXPECT_EQ(model.accessors.at(static_cast<std::size_t>(primitive.indices)).componentType,
              TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    for (const auto& index : elements<std::array<std::uint32_t, 1>>(model, primitive.indices)) {
        mesh.indices.push_back(index[0]);
    }
    const auto& bounds =
        model.accessors.at(static_cast<std::size_t>(primitive.attributes.at("POSITION")));
    for (std::size_t k = 0; k < 3; ++k) {
        double low = std::numeric_limits<double>::max();
        double high = -low;
        for (const vector3& p : mesh.positions) {
            low = std::min(low, p[k]);
            high = std::max(high, p[k]);
        }
        EXPECT_EQ(bounds.minValues.at(k), low) << "glTF wants it exact";
        EXPECT_EQ(bounds.maxValues.at(k), high);
    }
    return mesh;
}

/// A file of wood alone.
inline read_mesh read_glb(const std::string& path) {
    const tinygltf::Model model = load_glb(path);
    EXPECT_EQ(model.meshes.size(), 1u);
    EXPECT_EQ(model.materials.size(), 1u);
    EXPECT_EQ(model.scenes.size(), 1u);
    return mesh_of(model, 0);
}

inline double dot(const vector3& a, const vector3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline vector3 minus(const vector3& a, const vector3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline vector3 cross(const vector3& a, const vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Of the triangles of a closed surface so many agree with their normals: collars have the normals
/// of their parents, which turn away where branches join at sharp angles.
inline constexpr double closed_surface = 0.94;

/// What holds of every surface: indices in range, unit normals that mostly agree with the winding.
inline void expect_sound(const read_mesh& mesh, double agreeing = 0.97) {
    ASSERT_FALSE(mesh.indices.empty());
    ASSERT_EQ(mesh.indices.size() % 3, 0u);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
    std::vector<bool> used(mesh.positions.size());
    for (const std::uint32_t i : mesh.indices) {
        ASSERT_LT(i, mesh.positions.size());
        used[i] = true;
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
        ASSERT_TRUE(used[i]) << "vertex " << i;
        ASSERT_NEAR(dot(mesh.normals[i], mesh.normals[i]), 1, 1e-4) << "normal " << i;
        ASSERT_TRUE(std::isfinite(dot(mesh.positions[i], mesh.positions[i]))) << i;
    }
    std::size_t agree = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const vector3& a = mesh.positions[mesh.indices[i]];
        const vector3 n = cross(minus(mesh.positions[mesh.indices[i + 1]], a),
                                minus(mesh.positions[mesh.indices[i + 2]], a));
        agree += dot(n, mesh.normals[mesh.indices[i]]) >= 0 ? 1 : 0;
    }
    EXPECT_GT(static_cast<double>(agree), agreeing * static_cast<double>(mesh.indices.size() / 3));
}

inline void expect_tangents(const read_mesh& mesh) {
    ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
        const vector3 t{mesh.tangents[i][0], mesh.tangents[i][1], mesh.tangents[i][2]};
        ASSERT_NEAR(dot(t, t), 1, 1e-4) << i;
        ASSERT_NEAR(dot(t, mesh.normals[i]), 0, 1e-3) << i;
        ASSERT_EQ(std::abs(mesh.tangents[i][3]), 1) << i;
    }
}

} // namespace skybark::tests
