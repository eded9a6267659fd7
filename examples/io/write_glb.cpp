#include <io/write_glb.hpp>

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>

#include <array>
#include <bit>
#include <cstring>
#include <exception>
#include <glm/common.hpp>
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

/// Appends arrays to the one buffer of a model, and says where each one lies.
class model_builder {
  public:
    model_builder() { model_.buffers.emplace_back(); }

    void reserve(std::size_t bytes) { data().reserve(bytes); }

    /// An accessor of `count` elements; `element(i)` gives each.
    template <class Element>
    int add(std::size_t count, int type, int component, int target, Element&& element) {
        using value = decltype(element(std::size_t{0}));
        const std::size_t offset = data().size();
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
        tinygltf::Accessor accessor;
        accessor.bufferView = static_cast<int>(model_.bufferViews.size() - 1);
        accessor.componentType = component;
        accessor.count = count;
        accessor.type = type;
        model_.accessors.push_back(accessor);
        return static_cast<int>(model_.accessors.size() - 1);
    }

    [[nodiscard]] tinygltf::Model& model() { return model_; }

  private:
    [[nodiscard]] std::vector<unsigned char>& data() { return model_.buffers[0].data; }

    tinygltf::Model model_;
};

/// The box that glTF wants of positions.
void add_bounds(tinygltf::Accessor& accessor, std::span<const surface_vertex> vertices) {
    glm::vec3 low(std::numeric_limits<float>::max());
    glm::vec3 high(std::numeric_limits<float>::lowest());
    for (const surface_vertex& v : vertices) {
        low = glm::min(low, v.position);
        high = glm::max(high, v.position);
    }
    accessor.minValues = {double{low.x}, double{low.y}, double{low.z}};
    accessor.maxValues = {double{high.x}, double{high.y}, double{high.z}};
}

tinygltf::Primitive add_primitive(model_builder& to, std::span<const surface_vertex> vertices,
                                  std::span<const std::uint32_t> indices) {
    const auto attribute = [&](int type, auto&& element) {
        return to.add(vertices.size(), type, TINYGLTF_COMPONENT_TYPE_FLOAT,
                      TINYGLTF_TARGET_ARRAY_BUFFER, element);
    };
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    primitive.attributes["POSITION"] =
        attribute(TINYGLTF_TYPE_VEC3, [&](std::size_t i) { return vertices[i].position; });
    add_bounds(to.model().accessors.back(), vertices);
    primitive.attributes["NORMAL"] =
        attribute(TINYGLTF_TYPE_VEC3, [&](std::size_t i) { return vertices[i].normal; });
    primitive.attributes["TANGENT"] =
        attribute(TINYGLTF_TYPE_VEC4, [&](std::size_t i) { return vertices[i].tangent; });
    primitive.attributes["TEXCOORD_0"] = attribute(TINYGLTF_TYPE_VEC2, [&](std::size_t i) {
        return glm::vec2(vertices[i].u, 1 - vertices[i].v);
    });
    primitive.indices =
        to.add(indices.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
               TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i) { return indices[i]; });
    return primitive;
}

tinygltf::Material as_gltf(const glb_material& from) {
    tinygltf::Material material;
    material.name = from.name;
    tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
    pbr.baseColorFactor = {double{from.base_color.r}, double{from.base_color.g},
                           double{from.base_color.b}, double{from.base_color.a}};
    pbr.metallicFactor = 0;
    pbr.roughnessFactor = double{from.roughness};
    return material;
}

void add_scene(tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    tinygltf::Mesh mesh;
    mesh.primitives.push_back(primitive);
    model.meshes.push_back(mesh);
    tinygltf::Node node;
    node.mesh = 0;
    model.nodes.push_back(node);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    model.asset.version = "2.0";
    model.asset.generator = "skybark";
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
        return fail(error_code::bad_input, in_quotes(path) + " can't be written as glTF.");
    }
    return file->commit();
}

} // namespace

result<void> write_glb(const std::string& path, std::span<const surface_vertex> vertices,
                       std::span<const std::uint32_t> indices, const glb_material& material) {
    if (vertices.empty() || indices.empty()) {
        return fail(error_code::bad_input,
                    in_quotes(path) + " can't be written: glTF has no mesh without triangles.");
    }
    const std::uint64_t bytes =
        std::uint64_t{vertices.size()} * sizeof(surface_vertex) + indices.size_bytes();
    constexpr std::uint64_t text = 65536; // the JSON has some 2 kB
    if (bytes > std::numeric_limits<std::uint32_t>::max() - text) {
        return fail(error_code::bad_input,
                    in_quotes(path) + " can't be written: a mesh of " + std::to_string(bytes) +
                        " bytes is beyond the 4 GiB of a .glb; expected fewer sides or rings, or "
                        "a .ply or .obj.");
    }
    try {
        model_builder builder;
        builder.reserve(static_cast<std::size_t>(bytes));
        add_scene(builder.model(), add_primitive(builder, vertices, indices));
        builder.model().materials.push_back(as_gltf(material));
        return write_model(path, builder.model());
    } catch (const std::exception&) { // bad_alloc; the JSON library has its own kinds as well
        return fail(error_code::out_of_memory,
                    "There is not enough memory to write " + in_quotes(path) + ".");
    }
}

} // namespace skybark::io
