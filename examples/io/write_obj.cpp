#include <io/write_obj.hpp>

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <io/write_png.hpp>

#include <algorithm>
#include <charconv>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <vector>

namespace skybark::io {

namespace {

/// Collects text and hands it on in large pieces. After a failure it takes no more.
class text_writer {
  public:
    explicit text_writer(atomic_file& file) : file_(file) { text_.reserve(full + longest_line); }

    void add(std::string_view text) { text_ += text; }
    template <class Number>
    void add_number(Number value) {
        char digits[32];
        const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
        text_.append(digits, static_cast<std::size_t>(end - digits));
    }
    void end_line() {
        text_ += '\n';
        if (text_.size() >= full) {
            flush();
        }
    }
    [[nodiscard]] result<void> finish() {
        flush();
        return done_;
    }

  private:
    static constexpr std::size_t full = std::size_t{1} << 20u;
    static constexpr std::size_t longest_line = 256;

    void flush() {
        if (done_) {
            done_ = file_.write(text_);
        }
        text_.clear();
    }

    atomic_file& file_;
    std::string text_;
    result<void> done_;
};

void add_floats(text_writer& to, std::string_view keyword, std::initializer_list<float> values) {
    to.add(keyword);
    for (const float value : values) {
        to.add(" ");
        to.add_number(value);
    }
    to.end_line();
}

constexpr std::uint32_t nowhere = 0xffffffffu;

/// The vertex that gives each place its position, in the order of the places; `nowhere` where no
/// vertex is of the place.
std::vector<std::uint32_t> first_at_places(const surface_mesh& mesh) {
    std::vector<std::uint32_t> first(mesh.vertices.size(), nowhere);
    for (std::uint32_t i = 0; i < mesh.places.size(); ++i) {
        std::uint32_t& at = first[mesh.places[i]];
        at = at == nowhere ? i : at;
    }
    return first;
}

/// Numbers positions and vertices through all meshes; OBJ counts from one.
class obj_writer {
  public:
    explicit obj_writer(text_writer& to) : to_(to) {}

    void add(const surface_mesh& mesh, glm::vec2 repeats) {
        const std::vector<std::uint32_t> numbers = add_positions(mesh);
        for (const surface_vertex& v : mesh.vertices) {
            add_floats(to_, "vt", {v.u * repeats.x, v.v * repeats.y});
        }
        for (const surface_vertex& v : mesh.vertices) {
            add_floats(to_, "vn", {v.normal.x, v.normal.y, v.normal.z});
        }
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            add_triangle(mesh, numbers, mesh.indices.subspan(i).first<3>());
        }
        vertices_ += mesh.vertices.size();
    }

  private:
    /// The number of each place's position, from 0 on; none where each vertex has its own.
    std::vector<std::uint32_t> add_positions(const surface_mesh& mesh) {
        first_position_ = positions_;
        if (mesh.places.empty()) {
            for (const surface_vertex& v : mesh.vertices) {
                add_position(v);
            }
            return {};
        }
        std::vector<std::uint32_t> numbers = first_at_places(mesh);
        std::uint32_t next = 0;
        for (std::uint32_t& number : numbers) {
            if (number != nowhere) {
                add_position(mesh.vertices[number]);
                number = next++;
            }
        }
        return numbers;
    }

    void add_position(const surface_vertex& v) {
        add_floats(to_, "v", {v.position.x, v.position.y, v.position.z});
        ++positions_;
    }

    void add_triangle(const surface_mesh& mesh, const std::vector<std::uint32_t>& numbers,
                      std::span<const std::uint32_t, 3> corners) {
        to_.add("f");
        for (const std::uint32_t corner : corners) {
            const std::uint32_t place = mesh.places.empty() ? corner : numbers[mesh.places[corner]];
            const std::uint64_t vertex = vertices_ + corner + 1;
            to_.add(" ");
            to_.add_number(first_position_ + place + 1);
            to_.add("/");
            to_.add_number(vertex);
            to_.add("/");
            to_.add_number(vertex);
        }
        to_.end_line();
    }

