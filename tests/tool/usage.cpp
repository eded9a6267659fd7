// What the tool says of its command line.

#include "support.hpp"

using namespace skybark::tests;

namespace {

class tool_usage : public tool {
  protected:
    /// A usage error: code 2, a sentence with these parts, no file.
    void expect_refused(words arguments, const words& parts) {
        const outcome o = skybark(std::move(arguments));
        EXPECT_EQ(o.code, 2) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
        EXPECT_EQ(names(), std::set<std::string>{});
    }
    /// `skybark tree quaking_aspen -o a.obj` with two more words.
    void expect_value_refused(const std::string& option, const std::string& value) {
        expect_refused({"tree", "quaking_aspen", "-o", in_folder("a.obj"), option, value},
                       {option, "\"" + value + "\"", "expected"});
    }
};

} // namespace

TEST_F(tool_usage, helps) {
    for (const char* command : {"tree", "cloud", "gather", "devices", "conformance"}) {
        const outcome o = skybark({command, "--help"});
        EXPECT_EQ(o.code, 0);
        EXPECT_EQ(o.err, "");
        EXPECT_TRUE(has(o.out, {"Usage: skybark " + std::string(command)}));
        EXPECT_TRUE(has(skybark({"--help"}).out, {command}));
    }
    EXPECT_TRUE(
        has(skybark({"tree", "--help"}).out,
            {"--backend",  "--device", "--size",  "--seed",      "--stats",     "--quiet",
             "--sides",    "--rings",  "--frame", "--padding",   "--form",      "--skeleton",
             "--list",     "-o",       "--bark",  "--bark-map",  "--leaves",    "--no-leaves",
             "--leaf-map", "--sway",   "--wind",  "--wind-from", "--gusts",     "--at",
             "--frames",   "--fps",    "--lod",   "--tubes",     "--bark-edge", "--camera",
             "--look-at"}));
    EXPECT_TRUE(has(
        skybark({"cloud", "--help"}).out,
        {"--backend", "--device", "--size",    "--seed",       "--stats",  "--quiet",     "--sun",
         "--volume",  "--method", "--padding", "--polygons",   "--route",  "--profile",   "--light",
         "--octaves", "--phase",  "--sigmas",  "--extinction", "--albedo", "--particles", "--half",
         "--probe",   "--camera", "--look-at", "--list",       "--grid",   "-o"}));
    EXPECT_TRUE(has(skybark({"gather", "--help"}).out, {"--backend",    "--device",
                                                        "--size",       "--seed",
                                                        "--stats",      "--quiet",
                                                        "--points",     "--lightmap",
                                                        "--unwrapped",  "--directions",
                                                        "--error",      "--max-directions",
                                                        "--bounces",    "--bounce-directions",
                                                        "--patch-size", "--sky",
                                                        "--sun",        "--sun-irradiance",
                                                        "--method",     "--peel-size",
                                                        "--save",       "--resume",
                                                        "--exposure",   "--supersampling",
                                                        "--two-sided",  "--camera",
                                                        "--look-at",    "-o"}));
}

TEST_F(tool_usage, tells_its_version) {
    const outcome o = skybark({"--version"});
    EXPECT_EQ(o.code, 0);
    EXPECT_EQ(o.out.rfind("skybark ", 0), 0u) << o.out;
    EXPECT_EQ(skybark({"tree", "--version"}).out, o.out);
}

TEST_F(tool_usage, lists_species) {
    const outcome o = skybark({"tree", "--list"});
    EXPECT_EQ(o.code, 0);
    EXPECT_TRUE(
        has(o.out, {"quaking_aspen", "black_tupelo", "weeping_willow", "california_black_oak"}));
}

TEST_F(tool_usage, wants_a_command) {
    const outcome o = skybark({});
    EXPECT_EQ(o.code, 2);
    EXPECT_TRUE(has(o.err, {"Usage: skybark"}));
    expect_refused({"grow"}, {"\"grow\"", "tree, cloud, gather, meadow, devices or conformance"});
    expect_refused({"--grow"}, {"--grow"});
}

