#pragma once
// The scenes that tests and benchmarks share, by name.

#include <scenes/canopy.hpp>
#include <scenes/cornell.hpp>
#include <scenes/park.hpp>

#include <string_view>

namespace skybark::scenes {

inline constexpr const char* scene_names[] = {"cornell", "park", "canopy"};

/// One of scene_names; any other name: the box.
[[nodiscard]] inline surface_list scene_named(std::string_view name) {
    return name == "park" ? park() : name == "canopy" ? canopy() : cornell();
}

} // namespace skybark::scenes
