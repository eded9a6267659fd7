#include <io/read_skeleton_json.hpp>

#include <io/text_input.hpp>
#include <skybark/trees/species.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <set>

// A reader of just this grammar instead of a general library: it knows the line of every value,
// keeps no second copy of ten million segments, and never recurses.

namespace skybark::io {

namespace {

using trees::weber_penn_level;
using trees::weber_penn_parameters;

template <class Record>
struct real_field {
    std::string_view name;
    float Record::*member;
};
template <class Record>
struct count_field {
    std::string_view name;
    int Record::*member;
};

constexpr std::array<real_field<weber_penn_parameters>, 19> tree_reals{{
    {"base_size", &weber_penn_parameters::base_size},
    {"scale", &weber_penn_parameters::scale},
    {"scale_v", &weber_penn_parameters::scale_v},
    {"z_scale", &weber_penn_parameters::z_scale},
    {"z_scale_v", &weber_penn_parameters::z_scale_v},
    {"ratio", &weber_penn_parameters::ratio},
    {"ratio_power", &weber_penn_parameters::ratio_power},
    {"lobe_depth", &weber_penn_parameters::lobe_depth},
    {"flare", &weber_penn_parameters::flare},
    {"leaf_scale", &weber_penn_parameters::leaf_scale},
    {"leaf_scale_x", &weber_penn_parameters::leaf_scale_x},
    {"attraction_up", &weber_penn_parameters::attraction_up},
    {"prune_ratio", &weber_penn_parameters::prune_ratio},
    {"prune_width", &weber_penn_parameters::prune_width},
    {"prune_width_peak", &weber_penn_parameters::prune_width_peak},
    {"prune_power_low", &weber_penn_parameters::prune_power_low},
    {"prune_power_high", &weber_penn_parameters::prune_power_high},
    {"trunk_scale", &weber_penn_parameters::trunk_scale},
    {"trunk_scale_v", &weber_penn_parameters::trunk_scale_v},
}};
constexpr std::array<count_field<weber_penn_parameters>, 6> tree_counts{{
    {"shape", &weber_penn_parameters::shape},
    {"levels", &weber_penn_parameters::levels},
    {"lobes", &weber_penn_parameters::lobes},
    {"leaves", &weber_penn_parameters::leaves},
    {"leaf_shape", &weber_penn_parameters::leaf_shape},
    {"base_splits", &weber_penn_parameters::base_splits},
}};
constexpr std::array<real_field<weber_penn_level>, 13> level_reals{{
    {"down_angle", &weber_penn_level::down_angle},
    {"down_angle_v", &weber_penn_level::down_angle_v},
    {"rotate", &weber_penn_level::rotate},
    {"rotate_v", &weber_penn_level::rotate_v},
    {"length", &weber_penn_level::length},
    {"length_v", &weber_penn_level::length_v},
    {"taper", &weber_penn_level::taper},
    {"seg_splits", &weber_penn_level::seg_splits},
    {"split_angle", &weber_penn_level::split_angle},
    {"split_angle_v", &weber_penn_level::split_angle_v},
    {"curve", &weber_penn_level::curve},
    {"curve_back", &weber_penn_level::curve_back},
    {"curve_v", &weber_penn_level::curve_v},
}};
constexpr std::array<count_field<weber_penn_level>, 2> level_counts{{
    {"branches", &weber_penn_level::branches},
    {"curve_res", &weber_penn_level::curve_res},
}};

/// Goes through a text token by token. After the first failure every answer is false.
class cursor {
  public:
    cursor(std::string_view text, std::string_view name) : rest_(text), name_(name) {}

    [[nodiscard]] std::size_t line() const { return line_; }
    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] const error& what() const { return error_; }

    bool wrong(std::size_t line, std::string_view complaint) {
        if (!failed_)
            error_ = error_at(name_, line, complaint);
        failed_ = true;
        return false;
    }
    bool wrong(std::string_view complaint) { return wrong(line_, complaint); }

