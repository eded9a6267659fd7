#include "support/temporary_name.hpp"

#include <io/read_qsm.hpp>

#include "support/sample_qsm.hpp"

#include <io/read_tree.hpp>
#include <io/settle.hpp>
#include <skybark/trees/build_skeleton.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

const std::string header = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n";

/// The sentence that `text` gets; empty if it is read.
std::string complaint(std::string_view text) {
    const auto read = io::parse_qsm(text, "tree.csv");
    return read ? std::string() : read.error().message;
}

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

struct temporary_file {
    explicit temporary_file(const std::string& name, const std::string& text = {})
        : path(support::temporary_name(name)) {
        std::ofstream(path, std::ios::binary) << text;
    }
    temporary_file(const temporary_file&) = delete;
    temporary_file& operator=(const temporary_file&) = delete;
    ~temporary_file() { std::filesystem::remove(path); }
    std::filesystem::path path;
};

} // namespace

TEST(read_qsm, turns_z_up_into_y_up) {
    const auto read = io::parse_qsm(header + "7,-1,1,2,3,4,5,7,0.25\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 1u);
    const trees::segment& s = read->front();
    EXPECT_EQ(s.base, glm::vec3(1, 3, -2));
    EXPECT_EQ(s.tip, glm::vec3(4, 7, -5));
    EXPECT_EQ(s.base_radius, 0.25f);
    EXPECT_EQ(s.radius, 0.25f);
    EXPECT_EQ(s.parent, trees::none);
}

TEST(read_qsm, reads_every_cylinder_of_a_sample) {
    const auto cylinders = support::sample_cylinders();
    ASSERT_GT(cylinders.size(), 300u);
    const auto read = io::parse_qsm(support::qsm_text(cylinders), "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), cylinders.size());
    for (std::size_t i = 0; i < cylinders.size(); ++i) {
        const trees::segment& s = (*read)[i];
        const support::sample_cylinder& c = cylinders[i];
        EXPECT_NEAR(s.tip.x, c.end[0], 2e-6);
        EXPECT_NEAR(s.tip.y, c.end[2], 2e-6);
        EXPECT_NEAR(s.tip.z, -c.end[1], 2e-6);
        EXPECT_NEAR(s.base.x, c.start[0], 2e-6);
        EXPECT_NEAR(s.radius, c.radius, 1e-6);
        EXPECT_EQ(s.parent, c.parent_id < 0 ? trees::none : static_cast<unsigned>(c.parent_id));
    }
    EXPECT_TRUE(trees::build_skeleton(*read));
}

TEST(read_qsm, finds_columns_by_name_ids_in_any_order) {
    const std::string text = "radius;note;endZ;endY;endX;startZ;startY;startX;parentID;ID\r\n"
                             "1;\"a;b\";3;0;0;2;0;0;-40;1000000007\r\n"
                             "\r\n"
                             "2;c;2;0;0;1;0;0;-1;-40\r\n";
    const auto read = io::parse_qsm("\xef\xbb\xbf" + text, "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 2u);
    EXPECT_EQ((*read)[0].parent, 1u);
    EXPECT_EQ((*read)[1].parent, trees::none);
    EXPECT_EQ((*read)[0].tip, glm::vec3(0, 3, 0));
    std::string tabs = text;
    for (char& c : tabs)
        c = c == ';' ? '\t' : c;
    const auto same = io::parse_qsm(tabs, "t");
    ASSERT_TRUE(same) << same.error().message;
    EXPECT_EQ((*same)[0].radius, 1.0f);
}

TEST(read_qsm, takes_ids_from_one_end_of_the_range_to_the_other) {
    const std::string least = "-9223372036854775808";
    const std::string greatest = "9223372036854775807";
    const std::string rest = ",0,0,0,0,0,1,1\n";
    const auto read = io::parse_qsm(
        header + least + ",5" + rest + "5,-1" + rest + greatest + "," + least + rest, "t");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ((*read)[0].parent, 1u);
    EXPECT_EQ((*read)[2].parent, 0u);
    EXPECT_TRUE(has(
        complaint(header + least + ",-1" + rest + greatest + ",-1" + rest + least + ",-1" + rest),
        "Line 4 of \"tree.csv\": the ID -9223372036854775808 is that of line 2"));
}

TEST(read_qsm, takes_parent_zero_for_a_root_where_ids_begin_at_one) {
    const auto read = io::parse_qsm(header + "1,0,0,0,0,0,0,1,1\n2,1,0,0,1,0,0,2,1\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ((*read)[0].parent, trees::none);
    EXPECT_EQ((*read)[1].parent, 0u);
}

TEST(read_qsm, settles_the_root_at_the_origin_and_keeps_millimetres) {
    // a national grid: floats at 5.6e6 m are half a metre apart
    const std::string text = header +
                             "1,0,500000.250,5600000.001,100,500000.250,5600000.001,101,1\n"
                             "0,-1,500000.250,5600000.000,99,500000.250,5600000.001,100,1\n";
    const auto read = io::parse_qsm(text, "t", io::placement::settled);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ((*read)[1].base, glm::vec3(0));
    EXPECT_NEAR((*read)[1].tip.z, -0.001, 1e-6);
    EXPECT_NEAR((*read)[0].tip.y, 2, 1e-6);
    auto given = *io::parse_qsm(text, "t");
    EXPECT_GT(given[0].base.x, 4e5f);
    io::settle(given);
    EXPECT_EQ(given[1].base, glm::vec3(0));
}

TEST(read_qsm, names_file_line_and_value) {
    const std::string good = "0,-1,0,0,0,0,0,1,1\n";
    EXPECT_TRUE(has(complaint(""), "\"tree.csv\" is empty"));
    EXPECT_TRUE(has(complaint("\n \n"), "\"tree.csv\" is empty"));
    EXPECT_TRUE(has(complaint(header), "Line 1 of \"tree.csv\": there are no cylinders"));
    EXPECT_TRUE(has(complaint("a,b,c\n1,2,3\n"), "Line 1 of \"tree.csv\": there is no column"));
    EXPECT_TRUE(has(complaint("ID," + header + good), "\"ID\" is there twice"));
    EXPECT_TRUE(has(complaint(header + good + "1,0,0,0,1,0,zwei,2,1\n"),
                    "Line 3 of \"tree.csv\": endY is \"zwei\"; expected a finite number"));
    for (const char* bad : {"nan", "inf", "-inf", "1e999", "1e30", "", "1x", "0x10"})
        EXPECT_TRUE(has(complaint(header + "0,-1," + bad + ",0,0,0,0,1,1\n"), "Line 2")) << bad;
    EXPECT_TRUE(has(complaint(header + "0,-1,0,0,0,0,0,1,-0.5\n"), "radius is \"-0.5\""));
    EXPECT_TRUE(has(complaint(header + "0,-1,0,0,0\n"), "ends after 5 fields; expected 9"));
    EXPECT_TRUE(has(complaint(header + "0,-1,1,5,0,0,0,0,1,1\n"), "\"1\" is one field too many"));
    EXPECT_TRUE(has(complaint(header + "0.5,-1,0,0,0,0,0,1,1\n"), "ID is \"0.5\""));
    EXPECT_TRUE(has(complaint(header + good + "5,-1,0,0,0,0,0,1,1\n0,-1,0,0,0,0,0,1,1\n"),
                    "Line 4 of \"tree.csv\": the ID 0 is that of line 2 as well"));
    EXPECT_TRUE(has(complaint(header + good + "1,9,0,0,0,0,0,1,1\n"),
                    "Line 3 of \"tree.csv\": parentID is 9, but no cylinder has that ID"));
    EXPECT_TRUE(has(complaint(header + "5,5,0,0,0,0,0,1,1\n"), "Line 2"));
}

TEST(read_qsm, names_the_cylinders_of_a_cycle) {
    const std::string sentence = complaint(header + "0,-1,0,0,0,0,0,1,1\n"
                                                    "1,3,0,0,0,0,0,1,1\n"
                                                    "2,1,0,0,0,0,0,1,1\n"
                                                    "3,2,0,0,0,0,0,1,1\n"
                                                    "4,3,0,0,0,0,0,1,1\n");
    EXPECT_TRUE(has(sentence, "Line 3 of \"tree.csv\""));
    EXPECT_TRUE(has(sentence, "1 → 3 → 2 → 1"));
}

TEST(read_qsm, survives_binary_and_a_huge_line) {
    std::string binary(1000, '\0');
    for (std::size_t i = 0; i < binary.size(); ++i)
        binary[i] = static_cast<char>(i * 37 + 11);
    EXPECT_TRUE(has(complaint(binary), "of \"tree.csv\""));
    EXPECT_TRUE(has(complaint(header + std::string(20'000'000, 'x')), "ends after 1 fields"));
    EXPECT_LT(complaint(header + std::string(20'000'000, ',')).size(), 500u);
}

TEST(read_qsm, refuses_what_is_no_readable_file) {
    const auto sentence = [](const std::string& path) {
        const auto read = io::read_qsm(path);
        return read ? std::string() : read.error().message;
    };
    const std::string folder = std::filesystem::temp_directory_path().string();
    EXPECT_TRUE(has(sentence(folder), "is a directory; expected a file."));
    EXPECT_TRUE(has(sentence(folder + "/skybark_no_such.csv"), "can't be opened: No such file"));
    const temporary_file large("large.csv");
    std::error_code unsupported;
    std::filesystem::resize_file(large.path, (std::uintmax_t{4} << 30u) + 1, unsupported);
    if (!unsupported) { // sparse: takes no room
        EXPECT_TRUE(has(sentence(large.path.string()), "4294967297 bytes; expected at most 4 GiB"));
    }
}

TEST(read_qsm, reads_a_scanned_tree) {
    const char* folder = std::getenv("SKYBARK_TEST_DATA");
    const std::string scan = std::string(folder ? folder : "") + "/small_tree_qsm.csv";
    const temporary_file stand_in("sample.csv", support::qsm_text(support::sample_cylinders()));
    const bool real = folder != nullptr && std::filesystem::exists(scan);
    const auto read = io::read_tree(real ? scan : stand_in.path.string(), 1);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->front().base, glm::vec3(0));
    const auto skeleton = trees::build_skeleton(*read);
    ASSERT_TRUE(skeleton) << skeleton.error().message;
    if (real) { // counted in the file by other means
        EXPECT_EQ(skeleton->size(), 517u);
        EXPECT_NEAR(trees::height(*skeleton), 15.3, 0.1);
    }
}

TEST(read_qsm, reads_a_million_lines_in_seconds_slow) {
    std::string text = header;
    constexpr int count = 1'000'000;
    for (int i = count; i-- > 0;) // children first, so that IDs need sorting
        text += std::to_string(i) + "," + std::to_string(i - 1) + ",0,0," + std::to_string(i) +
                ",0,0," + std::to_string(i + 1) + ",0.1\n";
    const auto begin = std::chrono::steady_clock::now();
    const auto read = io::parse_qsm(text, "t");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->size(), static_cast<std::size_t>(count));
    EXPECT_LT(took.count(), 10.0);
}
