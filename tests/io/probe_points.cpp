#include "support/temporary_name.hpp"

#include <io/probe_points.hpp>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>

using namespace skybark;

namespace {

struct temporary_path {
    explicit temporary_path(const std::string& name)
        : path(support::temporary_name(name).string()) {}
    temporary_path(const temporary_path&) = delete;
    temporary_path& operator=(const temporary_path&) = delete;
    ~temporary_path() { std::filesystem::remove(path); }
    [[nodiscard]] std::string text() const {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::string path;
};

} // namespace

TEST(probe_points, are_read_by_name) {
    const auto read = io::parse_points("name,z,y,x\na,3,2,1\nb,-6,5,4e3\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, (std::vector<glm::vec3>{{1, 2, 3}, {4000, 5, -6}}));
}

TEST(probe_points, are_refused_with_file_line_and_value) {
    for (const auto& [text, part] :
         {std::pair{"", "\"p.csv\" is empty; expected a table of points with the columns x, y and "
                        "z."},
          std::pair{"x,y,z\n", "Line 1 of \"p.csv\": there are no points"},
          std::pair{"x,y\n1,2\n", "there is no column \"z\""},
          std::pair{"x,y,z\n0,0,0\n0,nan,0\n", "Line 3 of \"p.csv\": y is \"nan\""},
          std::pair{"x,y,z\n0,0\n", "ends after 2 fields; expected 3"}}) {
        const auto read = io::parse_points(text, "p.csv");
        ASSERT_FALSE(read) << text;
        EXPECT_NE(read.error().message.find(part), std::string::npos) << read.error().message;
    }
}

TEST(probe_points, are_written_with_all_their_digits) {
    const temporary_path file("written.csv");
    const glm::vec3 points[] = {{0.1f, -2, 1e7f}, {1.0f / 3, 0, -0.0f}};
    const io::probed_light light[] = {{7.5f, 0.25f}, {1e-20f, std::numeric_limits<float>::min()}};
    ASSERT_TRUE(io::write_probes(file.path, points, light));
    EXPECT_EQ(file.text(), "x,y,z,optical_depth,light\n"
                           "0.1,-2,1e+07,7.5,0.25\n"
                           "0.33333334,0,-0,1e-20,1.1754944e-38\n");
    const auto again = io::read_points(file.path);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(*again, std::vector<glm::vec3>(std::begin(points), std::end(points)));
}

TEST(probe_points, are_written_block_by_block) {
    const temporary_path file("blocks.csv");
    std::vector<glm::vec3> points(200'000);
    std::vector<io::probed_light> light(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = glm::vec3(static_cast<float>(i) / 7, 1.0f / 3, 2.0f / 3);
    ASSERT_TRUE(io::write_probes(file.path, points, light));
    const auto again = io::read_points(file.path);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(*again, points);
}

TEST(probe_points, leave_no_file_where_none_can_be_written) {
    const auto written = io::write_probes("/no/such/folder/a.csv", {}, {});
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("/no/such/folder"), std::string::npos);
}
