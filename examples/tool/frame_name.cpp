#include "frame_name.hpp"

#include <io/text_input.hpp>

namespace skybark::tool {

namespace {

/// What follows a per cent sign.
struct conversion {
    std::size_t length = 0; ///< 0: none that we know
    std::size_t digits = 1;
    bool is_number = false;
};

conversion conversion_at(std::string_view text) {
    if (text.substr(0, 1) == "%") {
        return {1, 1, false};
    }
    if (text.substr(0, 1) == "d") {
        return {1, 1, true};
    }
    if (text.size() >= 3 && text[0] == '0' && text[1] >= '1' && text[1] <= '9' && text[2] == 'd') {
        return {3, static_cast<std::size_t>(text[1] - '0'), true};
    }
    return {};
}

failure wrong(std::string_view pattern, std::string_view what) {
    std::string sentence = "-o is ";
    sentence.append(io::in_quotes(pattern)).append(", which has ").append(what);
    sentence.append("; expected one place for the frame's number, such as %04d, and %% for a per "
                    "cent sign.");
    return fail(error_code::bad_input, std::move(sentence));
}

} // namespace

result<frame_name> frame_name::parse(std::string_view pattern) {
    frame_name name;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        std::string& to = name.numbered_ ? name.after_ : name.before_;
        if (pattern[i] != '%') {
            to += pattern[i];
            continue;
        }
        const conversion found = conversion_at(pattern.substr(i + 1));
        if (found.length == 0) {
            return wrong(pattern, io::in_quotes(pattern.substr(i, 3)) + " in it");
        }
        if (found.is_number && name.numbered_) {
            return wrong(pattern, "two places for a number");
        }
        if (found.is_number) {
            name.numbered_ = true;
            name.digits_ = found.digits;
        } else {
            to += '%';
        }
        i += found.length;
    }
    return name;
}

std::string frame_name::of(std::uint32_t frame) const {
    if (!numbered_) {
        return before_;
    }
    const std::string number = std::to_string(frame);
    std::string name = before_;
    name.append(digits_ > number.size() ? digits_ - number.size() : 0, '0');
    return name.append(number).append(after_);
}

} // namespace skybark::tool
