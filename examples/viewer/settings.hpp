#pragma once
// What can be turned while a meadow is shown: one table, for the panel's sliders and for scripts.

#include <meadow/description.hpp>
#include <skybark/core/result.hpp>

#include <cstdint>
#include <span>
#include <string_view>

namespace skybark::viewer {

struct settings {
    meadow::weather weather;
    float detail = 1; ///< 1 is what the picture can show, 2 half as fine: as meadow::look takes it
    std::uint32_t bounces = 2;

    [[nodiscard]] bool operator==(const settings&) const = default;
};

enum class knob_kind {
    plain,
    logarithmic, ///< its slider is
    whole,       ///< only whole numbers
};

/// A number of the settings, how it is called, and where it may lie.
struct knob {
    std::string_view name; ///< in scripts
    const char* label;     ///< in the panel
    const char* format;    ///< of its value there, for printf
    double low;
    double high;
    knob_kind kind;
    double (*get)(const settings&);
    void (*set)(settings&, double);
};

/// In the order in which the panel shows them.
[[nodiscard]] std::span<const knob> knobs();

/// The knob of that name, or nothing.
[[nodiscard]] const knob* find_knob(std::string_view name);

} // namespace skybark::viewer
