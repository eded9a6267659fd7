// `skybark meadow` as a process: pictures, frames, its report, and what it refuses.

#include "pictures.hpp"

using namespace skybark::tests;

namespace {

/// A few trees, little of all else.
const words small{"--size",          "96x54", "--trees", "3", "--grass",        "0.05",
                  "--directions",    "4",     "--lod",   "2", "--cloud-voxels", "16",
                  "--supersampling", "1"};

words with_small(words first) {
    first.insert(first.end(), small.begin(), small.end());
    return first;
}

class tool_meadow : public tool {
  protected:
    void expect_refused(words arguments, const words& parts) const {
        arguments.insert(arguments.begin(), "meadow");
        const outcome o = skybark(arguments);
        EXPECT_EQ(o.code, 2) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_TRUE(has(o.err, {"expected"}));
        EXPECT_EQ(names(), std::set<std::string>{});
    }
};

class tool_meadow_on : public tool_meadow, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, tool_meadow_on, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& each) { return std::string(each.param); });

} // namespace

TEST_P(tool_meadow_on, draws_and_reports) {
    const std::string out = in_folder("m.png");
    const std::string stats = in_folder("m.json");
    const outcome o =
        skybark(with_small({"meadow", "--backend", GetParam(), "-o", out, "--stats", stats}));
    SKYBARK_SKIP_UNAVAILABLE(o, GetParam());
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(o.err, "");
    EXPECT_TRUE(has(o.out, {"m.png", "3 trees", GetParam()}));
    const read_picture picture = read_png(out);
    EXPECT_EQ(picture.width, 96);
    EXPECT_EQ(picture.height, 54);

    const auto report = nlohmann::json::parse(read_file(stats));
    EXPECT_EQ(report["command"], "meadow");
    EXPECT_EQ(report["backend"], GetParam());
    EXPECT_EQ(report["counts"]["trees"], 3);
    EXPECT_EQ(report["counts"]["frames"], 1);
    EXPECT_GT(report["counts"]["triangles"], 1000);
    EXPECT_GT(report["counts"]["light_patches"], 1000);
    for (const char* stage :
         {"grow", "settle", "sway", "mesh", "clouds", "light", "draw", "write"}) {
        EXPECT_GE(report["seconds"][stage], 0) << stage;
    }
    for (const char* part : {"stand", "clouds", "light", "picture"}) {
        EXPECT_GT(report["memory"][part], 1000) << part;
    }
}

// Frames of a file that plays, or in files of their own: the first is what a picture shows.
TEST_F(tool_meadow, draws_frames) {
    const outcome frames = skybark(
        with_small({"meadow", "--seconds", "0.2", "--fps", "10", "-o", in_folder("m_%02d.png")}));
    ASSERT_EQ(frames.code, 0) << frames.err;
    EXPECT_EQ(names(), (std::set<std::string>{"m_00.png", "m_01.png"}));
    ASSERT_EQ(skybark(with_small({"meadow", "-o", in_folder("one.png")})).code, 0);
    EXPECT_EQ(read_file(in_folder("one.png")), read_file(in_folder("m_00.png")));
    EXPECT_NE(read_file(in_folder("one.png")), read_file(in_folder("m_01.png")));
    const outcome plays = skybark(with_small(
        {"meadow", "--seconds", "0.2", "--fps", "10", "-o", in_folder("m.apng"), "--quiet"}));
    ASSERT_EQ(plays.code, 0) << plays.err;
    EXPECT_EQ(plays.out, "");
    EXPECT_NE(read_file(in_folder("m.apng")).find("acTL"), std::string::npos);
}

TEST_F(tool_meadow, another_seed_grows_another_meadow) {
    ASSERT_EQ(skybark(with_small({"meadow", "-o", in_folder("a.png")})).code, 0);
    ASSERT_EQ(skybark(with_small({"meadow", "-o", in_folder("b.png"), "--seed", "2"})).code, 0);
    EXPECT_GT(compare(read_png(in_folder("a.png")), read_png(in_folder("b.png"))).mean, 1);
}

TEST_F(tool_meadow, refuses_what_cannot_be) {
    const std::string out = in_folder("a.png");
    expect_refused({}, {"no -o OUT"});
    expect_refused({"-o", in_folder("a.obj")}, {"a.obj", ".png"});
    expect_refused({"-o", in_folder("a_%d_%d.png")}, {"two places"});
    expect_refused({"-o", out, "--fps", "12"}, {"--fps", "%04d"});
    for (const auto& [option, values] : std::initializer_list<std::pair<const char*, words>>{
             {"--seconds", {"-1", "nan", "1e9"}},
             {"--fps", {"0", "-1", "inf"}},
             {"--sun", {"1", "1,2,3", "0,-5", "0,91", "a,b", "nan,10"}},
             {"--turbidity", {"0", "11"}},
             {"--wind", {"-1", "31", "1e300"}},
             {"--wind-from", {"400"}},
             {"--cloud", {"-0.1", "0.9"}},
             {"--trees", {"-1", "201", "1.5", "99999999999999999999"}},
             {"--grass", {"-1", "5"}},
             {"--bounces", {"-1", "17"}},
             {"--directions", {"0", "4097"}},
             {"--cloud-voxels", {"0", "1000000000"}},
             {"--supersampling", {"0", "9"}},
             {"--lod", {"0", "65"}}}) {
        for (const std::string& value : values) {
            expect_refused({"-o", in_folder("m_%d.png"), std::string(option) + "=" + value},
                           {option});
        }
    }
    expect_refused({"-o", out, "--camera", "1,2,3"}, {"--camera", "--look-at"});
    expect_refused({"-o", out, "--stats", out}, {"same file"});
    const outcome nowhere = skybark({"meadow", "-o", in_folder("no/such/folder/a.png")});
    EXPECT_EQ(nowhere.code, 1);
    EXPECT_TRUE(is_sentence(nowhere.err));
}
