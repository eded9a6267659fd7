#include <io/write_glb.hpp>
#include <io/write_obj.hpp>
#include <io/write_ply.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

using namespace skybark;

namespace {

/// One triangle with numbers that are easy to get wrong.
const std::vector<surface_vertex> vertices{
    {{0.1f, -2e-7f, 3}, 0.25f, {0, 0, 1}, 1.5f, {1, 0, 0, 1}},
    {{1e6f, 0, -0.0f}, 0.5f, {0, 1, 0}, 17.25f, {0, 0, 1, -1}},
    {{1.0f / 3, 16777216, -7}, 1, {1, 0, 0}, 0, {0, 1, 0, 1}},
};
const std::vector<std::uint32_t> indices{2, 0, 1};

std::string written(const char* extension, const auto& write) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("skybark_write_mesh" + std::string(extension)))
            .string();
    const auto done = write(path);
    EXPECT_TRUE(done) << done.error().message;
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::filesystem::remove(path);
    return text;
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

} // namespace

TEST(write_obj, writes_the_shortest_numbers_that_read_back) {
    const std::string text = written(
        ".obj", [](const std::string& path) { return io::write_obj(path, vertices, indices); });
    EXPECT_EQ(text.substr(text.find('\n') + 1), "v 0.1 -2e-07 3\n"
                                                "v 1e+06 0 -0\n"
                                                "v 0.33333334 16777216 -7\n"
                                                "vt 0.25 1.5\n"
                                                "vt 0.5 17.25\n"
                                                "vt 1 0\n"
                                                "vn 0 0 1\n"
                                                "vn 0 1 0\n"
                                                "vn 1 0 0\n"
                                                "f 3/3/3 1/1/1 2/2/2\n");
}

TEST(write_obj, writes_more_than_its_buffer) {
    const std::vector<surface_vertex> many(100000, vertices[0]);
    const std::string text = written(
        ".obj", [&](const std::string& path) { return io::write_obj(path, many, indices); });
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 300002);
    EXPECT_EQ(text.substr(text.size() - 20), "f 3/3/3 1/1/1 2/2/2\n");
}

TEST(write_ply, writes_records_of_the_size_that_it_says) {
    const std::string bytes = written(
        ".ply", [](const std::string& path) { return io::write_ply(path, vertices, indices); });
    const std::size_t at = bytes.find("end_header\n") + 11;
    ASSERT_EQ(bytes.size(), at + 3 * 32 + 13);
    EXPECT_EQ(value_at<float>(bytes, at), 0.1f);
    EXPECT_EQ(value_at<float>(bytes, at + 32), 1e6f);
    EXPECT_EQ(value_at<float>(bytes, at + 32 + 28), 17.25f) << "t";
    EXPECT_EQ(bytes[at + 96], 3);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, at + 97), 2u);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, at + 105), 1u);
}

TEST(write_glb, writes_what_gltf_wants) {
    const std::string bytes = written(
        ".glb", [](const std::string& path) { return io::write_glb(path, vertices, indices); });
    ASSERT_GT(bytes.size(), 20u);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), bytes.size());
    const std::size_t text = value_at<std::uint32_t>(bytes, 12);
    const auto gltf = nlohmann::json::parse(bytes.substr(20, text), nullptr, false);
    ASSERT_TRUE(gltf.is_object());
    const std::size_t binary = 20 + text + 8;
    const auto& primitive = gltf["meshes"][0]["primitives"][0];
    const auto offset_of = [&](const nlohmann::json& accessor) {
        const auto& view =
            gltf["bufferViews"]
                [gltf["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
        return binary + view.value("byteOffset", std::size_t{0});
    };
    const auto& positions =
        gltf["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_EQ(positions["min"][1].get<float>(), -2e-7f);
    EXPECT_EQ(positions["max"][0].get<float>(), 1e6f);
    EXPECT_EQ(positions["count"], 3);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["POSITION"]) + 24),
              1.0f / 3);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["TANGENT"]) + 28), -1.0f);
    EXPECT_EQ(value_at<float>(bytes, offset_of(primitive["attributes"]["TEXCOORD_0"]) + 4), -0.5f)
        << "1 - v";
    EXPECT_EQ(value_at<std::uint32_t>(bytes, offset_of(primitive["indices"])), 2u);
    const auto& pbr = gltf["materials"][0]["pbrMetallicRoughness"];
    EXPECT_EQ(pbr["baseColorFactor"].size(), 4u);
    EXPECT_EQ(pbr.value("metallicFactor", 1.0), 0.0);
}

TEST(write_glb, has_no_mesh_without_triangles) {
    const auto done = io::write_glb("/nowhere/a.glb", {}, {});
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("without triangles"), std::string::npos);
}
