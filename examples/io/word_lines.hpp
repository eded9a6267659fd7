#pragma once
// word_lines: lines of words, as Wavefront's text files have them.

#include <io/text_input.hpp>

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

namespace skybark::io {

/// Takes the first word off `rest`; empty at its end.
[[nodiscard]] inline std::string_view next_word(std::string_view& rest) {
    rest = trimmed(rest);
    const std::size_t end = rest.find_first_of(" \t");
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(word.size());
    return word;
}

/// Goes through the lines of a text: comments and empty lines are left out, and a line that ends in
/// "\" goes on in the next.
class word_lines {
  public:
    word_lines(std::string_view name, std::string_view text)
        : name_(name), rest_(without_mark(text)) {}

    /// Whether there is another line; `line` is what stands in it.
    [[nodiscard]] bool next(std::string_view& line) {
        while (!rest_.empty()) {
            line = take();
            number_ = read_;
            if (!line.empty() && line.back() == '\\') {
                joined_ = line.substr(0, line.size() - 1);
                while (!rest_.empty() && !line.empty() && line.back() == '\\') {
                    line = take();
                    joined_ += ' ';
                    joined_ += line.substr(0, line.find_last_not_of('\\') + 1);
                }
                line = trimmed(joined_);
            }
            if (!line.empty() && line.front() != '#') {
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] failure fail_here(std::string_view complaint) const {
        return fail_at(name_, number_, complaint);
    }

    /// The next word as a number from `low` to `high`.
    [[nodiscard]] result<double> number(std::string_view keyword, std::string_view& rest,
                                        double low, double high, std::string_view expected) const {
        const std::string_view word = next_word(rest);
        const auto value = parse_number(word);
        if (!value || *value < low || *value > high) {
            return fail_here(std::string(keyword) + " has " +
                             (word.empty() ? std::string("too few numbers") : in_quotes(word)) +
                             "; expected " + std::string(expected) + ".");
        }
        return *value;
    }

    /// The next three of them.
    [[nodiscard]] result<glm::vec3> numbers(std::string_view keyword, std::string_view& rest,
                                            double low, double high,
                                            std::string_view expected) const {
        glm::vec3 all(0);
        for (int i = 0; i < 3; ++i) {
            const auto value = number(keyword, rest, low, high, expected);
            if (!value) {
                return failure(value.error());
            }
            all[i] = static_cast<float>(*value);
        }
        return all;
    }

  private:
    std::string_view take() {
        ++read_;
        return trimmed(next_line(rest_));
    }

    std::string_view name_;
    std::string_view rest_;
    std::size_t number_ = 0; ///< of the line that `next` gave
    std::size_t read_ = 0;
    std::string joined_;
};

} // namespace skybark::io