    /// What comes next, for a sentence.
    [[nodiscard]] std::string found() {
        skip_blanks();
        if (rest_.empty())
            return "the file ends";
        constexpr std::size_t excerpt = 20;
        return "there is " + in_quotes(rest_.substr(0, std::min(excerpt, rest_.find('\n'))));
    }

    [[nodiscard]] bool at_end() {
        skip_blanks();
        return rest_.empty();
    }

    /// Takes `c` if it comes next.
    bool take(char c) {
        skip_blanks();
        if (failed_ || rest_.empty() || rest_.front() != c)
            return false;
        rest_.remove_prefix(1);
        return true;
    }

    bool expect(char c, std::string_view purpose) {
        return take(c) || wrong(found() + "; expected \"" + std::string(1, c) + "\" " +
                                std::string(purpose) + ".");
    }

    /// The items of an array or the members of an object: true while there is a next one.
    bool next_item(char close, bool& first) {
        if (failed_)
            return false;
        if (take(close))
            return false;
        if (!first && !take(','))
            return wrong(found() + "; expected \",\" or \"" + std::string(1, close) + "\".");
        first = false;
        return true;
    }

    /// A member's name and its colon.
    bool key(std::string& name) {
        return string(name, "name of a member") &&
               (take(':') || wrong(found() + "; expected \":\" after " + in_quotes(name) + "."));
    }

    bool string(std::string& value, std::string_view purpose) {
        value.clear();
        if (!take('"'))
            return wrong(found() + "; expected a " + std::string(purpose) + " in quotation marks.");
        while (true) {
            if (rest_.empty() || static_cast<unsigned char>(rest_.front()) < 0x20)
                return wrong("the string " + in_quotes(value) + " doesn't end; expected \".");
            const char c = rest_.front();
            rest_.remove_prefix(1);
            if (c == '"')
                return true;
            if (c != '\\') {
                value += c;
                continue;
            }
            constexpr std::string_view simple = "\"\\/";
            if (rest_.empty() || simple.find(rest_.front()) == std::string_view::npos)
                return wrong("the string " + in_quotes(value) +
                             " goes on with an escape that isn't used here; expected \\\", \\\\ "
                             "or \\/.");
            value += rest_.front();
            rest_.remove_prefix(1);
        }
    }

    /// The characters of a number or literal, unchecked; empty at anything else.
    std::string_view word() {
        skip_blanks();
        constexpr std::string_view letters =
            "+-.0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
        const std::size_t end = rest_.find_first_not_of(letters);
        const std::string_view text = rest_.substr(0, end);
        if (failed_)
            return {};
        rest_.remove_prefix(text.size());
        return text;
    }

    /// The word that was found instead of a value, or what there is instead of a word.
    [[nodiscard]] std::string instead(std::string_view word) {
        return word.empty() ? found() : "there is " + in_quotes(word);
    }

    /// A whole number from `low` to `high`.
    bool whole(std::int64_t& value, std::string_view what, std::int64_t low, std::int64_t high) {
        const std::string_view text = word();
        const auto parsed = parse_integer(text);
        if (!parsed || *parsed < low || *parsed > high)
            return wrong(std::string(what) + ": " + instead(text) + "; expected " +
                         (low == high ? std::to_string(low)
                                      : "a whole number from " + std::to_string(low) + " to " +
                                            std::to_string(high)) +
                         ".");
        value = *parsed;
        return true;
    }

  private:
    void skip_blanks() {
        std::size_t i = 0;
        for (; i < rest_.size(); ++i) {
            const char c = rest_[i];
            if (c == '\n')
                ++line_;
            else if (c != ' ' && c != '\t' && c != '\r')
                break;
        }
        rest_.remove_prefix(i);
    }

    std::string_view rest_;
    std::string_view name_;
    std::size_t line_ = 1;
    bool failed_ = false;
    error error_;
};

class skeleton_parser {
  public:
    skeleton_parser(std::string_view text, std::string_view name, std::uint32_t seed,
                    std::size_t most_grown)
        : in_(without_mark(text), name), name_(name), seed_(seed), most_grown_(most_grown) {}

