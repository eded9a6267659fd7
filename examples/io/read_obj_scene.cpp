#include <io/cut_polygon.hpp>
#include <io/number_table.hpp>
#include <io/read_mtl.hpp>
#include <io/read_scene.hpp>
#include <io/word_lines.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace skybark::io {

namespace {

constexpr std::int64_t no_number = -1;

/// What a corner of a face names: a place, a texture coordinate, a normal; no_number: none.
using corner = std::array<std::int64_t, 3>;

struct corner_hash {
    std::size_t operator()(const corner& c) const noexcept {
        std::uint64_t hash = 0;
        for (const std::int64_t number : c) {
            hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 29u;
        }
        return static_cast<std::size_t>(hash);
    }
};

/// What the format has and a scene of triangles hasn't.
bool is_skipped(std::string_view keyword) {
    constexpr std::string_view known[] = {
        "o",    "g",      "s",      "l",          "p",         "vp",    "deg",      "bmat",
        "step", "cstype", "curv",   "curv2",      "surf",      "parm",  "trim",     "hole",
        "scrv", "sp",     "end",    "con",        "mg",        "bevel", "c_interp", "d_interp",
        "lod",  "maplib", "usemap", "shadow_obj", "trace_obj", "ctech", "stech"};
    return std::find(std::begin(known), std::end(known), keyword) != std::end(known);
}

class obj_reader {
  public:
    obj_reader(const std::string& path, std::string_view text) : path_(path), lines_(path, text) {}

    [[nodiscard]] result<triangle_scene> read() {
        std::string_view line;
        while (lines_.next(line)) {
            if (auto done = statement(line); !done) {
                return failure(done.error());
            }
        }
        if (scene_.triangles.empty()) {
            return fail(error_code::bad_input,
                        in_quotes(path_) + " has no triangles; expected at least one face.");
        }
        return std::move(scene_);
    }

  private:
    [[nodiscard]] result<void> statement(std::string_view rest) {
        const std::string_view keyword = next_word(rest);
        if (keyword == "v") {
            return place(rest);
        }
        if (keyword == "vt") {
            return texture_coordinate(rest);
        }
        if (keyword == "vn") {
            return normal(rest);
        }
        if (keyword == "f" || keyword == "fo") {
            return face(rest);
        }
        if (keyword == "usemtl") {
            return use(trimmed(rest));
        }
        if (keyword == "mtllib") {
            return load_materials(trimmed(rest));
        }
        if (is_skipped(keyword)) {
            return {};
        }
        return lines_.fail_here(in_quotes(keyword) +
                                " is no statement of an OBJ file; expected v, vt, vn, f, usemtl, "
                                "mtllib or another that the format has.");
    }

    [[nodiscard]] result<void> place(std::string_view rest) {
        const auto value =
            lines_.numbers("v", rest, -farthest_metres, farthest_metres, expected_position);
        if (!value) {
            return failure(value.error());
        }
        places_.push_back(*value);
        return {};
    }

    [[nodiscard]] result<void> texture_coordinate(std::string_view rest) {
        glm::vec2 coordinate(0);
        for (int i = 0; i < 2; ++i) {
            if (i == 1 && trimmed(rest).empty()) {
                break; // a line alone has one
            }
            const auto value =
                lines_.number("vt", rest, -1e6, 1e6, "a finite number of at most 1e6");
            if (!value) {
                return failure(value.error());
            }
            coordinate[i] = static_cast<float>(*value);
        }
        coordinates_.push_back(coordinate);
        return {};
    }

    [[nodiscard]] result<void> normal(std::string_view rest) {
        const auto value = lines_.numbers("vn", rest, -1e9, 1e9, "finite numbers of at most 1e9");
        if (!value) {
            return failure(value.error());
        }
        const glm::dvec3 wide(*value);
        const double length = glm::length(wide);
        normals_.push_back(length > 0 ? glm::vec3(wide / length) : glm::vec3(0));
        return {};
    }

    /// Turns "7", "-1" into an index below `count`.
    [[nodiscard]] result<std::int64_t> index(std::string_view word, std::size_t count,
                                             const char* what) const {
        const auto number = parse_integer(word);
        const auto size = static_cast<std::int64_t>(count);
        if (!number || *number == 0) {
            return lines_.fail_here("f has " + in_quotes(word) + "; expected the number of a " +
                                    what + ".");
        }
        if (*number > size || *number < -size) {
            return lines_.fail_here("f names the " + std::string(what) + " " +
                                    std::to_string(*number) + "; expected one of the " +
                                    std::to_string(size) + " before it.");
        }
        return *number > 0 ? *number - 1 : size + *number;
    }

