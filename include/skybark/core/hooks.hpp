#pragma once
// Hooks: what a program that embeds a device is told. Every backend's description takes them.
//
//     skybark::hooks hooks;
//     hooks.user = &my_engine;
//     hooks.log = [](void* user, skybark::log_level level, std::string_view text) { … };
//     hooks.begin_zone = [](void* user, const char* name) { … };
//     hooks.end_zone = [](void* user) { … };
//
// They are called on the thread that calls the device, never on another, and must not throw, nor
// call the device again. A hook that is null costs a branch.

#include <array>
#include <cstdint>
#include <ctime>
#include <string>
#include <string_view>

namespace skybark {

enum class log_level : std::uint8_t {
    debug,   ///< memory that is made or grows, with its bytes; programs, with what they took
    info,    ///< a device is made
    warning, ///< memory that could not be had
    error,   ///< a program that the driver rejects, a device that is lost
};

struct hooks {
    void* user = nullptr; ///< given to each
    /// One sentence without a line's end. The text is gone when the call returns.
    void (*log)(void* user, log_level level, std::string_view text) = nullptr;
    /// Zones nest. The name outlives the program: "map wave_wind", "submit", "wait", "upload", ….
    void (*begin_zone)(void* user, const char* name) = nullptr;
    void (*end_zone)(void* user) = nullptr;

    [[nodiscard]] constexpr bool has_zones() const noexcept {
        return begin_zone != nullptr || end_zone != nullptr;
    }
};

/// A zone from here to the end of the scope. The hooks must outlive it.
class zone {
  public:
    zone(const hooks& to, const char* name) : hooks_(&to) {
        if (to.begin_zone != nullptr) {
            to.begin_zone(to.user, name);
        }
    }
    zone(const zone&) = delete;
    zone& operator=(const zone&) = delete;
    ~zone() {
        if (hooks_->end_zone != nullptr) {
            hooks_->end_zone(hooks_->user);
        }
    }

  private:
    const hooks* hooks_;
};

/// Logs the string that `text()` returns, which is only made where somebody reads it.
template <class Text>
void log(const hooks& to, log_level level, Text&& text) {
    if (to.log != nullptr) {
        const std::string sentence = text();
        to.log(to.user, level, sentence);
    }
}

/// The patterns that run a kernel.
enum class pattern : std::uint8_t {
    map,
    map_voxels,
    expand,
    expand_rings,
    accumulate,
    accumulate_scan,
    draw,
    peel,
};

[[nodiscard]] constexpr std::string_view to_string(pattern p) noexcept {
    switch (p) {
    case pattern::map:
        return "map";
    case pattern::map_voxels:
        return "map_voxels";
    case pattern::expand:
        return "expand";
    case pattern::expand_rings:
        return "expand_rings";
    case pattern::accumulate:
        return "accumulate";
    case pattern::accumulate_scan:
        return "accumulate_scan";
    case pattern::draw:
        return "draw";
    case pattern::peel:
        return "peel";
    }
    return "pattern";
}

namespace detail {

/// The name of a type as the compiler writes it, without namespaces: "wave_wind".
template <class T>
[[nodiscard]] constexpr std::string_view name_of_type() noexcept {
#if defined(__GNUC__)
    std::string_view text = __PRETTY_FUNCTION__; // … [with T = a::b<c>; …] or … [T = a::b<c>]
    text.remove_prefix(text.find("T = ") + 4);
    text = text.substr(0, text.find_first_of(";]"));
    if (const std::size_t colon = text.substr(0, text.find('<')).rfind(':');
        colon != std::string_view::npos) {
        text.remove_prefix(colon + 1);
    }
    return text;
#else
    return "kernel";
#endif
}

/// "map wave_wind" with the zero at its end.
template <pattern P, class K>
[[nodiscard]] constexpr auto make_zone_name() noexcept {
    constexpr std::string_view first = to_string(P);
    constexpr std::string_view second = name_of_type<K>();
    std::array<char, first.size() + second.size() + 2> name{};
    for (std::size_t i = 0; i < first.size(); ++i) {
        name[i] = first[i];
    }
    name[first.size()] = ' ';
    for (std::size_t i = 0; i < second.size(); ++i) {
        name[first.size() + 1 + i] = second[i];
    }
    return name;
}
template <pattern P, class K>
inline constexpr auto zone_name_storage = make_zone_name<P, K>();

[[nodiscard]] inline double milliseconds_now() {
    std::timespec now{};
    (void)std::timespec_get(&now, TIME_UTC);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// "12.3 ms"
[[nodiscard]] inline std::string milliseconds_text(double milliseconds) {
    const auto tenths = static_cast<std::int64_t>(milliseconds * 10 + 0.5);
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " ms";
}

} // namespace detail

/// The zone of a pattern with a kernel: "map wave_wind".
template <pattern P, class K>
[[nodiscard]] constexpr const char* zone_name() noexcept {
    return detail::zone_name_storage<P, K>.data();
}

} // namespace skybark
