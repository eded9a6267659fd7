// Light from the command line: closed forms seen from outside, the same light on every backend,
// states to go on from, every form of output, and what is wrong with files.

#include "pictures.hpp"
#include "support.hpp"

#include <algorithm>
#include <cmath>
#include <io/exr.hpp>
#include <numbers>
#include <sstream>

using namespace skybark::tests;

namespace {

constexpr double pi = std::numbers::pi;
const words backends{"cpu", "opengl", "vulkan"};

/// A line of what was gathered.
struct gathered {
    double x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0, r = 0, g = 0, b = 0, error = 0;
};

std::vector<gathered> read_gathered(const std::filesystem::path& path) {
    std::istringstream lines(read_file(path));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "x,y,z,nx,ny,nz,r,g,b,error");
    std::vector<gathered> all;
    while (std::getline(lines, line)) {
        gathered g;
        std::istringstream fields(line);
        char comma = 0;
        for (double* value : {&g.x, &g.y, &g.z, &g.nx, &g.ny, &g.nz, &g.r, &g.g, &g.b, &g.error}) {
            fields >> *value >> comma;
        }
        EXPECT_FALSE(fields.bad()) << line;
        all.push_back(g);
    }
    return all;
}

/// A unit square at the height 1, that shines down.
const std::string lamp = "mtllib lamp.mtl\nusemtl lamp\nv -0.5 1 -0.5\nv 0.5 1 -0.5\n"
                         "v 0.5 1 0.5\nv -0.5 1 0.5\nf 1 2 3 4\n";
const std::string lamp_material = "newmtl lamp\nKd 0 0 0\nKe 1 2 4\n";

/// A unit cube whose fronts look inwards.
const std::string room = "mtllib room.mtl\nusemtl wall\n"
                         "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 1 0\nv 1 1 0\nv 1 1 1\nv 0 1 1\n"
                         "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

class tool_gather : public tool {
  protected:
    void SetUp() override {
        tool::SetUp();
        write_file(in_folder("lamp.obj"), lamp);
        write_file(in_folder("lamp.mtl"), lamp_material);
        write_file(in_folder("room.obj"), room);
        write_file(in_folder("room.mtl"), "newmtl wall\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
        write_file(in_folder("p.csv"), "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n0.2,0,0.1,0,1,0\n"
                                       "0,2,0,0,1,0\n0.1,0.5,0,0,-1,0\n");
    }
    [[nodiscard]] outcome gather(const std::string& scene, const std::string& out,
                                 words more = {}) const {
        more.insert(more.begin(), {"gather", in_folder(scene), "-o", in_folder(out)});
        return skybark(more);
    }
    /// What is gathered into a table.
    [[nodiscard]] std::vector<gathered> table(const std::string& scene, words more = {}) const {
        const outcome o = gather(scene, "t.csv", std::move(more));
        EXPECT_EQ(o.code, 0) << o.err;
        return read_gathered(folder / "t.csv");
    }
    /// An error of the files: code 1, a sentence with these parts, nothing new in the folder.
    void expect_failed(const std::string& scene, words more, const words& parts,
                       const std::string& out = "bad.csv") const {
        const auto before = names();
        const outcome o = gather(scene, out, std::move(more));
        EXPECT_EQ(o.code, 1) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
        EXPECT_EQ(names(), before);
    }
};

} // namespace

// ---- Closed forms ------------------------------------------------------------------------------

// The form factor from a point to a parallel square over it, half its side a at a height of 1:
// 4 · (1/2π) · 2 · a/√(1+a²) · atan(a/√(1+a²)) = 0.239456.
TEST_F(tool_gather, a_square_light_above_a_point) {
    const auto light = table("lamp.obj", {"--points", in_folder("p.csv"), "--directions", "16384"});
    ASSERT_EQ(light.size(), 4u);
    const double part = 0.5 / std::sqrt(1.25);
    const double factor = 4 / pi * part * std::atan(part);
    ASSERT_NEAR(factor, 0.239456, 1e-6);
    // Five standard errors, as the table says them, of which the first directions are a part.
    EXPECT_NEAR(light[0].r, pi * factor, 0.01);
    EXPECT_NEAR(light[0].g, 2 * pi * factor, 0.02);
    EXPECT_NEAR(light[0].b, 4 * pi * factor, 0.04);
    EXPECT_GT(light[0].error, 0);
    EXPECT_LT(light[0].error, 0.02);
    EXPECT_EQ(light[2].r, 0) << "above it, looking up";
    EXPECT_EQ(light[3].r, 0) << "below it, looking down";
    EXPECT_EQ(light[0].ny, 1);
    EXPECT_EQ(light[1].x, 0.2);
}

