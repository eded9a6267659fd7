#include <io/write_glb.hpp>

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <io/write_png.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <exception>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <ostream>
#include <streambuf>
#include <tiny_gltf.h>

namespace skybark::io {

namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are written as they are");

/// Lets the library's stream write to our file, and keeps what went wrong.
class file_buffer : public std::streambuf {
  public:
    explicit file_buffer(atomic_file& file) : file_(file) {}
    [[nodiscard]] const result<void>& done() const { return done_; }

  protected:
    std::streamsize xsputn(const char* text, std::streamsize size) override {
        if (done_) {
            done_ = file_.write(std::string_view(text, static_cast<std::size_t>(size)));
        }
        return done_ ? size : 0;
    }
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }

  private:
    atomic_file& file_;
    result<void> done_;
};

/// Two numbers of four, as glTF wants the joints and the weights of a vertex.
struct joint_numbers {
    std::uint16_t first = 0;
    std::uint16_t second = 0;
    std::uint16_t unused[2] = {0, 0};
};
static_assert(sizeof(joint_numbers) == 8);

/// Appends arrays to the one buffer of a model, and says where each one lies.
class model_builder {
  public:
    model_builder() {
        model_.buffers.emplace_back();
        model_.scenes.emplace_back();
        model_.defaultScene = 0;
        model_.asset.version = "2.0";
        model_.asset.generator = "skybark";
    }

    void reserve(std::size_t bytes) { data().reserve(bytes); }

    /// A view of `count` elements; `element(i)` gives each. Every view begins at four bytes.
    template <class Element>
    int add_view(std::size_t count, int target, Element&& element) {
        using value = decltype(element(std::size_t{0}));
        const std::size_t offset = (data().size() + 3) / 4 * 4;
        data().resize(offset + count * sizeof(value));
        for (std::size_t i = 0; i < count; ++i) {
            const value v = element(i);
            std::memcpy(data().data() + offset + i * sizeof(value), &v, sizeof(value));
        }
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = offset;
        view.byteLength = count * sizeof(value);
        view.target = target;
        model_.bufferViews.push_back(view);
        return last(model_.bufferViews);
    }

    int add_accessor(int view, std::size_t offset, std::size_t count, int type, int component) {
        tinygltf::Accessor accessor;
        accessor.bufferView = view;
        accessor.byteOffset = offset;
        accessor.componentType = component;
        accessor.count = count;
        accessor.type = type;
        model_.accessors.push_back(accessor);
        return last(model_.accessors);
    }

    /// An accessor of a view of its own.
    template <class Element>
    int add(std::size_t count, int type, int component, int target, Element&& element) {
        const int view = add_view(count, target, element);
        return add_accessor(view, 0, count, type, component);
    }

    /// A node; -1 is the scene itself as its parent.
    int add_node(const tinygltf::Node& node, int parent) {
        model_.nodes.push_back(node);
        const int number = last(model_.nodes);
        if (parent < 0) {
            model_.scenes[0].nodes.push_back(number);
        } else {
            model_.nodes[static_cast<std::size_t>(parent)].children.push_back(number);
        }
        return number;
    }

    [[nodiscard]] tinygltf::Model& model() { return model_; }

    template <class Array>
    [[nodiscard]] static int last(const Array& array) {
        return static_cast<int>(array.size()) - 1;
    }

  private:
    [[nodiscard]] std::vector<unsigned char>& data() { return model_.buffers[0].data; }

    tinygltf::Model model_;
};

constexpr int no_target = 0; ///< of what isn't for a vertex stage

template <class Vector>
std::vector<double> numbers(const Vector& v) {
    std::vector<double> all;
    for (glm::length_t i = 0; i < Vector::length(); ++i) {
        all.push_back(double{v[i]});
    }
    return all;
}

/// The box that glTF wants of positions.
void add_bounds(tinygltf::Accessor& accessor, std::span<const surface_vertex> vertices) {
    glm::vec3 low(std::numeric_limits<float>::max());
    glm::vec3 high(std::numeric_limits<float>::lowest());
    for (const surface_vertex& v : vertices) {
        low = glm::min(low, v.position);
        high = glm::max(high, v.position);
    }
    accessor.minValues = numbers(low);
    accessor.maxValues = numbers(high);
}

