#include <io/read_mtl.hpp>

#include <io/picture_means.hpp>
#include <io/word_lines.hpp>

#include <algorithm>
#include <filesystem>
#include <glm/common.hpp>
#include <map>
#include <optional>
#include <utility>

namespace skybark::io {

namespace {

constexpr double brightest = 1e9;

/// A material as its lines have it.
struct mtl_material {
    std::string name;
    glm::vec3 diffuse{0.5f};
    glm::vec3 emission{0};
    std::optional<glm::vec3> filter; ///< Tf
    double opaque = 1;               ///< d
    std::int64_t illum = 2;
    std::string map_diffuse;
    std::string map_emission;
    std::string map_opaque;
};

bool lets_light_through(std::int64_t illum) {
    return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}

/// How many words an option of a map takes after itself; nothing: it is none.
std::optional<int> words_of_option(std::string_view word) {
    constexpr std::pair<std::string_view, int> known[] = {
        {"-blendu", 1}, {"-blendv", 1},  {"-boost", 1}, {"-bm", 1},     {"-cc", 1},
        {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},    {"-texres", 1}, {"-type", 1}};
    for (const auto& [name, count] : known) {
        if (name == word) {
            return count;
        }
    }
    return {};
}

/// The name of a file behind a map's options; it may have spaces.
std::string map_name(std::string_view rest) {
    while (true) {
        std::string_view after = rest;
        const std::string_view word = next_word(after);
        if (word == "-o" || word == "-s" || word == "-t") { // one number to three
            rest = after;
            for (int i = 0; i < 3 && parse_number(next_word(after)); ++i) {
                rest = after;
            }
        } else if (const auto count = words_of_option(word)) {
            for (int i = 0; i < *count; ++i) {
                (void)next_word(after);
            }
            rest = after;
        } else {
            return std::string(trimmed(rest));
        }
    }
}

class mtl_reader {
  public:
    mtl_reader(const std::string& path, std::string_view text, std::vector<scene_material>& to,
               std::vector<alpha_map>& maps)
        : path_(path), lines_(path, text), to_(to), maps_(maps) {}

    [[nodiscard]] result<void> read() {
        std::string_view line;
        while (lines_.next(line)) {
            if (auto done = statement(line); !done) {
                return done;
            }
        }
        return end_material();
    }

  private:
    [[nodiscard]] result<void> statement(std::string_view rest) {
        const std::string_view keyword = next_word(rest);
        if (keyword == "newmtl") {
            auto done = end_material();
            rest = trimmed(rest);
            if (done && rest.empty()) {
                return lines_.fail_here("newmtl has no name; expected one.");
            }
            current_.emplace().name = rest;
            return done;
        }
        if (!current_) {
            return is_ours(keyword) ? lines_.fail_here(in_quotes(keyword) +
                                                       " stands before the first newmtl; expected "
                                                       "it in a material.")
                                    : result<void>();
        }
        return property(keyword, rest);
    }

    [[nodiscard]] static bool is_ours(std::string_view keyword) {
        constexpr std::string_view ours[] = {"Kd",    "Ke",     "Tf",     "d",    "Tr",
                                             "illum", "map_Kd", "map_Ke", "map_d"};
        return std::find(std::begin(ours), std::end(ours), keyword) != std::end(ours);
    }

    [[nodiscard]] result<void> property(std::string_view keyword, std::string_view rest) {
        mtl_material& m = *current_;
        if (keyword == "Kd") {
            return colour(keyword, rest, 1, "numbers from 0 to 1", m.diffuse);
        }
        if (keyword == "Ke") {
            return colour(keyword, rest, brightest, "numbers from 0 to 1e9", m.emission);
        }
        if (keyword == "Tf") {
            return colour(keyword, rest, 1, "numbers from 0 to 1", m.filter.emplace());
        }
        if (keyword == "d" || keyword == "Tr") {
            const auto value = lines_.number(keyword, rest, 0, 1, "a number from 0 to 1");
            if (value) {
                m.opaque = keyword == "d" ? *value : 1 - *value;
            }
            return value ? result<void>() : failure(value.error());
        }
        if (keyword == "illum") {
            const auto value = lines_.number(keyword, rest, 0, 10, "a number from 0 to 10");
            if (value) {
                m.illum = static_cast<std::int64_t>(*value);
            }
            return value ? result<void>() : failure(value.error());
        }
        if (keyword == "map_Kd") {
            m.map_diffuse = map_name(rest);
        } else if (keyword == "map_Ke") {
            m.map_emission = map_name(rest);
        } else if (keyword == "map_d") {
            m.map_opaque = map_name(rest);
        }
        return {};
    }

