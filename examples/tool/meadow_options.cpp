#include "meadow_options.hpp"

#include <CLI/CLI.hpp>
#include <io/text_input.hpp>

#include <cmath>

namespace skybark::tool {

namespace {

constexpr double longest = 3600; // s
constexpr double fewest_frames_a_second = 0.1;
constexpr double most_frames_a_second = 1000;
constexpr double default_length = 2; // s, of frames

/// A picture, numbered pictures or one that moves.
result<void> check_output(const meadow_option_words& words, const std::string& out,
                          meadow_options& options) {
    const std::string extension = extension_of(out);
    if (extension != ".png" && extension != ".apng") {
        return contradiction("-o is " + io::in_quotes(out) +
                             "; expected a name that ends in .png (a picture, or frames as in "
                             "NAME_%04d.png) or .apng (frames).");
    }
    const auto name = frame_name::parse(out);
    if (!name) {
        return failure(name.error());
    }
    if (extension == ".png" && !name->is_numbered()) {
        if (words.fps) {
            return contradiction("--fps is given, but -o is " + io::in_quotes(out) +
                                 ", one picture; expected a place for the frame's number in it, "
                                 "such as %04d, or a name that ends in .apng.");
        }
        return {};
    }
    if (!words.seconds) {
        options.seconds = default_length;
    }
    const double frames = std::max(1.0, std::round(options.seconds * options.fps));
    options.frames = static_cast<std::uint32_t>(frames);
    const auto output =
        find_frame_output(out, options.frames, "Frames are asked for", options.name);
    if (!output) {
        return failure(output.error());
    }
    options.output = *output;
    return {};
}

result<void> check_view(const meadow_option_words& words, meadow_options& options) {
    const auto view = check_camera(words.camera, words.look_at);
    if (!view) {
        return failure(view.error());
    }
    options.from.eye = view->eye.value_or(options.from.eye);
    options.from.target = view->target.value_or(options.from.target);
    return {};
}

} // namespace

void add_meadow_options(CLI::App& to, meadow_option_words& words) {
    to.add_option("--seconds", words.seconds,
                  "Of a picture: when it is taken (0); of frames: how long they take (2)")
        ->type_name("S");
    to.add_option("--fps", words.fps, "Frames a second (24)")->type_name("F");
    add_scene_options(to, words);
}

void add_scene_options(CLI::App& to, meadow_option_words& words) {
    to.add_option("--sun", words.sun,
                  "Where it stands, in degrees clockwise from north and above the horizon (235,34)")
        ->type_name("AZIMUTH,ELEVATION");
    to.add_option("--turbidity", words.turbidity, "Of the air: 2 very clear to 10 haze (2.4)")
        ->type_name("T");
    to.add_option("--wind", words.wind, "Its mean speed in m/s, 10 m above the ground (6)")
        ->type_name("SPEED");
    to.add_option("--wind-from", words.wind_from,
                  "Where it comes from, in degrees clockwise from north (250)")
        ->type_name("DEG");
    to.add_option("--cloud", words.cloud, "Part of the sky that is covered, 0 to 0.8 (0.4)")
        ->type_name("C");
    to.add_option("--trees", words.trees, "How many (24)")->type_name("N");
    to.add_option("--grass", words.grass, "Times as much of it as is usual, 0 to 4 (1)")
        ->type_name("X");
    to.add_option("--bounces", words.bounces, "Of light, between ground, bark and leaves (2)")
        ->type_name("K");
    to.add_option("--directions", words.directions, "Axes that light is gathered along (48)")
        ->type_name("D");
    to.add_option("--cloud-voxels", words.cloud_voxels,
                  "Along each side of the clouds' attenuation volumes (128)")
        ->type_name("N");
    to.add_option("--supersampling", words.supersampling, "Samples a pixel, in each direction (2)")
        ->type_name("N");
    to.add_option("--lod", words.lod,
                  "Level of detail: 1 is what the picture can show, 2 half as fine (1)")
        ->type_name("L");
    add_camera_options(to, words.camera, words.look_at);
}

result<meadow_options> check(const meadow_option_words& words, const std::string& out) {
    auto options = check_scene(words);
    if (!options) {
        return options;
    }
    const result<void> all[] = {
        read("--seconds", words.seconds, 0, longest, "s", options->seconds),
        read("--fps", words.fps, fewest_frames_a_second, most_frames_a_second, "frames a second",
             options->fps),
    };
    for (const result<void>& one : all) {
        if (!one) {
            return failure(one.error());
        }
    }
    if (auto good = check_output(words, out, *options); !good) {
        return failure(good.error());
    }
    return options;
}

result<meadow_options> check_scene(const meadow_option_words& words) {
    meadow_options options;
    meadow::description& what = options.what;
    meadow::weather& now = options.now;
    const result<void> all[] = {
        read_sun(words.sun, 0, now.sun_azimuth, now.sun_elevation),
        read("--turbidity", words.turbidity, 1.7, 10, "", now.turbidity),
        read("--wind", words.wind, 0, 30, "m/s", now.wind),
        read("--wind-from", words.wind_from, -360, 360, "degrees clockwise from north",
             now.wind_from),
        read("--cloud", words.cloud, 0, 0.8, "", now.cloud),
        read("--trees", words.trees, 0, 200, what.trees),
        read("--grass", words.grass, 0, 4, "", what.grass),
        read("--bounces", words.bounces, 0, 16, what.bounces),
        read("--directions", words.directions, 1, 4096, what.directions),
        read("--cloud-voxels", words.cloud_voxels, 16, 512, what.cloud_voxels),
        read("--supersampling", words.supersampling, 1, 8, what.supersampling),
        read("--lod", words.lod, 0.25, 64, "", options.lod),
        check_view(words, options),
    };
    for (const result<void>& one : all) {
        if (!one) {
            return failure(one.error());
        }
    }
    return options;
}

} // namespace skybark::tool
