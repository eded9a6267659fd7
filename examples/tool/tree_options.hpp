#pragma once
// What `skybark tree` is asked for beyond a mesh: bark, leaves, wind and sway, frames, detail.

#include "frame_files.hpp"

#include <skybark/core/result.hpp>

#include <glm/vec3.hpp>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace skybark::tool {

/// The options as they were typed; nothing where they weren't.
struct tree_option_words {
    std::optional<std::string> bark;
    std::optional<std::string> bark_map;
    std::optional<std::string> bark_edge;
    std::optional<std::string> leaf_map;
    std::optional<std::string> sway;
    std::optional<std::string> wind;
    std::optional<std::string> wind_from;
    std::optional<std::string> gusts;
    std::optional<std::string> at;
    std::optional<std::string> frames;
    std::optional<std::string> fps;
    std::optional<std::string> lod;
    std::optional<std::string> camera;
    std::optional<std::string> look_at;
    bool leaves = false;
    bool no_leaves = false;
    bool tubes = false;
};

/// How a tree answers to the wind: as the paper has it, at rest in every wind, or with inertia.
enum class sway_kind { paper, quasi_static, dynamic };
enum class gust_kind { kaimal, power_law, none };

struct tree_options {
    float bark_depth = 0;       ///< m, of the relief; 0: none
    float bark_edge = 0;        ///< m; longer edges are split
    std::string bark_map;       ///< a height map; empty: the built-in bark
    std::string leaf_map;       ///< colour with alpha; empty: the built-in leaf
    std::optional<bool> leaves; ///< nothing: as the tree has it
    sway_kind sway = sway_kind::dynamic;
    float wind = 0;         ///< m/s, its mean
    double wind_from = 270; ///< degrees clockwise from north
    gust_kind gusts = gust_kind::kaimal;
    double at = 0;            ///< s, sway until then
    std::uint32_t frames = 1; ///< frame k is k / fps seconds later
    double fps = 24;
    float lod = 0;      ///< 0: full detail
    bool tubes = false; ///< capped tubes that stick in each other, not one closed surface a tree
    std::optional<glm::vec3> camera;  ///< m; nothing: where all of the tree is seen from
    std::optional<glm::vec3> look_at; ///< m
    frame_output output = frame_output::single;
    frame_name name; ///< of numbered frames

    [[nodiscard]] double seconds_of(std::uint32_t frame) const { return at + frame / fps; }
};

/// What the other options of the command say, as far as it matters here.
struct tree_option_context {
    std::string out;        ///< -o
    bool skeleton = false;  ///< --skeleton
    bool list_form = false; ///< --form list
};

/// Adds --bark … --tubes to a command.
void add_tree_options(CLI::App& to, tree_option_words& words);

/// Numbers in their ranges, names that are known, and nothing that contradicts something else.
/// Errors: sentences that name the option, what it is and what was expected.
[[nodiscard]] result<tree_options> check(const tree_option_words& words,
                                         const tree_option_context& context);

} // namespace skybark::tool
