// The options of `skybark tree` beyond a mesh: words into numbers, and sentences about the rest.

#include <tool/tree_options.hpp>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

using namespace skybark::tool;

namespace {

using words = std::vector<std::string>;

/// Reads a command line by the same parser as the tool.
tree_option_words parsed(words arguments) {
    CLI::App app;
    tree_option_words typed;
    add_tree_options(app, typed);
    std::reverse(arguments.begin(), arguments.end()); // as CLI11 wants a vector
    EXPECT_NO_THROW(app.parse(arguments));
    return typed;
}

skybark::result<tree_options> checked(words arguments, tree_option_context context = {"a.png"}) {
    return check(parsed(std::move(arguments)), context);
}

tree_options accepted(words arguments, tree_option_context context = {"a.png"}) {
    const auto options = checked(std::move(arguments), std::move(context));
    EXPECT_TRUE(options) << options.error().message;
    return options.value_or(tree_options{});
}

void expect_refused(words arguments, std::initializer_list<const char*> parts,
                    tree_option_context context = {"a.png"}) {
    const std::string first = arguments.empty() ? "" : arguments[0];
    const auto options = checked(std::move(arguments), std::move(context));
    ASSERT_FALSE(options) << first;
    const std::string& message = options.error().message;
    for (const char* part : parts) {
        EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
    }
    EXPECT_NE(message.find("expected"), std::string::npos) << message;
    EXPECT_EQ(message.back(), '.');
    EXPECT_EQ(message.find(".."), std::string::npos) << message;
}

void expect_value_refused(const std::string& option, const std::string& value) {
    const std::string quoted = value.empty() ? "" : "\"" + value + "\"";
    // With = a value may begin with a minus, and without it may be empty.
    words arguments = value.empty() ? words{option, ""} : words{option + "=" + value};
    // Options that need another.
    if (option == "--fps") {
        arguments.insert(arguments.begin(), {"--frames", "2"});
    }
    expect_refused(arguments, {option.c_str(), quoted.c_str()}, {"a_%d.png"});
}

} // namespace

TEST(tree_options, are_what_the_manual_says) {
    const tree_options options = accepted({});
    EXPECT_EQ(options.bark_depth, 0);
    EXPECT_FALSE(options.leaves);
    EXPECT_EQ(options.sway, sway_kind::dynamic);
    EXPECT_EQ(options.wind, 0);
    EXPECT_EQ(options.wind_from, 270) << "from the west";
    EXPECT_EQ(options.gusts, gust_kind::kaimal);
    EXPECT_EQ(options.at, 0);
    EXPECT_EQ(options.frames, 1u);
    EXPECT_EQ(options.fps, 24);
    EXPECT_EQ(options.lod, 0);
    EXPECT_FALSE(options.tubes);
    EXPECT_EQ(options.output, frame_output::single);
}

TEST(tree_options, are_what_was_typed) {
    const tree_options options =
        accepted({"--bark", "0.025", "--bark-map", "b.png", "--leaf-map", "l.png", "--sway",
                  "quasi_static", "--wind", "12.5", "--wind-from", "0", "--gusts", "power_law",
                  "--at", "2.5", "--lod", "1.5", "--tubes"});
    EXPECT_FLOAT_EQ(options.bark_depth, 0.025f);
    EXPECT_EQ(options.bark_map, "b.png");
    EXPECT_EQ(options.leaf_map, "l.png");
    EXPECT_EQ(options.leaves, true) << "a leaf map is for leaves";
    EXPECT_EQ(options.sway, sway_kind::quasi_static);
    EXPECT_EQ(options.wind, 12.5f);
    EXPECT_EQ(options.gusts, gust_kind::power_law);
    EXPECT_EQ(options.seconds_of(0), 2.5);
    EXPECT_EQ(options.lod, 1.5f);
    EXPECT_TRUE(options.tubes);
    EXPECT_EQ(accepted({"--bark", "off"}).bark_depth, 0);
    EXPECT_EQ(accepted({"--leaves"}).leaves, true);
    EXPECT_EQ(accepted({"--no-leaves"}).leaves, false);
    EXPECT_EQ(accepted({"--sway", "paper"}).sway, sway_kind::paper);
    EXPECT_EQ(accepted({"--gusts", "none"}).gusts, gust_kind::none);
}

TEST(tree_options, refuse_numbers_that_are_none) {
    const words none{"",  "nan", "-nan", "inf", "-inf", "1e400", "1e39",
                     "x", "1x",  " 1",   "0x1", "1,5",  "--"};
    const std::pair<const char*, words> all[] = {
        {"--bark", {"-0.001", "1.01", "on", "OFF"}},
        {"--wind", {"-1", "151"}},
        {"--wind-from", {"361", "-361", "west"}},
        {"--at", {"-1", "86401"}},
        {"--fps", {"0", "-24", "1001", "1e-9"}},
        {"--lod", {"-0.5", "17"}},
        {"--frames", {"0", "-1", "1.5", "1000001", "99999999999999999999"}},
    };
    for (const auto& [option, own] : all) {
        for (const words& values : {none, own}) {
            for (const std::string& value : values) {
                expect_value_refused(option, value);
            }
        }
    }
}