TEST_F(tool_gather, an_even_sky_alone_gives_pi_times_its_radiance) {
    const auto light = table(
        "lamp.obj", {"--points", in_folder("p.csv"), "--directions", "3", "--sky", "0.5,1,2"});
    ASSERT_EQ(light.size(), 4u);
    for (const std::size_t free : {std::size_t{2}, std::size_t{3}}) {
        EXPECT_NEAR(light[free].r, 0.5 * pi, 1e-5);
        EXPECT_NEAR(light[free].g, pi, 1e-5);
        EXPECT_NEAR(light[free].b, 2 * pi, 2e-5);
        EXPECT_NEAR(light[free].error, 0, 1e-5);
    }
}

// e (1 − ρ^(k+1)) / (1 − ρ), in every corner of the box as well: the scene's own vertices.
TEST_F(tool_gather, a_closed_box_after_bounces) {
    for (const int bounces : {0, 1, 4}) {
        words more{"--bounces", std::to_string(bounces), "--directions", "64"};
        if (bounces != 0) {
            more.insert(more.end(), {"--patch-size", "0.2"});
        }
        const auto light = table("room.obj", more);
        ASSERT_EQ(light.size(), 24u) << "three faces meet in each of eight corners";
        const double expected = pi * (1 - std::pow(0.5, bounces + 1)) / 0.5;
        for (const gathered& g : light) {
            EXPECT_NEAR(g.r, expected, 0.01 * expected);
        }
    }
}

TEST_F(tool_gather, the_sun_falls_on_what_faces_it) {
    // 30° above the east: on level ground half of it. What stands under the lamp is in its shadow.
    write_file(in_folder("q.csv"), "x,y,z,nx,ny,nz\n5,0,0,0,1,0\n-1.732051,0,0,0,1,0\n"
                                   "5,0,0,1,0,0\n5,0,0,-1,0,0\n");
    const auto light = table("lamp.obj", {"--points", in_folder("q.csv"), "--directions", "8",
                                          "--sun", "90,30", "--sun-irradiance", "10,20,30"});
    ASSERT_EQ(light.size(), 4u);
    EXPECT_NEAR(light[0].b, 15, 0.05) << "and what comes from the lamp";
    EXPECT_LT(light[1].b, 1);
    EXPECT_NEAR(light[2].b, 30 * std::cos(pi / 6), 1e-3) << "the lamp is behind it";
    EXPECT_LT(light[3].b, 1);
}

TEST_F(tool_gather, holes_and_leaves_let_light_through) {
    // A roof over the point: closed, thin (half of what falls on it goes through), and turned away.
    const std::string roof = "v -50 1 -50\nv 50 1 -50\nv 50 1 50\nv -50 1 50\nf 1 2 3 4\n";
    write_file(in_folder("p1.csv"), "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n");
    write_file(in_folder("leaf.obj"), "mtllib leaf.mtl\nusemtl leaf\n" + roof);
    const auto under = [&](const std::string& material, words more = {}) {
        write_file(in_folder("leaf.mtl"), "newmtl leaf\n" + material);
        more.insert(more.end(), {"--points", in_folder("p1.csv"), "--directions", "256", "--sky",
                                 "1", "--bounces", "1", "--patch-size", "100"});
        return table("leaf.obj", more).at(0).r / pi;
    };
    // Between the roof's edge and the horizon there is 1/50² of the sky's light.
    EXPECT_NEAR(under("Kd 0 0 0\n"), 0, 0.02);
    EXPECT_NEAR(under("Kd 0 0 0\nTf 0.5 0.5 0.5\nillum 4\n"), 0.5, 0.02);
    EXPECT_NEAR(under("Kd 0 0 0\nd 0.25\n"), 0.75, 0.02);
    // Its front shines; its back does where both sides do.
    EXPECT_NEAR(under("Kd 0 0 0\nKe 2 2 2\n"), 2, 0.05);
    write_file(in_folder("leaf.obj"), "mtllib leaf.mtl\nusemtl leaf\n" + roof + "f 4 3 2 1\n");
    write_file(in_folder("back.obj"),
               "mtllib leaf.mtl\nusemtl leaf\n" + roof.substr(0, roof.rfind('f')) + "f 4 3 2 1\n");
    write_file(in_folder("leaf.mtl"), "newmtl leaf\nKd 0 0 0\nKe 2 2 2\n");
    const words from_below{"--points", in_folder("p1.csv"), "--directions", "64"};
    EXPECT_EQ(table("back.obj", from_below).at(0).r, 0);
    words both = from_below;
    both.emplace_back("--two-sided");
    EXPECT_NEAR(table("back.obj", both).at(0).r / pi, 2, 0.05);
}

