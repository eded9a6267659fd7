// The options of `skybark gather`: words into numbers, and sentences about the rest.

#include <tool/gather_options.hpp>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <gtest/gtest.h>
#include <io/exr.hpp>
#include <string>
#include <vector>

using namespace skybark::tool;
using skybark::gather::gather_method;

namespace {

using words = std::vector<std::string>;

const gather_option_context to_table{"a.obj", "a.csv"};
const gather_option_context to_mesh{"a.glb", "a.ply"};
const gather_option_context to_picture{"a.OBJ", "a.png"};
const gather_option_context to_lightmap{"a.obj", "a.exr"};

skybark::result<gather_options> checked(words arguments, const gather_option_context& context) {
    CLI::App app;
    gather_option_words typed;
    add_gather_options(app, typed);
    std::reverse(arguments.begin(), arguments.end()); // as CLI11 wants a vector
    EXPECT_NO_THROW(app.parse(arguments));
    return check(typed, context);
}

gather_options accepted(words arguments, const gather_option_context& context = to_table) {
    const auto options = checked(std::move(arguments), context);
    EXPECT_TRUE(options) << options.error().message;
    return options.value_or(gather_options{});
}

void refused(words arguments, const words& parts, const gather_option_context& context = to_table) {
    const auto options = checked(std::move(arguments), context);
    ASSERT_FALSE(options);
    const std::string& sentence = options.error().message;
    EXPECT_EQ(sentence.back(), '.') << sentence;
    for (const std::string& part : parts) {
        EXPECT_NE(sentence.find(part), std::string::npos) << sentence << " lacks " << part;
    }
}

} // namespace

TEST(gather_options, has_defaults) {
    const gather_options o = accepted({});
    EXPECT_EQ(o.output, gather_output::table);
    EXPECT_EQ(o.places, gather_places::vertices);
    EXPECT_EQ(o.directions, 1024u);
    EXPECT_FALSE(o.error);
    EXPECT_EQ(o.bounces, 0u);
    EXPECT_EQ(o.sky, glm::vec3(0));
    EXPECT_FALSE(o.has_sun);
    EXPECT_EQ(o.method, gather_method::resolve);
    EXPECT_EQ(accepted({}, to_mesh).output, gather_output::mesh);
    EXPECT_EQ(accepted({}, to_picture).places, gather_places::pixels);
    if (skybark::io::has_exr()) {
        EXPECT_EQ(accepted({}, to_lightmap).places, gather_places::texels);
        EXPECT_EQ(accepted({}, to_lightmap).lightmap, 1024u);
    } else {
        refused({}, {"OpenEXR"}, to_lightmap);
    }
}