TEST(tree_options, refuse_names_that_they_do_not_know) {
    for (const char* value : {"", "Dynamic", "static", "quasi"}) {
        expect_value_refused("--sway", value);
    }
    for (const char* value : {"", "gauss", "1/f"}) {
        expect_value_refused("--gusts", value);
    }
    expect_refused({"--bark", "0.1", "--bark-map", ""}, {"--bark-map"});
    expect_refused({"--leaf-map", ""}, {"--leaf-map"});
}

TEST(tree_options, refuse_what_contradicts_itself) {
    expect_refused({"--leaves", "--no-leaves"}, {"--leaves", "--no-leaves"});
    expect_refused({"--no-leaves", "--leaf-map", "l.png"}, {"--leaf-map", "--no-leaves"});
    expect_refused({"--bark-map", "b.png"}, {"--bark-map", "--bark DEPTH"});
    expect_refused({"--bark", "off", "--bark-map", "b.png"}, {"--bark-map"});
    expect_refused({"--fps", "30"}, {"--fps", "--frames"});
    expect_refused({"--frames", "1000000", "--fps", "0.01"}, {"86400"}, {"a_%d.png"});
    const tree_option_context sticks{"a.png", true};
    expect_refused({"--bark", "0.1"}, {"--skeleton", "--bark"}, sticks);
    expect_refused({"--leaves"}, {"--skeleton", "--leaves"}, sticks);
    expect_refused({"--tubes"}, {"--skeleton", "--tubes"}, sticks);
    expect_refused({"--lod", "1"}, {"--skeleton", "--lod"}, sticks);
    EXPECT_EQ(accepted({"--no-leaves", "--bark", "0", "--wind", "3"}, sticks).wind, 3);
}

TEST(tree_options, know_where_frames_go) {
    for (const char* out : {"a_%04d.png", "a_%04d.obj", "a_%04d.ply"}) {
        const tree_options options = accepted({"--frames", "3", "--fps", "10"}, {out});
        EXPECT_EQ(options.output, frame_output::numbered);
        EXPECT_EQ(options.name.of(2), std::string(out).replace(2, 4, "0002"));
        EXPECT_EQ(options.seconds_of(2), 0.2);
    }
    for (const char* out : {"a.glb", "a.APNG", "100%.glb"}) {
        EXPECT_EQ(accepted({"--frames", "3"}, {out}).output, frame_output::together);
    }
    EXPECT_EQ(accepted({"--frames", "1"}, {"a.png"}).name.of(0), "a.png");
    EXPECT_EQ(accepted({}, {"100% %s.png"}).output, frame_output::single) << "no pattern";
    expect_refused({"--frames", "2"}, {"\"a.png\"", "%04d", ".glb", ".apng"}, {"a.png"});
    expect_refused({"--frames", "2"}, {"a_%s.png", "\"%s.\""}, {"a_%s.png"});
    expect_refused({"--frames", "2"}, {"a_%d_%d.png"}, {"a_%d_%d.png"});
    expect_refused({"--frames", "2"}, {"a_%d.glb", "without"}, {"a_%d.glb"});
    expect_refused({}, {"a_%04d.png", "--frames N"}, {"a_%04d.png"});
    expect_refused({"--frames", "2"}, {"--form list", "--form rings"}, {"a.glb", false, true});
    EXPECT_EQ(accepted({"--frames", "2"}, {"a_%d.obj", false, true}).frames, 2u);
}

// Whatever is typed is an answer, and what is accepted lies in its range.
TEST(tree_options, take_any_text) {
    std::mt19937 random(5);
    const words some{"",     "0",       "1",  "-1",    "1e9",  "nan", "inf",
                     "off",  "dynamic", "%d", "none",  "0.02", "360", "1e-9",
                     "\xff", "a.png",   "24", "paper", "1e999"};
    for (int i = 0; i < 20000; ++i) {
        tree_option_words typed;
        for (auto* word :
             {&typed.bark, &typed.bark_map, &typed.leaf_map, &typed.sway, &typed.wind,
              &typed.wind_from, &typed.gusts, &typed.at, &typed.frames, &typed.fps, &typed.lod}) {
            if (random() % 4 == 0) {
                *word = some[random() % some.size()];
            }
        }
        typed.leaves = random() % 4 == 0;
        typed.no_leaves = random() % 4 == 0;
        const auto options = check(typed, {"a_%d.png", random() % 4 == 0, random() % 4 == 0});
        if (!options) {
            EXPECT_EQ(options.error().message.back(), '.');
            continue;
        }
        EXPECT_TRUE(options->bark_depth >= 0 && options->bark_depth <= 1);
        EXPECT_TRUE(options->wind >= 0 && options->wind <= 150);
        EXPECT_TRUE(options->fps > 0 && options->fps <= 1000);
        EXPECT_TRUE(options->frames >= 1 && options->lod >= 0 && options->at >= 0);
    }
}
