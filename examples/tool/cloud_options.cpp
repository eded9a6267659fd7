#include "cloud_options.hpp"

#include <CLI/CLI.hpp>
#include <io/text_input.hpp>
#include <skybark/clouds/cumulus.hpp>

namespace skybark::tool {

namespace {

constexpr std::uint32_t smallest_volume = 4;
constexpr std::uint32_t largest_volume = 65536;
constexpr double most_extinction = 1e6;
constexpr std::uint32_t most_octaves = 32;

constexpr named<cloud_method> methods[] = {{"impulse_scan", cloud_method::impulse_scan},
                                           {"shadow_polygons", cloud_method::shadow_polygons},
                                           {"harris", cloud_method::harris}};
constexpr named<cloud_light> lights[] = {{"product", cloud_light::product},
                                         {"continuum", cloud_light::continuum},
                                         {"octaves", cloud_light::octaves},
                                         {"multiple", cloud_light::multiple}};
constexpr named<clouds::attenuation_profile> profiles[] = {
    {"step", clouds::attenuation_profile::step}, {"erf", clouds::attenuation_profile::erf}};
constexpr named<padding> paddings[] = {{"degenerate", padding::degenerate},
                                       {"compact", padding::compact}};
constexpr named<clouds::polygon_source> polygon_sources[] = {
    {"list", clouds::polygon_source::list}, {"stage", clouds::polygon_source::stage}};
constexpr named<accumulate_route> routes[] = {{"direct", accumulate_route::direct},
                                              {"tiles_copied", accumulate_route::tiles_copied},
                                              {"tiles_drawn", accumulate_route::tiles_drawn},
                                              {"layers", accumulate_route::layers}};

constexpr cloud_entry built_in[] = {
    {"cumulus", "one cloud of fair weather", cloud_source::cumulus},
    {"cumulus_field", "two dozen of them over 9 by 9 km", cloud_source::cumuli}};

template <class T, std::size_t N>
std::string_view name_among(const named<T> (&names)[N], T value) {
    for (const auto& [name, one] : names) {
        if (one == value) {
            return name;
        }
    }
    return {};
}

result<cloud_source> source_of(const std::string& input) {
    for (const cloud_entry& entry : built_in) {
        if (entry.name == input) {
            return entry.source;
        }
    }
    const std::string extension = extension_of(input);
    if (extension == ".csv" || extension == ".tsv" || extension == ".txt") {
        return cloud_source::table;
    }
    if (extension == ".vdb") {
        return cloud_source::grid;
    }
    return contradiction("INPUT is " + io::in_quotes(input) +
                         "; expected particles (.csv, .tsv, .txt), a density (.vdb), cumulus or "
                         "cumulus_field.");
}

result<cloud_output> output_of(const std::string& out) {
    const std::string extension = extension_of(out);
    if (extension == ".png") {
        return cloud_output::picture;
    }
    if (extension == ".vdb") {
        return cloud_output::volume;
    }
    if (extension == ".csv") {
        return cloud_output::probes;
    }
    return contradiction("-o is " + io::in_quotes(out) +
                         "; expected a name that ends in .png (a picture), .vdb (a volume) or, "
                         "with --probe, .csv.");
}

result<void> check_probe(const cloud_option_words& words, const cloud_option_context& context,
                         cloud_options& options) {
    if (words.probe && words.probe->empty()) {
        return contradiction("--probe is empty; expected the name of a file of points.");
    }
    options.probe = words.probe.value_or("");
    if (words.probe && options.output != cloud_output::probes) {
        return contradiction("--probe is given, but -o is " + io::in_quotes(context.out) +
                             "; expected a name that ends in .csv.");
    }
    if (!words.probe && options.output == cloud_output::probes) {
        return contradiction("-o is " + io::in_quotes(context.out) +
                             "; expected --probe POINTS.csv with it.");
    }
    return {};
}

/// "hg:0.85": what comes before the colon, and behind it.
std::pair<std::string_view, std::string_view> cut_at_colon(std::string_view text) {
    const std::size_t colon = text.find(':');
    return colon == std::string_view::npos
               ? std::pair{text, std::string_view()}
               : std::pair{text.substr(0, colon), text.substr(colon + 1)};
}

std::optional<clouds::phase_function> phase_of(std::string_view text) {
    constexpr double sharpest = 0.999;
    const auto is_cosine = [](double g) { return g >= -sharpest && g <= sharpest; };
    if (text == "isotropic") {
        return clouds::phase_function::isotropic();
    }
    const auto [name, rest] = cut_at_colon(text);
    if (name == "hg") {
        const auto g = numbers_in<1>(rest);
        if (g && is_cosine((*g)[0])) {
            return clouds::phase_function::henyey_greenstein((*g)[0]);
        }
    }
    if (name == "draine") {
        const auto both = numbers_in<2>(rest);
        if (both && is_cosine((*both)[0]) && (*both)[1] >= 0 && (*both)[1] <= 1e6) {
            return clouds::phase_function::draine((*both)[0], (*both)[1]);
        }
    }
    if (name == "mie") {
        const auto diameter = numbers_in<1>(rest);
        const auto droplets =
            clouds::phase_function::mie(diameter ? (*diameter)[0] : 0); // checks its range
        if (droplets) {
            return *droplets;
        }
    }
    return {};
}

/// The paper's product has no sense for what scatters nearly all straight on: each particle would
/// amplify the light. It was made for scattering such as Rayleigh's.
bool is_product(const cloud_options& options) { return options.light == cloud_light::product; }

result<void> check_phase(const cloud_option_words& words, cloud_options& options) {
    const std::string text = words.phase.value_or(is_product(options) ? "draine:0,1" : "mie:10");
    const auto phase = phase_of(text);
    if (!phase) {
        return contradiction("--phase is " + io::in_quotes(text) +
                             "; expected isotropic, hg:G with G from -0.999 to 0.999, "
                             "draine:G,ALPHA with ALPHA from 0, or mie:D with droplets of 5 to 50 "
                             "µm across.");
    }
    options.phase = *phase;
    return {};
}

/// What goes with one method and not with the others.
result<void> check_method(const cloud_option_words& words, cloud_options& options) {
    if (options.method != cloud_method::shadow_polygons) {
        for (const auto& [given, option] : {std::pair{words.polygons.has_value(), "--polygons"},
                                            std::pair{words.padding.has_value(), "--padding"},
                                            std::pair{words.route.has_value(), "--route"}}) {
            if (given) {
                return contradiction(std::string(option) +
                                     " is given without --method shadow_polygons; expected both.");
            }
        }
    }
    if (options.method != cloud_method::harris) {
        return {};
    }
    if (!words.light) {
        options.light = cloud_light::product;
    }
    if (options.light != cloud_light::product) {
        return contradiction("--method harris has the light of the product alone; expected "
                             "--light product or none.");
    }
    for (const auto& [given, option] :
         {std::pair{words.profile.has_value(), "--profile"}, std::pair{words.half, "--half"}}) {
        if (given) {
            return contradiction(std::string("--method harris fills no volume; expected no ") +
                                 option + ".");
        }
    }
    if (options.output != cloud_output::picture) {
        return contradiction("--method harris lights particles and no places between them; "
                             "expected -o with a picture (.png).");
    }
    return {};
}

result<void> check_source(const cloud_option_words& words, bool seeded,
                          const cloud_options& options) {
    const bool is_grid = options.source == cloud_source::grid;
    const bool is_made =
        options.source == cloud_source::cumulus || options.source == cloud_source::cumuli;
    for (const auto& [given, option] : {std::pair{words.extinction.has_value(), "--extinction"},
                                        std::pair{words.albedo.has_value(), "--albedo"}}) {
        if (given && !is_grid) {
            return contradiction(std::string(option) +
                                 " is given, but INPUT has particles with their own; expected it "
                                 "with a .vdb.");
        }
    }
    for (const auto& [given, option] :
         {std::pair{words.particles.has_value(), "--particles"}, std::pair{seeded, "--seed"}}) {
        if (given && !is_made) {
            return contradiction(std::string(option) +
                                 " is given, but INPUT is a file; expected it with a built-in "
                                 "cloud, such as cumulus.");
        }
    }
    if (options.source == cloud_source::cumuli && options.particles < clouds_of_field) {
        return contradiction("--particles is " + io::in_quotes(*words.particles) +
                             ", and cumulus_field has " + std::to_string(clouds_of_field) +
                             " clouds; expected one particle a cloud at least.");
    }
    if (words.grid && !is_grid) {
        return contradiction("--grid is given, but INPUT is no .vdb; expected both.");
    }
    if (words.grid && words.grid->empty()) {
        return contradiction("--grid is empty; expected the name of a grid of the .vdb.");
    }
    if (is_grid && options.method != cloud_method::impulse_scan) {
        return contradiction("INPUT is a density, which has no particles; expected --method "
                             "impulse_scan.");
    }
    if (is_grid && options.light == cloud_light::product) {
        return contradiction("INPUT is a density, and the product of --light product depends on "
                             "how a cloud is cut into particles; expected --light continuum, its "
                             "limit.");
    }
    for (const auto& [given, option] : {std::pair{words.profile.has_value(), "--profile"},
                                        std::pair{words.sigmas.has_value(), "--sigmas"}}) {
        if (given && is_grid) {
            return contradiction(std::string("INPUT is a density, which has no particles with ") +
                                 option + "; expected none.");
        }
    }
    return {};
}

/// What only a picture has, and what only the light of one output depends on.
result<void> check_output(const cloud_option_words& words, const cloud_option_context& context,
                          const cloud_options& options) {
    if (words.octaves && options.light != cloud_light::octaves) {
        return contradiction("--octaves is given without --light octaves; expected both.");
    }
    if (options.output == cloud_output::picture) {
        return {};
    }
    for (const auto& [given, option] :
         {std::pair{context.size, "--size"}, std::pair{words.camera.has_value(), "--camera"},
          std::pair{words.look_at.has_value(), "--look-at"}}) {
        if (given) {
            return contradiction(std::string(option) + " is given, but -o is " +
                                 io::in_quotes(context.out) +
                                 ", which is no picture; expected it with a .png.");
        }
    }
    if (words.octaves && options.output == cloud_output::volume) {
        return contradiction("--octaves is given, but a .vdb holds optical depths, of which "
                             "octaves are made later; expected none.");
    }
    if (words.phase && options.light == cloud_light::octaves) {
        return contradiction("--phase is given, but --light octaves needs optical depths alone "
                             "where no picture is drawn; expected none.");
    }
    return {};
}

} // namespace

std::span<const cloud_entry> all_clouds() { return built_in; }

std::string_view name_of(cloud_method method) { return name_among(methods, method); }
std::string_view name_of(cloud_light light) { return name_among(lights, light); }
std::string_view name_of(clouds::attenuation_profile profile) {
    return name_among(profiles, profile);
}

void add_cloud_options(CLI::App& to, cloud_option_words& words) {
    to.add_option("--sun", words.sun,
                  "Where it stands, in degrees: clockwise from north, -360 to 360, and above the "
                  "horizon, 0 to 90 for a picture and else -90 to 90 (120,50)")
        ->type_name("AZIMUTH,ELEVATION");
    to.add_option("--volume", words.volume,
                  "Voxels along each side of the attenuation volume, 4 to 65536 (128)")
        ->type_name("N");
    to.add_option("--method", words.method,
                  "How light is found: impulse_scan, shadow_polygons or harris (impulse_scan)")
        ->type_name("M");
    to.add_option("--padding", words.padding,
                  "Of shadow polygons: degenerate, as many for each particle, or compact (compact)")
        ->type_name("P");
    to.add_option("--polygons", words.polygons,
                  "Where shadow polygons come from: a list, or the stage that draws them (list)")
        ->type_name("S");
    to.add_option("--route", words.route,
                  "How they reach the volume: direct, tiles_copied, tiles_drawn or layers, where "
                  "the backend has it (direct)")
        ->type_name("R");
    to.add_option("--profile", words.profile, "Of a particle along the light: step or erf (erf)")
        ->type_name("P");
    to.add_option("--light", words.light,
                  "What comes through: product, continuum, octaves or multiple (continuum)")
        ->type_name("L");
    to.add_option("--octaves", words.octaves, "Of --light octaves, 1 to 32 (8)")->type_name("N");
    to.add_option("--phase", words.phase,
                  "How droplets scatter: isotropic, hg:G, draine:G,ALPHA or mie:D, droplets of D "
                  "µm across (mie:10; for the product draine:0,1, which is Rayleigh's)")
        ->type_name("F");
    to.add_option("--sigmas", words.sigmas,
                  "Standard deviations in a particle's radius, 0.1 to 9 (3); 4 for depths over 30, "
                  "whose cut at 3 is a rim that one sees")
        ->type_name("S");
    to.add_option("--grid", words.grid,
                  "Of a .vdb: which of its grids is the density (density, or the only one)")
        ->type_name("NAME");
    to.add_option("--extinction", words.extinction,
                  "Of a density (.vdb): what of the light 1 takes out, in 1/m (1)")
        ->type_name("E");
    to.add_option("--albedo", words.albedo, "Of a density: what of that is scattered, 0 to 1 (1)")
        ->type_name("A");
    to.add_option("--particles", words.particles,
                  "Of a built-in cloud (12000); cumulus_field has 24 clouds, and as many times "
                  "what each gets")
        ->type_name("N");
    to.add_flag("--half", words.half, "Floats of 16 bits in the volume, and in its .vdb");
    to.add_option("--probe", words.probe,
                  "Places x,y,z, for which a .csv says the optical depth towards the sun and the "
                  "light over that of the sun")
        ->type_name("POINTS.csv");
    add_camera_options(to, words.camera, words.look_at);
}

result<cloud_options> check(const cloud_option_words& words, const cloud_option_context& context) {
    cloud_options options;
    const auto source = source_of(context.input);
    if (!source) {
        return failure(source.error());
    }
    options.source = *source;
    const auto output = output_of(context.out);
    if (!output) {
        return failure(output.error());
    }
    options.output = *output;
    clouds::attenuation_options& volume = options.attenuation;
    volume.light = clouds::attenuation_light::extinction;
    volume.format = words.half ? volume_format::float16 : volume_format::float32;
    const result<void> all[] = {
        check_probe(words, context, options),
        read_sun(words.sun, options.output == cloud_output::picture ? 0 : -90, options.sun_azimuth,
                 options.sun_elevation),
        read("--volume", words.volume, smallest_volume, largest_volume, options.volume),
        read("--method", words.method, methods, options.method),
        read("--padding", words.padding, paddings, volume.policy),
        read("--polygons", words.polygons, polygon_sources, volume.polygons),
        read("--route", words.route, routes, volume.route),
        read("--profile", words.profile, profiles, volume.profile),
        read("--light", words.light, lights, options.light),
        read("--octaves", words.octaves, 1, most_octaves, options.octaves),
        read("--sigmas", words.sigmas, 0.1, 9, "", volume.sigmas),
        read("--extinction", words.extinction, 0, most_extinction, "1/m", options.extinction),
        read("--albedo", words.albedo, 0, 1, "", options.albedo),
        read("--particles", words.particles, 1, clouds::most_cumulus_particles, options.particles),
        check_method(words, options),
        check_phase(words, options),
        check_source(words, context.seed, options),
        check_output(words, context, options),
    };
    for (const result<void>& one : all) {
        if (!one) {
            return failure(one.error());
        }
    }
    options.grid = words.grid.value_or("");
    volume.method = options.method == cloud_method::shadow_polygons
                        ? clouds::attenuation_method::shadow_polygons
                        : clouds::attenuation_method::impulse_scan;
    const auto view = check_camera(words.camera, words.look_at);
    if (!view) {
        return failure(view.error());
    }
    options.camera = *view;
    return options;
}

} // namespace skybark::tool
