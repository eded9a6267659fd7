#include "tree_options.hpp"

#include "options.hpp"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <io/text_input.hpp>

namespace skybark::tool {

namespace {

constexpr double deepest_bark = 1;           // m: no tree's is
constexpr float shortest_bark_edge = 0.001f; // m
constexpr float longest_bark_edge = 100;     // m
constexpr double strongest_wind = 150;       // m/s: more than any that was measured near the ground
constexpr double longest = 86400;            // s: a day
constexpr double fewest_frames_a_second = 0.001;
constexpr double most_frames_a_second = 1000;
constexpr std::uint32_t most_frames = 1000000;
constexpr double coarsest = 16;

[[nodiscard]] result<void> read_file_name(std::string_view option,
                                          const std::optional<std::string>& text, std::string& to) {
    if (text && text->empty()) {
        return contradiction(std::string(option) + " is empty; expected the name of an image.");
    }
    to = text.value_or("");
    return {};
}

result<void> check_bark(const tree_option_words& words, tree_options& options) {
    if (words.bark != "off") {
        if (auto good =
                read("--bark", words.bark, 0, deepest_bark, "m, or off", options.bark_depth);
            !good) {
            return good;
        }
    }
    for (const auto& [is_given, option] : {std::pair{words.bark_map.has_value(), "--bark-map"},
                                           std::pair{words.bark_edge.has_value(), "--bark-edge"}}) {
        if (is_given && options.bark_depth == 0) {
            return contradiction(std::string(option) +
                                 " is given, but the bark has no depth; expected --bark DEPTH "
                                 "with it, such as 0.02.");
        }
    }
    // Three times its depth shows a furrow; finer ones are the normal map's.
    options.bark_edge = std::max(3 * options.bark_depth, shortest_bark_edge);
    if (auto good = read("--bark-edge", words.bark_edge, shortest_bark_edge, longest_bark_edge, "m",
                         options.bark_edge);
        !good) {
        return good;
    }
    return read_file_name("--bark-map", words.bark_map, options.bark_map);
}

result<void> check_leaves(const tree_option_words& words, tree_options& options) {
    if (words.leaves && words.no_leaves) {
        return contradiction("--leaves and --no-leaves contradict each other; expected one.");
    }
    if (words.no_leaves && words.leaf_map) {
        return contradiction("--leaf-map and --no-leaves contradict each other; expected one.");
    }
    if (words.leaves || words.no_leaves || words.leaf_map) {
        options.leaves = !words.no_leaves;
    }
    return read_file_name("--leaf-map", words.leaf_map, options.leaf_map);
}

result<void> check_wind(const tree_option_words& words, tree_options& options) {
    static constexpr named<sway_kind> sways[] = {{"paper", sway_kind::paper},
                                                 {"quasi_static", sway_kind::quasi_static},
                                                 {"dynamic", sway_kind::dynamic}};
    static constexpr named<gust_kind> gusts[] = {{"kaimal", gust_kind::kaimal},
                                                 {"power_law", gust_kind::power_law},
                                                 {"none", gust_kind::none}};
    if (auto good = read("--sway", words.sway, sways, options.sway); !good) {
        return good;
    }
    if (auto good = read("--gusts", words.gusts, gusts, options.gusts); !good) {
        return good;
    }
    if (auto good = read("--wind", words.wind, 0, strongest_wind, "m/s", options.wind); !good) {
        return good;
    }
    return read("--wind-from", words.wind_from, -360, 360, "degrees clockwise from north",
                options.wind_from);
}

result<void> check_output(const tree_option_context& context, tree_options& options) {
    if (extension_of(context.out) == ".glb" && context.list_form) {
        return contradiction("--form list has no frames in a .glb; expected --form rings.");
    }
    const auto output = find_frame_output(
        context.out, options.frames, "--frames is " + std::to_string(options.frames), options.name);
    if (!output) {
        return failure(output.error());
    }
    options.output = *output;
    return {};
}

result<void> check_frames(const tree_option_words& words, const tree_option_context& context,
                          tree_options& options) {
    if (words.fps && !words.frames) {
        return contradiction("--fps is given without --frames; expected both.");
    }
    if (auto good = read("--at", words.at, 0, longest, "s", options.at); !good) {
        return good;
    }
    if (auto good = read("--fps", words.fps, fewest_frames_a_second, most_frames_a_second,
                         "frames a second", options.fps);
        !good) {
        return good;
    }
    if (!words.frames) {
        return check_single_name(context.out, "expected --frames N as well.");
    }
    const auto frames = whole_number("--frames", *words.frames, 1, most_frames);
    if (!frames) {
        return failure(frames.error());
    }
    options.frames = *frames;
    if (options.frames / options.fps > longest) {
        return contradiction("--frames is " + *words.frames + " and --fps is " +
                             words.fps.value_or("24") +
                             "; expected no more than a day of 86400 s.");
    }
    return check_output(context, options);
}

result<void> read_camera(const tree_option_words& words, tree_options& options) {
    const auto view = check_camera(words.camera, words.look_at);
    if (!view) {
        return failure(view.error());
    }
    options.camera = view->eye;
    options.look_at = view->target;
    return {};
}

/// The sticks of --skeleton have none of this.
result<void> check_skeleton(const tree_options& options, const tree_option_words& words) {
    const std::pair<bool, const char*> all[] = {{options.bark_depth > 0, "--bark"},
                                                {options.leaves == true, "--leaves"},
                                                {options.tubes, "--tubes"},
                                                {words.lod.has_value(), "--lod"}};
    for (const auto& [is_given, option] : all) {
        if (is_given) {
            return contradiction(std::string("--skeleton and ") + option +
                                 " contradict each other; expected one.");
        }
    }
    return {};
}

} // namespace

void add_tree_options(CLI::App& to, tree_option_words& words) {
    to.add_option("--bark", words.bark, "Depth of the bark's relief in m, or off (off)")
        ->type_name("DEPTH");
    to.add_option("--bark-edge", words.bark_edge,
                  "Length in m above which its edges are split (three times its depth)")
        ->type_name("M");
    to.add_option("--bark-map", words.bark_map, "Its heights, as an image (a built-in bark)")
        ->type_name("IMAGE");
    to.add_flag("--leaves", words.leaves, "With leaves (as pictures of built-in species are)");
    to.add_flag("--no-leaves", words.no_leaves, "Without leaves");
    to.add_option("--leaf-map", words.leaf_map,
                  "A leaf's colour and outline (alpha), as an image (a built-in leaf)")
        ->type_name("IMAGE");
    to.add_option("--sway", words.sway,
                  "How wood yields to the wind: paper, quasi_static or dynamic (dynamic)")
        ->type_name("MODEL");
    to.add_option("--wind", words.wind, "Its mean speed in m/s (0)")->type_name("SPEED");
    to.add_option("--wind-from", words.wind_from,
                  "Where it comes from, in degrees clockwise from north (270, the west)")
        ->type_name("DEG");
    to.add_option("--gusts", words.gusts, "kaimal, power_law or none (kaimal)")->type_name("MODEL");
    to.add_option("--at", words.at, "Let it sway for so many seconds first (0)")
        ->type_name("SECONDS");
    to.add_option("--frames", words.frames,
                  "So many, as numbered files (-o NAME_%04d.png) or in one .glb or .apng")
        ->type_name("N");
    to.add_option("--fps", words.fps, "Frames a second (24)")->type_name("F");
    to.add_option(
          "--lod", words.lod,
          "Level of detail: 0 is all of it, 1 what the picture can show, 2 half as fine (0)")
        ->type_name("L");
    add_camera_options(to, words.camera, words.look_at);
    to.add_flag("--tubes", words.tubes,
                "Branches as capped tubes that stick in each other (one closed surface a tree)");
}

result<tree_options> check(const tree_option_words& words, const tree_option_context& context) {
    tree_options options;
    options.tubes = words.tubes;
    result<void> good = check_bark(words, options);
    if (good) {
        good = check_leaves(words, options);
    }
    if (good) {
        good = check_wind(words, options);
    }
    if (good) {
        good = read("--lod", words.lod, 0, coarsest, "", options.lod);
    }
    if (good) {
        good = read_camera(words, options);
    }
    if (good) {
        good = check_frames(words, context, options);
    }
    if (good && context.skeleton) {
        good = check_skeleton(options, words);
    }
    if (!good) {
        return failure(good.error());
    }
    return options;
}

} // namespace skybark::tool
