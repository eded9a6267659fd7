#pragma once
// What all commands share: options as words from the command line, and what they mean.

#include <skybark/core/result.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace CLI {
class App;
}

namespace skybark::tool {

/// What the process returns.
enum exit_code : int {
    exit_done = 0,
    exit_failed = 1,
    exit_usage = 2,
    exit_unavailable = 3, ///< the backend
};

/// The common options as they were typed; nothing where they weren't. Numbers stay text until
/// `check`, so that what is wrong with one is said in our words.
struct common_words {
    std::string backend = "cpu";
    std::string device;
    std::optional<std::string> size;
    std::optional<std::string> seed;
    std::optional<std::string> stats;
    bool quiet = false;
};

enum class backend_kind { cpu, opengl, vulkan };
[[nodiscard]] const char* name_of(backend_kind kind);

struct common_options {
    backend_kind backend = backend_kind::cpu;
    std::uint32_t device = 0; ///< as `skybark devices` counts them
    bool any_device = true;   ///< none was asked for
    std::uint32_t width = 1280;
    std::uint32_t height = 800;
    std::uint32_t seed = 1;
    std::string stats; ///< empty: none
    bool quiet = false;
};

/// Adds --backend and --device; the others with them, or one by one.
void add_backend_options(CLI::App& to, common_words& words);
void add_quiet(CLI::App& to, common_words& words);
void add_common_options(CLI::App& to, common_words& words);
[[nodiscard]] result<common_options> check(const common_words& words);

/// Where a picture is taken from, and what is in its middle, m. Nothing: where all is seen.
struct camera_view {
    std::optional<glm::vec3> eye;
    std::optional<glm::vec3> target;
};
/// Adds --camera and --look-at.
void add_camera_options(CLI::App& to, std::optional<std::string>& camera,
                        std::optional<std::string>& look_at);
[[nodiscard]] result<camera_view> check_camera(const std::optional<std::string>& camera,
                                               const std::optional<std::string>& look_at);

/// A whole number in [low, high], or a sentence that names `option` and what it got.
[[nodiscard]] result<std::uint32_t>
whole_number(std::string_view option, std::string_view text, std::uint32_t low,
             std::uint32_t high = std::numeric_limits<std::uint32_t>::max());

/// A finite number in [low, high], or such a sentence. `unit` stands behind the range; it may be
/// empty.
[[nodiscard]] result<double> number(std::string_view option, std::string_view text, double low,
                                    double high, std::string_view unit);

/// What one of the `names` stands for.
template <class T>
using named = std::pair<std::string_view, T>;
[[nodiscard]] failure not_among(std::string_view option, std::string_view text,
                                std::span<const std::string_view> names);
template <class T, std::size_t N>
[[nodiscard]] result<T> one_of(std::string_view option, std::string_view text,
                               const named<T> (&names)[N]) {
    std::string_view known[N];
    for (std::size_t i = 0; i < N; ++i) {
        if (names[i].first == text) {
            return names[i].second;
        }
        known[i] = names[i].first;
    }
    return not_among(option, text, known);
}

/// An error of the command line.
[[nodiscard]] failure contradiction(std::string sentence);

/// `read` takes what was typed behind an option, if it was: else `to` stays as it is. Errors are
/// those of whole_number, number and one_of.
template <std::unsigned_integral T>
[[nodiscard]] result<void> read(std::string_view option, const std::optional<std::string>& text,
                                std::uint32_t low, std::uint32_t high, T& to) {
    if (!text) {
        return {};
    }
    const auto value = whole_number(option, *text, low, high);
    if (!value) {
        return failure(value.error());
    }
    to = *value;
    return {};
}
template <std::floating_point T>
[[nodiscard]] result<void> read(std::string_view option, const std::optional<std::string>& text,
                                double low, double high, std::string_view unit, T& to) {
    if (!text) {
        return {};
    }
    const auto value = number(option, *text, low, high, unit);
    if (!value) {
        return failure(value.error());
    }
    to = static_cast<T>(*value);
    return {};
}
template <class T, std::size_t N>
[[nodiscard]] result<void> read(std::string_view option, const std::optional<std::string>& text,
                                const named<T> (&names)[N], T& to) {
    if (!text) {
        return {};
    }
    const auto value = one_of(option, *text, names);
    if (!value) {
        return failure(value.error());
    }
    to = *value;
    return {};
}

/// Numbers with commas between: whether there are as many as `to` takes, and each is one.
[[nodiscard]] bool read_numbers(std::string_view text, std::span<double> to);
template <std::size_t N>
[[nodiscard]] std::optional<std::array<double, N>> numbers_in(std::string_view text) {
    std::array<double, N> numbers{};
    return read_numbers(text, numbers) ? std::optional(numbers) : std::nullopt;
}

/// --sun AZIMUTH,ELEVATION, in degrees: the azimuth from -360 to 360, the elevation from `lowest`
/// to 90.
[[nodiscard]] result<void> read_sun(const std::optional<std::string>& text, double lowest,
                                    double& azimuth, double& elevation);

/// The extension in lower case, with its dot.
[[nodiscard]] std::string extension_of(const std::string& path);

/// Says it on stderr.
void complain(std::string_view sentence);
/// Says what is wrong with a command line, and returns `exit_usage`.
[[nodiscard]] int usage_error(std::string_view command, std::string_view sentence);
/// Says what went wrong, and returns what that is for the shell.
[[nodiscard]] int report_failure(const error& e);

} // namespace skybark::tool