    text_writer& to_;
    std::uint64_t first_position_ = 0;
    std::uint64_t positions_ = 0;
    std::uint64_t vertices_ = 0;
};

/// A name that is one word in every reader, and harmless in a path.
std::string as_word(std::string_view name) {
    std::string word;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '_' || c == '-';
        word += plain ? c : '_';
    }
    return word.empty() ? "unnamed" : word;
}

/// The names of the files beside the .obj.
class companions {
  public:
    explicit companions(const std::string& path) : stem_(path) { stem_.replace_extension(); }

    [[nodiscard]] std::string material_file() const { return stem_.string() + ".mtl"; }
    [[nodiscard]] std::string texture_file(const surface_material& m, const char* kind) const {
        return stem_.string() + "_" + as_word(m.name) + kind + ".png";
    }
    [[nodiscard]] static std::string name_of(const std::string& path) {
        return std::filesystem::path(path).filename().string();
    }

  private:
    std::filesystem::path stem_;
};

constexpr const char* base_kind = "";
constexpr const char* normal_kind = "_normal";

failure cannot(const std::string& path, const std::string& why) {
    return fail(error_code::bad_input, in_quotes(path) + " can't be written: " + why);
}

result<void> check_mesh(const std::string& path, const surface_mesh& mesh, std::size_t materials) {
    const std::size_t vertices = mesh.vertices.size();
    const auto beyond = [vertices](std::uint32_t number) { return number >= vertices; };
    if (mesh.indices.size() % 3 != 0 ||
        std::any_of(mesh.indices.begin(), mesh.indices.end(), beyond)) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " has " +
                                std::to_string(mesh.indices.size()) +
                                " indices that are no triangles of its " +
                                std::to_string(vertices) + " vertices.");
    }
    if (!mesh.places.empty() && (mesh.places.size() != vertices ||
                                 std::any_of(mesh.places.begin(), mesh.places.end(), beyond))) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " has " +
                                std::to_string(mesh.places.size()) +
                                " numbers of places that don't fit its " +
                                std::to_string(vertices) + " vertices.");
    }
    if (materials != 0 && mesh.material >= materials) {
        return cannot(path, "the mesh " + in_quotes(mesh.name) + " is of material " +
                                std::to_string(mesh.material) + ", but there are " +
                                std::to_string(materials) + ".");
    }
    return {};
}

result<void> check(const std::string& path, std::span<const surface_mesh> meshes,
                   std::span<const surface_material> materials) {
    for (const surface_mesh& mesh : meshes) {
        if (auto good = check_mesh(path, mesh, materials.size()); !good) {
            return good;
        }
    }
    for (std::size_t i = 0; i < materials.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (as_word(materials[i].name) == as_word(materials[k].name)) {
                return cannot(path,
                              "two materials have the name " + in_quotes(materials[i].name) + ".");
            }
        }
    }
    // The name stands in a line of the file.
    if (!materials.empty() &&
        companions::name_of(path).find_first_of("\r\n") != std::string::npos) {
        return cannot(path, "its name has a line break, which the name of a .mtl can't have.");
    }
    return {};
}

void add_word(text_writer& to, std::string_view keyword, std::string_view word) {
    to.add(keyword);
    to.add(" ");
    to.add(word);
    to.end_line();
}

void add_material(text_writer& to, const surface_material& m, const companions& beside) {
    add_word(to, "newmtl", as_word(m.name));
    add_floats(to, "Kd", {m.base_color.r, m.base_color.g, m.base_color.b});
    add_floats(to, "Ks", {0, 0, 0});
    add_floats(to, "d", {m.base_color.a});
    add_floats(to, "Pr", {m.roughness});
    add_word(to, "illum", "1");
    if (!m.base_texture.empty()) {
        const std::string name = companions::name_of(beside.texture_file(m, base_kind));
        add_word(to, "map_Kd", name);
        if (m.masked) {
            add_word(to, "map_d", name);
        }
    }
    if (!m.normal_texture.empty()) {
        add_word(to, "norm", companions::name_of(beside.texture_file(m, normal_kind)));
    }
    to.end_line();
}