TEST_F(tool_gather, reads_binary_gltf) {
    // A species of the tool's own, as a file that another command wrote.
    const outcome made =
        skybark({"tree", "quaking_aspen", "--sides", "4", "-o", in_folder("t.glb")});
    ASSERT_EQ(made.code, 0) << made.err;
    write_file(in_folder("far.csv"), "x,y,z,nx,ny,nz\n0,1000,0,0,1,0\n0.5,0.01,0.5,0,1,0\n");
    const auto light =
        table("t.glb", {"--points", in_folder("far.csv"), "--sky", "1", "--directions", "128"});
    ASSERT_EQ(light.size(), 2u);
    EXPECT_NEAR(light[0].r, pi, 1e-4);
    EXPECT_LT(light[1].r, 0.97 * pi) << "under its leaves";
    EXPECT_GT(light[1].r, 0);
}

// ---- Backends, states, errors ------------------------------------------------------------------

TEST_F(tool_gather, backends_agree) {
    const words common{
        "--bounces",           "2",  "--patch-size", "0.3",         "--directions", "32",
        "--bounce-directions", "32", "--sky",        "0.1,0.2,0.3", "--sun",        "30,60"};
    for (const char* scene : {"room.obj", "lamp.obj"}) {
        const auto expected = table(scene, common);
        for (const std::string& backend : backends) {
            words more = common;
            more.insert(more.end(), {"--backend", backend});
            const outcome o = gather(scene, "b.csv", more);
            SKYBARK_SKIP_UNAVAILABLE(o, backend);
            ASSERT_EQ(o.code, 0) << o.err;
            const auto found = read_gathered(folder / "b.csv");
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
                // Hits are the same; sums of 32 floats, each bounce's too, may be rounded
                // otherwise.
                EXPECT_NEAR(found[i].r, expected[i].r, 1e-4 * (1 + expected[i].r)) << backend;
                EXPECT_NEAR(found[i].b, expected[i].b, 1e-4 * (1 + expected[i].b)) << backend;
                EXPECT_NEAR(found[i].error, expected[i].error, 1e-3 * (1 + expected[i].error));
            }
        }
    }
}

TEST_F(tool_gather, peels_about_the_same_light) {
    write_file(in_folder("q.csv"), "x,y,z,nx,ny,nz\n0.3,0.001,0.4,0,1,0\n0.5,0.5,0.5,0,0,1\n");
    const words common{"--points", in_folder("q.csv"), "--directions", "16"};
    const auto expected = table("room.obj", common);
    for (const std::string& backend : backends) {
        words more = common;
        more.insert(more.end(), {"--method", "peel", "--peel-size", "256", "--backend", backend});
        const outcome o = gather("room.obj", "b.csv", more);
        SKYBARK_SKIP_UNAVAILABLE(o, backend);
        ASSERT_EQ(o.code, 0) << o.err;
        const auto found = read_gathered(folder / "b.csv");
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            // Rays are off by up to a pixel: a wall of the room, or none, is seen at its edges.
            EXPECT_NEAR(found[i].r, expected[i].r, 0.15 * expected[i].r) << backend;
        }
    }
}