    [[nodiscard]] result<void> colour(std::string_view keyword, std::string_view rest, double high,
                                      std::string_view expected, glm::vec3& to) {
        std::string_view words = rest;
        const std::string_view first = next_word(words);
        if (first == "spectral" || first == "xyz") {
            return lines_.fail_here(std::string(keyword) + " is " + in_quotes(first) +
                                    "; expected red, green and blue.");
        }
        if (!first.empty() && trimmed(words).empty()) { // one number is a grey
            const auto grey = lines_.number(keyword, rest, 0, high, expected);
            if (!grey) {
                return failure(grey.error());
            }
            to = glm::vec3(static_cast<float>(*grey));
            return {};
        }
        const auto value = lines_.numbers(keyword, rest, 0, high, expected);
        if (!value) {
            return failure(value.error());
        }
        to = *value;
        return {};
    }

    [[nodiscard]] result<void> end_material() {
        if (!current_) {
            return {};
        }
        const mtl_material from = *std::exchange(current_, std::nullopt);
        scene_material m;
        m.name = from.name;
        const auto opaque = static_cast<float>(from.opaque);
        m.diffuse = from.diffuse * opaque;
        m.emission = from.emission;
        if (opaque < 1) {
            m.transmission = (1 - opaque) * from.filter.value_or(glm::vec3(1));
        } else if (lets_light_through(from.illum)) {
            m.transmission = from.filter.value_or(glm::vec3(0));
        }
        auto done = multiply_by_mean(from.map_diffuse, m.diffuse);
        if (done && m.emission != glm::vec3(0)) {
            done = multiply_by_mean(from.map_emission, m.emission);
        }
        if (done && !from.map_opaque.empty()) {
            done = find_holes(from.map_opaque, m);
        }
        if (!done) {
            return done;
        }
        const glm::vec3 back = m.diffuse + m.transmission;
        const float most = std::max({back.x, back.y, back.z});
        if (most > 1.0001f) {
            return fail(error_code::bad_input,
                        in_quotes(path_) + ": the material " + in_quotes(m.name) +
                            " reflects and transmits " + std::to_string(most) +
                            " of what arrives; expected Kd and Tf to be 1 at most together.");
        }
        m.two_sided = m.transmission != glm::vec3(0) || m.alpha_map != no_alpha_map;
        to_.push_back(std::move(m));
        return {};
    }

    [[nodiscard]] result<const colour_picture*> picture(const std::string& name) {
        const auto known = pictures_.find(name);
        if (known != pictures_.end()) {
            return &known->second;
        }
        std::string plain = name; // exporters on Windows
        std::replace(plain.begin(), plain.end(), '\\', '/');
        const auto beside = std::filesystem::path(path_).parent_path() / plain;
        auto read = read_colours(beside.string());
        if (!read) {
            return fail(read.error().code == error_code::out_of_memory ? error_code::out_of_memory
                                                                       : error_code::bad_input,
                        in_quotes(path_) + " names a picture: " + read.error().message);
        }
        return &pictures_.emplace(name, std::move(*read)).first->second;
    }

    [[nodiscard]] result<void> multiply_by_mean(const std::string& name, glm::vec3& to) {
        if (name.empty()) {
            return {};
        }
        const auto read = picture(name);
        if (!read) {
            return failure(read.error());
        }
        to *= mean_colour(**read);
        return {};
    }

    [[nodiscard]] result<void> find_holes(const std::string& name, scene_material& m) {
        const auto known = map_of_.find(name);
        if (known == map_of_.end()) {
            const auto read = picture(name);
            if (!read) {
                return failure(read.error());
            }
            map_of_[name] = static_cast<std::uint32_t>(maps_.size());
            maps_.push_back(alpha_of(**read, true));
        }
        m.alpha_map = map_of_[name];
        return {};
    }

    const std::string& path_;
    word_lines lines_;
    std::vector<scene_material>& to_;
    std::vector<alpha_map>& maps_;
    std::optional<mtl_material> current_;
    std::map<std::string, colour_picture> pictures_;
    std::map<std::string, std::uint32_t> map_of_;
};

} // namespace

result<void> read_mtl(const std::string& path, std::vector<scene_material>& materials,
                      std::vector<alpha_map>& maps) {
    const auto text = load_text(path);
    if (!text) {
        return failure(text.error());
    }
    return mtl_reader(path, *text, materials, maps).read();
}

} // namespace skybark::io