    result<std::vector<trees::segment>> parse() {
        if (in_.at_end())
            return fail(error_code::bad_input,
                        in_quotes(name_) + " is empty; expected a tree as JSON.");
        if (!read_outermost())
            return failure(in_.what());
        if (has_segments_) {
            if (!check_parents())
                return failure(in_.what());
            return std::move(segments_);
        }
        return grow_species();
    }

  private:
    bool read_outermost() {
        if (!in_.expect('{', "at the beginning of a tree"))
            return false;
        bool first = true;
        std::string key;
        while (in_.next_item('}', first))
            if (!in_.key(key) || !once(seen_, key) || !read_member(key))
                return false;
        // next_item is false after a failure as well
        if (in_.failed())
            return false;
        if (!in_.at_end())
            return in_.wrong(in_.found() + " after the tree; expected the end of the file.");
        if (!versioned_)
            return in_.wrong("there is no member \"skybark_tree\"; expected \"skybark_tree\": 1.");
        if (has_segments_ == !species_.empty())
            return in_.wrong(has_segments_
                                 ? "there are both \"segments\" and \"species\"; expected one."
                                 : "there is neither \"segments\" nor \"species\"; expected one.");
        if (has_segments_ && (seen_.count("seed") != 0 || seen_.count("parameters") != 0))
            return in_.wrong("there are \"segments\" with a \"seed\" or \"parameters\"; expected "
                             "those with a \"species\" only.");
        if (has_segments_ && segments_.empty())
            return in_.wrong("there are no segments; expected one at least.");
        return true;
    }

    bool once(std::set<std::string>& seen, const std::string& key) {
        return seen.insert(key).second ||
               in_.wrong("the member " + in_quotes(key) + " is there twice; expected it once.");
    }

    bool read_member(const std::string& key) {
        if (key == "skybark_tree") {
            std::int64_t version = 0;
            versioned_ = true;
            return in_.whole(version, "\"skybark_tree\"", 1, 1);
        }
        if (key == "comment") {
            std::string comment;
            return in_.string(comment, "comment");
        }
        if (key == "segments")
            return read_segments();
        if (key == "species")
            return read_species();
        if (key == "seed") {
            std::int64_t seed = 0;
            if (!in_.whole(seed, "\"seed\"", 0, std::numeric_limits<std::uint32_t>::max()))
                return false;
            seed_ = static_cast<std::uint32_t>(seed);
            return true;
        }
        if (key == "parameters")
            return read_parameters();
        return in_.wrong("there is no member " + in_quotes(key) +
                         " in a tree; expected skybark_tree, segments, species, seed, parameters "
                         "or comment.");
    }

    bool read_segments() {
        has_segments_ = true;
        if (!in_.expect('[', "at the beginning of the segments"))
            return false;
        bool first = true;
        while (in_.next_item(']', first))
            if (!read_segment())
                return false;
        return !in_.failed();
    }

    bool read_segment() {
        if (!in_.expect('{', "at the beginning of a segment"))
            return false;
        if (segments_.size() >= trees::none - 1)
            return in_.wrong("there are too many segments; expected at most 4294967294.");
        lines_.push_back(static_cast<std::uint32_t>(in_.line()));
        enum : unsigned { base = 1, tip = 2, base_radius = 4, radius = 8, parent = 16 };
        unsigned seen = 0;
        trees::segment s;
        const auto is_new = [&](unsigned member, std::string_view name) {
            if ((seen & member) != 0)
                return in_.wrong(who() + " has " + in_quotes(name) + " twice; expected it once.");
            seen |= member;
            return true;
        };
        bool first = true;
        while (in_.next_item('}', first)) {
            if (!in_.key(key_))
                return false;
            bool good = false;
            if (key_ == "base")
                good = is_new(base, key_) && read_point(s.base);
            else if (key_ == "tip")
                good = is_new(tip, key_) && read_point(s.tip);
            else if (key_ == "base_radius")
                good = is_new(base_radius, key_) && read_radius(s.base_radius);
            else if (key_ == "radius")
                good = is_new(radius, key_) && read_radius(s.radius);
            else if (key_ == "parent")
                good = is_new(parent, key_) && read_parent(s.parent);
            else
                in_.wrong("there is no member " + in_quotes(key_) +
                          " in a segment; expected base, tip, base_radius, radius and parent.");
            if (!good)
                return false;
        }
        if (in_.failed())
            return false;
        for (const auto& [member, name] :
             {std::pair{base, "base"}, {tip, "tip"}, {radius, "radius"}, {parent, "parent"}})
            if ((seen & member) == 0)
                return in_.wrong(who() + " has no " + in_quotes(name) +
                                 "; expected base, tip, radius and parent.");
        if ((seen & base_radius) == 0)
            s.base_radius = s.radius;
        segments_.push_back(s);
        return true;
    }

