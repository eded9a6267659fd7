#include "settings.hpp"

#include <algorithm>

namespace skybark::viewer {

namespace {

/// A knob that turns a member of the weather, or of the settings themselves.
template <auto Member>
constexpr knob weather_knob(std::string_view name, const char* label, const char* format,
                            double low, double high) {
    return {name,
            label,
            format,
            low,
            high,
            knob_kind::plain,
            [](const settings& s) { return static_cast<double>(s.weather.*Member); },
            [](settings& s, double value) {
                using number = std::remove_reference_t<decltype(s.weather.*Member)>;
                s.weather.*Member = static_cast<number>(value);
            }};
}
template <auto Member>
constexpr knob own_knob(std::string_view name, const char* label, const char* format, double low,
                        double high, knob_kind kind) {
    return {name,
            label,
            format,
            low,
            high,
            kind,
            [](const settings& s) { return static_cast<double>(s.*Member); },
            [](settings& s, double value) {
                using number = std::remove_reference_t<decltype(s.*Member)>;
                s.*Member = static_cast<number>(value);
            }};
}

using meadow::weather;

constexpr knob all[] = {
    weather_knob<&weather::sun_azimuth>("sun_azimuth", "sun from", "%.0f deg", 0, 360),
    weather_knob<&weather::sun_elevation>("sun_elevation", "sun above", "%.1f deg", 0, 90),
    weather_knob<&weather::turbidity>("turbidity", "turbidity", "%.1f", 1.7, 10),
    weather_knob<&weather::wind>("wind", "wind", "%.1f m/s", 0, 30),
    weather_knob<&weather::wind_from>("wind_from", "wind from", "%.0f deg", 0, 360),
    weather_knob<&weather::cloud>("cloud", "cloud", "%.2f", 0, 0.8),
    own_knob<&settings::detail>("detail", "detail", "%.2f", 0.25, 64, knob_kind::logarithmic),
    own_knob<&settings::bounces>("bounces", "bounces", "%.0f", 0, 16, knob_kind::whole),
};

} // namespace

std::span<const knob> knobs() { return all; }

const knob* find_knob(std::string_view name) {
    const auto* found =
        std::find_if(std::begin(all), std::end(all), [&](const knob& k) { return k.name == name; });
    return found == std::end(all) ? nullptr : found;
}

} // namespace skybark::viewer
