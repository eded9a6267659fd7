// What the tool says of files that aren't what they should be.

#include "support.hpp"

using namespace skybark::tests;

namespace {

const std::string csv = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
                        "1,-1,0,0,0,0,0,1,0.1\n";
const std::string mtg = "CODE:\tFORM-A\n"
                        "CLASSES:\n"
                        "$\t0\tFREE\tFREE\tIMPLICIT\n"
                        "P\t1\tFREE\tFREE\tEXPLICIT\n"
                        "S\t2\tFREE\tFREE\tEXPLICIT\n"
                        "DESCRIPTION:\n"
                        "FEATURES:\n"
                        "XX\tREAL\n"
                        "YY\tREAL\n"
                        "ZZ\tREAL\n"
                        "TopDia\tREAL\n"
                        "MTG:\n"
                        "ENTITY-CODE\t\tXX\tYY\tZZ\tTopDia\n"
                        "/P1\t\t0\t0\t0\t0.2\n"
                        "^/S1\t\t0\t0\t1\t0.2\n";
const std::string json = "{\"skybark_tree\": 1, \"segments\": [\n"
                         "{\"base\": [0, 0, 0], \"tip\": [0, 1, 0], \"radius\": 0.1, "
                         "\"parent\": null}";
const std::string binary("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\xff\xfe", 24);

/// A segment of the description.
std::string segment(const std::string& tip, const std::string& radius, const std::string& parent) {
    return "{\"base\": [0, 1, 0], \"tip\": " + tip + ", \"radius\": " + radius +
           ", \"parent\": " + parent + "}";
}

class tool_inputs : public tool {
  protected:
    /// Code 1, a sentence with the file's name and these parts, and nothing beside the input.
    void expect_rejected(const std::string& name, const words& parts) {
        const auto before = names();
        const outcome o = skybark({"tree", in_folder(name), "-o", in_folder("out.obj"), "--stats",
                                   in_folder("stats.json")});
        EXPECT_EQ(o.code, 1) << name;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, {name})) << "the file";
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
        EXPECT_EQ(names(), before) << "a file was left";
    }
    void expect_rejected(const std::string& name, const std::string& text, const words& parts) {
        write_file(in_folder(name), text);
        expect_rejected(name, parts);
    }
    void expect_read(const std::string& name, const std::string& text) {
        write_file(in_folder(name), text);
        const outcome o = skybark({"tree", in_folder(name), "-o", in_folder("out.obj")});
        EXPECT_EQ(o.code, 0) << o.err;
    }
};

} // namespace

TEST_F(tool_inputs, reads_what_the_others_here_are_made_of) {
    expect_read("t.csv", csv);
    expect_read("t.mtg", mtg);
    expect_read("t.json", json + "]}");
}

TEST_F(tool_inputs, csv) {
    expect_rejected("empty.csv", "", {"empty"});
    expect_rejected("no_rows.csv", csv.substr(0, csv.find('\n') + 1), {"Line 1"});
    expect_rejected("binary.csv", binary, {"Line 1", "\\x89PNG"});
    expect_rejected("truncated.csv", csv + "2,1,0,0,1,0,0", {"Line 3", "2,1,0,0,1,0,0"});
    expect_rejected("cycle.csv", csv + "2,3,0,0,1,0,0,2,0.1\n3,2,0,0,2,0,0,3,0.1\n",
                    {"Line 3", "2 → 3 → 2"});
    expect_rejected("own_parent.csv", csv + "2,2,0,0,1,0,0,2,0.1\n", {"Line 3", "2 → 2"});
    expect_rejected("missing_parent.csv", csv + "2,77,0,0,1,0,0,2,0.1\n", {"Line 3", "77"});
    expect_rejected("nan.csv", csv + "2,1,0,0,nan,0,0,2,0.1\n", {"Line 3", "\"nan\"", "startZ"});
    expect_rejected("infinite.csv", csv + "2,1,0,0,1,0,0,inf,0.1\n", {"Line 3", "\"inf\""});
    expect_rejected("negative.csv", csv + "2,1,0,0,1,0,0,2,-0.5\n", {"Line 3", "\"-0.5\""});
    expect_rejected("no_column.csv", "ID,parentID\n1,-1\n", {"Line 1", "startX"});
    expect_rejected("text.csv", csv + "2,1,0,0,1,0,0,tall,0.1\n", {"Line 3", "\"tall\"", "endZ"});
}

