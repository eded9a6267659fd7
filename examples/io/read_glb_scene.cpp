#include <io/number_table.hpp>
#include <io/picture_means.hpp>
#include <io/read_scene.hpp>
#include <io/text_input.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <map>
#include <tiny_gltf.h>
#include <utility>

namespace skybark::io {

namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are read as they are");

constexpr std::string_view diffuse_transmission = "KHR_materials_diffuse_transmission";
constexpr std::string_view transmission = "KHR_materials_transmission";
constexpr std::string_view emissive_strength = "KHR_materials_emissive_strength";

/// Extensions that a file may require: those that are read, and those that change nothing here.
bool is_known(std::string_view extension) {
    constexpr std::string_view known[] = {
        diffuse_transmission,       transmission,          emissive_strength,
        "KHR_materials_ior",        "KHR_materials_unlit", "KHR_materials_volume",
        "KHR_materials_specular",   "KHR_materials_sheen", "KHR_materials_clearcoat",
        "KHR_materials_variants",   "KHR_lights_punctual", "KHR_materials_iridescence",
        "KHR_materials_anisotropy", "KHR_xmp_json_ld"};
    return std::find(std::begin(known), std::end(known), extension) != std::end(known);
}

/// Elements of an accessor, one after another.
struct element_view {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
    std::size_t count = 0;
    int component = 0;
    bool normalized = false;

    /// Component `c` of element `i`, as glTF makes floats of it.
    [[nodiscard]] double at(std::size_t i, std::size_t c) const {
        const unsigned char* p = first + i * stride;
        switch (component) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return p[c] / (normalized ? 255.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(p, c) / (normalized ? 65535.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load<std::uint32_t>(p, c);
        default:
            return double{load<float>(p, c)};
        }
    }

  private:
    template <class T>
    [[nodiscard]] static T load(const unsigned char* p, std::size_t c) {
        T value;
        std::memcpy(&value, p + c * sizeof(T), sizeof(T));
        return value;
    }
};

class glb_reader {
  public:
    explicit glb_reader(const std::string& path) : path_(path) {}

    [[nodiscard]] result<triangle_scene> read() {
        auto done = load();
        if (done) {
            done = add_materials();
        }
        if (done) {
            done = add_nodes();
        }
        if (!done) {
            return failure(done.error());
        }
        if (scene_.triangles.empty()) {
            return refuse("has no triangles; expected at least one in its default scene.");
        }
        return std::move(scene_);
    }

  private:
    struct placed_node {
        int node = 0;
        glm::dmat4 parent{1};
    };

    [[nodiscard]] failure refuse(const std::string& complaint) const {
        return fail(error_code::bad_input, in_quotes(path_) + " " + complaint);
    }

    /// `number` as an index below `count`, or a sentence.
    [[nodiscard]] result<std::size_t> index(const std::string& what, int number,
                                            std::size_t count) const {
        if (number < 0 || static_cast<std::size_t>(number) >= count) {
            return refuse("names the " + what + " " + std::to_string(number) +
                          "; expected one of " + std::to_string(count) + ", from 0 on.");
        }
        return static_cast<std::size_t>(number);
    }

    // ---- The file ------------------------------------------------------------------------------

    [[nodiscard]] result<void> load() {
        const auto bytes = load_text(path_);
        if (!bytes) {
            return failure(bytes.error());
        }
        if (bytes->size() < 20 || bytes->compare(0, 4, "glTF") != 0) {
            return refuse("is no binary glTF file; expected one that begins with \"glTF\".");
        }
        std::uint32_t said = 0;
        std::memcpy(&said, bytes->data() + 8, sizeof said);
        if (said > bytes->size()) {
            return refuse("ends after " + std::to_string(bytes->size()) + " bytes; expected " +
                          std::to_string(said) + ", as it says itself.");
        }
        std::string error;
        std::string warning;
        tinygltf::TinyGLTF loader;
        const std::size_t slash = path_.find_last_of('/');
        const std::string folder = slash == std::string::npos ? "." : path_.substr(0, slash);
        const bool good = loader.LoadBinaryFromMemory(
            &model_, &error, &warning, reinterpret_cast<const unsigned char*>(bytes->data()),
            static_cast<unsigned int>(bytes->size()), folder);
        if (!good) {
            std::replace(error.begin(), error.end(), '\n', ' ');
            error = std::string(trimmed(error));
            return refuse("can't be read as glTF: " + (error.empty() ? "it is damaged." : error) +
                          (error.empty() || error.back() == '.' ? "" : "."));
        }
        for (const std::string& name : model_.extensionsRequired) {
            if (!is_known(name)) {
                return refuse("requires the extension " + in_quotes(name) +
                              ", which we don't know; expected a file without it.");
            }
        }
        return {};
    }

