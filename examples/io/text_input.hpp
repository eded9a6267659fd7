#pragma once
// What the readers of text files share: loading, numbers, sentences about lines, family trees.

#include <skybark/trees/skeleton.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// The whole file. Errors: it doesn't exist, isn't a plain file, can't be read, is over 4 GiB, or
/// doesn't fit in memory.
[[nodiscard]] result<std::string> load_text(const std::string& path);

/// The file's bytes, handed on in blocks of 1 MiB or less: for what needn't fit in memory. Ends
/// with the first error of `take`.
[[nodiscard]] result<void> load_blocks(const std::string& path,
                                       const std::function<result<void>(std::string_view)>& take);

/// The first `bytes` of the file, or all that it has.
[[nodiscard]] result<std::string> load_start(const std::string& path, std::size_t bytes);

/// `text` in quotation marks for a sentence: what isn't printable UTF-8 as \xNN, cut after 60
/// bytes.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// 'Line 3 of "tree.csv": ' followed by `complaint`, as an error.
[[nodiscard]] error error_at(std::string_view name, std::size_t line, std::string_view complaint);
[[nodiscard]] failure fail_at(std::string_view name, std::size_t line, std::string_view complaint);

/// `text` without spaces, tabs and carriage returns at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// All of `text` as a finite number that a float can hold, or nothing. Independent of the locale.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// No tree stands farther than this from its origin, on any grid of the Earth; larger numbers are
/// mistakes, and their squares wouldn't fit a float later.
inline constexpr double most_metres = 1e9;

/// All of `text` as a whole number, or nothing.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);

/// Takes the first line off `rest`, without its end (LF or CRLF).
[[nodiscard]] std::string_view next_line(std::string_view& rest);

/// What separates the fields of a table with this header: a comma, a semicolon or a tab.
[[nodiscard]] char separator_of(std::string_view header);

/// Takes the next field off a line, without its quotation marks and the spaces around it; false at
/// the line's end, which is where `more`, true at first, becomes false.
[[nodiscard]] bool next_field(std::string_view& line, bool& more, char separator,
                              std::string_view& field);

/// Leaves out the byte order mark that some editors put before UTF-8.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// From the z-up axes of scanners and digitisers to +Y up; both right-handed.
[[nodiscard]] inline glm::vec3 from_z_up(double x, double y, double z) {
    return {static_cast<float>(x), static_cast<float>(z), static_cast<float>(-y)};
}

/// The members of one cycle of parents in their order, or nothing if there is none. Parents are
/// indices into `segments` or `none`. Linear time, no recursion.
[[nodiscard]] std::vector<std::uint32_t> find_cycle(const std::vector<trees::segment>& segments);

/// A sentence about a cycle: "4 → 7 → 4", each named by `label`, cut after eight.
[[nodiscard]] std::string cycle_text(const std::vector<std::uint32_t>& cycle,
                                     const std::function<std::string(std::uint32_t)>& label);

/// Runs a reader; what the standard library throws for want of memory becomes an error.
template <class Read>
[[nodiscard]] auto within_memory(std::string_view name, const Read& read) -> decltype(read()) {
    try {
        return read();
    } catch (const std::exception&) { // bad_alloc, length_error: nothing else is thrown here
        return fail(error_code::out_of_memory,
                    "There is not enough memory to read " + in_quotes(name) + ".");
    }
}

} // namespace skybark::io
