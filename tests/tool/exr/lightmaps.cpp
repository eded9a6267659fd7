// A lightmap and the mesh that it belongs to, put together again as a renderer does.

#include "../support.hpp"

#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <io/read_scene.hpp>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <sstream>

using namespace skybark::tests;

namespace {

constexpr std::size_t size = 128;

using tool_lightmaps = tool;

/// Red, in rows from the top.
std::vector<float> read_red(const std::string& path) {
    std::vector<float> red(size * size);
    Imf::InputFile file(path.c_str());
    Imf::FrameBuffer frame;
    frame.insert("R", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(red.data()), sizeof(float),
                                 sizeof(float) * size));
    file.setFrameBuffer(frame);
    file.readPixels(0, static_cast<int>(size) - 1);
    return red;
}

/// Bilinear lookup; v counts from the bottom, as in OBJ.
float look_up(const std::vector<float>& red, glm::vec2 at) {
    const glm::vec2 texel = glm::vec2(at.x, 1 - at.y) * static_cast<float>(size) - 0.5f;
    const glm::vec2 low = glm::floor(texel);
    float sum = 0;
    for (int n = 0; n < 4; ++n) {
        const float x = low.x + static_cast<float>(n % 2);
        const float y = low.y + static_cast<float>(n / 2);
        const float weight = (1 - std::abs(texel.x - x)) * (1 - std::abs(texel.y - y));
        if (weight > 0) {
            sum +=
                weight * red.at(static_cast<std::size_t>(y) * size + static_cast<std::size_t>(x));
        }
    }
    return sum;
}

} // namespace

TEST_F(tool_lightmaps, hold_the_light_of_their_places) {
    // A floor under a large lamp that hangs to one side.
    write_file(in_folder("a.mtl"), "newmtl floor\nKd 0 0 0\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
    write_file(in_folder("a.obj"), "mtllib a.mtl\nv 0 0 0\nv 0 0 2\nv 3 0 2\nv 3 0 0\nv 1 1 0.2\n"
                                   "v 3 1 0.5\nv 3 1 2\nv 1 1.5 2\nusemtl floor\nf 1 2 3 4\n"
                                   "usemtl lamp\nf 5 6 7\nf 5 7 8\n");
    const words directions{"--directions", "512"};
    words map{"gather",      in_folder("a.obj"), "-o", in_folder("a.exr"), "--lightmap", "128",
              "--unwrapped", in_folder("u.obj")};
    map.insert(map.end(), directions.begin(), directions.end());
    const outcome made = skybark(map);
    ASSERT_EQ(made.code, 0) << made.err;

    const auto mesh = skybark::io::read_scene(in_folder("u.obj"));
    ASSERT_TRUE(mesh) << mesh.error().message;
    ASSERT_EQ(mesh->triangles.size(), 4u);
    std::vector<glm::vec2> places;
    std::ofstream points(folder / "p.csv");
    points << "x,y,z,nx,ny,nz\n";
    for (std::size_t t = 0; t < 2; ++t) { // the floor
        const glm::uvec3 v = mesh->triangles[t];
        for (int i = 1; i < 10; ++i) {
            for (int k = 1; i + k < 10; ++k) {
                const glm::vec3 w(0.1f * static_cast<float>(i), 0.1f * static_cast<float>(k),
                                  0.1f * static_cast<float>(10 - i - k));
                const auto at = [&](const auto& of) {
                    return w.x * of[v.x] + w.y * of[v.y] + w.z * of[v.z];
                };
                places.push_back(at(mesh->coordinates));
                const glm::vec3 p = at(mesh->positions);
                points << p.x << ',' << p.y << ',' << p.z << ",0,1,0\n";
            }
        }
    }
    points.close();
    words table{"gather",           in_folder("a.obj"), "-o",
                in_folder("t.csv"), "--points",         in_folder("p.csv")};
    table.insert(table.end(), directions.begin(), directions.end());
    const outcome asked = skybark(table);
    ASSERT_EQ(asked.code, 0) << asked.err;

    // The same directions at nearly the same places: what differs is where each ray passes the
    // lamp's edge, for a few of 512 directions, of which each weighs up to 2π / 512.
    const std::vector<float> red = read_red(in_folder("a.exr"));
    std::istringstream lines(read_file(folder / "t.csv"));
    std::string line;
    std::getline(lines, line);
    double least = 1e9;
    double most = 0;
    double squares = 0;
    for (const glm::vec2 place : places) {
        ASSERT_TRUE(std::getline(lines, line));
        std::istringstream fields(line);
        std::string field;
        for (int i = 0; i < 7; ++i) {
            std::getline(fields, field, ',');
        }
        const double expected = std::stod(field);
        const double found = static_cast<double>(look_up(red, place));
        EXPECT_NEAR(found, expected, 0.08);
        squares += (found - expected) * (found - expected) / static_cast<double>(places.size());
        least = std::min(least, expected);
        most = std::max(most, expected);
    }
    EXPECT_LT(std::sqrt(squares), 0.025);
    EXPECT_GT(most, 3 * least) << "light differs from place to place";
}
