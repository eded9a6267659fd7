#include <io/read_mtg.hpp>

#include <skybark/trees/build_skeleton.hpp>

#include <gtest/gtest.h>

using namespace skybark;

namespace {

const std::string header = "CODE :\tFORM-A\n"
                           "\n"
                           "CLASSES:\n"
                           "SYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n"
                           "$\t0\tFREE\tFREE\tIMPLICIT\n"
                           "P\t1\tFREE\tFREE\tEXPLICIT\n"
                           "A \t2\tFREE\tFREE\tEXPLICIT\n"
                           "S\t3\tFREE\tFREE\tEXPLICIT\n"
                           "\n"
                           "DESCRIPTION :\n"
                           "LEFT\tRIGHT\tRELTYPE\tMAX\n"
                           "S\tS\t+\t?\n"
                           "\n"
                           "FEATURES:\n"
                           "NAME\tTYPE\n"
                           "Note\tSTRING\n"
                           "XX\tREAL\n"
                           "YY\tREAL\n"
                           "ZZ\tREAL\n"
                           "TopDia\tREAL\n"
                           "\n"
                           "MTG:\n"
                           "\n";
const std::string columns = "ENTITY-CODE\t\t\tNote\tXX\tYY\tZZ\tTopDia\n";

std::vector<trees::segment> read(const std::string& entities, io::mtg_units units = {}) {
    auto segments = io::parse_mtg(header + columns + entities, "plant.mtg", units);
    EXPECT_TRUE(segments) << segments.error().message;
    return segments ? *std::move(segments) : std::vector<trees::segment>{};
}

std::string complaint(const std::string& text) {
    const auto segments = io::parse_mtg(text, "plant.mtg");
    return segments ? std::string() : segments.error().message;
}

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

constexpr std::size_t header_lines = 24; ///< the first entity stands on the next line

std::string at_line(std::size_t entity) {
    return "Line " + std::to_string(header_lines + entity) + " of \"plant.mtg\"";
}

} // namespace

TEST(read_mtg, reads_an_axis_that_bears_another) {
    const auto s = read("/P1\n"
                        "^/A1\t\t\tfoot\t1\t2\t0\t0.4\n"
                        "^/S1\t\t\t\t1\t2\t3\t0.2\n"
                        "\t+A2\n"
                        "\t^/S1\t\t\t2\t2\t4\t0.1\n"
                        "\t^<S2\t\t\t3\t2\t4\t0.05\n"
                        "^<S2\t\t\t\t1\t2\t5\t\n");
    ASSERT_EQ(s.size(), 4u);
    EXPECT_EQ(s[0].base, glm::vec3(1, 0, -2)) << "where the axis says it begins";
    EXPECT_EQ(s[0].tip, glm::vec3(1, 3, -2));
    EXPECT_FLOAT_EQ(s[0].base_radius, 0.2f);
    EXPECT_FLOAT_EQ(s[0].radius, 0.1f);
    EXPECT_EQ(s[0].parent, trees::none);
    EXPECT_EQ(s[1].parent, 0u);
    EXPECT_EQ(s[1].base, s[0].tip);
    EXPECT_EQ(s[1].tip, glm::vec3(2, 4, -2));
    EXPECT_EQ(s[2].parent, 1u);
    EXPECT_EQ(s[3].parent, 0u) << "^ goes on in its own column";
    EXPECT_EQ(s[3].base, s[0].tip);
    EXPECT_FLOAT_EQ(s[3].radius, 0.1f) << "not given: as before";
    EXPECT_TRUE(trees::build_skeleton(s));
}

TEST(read_mtg, nests_by_columns_without_a_caret) {
    const auto s = read("/P1\n"
                        "\t/A1\n"
                        "\t\t/S1\t\t0\t0\t1\t2\n"
                        "\t\t^<S2\t\t0\t0\t2\t2\n"
                        "\t\t^+A2/S1\t\t1\t0\t2\t1\n"
                        "\t\t^<S2\t\t2\t0\t2\t1\n");
    ASSERT_EQ(s.size(), 4u);
    EXPECT_EQ(s[0].base, s[0].tip) << "nothing says where it begins";
    EXPECT_EQ(s[1].parent, 0u);
    EXPECT_EQ(s[2].parent, 1u);
    EXPECT_EQ(s[3].parent, 2u);
}

TEST(read_mtg, passes_over_entities_without_coordinates) {
    const auto s = read("/P1/A1/S1\t\t\t\t0\t0\t0\t1\n"
                        "^<S2<<S9\t\t\t\t0\t0\t9\t1\n"
                        "^<S10\n"
                        "\t+A1/S1<.<S5\t\t\t1\t0\t9\t0.5\n"
                        "^<S11\t\t\t\t0\t0\t11\t1\n");
    ASSERT_EQ(s.size(), 4u);
    EXPECT_EQ(s[1].tip, glm::vec3(0, 9, 0));
    EXPECT_EQ(s[2].parent, 1u);
    EXPECT_EQ(s[3].parent, 1u);
    EXPECT_EQ(s[3].base, s[1].tip);
}

TEST(read_mtg, keeps_the_base_of_an_axis_until_wood_is_placed) {
    const auto s = read("/P1/A1/S1\t\t\t\t0\t0\t1\t1\n"
                        "\t+A2\t\t\t0.5\t0\t1\t0.2\n"
                        "\t^/S1\n"
                        "\t^<S2\t\t\t2\t0\t1\t0.1\n");
    ASSERT_EQ(s.size(), 2u);
    EXPECT_EQ(s[1].base, glm::vec3(0.5f, 1, 0));
    EXPECT_FLOAT_EQ(s[1].base_radius, 0.1f);
    EXPECT_EQ(s[1].parent, 0u);
}