    [[nodiscard]] result<element_view> view_of(int accessor_number) const {
        const auto number = index("accessor", accessor_number, model_.accessors.size());
        if (!number) {
            return failure(number.error());
        }
        const tinygltf::Accessor& accessor = model_.accessors[*number];
        const std::string name = "the accessor " + std::to_string(*number);
        if (accessor.sparse.isSparse || accessor.bufferView < 0) {
            return refuse("has " + name + " that is sparse or has no view; expected a plain one.");
        }
        const auto view_number =
            index("buffer view", accessor.bufferView, model_.bufferViews.size());
        if (!view_number) {
            return failure(view_number.error());
        }
        const tinygltf::BufferView& view = model_.bufferViews[*view_number];
        const auto buffer_number = index("buffer", view.buffer, model_.buffers.size());
        if (!buffer_number) {
            return failure(buffer_number.error());
        }
        const auto& data = model_.buffers[*buffer_number].data;
        const int stride = accessor.ByteStride(view);
        const int component =
            tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
        const int components =
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
        if (stride <= 0 || component <= 0 || components <= 0) {
            return refuse("has " + name + " of an unknown type.");
        }
        const auto element = static_cast<std::size_t>(component * components);
        const std::size_t room = data.size();
        // Sizes by subtraction: none of these sums can be trusted not to wrap.
        const bool inside =
            view.byteOffset <= room && view.byteLength <= room - view.byteOffset &&
            accessor.byteOffset <= view.byteLength &&
            (accessor.count == 0 ||
             (element <= view.byteLength - accessor.byteOffset &&
              (accessor.count - 1) <= (view.byteLength - accessor.byteOffset - element) /
                                          static_cast<std::size_t>(stride)));
        if (!inside) {
            return refuse("has " + name + " of " + std::to_string(accessor.count) +
                          " elements beyond the end of its buffer of " + std::to_string(room) +
                          " bytes.");
        }
        return element_view{data.data() + view.byteOffset + accessor.byteOffset,
                            static_cast<std::size_t>(stride), accessor.count,
                            accessor.componentType, accessor.normalized};
    }