    /// The segment that is being read, for a sentence.
    [[nodiscard]] std::string who() const { return "segment " + std::to_string(segments_.size()); }

    bool read_point(glm::vec3& point) {
        if (!in_.expect('[', "and three coordinates"))
            return false;
        for (glm::length_t i = 0; i < 3; ++i)
            if ((i > 0 && !in_.expect(',', "and another coordinate")) || !read_metres(point[i]))
                return false;
        return in_.expect(']', "after three coordinates");
    }

    bool read_metres(float& value) {
        const std::string_view text = in_.word();
        const auto parsed = parse_number(text);
        if (!parsed || std::abs(*parsed) > most_metres)
            return in_.wrong("in the " + key_ + " of " + who() + " " + in_.instead(text) +
                             "; expected a finite number of at most 1e9 metres.");
        value = static_cast<float>(*parsed);
        return true;
    }

    static std::string number_text(double value) {
        return trees::detail::weber_penn::value_text(value);
    }

    bool read_radius(float& radius) {
        if (!read_metres(radius))
            return false;
        return radius >= 0 || in_.wrong("the " + key_ + " of " + who() + " is " +
                                        number_text(static_cast<double>(radius)) +
                                        "; expected zero or more metres.");
    }

    bool read_parent(std::uint32_t& parent) {
        const std::string_view text = in_.word();
        if (text == "null")
            return true;
        const auto index = parse_integer(text);
        if (!index || *index < 0 || *index >= trees::none)
            return in_.wrong("in the parent of " + who() + " " + in_.instead(text) +
                             "; expected the index of a segment, or null at a root.");
        parent = static_cast<std::uint32_t>(*index);
        return true;
    }

    bool check_parents() {
        for (std::size_t i = 0; i < segments_.size(); ++i) {
            const std::uint32_t parent = segments_[i].parent;
            if (parent != trees::none && parent >= segments_.size())
                return in_.wrong(lines_[i], "segment " + std::to_string(i) + " has the parent " +
                                                std::to_string(parent) + "; expected less than " +
                                                std::to_string(segments_.size()) +
                                                ", the number of segments.");
        }
        const auto cycle = find_cycle(segments_);
        return cycle.empty() ||
               in_.wrong(lines_[cycle.front()],
                         "the segments " + cycle_text(cycle, [](std::uint32_t i) {
                             return std::to_string(i);
                         }) + " are each other's parents; expected parents that lead to a root.");
    }

    bool read_species() {
        if (!in_.string(species_, "species"))
            return false;
        if (trees::find_species(species_) != nullptr)
            return true;
        std::string known;
        for (const auto& entry : trees::all_species())
            known += (known.empty() ? "" : ", ") + std::string(entry.name);
        return in_.wrong("the species is " + in_quotes(species_) + "; expected one of " + known +
                         ".");
    }

    /// A parameter that is set on top of the species', whichever comes first in the file.
    struct setting {
        std::size_t level = no_level;
        std::string name;
        double value = 0;
        std::size_t line = 0;
    };
    static constexpr std::size_t no_level = 4;

    bool read_parameters() {
        if (!in_.expect('{', "at the beginning of the parameters"))
            return false;
        std::set<std::string> seen;
        bool first = true;
        std::string key;
        while (in_.next_item('}', first)) {
            if (!in_.key(key) || !once(seen, key))
                return false;
            if (!(key == "level" ? read_levels() : read_setting(no_level, key)))
                return false;
        }
        return !in_.failed();
    }