TEST_F(tool_gather, goes_on_to_the_same_bits) {
    const words common{"--bounces", "1", "--patch-size", "0.4", "--sun", "10,80", "--sky", "0.5"};
    const auto run = [&](const std::string& out, words more) {
        more.insert(more.end(), common.begin(), common.end());
        const outcome o = gather("room.obj", out, more);
        EXPECT_EQ(o.code, 0) << o.err;
    };
    run("once.csv", {"--directions", "100"});
    const std::string state = in_folder("state");
    run("a.csv", {"--directions", "37", "--save", state});
    run("b.csv", {"--directions", "64", "--resume", state, "--save", state});
    run("c.csv", {"--directions", "100", "--resume", state});
    EXPECT_EQ(read_file(folder / "c.csv"), read_file(folder / "once.csv"));
    EXPECT_NE(read_file(folder / "a.csv"), read_file(folder / "once.csv"));
    run("d.csv", {"--directions", "64", "--resume", state});
    EXPECT_EQ(read_file(folder / "d.csv"), read_file(folder / "b.csv")) << "nothing left to do";
}

TEST_F(tool_gather, refuses_a_state_of_something_else) {
    const std::string state = in_folder("state");
    const words points{"--points", in_folder("p.csv")};
    const auto with = [&](words more) {
        more.insert(more.begin(), points.begin(), points.end());
        return more;
    };
    ASSERT_EQ(gather("lamp.obj", "a.csv", with({"--directions", "64", "--save", state})).code, 0);
    const auto refused = [&](const std::string& scene, words more, const words& parts) {
        more.insert(more.end(), {"--resume", state});
        expect_failed(scene, more, parts);
    };
    refused("lamp.obj", with({"--sky", "1"}), {"\"sky 0,0,0\"", "expected \"sky 1,1,1\""});
    refused("lamp.obj", with({"--sun", "1,2"}), {"\"sun none\"", "sun 1,2"});
    refused("lamp.obj", with({"--seed", "2"}), {"\"seed 1\"", "\"seed 2\""});
    refused("lamp.obj", with({"--bounces", "1"}), {"\"bounces 0\""});
    refused("lamp.obj", with({"--method", "peel"}), {"method resolve"});
    refused("lamp.obj", with({"--directions", "9"}), {"64 directions already", "--directions"});
    refused("room.obj", with({}), {"state", "another scene"});
    refused("lamp.obj", {}, {"state", "other samples"}); // as many vertices, but elsewhere
}

TEST_F(tool_gather, refuses_a_state_that_is_damaged) {
    const std::string state = in_folder("state");
    const words common{"--points", in_folder("p.csv"), "--directions", "32"};
    words more = common;
    more.insert(more.end(), {"--save", state});
    ASSERT_EQ(gather("lamp.obj", "a.csv", more).code, 0);
    const std::string whole = read_file(state);
    more = common;
    more.insert(more.end(), {"--resume", state});
    const auto refused = [&](const std::string& bytes, const words& parts) {
        write_file(state, bytes);
        expect_failed("lamp.obj", more, parts);
    };
    refused("", {"no state of a gather"});
    refused("x,y,z\n", {"no state of a gather", "--save"});
    refused(whole.substr(0, whole.size() - 1), {"bytes"});
    refused(whole.substr(0, whole.find('\n') + 1), {"0 bytes"});
    refused(whole.substr(0, 30), {"can't be gone on with"});
    std::string changed = whole;
    changed[changed.size() - 20] = static_cast<char>(changed[changed.size() - 20] ^ 1);
    refused(changed, {"damaged"});
    std::filesystem::remove(state);
    expect_failed("lamp.obj", more, {"state", "can't be opened"});
}