    /// The view of an attribute, which must be of floats, or where `coordinates`, may be whole
    /// numbers that stand for 0…1. Its count is 0 where the primitive has none.
    [[nodiscard]] result<element_view> attribute(const tinygltf::Primitive& from,
                                                 const std::string& name, int type,
                                                 bool coordinates) const {
        const auto found = from.attributes.find(name);
        if (found == from.attributes.end()) {
            return element_view{};
        }
        auto view = view_of(found->second);
        if (!view) {
            return view;
        }
        const bool floats = view->component == TINYGLTF_COMPONENT_TYPE_FLOAT;
        const bool parts =
            view->normalized && (view->component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                 view->component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
        const int has = model_.accessors[static_cast<std::size_t>(found->second)].type;
        if (has != type || !(floats || (coordinates && parts))) {
            return refuse("has " + name + " in numbers of another type; expected floats.");
        }
        return view;
    }

    // ---- Materials -----------------------------------------------------------------------------

    [[nodiscard]] result<colour_picture> picture(int texture) const {
        const auto number = index("texture", texture, model_.textures.size());
        if (!number) {
            return failure(number.error());
        }
        const auto source = index("image", model_.textures[*number].source, model_.images.size());
        if (!source) {
            return failure(source.error());
        }
        const tinygltf::Image& image = model_.images[*source];
        const bool good =
            image.width > 0 && image.height > 0 && image.component == 4 && image.bits == 8 &&
            image.image.size() == std::size_t{4} * static_cast<std::size_t>(image.width) *
                                      static_cast<std::size_t>(image.height);
        if (!good) {
            return refuse("has the image " + std::to_string(*source) +
                          " in a form that we don't know; expected PNG or JPEG of 8 bits.");
        }
        return colour_picture{static_cast<std::uint32_t>(image.width),
                              static_cast<std::uint32_t>(image.height), image.image, true};
    }

    /// Multiplies a colour by the mean of a texture; -1: there is none.
    [[nodiscard]] result<void> multiply_by_mean(int texture, glm::vec3& to) const {
        if (texture < 0) {
            return {};
        }
        const auto read = picture(texture);
        if (!read) {
            return failure(read.error());
        }
        to *= mean_colour(*read);
        return {};
    }

    [[nodiscard]] result<glm::vec3> colour(const std::string& what, const std::string& of,
                                           const std::vector<double>& numbers, double high) const {
        glm::vec3 c(1);
        for (std::size_t i = 0; i < 3 && i < numbers.size(); ++i) {
            if (!(numbers[i] >= 0 && numbers[i] <= high)) { // NaN as well
                return refuse("has the " + what + " " + std::to_string(numbers[i]) + " in the " +
                              "material " + in_quotes(of) + "; expected numbers from 0 to " +
                              (high > 1 ? "1e9." : "1."));
            }
            c[static_cast<glm::length_t>(i)] = static_cast<float>(numbers[i]);
        }
        return c;
    }

    /// A number of an extension; `otherwise` where it has none.
    [[nodiscard]] static double number_in(const tinygltf::Value& in, const char* key,
                                          double otherwise) {
        if (!in.IsObject() || !in.Has(key) || !in.Get(key).IsNumber()) {
            return otherwise;
        }
        return in.Get(key).GetNumberAsDouble();
    }
    [[nodiscard]] static std::vector<double> numbers_in(const tinygltf::Value& in,
                                                        const char* key) {
        std::vector<double> numbers;
        if (in.IsObject() && in.Has(key) && in.Get(key).IsArray()) {
            for (std::size_t i = 0; i < in.Get(key).ArrayLen(); ++i) {
                numbers.push_back(in.Get(key).Get(static_cast<int>(i)).GetNumberAsDouble());
            }
        }
        return numbers;
    }
    [[nodiscard]] static tinygltf::Value extension(const tinygltf::Material& from,
                                                   std::string_view name) {
        const auto found = from.extensions.find(std::string(name));
        return found == from.extensions.end() ? tinygltf::Value() : found->second;
    }

    [[nodiscard]] result<void> add_materials() {
        for (const tinygltf::Material& from : model_.materials) {
            scene_material m;
            m.name = from.name;
            m.two_sided = from.doubleSided;
            auto done = add_colours(from, m);
            if (done) {
                done = add_transmission(from, m);
            }
            if (done) {
                done = add_holes(from, m);
            }
            if (!done) {
                return done;
            }
            scene_.materials.push_back(std::move(m));
        }
        if (scene_.materials.empty()) {
            scene_.materials.push_back(default_material());
        }
        return {};
    }

    /// glTF's: white, one-sided.
    [[nodiscard]] static scene_material default_material() {
        scene_material m;
        m.name = "default";
        m.diffuse = glm::vec3(1);
        return m;
    }

    [[nodiscard]] result<void> add_colours(const tinygltf::Material& from, scene_material& m) {
        const auto& pbr = from.pbrMetallicRoughness;
        const auto base = colour("base colour", m.name, pbr.baseColorFactor, 1);
        if (!base) {
            return failure(base.error());
        }
        m.diffuse = *base;
        if (auto done = multiply_by_mean(pbr.baseColorTexture.index, m.diffuse); !done) {
            return done;
        }
        const auto emitted = colour("emission", m.name, from.emissiveFactor, 1e9);
        if (!emitted) {
            return failure(emitted.error());
        }
        const double strength =
            number_in(extension(from, emissive_strength), "emissiveStrength", 1);
        if (!(strength >= 0 && strength <= 1e9)) {
            return refuse("has the emissive strength " + std::to_string(strength) +
                          " in the material " + in_quotes(m.name) +
                          "; expected a number from 0 to 1e9.");
        }
        m.emission =
            from.emissiveFactor.empty() ? glm::vec3(0) : *emitted * static_cast<float>(strength);
        return m.emission == glm::vec3(0)
                   ? result<void>()
                   : multiply_by_mean(from.emissiveTexture.index, m.emission);
    }

    [[nodiscard]] result<void> add_transmission(const tinygltf::Material& from, scene_material& m) {
        const tinygltf::Value leaf = extension(from, diffuse_transmission);
        const tinygltf::Value glass = extension(from, transmission);
        const double through = number_in(leaf, "diffuseTransmissionFactor", 0);
        const double clear = number_in(glass, "transmissionFactor", 0);
        if (!(through >= 0 && through <= 1 && clear >= 0 && clear <= 1)) {
            return refuse("has the transmission " + std::to_string(through > 0 ? through : clear) +
                          " in the material " + in_quotes(m.name) +
                          "; expected a number from 0 to 1.");
        }
        const auto tint = colour("transmission colour", m.name,
                                 numbers_in(leaf, "diffuseTransmissionColorFactor"), 1);
        if (!tint) {
            return failure(tint.error());
        }
        // The part of the light that is reflected is what neither passes on.
        const glm::vec3 base = m.diffuse;
        const auto first = static_cast<float>(clear);
        const auto second = static_cast<float>(through);
        m.transmission = base * first + *tint * ((1 - first) * second);
        m.diffuse = base * ((1 - first) * (1 - second));
        m.two_sided = m.two_sided || m.transmission != glm::vec3(0);
        return {};
    }

    [[nodiscard]] result<void> add_holes(const tinygltf::Material& from, scene_material& m) {
        if (from.alphaMode != "MASK" && from.alphaMode != "BLEND") {
            coordinate_sets_.push_back(0);
            return {};
        }
        const auto& pbr = from.pbrMetallicRoughness;
        coordinate_sets_.push_back(pbr.baseColorTexture.texCoord);
        const double alpha = pbr.baseColorFactor.size() == 4 ? pbr.baseColorFactor[3] : 1;
        const double cutoff = from.alphaMode == "MASK" ? from.alphaCutoff : 0.5;
        if (!(alpha >= 0 && alpha <= 1 && std::abs(cutoff) <= 1e9)) {
            return refuse("has the alpha " + std::to_string(alpha) + " or the cutoff " +
                          std::to_string(cutoff) + " in the material " + in_quotes(m.name) +
                          "; expected a number from 0 to 1.");
        }
        const int texture = pbr.baseColorTexture.index;
        if (texture < 0 && from.alphaMode == "BLEND") { // as much as passes it
            m.transmission = m.transmission * static_cast<float>(alpha) +
                             glm::vec3(static_cast<float>(1 - alpha));
            m.diffuse *= static_cast<float>(alpha);
            m.two_sided = m.two_sided || alpha < 1;
            return {};
        }
        if (texture < 0 && alpha >= cutoff) {
            return {};
        }
        // The factor goes into the cutoff, so that the map is the picture's.
        const double relative = alpha > 0 ? cutoff / alpha : 2;
        m.cutoff = static_cast<float>(std::clamp(relative, 0.0, 2.0));
        m.two_sided = true;
        if (texture < 0) {
            m.cutoff = 2; // all of it
            m.alpha_map = static_cast<std::uint32_t>(scene_.maps.size());
            scene_.maps.push_back({1, 1, {1.0f}});
            return {};
        }
        const auto known = map_of_.find(texture);
        if (known != map_of_.end()) {
            m.alpha_map = known->second;
            return {};
        }
        const auto read = picture(texture);
        if (!read) {
            return failure(read.error());
        }
        m.alpha_map = map_of_[texture] = static_cast<std::uint32_t>(scene_.maps.size());
        scene_.maps.push_back(alpha_of(*read, false));
        return {};
    }

    // ---- Nodes ---------------------------------------------------------------------------------

    [[nodiscard]] static glm::dmat4 transform_of(const tinygltf::Node& node) {
        glm::dmat4 m(1);
        if (node.matrix.size() == 16) {
            for (int i = 0; i < 16; ++i) {
                m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
            }
            return m;
        }
        if (node.translation.size() == 3) {
            m = glm::translate(m, {node.translation[0], node.translation[1], node.translation[2]});
        }
        if (node.rotation.size() == 4) {
            m *= glm::mat4_cast(
                glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
        }
        if (node.scale.size() == 3) {
            m = glm::scale(m, {node.scale[0], node.scale[1], node.scale[2]});
        }
        return m;
    }

    [[nodiscard]] std::vector<int> roots() const {
        if (!model_.scenes.empty()) {
            const int wanted = std::max(model_.defaultScene, 0);
            const std::size_t last = model_.scenes.size() - 1;
            return model_.scenes[std::min(static_cast<std::size_t>(wanted), last)].nodes;
        }
        std::vector<bool> is_child(model_.nodes.size());
        for (const tinygltf::Node& node : model_.nodes) {
            for (const int child : node.children) {
                if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) {
                    is_child[static_cast<std::size_t>(child)] = true;
                }
            }
        }
        std::vector<int> all;
        for (std::size_t i = 0; i < is_child.size(); ++i) {
            if (!is_child[i]) {
                all.push_back(static_cast<int>(i));
            }
        }
        return all;
    }

    [[nodiscard]] result<void> add_nodes() {
        std::vector<placed_node> left;
        const std::vector<int> first = roots();
        for (auto root = first.rbegin(); root != first.rend(); ++root) {
            left.push_back({*root, glm::dmat4(1)});
        }
        std::vector<bool> seen(model_.nodes.size());
        while (!left.empty()) {
            const placed_node at = left.back();
            left.pop_back();
            const auto number = index("node", at.node, model_.nodes.size());
            if (!number) {
                return failure(number.error());
            }
            if (seen[*number]) {
                return refuse("has the node " + std::to_string(*number) +
                              " under two parents or under itself; expected a tree.");
            }
            seen[*number] = true;
            const tinygltf::Node& node = model_.nodes[*number];
            const glm::dmat4 to_world = at.parent * transform_of(node);
            if (node.mesh >= 0) {
                if (auto done = add_mesh(node.mesh, to_world); !done) {
                    return done;
                }
            }
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
                left.push_back({*child, to_world});
            }
        }
        return {};
    }

