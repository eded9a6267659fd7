#pragma once
// What `skybark gather` is asked for: where light is wanted, what lights, and how exactly.

#include "options.hpp"

#include <skybark/gather/final_gather.hpp>

#include <optional>
#include <string>

namespace skybark::tool {

/// The options as they were typed; nothing where they weren't.
struct gather_option_words {
    std::optional<std::string> points;
    std::optional<std::string> lightmap;
    std::optional<std::string> unwrapped;
    std::optional<std::string> directions;
    std::optional<std::string> error;
    std::optional<std::string> most_directions;
    std::optional<std::string> bounces;
    std::optional<std::string> bounce_directions;
    std::optional<std::string> patch_size;
    std::optional<std::string> sky;
    std::optional<std::string> sun;
    std::optional<std::string> sun_irradiance;
    std::optional<std::string> method;
    std::optional<std::string> peel_size;
    std::optional<std::string> save;
    std::optional<std::string> resume;
    std::optional<std::string> exposure;
    std::optional<std::string> supersampling;
    std::optional<std::string> camera;
    std::optional<std::string> look_at;
    bool two_sided = false;
};

/// What becomes of the light.
enum class gather_output {
    table,    ///< .csv
    mesh,     ///< .ply
    lightmap, ///< .exr
    picture,  ///< .png
};

/// Where light is asked for.
enum class gather_places {
    vertices, ///< of the scene
    points,   ///< from a file
    texels,   ///< of a lightmap
    pixels,   ///< of a picture
};

struct gather_options {
    gather_output output = gather_output::table;
    gather_places places = gather_places::vertices;
    std::string points;
    std::string unwrapped; ///< a mesh with the lightmap's texture coordinates; empty: none
    std::uint32_t lightmap = 1024;
    std::uint64_t directions = 1024; ///< at most, where there is an error
    std::optional<double> error;     ///< W/m²
    std::uint32_t bounces = 0;
    std::uint32_t bounce_directions = 256;
    float patch_size = 0; ///< m; 0: by the scene's area
    glm::vec3 sky{0};     ///< radiance, W/(m² sr)
    bool has_sun = false;
    double sun_azimuth = 0; ///< degrees clockwise from north
    double sun_elevation = 90;
    glm::vec3 sun_irradiance{1}; ///< across its beam, W/m²
    gather::gather_method method = gather::gather_method::resolve;
    std::uint32_t peel_size = 1024;
    std::string save;
    std::string resume;
    std::optional<float> exposure;
    std::uint32_t supersampling = 2;
    camera_view camera;
    bool two_sided = false;
};

/// What the other words of the command say, as far as it matters here.
struct gather_option_context {
    std::string input;
    std::string out; ///< -o
};

/// Adds --points … --look-at to a command.
void add_gather_options(CLI::App& to, gather_option_words& words);

/// Numbers in their ranges, names that are known, and nothing that contradicts something else.
/// Errors: sentences that name the option, what it is and what was expected.
[[nodiscard]] result<gather_options> check(const gather_option_words& words,
                                           const gather_option_context& context);

} // namespace skybark::tool