/// `v` with a length of 1, as it is where it has one; `otherwise` where it has none.
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
    const float l2 = glm::dot(v, v);
    if (std::abs(l2 - 1) < 1e-6f) {
        return v;
    }
    const glm::dvec3 wide(v);
    const double length = glm::length(wide);
    return std::isfinite(length) && length > 0 ? glm::vec3(wide / length) : otherwise;
}

glm::vec3 normal_of(const surface_vertex& v) { return unit_or(v.normal, {0, 1, 0}); }

glm::vec4 tangent_of(const surface_vertex& v) {
    const glm::vec3 n = normal_of(v);
    const glm::vec3 axis = std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 any = glm::normalize(glm::cross(axis, n));
    // Where surfaces join, normals and tangents are each their own neighbours' mean.
    const float lean = glm::dot(glm::vec3(v.tangent), n);
    const glm::vec3 level = glm::vec3(v.tangent) - (std::abs(lean) < 1e-5f ? 0 : lean) * n;
    return {unit_or(level, any), v.tangent.w < 0 ? -1.0f : 1.0f};
}

/// Weights of 0 belong to joint 0, and no joint counts twice: validators want that.
joint_numbers joints_at(const vertex_carrier& c) {
    const auto first = static_cast<std::uint16_t>(c.share < 1 ? c.first : c.second);
    const bool two = c.share > 0 && c.share < 1 && c.first != c.second;
    return {first, two ? static_cast<std::uint16_t>(c.second) : std::uint16_t{0}, {0, 0}};
}
glm::vec4 weights_at(const vertex_carrier& c) {
    const bool two = c.share > 0 && c.share < 1 && c.first != c.second;
    return two ? glm::vec4(1 - c.share, c.share, 0, 0) : glm::vec4(1, 0, 0, 0);
}

void add_carriers(model_builder& to, tinygltf::Primitive& primitive,
                  std::span<const vertex_carrier> carriers) {
    primitive.attributes["JOINTS_0"] =
        to.add(carriers.size(), TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
               TINYGLTF_TARGET_ARRAY_BUFFER, [&](std::size_t i) { return joints_at(carriers[i]); });
    primitive.attributes["WEIGHTS_0"] = to.add(
        carriers.size(), TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_FLOAT,
        TINYGLTF_TARGET_ARRAY_BUFFER, [&](std::size_t i) { return weights_at(carriers[i]); });
}

tinygltf::Primitive add_primitive(model_builder& to, const surface_mesh& mesh,
                                  const surface_material& material) {
    const std::span<const surface_vertex> vertices = mesh.vertices;
    const auto attribute = [&](int type, auto&& element) {
        return to.add(vertices.size(), type, TINYGLTF_COMPONENT_TYPE_FLOAT,
                      TINYGLTF_TARGET_ARRAY_BUFFER, element);
    };
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = static_cast<int>(mesh.material);
    primitive.attributes["POSITION"] =
        attribute(TINYGLTF_TYPE_VEC3, [&](std::size_t i) { return vertices[i].position; });
    add_bounds(to.model().accessors.back(), vertices);
    primitive.attributes["NORMAL"] =
        attribute(TINYGLTF_TYPE_VEC3, [&](std::size_t i) { return normal_of(vertices[i]); });
    primitive.attributes["TANGENT"] =
        attribute(TINYGLTF_TYPE_VEC4, [&](std::size_t i) { return tangent_of(vertices[i]); });
    const glm::vec2 repeats = material.repeats;
    primitive.attributes["TEXCOORD_0"] = attribute(TINYGLTF_TYPE_VEC2, [&](std::size_t i) {
        return glm::vec2(vertices[i].u * repeats.x, 1 - vertices[i].v * repeats.y);
    });
    if (!mesh.carriers.empty()) {
        add_carriers(to, primitive, mesh.carriers);
    }
    primitive.indices = to.add(
        mesh.indices.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i) { return mesh.indices[i]; });
    return primitive;
}

