#include "gather_options.hpp"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <io/exr.hpp>
#include <io/text_input.hpp>

namespace skybark::tool {

namespace {

constexpr std::uint32_t most_directions = 100'000'000;
constexpr std::uint32_t picture_directions = 512;
constexpr std::uint32_t error_directions = 65536;
constexpr double brightest = 1e9;

constexpr named<gather::gather_method> methods[] = {{"resolve", gather::gather_method::resolve},
                                                    {"peel", gather::gather_method::peel}};

[[nodiscard]] bool is_light(std::span<const double> colour) {
    return std::all_of(colour.begin(), colour.end(),
                       [](double c) { return c >= 0 && c <= brightest; });
}

/// R,G,B, or one number for all three.
[[nodiscard]] result<void> read_light(std::string_view option,
                                      const std::optional<std::string>& text, std::string_view unit,
                                      glm::vec3& to) {
    if (!text) {
        return {};
    }
    const auto colour = numbers_in<3>(*text);
    const auto grey = numbers_in<1>(*text);
    if (!(colour && is_light(*colour)) && !(grey && is_light(*grey))) {
        return contradiction(std::string(option) + " is " + io::in_quotes(*text) +
                             "; expected R,G,B in " + std::string(unit) +
                             ", such as 1,1,1, each from 0 to 1e9.");
    }
    to = colour ? glm::vec3(glm::dvec3((*colour)[0], (*colour)[1], (*colour)[2]))
                : glm::vec3(static_cast<float>((*grey)[0]));
    return {};
}

result<void> check_sun(const gather_option_words& words, gather_options& options) {
    if (words.sun_irradiance && !words.sun) {
        return contradiction("--sun-irradiance is given without --sun; expected both.");
    }
    if (!words.sun) {
        return {};
    }
    if (auto good = read_sun(words.sun, -90, options.sun_azimuth, options.sun_elevation); !good) {
        return good;
    }
    options.has_sun = true;
    return read_light("--sun-irradiance", words.sun_irradiance, "W/m²", options.sun_irradiance);
}

result<void> check_output(const gather_option_context& context, gather_options& options) {
    const std::string in = extension_of(context.input);
    if (in != ".obj" && in != ".glb") {
        return contradiction("SCENE is " + io::in_quotes(context.input) +
                             "; expected triangles: a name that ends in .obj or .glb.");
    }
    const std::string out = extension_of(context.out);
    if (out == ".csv") {
        options.output = gather_output::table;
    } else if (out == ".ply") {
        options.output = gather_output::mesh;
    } else if (out == ".exr") {
        options.output = gather_output::lightmap;
    } else if (out == ".png") {
        options.output = gather_output::picture;
    } else {
        return contradiction("-o is " + io::in_quotes(context.out) +
                             "; expected a name that ends in .csv (a table), .ply (a coloured "
                             "mesh), .exr (a lightmap) or .png (a picture).");
    }
    if (options.output == gather_output::lightmap && !io::has_exr()) {
        return contradiction("-o is " + io::in_quotes(context.out) +
                             ", and this program was built without OpenEXR; expected one that was "
                             "built where libopenexr-dev is installed.");
    }
    return {};
}

result<void> check_places(const gather_option_words& words, gather_options& options) {
    const bool is_picture = options.output == gather_output::picture;
    const bool is_map = options.output == gather_output::lightmap;
    if (words.points && (words.lightmap || is_picture || is_map)) {
        return contradiction(
            words.lightmap
                ? "--points and --lightmap are both given; expected one of them."
                : "--points are given, but a picture or a lightmap has places of its own; expected "
                  "a name for -o that ends in .csv or .ply.");
    }
    if (words.points && words.points->empty()) {
        return contradiction("--points is empty; expected the name of a file of points.");
    }
    if (words.lightmap && is_picture) {
        return contradiction("--lightmap is given, but each pixel of a picture asks for light "
                             "itself; expected a name for -o that ends in .exr, .csv or .ply.");
    }
    options.points = words.points.value_or("");
    options.places = is_picture                 ? gather_places::pixels
                     : words.points             ? gather_places::points
                     : words.lightmap || is_map ? gather_places::texels
                                                : gather_places::vertices;
    if (words.unwrapped) {
        const std::string extension = extension_of(*words.unwrapped);
        if (options.places != gather_places::texels) {
            return contradiction("--unwrapped is given without a lightmap; expected --lightmap or "
                                 "a name for -o that ends in .exr.");
        }
        if (extension != ".ply" && extension != ".obj" && extension != ".glb") {
            return contradiction("--unwrapped is " + io::in_quotes(*words.unwrapped) +
                                 "; expected a name that ends in .ply, .obj or .glb.");
        }
        options.unwrapped = *words.unwrapped;
    }
    for (const auto& [given, option] :
         {std::pair{words.supersampling.has_value(), "--supersampling"},
          std::pair{words.camera.has_value(), "--camera"},
          std::pair{words.look_at.has_value(), "--look-at"}}) {
        if (given && !is_picture) {
            return contradiction(std::string(option) +
                                 " is given without a picture; expected a name for -o that ends "
                                 "in .png.");
        }
    }
    if (words.exposure && !is_picture && options.output != gather_output::mesh) {
        return contradiction("--exposure is given, but -o has light and no colours for a display; "
                             "expected a name that ends in .png or .ply.");
    }
    return {};
}

result<void> check_directions(const gather_option_words& words, gather_options& options) {
    if (words.directions && words.error) {
        return contradiction("--directions and --error are both given; expected one of them, or "
                             "--max-directions with --error.");
    }
    if (words.most_directions && !words.error) {
        return contradiction("--max-directions is given without --error; expected both, or "
                             "--directions.");
    }
    if (words.error) {
        float error = 0;
        if (auto good = read("--error", words.error, 1e-9, brightest, "W/m²", error); !good) {
            return good;
        }
        options.error = static_cast<double>(error);
        options.directions = error_directions;
        return read("--max-directions", words.most_directions, 1, most_directions,
                    options.directions);
    }
    if (options.places == gather_places::pixels) {
        options.directions = picture_directions;
    }
    return read("--directions", words.directions, 1, most_directions, options.directions);
}

result<void> check_method(const gather_option_words& words, gather_options& options) {
    if (words.method) {
        const auto method = one_of("--method", *words.method, methods);
        if (!method) {
            return failure(method.error());
        }
        options.method = *method;
    }
    if (words.peel_size && options.method != gather::gather_method::peel) {
        return contradiction("--peel-size is given without --method peel; expected both.");
    }
    for (const auto& [given, option] :
         {std::pair{words.bounce_directions.has_value(), "--bounce-directions"},
          std::pair{words.patch_size.has_value(), "--patch-size"}}) {
        if (given && options.bounces == 0) {
            return contradiction(std::string(option) +
                                 " is given without --bounces; expected both.");
        }
    }
    return read("--peel-size", words.peel_size, 16, 16384, options.peel_size);
}

} // namespace

void add_gather_options(CLI::App& to, gather_option_words& words) {
    to.add_option("--points", words.points,
                  "Where light is asked for: a table with x,y,z,nx,ny,nz (the scene's vertices)")
        ->type_name("POINTS.csv");
    to.add_option("--lightmap", words.lightmap,
                  "Ask for light at the texels of a lightmap of N by N, each triangle on texels of "
                  "its own (1024 for .exr)")
        ->type_name("N");
    to.add_option("--unwrapped", words.unwrapped,
                  "Write the triangles with their places in the lightmap as texture coordinates "
                  "(.ply, .obj, .glb)")
        ->type_name("MESH");
    to.add_option("--directions", words.directions,
                  "Axes to look along, to both sides (1024; 512 for a picture)")
        ->type_name("D");
    to.add_option("--error", words.error,
                  "Go on until the standard error, rms over the points, is this small, in W/m²")
        ->type_name("E");
    to.add_option("--max-directions", words.most_directions,
                  "Of --error: stop there at the latest (65536)")
        ->type_name("D");
    to.add_option("--bounces", words.bounces,
                  "How often light may be passed on; 0: that of the sky, the sun and emitters "
                  "alone (0)")
        ->type_name("K");
    to.add_option("--bounce-directions", words.bounce_directions,
                  "Axes that each bounce looks along (256)")
        ->type_name("D");
    to.add_option("--patch-size", words.patch_size,
                  "Of bounces: no patch of a surface that keeps its light is longer, in m (30000 "
                  "patches more than triangles)")
        ->type_name("M");
    to.add_option("--sky", words.sky, "Radiance of the sky, all around, in W/(m² sr) (0,0,0)")
        ->type_name("R,G,B");
    to.add_option("--sun", words.sun,
                  "Where the sun stands, in degrees clockwise from north and above the horizon "
                  "(none)")
        ->type_name("AZIMUTH,ELEVATION");
    to.add_option("--sun-irradiance", words.sun_irradiance,
                  "What it gives a surface that faces it, in W/m² (1,1,1)")
        ->type_name("R,G,B");
    to.add_option("--method", words.method,
                  "resolve, exact at each point, or peel, depth layers (resolve)")
        ->type_name("M");
    to.add_option("--peel-size", words.peel_size, "Of --method peel: pixels of a layer (1024)")
        ->type_name("N");
    to.add_option("--save", words.save,
                  "Keep what has been gathered, every minute and at the end, to go on with")
        ->type_name("STATE");
    to.add_option("--resume", words.resume, "Go on from there")->type_name("STATE");
    to.add_option("--exposure", words.exposure,
                  "Of colours for a display: 1 over the radiance that is white (by the light)")
        ->type_name("X");
    to.add_option("--supersampling", words.supersampling,
                  "Of a picture: places a pixel, in each direction (2)")
        ->type_name("N");
    to.add_flag("--two-sided", words.two_sided,
                "All surfaces reflect and emit on their backs as well");
    add_camera_options(to, words.camera, words.look_at);
}

result<gather_options> check(const gather_option_words& words,
                             const gather_option_context& context) {
    gather_options options;
    options.two_sided = words.two_sided;
    float exposure = 0;
    // Each needs what those before it have found.
    auto done = check_output(context, options);
    if (done) {
        done = check_places(words, options);
    }
    if (done) {
        done = check_directions(words, options);
    }
    if (done) {
        done = check_sun(words, options);
    }
    if (done) {
        done = read("--bounces", words.bounces, 0, 1000, options.bounces);
    }
    if (done) {
        done = check_method(words, options);
    }
    if (!done) {
        return failure(done.error());
    }
    const result<void> rest[] = {
        read("--lightmap", words.lightmap, 1, 32768, options.lightmap),
        read("--bounce-directions", words.bounce_directions, 1, most_directions,
             options.bounce_directions),
        read("--patch-size", words.patch_size, 1e-6, 1e9, "m", options.patch_size),
        read_light("--sky", words.sky, "W/(m² sr)", options.sky),
        read("--exposure", words.exposure, 1e-9, 1e9, "", exposure),
        read("--supersampling", words.supersampling, 1, 8, options.supersampling)};
    for (const result<void>& one : rest) {
        if (!one) {
            return failure(one.error());
        }
    }
    if (words.exposure) {
        options.exposure = exposure;
    }
    for (const auto& [name, option] :
         {std::pair{&words.save, "--save"}, std::pair{&words.resume, "--resume"}}) {
        if (*name && (*name)->empty()) {
            return contradiction(std::string(option) + " is empty; expected the name of a file.");
        }
    }
    options.save = words.save.value_or("");
    options.resume = words.resume.value_or("");
    const auto view = check_camera(words.camera, words.look_at);
    if (!view) {
        return failure(view.error());
    }
    options.camera = *view;
    return options;
}

} // namespace skybark::tool
