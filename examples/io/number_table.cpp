#include <io/number_table.hpp>

#include <io/text_input.hpp>

#include <algorithm>
#include <utility>

namespace skybark::io {

namespace {

constexpr std::size_t no_column = ~std::size_t{0};
constexpr std::size_t longest_line = std::size_t{1} << 20u;

/// In any letter case.
bool is_name(std::string_view name, std::string_view field) {
    const auto lower = [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    return std::equal(name.begin(), name.end(), field.begin(), field.end(),
                      [&](char a, char b) { return lower(a) == lower(b); });
}

} // namespace

number_table::number_table(std::string_view name, std::string_view rows,
                           std::span<const table_column> columns, row_action action)
    : name_(name), rows_(rows), columns_(columns), action_(std::move(action)),
      fields_(columns.size()), values_(columns.size()) {}

result<void> number_table::take(std::string_view bytes) {
    for (std::size_t end = bytes.find('\n'); end != std::string_view::npos;
         end = bytes.find('\n')) {
        std::string_view text = bytes.substr(0, end);
        if (!rest_.empty()) {
            rest_ += text;
            text = rest_;
        }
        if (auto read = line(text); !read)
            return read;
        rest_.clear();
        bytes.remove_prefix(end + 1);
    }
    rest_ += bytes;
    if (rest_.size() > longest_line)
        return fail_at(name_, number_ + 1,
                       in_quotes(rest_) + " goes on for more than 1 MiB; expected a table of " +
                           std::string(rows_) + ".");
    return {};
}

result<void> number_table::finish() {
    if (!rest_.empty()) {
        if (auto read = line(rest_); !read)
            return read;
        rest_.clear();
    }
    if (!have_header_)
        return fail(error_code::bad_input, in_quotes(name_) + " is empty; expected a table of " +
                                               std::string(rows_) + " with the columns " +
                                               all_columns() + ".");
    if (!have_row_)
        return fail_at(name_, number_,
                       "there are no " + std::string(rows_) +
                           " after the header; expected one at least.");
    return {};
}

result<void> number_table::line(std::string_view text) {
    if (++number_ == 1)
        text = without_mark(text);
    const std::string_view shown = trimmed(text);
    if (shown.empty() || shown.front() == '#')
        return {};
    return have_header_ ? row(text) : header(text);
}

std::string number_table::all_columns() const {
    std::string all;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        all += c == 0 ? "" : c + 1 == columns_.size() ? " and " : ", ";
        all += columns_[c].name;
    }
    return all;
}

result<void> number_table::header(std::string_view text) {
    separator_ = separator_of(text);
    std::vector<bool> found(columns_.size());
    std::string_view rest = text;
    std::string_view field;
    bool more = true;
    while (next_field(rest, more, separator_, field)) {
        const auto at = std::find_if(columns_.begin(), columns_.end(),
                                     [&](const table_column& c) { return is_name(c.name, field); });
        const auto c = static_cast<std::size_t>(at - columns_.begin());
        column_at_.push_back(at == columns_.end() ? no_column : c);
        if (at == columns_.end())
            continue;
        if (found[c])
            return fail_at(name_, number_,
                           "the column " + in_quotes(field) + " is there twice; expected it once.");
        found[c] = true;
        needed_ = column_at_.size();
    }
    for (std::size_t c = 0; c < columns_.size(); ++c)
        if (!found[c])
            return fail_at(name_, number_,
                           "there is no column " + in_quotes(columns_[c].name) + " in the header " +
                               in_quotes(text) + "; expected " + all_columns() + ".");
    have_header_ = true;
    return {};
}

result<void> number_table::row(std::string_view text) {
    std::size_t count = 0;
    std::string_view rest = text;
    bool more = true;
    for (std::string_view field; next_field(rest, more, separator_, field); ++count) {
        if (count >= column_at_.size()) {
            if (field.empty()) // a separator at the end of the line
                continue;
            // a decimal comma would shift all that comes after it
            return fail_at(name_, number_,
                           in_quotes(field) + " is one field too many; expected the header's " +
                               std::to_string(column_at_.size()) + ".");
        }
        if (column_at_[count] != no_column)
            fields_[column_at_[count]] = field;
    }
    if (count < needed_)
        return fail_at(name_, number_,
                       in_quotes(text) + " ends after " + std::to_string(count) +
                           (count == 1 ? " field" : " fields") + "; expected " +
                           std::to_string(needed_) + " at least.");
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        const auto value = parse_number(fields_[c]);
        if (!value || *value < columns_[c].low || *value > columns_[c].high)
            return fail_at(name_, number_,
                           std::string(columns_[c].name) + " is " + in_quotes(fields_[c]) +
                               "; expected " + std::string(columns_[c].expected) + ".");
        values_[c] = *value;
    }
    action_(values_);
    have_row_ = true;
    return {};
}

result<void> read_number_table(const std::string& path, std::string_view rows,
                               std::span<const table_column> columns,
                               number_table::row_action action) {
    return within_memory(path, [&]() -> result<void> {
        number_table table(path, rows, columns, std::move(action));
        auto read = load_blocks(path, [&](std::string_view bytes) { return table.take(bytes); });
        return read ? table.finish() : read;
    });
}

result<void> parse_number_table(std::string_view text, std::string_view name, std::string_view rows,
                                std::span<const table_column> columns,
                                number_table::row_action action) {
    return within_memory(name, [&]() -> result<void> {
        number_table table(name, rows, columns, std::move(action));
        auto read = table.take(text);
        return read ? table.finish() : read;
    });
}

} // namespace skybark::io