TEST(read_mtg, converts_units) {
    const auto s = read("/P1/A1/S1\t\t\t\t100\t0\t200\t30\n", {0.01, 0.001});
    ASSERT_EQ(s.size(), 1u);
    EXPECT_FLOAT_EQ(s[0].tip.x, 1);
    EXPECT_FLOAT_EQ(s[0].tip.y, 2);
    EXPECT_FLOAT_EQ(s[0].radius, 0.015f);
}

TEST(read_mtg, several_plants_comments_and_crlf) {
    std::string text = header + columns +
                       "/P1/A1/S1\t\t\t\t0\t0\t1\t1 # comment\n"
                       "/P2/A1/S1\t\t\t# ignored\t5\t0\t1\t1\n"
                       "\t# a line of comment\n";
    for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2)
        text.insert(i, 1, '\r');
    const auto s = io::parse_mtg("\xef\xbb\xbf" + text, "t");
    ASSERT_TRUE(s) << s.error().message;
    ASSERT_EQ(s->size(), 2u);
    EXPECT_EQ((*s)[1].parent, trees::none);
    EXPECT_EQ((*s)[1].tip.x, 5.0f);
}

TEST(read_mtg, names_the_line_of_a_bad_entity) {
    const std::string start = header + columns;
    const std::string root = "/P1/A1/S1\t\t\t\t0\t0\t1\t1\n";
    const auto second = [&](const std::string& line) { return complaint(start + root + line); };
    EXPECT_TRUE(has(second("^<Q2\n"), at_line(2)));
    EXPECT_TRUE(has(second("^<Q2\n"), "has the label \"Q2\"; expected the symbol of a class"));
    EXPECT_TRUE(has(second("^*S2\n"), "expected \"/\", \"<\" or \"+\" there"));
    EXPECT_TRUE(has(second("*\n"), "begins a plant"));
    EXPECT_TRUE(has(second("(A1)/S2\n"), "begins a plant"));
    EXPECT_TRUE(has(second("^<S2\t\t\t\t0\tzwei\t1\t1\n"), "\"zwei\"; expected a finite number"));
    EXPECT_TRUE(has(second("^<S2\t\t\t\t0\tnan\t1\t1\n"), "\"nan\"; expected a finite number"));
    EXPECT_TRUE(has(second("^<S2\t\t\t\t0\t1e30\t1\t1\n"), "\"1e30\"; expected a finite number"));
    EXPECT_TRUE(has(second("^<S2\t\t\t\t0\t0\t1\t-1\n"), "\"-1\"; expected zero or more"));
    EXPECT_TRUE(has(second("^<S2\t\t\t\t0\t\t1\t1\n"), "has 2 of the coordinates"));
    EXPECT_TRUE(has(second("^<S2\t+S3\n"), "there are two codes, \"^<S2\" and \"+S3\""));
    EXPECT_TRUE(has(second("\t\t+S3\n"), "column 2, where there is nothing above it"));
    EXPECT_TRUE(has(second("^/S2\n"), "expected a finer scale"));
    EXPECT_TRUE(has(second("/P1/A1/S1<S2\n"), "begins the plant \"P1\" again"));
    EXPECT_TRUE(has(second("^<S2<<A9\n"), "expected the same class at both ends"));
    EXPECT_TRUE(has(second("^\n"), "is incomplete"));
    EXPECT_TRUE(has(second("\t\t\t\t5\n"), "the value \"5\" without a code"));
    EXPECT_TRUE(has(complaint(start + "/P1/A1/S1\t\t\t\t0\t0\t1\t\n"), "no thickness"));
    EXPECT_TRUE(has(complaint(start + "/P1<S1\n"), "expected the same or a coarser scale"));
    EXPECT_TRUE(has(complaint(start + "/P1\n"), "no entity of the finest scale, 3"));
}

TEST(read_mtg, names_the_line_of_a_bad_header) {
    EXPECT_TRUE(has(complaint(""), "\"plant.mtg\" is empty"));
    EXPECT_TRUE(has(complaint("hello\n"), "Line 1 of \"plant.mtg\": \"hello\" stands before"));
    EXPECT_TRUE(has(complaint("CODE:\tFORM-B\n"), "the code's form is \"FORM-B\""));
    EXPECT_TRUE(has(complaint("CODE:\tFORM-A\nMTG:\n"), "a section begins out of turn"));
    EXPECT_TRUE(has(complaint(header.substr(0, 200)), "ends before the section MTG"));
    EXPECT_TRUE(has(complaint(header + "ENTITY-CODE\tXX\tYY\n"), "there are no columns XX, YY"));
    EXPECT_TRUE(has(complaint(header + "ENTITY-CODE\tXX\tYY\tZZ\n"), "there is no column TopDia"));
    EXPECT_TRUE(has(complaint(header + "ENTITY-CODE\tXX\tXX\n"), "says again"));
    EXPECT_TRUE(has(complaint(header + "ENTITY-CODE\tLength\n"), "isn't one of the features"));
    EXPECT_TRUE(has(complaint(header + "CODES\tXX\n"), "begin with \"CODES\""));
    EXPECT_TRUE(has(complaint("CODE:\tFORM-A\nCLASSES:\nS1\t3\n"), "symbol is \"S1\""));
    EXPECT_TRUE(has(complaint("CODE:\tFORM-A\nCLASSES:\nS\tdrei\n"), "is \"drei\"; expected"));
    EXPECT_TRUE(has(complaint("CODE:\tFORM-A\nCLASSES:\nS\t3\nS\t2\n"), "above; expected one"));
    const std::string binary("\x7f"
                             "ELF\0\1\2\xff",
                             8);
    EXPECT_TRUE(has(complaint(binary), "Line 1"));
}
