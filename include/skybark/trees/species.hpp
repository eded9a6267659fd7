#pragma once
// Built-in species.
//
// Source: the table of parameters in the appendix of Weber and Penn, "Creation and Rendering of
// Realistic Trees", SIGGRAPH 1995, compared with the tables that Arbaro and OpenAlea publish.
// Where those differ (the willow's twigs), the values are those most of them share.
// Angles in degrees, as there.

#include <skybark/core/when_used.hpp>
#include <skybark/trees/weber_penn.hpp>

#include <array>
#include <span>
#include <string_view>

namespace skybark::trees {

/// Populus tremuloides: slender, conical crown.
template <class = when_used>
[[nodiscard]] weber_penn_parameters quaking_aspen() {
    weber_penn_parameters p;
    p.shape = 7;
    p.base_size = 0.4f;
    p.scale = 13;
    p.scale_v = 3;
    p.levels = 3;
    p.ratio = 0.015f;
    p.ratio_power = 1.2f;
    p.lobes = 5;
    p.lobe_depth = 0.07f;
    p.flare = 0.6f;
    p.leaves = 25;
    p.leaf_scale = 0.17f;
    p.leaf_scale_x = 1;
    p.attraction_up = 0.5f;
    p.trunk_scale = 1;
    p.trunk_scale_v = 0.2f;
    p.level[0] = {.length = 1, .taper = 1, .curve_res = 3, .curve_v = 20};
    p.level[1] = {.down_angle = 60,
                  .down_angle_v = -50,
                  .rotate = 140,
                  .branches = 50,
                  .length = 0.3f,
                  .curve_res = 5,
                  .curve = -40,
                  .curve_v = 50};
    p.level[2] = {.down_angle = 45,
                  .down_angle_v = 10,
                  .rotate = 140,
                  .branches = 30,
                  .length = 0.6f,
                  .curve_res = 3,
                  .curve = -40,
                  .curve_v = 75};
    p.level[3] = {.down_angle = 45, .down_angle_v = 10, .rotate = 77, .branches = 10, .length = 0};
    return p;
}

/// Nyssa sylvatica: tall, with long straight boughs.
template <class = when_used>
[[nodiscard]] weber_penn_parameters black_tupelo() {
    weber_penn_parameters p;
    p.shape = 4;
    p.base_size = 0.2f;
    p.scale = 23;
    p.scale_v = 5;
    p.levels = 4;
    p.ratio = 0.015f;
    p.ratio_power = 1.3f;
    p.lobes = 3;
    p.lobe_depth = 0.1f;
    p.flare = 1;
    p.leaves = 6;
    p.leaf_scale = 0.3f;
    p.leaf_scale_x = 0.5f;
    p.attraction_up = 0.5f;
    p.level[0] = {.length = 1, .taper = 1.1f, .curve_res = 10, .curve_v = 40};
    p.level[1] = {.down_angle = 60,
                  .down_angle_v = -40,
                  .rotate = 140,
                  .branches = 50,
                  .length = 0.3f,
                  .length_v = 0.05f,
                  .curve_res = 10,
                  .curve_v = 90};
    p.level[2] = {.down_angle = 30,
                  .down_angle_v = 10,
                  .rotate = 140,
                  .branches = 25,
                  .length = 0.6f,
                  .length_v = 0.1f,
                  .curve_res = 10,
                  .curve = -10,
                  .curve_v = 150};
    p.level[3] = {.down_angle = 45,
                  .down_angle_v = 10,
                  .rotate = 140,
                  .branches = 12,
                  .length = 0.4f,
                  .curve_res = 1};
    return p;
}

/// Salix babylonica: several trunks, twigs that hang down and are cut to an envelope.
template <class = when_used>
[[nodiscard]] weber_penn_parameters weeping_willow() {
    weber_penn_parameters p;
    p.shape = 3;
    p.base_size = 0.05f;
    p.scale = 15;
    p.scale_v = 5;
    p.levels = 4;
    p.ratio = 0.03f;
    p.ratio_power = 2;
    p.lobes = 9;
    p.lobe_depth = 0.03f;
    p.flare = 0.75f;
    p.leaves = 15;
    p.leaf_scale = 0.12f;
    p.leaf_scale_x = 0.2f;
    p.attraction_up = -3;
    p.prune_ratio = 1;
    p.prune_width = 0.4f;
    p.prune_width_peak = 0.6f;
    p.prune_power_low = 0.001f;
    p.prune_power_high = 0.5f;
    p.base_splits = 2;
    p.level[0] = {.length = 0.8f,
                  .seg_splits = 0.1f,
                  .split_angle = 3,
                  .curve_res = 8,
                  .curve_back = 20,
                  .curve_v = 120};
    p.level[1] = {.down_angle = 20,
                  .down_angle_v = 10,
                  .rotate = -120,
                  .rotate_v = 30,
                  .branches = 25,
                  .length = 0.5f,
                  .length_v = 0.1f,
                  .seg_splits = 0.2f,
                  .split_angle = 30,
                  .split_angle_v = 10,
                  .curve_res = 16,
                  .curve = 40,
                  .curve_back = 80,
                  .curve_v = 90};
    p.level[2] = {.down_angle = 30,
                  .down_angle_v = 10,
                  .rotate = -120,
                  .rotate_v = 30,
                  .branches = 10,
                  .length = 1.5f,
                  .seg_splits = 0.2f,
                  .split_angle = 45,
                  .split_angle_v = 20,
                  .curve_res = 12};
    p.level[3] = {.down_angle = 20,
                  .down_angle_v = 10,
                  .rotate = 140,
                  .branches = 300,
                  .length = 0.1f,
                  .curve_res = 1};
    return p;
}

/// Quercus kelloggii: low, broad, with twisted boughs.
template <class = when_used>
[[nodiscard]] weber_penn_parameters california_black_oak() {
    weber_penn_parameters p;
    p.shape = 2;
    p.base_size = 0.05f;
    p.scale = 10;
    p.scale_v = 10;
    p.levels = 3;
    p.ratio = 0.018f;
    p.ratio_power = 1.3f;
    p.lobes = 5;
    p.lobe_depth = 0.1f;
    p.flare = 1.2f;
    p.leaves = 25;
    p.leaf_scale = 0.12f;
    p.leaf_scale_x = 0.66f;
    p.attraction_up = 0.8f;
    p.base_splits = 2;
    p.level[0] = {.length = 1,
                  .taper = 0.95f,
                  .seg_splits = 0.4f,
                  .split_angle = 10,
                  .curve_res = 8,
                  .curve_v = 90};
    p.level[1] = {.down_angle = 30,
                  .down_angle_v = -30,
                  .rotate = 80,
                  .branches = 40,
                  .length = 0.8f,
                  .length_v = 0.1f,
                  .seg_splits = 0.2f,
                  .split_angle = 10,
                  .split_angle_v = 10,
                  .curve_res = 10,
                  .curve = 40,
                  .curve_back = -70,
                  .curve_v = 150};
    p.level[2] = {.down_angle = 45,
                  .down_angle_v = 10,
                  .rotate = 140,
                  .branches = 120,
                  .length = 0.2f,
                  .length_v = 0.05f,
                  .seg_splits = 0.1f,
                  .split_angle = 10,
                  .split_angle_v = 10,
                  .curve_res = 3,
                  .curve_v = -30};
    p.level[3] = {.down_angle = 45, .down_angle_v = 10, .rotate = 140, .length = 0.4f};
    return p;
}

/// A species that can be asked for by name.
struct species_entry {
    std::string_view name;  ///< as on a command line: "quaking_aspen"
    std::string_view title; ///< for people: "Quaking aspen (Populus tremuloides)"
    weber_penn_parameters parameters;
};

/// Every built-in species, in alphabetical order.
template <class = when_used>
[[nodiscard]] const std::array<species_entry, 4>& all_species() {
    static const std::array<species_entry, 4> species{{
        {"black_tupelo", "Black tupelo (Nyssa sylvatica)", black_tupelo()},
        {"california_black_oak", "California black oak (Quercus kelloggii)",
         california_black_oak()},
        {"quaking_aspen", "Quaking aspen (Populus tremuloides)", quaking_aspen()},
        {"weeping_willow", "Weeping willow (Salix babylonica)", weeping_willow()},
    }};
    return species;
}

/// The species of that name, or null. The pointer stays valid for as long as the program runs.
template <class = when_used>
[[nodiscard]] const species_entry* find_species(std::string_view name) {
    for (const species_entry& entry : all_species())
        if (entry.name == name)
            return &entry;
    return nullptr;
}

} // namespace skybark::trees
