#pragma once
// What `skybark cloud` is asked for: the sun, how the cloud is lit by it, and what it scatters.

#include "options.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/phase.hpp>

#include <optional>
#include <string>

namespace skybark::tool {

/// The options as they were typed; nothing where they weren't.
struct cloud_option_words {
    std::optional<std::string> sun;
    std::optional<std::string> volume;
    std::optional<std::string> method;
    std::optional<std::string> padding;
    std::optional<std::string> polygons;
    std::optional<std::string> route;
    std::optional<std::string> profile;
    std::optional<std::string> light;
    std::optional<std::string> octaves;
    std::optional<std::string> phase;
    std::optional<std::string> sigmas;
    std::optional<std::string> grid;
    std::optional<std::string> extinction;
    std::optional<std::string> albedo;
    std::optional<std::string> particles;
    std::optional<std::string> probe;
    std::optional<std::string> camera;
    std::optional<std::string> look_at;
    bool half = false;
};

/// What the cloud is made of.
enum class cloud_source {
    table,   ///< particles from a .csv
    grid,    ///< densities from a .vdb
    cumulus, ///< particles of a built-in cloud
    cumuli,  ///< particles of a built-in field of clouds
};

/// What becomes of it.
enum class cloud_output {
    picture,
    volume, ///< a .vdb
    probes, ///< a .csv
};

/// How it is lit.
enum class cloud_method { impulse_scan, shadow_polygons, harris };
enum class cloud_light { product, continuum, octaves, multiple };

/// As the command line calls it.
[[nodiscard]] std::string_view name_of(cloud_method method);
[[nodiscard]] std::string_view name_of(cloud_light light);
[[nodiscard]] std::string_view name_of(clouds::attenuation_profile profile);

/// How many clouds the built-in field has.
inline constexpr std::uint32_t clouds_of_field = 24;

struct cloud_options {
    cloud_source source = cloud_source::table;
    cloud_output output = cloud_output::picture;
    double sun_azimuth = 120; ///< degrees clockwise from north
    double sun_elevation = 50;
    std::uint32_t volume = 128; ///< voxels along each side
    cloud_method method = cloud_method::impulse_scan;
    cloud_light light = cloud_light::continuum;
    std::uint32_t octaves = 8; ///< of that light
    clouds::phase_function phase;
    /// The attenuation volume, with extinction for its light.
    clouds::attenuation_options attenuation;
    std::string grid;                ///< of a .vdb: its name; empty: none was asked for
    float extinction = 1;            ///< of a grid: 1/m that a density of 1 means
    float albedo = 1;                ///< of a grid
    std::uint32_t particles = 12000; ///< of a built-in cloud
    std::string probe;               ///< a file of points; empty: none
    camera_view camera;
};

/// What the other words of the command say, as far as it matters here.
struct cloud_option_context {
    std::string input;
    std::string out;   ///< -o
    bool size = false; ///< --size was typed
    bool seed = false; ///< --seed was typed
};

/// A built-in cloud.
struct cloud_entry {
    std::string_view name;
    std::string_view title;
    cloud_source source;
};
[[nodiscard]] std::span<const cloud_entry> all_clouds();

/// Adds --sun … --look-at to a command.
void add_cloud_options(CLI::App& to, cloud_option_words& words);

/// Numbers in their ranges, names that are known, and nothing that contradicts something else.
/// Errors: sentences that name the option, what it is and what was expected.
[[nodiscard]] result<cloud_options> check(const cloud_option_words& words,
                                          const cloud_option_context& context);

} // namespace skybark::tool