void add_mesh(model_builder& to, const surface_mesh& from, const surface_material& material) {
    tinygltf::Mesh mesh;
    mesh.name = from.name;
    mesh.primitives.push_back(add_primitive(to, from, material));
    to.model().meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = from.name;
    node.mesh = model_builder::last(to.model().meshes);
    node.skin = from.carriers.empty() ? -1 : 0;
    to.add_node(node, -1);
}

/// A texture of an image that is PNG already.
int add_texture(model_builder& to, const std::string& name, const std::string& png) {
    tinygltf::Image image;
    image.name = name;
    image.mimeType = "image/png";
    image.bufferView = to.add_view(png.size(), no_target, [&](std::size_t i) { return png[i]; });
    to.model().images.push_back(image);
    tinygltf::Texture texture;
    texture.source = model_builder::last(to.model().images);
    to.model().textures.push_back(texture);
    return model_builder::last(to.model().textures);
}

/// The pictures of a material, compressed; empty where there is none.
struct compressed_textures {
    std::string base;
    std::string normal;
};

void add_material(model_builder& to, const surface_material& from,
                  const compressed_textures& textures) {
    tinygltf::Material material;
    material.name = from.name;
    tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
    pbr.baseColorFactor = numbers(from.base_color);
    pbr.metallicFactor = 0;
    pbr.roughnessFactor = double{from.roughness};
    if (!textures.base.empty()) {
        pbr.baseColorTexture.index = add_texture(to, from.name, textures.base);
    }
    if (!textures.normal.empty()) {
        material.normalTexture.index = add_texture(to, from.name + "_normal", textures.normal);
    }
    if (from.masked) {
        material.alphaMode = "MASK";
        material.alphaCutoff = double{from.cutoff};
    }
    material.doubleSided = from.double_sided;
    to.model().materials.push_back(material);
}

/// A node for each joint under its parent's, and the skin that names them all.
void add_skin(model_builder& to, std::span<const joint> joints, const joint_motion& motion) {
    tinygltf::Node root;
    root.name = "skeleton";
    tinygltf::Skin skin;
    skin.name = "skeleton";
    skin.skeleton = to.add_node(root, -1);
    const int first = skin.skeleton + 1;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        tinygltf::Node node;
        node.name = "segment_" + std::to_string(i);
        node.translation = numbers(motion.rest_translation[i]);
        node.rotation = numbers(motion.rest_rotation[i]);
        const std::uint32_t parent = joints[i].parent;
        skin.joints.push_back(to.add_node(
            node, parent == trees::none ? skin.skeleton : first + static_cast<int>(parent)));
    }
    skin.inverseBindMatrices =
        to.add(joints.size(), TINYGLTF_TYPE_MAT4, TINYGLTF_COMPONENT_TYPE_FLOAT, no_target,
               [&](std::size_t i) { return motion.inverse_bind[i]; });
    to.model().skins.push_back(skin);
}

/// One channel for each joint that has a track; all keys of a kind lie in one view.
template <class Key>
void add_channels(model_builder& to, tinygltf::Animation& animation, const char* path, int type,
                  int times, const joint_motion& motion, const std::vector<std::uint32_t>& tracks,
                  const std::vector<Key>& keys) {
    if (keys.empty()) {
        return;
    }
    const int view = to.add_view(keys.size(), no_target, [&](std::size_t i) { return keys[i]; });
    const std::vector<int>& joints = to.model().skins[0].joints;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        if (tracks[i] == joint_motion::still) {
            continue;
        }
        tinygltf::AnimationSampler sampler;
        sampler.input = times;
        sampler.output = to.add_accessor(view, std::size_t{tracks[i]} * motion.frames * sizeof(Key),
                                         motion.frames, type, TINYGLTF_COMPONENT_TYPE_FLOAT);
        sampler.interpolation = "LINEAR";
        animation.samplers.push_back(sampler);
        tinygltf::AnimationChannel channel;
        channel.sampler = model_builder::last(animation.samplers);
        channel.target_node = joints[i];
        channel.target_path = path;
        animation.channels.push_back(channel);
    }
}