    [[nodiscard]] result<void> add_mesh(int mesh, const glm::dmat4& to_world) {
        const auto number = index("mesh", mesh, model_.meshes.size());
        if (!number) {
            return failure(number.error());
        }
        for (const tinygltf::Primitive& primitive : model_.meshes[*number].primitives) {
            const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
            if (mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                if (auto done = add_primitive(primitive, mode, to_world); !done) {
                    return done;
                }
            }
        }
        return {};
    }

    [[nodiscard]] result<void> add_primitive(const tinygltf::Primitive& from, int mode,
                                             const glm::dmat4& to_world) {
        std::uint32_t material = 0;
        if (from.material >= 0) {
            const auto number = index("material", from.material, model_.materials.size());
            if (!number) {
                return failure(number.error());
            }
            material = static_cast<std::uint32_t>(*number);
        } else if (!model_.materials.empty()) {
            if (default_ == no_alpha_map) {
                default_ = static_cast<std::uint32_t>(scene_.materials.size());
                scene_.materials.push_back(default_material());
                coordinate_sets_.push_back(0);
            }
            material = default_;
        }
        const std::size_t first = scene_.positions.size();
        if (auto done = add_vertices(from, material, to_world); !done) {
            return done;
        }
        const std::size_t count = scene_.positions.size() - first;
        if (scene_.positions.size() > std::numeric_limits<std::uint32_t>::max() / 4) {
            return refuse("has more than a thousand million vertices; expected fewer.");
        }
        std::vector<std::uint32_t> indices;
        if (auto done = read_indices(from, count, indices); !done) {
            return done;
        }
        const bool mirrored = glm::determinant(glm::dmat3(to_world)) < 0;
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            const auto base = static_cast<std::uint32_t>(first);
            const glm::uvec3 t =
                base + glm::uvec3(indices[a], indices[mirrored ? c : b], indices[mirrored ? b : c]);
            scene_.triangles.push_back(t);
            scene_.material_of.push_back(material);
        };
        if (mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0) {
            return refuse("has a primitive of " + std::to_string(indices.size()) +
                          " corners; expected three a triangle.");
        }
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            for (std::size_t i = 0; i < indices.size(); i += 3) {
                add(i, i + 1, i + 2);
            }
        }
        for (std::size_t i = 2; mode == TINYGLTF_MODE_TRIANGLE_STRIP && i < indices.size(); ++i) {
            add(i - 2, i % 2 == 0 ? i - 1 : i, i % 2 == 0 ? i : i - 1);
        }
        for (std::size_t i = 2; mode == TINYGLTF_MODE_TRIANGLE_FAN && i < indices.size(); ++i) {
            add(0, i - 1, i);
        }
        return {};
    }