/// Files that are on the disk but have no name yet.
class file_set {
  public:
    /// Creates a file, and lets `fill` write it.
    template <class Fill>
    [[nodiscard]] result<void> add(const std::string& path, Fill&& fill) {
        auto file = atomic_file::create(path);
        if (!file) {
            return failure(file.error());
        }
        if (result<void> done = fill(*file); !done) {
            return done;
        }
        if (auto done = file->finish(); !done) {
            return done;
        }
        files_.push_back(std::move(*file));
        return {};
    }
    [[nodiscard]] result<void> commit() {
        for (atomic_file& file : files_) {
            if (auto done = file.commit(); !done) {
                return done;
            }
        }
        return {};
    }

  private:
    std::vector<atomic_file> files_;
};

result<void> add_texture(file_set& to, const std::string& path, const image_view& image) {
    if (image.empty()) {
        return {};
    }
    const auto png = encode_png(path, image.rgba, image.width, image.height);
    if (!png) {
        return failure(png.error());
    }
    return to.add(path, [&](atomic_file& file) { return file.write(*png); });
}

result<void> add_materials(file_set& to, std::span<const surface_material> materials,
                           const companions& beside) {
    for (const surface_material& m : materials) {
        if (auto done = add_texture(to, beside.texture_file(m, base_kind), m.base_texture); !done) {
            return done;
        }
        if (auto done = add_texture(to, beside.texture_file(m, normal_kind), m.normal_texture);
            !done) {
            return done;
        }
    }
    return to.add(beside.material_file(), [&](atomic_file& file) {
        text_writer text(file);
        for (const surface_material& m : materials) {
            add_material(text, m, beside);
        }
        return text.finish();
    });
}

result<void> add_meshes(atomic_file& file, std::span<const surface_mesh> meshes,
                        std::span<const surface_material> materials, const companions& beside) {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    for (const surface_mesh& mesh : meshes) {
        vertices += mesh.vertices.size();
        triangles += mesh.indices.size() / 3;
    }
    text_writer to(file);
    add_word(to, "# Metres, +Y up.",
             std::to_string(vertices) + " vertices, " + std::to_string(triangles) + " triangles.");
    if (!materials.empty()) {
        add_word(to, "mtllib", companions::name_of(beside.material_file()));
    }
    obj_writer objects(to);
    for (const surface_mesh& mesh : meshes) {
        if (meshes.size() > 1) {
            add_word(to, "g", as_word(mesh.name));
        }
        if (!materials.empty()) {
            add_word(to, "usemtl", as_word(materials[mesh.material].name));
        }
        objects.add(mesh, materials.empty() ? glm::vec2(1) : materials[mesh.material].repeats);
    }
    return to.finish();
}

} // namespace

result<void> write_obj(const std::string& path, std::span<const surface_mesh> meshes,
                       std::span<const surface_material> materials) {
    try {
        if (auto good = check(path, meshes, materials); !good) {
            return good;
        }
        const companions beside(path);
        file_set files;
        if (!materials.empty()) {
            if (auto done = add_materials(files, materials, beside); !done) {
                return done;
            }
        }
        if (auto done = files.add(
                path,
                [&](atomic_file& file) { return add_meshes(file, meshes, materials, beside); });
            !done) {
            return done;
        }
        return files.commit();
    } catch (const std::exception&) { // bad_alloc, length_error
        return fail(error_code::out_of_memory,
                    "There is not enough memory to write " + in_quotes(path) + ".");
    }
}

result<void> write_obj(const std::string& path, std::span<const surface_vertex> vertices,
                       std::span<const std::uint32_t> indices) {
    surface_mesh mesh;
    mesh.vertices = vertices;
    mesh.indices = indices;
    return write_obj(path, {&mesh, 1}, {});
}

} // namespace skybark::io
