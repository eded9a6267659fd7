#include "options.hpp"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <glm/geometric.hpp>
#include <io/text_input.hpp>

namespace skybark::tool {

namespace {

constexpr named<backend_kind> backends[] = {{"cpu", backend_kind::cpu},
                                            {"opengl", backend_kind::opengl},
                                            {"vulkan", backend_kind::vulkan}}; // in their order

/// "1280x800". Sides are limited by what a PNG writer and most devices can do.
result<std::pair<std::uint32_t, std::uint32_t>> parse_size(std::string_view text) {
    constexpr std::uint32_t longest = 16384;
    const std::size_t times = text.find_first_of("xX");
    if (times != std::string_view::npos) {
        const auto width = whole_number("--size", text.substr(0, times), 1, longest);
        const auto height = whole_number("--size", text.substr(times + 1), 1, longest);
        if (width && height) {
            return std::pair{*width, *height};
        }
    }
    return fail(error_code::bad_input, "--size is " + io::in_quotes(text) +
                                           "; expected WIDTHxHEIGHT such as 1280x800, each from 1 "
                                           "to 16384 pixels.");
}

/// Three numbers with commas between, if they were typed.
result<void> read_place(std::string_view option, const std::optional<std::string>& text,
                        std::optional<glm::vec3>& to) {
    constexpr double farthest = 1e6; // m
    if (!text) {
        return {};
    }
    glm::vec3 place(0);
    std::string_view rest = *text;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t comma = rest.find(',');
        if ((comma == std::string_view::npos) != (axis == 2)) {
            return fail(error_code::bad_input, std::string(option) + " is " + io::in_quotes(*text) +
                                                   "; expected X,Y,Z in m, such as 3,1.5,4.");
        }
        const auto value = number(option, rest.substr(0, comma), -farthest, farthest, "m");
        if (!value) {
            return failure(value.error());
        }
        place[axis] = static_cast<float>(*value);
        rest.remove_prefix(axis < 2 ? comma + 1 : 0);
    }
    to = place;
    return {};
}

} // namespace

void add_backend_options(CLI::App& to, common_words& words) {
    to.add_option("--backend", words.backend, "What computes: cpu, opengl or vulkan (cpu)")
        ->type_name("B");
    to.add_option("--device", words.device,
                  "Which of the backend's devices, as 'skybark devices' "
                  "numbers them (the backend's choice)")
        ->type_name("N");
}

void add_quiet(CLI::App& to, common_words& words) {
    to.add_flag("--quiet", words.quiet, "Say nothing but what went wrong");
}

void add_common_options(CLI::App& to, common_words& words) {
    add_backend_options(to, words);
    to.add_option("--size", words.size, "Pixels of a picture (1280x800)")->type_name("WxH");
    to.add_option("--seed", words.seed, "Of what is random (1)")->type_name("N");
    to.add_option("--stats", words.stats, "Write counts, seconds by stage and the device as JSON")
        ->type_name("FILE.json");
    add_quiet(to, words);
}

void add_camera_options(CLI::App& to, std::optional<std::string>& camera,
                        std::optional<std::string>& look_at) {
    to.add_option("--camera", camera, "Where the picture is taken from, in m")->type_name("X,Y,Z");
    to.add_option("--look-at", look_at, "What is in its middle, in m")->type_name("X,Y,Z");
}

result<camera_view> check_camera(const std::optional<std::string>& camera,
                                 const std::optional<std::string>& look_at) {
    if (camera.has_value() != look_at.has_value()) {
        return fail(error_code::bad_input, "--camera and --look-at go together; expected both.");
    }
    camera_view view;
    if (auto good = read_place("--camera", camera, view.eye); !good) {
        return failure(good.error());
    }
    if (auto good = read_place("--look-at", look_at, view.target); !good) {
        return failure(good.error());
    }
    if (view.eye && glm::distance(*view.eye, *view.target) < 1e-3f) {
        return fail(error_code::bad_input,
                    "--camera and --look-at are the same place; expected two.");
    }
    return view;
}

const char* name_of(backend_kind kind) {
    return backends[static_cast<std::size_t>(kind)].first.data();
}