void add_animation(model_builder& to, const joint_motion& motion, double frames_per_second) {
    if (motion.rotations.empty() && motion.translations.empty()) {
        return; // glTF knows no animation without channels
    }
    const auto time = [&](std::size_t i) {
        return static_cast<float>(static_cast<double>(i) / frames_per_second);
    };
    const int times =
        to.add(motion.frames, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, no_target, time);
    to.model().accessors.back().minValues = {0};
    to.model().accessors.back().maxValues = {double{time(motion.frames - 1)}};
    tinygltf::Animation animation;
    animation.name = "sway";
    add_channels(to, animation, "rotation", TINYGLTF_TYPE_VEC4, times, motion,
                 motion.rotation_track, motion.rotations);
    add_channels(to, animation, "translation", TINYGLTF_TYPE_VEC3, times, motion,
                 motion.translation_track, motion.translations);
    to.model().animations.push_back(std::move(animation));
}

failure cannot(const std::string& path, const std::string& why) {
    return fail(error_code::bad_input, in_quotes(path) + " can't be written: " + why);
}

result<void> check_carriers(const std::string& path, const surface_mesh& mesh, std::size_t joints) {
    if (!mesh.carriers.empty() && mesh.carriers.size() != mesh.vertices.size()) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " has " +
                                std::to_string(mesh.vertices.size()) + " vertices but " +
                                std::to_string(mesh.carriers.size()) + " carriers.");
    }
    for (const vertex_carrier& c : mesh.carriers) {
        if (std::max(c.first, c.second) >= joints || !(c.share >= 0 && c.share <= 1)) {
            return cannot(path, "a vertex of the mesh " + in_quotes(mesh.name) +
                                    " is carried by segments " + std::to_string(c.first) + " and " +
                                    std::to_string(c.second) + " of " + std::to_string(joints) +
                                    ", the latter with a share of " + std::to_string(c.share) +
                                    ".");
        }
    }
    return {};
}

result<void> check_mesh(const std::string& path, const surface_mesh& mesh, const glb_scene& scene) {
    if (mesh.material >= scene.materials.size()) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " is of material " +
                                std::to_string(mesh.material) + ", but there are " +
                                std::to_string(scene.materials.size()) + ".");
    }
    if (mesh.indices.size() % 3 != 0) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " has " +
                                std::to_string(mesh.indices.size()) +
                                " indices, no whole number of triangles.");
    }
    for (const std::uint32_t index : mesh.indices) {
        if (index >= mesh.vertices.size()) {
            return cannot(path, "the mesh " + in_quotes(mesh.name) + " has an index of " +
                                    std::to_string(index) + ", but " +
                                    std::to_string(mesh.vertices.size()) + " vertices.");
        }
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const surface_vertex& v = mesh.vertices[i];
        if (!std::isfinite(v.position.x) || !std::isfinite(v.position.y) ||
            !std::isfinite(v.position.z) || !std::isfinite(v.u) || !std::isfinite(v.v)) {
            return cannot(path, "vertex " + std::to_string(i) + " of the mesh " +
                                    in_quotes(mesh.name) + " isn't finite.");
        }
    }
    return check_carriers(path, mesh, scene.joints.size());
}

result<void> check_scene(const std::string& path, const glb_scene& scene) {
    if (std::all_of(scene.meshes.begin(), scene.meshes.end(),
                    [](const surface_mesh& mesh) { return mesh.indices.empty(); })) {
        return cannot(path, "glTF has no mesh without triangles.");
    }
    if (scene.joints.size() > most_glb_joints) {
        return cannot(path, "the tree has " + std::to_string(scene.joints.size()) +
                                " segments, and a .glb moves " + std::to_string(most_glb_joints) +
                                " at most; expected a smaller tree, or frames as numbered .obj "
                                "files.");
    }
    if (!scene.poses.empty() &&
        !(scene.frames_per_second > 0 && std::isfinite(scene.frames_per_second))) {
        return cannot(path,
                      "there are " + std::to_string(scene.frames_per_second) + " frames a second.");
    }
    for (const surface_mesh& mesh : scene.meshes) {
        if (auto good = check_mesh(path, mesh, scene); !good) {
            return good;
        }
    }
    return {};
}