TEST(gather_options, reads_what_is_typed) {
    const gather_options o = accepted({"--points",
                                       "p.csv",
                                       "--directions",
                                       "77",
                                       "--bounces",
                                       "3",
                                       "--bounce-directions",
                                       "64",
                                       "--patch-size",
                                       "0.5",
                                       "--sky",
                                       "1,2,3",
                                       "--sun",
                                       "90,45",
                                       "--sun-irradiance",
                                       "4",
                                       "--method",
                                       "peel",
                                       "--peel-size",
                                       "512",
                                       "--save",
                                       "s",
                                       "--resume",
                                       "t",
                                       "--two-sided"});
    EXPECT_EQ(o.places, gather_places::points);
    EXPECT_EQ(o.points, "p.csv");
    EXPECT_EQ(o.directions, 77u);
    EXPECT_EQ(o.bounces, 3u);
    EXPECT_EQ(o.bounce_directions, 64u);
    EXPECT_EQ(o.patch_size, 0.5f);
    EXPECT_EQ(o.sky, glm::vec3(1, 2, 3));
    EXPECT_TRUE(o.has_sun);
    EXPECT_EQ(o.sun_azimuth, 90);
    EXPECT_EQ(o.sun_elevation, 45);
    EXPECT_EQ(o.sun_irradiance, glm::vec3(4)) << "one number is a grey";
    EXPECT_EQ(o.method, gather_method::peel);
    EXPECT_EQ(o.peel_size, 512u);
    EXPECT_EQ(o.save, "s");
    EXPECT_EQ(o.resume, "t");
    EXPECT_TRUE(o.two_sided);
    const gather_options e = accepted({"--error", "0.01"});
    EXPECT_FLOAT_EQ(static_cast<float>(e.error.value_or(0)), 0.01f);
    EXPECT_EQ(e.directions, 65536u);
    EXPECT_EQ(accepted({"--error", "1", "--max-directions", "9"}).directions, 9u);
    const gather_options m = accepted({"--lightmap", "64", "--unwrapped", "u.glb"});
    EXPECT_EQ(m.places, gather_places::texels);
    EXPECT_EQ(m.lightmap, 64u);
    EXPECT_EQ(m.unwrapped, "u.glb");
    const gather_options p = accepted(
        {"--camera", "1,2,3", "--look-at", "0,0,0", "--exposure", "2", "--supersampling", "4"},
        to_picture);
    EXPECT_EQ(p.camera.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(p.exposure, 2.0f);
    EXPECT_EQ(p.supersampling, 4u);
}

TEST(gather_options, refuses_values) {
    for (const char* text : {"0", "-1", "many", "1.5", "100000001"}) {
        refused({"--directions", text}, {"--directions", text, "expected a whole number from 1"});
    }
    for (const char* text : {"0", "-1", "nan", "inf", "x"}) {
        refused({"--error", text}, {"--error", text, "expected"});
    }
    for (const char* text : {"-1", "1001", "two"}) {
        refused({"--bounces", text}, {"--bounces", text, "from 0 to 1000"});
    }
    for (const char* text : {"", "1,2", "1,2,3,4", "1,-2,3", "nan,0,0", "red", "1,,2", "2e9,1,1"}) {
        refused({"--sky", text}, {"--sky", "\"" + std::string(text) + "\"", "R,G,B"});
        refused({"--sun", "0,0", "--sun-irradiance", text}, {"--sun-irradiance", "R,G,B"});
    }
    for (const char* text : {"", "90", "0,91", "0,-91", "400,0", "a,b"}) {
        refused({"--sun", text}, {"--sun", "AZIMUTH,ELEVATION"});
    }
    refused({"--method", "rays"}, {"--method", "\"rays\"", "resolve or peel"});
    refused({"--lightmap", "0"}, {"--lightmap", "from 1 to 32768"});
    refused({"--lightmap", "40000"}, {"--lightmap", "40000"});
    refused({"--bounces", "1", "--patch-size", "0"}, {"--patch-size"});
    refused({"--method", "peel", "--peel-size", "1"}, {"--peel-size"});
    refused({"--supersampling", "0"}, {"--supersampling"}, to_picture);
    refused({"--exposure", "-1"}, {"--exposure"}, to_picture);
    refused({"--points", ""}, {"--points", "empty"});
    refused({"--save", ""}, {"--save", "empty"});
    refused({"--resume", ""}, {"--resume", "empty"});
}

TEST(gather_options, refuses_contradictions) {
    refused({"--directions", "9", "--error", "1"}, {"--directions", "--error"});
    refused({"--max-directions", "9"}, {"--max-directions", "--error"});
    refused({"--points", "p.csv", "--lightmap", "9"}, {"--points", "--lightmap"});
    refused({"--points", "p.csv"}, {"--points", ".csv or .ply"}, to_picture);
    refused({"--lightmap", "9"}, {"--lightmap", ".exr"}, to_picture);
    refused({"--unwrapped", "u.obj"}, {"--unwrapped", "--lightmap"});
    refused({"--lightmap", "9", "--unwrapped", "u.txt"}, {"\"u.txt\"", ".glb"});
    refused({"--sun-irradiance", "1"}, {"--sun-irradiance", "--sun"});
    refused({"--peel-size", "99"}, {"--peel-size", "--method peel"});
    refused({"--bounce-directions", "99"}, {"--bounce-directions", "--bounces"});
    refused({"--patch-size", "1"}, {"--patch-size", "--bounces"});
    refused({"--supersampling", "2"}, {"--supersampling", ".png"});
    refused({"--camera", "0,0,0", "--look-at", "1,0,0"}, {"--camera", ".png"});
    refused({"--camera", "0,0,0"}, {"--camera", "--look-at"}, to_picture);
    refused({"--exposure", "1"}, {"--exposure", ".png or .ply"});
    refused({}, {"\"a.stl\"", ".obj or .glb"}, {"a.stl", "a.csv"});
    refused({}, {"\"obj\"", ".obj or .glb"}, {"obj", "a.csv"});
    refused({}, {"\"a.jpg\"", ".csv", ".ply", ".exr", ".png"}, {"a.obj", "a.jpg"});
}
