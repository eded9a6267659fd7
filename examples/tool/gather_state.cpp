// What a saved gather says of itself in its first line: the options that its light depends on.

#include "gather_job.hpp"

#include <io/text_input.hpp>

#include <cstdio>

namespace skybark::tool {

namespace {

constexpr std::string_view beginning = "skybark gather state 1";

/// In as many digits as tell floats apart.
std::string text_of(double value) {
    char digits[32];
    const int size = std::snprintf(digits, sizeof digits, "%.9g", value);
    return {digits, static_cast<std::size_t>(size)};
}

std::string text_of(glm::vec3 v) {
    std::string text = text_of(static_cast<double>(v.x));
    text.append(",").append(text_of(static_cast<double>(v.y)));
    return text.append(",").append(text_of(static_cast<double>(v.z)));
}

/// The next "; name value" of a line.
std::string_view next_part(std::string_view& line) {
    const std::size_t end = line.find(';');
    const std::string_view part = line.substr(0, end);
    line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
    return io::trimmed(part);
}

} // namespace

std::string state_line(const gather_job& job) {
    const gather_options& o = job.options;
    std::string line(beginning);
    line += "; seed " + std::to_string(job.common.seed);
    line += o.method == gather::gather_method::peel ? "; method peel " + std::to_string(o.peel_size)
                                                    : std::string("; method resolve");
    line += "; bounces " + std::to_string(o.bounces);
    if (o.bounces != 0) {
        line += " of " + std::to_string(o.bounce_directions) + " directions and patches of " +
                text_of(static_cast<double>(job.patch_size)) + " m";
    }
    line += "; sky " + text_of(o.sky);
    line += o.has_sun ? "; sun " + text_of(o.sun_azimuth) + "," + text_of(o.sun_elevation) +
                            " with " + text_of(o.sun_irradiance)
                      : std::string("; sun none");
    return line + "\n";
}

result<std::string_view> state_behind_line(const gather_job& job) {
    const std::string_view whole = job.resumed;
    const std::string_view name = job.options.resume;
    if (whole.substr(0, beginning.size()) != beginning) {
        return fail(error_code::bad_input, io::in_quotes(name) +
                                               " is no state of a gather; expected a file that "
                                               "--save has written.");
    }
    const std::size_t end = whole.find('\n');
    std::string_view theirs = whole.substr(0, end);
    const std::string own = state_line(job);
    std::string_view ours = std::string_view(own).substr(0, own.size() - 1);
    while (!ours.empty() || !theirs.empty()) {
        const std::string_view here = next_part(theirs);
        const std::string_view wanted = next_part(ours);
        if (here != wanted) {
            return fail(error_code::bad_input,
                        io::in_quotes(name) + " can't be gone on with: it was gathered with " +
                            io::in_quotes(here) + "; expected " + io::in_quotes(wanted) + ".");
        }
    }
    return end == std::string_view::npos ? std::string_view() : whole.substr(end + 1);
}

} // namespace skybark::tool
