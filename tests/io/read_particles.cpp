#include "support/temporary_name.hpp"

#include <io/read_particles.hpp>

#include <io/number_table.hpp>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

const std::string header = "x,y,z,radius,optical_depth,albedo\n";

/// The sentence that `text` gets; empty if it is read.
std::string complaint(std::string_view text) {
    const auto read = io::parse_particles(text, "cloud.csv");
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

TEST(read_particles, reads_what_is_there) {
    const auto read = io::parse_particles(header + "1.5,-2,3e2,0.25,4,0.5\n0,0,0,1,0,1\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 2u);
    const cloud_particle& p = read->front();
    EXPECT_EQ(p.position, glm::vec3(1.5f, -2, 300)) << "as the file has it: nothing is turned";
    EXPECT_EQ(p.radius, 0.25f);
    EXPECT_EQ(p.optical_depth, 4.0f);
    EXPECT_EQ(p.albedo, 0.5f);
    EXPECT_EQ(read->back().optical_depth, 0.0f);
}

TEST(read_particles, finds_columns_by_name_in_any_order) {
    const std::string text = "\xef\xbb\xbf# made by hand\r\n"
                             "\r\n"
                             "albedo;\"name\";radius; z;y ;x;optical_depth\r\n"
                             "  # a comment; between\r\n"
                             "0.9;\"a;b\";7;3;2;1;6\r\n"
                             "\r\n"
                             "0.8;c;70;30;20;10;60";
    std::string tabs = text;
    for (char& c : tabs)
        c = c == ';' ? '\t' : c;
    for (const std::string& each : {text, tabs}) {
        const auto read = io::parse_particles(each, "t");
        ASSERT_TRUE(read) << read.error().message;
        ASSERT_EQ(read->size(), 2u);
        EXPECT_EQ((*read)[0].position, glm::vec3(1, 2, 3));
        EXPECT_EQ((*read)[1].radius, 70.0f);
        EXPECT_EQ((*read)[1].optical_depth, 60.0f);
        EXPECT_EQ((*read)[1].albedo, 0.8f);
    }
}

TEST(read_particles, knows_columns_in_any_letter_case) {
    const auto read =
        io::parse_particles("X,y,Z,Radius,OPTICAL_DEPTH,aLbEdO\n1,2,3,4,5,0.5\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 1u);
    EXPECT_EQ((*read)[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ((*read)[0].radius, 4.0f);
    EXPECT_EQ((*read)[0].optical_depth, 5.0f);
    EXPECT_EQ((*read)[0].albedo, 0.5f);
    EXPECT_TRUE(has(complaint("x,X,y,z,radius,optical_depth,albedo\n"), "\"X\" is there twice"));
}

TEST(read_particles, takes_a_text_in_pieces_of_any_length) {
    const std::string text = "# c\n" + header + "1,2,3,4,5,0.5\n\n6,7,8,9,10,1";
    const io::table_column columns[] = {{"radius", 0, 1e9, "a number"}, {"z", 0, 1e9, "a number"}};
    for (std::size_t length = 1; length <= text.size(); ++length) {
        std::vector<double> seen;
        io::number_table table("t", "rows", columns, [&](std::span<const double> row) {
            seen.insert(seen.end(), row.begin(), row.end());
        });
        for (std::size_t from = 0; from < text.size(); from += length)
            ASSERT_TRUE(table.take(std::string_view(text).substr(from, length)));
        ASSERT_TRUE(table.finish());
        EXPECT_EQ(seen, (std::vector<double>{4, 3, 9, 8})) << length;
    }
}

TEST(read_particles, names_file_line_and_value) {
    const std::string good = "0,0,0,1,2,1\n";
    EXPECT_TRUE(has(complaint(""), "\"cloud.csv\" is empty; expected a table of particles with the "
                                   "columns x, y, z, radius, optical_depth and albedo."));
    EXPECT_TRUE(has(complaint("\n \n# no more\n"), "\"cloud.csv\" is empty"));
    EXPECT_TRUE(has(complaint(header), "Line 1 of \"cloud.csv\": there are no particles"));
    EXPECT_TRUE(has(complaint("x,y,z,radius,albedo\n0,0,0,1,1\n"),
                    "Line 1 of \"cloud.csv\": there is no column \"optical_depth\""));
    EXPECT_TRUE(has(complaint("x," + header + good), "\"x\" is there twice"));
    const char* columns[] = {"x", "y", "z", "radius", "optical_depth", "albedo"};
    for (std::size_t c = 0; c < 6; ++c) {
        for (const char* bad : {"nan", "NaN", "-nan", "inf", "-inf", "1e999", "1e30", "", "1x",
                                "0x10", "1 2", "-1.0000001e9"}) {
            std::string row;
            for (std::size_t i = 0; i < 6; ++i)
                row += (i == 0 ? "" : ",") + std::string(i == c ? bad : "1");
            const std::string sentence = complaint(header + good + row + "\n");
            EXPECT_TRUE(has(sentence, "Line 3 of \"cloud.csv\": " + std::string(columns[c]) +
                                          " is \"" + bad + "\"; expected a "));
        }
    }
    EXPECT_TRUE(has(complaint(header + "0,0,0,-0.5,2,1\n"), "radius is \"-0.5\"; expected a number "
                                                            "of metres from 1e-6 to 1e9."));
    EXPECT_TRUE(has(complaint(header + "0,0,0,0,2,1\n"), "radius is \"0\""));
    EXPECT_TRUE(has(complaint(header + "0,0,0,1e-60,2,1\n"), "radius is \"1e-60\""));
    EXPECT_TRUE(has(complaint(header + "0,0,0,1,-2,1\n"),
                    "optical_depth is \"-2\"; expected a number from 0 to 1e6."));
    EXPECT_TRUE(has(complaint(header + "0,0,0,1,2,1.01\n"),
                    "albedo is \"1.01\"; expected a number from 0 to 1."));
    EXPECT_TRUE(has(complaint(header + "0,0,0,1,2,-0.01\n"), "albedo is \"-0.01\""));
    EXPECT_TRUE(has(complaint(header + good + "0,0,0,1"),
                    "Line 3 of \"cloud.csv\": \"0,0,0,1\" ends after 4 fields; expected 6"));
    EXPECT_TRUE(has(complaint(header + "0,0,0,1,2,1,7\n"), "\"7\" is one field too many"));
    EXPECT_EQ(complaint(header + "0,0,0,1,2,1,\n"), "") << "a comma at the end of the line";
}

TEST(read_particles, survives_binary_and_a_huge_line) {
    std::string binary(1000, '\0');
    for (std::size_t i = 0; i < binary.size(); ++i)
        binary[i] = static_cast<char>(i * 37 + 11);
    EXPECT_TRUE(has(complaint(binary), "of \"cloud.csv\""));
    for (const char* each : {"x", ","}) {
        std::string text = header;
        for (int i = 0; i < 20'000'000; ++i)
            text += each;
        EXPECT_TRUE(has(complaint(text), "Line 2 of \"cloud.csv\""));
        EXPECT_LT(complaint(text).size(), 500u);
    }
}

TEST(read_particles, refuses_what_is_no_readable_file) {
    const auto sentence = [](const std::string& path) {
        const auto read = io::read_particles(path);
        return read ? std::string() : read.error().message;
    };
    const std::string folder = std::filesystem::temp_directory_path().string();
    EXPECT_TRUE(has(sentence(folder), "is a directory; expected a file."));
    EXPECT_TRUE(has(sentence(folder + "/skybark_no_such.csv"), "can't be opened: No such file"));
    const temporary_file empty("empty.csv");
    EXPECT_TRUE(has(sentence(empty.path.string()), "is empty"));
    const temporary_file cut("cut.csv", header + "0,0,0,1,2,1\n0,0,0,1");
    EXPECT_TRUE(has(sentence(cut.path.string()), "Line 3"));
}

TEST(read_particles, reads_a_file_of_several_blocks) {
    std::string text = header;
    constexpr int count = 100'000; // 2 MB: a line lies across the end of a block
    for (int i = 0; i < count; ++i)
        text += std::to_string(i) + ",0.25,-3,1.5,0.5,0.875\n";
    const temporary_file file("blocks.csv", text);
    const auto read = io::read_particles(file.path.string());
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < read->size(); ++i) {
        const cloud_particle& p = (*read)[i];
        ASSERT_EQ(p.position, glm::vec3(static_cast<float>(i), 0.25f, -3));
        ASSERT_EQ(p.albedo, 0.875f);
    }
}

TEST(read_particles, reads_ten_million_lines_in_seconds_slow) {
    std::string text = header;
    constexpr int count = 10'000'000;
    for (int i = 0; i < count; ++i)
        text += std::to_string(i) + ",1.25,2.5,10,0.5,1\n";
    const temporary_file file("many.csv", text);
    const auto begin = std::chrono::steady_clock::now();
    const auto read = io::read_particles(file.path.string());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->size(), static_cast<std::size_t>(count));
    EXPECT_LT(took.count(), 30.0);
}
