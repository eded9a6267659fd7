#pragma once
// number_table: the rows of a text table whose columns hold numbers, one after another.
//
// The first line is the header; columns are found by name in any letter case, in any order among
// any others. Fields are separated by commas, semicolons or tabs, whichever the header has most of;
// spaces around them are left out, they may stand in double quotes, lines end in LF or CRLF. A byte
// order mark, empty lines and lines that begin with # are skipped.

#include <skybark/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// A column that must be there, and what may be in it.
struct table_column {
    std::string_view name;
    double low = 0;
    double high = 0;
    std::string_view expected; ///< completes "expected ": "a number from 0 to 1"
};

/// Positions in metres: no cloud, no scene is farther away than that.
inline constexpr double farthest_metres = 1e9;
inline constexpr std::string_view expected_position = "a finite number of at most 1e9 metres";

/// Takes a table as its bytes come. Errors (`bad_input`) name the file, the line, the value and
/// what was expected: no header, no such column, a column twice, no rows, too few or too many
/// fields, not a number, a number out of its range, a line of more than 1 MiB.
class number_table {
  public:
    /// What is done with a row: its numbers, in the order of `columns`.
    using row_action = std::function<void(std::span<const double>)>;

    /// `name` stands for the file in sentences, `rows` for what a row is ("particles"). What they
    /// and `columns` point to must outlive the table.
    number_table(std::string_view name, std::string_view rows,
                 std::span<const table_column> columns, row_action action);

    /// The next bytes of the text, as many as there are.
    [[nodiscard]] result<void> take(std::string_view bytes);
    /// After the last of them.
    [[nodiscard]] result<void> finish();

  private:
    [[nodiscard]] result<void> line(std::string_view text);
    [[nodiscard]] result<void> header(std::string_view text);
    [[nodiscard]] result<void> row(std::string_view text);
    [[nodiscard]] std::string all_columns() const;

    std::string_view name_;
    std::string_view rows_;
    std::span<const table_column> columns_;
    row_action action_;
    std::string rest_; ///< of a line whose end hasn't come yet
    std::size_t number_ = 0;
    bool have_header_ = false;
    bool have_row_ = false;
    char separator_ = ',';
    std::vector<std::size_t> column_at_; ///< for each field, which column it is, or `no_column`
    std::size_t needed_ = 0;             ///< fields up to the last wanted one
    std::vector<std::string_view> fields_;
    std::vector<double> values_;
};

/// All of a file.
[[nodiscard]] result<void> read_number_table(const std::string& path, std::string_view rows,
                                             std::span<const table_column> columns,
                                             number_table::row_action action);

/// All of a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<void> parse_number_table(std::string_view text, std::string_view name,
                                              std::string_view rows,
                                              std::span<const table_column> columns,
                                              number_table::row_action action);

} // namespace skybark::io
