#include <io/read_qsm.hpp>

#include <io/settle.hpp>
#include <io/text_input.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace skybark::io {

namespace {

constexpr std::array<std::string_view, 9> wanted{"startX", "startY", "startZ", "endX",    "endY",
                                                 "endZ",   "radius", "ID",     "parentID"};
enum column : std::size_t { start_x, end_x = 3, radius_m = 6, id, parent_id, column_count };

/// Where the wanted columns are.
struct layout {
    char separator = ',';
    std::vector<std::uint8_t> wanted_at; ///< for each column which wanted one it is, or none
    std::size_t needed = 0;              ///< columns up to the last wanted one
};
constexpr std::uint8_t unwanted = 0xff;

result<layout> read_header(std::string_view line, std::size_t number, std::string_view name) {
    layout l;
    l.separator = separator_of(line);
    std::array<bool, column_count> found{};
    std::string_view rest = line;
    std::string_view field;
    bool more = true;
    while (next_field(rest, more, l.separator, field)) {
        const auto at = std::find(wanted.begin(), wanted.end(), field);
        l.wanted_at.push_back(unwanted);
        if (at == wanted.end())
            continue;
        const auto w = static_cast<std::size_t>(at - wanted.begin());
        if (found[w])
            return fail_at(name, number,
                           "the column " + in_quotes(field) + " is there twice; expected it once.");
        found[w] = true;
        l.wanted_at.back() = static_cast<std::uint8_t>(w);
    }
    for (std::size_t w = 0; w < column_count; ++w)
        if (!found[w])
            return fail_at(name, number,
                           "there is no column " + in_quotes(wanted[w]) + " in the header " +
                               in_quotes(line) +
                               "; expected startX, startY, startZ, endX, endY, endZ, radius, ID "
                               "and parentID.");
    l.needed = l.wanted_at.size();
    while (l.needed > 0 && l.wanted_at[l.needed - 1] == unwanted)
        --l.needed;
    return l;
}

/// Maps IDs to rows: IDs that lie close together, as most files have them, by a table of their
/// range, others by a sorted list.
class id_table {
  public:
    explicit id_table(const std::vector<std::int64_t>& ids) {
        const auto [least, greatest] = std::minmax_element(ids.begin(), ids.end());
        least_ = *least;
        const std::uint64_t range = above_least(*greatest);
        constexpr std::uint64_t sparse = 4; // a table no larger than the list would be
        if (range / sparse < ids.size()) {
            dense_.assign(static_cast<std::size_t>(range) + 1, trees::none);
            for (std::uint32_t row = 0; row < ids.size(); ++row) {
                std::uint32_t& entry = dense_[static_cast<std::size_t>(above_least(ids[row]))];
                if (entry == trees::none)
                    entry = row;
                else
                    repeated_ = std::min(repeated_, row);
            }
            return;
        }
        sorted_.reserve(ids.size());
        for (std::uint32_t row = 0; row < ids.size(); ++row)
            sorted_.emplace_back(ids[row], row);
        std::sort(sorted_.begin(), sorted_.end());
        for (std::size_t i = 1; i < sorted_.size(); ++i)
            if (sorted_[i - 1].first == sorted_[i].first)
                repeated_ = std::min(repeated_, sorted_[i].second);
    }
    /// The first row whose ID an earlier row has too, or `none`.
    [[nodiscard]] std::uint32_t repeated() const { return repeated_; }
    /// The first row of that ID, or `none`.
    [[nodiscard]] std::uint32_t find(std::int64_t id) const {
        if (!dense_.empty())
            return id >= least_ && above_least(id) < dense_.size()
                       ? dense_[static_cast<std::size_t>(above_least(id))]
                       : trees::none;
        const auto at =
            std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(id, std::uint32_t{0}));
        return at != sorted_.end() && at->first == id ? at->second : trees::none;
    }

  private:
    /// How far `id` is above the least ID; never overflows.
    [[nodiscard]] std::uint64_t above_least(std::int64_t id) const {
        return static_cast<std::uint64_t>(id) - static_cast<std::uint64_t>(least_);
    }

    std::int64_t least_ = 0;
    std::uint32_t repeated_ = trees::none;
    std::vector<std::uint32_t> dense_;
    std::vector<std::pair<std::int64_t, std::uint32_t>> sorted_;
};

class qsm_parser {
  public:
    qsm_parser(std::string_view name, placement where) : name_(name), where_(where) {}

    result<std::vector<trees::segment>> parse(std::string_view text) {
        text = without_mark(text);
        std::size_t number = 0;
        while (!text.empty()) {
            const std::string_view line = next_line(text);
            ++number;
            if (trimmed(line).empty())
                continue;
            if (!have_header_) {
                auto header = read_header(line, number, name_);
                if (!header)
                    return failure(header.error());
                layout_ = *std::move(header);
                have_header_ = true;
            } else if (auto read = read_row(line, number); !read) {
                return failure(read.error());
            }
        }
        if (!have_header_)
            return fail(error_code::bad_input,
                        in_quotes(name_) + " is empty; expected a table of cylinders.");
        if (segments_.empty())
            return fail_at(name_, number, "there are no cylinders after the header.");
        if (auto linked = link_parents(); !linked)
            return failure(linked.error());
        if (where_ == placement::settled)
            settle(segments_);
        return std::move(segments_);
    }