    /// "7", "7/5", "7/5/3" or "7//3".
    [[nodiscard]] result<corner> parse_corner(std::string_view word) const {
        corner c{no_number, no_number, no_number};
        const std::size_t counts[3] = {places_.size(), coordinates_.size(), normals_.size()};
        const char* const names[3] = {"vertex", "texture coordinate", "normal"};
        bool more = true;
        for (std::size_t i = 0; i < 3 && more; ++i) {
            const std::size_t end = word.find('/');
            const std::string_view part = word.substr(0, end);
            more = end != std::string_view::npos;
            word.remove_prefix(more ? end + 1 : word.size());
            if (part.empty() && i > 0) {
                continue;
            }
            const auto number = index(part, counts[i], names[i]);
            if (!number) {
                return failure(number.error());
            }
            c[i] = *number;
        }
        if (more) {
            return lines_.fail_here("f has a corner of more than three numbers; expected "
                                    "vertex/texture/normal.");
        }
        return c;
    }

    [[nodiscard]] std::uint32_t vertex_of(const corner& c) {
        const auto [at, is_new] =
            vertices_.emplace(c, static_cast<std::uint32_t>(scene_.positions.size()));
        if (is_new) {
            const auto pick = [](std::int64_t i) { return static_cast<std::size_t>(i); };
            scene_.positions.push_back(places_[pick(c[0])]);
            scene_.coordinates.push_back(c[1] == no_number ? glm::vec2(0)
                                                           : coordinates_[pick(c[1])]);
            scene_.normals.push_back(c[2] == no_number ? glm::vec3(0) : normals_[pick(c[2])]);
        }
        return at->second;
    }

    [[nodiscard]] result<void> face(std::string_view rest) {
        numbers_.clear();
        corners_.clear();
        for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
            const auto c = parse_corner(word);
            if (!c) {
                return failure(c.error());
            }
            numbers_.push_back(vertex_of(*c));
            corners_.push_back(places_[static_cast<std::size_t>((*c)[0])]);
        }
        if (numbers_.size() < 3) {
            return lines_.fail_here("f has " + std::to_string(numbers_.size()) +
                                    " corners; expected three at least.");
        }
        const auto triangles = cut_polygon(corners_);
        if (!triangles) {
            return lines_.fail_here("f is no convex polygon and has " +
                                    std::to_string(corners_.size()) + " corners; expected " +
                                    std::to_string(most_concave_corners) + " at most.");
        }
        const std::uint32_t material = current_material();
        for (const auto& t : *triangles) {
            scene_.triangles.emplace_back(numbers_[t[0]], numbers_[t[1]], numbers_[t[2]]);
            scene_.material_of.push_back(material);
        }
        return {};
    }

    /// The one that usemtl named, or grey.
    [[nodiscard]] std::uint32_t current_material() {
        if (material_ == none) {
            if (grey_ == none) {
                grey_ = static_cast<std::uint32_t>(scene_.materials.size());
                scene_.materials.emplace_back().name = "default";
            }
            return grey_;
        }
        return material_;
    }

    [[nodiscard]] result<void> use(std::string_view name) {
        for (std::size_t i = scene_.materials.size(); i-- > 0;) {
            if (i != grey_ && scene_.materials[i].name == name) {
                material_ = static_cast<std::uint32_t>(i);
                return {};
            }
        }
        return lines_.fail_here(
            "there is no material " + in_quotes(name) +
            (library_.empty() ? "; expected a mtllib before that has it."
                              : " in " + in_quotes(library_) + "; expected one that it has."));
    }

    /// Several names may stand in one line, and names may have spaces: the whole is tried first.
    [[nodiscard]] result<void> load_materials(std::string_view names) {
        if (names.empty()) {
            return lines_.fail_here("mtllib has no name; expected that of a .mtl file.");
        }
        if (exists(names)) {
            return load_material_file(names);
        }
        for (std::string_view rest = names, name = next_word(rest); !name.empty();
             name = next_word(rest)) {
            if (!exists(name)) {
                return lines_.fail_here("there is no file " + in_quotes(beside(name)) +
                                        "; expected the materials that mtllib names.");
            }
            if (auto done = load_material_file(name); !done) {
                return done;
            }
        }
        return {};
    }

    [[nodiscard]] std::string beside(std::string_view name) const {
        return (std::filesystem::path(path_).parent_path() / std::string(name)).string();
    }
    [[nodiscard]] bool exists(std::string_view name) const {
        std::error_code ignored;
        return std::filesystem::exists(beside(name), ignored);
    }

    [[nodiscard]] result<void> load_material_file(std::string_view name) {
        library_ = beside(name);
        return read_mtl(library_, scene_.materials, scene_.maps);
    }

    static constexpr std::uint32_t none = 0xffffffffu;

    const std::string& path_;
    word_lines lines_;
    triangle_scene scene_;
    std::vector<glm::vec3> places_;
    std::vector<glm::vec2> coordinates_;
    std::vector<glm::vec3> normals_;
    std::unordered_map<corner, std::uint32_t, corner_hash> vertices_;
    std::vector<std::uint32_t> numbers_; // of the face
    std::vector<glm::vec3> corners_;
    std::uint32_t material_ = none;
    std::uint32_t grey_ = none;
    std::string library_;
};

} // namespace

result<triangle_scene> read_obj_scene(const std::string& path) {
    return within_memory(path, [&]() -> result<triangle_scene> {
        const auto text = load_text(path);
        if (!text) {
            return failure(text.error());
        }
        return obj_reader(path, *text).read();
    });
}

} // namespace skybark::io