TEST_F(tool_inputs, mtg) {
    expect_rejected("empty.mtg", "", {"empty"});
    expect_rejected("binary.mtg", binary, {"Line 1"});
    expect_rejected("truncated.mtg", mtg.substr(0, mtg.find("MTG:")), {"Line 11", "MTG"});
    expect_rejected("no_parent.mtg", mtg + "\t\t+S2\t0\t0\t2\t0.1\n", {"Line 16", "+S2"});
    expect_rejected("nan.mtg", mtg + "^<S2\t\t0\tnan\t2\t0.1\n", {"Line 16", "\"nan\""});
    expect_rejected("negative.mtg", mtg + "^<S2\t\t0\t0\t2\t-0.1\n", {"Line 16", "\"-0.1\""});
    expect_rejected("unknown.mtg", mtg + "^<Q2\t\t0\t0\t2\t0.1\n", {"Line 16", "Q"});
}

TEST_F(tool_inputs, json) {
    expect_rejected("empty.json", "", {"empty"});
    expect_rejected("binary.json", binary, {"Line 1"});
    expect_rejected("truncated.json", json, {"Line 2"});
    expect_rejected("no_end.json", json + ",\n" + segment("[0, 2, 0", "0.1", "0"), {"Line 3"});
    expect_rejected("cycle.json",
                    json + ",\n" + segment("[0, 2, 0]", "0.1", "2") + ",\n" +
                        segment("[0, 3, 0]", "0.1", "1") + "]}",
                    {"Line 3", "1 → 2 → 1"});
    expect_rejected("missing_parent.json", json + ",\n" + segment("[0, 2, 0]", "0.1", "77") + "]}",
                    {"Line 3", "77"});
    expect_rejected("nan.json", json + ",\n" + segment("[0, NaN, 0]", "0.1", "0") + "]}",
                    {"Line 3", "NaN"});
    expect_rejected("infinite.json", json + ",\n" + segment("[0, 1e99, 0]", "0.1", "0") + "]}",
                    {"Line 3", "1e99"});
    expect_rejected("negative.json", json + ",\n" + segment("[0, 2, 0]", "-0.5", "0") + "]}",
                    {"Line 3", "-0.5"});
    expect_rejected("species.json", "{\"skybark_tree\": 1,\n\"species\": \"baobab\"}",
                    {"Line 2", "baobab"});
    expect_rejected("none.json", "{\"skybark_tree\": 1, \"segments\": []}", {"Line 1"});
}

TEST_F(tool_inputs, no_file) {
    expect_rejected("missing.csv", {"No such file"});
    expect_rejected("missing.mtg", {"No such file"});
    expect_rejected("missing.json", {"No such file"});
    for (const char* name : {"folder.csv", "folder.mtg", "folder.json"}) {
        std::filesystem::create_directory(folder / name);
        expect_rejected(name, {"directory"});
    }
    expect_rejected("tree.xml", "<tree/>", {"tree.xml", ".csv", ".mtg", ".json", "quaking_aspen"});
    expect_rejected("birch", {"birch", "black_tupelo"});
}

TEST_F(tool_inputs, unreadable_file) {
    if (::geteuid() == 0) {
        GTEST_SKIP() << "Root reads every file.";
    }
    write_file(in_folder("locked.csv"), csv);
    std::filesystem::permissions(folder / "locked.csv", std::filesystem::perms::none);
    expect_rejected("locked.csv", {"Permission denied"});
}

namespace {

/// Ten million cylinders, one above the other in groups of a thousand, and then `last`.
void write_ten_million_lines(const std::string& path, const std::string& last) {
    std::ofstream file(path, std::ios::binary);
    file << csv.substr(0, csv.find('\n') + 1);
    std::string text;
    for (int i = 0; i < 10'000'000; ++i) {
        const bool root = i % 1000 == 0;
        const std::string x = std::to_string(i / 1000);
        const std::string z = std::to_string(i % 1000);
        text += std::to_string(i) + "," + (root ? "-1" : std::to_string(i - 1)) + "," + x + ",0," +
                z + "," + x + ",0," + z + ".9,0.1\n";
        if (text.size() > (1u << 20u)) {
            file << text;
            text.clear();
        }
    }
    file << text << last;
}

} // namespace

TEST_F(tool_inputs, names_the_last_of_ten_million_lines_slow) {
    write_ten_million_lines(in_folder("long.csv"), "10000000,9999999,0,0,0,0,0,high,0.1\n");
    expect_rejected("long.csv", {"Line 10000002", "\"high\"", "endZ"});
}

// 2^32 - 1 vertices are the most that indices of 32 bits tell apart: a sentence, before any memory
// has been asked for.
TEST_F(tool_inputs, reads_ten_million_lines_and_says_what_is_too_much_slow) {
    write_ten_million_lines(in_folder("long.csv"), "");
    const outcome o = skybark({"tree", in_folder("long.csv"), "-o", in_folder("out.obj"), "--sides",
                               "100", "--rings", "10"});
    EXPECT_EQ(o.code, 1) << o.err;
    EXPECT_TRUE(is_sentence(o.err));
    EXPECT_TRUE(has(o.err, {"32-bit"}));
    EXPECT_EQ(names(), std::set<std::string>{"long.csv"});
}