  private:
    result<void> read_row(std::string_view line, std::size_t number) {
        std::array<std::string_view, column_count> fields{};
        std::size_t count = 0;
        std::string_view rest = line;
        bool more = true;
        for (std::string_view field; next_field(rest, more, layout_.separator, field); ++count) {
            if (count >= layout_.wanted_at.size()) {
                if (field.empty()) // a separator at the end of the line
                    continue;
                // a decimal comma would shift all that comes after it
                return fail_at(name_, number,
                               in_quotes(field) + " is one field too many; expected the header's " +
                                   std::to_string(layout_.wanted_at.size()) + ".");
            }
            if (layout_.wanted_at[count] != unwanted)
                fields[layout_.wanted_at[count]] = field;
        }
        if (count < layout_.needed)
            return fail_at(name_, number,
                           in_quotes(line) + " ends after " + std::to_string(count) +
                               " fields; expected " + std::to_string(layout_.needed) +
                               " at least.");

        std::array<double, radius_m + 1> value{};
        for (std::size_t c = 0; c < value.size(); ++c) {
            const auto parsed = parse_number(fields[c]);
            if (!parsed || std::abs(*parsed) > most_metres)
                return fail_at(name_, number,
                               std::string(wanted[c]) + " is " + in_quotes(fields[c]) +
                                   "; expected a finite number of at most 1e9 metres.");
            value[c] = *parsed;
        }
        if (value[radius_m] < 0)
            return fail_at(name_, number,
                           "radius is " + in_quotes(fields[radius_m]) +
                               "; expected zero or more metres.");
        std::array<std::int64_t, 2> ids{};
        for (std::size_t c = id; c <= parent_id; ++c) {
            const auto parsed = parse_integer(fields[c]);
            if (!parsed)
                return fail_at(name_, number,
                               std::string(wanted[c]) + " is " + in_quotes(fields[c]) +
                                   "; expected a whole number.");
            ids[c - id] = *parsed;
        }
        if (segments_.size() >= trees::none - 1)
            return fail_at(name_, number,
                           "there are too many cylinders; expected at most "
                           "4294967294.");

        if (where_ == placement::settled && segments_.empty())
            near_ = {value[start_x], value[start_x + 1], value[start_x + 2]};
        trees::segment s;
        s.base = from_z_up(value[start_x] - near_[0], value[start_x + 1] - near_[1],
                           value[start_x + 2] - near_[2]);
        s.tip = from_z_up(value[end_x] - near_[0], value[end_x + 1] - near_[1],
                          value[end_x + 2] - near_[2]);
        s.base_radius = s.radius = static_cast<float>(value[radius_m]);
        segments_.push_back(s);
        ids_.push_back(ids[0]);
        parent_ids_.push_back(ids[1]);
        lines_.push_back(static_cast<std::uint32_t>(number));
        return {};
    }

    result<void> link_parents() {
        const id_table table(ids_);
        if (const std::uint32_t again = table.repeated(); again != trees::none)
            return fail_at(name_, lines_[again],
                           "the ID " + std::to_string(ids_[again]) + " is that of line " +
                               std::to_string(lines_[table.find(ids_[again])]) +
                               " as well; expected each once.");
        const bool counts_from_one = table.find(0) == trees::none;
        for (std::size_t i = 0; i < segments_.size(); ++i) {
            const std::int64_t parent = parent_ids_[i];
            if (parent == -1 || (parent == 0 && counts_from_one))
                continue;
            segments_[i].parent = table.find(parent);
            if (segments_[i].parent == trees::none)
                return fail_at(name_, lines_[i],
                               "parentID is " + std::to_string(parent) +
                                   ", but no cylinder has that ID; expected the ID of a cylinder, "
                                   "or -1 at a root.");
        }
        const auto cycle = find_cycle(segments_);
        if (!cycle.empty())
            return fail_at(name_, lines_[cycle.front()],
                           "the cylinders " + cycle_text(cycle, [&](std::uint32_t i) {
                               return std::to_string(ids_[i]);
                           }) + " are each other's parents; expected parents that lead to a root.");
        return {};
    }

    std::string_view name_;
    placement where_;
    layout layout_;
    bool have_header_ = false;
    std::array<double, 3> near_{}; ///< taken off in double precision, before floats lose it
    std::vector<trees::segment> segments_;
    std::vector<std::int64_t> ids_;
    std::vector<std::int64_t> parent_ids_;
    std::vector<std::uint32_t> lines_;
};

} // namespace

result<std::vector<trees::segment>> parse_qsm(std::string_view text, std::string_view name,
                                              placement where) {
    return within_memory(name, [&] { return qsm_parser(name, where).parse(text); });
}

result<std::vector<trees::segment>> read_qsm(const std::string& path, placement where) {
    const auto text = load_text(path);
    if (!text)
        return failure(text.error());
    return parse_qsm(*text, path, where);
}

} // namespace skybark::io
