// Scenes from Wavefront files.

#include "scene_files.hpp"

#include <io/cut_polygon.hpp>
#include <io/write_png.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

using namespace skybark;

namespace {

class read_obj_scene : public tests::scene_files {
  protected:
    void expect_line_refused(const std::string& line, const std::vector<std::string>& parts) {
        write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n" + line + "\nf 1 2 3\n");
        auto all = parts;
        all.insert(all.end(), {"Line 6 of", "a.obj", "expected"});
        expect_refused("a.obj", all);
    }
    /// A material of these lines.
    io::scene_material material(const std::string& lines) {
        write("m.mtl", "newmtl m\n" + lines);
        write("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        const io::triangle_scene scene = read("m.obj");
        return scene.materials.empty() ? io::scene_material() : scene.materials.front();
    }
    void expect_material_refused(const std::string& lines, std::vector<std::string> parts) {
        write("m.mtl", "newmtl m\n" + lines);
        write("m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        parts.emplace_back("m.mtl");
        expect_refused("m.obj", parts);
    }
};

void expect_near(glm::vec3 a, glm::vec3 b) {
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
    EXPECT_NEAR(a.z, b.z, 1e-6);
}

/// Twice the area of a polygon in the plane z = 0, by the shoelace formula.
double twice_area(const std::vector<glm::vec3>& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec3 a(p[i]);
        const glm::dvec3 b(p[(i + 1) % p.size()]);
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

} // namespace

TEST_F(read_obj_scene, reads_what_is_there) {
    write("a.mtl", "newmtl red wall\nKd 0.8 0.1 0.2\nNs 10\nillum 2\n\nnewmtl lamp\nKd 0 0 0\n"
                   "Ke 12 13 14\n");
    write("a.obj", "# a comment\nmtllib a.mtl\r\no box\nv 0 0 0\r\nv 1 0 0 1\nv 1 1 0 0.5 0.5 0.5\n"
                   "v 0 1 0\nvt 0.25\nvt 0.5 0.75 0\nvn 0 0 2\ns off\nusemtl red wall\n"
                   "f 1/1/1 2/2/1 3/1/1 4/1/1\nusemtl lamp\nf -4//-1 -3//-1 \\\n -2//-1\nf 1 2 3");
    const io::triangle_scene scene = read("a.obj");
    ASSERT_EQ(scene.triangles.size(), 4u);
    ASSERT_EQ(scene.material_of, (std::vector<std::uint32_t>{0, 0, 1, 1}));
    // Four corners with texture, three without, three without a normal.
    EXPECT_EQ(scene.positions.size(), 10u);
    EXPECT_EQ(scene.positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.coordinates[0], glm::vec2(0.25f, 0));
    EXPECT_EQ(scene.coordinates[1], glm::vec2(0.5f, 0.75f));
    EXPECT_EQ(scene.normals[0], glm::vec3(0, 0, 1)) << "made unit";
    EXPECT_EQ(scene.normals[9], glm::vec3(0)) << "absent";
    EXPECT_EQ(scene.positions[scene.triangles[2].z], glm::vec3(1, 1, 0));
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[0].name, "red wall");
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.8f, 0.1f, 0.2f));
    EXPECT_FALSE(scene.materials[0].two_sided);
    EXPECT_EQ(scene.materials[1].emission, glm::vec3(12, 13, 14));
}

TEST_F(read_obj_scene, is_grey_without_materials) {
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const io::triangle_scene scene = read("a.obj");
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.5f));
    EXPECT_EQ(scene.materials[0].emission, glm::vec3(0));
}

TEST_F(read_obj_scene, names_a_bad_line) {
    expect_line_refused("v 1 nan 2", {"\"nan\"", "1e9 metres"});
    expect_line_refused("v 1 inf 2", {"\"inf\""});
    expect_line_refused("v 1 2e9 2", {"\"2e9\""});
    expect_line_refused("v 1 2", {"too few numbers"});
    expect_line_refused("v 1,5 2 3", {"\"1,5\""});
    expect_line_refused("vt", {"too few numbers"});
    expect_line_refused("vn 0 1", {"too few numbers"});
    expect_line_refused("f 1 2 4", {"vertex 4", "of the 3 before it"});
    expect_line_refused("f 1 2 -4", {"vertex -4"});
    expect_line_refused("f 1 2 0", {"\"0\""});
    expect_line_refused("f 1/2 2 3", {"texture coordinate 2", "of the 1 before it"});
    expect_line_refused("f 1//2 2 3", {"normal 2"});
    expect_line_refused("f 1 2 x", {"\"x\""});
    expect_line_refused("f 1/1/1/1 2 3", {"more than three"});
    expect_line_refused("f 1 2", {"2 corners", "three at least"});
    expect_line_refused("f", {"0 corners"});
    expect_line_refused("usemtl none", {"\"none\"", "mtllib"});
    expect_line_refused("mtllib gone.mtl", {"gone.mtl", "no file"});
    expect_line_refused("\x01\x02", {"\\x01\\x02", "no statement"});
}

TEST_F(read_obj_scene, names_a_bad_file) {
    expect_refused("gone.obj", {"gone.obj", "can't be opened"});
    write("a.ply", "ply");
    expect_refused("a.ply", {"a.ply", ".obj", ".glb"});
    write("a.obj", "");
    expect_refused("a.obj", {"a.obj", "no triangles"});
    write("a.obj", "v 0 0 0\nv 1 0 0\n");
    expect_refused("a.obj", {"no triangles"});
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2");
    expect_refused("a.obj", {"Line 5", "2 corners"});
    std::filesystem::create_directory(folder / "d.obj");
    expect_refused("d.obj", {"directory"});
    write("b.mtl", "newmtl m\n");
    write("b.obj", "mtllib b.mtl\nusemtl n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_refused("b.obj", {"Line 2", "\"n\"", "b.mtl"});
}

