#include <io/text_input.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>

namespace skybark::io {

namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30u;
constexpr std::size_t block_bytes = std::size_t{1} << 20u;

failure fail_file(const std::string& path, std::string_view complaint) {
    return fail(error_code::bad_input, in_quotes(path) + " " + std::string(complaint));
}

/// How many bytes the printable UTF-8 character at the front of `text` has; 0 if there is none.
std::size_t character_length(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text.front());
    if (lead < 0x80)
        return lead >= 0x20 && lead != 0x7f ? 1 : 0;
    const std::size_t length = lead >= 0xc2 && lead < 0xe0   ? 2
                               : lead >= 0xe0 && lead < 0xf0 ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    if (text.size() < length)
        return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((static_cast<unsigned char>(text[i]) & 0xc0u) != 0x80u)
            return 0;
    return length;
}

struct close_file {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

using input_file = std::unique_ptr<std::FILE, close_file>;

result<input_file> open_input(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        return fail_file(path, "is a directory; expected a file.");
    input_file file(std::fopen(path.c_str(), "rb"));
    if (!file)
        return fail_file(path, "can't be opened: " + std::string(std::strerror(errno)) + ".");
    return file;
}

failure fail_reading(const std::string& path) {
    return fail_file(path, "can't be read: " + std::string(std::strerror(errno)) + ".");
}

result<std::string> load(const std::string& path) {
    const auto file = open_input(path);
    if (!file)
        return failure(file.error());
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(path, ignored);
    const bool known = !ignored;
    if (known && size > most_bytes)
        return fail_file(path, "has " + std::to_string(size) + " bytes; expected at most 4 GiB.");
    std::string text;
    if (known)
        text.reserve(static_cast<std::size_t>(size) + 1);
    while (true) { // by blocks, since a pipe doesn't know its size
        const std::size_t before = text.size();
        const std::size_t room = std::max(block_bytes, text.capacity() - before);
        text.resize(before + room);
        const std::size_t got = std::fread(text.data() + before, 1, room, file->get());
        text.resize(before + got);
        if (text.size() > most_bytes)
            return fail_file(path, "has more than 4 GiB; expected at most that.");
        if (got < room)
            break;
    }
    if (std::ferror(file->get()) != 0)
        return fail_reading(path);
    return text;
}

} // namespace

result<std::string> load_text(const std::string& path) {
    return within_memory(path, [&] { return load(path); });
}

result<void> load_blocks(const std::string& path,
                         const std::function<result<void>(std::string_view)>& take) {
    const auto file = open_input(path);
    if (!file)
        return failure(file.error());
    std::string block(block_bytes, '\0');
    while (true) {
        const std::size_t got = std::fread(block.data(), 1, block.size(), file->get());
        if (auto taken = take(std::string_view(block).substr(0, got)); !taken)
            return taken;
        if (got < block.size())
            break;
    }
    if (std::ferror(file->get()) != 0)
        return fail_reading(path);
    return {};
}

result<std::string> load_start(const std::string& path, std::size_t bytes) {
    const auto file = open_input(path);
    if (!file)
        return failure(file.error());
    std::string start(bytes, '\0');
    start.resize(std::fread(start.data(), 1, bytes, file->get()));
    if (std::ferror(file->get()) != 0)
        return fail_reading(path);
    return start;
}

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string out = "\"";
    std::size_t i = 0;
    while (i < text.size() && i < longest) {
        const std::size_t length = character_length(text.substr(i));
        if (length > 0) {
            out += text.substr(i, length);
        } else {
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\x%02x",
                          static_cast<unsigned>(static_cast<unsigned char>(text[i])));
            out += escaped;
        }
        i += std::max(length, std::size_t{1});
    }
    return out + (i < text.size() ? "…\"" : "\"");
}

error error_at(std::string_view name, std::size_t line, std::string_view complaint) {
    return {error_code::bad_input, "Line " + std::to_string(line) + " of " + in_quotes(name) +
                                       ": " + std::string(complaint)};
}

failure fail_at(std::string_view name, std::size_t line, std::string_view complaint) {
    return failure(error_at(name, line, complaint));
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blank = " \t\r";
    const std::size_t first = text.find_first_not_of(blank);
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end || text.empty())
        return {};
    // NaN fails the comparison as well
    if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())))
        return {};
    return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
    std::int64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stopped != end || text.empty())
        return {};
    return value;
}

std::string_view next_line(std::string_view& rest) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!line.empty() && line.back() == '\r')
        line.remove_suffix(1);
    return line;
}

bool next_field(std::string_view& line, bool& more, char separator, std::string_view& field) {
    if (!more)
        return false;
    std::size_t from = 0;
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string_view::npos && line[first] == '"') {
        const std::size_t close = line.find('"', first + 1);
        if (close != std::string_view::npos)
            from = close; // separators inside the quotes are text
    }
    const std::size_t end = line.find(separator, from);
    field = trimmed(line.substr(0, end));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
        field = trimmed(field.substr(1, field.size() - 2));
    more = end != std::string_view::npos;
    line.remove_prefix(more ? end + 1 : line.size());
    return true;
}

char separator_of(std::string_view header) {
    char best = ',';
    for (const char c : {';', '\t'})
        if (std::count(header.begin(), header.end(), c) >
            std::count(header.begin(), header.end(), best))
            best = c;
    return best;
}

std::string_view without_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.substr(0, mark.size()) == mark)
        text.remove_prefix(mark.size());
    return text;
}

std::vector<std::uint32_t> find_cycle(const std::vector<trees::segment>& segments) {
    // most files list parents first, which leaves no room for a cycle
    bool ordered = true;
    for (std::uint32_t i = 0; i < segments.size() && ordered; ++i)
        ordered = segments[i].parent == trees::none || segments[i].parent < i;
    if (ordered)
        return {};
    // which walk towards the root came by first; a walk that meets itself went round
    std::vector<std::uint32_t> walk_of(segments.size(), trees::none);
    for (std::uint32_t start = 0; start < segments.size(); ++start) {
        std::uint32_t i = start;
        while (i != trees::none && walk_of[i] == trees::none) {
            walk_of[i] = start;
            i = segments[i].parent;
        }
        if (i == trees::none || walk_of[i] != start)
            continue;
        std::vector<std::uint32_t> cycle{i};
        for (std::uint32_t j = segments[i].parent; j != i; j = segments[j].parent)
            cycle.push_back(j);
        return cycle;
    }
    return {};
}

std::string cycle_text(const std::vector<std::uint32_t>& cycle,
                       const std::function<std::string(std::uint32_t)>& label) {
    constexpr std::size_t most_named = 8;
    std::string text;
    for (std::size_t i = 0; i < cycle.size() && i < most_named; ++i)
        text += label(cycle[i]) + " → ";
    return text + (cycle.size() > most_named ? std::string("…") : label(cycle.front()));
}

} // namespace skybark::io
