#pragma once
// What grows in the meadow, on the host: trees of four species, grass and flowers, each at its
// place on the land. stand.hpp sends it to a device.

#include <meadow/description.hpp>
#include <meadow/drawable.hpp>
#include <meadow/land.hpp>
#include <skybark/trees/branch_layout.hpp>
#include <skybark/trees/leaf_layout.hpp>

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace skybark::meadow {

/// The camera as `camera` has it, seen from above: x and z.
struct view_axes {
    glm::vec2 eye;
    glm::vec2 ahead; ///< unit
    glm::vec2 right; ///< unit
};
[[nodiscard]] view_axes usual_view();

/// Where a tree stands, and how large it is.
struct tree_place {
    std::uint32_t species = 0; ///< index into `stand_species`
    glm::vec2 at{0};           ///< x and z, m
    float height = 10;         ///< m, about
};

inline constexpr std::array<std::string_view, 4> stand_species{
    "california_black_oak", "quaking_aspen", "weeping_willow", "black_tupelo"};

/// Where `count` trees stand: the first two dozen composed for the camera as `camera` has it, the
/// others wherever there is room on the land, but not in that camera's way.
[[nodiscard]] std::vector<tree_place> place_trees(std::uint32_t count, std::uint64_t seed);

/// All trees of a species, as one skeleton with many roots.
struct grown_trees {
    std::string_view species;
    trees::skeleton wood;
    std::vector<leaf> leaves;
    float leaf_cover = 1; ///< part of a blade's octagon that its picture fills
    material bark;
    material blade;
};

/// Grows them, one entry for each species that there are places of.
/// Errors: bad_input where the species' parameters are.
[[nodiscard]] result<std::vector<grown_trees>> grow_trees(std::span<const tree_place> places,
                                                          const land& ground, std::uint64_t seed);

/// Blades of one kind.
struct grown_blades {
    std::vector<leaf> blades; ///< their carriers are stems
    material blade;
};

/// Grass and flowers: tufts and discs as leaves, on stems of one segment, each its own root.
struct grown_grass {
    trees::skeleton stems;
    std::vector<float> area; ///< m² that each stem shows the wind
    std::vector<grown_blades> kinds;
};

/// Dense around the camera as `camera` has it, thinning out with the distance; `amount` times as
/// much as is usual, none where it is not above 0. Errors: those of build_skeleton.
[[nodiscard]] result<grown_grass> grow_grass(float amount, const land& ground, std::uint64_t seed);

/// `count` of the leaves at most, evenly chosen and enlarged, so that their blades have the area
/// that all of them have times `cover`.
[[nodiscard]] std::vector<leaf> coarse_leaves(std::span<const leaf> leaves, std::size_t count,
                                              float cover);

/// The layout of the `count` thickest segments, without caps.
[[nodiscard]] trees::branch_layout thick_branches(const trees::skeleton& of, std::size_t count);

/// What a material does with light on the whole: a leaf's mean over its picture.
[[nodiscard]] gather_material light_of(const material& of);

} // namespace skybark::meadow