TEST_F(tool_gather, stops_at_an_error) {
    const words points{"--points", in_folder("p.csv"), "--stats", in_folder("s.json")};
    const auto stats = [&](words more) {
        more.insert(more.begin(), points.begin(), points.end());
        const outcome o = gather("lamp.obj", "e.csv", more);
        EXPECT_EQ(o.code, 0) << o.err;
        return std::pair{nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false), o};
    };
    const auto [reached, quiet] = stats({"--error", "0.03"});
    EXPECT_LE(reached["error"]["rms"].get<double>(), 0.03);
    EXPECT_EQ(reached["error"]["reached"], true);
    EXPECT_EQ(quiet.err, "");
    double squares = 0;
    for (const gathered& g : read_gathered(folder / "e.csv")) {
        squares += g.error * g.error;
    }
    // The point over the lamp and the one that looks down see nothing, and know it.
    EXPECT_NEAR(std::sqrt(squares / 4), reached["error"]["rms"].get<double>(), 1e-6);
    const auto axes = reached["counts"]["directions"].get<std::uint64_t>();
    EXPECT_GE(axes, 64u);
    EXPECT_LT(axes, 65536u);
    const auto [cut, warned] = stats({"--error", "0.0001", "--max-directions", "100"});
    EXPECT_EQ(cut["counts"]["directions"], 100);
    EXPECT_EQ(cut["error"]["reached"], false);
    EXPECT_TRUE(has(warned.err, {"After 100 directions", "expected 0.0001"}));
    EXPECT_TRUE(is_sentence(warned.err));
}

TEST_F(tool_gather, counts) {
    const outcome o = gather("room.obj", "a.csv",
                             {"--bounces", "1", "--patch-size", "0.5", "--directions", "40",
                              "--bounce-directions", "16", "--stats", in_folder("s.json")});
    ASSERT_EQ(o.code, 0) << o.err;
    const auto s = nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
    EXPECT_EQ(s["command"], "gather");
    EXPECT_EQ(s["backend"], "cpu");
    EXPECT_EQ(s["counts"]["triangles"], 12);
    EXPECT_EQ(s["counts"]["materials"], 1);
    EXPECT_EQ(s["counts"]["patches"], 12 * 9) << "√2 / 0.5 is less than 3";
    EXPECT_EQ(s["counts"]["points"], 24);
    EXPECT_EQ(s["counts"]["directions"], 40);
    EXPECT_EQ(s["counts"]["bounces"], 1);
    double sum = 0;
    for (const char* stage : {"read", "build", "bounce", "gather", "draw", "write"}) {
        sum += s["seconds"][stage].get<double>();
    }
    EXPECT_NEAR(s["seconds"]["total"].get<double>(), sum, 1e-6);
    EXPECT_GE(s["bytes"]["up"].get<std::uint64_t>(), 12 * 48u);
    EXPECT_TRUE(has(o.out, {"a.csv", "24 points", "40 directions"}));
    EXPECT_EQ(gather("room.obj", "a.csv", {"--directions", "4", "--quiet"}).out, "");
}

// ---- What is written ---------------------------------------------------------------------------

TEST_F(tool_gather, writes_a_coloured_mesh) {
    ASSERT_EQ(gather("room.obj", "a.ply", {"--directions", "32"}).code, 0);
    const std::string bytes = read_file(folder / "a.ply");
    EXPECT_TRUE(has(bytes, {"element vertex 24\n", "element face 12\n", "property uchar red\n"}));
    const std::size_t body = bytes.find("end_header\n") + 11;
    EXPECT_EQ(bytes.size() - body, 24 * 43 + 12 * 13u);
    float light = 0;
    std::memcpy(&light, bytes.data() + body + 6 * sizeof(float), sizeof light);
    EXPECT_NEAR(light, pi, 1e-4) << "from walls that all shine alike";
}

TEST_F(tool_gather, writes_a_lightmap) {
    if (!skybark::io::has_exr()) {
        expect_failed("room.obj", {}, {"OpenEXR"}, "a.exr");
        GTEST_SKIP() << "built without OpenEXR";
    }
    for (const char* mesh : {"u.obj", "u.ply", "u.glb"}) {
        const outcome o = gather("room.obj", "a.exr",
                                 {"--lightmap", "64", "--directions", "16", "--unwrapped",
                                  in_folder(mesh), "--stats", in_folder("s.json")});
        ASSERT_EQ(o.code, 0) << o.err;
        EXPECT_GT(std::filesystem::file_size(folder / mesh), 400u);
    }
    EXPECT_EQ(read_file(folder / "a.exr").substr(0, 4), "\x76\x2f\x31\x01");
    const auto s = nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
    EXPECT_GT(s["counts"]["points"].get<int>(), 64 * 64 / 3);
    EXPECT_GT(s["texels_per_metre"].get<double>(), 10);
    // The unwrapped mesh is the scene again, with texture coordinates of its own.
    const auto light = table("u.obj", {"--directions", "8"});
    EXPECT_EQ(light.size(), 24u);
    EXPECT_TRUE(has(read_file(folder / "u.obj"), {"vt 0."}));
    // As a table, the texels' places.
    EXPECT_GT(table("room.obj", {"--lightmap", "64", "--directions", "1"}).size(), 64 * 64 / 3u);
}