TEST_F(tool_usage, wants_input_and_output) {
    expect_refused({"tree"}, {"INPUT"});
    expect_refused({"tree", "-o", in_folder("a.obj")}, {"INPUT", "--list"});
    expect_refused({"tree", "quaking_aspen"}, {"-o", ".png", ".obj", ".glb"});
    expect_refused({"tree", "quaking_aspen", "-o", in_folder("a.txt")},
                   {"a.txt", ".png", ".obj", ".glb"});
    expect_refused({"tree", "quaking_aspen", "-o", in_folder("png")}, {".png", ".obj", ".glb"});
    expect_refused({"tree", "quaking_aspen", "-o", folder.string() + "/"}, {".png"});
}

TEST_F(tool_usage, refuses_numbers_that_are_none) {
    for (const char* text :
         {"2", "1025", "-3", "8.0", "8x", "eight", "0x8", " 8", "1e1", "99999999999999999999"}) {
        expect_value_refused("--sides", text);
    }
    for (const char* text : {"1", "1025", "-2", "four"}) {
        expect_value_refused("--rings", text);
    }
    for (const char* text :
         {"0x600", "800", "800x", "x600", "800x16385", "-8x6", "8x6x4", "8 x6"}) {
        expect_value_refused("--size", text);
    }
    for (const char* text : {"-1", "4294967296", "random"}) {
        expect_value_refused("--seed", text);
    }
    for (const char* text : {"-1", "first"}) {
        expect_value_refused("--device", text);
    }
}

TEST_F(tool_usage, refuses_names_that_it_does_not_know) {
    expect_value_refused("--backend", "metal");
    expect_value_refused("--frame", "frenet");
    expect_value_refused("--padding", "none");
    expect_value_refused("--form", "strips");
    expect_refused({"tree", "quaking_aspen", "--shape", "-o", in_folder("a.obj")}, {"--shape"});
    expect_refused({"tree", "quaking_aspen", "birch", "-o", in_folder("a.obj")}, {"birch"});
    expect_refused({"devices", "--xml"}, {"--xml"});
    expect_refused({"conformance", "--backend", "metal"}, {"metal", "cpu, opengl or vulkan"});
}

// What is typed about bark, leaves, wind and frames is checked before any work is done.
TEST_F(tool_usage, refuses_what_trees_cannot_do) {
    expect_value_refused("--wind", "200");
    expect_value_refused("--sway", "rigid");
    expect_value_refused("--bark", "deep");
    expect_value_refused("--frames", "0");
    const auto refused = [&](const std::string& out, words more, const words& parts) {
        more.insert(more.begin(), {"tree", "quaking_aspen", "-o", in_folder(out)});
        expect_refused(more, parts);
    };
    refused("a.png", {"--frames", "2"}, {"--frames", "%04d"});
    refused("a.obj", {"--fps", "12"}, {"--fps", "--frames"});
    refused("a.obj", {"--bark-map", "b.png"}, {"--bark-map", "--bark"});
    refused("a.obj", {"--no-leaves", "--leaf-map", "l.png"}, {"--no-leaves"});
    refused("a.obj", {"--skeleton", "--lod", "1"}, {"--skeleton", "--lod"});
    refused("a.glb", {"--lod", "1", "--frames", "2"}, {"--lod", "--frames"});
}

TEST_F(tool_usage, keeps_its_input) {
    const std::string input = in_folder("tree.json");
    write_file(input, "kept");
    const outcome o = skybark({"tree", input, "-o", in_folder("a.obj"), "--stats", input});
    EXPECT_EQ(o.code, 2);
    EXPECT_TRUE(is_sentence(o.err));
    EXPECT_EQ(read_file(input), "kept");
}

TEST_F(tool_usage, says_when_there_is_no_such_device) {
    for (const char* backend : {"cpu", "opengl", "vulkan"}) {
        const outcome o = skybark({"tree", "quaking_aspen", "-o", in_folder("a.obj"), "--backend",
                                   backend, "--device", "4000000000"});
        EXPECT_EQ(o.code, 3) << backend;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_EQ(names(), std::set<std::string>{});
        EXPECT_EQ(skybark({"conformance", "--backend", backend, "--device", "4000000000"}).code, 3);
    }
}