    bool read_levels() {
        if (!in_.expect('[', "at the beginning of the levels"))
            return false;
        bool first = true;
        for (std::size_t level = 0; in_.next_item(']', first); ++level) {
            if (level == no_level)
                return in_.wrong("there are more than four levels; expected four at most.");
            if (!in_.expect('{', "at the beginning of a level"))
                return false;
            std::set<std::string> seen;
            std::string key;
            bool first_key = true;
            while (in_.next_item('}', first_key))
                if (!in_.key(key) || !once(seen, key) || !read_setting(level, key))
                    return false;
        }
        return !in_.failed();
    }

    bool read_setting(std::size_t level, const std::string& key) {
        weber_penn_parameters scratch;
        setting s{level, key, 0, in_.line()};
        if (!apply(s, scratch))
            return in_.wrong("there is no parameter " + in_quotes(key) +
                             (level == no_level ? "" : " of a level") +
                             "; expected a name of the Weber-Penn parameters.");
        const std::string_view text = in_.word();
        const auto parsed = parse_number(text);
        if (!parsed)
            return in_.wrong("in the parameter " + in_quotes(key) + " " + in_.instead(text) +
                             "; expected a finite number.");
        s.value = *parsed;
        if (is_count(s) && (std::floor(s.value) != s.value || std::abs(s.value) > 1e9))
            return in_.wrong("the parameter " + in_quotes(key) + " is " +
                             in_quotes(number_text(s.value)) +
                             "; expected a whole number of at most 1e9.");
        settings_.push_back(std::move(s));
        return true;
    }

    static bool is_count(const setting& s) {
        if (s.level == no_level) {
            for (const auto& field : tree_counts)
                if (field.name == s.name)
                    return true;
            return false;
        }
        for (const auto& field : level_counts)
            if (field.name == s.name)
                return true;
        return false;
    }

    template <class Record, class Reals, class Counts>
    static bool apply_to(Record& record, const Reals& reals, const Counts& counts,
                         const setting& s) {
        for (const auto& field : reals)
            if (field.name == s.name) {
                record.*field.member = static_cast<float>(s.value);
                return true;
            }
        for (const auto& field : counts)
            if (field.name == s.name) {
                record.*field.member = static_cast<int>(s.value);
                return true;
            }
        return false;
    }

    static bool apply(const setting& s, weber_penn_parameters& p) {
        return s.level == no_level ? apply_to(p, tree_reals, tree_counts, s)
                                   : apply_to(p.level[s.level], level_reals, level_counts, s);
    }

    result<std::vector<trees::segment>> grow_species() {
        weber_penn_parameters p = trees::find_species(species_)->parameters;
        for (const setting& s : settings_)
            apply(s, p);
        auto grown = trees::grow(p, seed_, most_grown_);
        if (grown)
            return grown;
        for (const setting& s : settings_) // the parameter is named first in the sentence
            if (grown.error().message.find(" " + s.name + " ") != std::string::npos)
                return fail_at(name_, s.line, grown.error().message);
        return fail(grown.error().code, in_quotes(name_) + ": " + grown.error().message);
    }

    cursor in_;
    std::string_view name_;
    std::uint32_t seed_;
    std::size_t most_grown_;
    std::string key_; ///< of a segment's member; kept, so that no segment allocates
    std::set<std::string> seen_;
    bool versioned_ = false;
    bool has_segments_ = false;
    std::vector<trees::segment> segments_;
    std::vector<std::uint32_t> lines_;
    std::string species_;
    std::vector<setting> settings_;
};

} // namespace

result<std::vector<trees::segment>> parse_skeleton_json(std::string_view text,
                                                        std::string_view name, std::uint32_t seed,
                                                        std::size_t most_grown) {
    return within_memory(name,
                         [&] { return skeleton_parser(text, name, seed, most_grown).parse(); });
}

result<std::vector<trees::segment>> read_skeleton_json(const std::string& path,
                                                       std::uint32_t seed) {
    const auto text = load_text(path);
    if (!text)
        return failure(text.error());
    return parse_skeleton_json(*text, path, seed);
}

} // namespace skybark::io