result<common_options> check(const common_words& words) {
    common_options options;
    const auto backend = one_of("--backend", words.backend, backends);
    if (!backend) {
        return failure(backend.error());
    }
    options.backend = *backend;
    if (!words.device.empty()) {
        const auto device = whole_number("--device", words.device, 0);
        if (!device) {
            return failure(device.error());
        }
        options.device = *device;
        options.any_device = false;
    }
    const auto size = parse_size(words.size.value_or("1280x800"));
    if (!size) {
        return failure(size.error());
    }
    options.width = size->first;
    options.height = size->second;
    const auto seed = whole_number("--seed", words.seed.value_or("1"), 0);
    if (!seed) {
        return failure(seed.error());
    }
    options.seed = *seed;
    if (words.stats && words.stats->empty()) {
        return contradiction("--stats is empty; expected the name of a file, such as stats.json.");
    }
    options.stats = words.stats.value_or("");
    options.quiet = words.quiet;
    return options;
}

result<std::uint32_t> whole_number(std::string_view option, std::string_view text,
                                   std::uint32_t low, std::uint32_t high) {
    const auto number = io::parse_integer(text);
    if (!number || *number < low || *number > high) {
        return fail(error_code::bad_input, std::string(option) + " is " + io::in_quotes(text) +
                                               "; expected a whole number from " +
                                               std::to_string(low) + " to " + std::to_string(high) +
                                               ".");
    }
    return static_cast<std::uint32_t>(*number);
}

result<double> number(std::string_view option, std::string_view text, double low, double high,
                      std::string_view unit) {
    const auto value = io::parse_number(text);
    if (value && *value >= low && *value <= high) {
        return *value;
    }
    const auto rounded = [](double bound) {
        char digits[32];
        return std::string(
            digits, static_cast<std::size_t>(std::snprintf(digits, sizeof digits, "%.6g", bound)));
    };
    std::string sentence(option);
    sentence.append(" is ").append(io::in_quotes(text)).append("; expected a number from ");
    sentence.append(rounded(low)).append(" to ").append(rounded(high));
    sentence.append(unit.empty() ? "" : " ").append(unit).append(".");
    return fail(error_code::bad_input, std::move(sentence));
}

failure not_among(std::string_view option, std::string_view text,
                  std::span<const std::string_view> names) {
    std::string known;
    for (std::size_t i = 0; i < names.size(); ++i) {
        known += i == 0 ? "" : i + 1 == names.size() ? " or " : ", ";
        known += names[i];
    }
    return fail(error_code::bad_input,
                std::string(option) + " is " + io::in_quotes(text) + "; expected " + known + ".");
}

failure contradiction(std::string sentence) {
    return fail(error_code::bad_input, std::move(sentence));
}

bool read_numbers(std::string_view text, std::span<double> to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        const std::size_t comma = text.find(',');
        if ((comma == std::string_view::npos) != (i + 1 == to.size())) {
            return false;
        }
        const auto value = io::parse_number(text.substr(0, comma));
        if (!value) {
            return false;
        }
        to[i] = *value;
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return true;
}

result<void> read_sun(const std::optional<std::string>& text, double lowest, double& azimuth,
                      double& elevation) {
    if (!text) {
        return {};
    }
    const auto angles = numbers_in<2>(*text);
    if (!angles || !((*angles)[0] >= -360 && (*angles)[0] <= 360) ||
        !((*angles)[1] >= lowest && (*angles)[1] <= 90)) {
        return contradiction("--sun is " + io::in_quotes(*text) +
                             "; expected AZIMUTH,ELEVATION in degrees, such as 120,50: from -360 "
                             "to 360 clockwise from north, and from " +
                             std::to_string(static_cast<int>(lowest)) + " to 90.");
    }
    azimuth = (*angles)[0];
    elevation = (*angles)[1];
    return {};
}

std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

void complain(std::string_view sentence) {
    std::fprintf(stderr, "skybark: %.*s\n", static_cast<int>(sentence.size()), sentence.data());
}

int usage_error(std::string_view command, std::string_view sentence) {
    complain(sentence);
    const std::string name = command.empty() ? "skybark" : "skybark " + std::string(command);
    std::fprintf(stderr, "'%s --help' tells more.\n", name.c_str());
    return exit_usage;
}

int report_failure(const error& e) {
    complain(e.message);
    return e.code == error_code::unavailable ? exit_unavailable : exit_failed;
}

} // namespace skybark::tool
