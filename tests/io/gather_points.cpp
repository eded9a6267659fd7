// Points that ask for light, and what is written about them.

#include "support/temporary_name.hpp"

#include <io/gather_points.hpp>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <iterator>

using namespace skybark;

namespace {

std::string temporary(const std::string& name) { return support::temporary_name(name).string(); }

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string complaint(std::string_view text) {
    const auto read = io::parse_gather_points(text, "points.csv");
    return read ? std::string() : read.error().message;
}

gather_sample sample(glm::vec3 position, glm::vec3 normal) {
    gather_sample s;
    s.position = position;
    s.normal = normal;
    return s;
}

} // namespace

TEST(gather_points, are_read) {
    const auto read =
        io::parse_gather_points("nx,ny,nz,name,x,y,z\n0,0,-2,a,1,2,3\n1e-9,0,0,b,-1,0,1e9\n", "t");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 2u);
    EXPECT_EQ((*read)[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ((*read)[0].normal, glm::vec3(0, 0, -1));
    EXPECT_EQ((*read)[1].normal, glm::vec3(1, 0, 0));
}

TEST(gather_points, are_refused) {
    const std::string header = "x,y,z,nx,ny,nz\n";
    EXPECT_NE(complaint(header + "0,0,0,0,1,0\n0,0,0,0,0,0\n").find("0,0,0 at its point 2"),
              std::string::npos);
    EXPECT_NE(complaint(header + "0,nan,0,0,1,0\n").find("\"nan\""), std::string::npos);
    EXPECT_NE(complaint("x,y,z\n0,0,0\n").find("nx"), std::string::npos);
    EXPECT_NE(complaint(header).find("points"), std::string::npos);
    EXPECT_NE(complaint("").find("points.csv"), std::string::npos);
    EXPECT_FALSE(io::read_gather_points("/nowhere/points.csv"));
}

TEST(gather_points, are_written_and_read_back) {
    const std::vector<gather_sample> points{sample({0.1f, 1e-20f, -3}, {0, 1, 0}),
                                            sample({1, 2, 3}, glm::normalize(glm::vec3(1, 2, 3)))};
    const std::vector<glm::vec4> light{{0.3f, 1e9f, 0, 0.125f}, {1, 2, 3, 4}};
    const std::string path = temporary("table.csv");
    ASSERT_TRUE(io::write_gathered(path, points, light));
    const std::string text = bytes_of(path);
    EXPECT_EQ(text.substr(0, text.find('\n')), "x,y,z,nx,ny,nz,r,g,b,error");
    EXPECT_NE(text.find("0.1,1e-20,-3,0,1,0,0.3,1e+09,0,0.125\n"), std::string::npos) << text;
    const auto back = io::read_gather_points(path);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ((*back)[1].position, points[1].position);
    std::filesystem::remove(path);
    EXPECT_FALSE(io::write_gathered("/nowhere/a.csv", points, light));
}

TEST(gather_points, become_coloured_meshes) {
    const std::vector<gather_sample> points{
        sample({0, 0, 0}, {0, 1, 0}), sample({1, 0, 0}, {0, 1, 0}), sample({0, 0, 1}, {0, 1, 0})};
    const std::vector<glm::vec4> light{{2, 1, 0, 0.5f}, {4, 2, 2, 0}, {0.2140411f, 0, 0, 0}};
    const std::vector<glm::uvec3> triangles{{0, 2, 1}};
    const std::string path = temporary("mesh.ply");
    ASSERT_TRUE(io::write_gathered_ply(path, points, light, 2, triangles));
    const std::string bytes = bytes_of(path);
    std::filesystem::remove(path);
    const std::size_t body = bytes.find("end_header\n") + 11;
    EXPECT_NE(bytes.find("element vertex 3\n"), std::string::npos);
    EXPECT_NE(bytes.find("property float error\nproperty uchar red\n"), std::string::npos);
    EXPECT_NE(bytes.find("element face 1\n"), std::string::npos);
    ASSERT_EQ(bytes.size() - body, 3 * 43u + 13u);
    std::array<float, 10> floats{};
    std::memcpy(floats.data(), bytes.data() + body, sizeof floats);
    EXPECT_EQ(floats, (std::array<float, 10>{0, 0, 0, 0, 1, 0, 2, 1, 0, 0.5f}));
    const auto colour = [&](std::size_t point, std::size_t c) {
        return static_cast<unsigned char>(bytes[body + 43 * point + 40 + c]);
    };
    EXPECT_EQ(colour(0, 0), 255);
    EXPECT_EQ(colour(0, 1), 188) << "a half, by the sRGB curve";
    EXPECT_EQ(colour(0, 2), 0);
    EXPECT_EQ(colour(1, 0), 255) << "brighter than white";
    EXPECT_NEAR(colour(2, 0), 92, 1) << "0.107";
    std::array<std::uint32_t, 3> corners{};
    EXPECT_EQ(bytes[body + 3 * 43], 3);
    std::memcpy(corners.data(), bytes.data() + body + 3 * 43 + 1, sizeof corners);
    EXPECT_EQ(corners, (std::array<std::uint32_t, 3>{0, 2, 1}));
    ASSERT_TRUE(io::write_gathered_ply(path, points, light, 0, {}));
    EXPECT_EQ(bytes_of(path).find("element face"), std::string::npos);
    std::filesystem::remove(path);
}