TEST_F(tool_gather, draws_a_picture) {
    // From inside: only walls, all alike. The lamp from below: it, and the sky around.
    const words inside{"--camera", "0.5,0.5,0.9",  "--look-at", "0.5,0.5,0",  "--size",
                       "40x30",    "--directions", "16",        "--exposure", "1"};
    for (const std::string& backend : backends) {
        words more = inside;
        more.insert(more.end(), {"--backend", backend});
        const outcome o = gather("room.obj", "a.png", more);
        SKYBARK_SKIP_UNAVAILABLE(o, backend);
        ASSERT_EQ(o.code, 0) << o.err;
        const read_picture drawn = read_png(in_folder("a.png"));
        ASSERT_EQ(drawn.width, 40);
        ASSERT_EQ(drawn.height, 30);
        for (std::size_t i = 0; i < drawn.rgba.size(); i += 4) {
            EXPECT_NEAR(drawn.rgba[i], drawn.rgba[0], 2) << backend;
            EXPECT_GT(drawn.rgba[i], 200);
        }
    }
    ASSERT_EQ(gather("lamp.obj", "b.png",
                     {"--camera", "0,-1,0", "--look-at", "0,1,0", "--size", "64x64", "--sky",
                      "0,0,0.2", "--exposure", "1", "--directions", "8"})
                  .code,
              0);
    const read_picture lit = read_png(in_folder("b.png"));
    const auto pixel = [&](int x, int y) {
        return lit.rgba.data() +
               4 * (static_cast<std::size_t>(y) * 64 + static_cast<std::size_t>(x));
    };
    EXPECT_GT(pixel(32, 32)[0], 200);
    EXPECT_GT(pixel(32, 32)[2], pixel(32, 32)[0] - 1);
    EXPECT_EQ(pixel(1, 1)[0], 0);
    EXPECT_GT(pixel(1, 1)[2], 100);
}

// ---- What is wrong -----------------------------------------------------------------------------

