#pragma once
// What `skybark meadow` is asked for.

#include "frame_files.hpp"
#include "options.hpp"

#include <meadow/description.hpp>

namespace skybark::tool {

/// The options as they were typed; nothing where they weren't.
struct meadow_option_words {
    std::optional<std::string> seconds;
    std::optional<std::string> fps;
    std::optional<std::string> sun;
    std::optional<std::string> turbidity;
    std::optional<std::string> wind;
    std::optional<std::string> wind_from;
    std::optional<std::string> cloud;
    std::optional<std::string> trees;
    std::optional<std::string> grass;
    std::optional<std::string> bounces;
    std::optional<std::string> directions;
    std::optional<std::string> cloud_voxels;
    std::optional<std::string> supersampling;
    std::optional<std::string> lod;
    std::optional<std::string> camera;
    std::optional<std::string> look_at;
};

struct meadow_options {
    meadow::description what; ///< size and seed are those of the common options
    meadow::weather now;
    meadow::camera from;
    float lod = 1;            ///< times as coarse as the picture can show
    double seconds = 0;       ///< of a picture: when it is taken; of frames: how long
    double fps = 24;          ///< frame k is at k / fps seconds
    std::uint32_t frames = 1; ///< 1 for a picture
    frame_output output = frame_output::single;
    frame_name name; ///< of numbered frames

    [[nodiscard]] double seconds_of(std::uint32_t frame) const {
        return output == frame_output::single ? seconds : frame / fps;
    }
};

/// Those of the scene alone; or with them, when pictures of it are taken.
void add_scene_options(CLI::App& to, meadow_option_words& words);
void add_meadow_options(CLI::App& to, meadow_option_words& words);

/// Numbers in their ranges, and nothing that contradicts something else. `out` is -o.
/// Errors: sentences that name the option, what it is and what was expected.
[[nodiscard]] result<meadow_options> check(const meadow_option_words& words,
                                           const std::string& out);
/// The same, of the scene's alone.
[[nodiscard]] result<meadow_options> check_scene(const meadow_option_words& words);

} // namespace skybark::tool
