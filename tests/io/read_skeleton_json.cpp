#include "support/temporary_name.hpp"

#include <io/read_skeleton_json.hpp>

#include <io/read_tree.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/species.hpp>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

std::string complaint(const std::string& text) {
    const auto tree = io::parse_skeleton_json(text, "tree.json");
    return tree ? std::string() : tree.error().message;
}

/// The sentence about a tree with these segments.
std::string about(const std::string& segments) {
    return complaint("{\"skybark_tree\": 1, \"segments\": [\n" + segments + "\n]}");
}

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

const std::string root = R"({"base":[0,0,0],"tip":[0,1,0],"radius":0.5,"parent":null})";

std::string child_of(const std::string& parent) {
    return R"({"base":[0,1,0],"tip":[0,2,0],"radius":0.5,"parent":)" + parent + "}";
}

bool same(const std::vector<trees::segment>& a, const std::vector<trees::segment>& b) {
    if (a.size() != b.size())
        return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].tip != b[i].tip || a[i].radius != b[i].radius || a[i].parent != b[i].parent)
            return false;
    return true;
}

} // namespace

TEST(read_skeleton_json, reads_segments) {
    const auto tree = io::parse_skeleton_json(
        R"({ "comment": "a \"fork\"", "segments": [
             {"parent": 1, "tip": [1.5, 2e0, -3], "base": [0, 1, 0], "radius": 0.25},
             {"base": [0,0,0], "tip": [0,1,0], "base_radius": 1, "radius": 0.5, "parent": null}
           ], "skybark_tree": 1 }
        )",
        "t");
    ASSERT_TRUE(tree) << tree.error().message;
    ASSERT_EQ(tree->size(), 2u);
    EXPECT_EQ((*tree)[0].tip, glm::vec3(1.5f, 2, -3));
    EXPECT_EQ((*tree)[0].base_radius, 0.25f) << "left out: as radius";
    EXPECT_EQ((*tree)[0].parent, 1u);
    EXPECT_EQ((*tree)[1].base_radius, 1.0f);
    EXPECT_EQ((*tree)[1].parent, trees::none);
}

TEST(read_skeleton_json, grows_a_species_with_its_own_parameters) {
    const auto plain =
        io::parse_skeleton_json(R"({"skybark_tree":1,"species":"quaking_aspen","seed":7})", "t", 3);
    ASSERT_TRUE(plain) << plain.error().message;
    EXPECT_TRUE(same(*plain, *trees::grow(trees::quaking_aspen(), 7)));
    const auto unseeded =
        io::parse_skeleton_json(R"({"skybark_tree":1,"species":"quaking_aspen"})", "t", 3);
    EXPECT_TRUE(same(*unseeded, *trees::grow(trees::quaking_aspen(), 3)));

    const auto changed = io::parse_skeleton_json( // parameters before the species they change
        R"({"parameters":{"levels":2,"scale":20,"level":[{},{"branches":3,"curve":-10}]},
            "skybark_tree":1,"seed":7,"species":"quaking_aspen"})",
        "t");
    ASSERT_TRUE(changed) << changed.error().message;
    trees::weber_penn_parameters p = trees::quaking_aspen();
    p.levels = 2;
    p.scale = 20;
    p.level[1].branches = 3;
    p.level[1].curve = -10;
    EXPECT_TRUE(same(*changed, *trees::grow(p, 7)));
}

TEST(read_skeleton_json, names_the_line_of_a_bad_segment) {
    EXPECT_EQ(about(root), "");
    EXPECT_TRUE(has(about(root + ",\n" + child_of("2")),
                    "Line 3 of \"tree.json\": segment 1 has the parent 2; expected less than 2"));
    EXPECT_TRUE(has(about(root + ",\n" + child_of("-1")), "\"-1\"; expected the index"));
    EXPECT_TRUE(has(about(root + ",\n" + child_of("true")), "\"true\"; expected the index"));
    EXPECT_TRUE(has(about(child_of("2") + ",\n" + root + ",\n" + child_of("0")),
                    "Line 2 of \"tree.json\": the segments 0 → 2 → 0 are each other's parents"));
    EXPECT_TRUE(has(about(child_of("0")), "0 → 0"));
    EXPECT_TRUE(has(about(root + ",\n{\"base\":[0,0,0]}"), "segment 1 has no \"tip\""));
    EXPECT_TRUE(has(about("{\"base\":[0,0]}"), "expected \",\" and another coordinate"));
    EXPECT_TRUE(has(about("{\"base\":[0,0,\nNaN]}"),
                    "Line 3 of \"tree.json\": in the base of segment 0 there is \"NaN\""));
    EXPECT_TRUE(has(about("{\"tip\":[0,1e999,0]}"), "\"1e999\"; expected a finite number"));
    EXPECT_TRUE(has(about("{\"radius\":-0.5}"), "radius of segment 0 is -0.5"));
    EXPECT_TRUE(has(about("{\"width\":1}"), "no member \"width\" in a segment"));
    EXPECT_TRUE(has(about("{\"radius\":1,\"radius\":1}"), "\"radius\" twice"));
    EXPECT_TRUE(has(about(""), "there are no segments"));
}