TEST_F(tool_gather, names_what_is_wrong_with_files) {
    expect_failed("gone.obj", {}, {"gone.obj", "can't be opened"});
    write_file(in_folder("empty.obj"), "");
    expect_failed("empty.obj", {}, {"empty.obj", "no triangles"});
    write_file(in_folder("broken.obj"), "v 0 0 0\nv 1 nan 0\n");
    expect_failed("broken.obj", {}, {"Line 2", "broken.obj", "\"nan\""});
    write_file(in_folder("face.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    expect_failed("face.obj", {}, {"Line 4", "vertex 9"});
    write_file(in_folder("nomtl.obj"), "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_failed("nomtl.obj", {}, {"Line 1", "none.mtl"});
    write_file(in_folder("room.mtl"), "newmtl wall\nKd 2 0 0\n");
    expect_failed("room.obj", {}, {"Line 2", "room.mtl", "\"2\""});
    write_file(in_folder("bad.glb"), "glTF and nothing else, whatever");
    expect_failed("bad.glb", {}, {"bad.glb"});
    write_file(in_folder("flat.obj"), "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 1\n");
    expect_failed("flat.obj", {}, {"flat.obj", "no vertex with a normal"});
    expect_failed("lamp.obj", {"--points", in_folder("gone.csv")}, {"gone.csv"});
    write_file(in_folder("none.csv"), "x,y,z,nx,ny,nz\n");
    expect_failed("lamp.obj", {"--points", in_folder("none.csv")}, {"none.csv", "points"});
    write_file(in_folder("nan.csv"), "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n0,0,nan,0,1,0\n");
    expect_failed("lamp.obj", {"--points", in_folder("nan.csv")}, {"Line 3", "\"nan\""});
    write_file(in_folder("zero.csv"), "x,y,z,nx,ny,nz\n0,0,0,0,0,0\n");
    expect_failed("lamp.obj", {"--points", in_folder("zero.csv")}, {"point 1", "0,0,0"});
    if (skybark::io::has_exr()) {
        expect_failed("lamp.obj", {"--lightmap", "1"}, {"lightmap of 1"}, "bad.exr");
    }
    write_file(in_folder("lamp.mtl"), lamp_material);
    expect_failed("lamp.obj", {}, {"nowhere", "folder"}, "nowhere/a.csv");
    expect_failed("lamp.obj", {"--save", in_folder("nowhere/s")}, {"nowhere", "folder"});
    expect_failed("lamp.obj", {"--stats", in_folder("nowhere/s")}, {"nowhere", "folder"});
}

// What no machine has is refused before it is asked for.
TEST_F(tool_gather, names_what_needs_too_much_memory) {
    expect_failed("lamp.obj", {"--size", "16384x16384", "--supersampling", "8"},
                  {"17179869184 points", "MiB"}, "a.png");
    if (skybark::io::has_exr()) {
        expect_failed("lamp.obj", {"--lightmap", "32768"}, {"lightmap of 32768", "points"},
                      "a.exr");
    }
}

TEST_F(tool_gather, names_what_is_wrong_with_words) {
    const auto refused = [&](const std::string& scene, const std::string& out, words more,
                             const words& parts) {
        const auto before = names();
        const outcome o = gather(scene, out, std::move(more));
        EXPECT_EQ(o.code, 2) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(names(), before);
    };
    refused("lamp.obj", "a.csv", {"--directions", "0"}, {"--directions", "\"0\""});
    refused("lamp.obj", "a.tif", {}, {"a.tif", ".exr"});
    refused("lamp.stl", "a.csv", {}, {"lamp.stl", ".obj or .glb"});
    refused("lamp.obj", "lamp.obj", {}, {".csv"});
    refused("lamp.obj", "p.csv", {"--points", in_folder("p.csv")}, {"same file"});
    refused("lamp.obj", "a.csv", {"--save", in_folder("a.csv")}, {"same file"});
    EXPECT_EQ(skybark({"gather"}).code, 2);
    EXPECT_TRUE(has(skybark({"gather"}).err, {"SCENE"}));
    EXPECT_TRUE(has(skybark({"gather", in_folder("lamp.obj")}).err, {"-o"}));
    for (const std::string& backend : backends) {
        EXPECT_EQ(
            gather("lamp.obj", "a.csv", {"--backend", backend, "--device", "4000000000"}).code, 3);
    }
}

TEST_F(tool_gather, takes_points_anywhere) {
    // In a solid (its backs are black), on a surface, on an edge, in a corner, outside.
    write_file(in_folder("solid.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                       "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    write_file(in_folder("q.csv"), "x,y,z,nx,ny,nz\n0.2,0.2,0.2,0,1,0\n0.3,0,0.3,0,-1,0\n"
                                   "0.5,0,0,0,-1,0\n0,0,0,0,-1,0\n1e9,0,0,1,0,0\n");
    const auto light =
        table("solid.obj", {"--points", in_folder("q.csv"), "--sky", "1", "--directions", "64"});
    ASSERT_EQ(light.size(), 5u);
    EXPECT_EQ(light[0].r, 0);
    for (std::size_t i = 1; i < 5; ++i) {
        EXPECT_NEAR(light[i].r, pi, 1e-4) << i << ": a convex body hides nothing from itself";
    }
}

TEST_F(tool_gather, takes_four_million_points_slow) {
    {
        std::ofstream file(folder / "many.csv");
        file << "x,y,z,nx,ny,nz\n";
        for (int i = 0; i < 4'000'000; ++i) {
            file << (i % 2000) * 0.001 - 1 << ",0," << (i / 2000) * 0.001 - 1 << ",0,1,0\n";
        }
    }
    const auto light = table("lamp.obj", {"--points", in_folder("many.csv"), "--directions", "8"});
    ASSERT_EQ(light.size(), 4'000'000u);
    double sum = 0;
    for (const gathered& g : light) {
        sum += g.r / 4e6;
    }
    // Two parallel squares, sides 2 and 1 at a distance of 1, by its mirror image: what the small
    // one sends to the large one. Eight directions are few.
    EXPECT_GT(sum, 0.05 * pi);
    EXPECT_LT(sum, 0.4 * pi);
}