    [[nodiscard]] result<void> read_indices(const tinygltf::Primitive& from, std::size_t vertices,
                                            std::vector<std::uint32_t>& indices) const {
        if (from.indices < 0) {
            for (std::uint32_t i = 0; i < vertices; ++i) {
                indices.push_back(i);
            }
            return {};
        }
        const auto view = view_of(from.indices);
        if (!view) {
            return failure(view.error());
        }
        const int component = view->component;
        const bool whole = component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (!whole || view->normalized) {
            return refuse("has indices of another type; expected whole numbers without a sign.");
        }
        indices.reserve(view->count);
        for (std::size_t i = 0; i < view->count; ++i) {
            const double number = view->at(i, 0);
            if (number >= static_cast<double>(vertices)) {
                return refuse("has the index " +
                              std::to_string(static_cast<std::uint64_t>(number)) +
                              " in a primitive of " + std::to_string(vertices) +
                              " vertices; expected a smaller one.");
            }
            indices.push_back(static_cast<std::uint32_t>(number));
        }
        return {};
    }

    [[nodiscard]] result<void> add_vertices(const tinygltf::Primitive& from, std::uint32_t material,
                                            const glm::dmat4& to_world) {
        const int set = coordinate_sets_.empty() ? 0 : coordinate_sets_[material];
        const auto places = attribute(from, "POSITION", TINYGLTF_TYPE_VEC3, false);
        const auto normals = attribute(from, "NORMAL", TINYGLTF_TYPE_VEC3, false);
        const auto coordinates =
            attribute(from, "TEXCOORD_" + std::to_string(set), TINYGLTF_TYPE_VEC2, true);
        for (const auto* one : {&places, &normals, &coordinates}) {
            if (!*one) {
                return failure(one->error());
            }
        }
        const std::size_t count = places->count;
        if ((normals->count != 0 && normals->count != count) ||
            (coordinates->count != 0 && coordinates->count != count)) {
            return refuse("has " + std::to_string(count) + " positions with " +
                          std::to_string(normals->count) + " normals and " +
                          std::to_string(coordinates->count) +
                          " texture coordinates; expected as many of each, or none.");
        }
        // The matrix of cofactors carries normals: of a mirror's sign and of any length.
        const glm::dmat3 m(to_world);
        const glm::dmat3 turn(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                              glm::cross(m[0], m[1]));
        const double sign = glm::determinant(m) < 0 ? -1 : 1;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3 local(places->at(i, 0), places->at(i, 1), places->at(i, 2));
            const glm::dvec3 p(to_world * glm::dvec4(local, 1));
            for (int axis = 0; axis < 3; ++axis) {
                if (!(std::abs(p[axis]) <= farthest_metres)) { // NaN as well
                    return refuse("has the position " + std::to_string(p.x) + ", " +
                                  std::to_string(p.y) + ", " + std::to_string(p.z) +
                                  "; expected finite numbers of at most 1e9 metres.");
                }
            }
            scene_.positions.emplace_back(p);
            glm::dvec3 n(0);
            if (normals->count != 0) {
                n = sign *
                    (turn * glm::dvec3(normals->at(i, 0), normals->at(i, 1), normals->at(i, 2)));
                const double length = glm::length(n);
                n = std::isfinite(length) && length > 0 ? n / length : glm::dvec3(0);
            }
            scene_.normals.emplace_back(n);
            glm::dvec2 t(0);
            if (coordinates->count != 0) {
                t = {coordinates->at(i, 0), coordinates->at(i, 1)};
                if (!(std::abs(t.x) <= 1e6 && std::abs(t.y) <= 1e6)) {
                    return refuse("has the texture coordinate " + std::to_string(t.x) + ", " +
                                  std::to_string(t.y) +
                                  "; expected finite numbers of at most 1e6.");
                }
            }
            scene_.coordinates.emplace_back(t);
        }
        return {};
    }

    const std::string& path_;
    tinygltf::Model model_;
    triangle_scene scene_;
    std::map<int, std::uint32_t> map_of_; ///< of textures
    std::vector<int> coordinate_sets_;    ///< of materials: of the map of their holes
    std::uint32_t default_ = no_alpha_map;
};

} // namespace

result<triangle_scene> read_glb_scene(const std::string& path) {
    return within_memory(path, [&] { return glb_reader(path).read(); });
}

} // namespace skybark::io