TEST(read_skeleton_json, names_the_line_of_a_bad_tree) {
    EXPECT_TRUE(has(complaint(" \n"), "\"tree.json\" is empty"));
    EXPECT_TRUE(has(complaint("[]"), "expected \"{\" at the beginning of a tree"));
    EXPECT_TRUE(
        has(complaint("{\"skybark_tree\":2}"), "\"skybark_tree\": there is \"2\"; expected 1."));
    EXPECT_TRUE(has(complaint("{}"), "no member \"skybark_tree\""));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1}"), "neither \"segments\" nor \"species\""));
    EXPECT_TRUE(has(
        complaint("{\"skybark_tree\":1,\"segments\":[" + root + "],\"species\":\"quaking_aspen\"}"),
        "both"));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1,\n\"species\":\"oak\"}"),
                    "Line 2 of \"tree.json\": the species is \"oak\"; expected one of black_tup"));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1,\n\"seed\":-1}"), "from 0 to 4294967295"));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1,\"size\":1}"), "no member \"size\""));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1} x"), "after the tree"));
    EXPECT_TRUE(has(complaint("{\"skybark_tree\":1"), "the file ends"));
    EXPECT_TRUE(has(complaint("{\"skybark_tr"), "doesn't end"));
    EXPECT_TRUE(has(complaint(std::string(100'000, '[')), "expected \"{\""));
    EXPECT_TRUE(has(complaint(std::string("\x7f"
                                          "ELF\0",
                                          5)),
                    "Line 1"));
}

TEST(read_skeleton_json, names_the_line_of_a_bad_parameter) {
    const auto with = [](const std::string& parameters) {
        return complaint("{\"skybark_tree\":1,\"species\":\"quaking_aspen\",\n\"parameters\":{\n" +
                         parameters + "}}");
    };
    EXPECT_TRUE(
        has(with("\"hight\":1"), "Line 3 of \"tree.json\": there is no parameter \"hight\""));
    EXPECT_TRUE(has(with("\"levels\":1.5"), "\"levels\" is \"1.5\"; expected a whole number"));
    EXPECT_TRUE(has(with("\"levels\":-1"), "Line 3 of \"tree.json\": The tree parameter levels"));
    EXPECT_TRUE(has(with("\"level\":[{},{\"branches\":9000000}]"), "segments; expected at most"));
    EXPECT_TRUE(has(with("\"level\":[{},{},{},{},{}]"), "more than four levels"));
    EXPECT_TRUE(has(with("\"level\":[{\"scale\":1}]"), "no parameter \"scale\" of a level"));
    EXPECT_TRUE(has(with("\"scale\":\"big\""), "in the parameter \"scale\" there is"));
}

TEST(read_tree, chooses_by_extension_or_name) {
    const auto tree = io::read_tree("weeping_willow", 5);
    ASSERT_TRUE(tree) << tree.error().message;
    EXPECT_TRUE(same(*tree, *trees::grow(trees::weeping_willow(), 5)));
    const auto unknown = io::read_tree("tree.fbx", 1);
    ASSERT_FALSE(unknown);
    for (const char* part : {"\"tree.fbx\"", ".csv", ".mtg", ".json", "quaking_aspen"})
        EXPECT_TRUE(has(unknown.error().message, part));
    const auto missing = io::read_tree("no_such_file.JSON", 1);
    ASSERT_FALSE(missing);
    EXPECT_TRUE(has(missing.error().message, "can't be opened"));
    const auto path = support::temporary_name("tree.json");
    std::ofstream(path) << "{\"skybark_tree\":1,\"segments\":[" << root << "]}";
    const auto file = io::read_tree(path.string(), 1);
    std::filesystem::remove(path);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->size(), 1u);
}
