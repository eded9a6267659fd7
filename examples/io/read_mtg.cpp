#include <io/read_mtg.hpp>

#include <io/text_input.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace skybark::io {

namespace {

constexpr std::string_view space = " \t\r\v\f";

/// Takes the next cell off a line, without its comment; false at its end.
bool next_cell(std::string_view& line, bool& more, std::string_view& cell) {
    if (!more)
        return false;
    const std::size_t end = line.find('\t');
    cell = line.substr(0, end);
    cell = trimmed(cell.substr(0, cell.find('#')));
    more = end != std::string_view::npos;
    line.remove_prefix(more ? end + 1 : line.size());
    return true;
}

/// Takes the next word off a line of the header, where any blanks separate.
std::string_view next_word(std::string_view& line) {
    const std::size_t first = line.find_first_not_of(space);
    if (first == std::string_view::npos) {
        line = {};
        return {};
    }
    const std::size_t end = line.find_first_of(space, first);
    const std::string_view word =
        line.substr(first, end == std::string_view::npos ? end : end - first);
    line.remove_prefix(end == std::string_view::npos ? line.size() : end);
    return word;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// What a column of the MTG section is read as.
enum class feature : std::uint8_t { x, y, z, top_diameter, top_radius, bottom_diameter, skipped };

feature feature_of(std::string_view name) {
    struct synonym {
        std::string_view name;
        feature meaning;
    };
    constexpr std::array<synonym, 18> synonyms{{
        {"XX", feature::x},
        {"X", feature::x},
        {"YY", feature::y},
        {"Y", feature::y},
        {"ZZ", feature::z},
        {"Z", feature::z},
        {"TopDia", feature::top_diameter},
        {"TopDiameter", feature::top_diameter},
        {"Diameter", feature::top_diameter},
        {"diameter", feature::top_diameter},
        {"diam", feature::top_diameter},
        {"Radius", feature::top_radius},
        {"TopRadius", feature::top_radius},
        {"R", feature::top_radius},
        {"radius", feature::top_radius},
        {"BotDia", feature::bottom_diameter},
        {"BotDiameter", feature::bottom_diameter},
        {"BottomDiameter", feature::bottom_diameter},
    }};
    for (const synonym& s : synonyms)
        if (s.name == name)
            return s.meaning;
    return feature::skipped;
}

/// Where a code has come to: what the next relation goes on from.
struct position {
    int scale = -1;                      ///< -1: nothing here
    std::uint32_t segment = trees::none; ///< that wood from here on hangs from
    bool has_base = false;               ///< whether a coarser entity said where the wood begins
    glm::dvec3 base{0};                  ///< m, z up
    double base_radius = -1;             ///< m; negative: not given
};

/// The features of one line; NaN: not given.
struct measures {
    static constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    std::array<double, 3> at{missing, missing, missing};
    double radius = missing;
    double bottom_radius = missing;
    [[nodiscard]] bool placed() const { return !std::isnan(at[0]); }
};

class mtg_parser {
  public:
    mtg_parser(std::string_view name, mtg_units units) : name_(name), units_(units) {}

    result<std::vector<trees::segment>> parse(std::string_view text) {
        text = without_mark(text);
        while (!text.empty()) {
            const std::string_view line = next_line(text);
            ++line_;
            if (auto read = read_line(line); !read)
                return failure(read.error());
        }
        if (line_ == 0)
            return fail(error_code::bad_input, in_quotes(name_) + " is empty; expected an MTG.");
        if (section_ != section::entities)
            return fail_at(name_, line_,
                           "the file ends before the section MTG; expected the sections CODE, "
                           "CLASSES, DESCRIPTION, FEATURES and MTG.");
        if (segments_.empty())
            return fail_at(name_, line_,
                           "no entity of the finest scale, " + std::to_string(finest_) +
                               ", has coordinates; expected one at least.");
        return std::move(segments_);
    }

  private:
    enum class section { start, code, classes, description, features, entities };

    result<void> wrong(std::string_view complaint) const {
        return fail_at(name_, line_, complaint);
    }

    /// Which section a line of the header begins; `rest` is what follows its keyword and colon.
    static section keyword_of(std::string_view line, std::string_view& rest) {
        rest = line;
        std::string_view word = next_word(rest);
        bool colon = false;
        if (!word.empty() && word.back() == ':') {
            word.remove_suffix(1);
            colon = true;
        } else if (std::string_view after = rest; next_word(after) == ":") {
            rest = after;
            colon = true;
        }
        if (word == "CODE")
            return section::code;
        if (!colon)
            return section::start;
        if (word == "CLASSES")
            return section::classes;
        if (word == "DESCRIPTION")
            return section::description;
        if (word == "FEATURES")
            return section::features;
        return word == "MTG" ? section::entities : section::start;
    }

    result<void> read_line(std::string_view line) {
        if (section_ == section::entities)
            return have_columns_ ? read_entity(line) : read_columns(line);
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(space) == std::string_view::npos)
            return {};
        std::string_view rest;
        const section begun = keyword_of(line, rest);
        if (begun != section::start)
            return begin(begun, rest);
        switch (section_) {
        case section::classes:
            return read_class(line);
        case section::features:
            return read_feature(line);
        case section::description:
            return {};
        default:
            return wrong(in_quotes(line) + " stands before any section; expected \"CODE:\".");
        }
    }

    result<void> begin(section begun, std::string_view rest) {
        if (static_cast<int>(begun) != static_cast<int>(section_) + 1)
            return wrong("a section begins out of turn; expected CODE, CLASSES, DESCRIPTION, "
                         "FEATURES and MTG, each once.");
        if (begun == section::code)
            if (const std::string_view form = next_word(rest); form != "FORM-A")
                return wrong("the code's form is " + in_quotes(form) + "; expected \"FORM-A\".");
        if (begun == section::entities && finest_ < 1)
            return wrong("no class has a scale of 1 or more; expected some in CLASSES.");
        section_ = begun;
        return {};
    }

    result<void> read_class(std::string_view line) {
        std::string_view rest = line;
        const std::string_view symbol = next_word(rest);
        const std::string_view scale_text = next_word(rest);
        if (symbol == "SYMBOL")
            return {};
        const bool named = symbol == "$" || std::all_of(symbol.begin(), symbol.end(), is_letter);
        if (!named)
            return wrong("the class's symbol is " + in_quotes(symbol) + "; expected letters.");
        const auto scale = parse_integer(scale_text);
        constexpr int most_scales = 1000;
        if (!scale || *scale < 0 || *scale > most_scales)
            return wrong("the scale of class " + in_quotes(symbol) + " is " +
                         in_quotes(scale_text) + "; expected a whole number from 0 to 1000.");
        const auto [at, is_new] = scale_of_.emplace(symbol, static_cast<int>(*scale));
        if (!is_new && at->second != *scale)
            return wrong("the class " + in_quotes(symbol) + " has the scale " +
                         in_quotes(scale_text) + " here and " + std::to_string(at->second) +
                         " above; expected one.");
        finest_ = std::max(finest_, at->second);
        return {};
    }

    result<void> read_feature(std::string_view line) {
        const std::string_view name = next_word(line);
        if (name != "NAME")
            declared_.emplace(name);
        return {};
    }

    result<void> read_columns(std::string_view line) {
        std::string_view rest = line;
        std::string_view cell;
        bool more = true;
        next_cell(rest, more, cell);
        if (cell.empty() && trimmed(line.substr(0, line.find('#'))).empty())
            return {};
        if (cell != "ENTITY-CODE" && cell != "TOPO")
            return wrong("the columns of the section MTG begin with " + in_quotes(cell) +
                         "; expected \"ENTITY-CODE\".");
        code_columns_ = 1;
        std::set<feature> found;
        while (next_cell(rest, more, cell)) {
            if (cell.empty()) {
                if (meaning_.empty())
                    ++code_columns_;
                else
                    meaning_.push_back(feature::skipped);
                continue;
            }
            if (declared_.find(cell) == declared_.end())
                return wrong("the column " + in_quotes(cell) +
                             " isn't one of the features declared in FEATURES.");
            meaning_.push_back(feature_of(cell));
            if (meaning_.back() != feature::skipped && !found.insert(meaning_.back()).second)
                return wrong("the column " + in_quotes(cell) +
                             " says again what another column says; expected one of them.");
        }
        if (found.count(feature::x) + found.count(feature::y) + found.count(feature::z) < 3)
            return wrong("there are no columns XX, YY and ZZ (or X, Y and Z) among the features; "
                         "expected where each entity ends.");
        if (found.count(feature::top_diameter) + found.count(feature::top_radius) == 0)
            return wrong("there is no column TopDia, Diameter or Radius among the features; "
                         "expected how thick each entity is.");
        have_columns_ = true;
        return {};
    }

    result<void> read_entity(std::string_view line) {
        std::string_view rest = line;
        std::string_view cell;
        std::string_view code;
        std::size_t column = 0;
        std::size_t index = 0;
        bool more = true;
        for (; index < code_columns_ && next_cell(rest, more, cell); ++index) {
            if (cell.empty())
                continue;
            if (!code.empty())
                return wrong("there are two codes, " + in_quotes(code) + " and " + in_quotes(cell) +
                             "; expected one a line.");
            code = cell;
            column = index;
        }
        measures m;
        for (const feature meaning : meaning_) {
            if (!next_cell(rest, more, cell))
                break;
            if (cell.empty() || meaning == feature::skipped)
                continue;
            if (code.empty())
                return wrong("there is the value " + in_quotes(cell) +
                             " without a code; expected one before it.");
            if (auto read = read_measure(meaning, cell, m); !read)
                return read;
        }
        if (code.empty())
            return {};
        const auto given =
            std::count_if(m.at.begin(), m.at.end(), [](double v) { return !std::isnan(v); });
        if (given != 0 && given != 3)
            return wrong(in_quotes(code) + " has " + std::to_string(given) +
                         " of the coordinates XX, YY and ZZ; expected all or none.");
        return follow(code, column, m);
    }

    result<void> read_measure(feature meaning, std::string_view cell, measures& m) const {
        const auto value = parse_number(cell);
        const double unit = meaning <= feature::z ? units_.coordinate : units_.diameter;
        if (!value || !(std::abs(*value * unit) <= most_metres))
            return wrong("a coordinate or thickness is " + in_quotes(cell) +
                         "; expected a finite number of at most 1e9 metres.");
        if (meaning <= feature::z) {
            m.at[static_cast<std::size_t>(meaning)] = *value * unit;
            return {};
        }
        if (*value < 0)
            return wrong("a thickness is " + in_quotes(cell) + "; expected zero or more.");
        if (meaning == feature::top_radius)
            m.radius = *value * unit;
        else
            (meaning == feature::top_diameter ? m.radius : m.bottom_radius) = *value * unit / 2;
        return {};
    }

    /// Follows a code from where its column says and leaves the column where it ends.
    result<void> follow(std::string_view code, std::size_t column, const measures& m) {
        const std::string_view whole = code;
        position at;
        const bool same_column = code.front() == '^';
        if (same_column)
            code.remove_prefix(1);
        const bool begins_plant = !same_column && column == 0;
        const std::size_t from = same_column ? column : column - 1;
        if (begins_plant) {
            at.scale = 0;
            if (code.empty() || code.front() != '/')
                return wrong("the code " + in_quotes(whole) +
                             " begins a plant; expected a \"/\" first (or a \"^\", to go on).");
            const std::string label(code.substr(1, code.find_first_of("/<+", 1) - 1));
            if (!plants_.insert(label).second)
                return wrong("the code " + in_quotes(whole) + " begins the plant " +
                             in_quotes(label) +
                             " again; expected codes relative to those above it.");
        } else if (from >= last_.size() || last_[from].scale < 0) {
            return wrong("the code " + in_quotes(whole) + " goes on from column " +
                         std::to_string(from + 1) + ", where there is nothing above it.");
        } else {
            at = last_[from];
        }
        if (code.empty())
            return wrong("the code " + in_quotes(whole) +
                         " is incomplete; expected \"/\", \"<\" or \"+\" and a label.");
        while (!code.empty())
            if (auto stepped = step(code, whole, at, m); !stepped)
                return stepped;
        last_.resize(std::max(last_.size(), column + 1));
        last_[column] = at;
        for (std::size_t c = column + 1; c < last_.size(); ++c)
            last_[c].scale = -1;
        return {};
    }

    /// Takes one relation and label (or a shorthand run of them) off the code.
    result<void> step(std::string_view& code, std::string_view whole, position& at,
                      const measures& m) {
        const char relation = code.front();
        if (relation != '/' && relation != '<' && relation != '+')
            return wrong("the code " + in_quotes(whole) + " has " + in_quotes(code) +
                         "; expected \"/\", \"<\" or \"+\" there.");
        code.remove_prefix(1);
        int scale = 0;
        std::string_view label;
        if (auto read = take_label(code, whole, label, scale); !read)
            return read;
        // E1<<E5: the entities between have no features, so that only the ends matter here
        for (const std::string_view run : {"<<", "++", "<.<", "+.+"}) {
            if (code.substr(0, run.size()) != run)
                continue;
            code.remove_prefix(run.size());
            int last_scale = 0;
            if (auto read = take_label(code, whole, label, last_scale); !read)
                return read;
            if (last_scale != scale)
                return wrong("the code " + in_quotes(whole) + " has a run to " + in_quotes(label) +
                             "; expected the same class at both ends.");
            break;
        }
        const bool fits = relation == '/' ? scale > at.scale : scale > 0 && scale <= at.scale;
        if (!fits)
            return wrong("in the code " + in_quotes(whole) + " the entity " + in_quotes(label) +
                         " of scale " + std::to_string(scale) + " comes after \"" + relation +
                         "\" and scale " + std::to_string(at.scale) + "; expected " +
                         (relation == '/' ? "a finer scale." : "the same or a coarser scale."));
        if (relation != '/')
            at.has_base = at.has_base && at.scale == finest_; // nothing placed there yet
        at.scale = scale;
        return arrive(at, code.empty() ? m : measures{});
    }

    result<void> take_label(std::string_view& code, std::string_view whole, std::string_view& label,
                            int& scale) const {
        std::size_t letters = 0;
        while (letters < code.size() && is_letter(code[letters]))
            ++letters;
        std::size_t end = letters;
        while (end < code.size() && is_digit(code[end]))
            ++end;
        const auto known = scale_of_.find(code.substr(0, letters));
        if (known == scale_of_.end())
            return wrong("the code " + in_quotes(whole) + " has the label " +
                         in_quotes(code.substr(0, std::max(end, std::size_t{1}))) +
                         "; expected the symbol of a class and a number.");
        scale = known->second;
        label = code.substr(0, end);
        code.remove_prefix(end);
        return {};
    }

    /// Notes a coarser entity's beginning, or makes a segment of one of the finest scale.
    result<void> arrive(position& at, const measures& m) {
        if (at.scale < finest_) {
            if (m.placed()) {
                at.has_base = true;
                at.base = {m.at[0], m.at[1], m.at[2]};
                at.base_radius = -1;
            }
            if (at.has_base && !std::isnan(m.radius))
                at.base_radius = m.radius;
            return {};
        }
        if (!m.placed())
            return {};
        trees::segment s;
        s.parent = at.segment;
        s.tip = from_z_up(m.at[0], m.at[1], m.at[2]);
        const bool hangs = at.segment != trees::none;
        s.base = s.tip;
        if (at.has_base)
            s.base = from_z_up(at.base.x, at.base.y, at.base.z);
        else if (hangs)
            s.base = segments_[at.segment].tip;
        double before = -1; // the thickness that is passed on where none is given
        if (at.has_base && at.base_radius >= 0)
            before = at.base_radius;
        else if (hangs)
            before = static_cast<double>(segments_[at.segment].radius);
        if (std::isnan(m.radius) && before < 0)
            return wrong("the first entity of a plant has coordinates and no thickness; expected "
                         "its TopDia, Diameter or Radius.");
        s.radius = static_cast<float>(std::isnan(m.radius) ? before : m.radius);
        if (!std::isnan(m.bottom_radius))
            s.base_radius = static_cast<float>(m.bottom_radius);
        else
            s.base_radius =
                at.has_base && at.base_radius >= 0 ? static_cast<float>(at.base_radius) : s.radius;
        if (segments_.size() >= trees::none - 1)
            return wrong("there are too many entities; expected at most 4294967294.");
        at.segment = static_cast<std::uint32_t>(segments_.size());
        at.has_base = false;
        segments_.push_back(s);
        return {};
    }

    std::string_view name_;
    mtg_units units_;
    section section_ = section::start;
    std::size_t line_ = 0;
    std::map<std::string, int, std::less<>> scale_of_;
    std::set<std::string, std::less<>> declared_;
    int finest_ = 0;
    bool have_columns_ = false;
    std::size_t code_columns_ = 0;
    std::vector<feature> meaning_;
    std::vector<position> last_; ///< for each column where its last code ended
    std::set<std::string, std::less<>> plants_;
    std::vector<trees::segment> segments_;
};

} // namespace

result<std::vector<trees::segment>> parse_mtg(std::string_view text, std::string_view name,
                                              mtg_units units) {
    return within_memory(name, [&] { return mtg_parser(name, units).parse(text); });
}

result<std::vector<trees::segment>> read_mtg(const std::string& path, mtg_units units) {
    const auto text = load_text(path);
    if (!text)
        return failure(text.error());
    return parse_mtg(*text, path, units);
}

} // namespace skybark::io