result<std::vector<compressed_textures>> compress(const std::string& path, const glb_scene& scene) {
    std::vector<compressed_textures> all;
    for (const surface_material& material : scene.materials) {
        compressed_textures& one = all.emplace_back();
        for (const auto& [image, png] : {std::pair{&material.base_texture, &one.base},
                                         std::pair{&material.normal_texture, &one.normal}}) {
            if (image->empty()) {
                continue;
            }
            auto made = encode_png(path, image->rgba, image->width, image->height);
            if (!made) {
                return failure(made.error());
            }
            *png = std::move(*made);
        }
    }
    return all;
}

/// The bytes of the binary part, with room for alignment.
std::uint64_t bytes_of(const glb_scene& scene, const joint_motion& motion,
                       const std::vector<compressed_textures>& textures) {
    std::uint64_t bytes = 4096 + scene.joints.size() * sizeof(glm::mat4) +
                          motion.frames * sizeof(float) +
                          motion.rotations.size() * sizeof(glm::vec4) +
                          motion.translations.size() * sizeof(glm::vec3);
    for (const surface_mesh& mesh : scene.meshes) {
        bytes += mesh.vertices.size() * sizeof(surface_vertex) + mesh.indices.size_bytes() +
                 mesh.carriers.size() * (sizeof(joint_numbers) + sizeof(glm::vec4));
    }
    for (const compressed_textures& one : textures) {
        bytes += one.base.size() + one.normal.size() + 8;
    }
    return bytes;
}

/// More than the JSON takes: some 400 bytes a joint with its two channels, and a few kB.
std::uint64_t text_bytes(const glb_scene& scene) {
    return 65536 + 1024 * (scene.joints.size() + scene.meshes.size() + scene.materials.size());
}

result<void> write_model(const std::string& path, const tinygltf::Model& model) {
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    file_buffer buffer(*file);
    std::ostream stream(&buffer);
    const bool made = tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
    if (!buffer.done()) {
        return buffer.done();
    }
    if (!made || !stream) {
        return cannot(path, "the glTF library refused it.");
    }
    return file->commit();
}

result<void> write_scene(const std::string& path, const glb_scene& scene) {
    const auto textures = compress(path, scene);
    if (!textures) {
        return failure(textures.error());
    }
    const auto motion = find_motion(scene.joints, scene.poses);
    if (!motion) {
        return cannot(path, motion.error().message);
    }
    const std::uint64_t bytes = bytes_of(scene, *motion, *textures);
    if (bytes + text_bytes(scene) > std::numeric_limits<std::uint32_t>::max()) {
        return cannot(path, "a scene of " + std::to_string(bytes) +
                                " bytes is beyond the 4 GiB of a .glb; expected fewer sides, rings "
                                "or frames, or a .ply or .obj.");
    }
    model_builder builder;
    builder.reserve(static_cast<std::size_t>(bytes));
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        add_material(builder, scene.materials[i], (*textures)[i]);
    }
    for (const surface_mesh& mesh : scene.meshes) {
        if (!mesh.indices.empty()) {
            add_mesh(builder, mesh, scene.materials[mesh.material]);
        }
    }
    if (!scene.joints.empty()) {
        add_skin(builder, scene.joints, *motion);
        add_animation(builder, *motion, scene.frames_per_second);
    }
    return write_model(path, builder.model());
}

} // namespace

result<void> write_glb(const std::string& path, const glb_scene& scene) {
    try {
        if (auto good = check_scene(path, scene); !good) {
            return good;
        }
        return write_scene(path, scene);
    } catch (const std::exception&) { // bad_alloc; the JSON library has its own kinds as well
        return fail(error_code::out_of_memory,
                    "There is not enough memory to write " + in_quotes(path) + ".");
    }
}

result<void> write_glb(const std::string& path, std::span<const surface_vertex> vertices,
                       std::span<const std::uint32_t> indices, const surface_material& material) {
    surface_mesh mesh;
    mesh.vertices = vertices;
    mesh.indices = indices;
    glb_scene scene;
    scene.meshes = {&mesh, 1};
    scene.materials = {&material, 1};
    return write_glb(path, scene);
}

} // namespace skybark::io