TEST_F(read_obj_scene, lets_light_through) {
    const auto half = material("Kd 0.5 0.5 0.5\nd 0.25\n");
    expect_near(half.diffuse, glm::vec3(0.125f));
    expect_near(half.transmission, glm::vec3(0.75f));
    EXPECT_TRUE(half.two_sided);
    const auto leaf = material("Kd 0.1 0.4 0.1\nTf 0.1 0.3 0\nillum 4\n");
    expect_near(leaf.transmission, {0.1f, 0.3f, 0});
    expect_near(leaf.diffuse, {0.1f, 0.4f, 0.1f});
    EXPECT_TRUE(leaf.two_sided);
    const auto wall = material("Kd 0.5 0.5 0.5\nTf 1 1 1\nillum 2\nTr 0\n");
    EXPECT_EQ(wall.transmission, glm::vec3(0)) << "as exporters write it";
    EXPECT_FALSE(wall.two_sided);
    expect_near(material("Kd 0.3\n").diffuse, glm::vec3(0.3f));
}

TEST_F(read_obj_scene, finds_holes_and_means) {
    // Two rows: the top one opaque and white, the bottom one transparent.
    std::vector<std::uint8_t> rgba(4 * 4 * 2, 255);
    std::fill(rgba.begin() + 16, rgba.end(), std::uint8_t{0});
    ASSERT_TRUE(io::write_png(in_folder("leaf 1.png"), rgba, 4, 2));
    const auto m = material("Kd 0.2 0.4 0.6\nmap_Kd leaf 1.png\nmap_d -clamp on leaf 1.png\n");
    expect_near(m.diffuse, {0.2f, 0.4f, 0.6f});
    EXPECT_TRUE(m.two_sided);
    ASSERT_EQ(m.alpha_map, 0u);
    const io::alpha_map map = read("m.obj").maps.at(0);
    EXPECT_EQ(map.width, 4u);
    EXPECT_EQ(map.height, 2u);
    EXPECT_EQ(map.values, (std::vector<float>{0, 0, 0, 0, 1, 1, 1, 1})) << "row 0 is at v = 0";
    // A grey of 188 is half as bright as white, by the sRGB curve.
    std::fill(rgba.begin(), rgba.end(), std::uint8_t{188});
    for (std::size_t i = 3; i < rgba.size(); i += 4) {
        rgba[i] = 255;
    }
    ASSERT_TRUE(io::write_png(in_folder("grey.png"), rgba, 4, 2));
    EXPECT_NEAR(material("Kd 1 1 1\nmap_Kd grey.png\n").diffuse.x, 0.5029, 1e-3);
    expect_material_refused("map_Kd gone.png\n", {"gone.png"});
    write("bad.png", "no picture");
    expect_material_refused("map_d bad.png\n", {"bad.png"});
}

TEST_F(read_obj_scene, names_a_bad_material) {
    expect_material_refused("Kd 1 2 0\n", {"Line 2", "\"2\"", "expected"});
    expect_material_refused("Kd nan 0 0\n", {"Line 2", "\"nan\""});
    expect_material_refused("Kd 1 0\n", {"too few numbers"});
    expect_material_refused("Ke -1 0 0\n", {"\"-1\""});
    expect_material_refused("d 2\n", {"\"2\""});
    expect_material_refused("Kd spectral a.rfl\n", {"\"spectral\""});
    expect_material_refused("Kd 0.8 0.8 0.8\nTf 0.3 0.3 0.3\nillum 4\n", {"\"m\"", "1.1"});
    expect_material_refused("newmtl\n", {"Line 2", "no name"});
    write("m.mtl", "Kd 1 1 1\nnewmtl m\n");
    expect_refused("m.obj", {"Line 1", "newmtl"});
}

// Areas add up and nothing is turned over, whatever the shape.
TEST_F(read_obj_scene, cuts_polygons) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> radius(0.2f, 1.0f);
    for (int corners = 3; corners < 40; ++corners) {
        std::vector<glm::vec3> star;
        for (int i = 0; i < corners; ++i) {
            const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(corners);
            const float r = radius(random);
            star.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
        }
        const auto triangles = io::cut_polygon(star);
        ASSERT_TRUE(triangles);
        ASSERT_EQ(triangles->size(), star.size() - 2);
        double sum = 0;
        for (const auto& t : *triangles) {
            const double area = twice_area({star[t[0]], star[t[1]], star[t[2]]});
            EXPECT_GE(area, -1e-6);
            sum += area;
        }
        EXPECT_NEAR(sum, twice_area(star), 1e-5);
    }
    EXPECT_EQ(io::cut_polygon(std::vector<glm::vec3>(5, glm::vec3(1)))->size(), 3u);
    // A comb of many teeth is refused, a disk of as many corners isn't.
    std::vector<glm::vec3> comb{{3000, -1, 0}, {-1, -1, 0}};
    std::vector<glm::vec3> disk;
    for (int i = 0; i < 3000; ++i) {
        comb.emplace_back(static_cast<float>(i), i % 2 == 0 ? 0.0f : 1.0f, 0.0f);
        const float angle = 6.2831853f * static_cast<float>(i) / 3000.0f;
        disk.emplace_back(1000 * std::cos(angle), 1000 * std::sin(angle), 0);
    }
    EXPECT_FALSE(io::cut_polygon(comb));
    EXPECT_EQ(io::cut_polygon(disk)->size(), 2998u);
}
