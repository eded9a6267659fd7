// Clouds from the command line: places against closed forms, volumes, pictures, and what is wrong
// with files, on every backend.

#include "pictures.hpp"
#include "support.hpp"

#include <cmath>
#include <io/vdb.hpp>
#include <sstream>

using namespace skybark::tests;

namespace {

const std::string header = "x,y,z,radius,optical_depth,albedo\n";
const words backends{"cpu", "opengl", "vulkan"};

/// A line of a table of places.
struct probe {
    double x = 0, y = 0, z = 0, optical_depth = 0, light = 0;
};

std::vector<probe> read_probes(const std::filesystem::path& path) {
    std::istringstream lines(read_file(path));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "x,y,z,optical_depth,light");
    std::vector<probe> all;
    while (std::getline(lines, line)) {
        probe p;
        char comma = 0;
        std::istringstream fields(line);
        fields >> p.x >> comma >> p.y >> comma >> p.z >> comma >> p.optical_depth >> comma >>
            p.light;
        EXPECT_TRUE(fields) << line;
        all.push_back(p);
    }
    return all;
}

class tool_clouds : public tool {
  protected:
    void SetUp() override {
        tool::SetUp();
        // A particle of 3 m: sigma is 1 m. Depth 2 through its centre.
        write_file(in_folder("one.csv"), header + "10,20,30,3,2,0.9\n");
    }

    /// Light at places, as a backend finds it. Nothing where there is no such backend.
    std::vector<probe> probes(const std::string& backend, const std::string& cloud,
                              const std::string& points, words more) {
        write_file(in_folder("points.csv"), "x,y,z\n" + points);
        words all{"cloud",   in_folder(cloud),        "--backend", backend,
                  "--probe", in_folder("points.csv"), "-o",        in_folder("light.csv"),
                  "--quiet"};
        all.insert(all.end(), more.begin(), more.end());
        const outcome o = skybark(all);
        if (o.code == 3 && !is_required(backend)) {
            return {};
        }
        EXPECT_EQ(o.code, 0) << o.err;
        EXPECT_EQ(o.out, "");
        return o.code == 0 ? read_probes(folder / "light.csv") : std::vector<probe>();
    }

    /// A blob of some hundred particles.
    static std::string blob() {
        std::string text = header;
        for (int i = 0; i < 300; ++i) {
            const double a = 2.399963 * i;
            const double h = 1 - (2 * i + 1) / 300.0;
            const double out = 60 * std::sqrt(1 - h * h) * (0.3 + 0.7 * (i % 7) / 6.0);
            text += std::to_string(out * std::cos(a)) + "," + std::to_string(200 + 50 * h) + "," +
                    std::to_string(out * std::sin(a)) + "," + std::to_string(12 + i % 9) + "," +
                    std::to_string(0.2 + 0.01 * (i % 40)) + ",1\n";
        }
        return text;
    }

    /// Code 1, a sentence with these parts, and nothing beside what was there.
    void expect_failed(words arguments, const words& parts) {
        const auto before = names();
        const outcome o = skybark(std::move(arguments));
        EXPECT_EQ(o.code, 1) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
        EXPECT_EQ(names(), before) << "a file was left";
    }
};

double below(double depth, double distance) { return depth * std::exp(-distance * distance / 2); }

} // namespace

// Straight up, the depth at a height y over the centre is 2 e^(-d²/2) ½ erfc(y / √2), nothing above
// the particle and all of it below. A voxel is 6/125 m wide at most: between middles the bend of a
// Gaussian of depth 2 costs less than 2 (0.05)²/8 along each axis, and its rim, which is cut off at
// three sigmas, 2 e^(-4.5) = 0.022 where it begins.
TEST_F(tool_clouds, one_particle_is_as_deep_as_its_formula_says) {
    const std::string points = "10,20,30\n"     // the centre: half of it lies above
                               "10,10,30\n"     // below
                               "10,-9000,30\n"  // far below
                               "11,15,30\n"     // below, a sigma aside
                               "10,21,30\n"     // a sigma above the centre
                               "11,19,31\n"     // within
                               "10,23.5,30\n"   // above
                               "10,9000,30\n"   // far above
                               "14,10,30\n"     // beside
                               "900,10,-900\n"; // far away
    const double expected[] = {1,
                               2,
                               2,
                               below(2, 1),
                               std::erfc(1 / std::sqrt(2.0)),
                               below(1, std::sqrt(2.0)) * std::erfc(-1 / std::sqrt(2.0)),
                               0,
                               0,
                               0,
                               0};
    // The part of the energy that goes straight on is g² of Henyey and Greenstein's.
    const double share = 1 - 0.9 * 0.25;
    for (const std::string& backend : backends) {
        const auto found =
            probes(backend, "one.csv", points, {"--sun", "0,90", "--phase", "hg:0.5"});
        if (found.empty()) {
            continue;
        }
        ASSERT_EQ(found.size(), std::size(expected)) << backend;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i].optical_depth, expected[i], 2e-3) << backend << ' ' << i;
            EXPECT_NEAR(found[i].light, std::exp(-share * expected[i]), 2e-3) << backend << i;
        }
        EXPECT_EQ(found[2].y, -9000);
        EXPECT_EQ(found[2].optical_depth, found[1].optical_depth) << "the shadow has no end";
        for (std::size_t i = 6; i < found.size(); ++i) {
            EXPECT_EQ(found[i].optical_depth, 0) << backend << ' ' << i;
            EXPECT_EQ(found[i].light, 1) << backend << ' ' << i;
        }
    }
}

// The compass: at 90,0 the sun stands level in the east, +X, and the shadow lies in the west; at
// 0,0 it stands in the north, −Z.
TEST_F(tool_clouds, the_sun_stands_where_the_compass_says) {
    const std::string points = "0,20,30\n20,20,30\n10,20,20\n10,20,40\n10,10,30\n10,30,30\n";
    const std::pair<const char*, std::size_t> all[] = {{"90,0", 0}, {"-90,0", 1}, {"180,0", 2},
                                                       {"0,0", 3},  {"77,90", 4}, {"5,-90", 5}};
    for (const auto& [sun, dark] : all) {
        const auto found =
            probes("cpu", "one.csv", points, {std::string("--sun=") + sun, "--volume", "64"});
        ASSERT_EQ(found.size(), 6u);
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i].optical_depth, i == dark ? 2 : 0, 5e-3) << sun << ' ' << i;
        }
    }
}

// Every kind of light by its own formula, below the particle where profiles don't matter.
TEST_F(tool_clouds, light_is_what_was_asked_for) {
    double octaves = 0;
    double weights = 0;
    for (int k = 0; k < 4; ++k) {
        octaves += std::pow(0.5, k) * std::exp(-2 * std::pow(0.5, k));
        weights += std::pow(0.5, k);
    }
    const double isotropic = 1 / (4 * std::acos(-1.0));
    const std::pair<words, double> all[] = {
        {{"--light", "continuum", "--phase", "isotropic"}, std::exp(-2.0)},
        {{"--light", "continuum", "--phase", "hg:0.8"}, std::exp(-2 * (1 - 0.9 * 0.64))},
        {{"--light", "product", "--phase", "isotropic"}, std::exp(-2.0) + 0.9 * 2 * isotropic},
        // Rayleigh's P(0) is 1.5 times that.
        {{"--light", "product"}, std::exp(-2.0) + 0.9 * 2 * 1.5 * isotropic},
        {{"--light", "octaves", "--octaves", "4"}, octaves / weights},
    };
    for (const std::string& backend : backends) {
        for (const auto& [more, expected] : all) {
            for (const char* profile : {"step", "erf"}) {
                words options{"--sun", "20,70", "--profile", profile};
                options.insert(options.end(), more.begin(), more.end());
                // Ten metres from the centre, away from the sun.
                const double a = 20 * std::acos(-1.0) / 180;
                const double e = 70 * std::acos(-1.0) / 180;
                const std::string point = std::to_string(10 - 10 * std::sin(a) * std::cos(e)) +
                                          "," + std::to_string(20 - 10 * std::sin(e)) + "," +
                                          std::to_string(30 + 10 * std::cos(a) * std::cos(e)) +
                                          "\n";
                const auto found = probes(backend, "one.csv", point, options);
                if (found.empty()) {
                    continue;
                }
                // As above.
                EXPECT_NEAR(found[0].optical_depth, 2, 2e-3) << backend << more[1];
                EXPECT_NEAR(found[0].light, expected, 2e-3) << backend << more[1];
            }
        }
    }
}

TEST_F(tool_clouds, backends_agree_on_a_blob) {
    write_file(in_folder("blob.csv"), blob());
    std::string points;
    for (int i = 0; i < 500; ++i) {
        points += std::to_string((i * 37) % 160 - 80) + "," + std::to_string(120 + (i * 53) % 150) +
                  "," + std::to_string((i * 71) % 160 - 80) + "\n";
    }
    const words kinds[] = {
        {"--light", "continuum"},
        {"--light", "product", "--profile", "step"},
        {"--light", "octaves", "--half"},
        {"--light", "multiple"},
        {"--method", "shadow_polygons", "--padding", "degenerate"},
        {"--method", "shadow_polygons", "--polygons", "stage", "--route", "tiles_copied"},
        {"--method", "shadow_polygons", "--polygons", "stage", "--route", "layers", "--padding",
         "compact"}};
    for (words more : kinds) {
        more.insert(more.end(), {"--volume", "48", "--sun", "200,35"});
        const auto cpu = probes("cpu", "blob.csv", points, more);
        ASSERT_EQ(cpu.size(), 500u);
        double deepest = 0;
        for (const probe& p : cpu) {
            deepest = std::max(deepest, p.optical_depth);
        }
        EXPECT_GT(deepest, 3) << "the points lie beside the cloud";
        for (const char* backend : {"opengl", "vulkan"}) {
            const auto found = probes(backend, "blob.csv", points, more);
            if (found.empty()) {
                continue;
            }
            ASSERT_EQ(found.size(), cpu.size());
            for (std::size_t i = 0; i < cpu.size(); ++i) {
                // The project's bound for optical depths.
                EXPECT_NEAR(found[i].optical_depth, cpu[i].optical_depth, 1e-4)
                    << backend << more[1] << i;
                EXPECT_NEAR(found[i].light, cpu[i].light, 1e-4) << backend << more[1] << i;
            }
        }
    }
}

// More light than what was never scattered, and all of it where there is no cloud.
TEST_F(tool_clouds, multiple_scattering_adds_light) {
    write_file(in_folder("blob.csv"), blob());
    const std::string points = "0,200,0\n0,160,0\n0,400,0\n900,200,0\n";
    const words common{"--sun", "0,90", "--volume", "48"};
    words multiple = common;
    multiple.insert(multiple.end(), {"--light", "multiple"});
    const auto single = probes("cpu", "blob.csv", points, common);
    const auto all = probes("cpu", "blob.csv", points, multiple);
    ASSERT_EQ(single.size(), 4u);
    ASSERT_EQ(all.size(), 4u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(all[i].optical_depth, single[i].optical_depth);
        EXPECT_GT(all[i].light, single[i].light + 0.05);
    }
    // Outside of the box, what the cloud sends there: less than half of the sun's fluence comes
    // from its edge, under the solid angle of a ball of 110 m, the box's half diagonal, 200 m and
    // 900 m away: 8 % and 0.4 % of all directions.
    EXPECT_GT(all[3].light, 1) << "beside";
    EXPECT_LT(all[3].light, 1.002);
    EXPECT_GT(all[2].light, all[3].light) << "above, nearer";
    EXPECT_LT(all[2].light, 1.04);
}

// Clouds with much room between them, in voxels that are four to thirty times as wide as high. In
// the depth of an endless cloud that absorbs nothing, five times the sun's irradiance is the most
// that diffusion knows; corners that many faces light may have a little more.
TEST_F(tool_clouds, no_cloud_of_a_field_shines_by_itself) {
    std::string points;
    for (int i = 0; i < 900; ++i) {
        points += std::to_string(-4000 + 270 * (i % 30)) + ",1100," +
                  std::to_string(-4000 + 270 * (i / 30)) + "\n";
    }
    for (const char* sun : {"20,90", "120,50", "120,10"}) {
        write_file(in_folder("points.csv"), "x,y,z\n" + points);
        const outcome o = skybark({"cloud", "cumulus_field", "--particles", "6000", "--light",
                                   "multiple", "--volume", "32", "--sun", sun, "--probe",
                                   in_folder("points.csv"), "-o", in_folder("light.csv")});
        ASSERT_EQ(o.code, 0) << o.err;
        double brightest = 0;
        for (const probe& p : read_probes(folder / "light.csv")) {
            EXPECT_GE(p.light, 0);
            brightest = std::max(brightest, p.light);
        }
        EXPECT_GT(brightest, 1.2) << sun;
        EXPECT_LT(brightest, 7) << sun;
    }
}

namespace {

/// A box of 8 × 10 × 12 voxels of 2 m, of density 1 above the middle and 3 below; its lowest corner
/// at (100, 50, -30).
skybark::result<void> write_layers(const std::string& path) {
    std::vector<float> values;
    for (int z = 0; z < 12; ++z) {
        for (int y = 0; y < 10; ++y) {
            for (int x = 0; x < 8; ++x) {
                values.push_back(y < 5 ? 3.0f : 1.0f);
            }
        }
    }
    skybark::io::vdb_volume volume;
    volume.name = "density";
    volume.values = values;
    volume.voxels = {8, 10, 12};
    volume.to_world = glm::dmat4(glm::dvec4(2, 0, 0, 0), glm::dvec4(0, 2, 0, 0),
                                 glm::dvec4(0, 0, 2, 0), glm::dvec4(100, 50, -30, 1));
    return skybark::io::write_vdb(path, std::span(&volume, 1));
}

} // namespace

TEST_F(tool_clouds, densities_take_light_along_their_way) {
    if (const auto written = write_layers(in_folder("layers.vdb")); !written) {
        GTEST_SKIP() << written.error().message;
    }
    // 10 m of density 1, 10 m of density 3, of 0.05 1/m each.
    const std::string points = "108,40,-18\n108,50,-18\n108,60,-18\n108,70.5,-18\n90,40,-18\n";
    const double expected[] = {2, 2, 0.5, 0, 0};
    for (const std::string& backend : backends) {
        const auto found = probes(
            backend, "layers.vdb", points,
            {"--sun", "0,90", "--extinction", "0.05", "--albedo", "0.8", "--phase", "hg:0.5"});
        if (found.empty()) {
            continue;
        }
        ASSERT_EQ(found.size(), 5u);
        for (std::size_t i = 0; i < found.size(); ++i) {
            // The step in the middle is smeared over a voxel of the file by its linear filter, and
            // the edges over one of the light's, 20 m / 125: 3 · 0.05 · 2 m / 8 in all.
            EXPECT_NEAR(found[i].optical_depth, expected[i], 0.04) << backend << i;
            EXPECT_NEAR(found[i].light, std::exp(-found[i].optical_depth * (1 - 0.8 * 0.25)), 1e-4)
                << backend << i;
        }
    }
}

TEST_F(tool_clouds, backends_draw_the_same_picture) {
    write_file(in_folder("blob.csv"), blob());
    const auto drawn = [&](const std::string& backend, words more) {
        more.insert(more.begin(), {"cloud", in_folder("blob.csv"), "--backend", backend, "-o",
                                   in_folder("a.png"), "--size", "160x100", "--volume", "32"});
        return skybark(more);
    };
    const words kinds[] = {{"--light", "continuum", "--sun", "90,10"},
                           {"--light", "multiple", "--half"},
                           {"--light", "octaves"},
                           {"--light", "product", "--method", "shadow_polygons"},
                           {"--method", "harris"}};
    std::vector<read_picture> of_the_cpu;
    for (const words& more : kinds) {
        for (const std::string& backend : backends) {
            const outcome o = drawn(backend, more);
            if (o.code == 3 && !is_required(backend)) {
                continue;
            }
            ASSERT_EQ(o.code, 0) << backend << o.err;
            EXPECT_TRUE(has(o.out, {"a.png: 300 particles, 32 x 32 x 32 voxels", backend}));
            const read_picture picture = read_png(in_folder("a.png"));
            ASSERT_EQ(picture.width, 160);
            ASSERT_EQ(picture.height, 100);
            if (backend == "cpu") {
                of_the_cpu.push_back(picture);
                continue;
            }
            const auto found = compare(picture, of_the_cpu.back());
            EXPECT_LT(found.mean, 1) << backend << more[1];
            EXPECT_LE(found.far, 0.005) << backend << more[1];
            RecordProperty(backend + more[1], std::to_string(found.mean));
        }
    }
    // That it sees a difference: no two kinds of light look the same.
    for (std::size_t i = 0; i < of_the_cpu.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            EXPECT_GT(compare(of_the_cpu[i], of_the_cpu[k]).mean, 0.1) << i << ' ' << k;
        }
    }
}

TEST_F(tool_clouds, takes_the_grid_that_is_named) {
    std::vector<skybark::io::vdb_volume> volumes(2);
    const std::vector<float> thin(64, 0.1f);
    const std::vector<float> thick(64, 0.2f);
    volumes[0].name = "smoke";
    volumes[0].values = thin;
    volumes[1].name = "fog";
    volumes[1].values = thick;
    for (skybark::io::vdb_volume& volume : volumes) {
        volume.voxels = {4, 4, 4};
    }
    if (const auto written = skybark::io::write_vdb(in_folder("two.vdb"), volumes); !written) {
        GTEST_SKIP() << written.error().message;
    }
    for (const auto& [grid, depth] : {std::pair{"smoke", 0.4}, std::pair{"fog", 0.8}}) {
        const auto found = probes("cpu", "two.vdb", "2,-5,2\n",
                                  {"--sun", "0,90", "--volume", "32", "--grid", grid});
        ASSERT_EQ(found.size(), 1u);
        // Its edges are smeared over a voxel of the light's.
        EXPECT_NEAR(found[0].optical_depth, depth, 0.02 * depth) << grid;
    }
    std::filesystem::remove(folder / "light.csv");
    expect_failed({"cloud", in_folder("two.vdb"), "-o", in_folder("a.png")},
                  {"two.vdb", "\"smoke\" (float), \"fog\" (float)", "--grid"});
    expect_failed({"cloud", in_folder("two.vdb"), "--grid", "fire", "-o", in_folder("a.png")},
                  {"two.vdb", "\"fire\"", "\"smoke\" (float)"});
}

TEST_F(tool_clouds, volumes_are_the_same_bytes_each_time) {
    const auto saved = [&](const char* sun) {
        const outcome o = skybark({"cloud", in_folder("one.csv"), "--volume", "16", "--sun", sun,
                                   "-o", in_folder("a.vdb")});
        EXPECT_EQ(o.code, 0) << o.err;
        return read_file(folder / "a.vdb");
    };
    const std::string one = saved("120,50");
    EXPECT_EQ(saved("120,50"), one);
    EXPECT_NE(saved("120,51"), one);
}

TEST_F(tool_clouds, draws_densities) {
    if (const auto written = write_layers(in_folder("layers.vdb")); !written) {
        GTEST_SKIP() << written.error().message;
    }
    std::vector<read_picture> pictures;
    for (const std::string& backend : backends) {
        const outcome o =
            skybark({"cloud", in_folder("layers.vdb"), "--extinction", "0.2", "--backend", backend,
                     "-o", in_folder("a.png"), "--size", "120x80", "--volume", "32"});
        if (o.code == 3 && !is_required(backend)) {
            continue;
        }
        ASSERT_EQ(o.code, 0) << o.err;
        pictures.push_back(read_png(in_folder("a.png")));
        EXPECT_LT(compare(pictures.back(), pictures.front()).mean, 1) << backend;
    }
    const outcome o = skybark({"cloud", in_folder("layers.vdb"), "--extinction", "0", "-o",
                               in_folder("a.png"), "--size", "120x80", "--volume", "32"});
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_GT(compare(read_png(in_folder("a.png")), pictures.front()).mean, 3) << "clear air";
}

TEST_F(tool_clouds, built_in_clouds_come_from_their_seed) {
    const auto drawn = [&](const char* cloud, const char* seed) {
        const outcome o =
            skybark({"cloud", cloud, "--seed", seed, "-o", in_folder("a.png"), "--size", "96x60",
                     "--volume", "32", "--particles", "600", "--stats", in_folder("s.json")});
        EXPECT_EQ(o.code, 0) << o.err;
        const auto stats = nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
        EXPECT_EQ(stats["counts"]["particles"], 600);
        return read_png(in_folder("a.png"));
    };
    const auto one = drawn("cumulus", "1");
    EXPECT_EQ(drawn("cumulus", "1").rgba, one.rgba);
    EXPECT_NE(drawn("cumulus", "2").rgba, one.rgba);
    EXPECT_NE(drawn("cumulus_field", "1").rgba, one.rgba);
    const outcome list = skybark({"cloud", "--list"});
    EXPECT_EQ(list.code, 0);
    EXPECT_TRUE(has(list.out, {"cumulus ", "cumulus_field "}));
}

// Two wide particles, and in the second cloud one as deep of a hundredth of their radius: no voxel
// of 2 · 10 m / 29 has its middle within it for sure.
TEST_F(tool_clouds, notes_particles_that_are_smaller_than_voxels) {
    const auto run_with = [&](const std::string& row, words more) {
        write_file(in_folder("c.csv"), header + "0,0,0,10,1,1\n" + row);
        more.insert(more.begin(),
                    {"cloud", in_folder("c.csv"), "-o", in_folder("a.png"), "--size", "16x8",
                     "--volume", "32", "--sun", "0,90", "--stats", in_folder("s.json")});
        outcome o = skybark(more);
        EXPECT_EQ(o.code, 0) << o.err;
        const auto stats = nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
        return std::pair{o, stats["counts"]["thin_particles"].get<int>()};
    };
    const auto [one, none_thin] = run_with("", {});
    EXPECT_EQ(one.err, "");
    EXPECT_EQ(none_thin, 0);
    EXPECT_TRUE(has(one.out, {"a.png: 1 particle, 32 x"}));
    // 0.1² of 10² of the area, times 20: 1/501 of the water.
    const auto [little, one_thin] = run_with("0,0,0,0.1,20,1\n", {});
    EXPECT_EQ(little.err, "");
    EXPECT_EQ(one_thin, 1);
    EXPECT_TRUE(has(little.out, {"a.png: 2 particles, 32 x"}));
    // 0.1² × 1000 of 10² + 0.1² × 1000: 1/11, and 32 · 0.69 / 0.1 voxels a side.
    const auto [noted, still_one] = run_with("0,0,0,0.1,1000,1\n", {});
    EXPECT_EQ(still_one, 1);
    EXPECT_TRUE(is_sentence(noted.err));
    EXPECT_TRUE(has(noted.err, {"1 of 2 particles", "9.1 %", "0.69", "--volume 22"}));
    EXPECT_EQ(run_with("0,0,0,0.1,1000,1\n", {"--quiet"}).first.err, "");
}

TEST_F(tool_clouds, stats_say_what_there_was) {
    const outcome o =
        skybark({"cloud", in_folder("one.csv"), "-o", in_folder("a.png"), "--stats",
                 in_folder("s.json"), "--volume", "20", "--size", "64x48", "--quiet"});
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(o.out, "");
    const auto stats = nlohmann::json::parse(read_file(folder / "s.json"), nullptr, false);
    EXPECT_EQ(stats["command"], "cloud");
    EXPECT_EQ(stats["backend"], "cpu");
    EXPECT_EQ(stats["counts"]["particles"], 1);
    EXPECT_EQ(stats["counts"]["voxels"], 8000);
    // Six metres over the 17 voxels within the margins, and at most 1/32 of an octave more.
    for (const auto& side : stats["voxel"]) {
        EXPECT_GE(side.get<double>(), 6.0 / 17);
        EXPECT_LE(side.get<double>(), 6.0 / 17 * 1.03);
    }
    double sum = 0;
    for (const char* stage : {"read", "build", "light", "draw", "write"}) {
        ASSERT_TRUE(stats["seconds"].contains(stage)) << stage;
        sum += stats["seconds"][stage].get<double>();
    }
    EXPECT_NEAR(stats["seconds"]["total"].get<double>(), sum, 1e-9);
    EXPECT_TRUE(stats["bytes"].contains("up"));
}

// ---- What is wrong ------------------------------------------------------------------------------

TEST_F(tool_clouds, says_what_is_wrong_with_particles) {
    const std::pair<const char*, words> all[] = {
        {"", {"is empty"}},
        {"x,y,z,radius,optical_depth,albedo\n", {"Line 1", "no particles"}},
        {"x,y,z,radius,albedo\n0,0,0,1,1\n", {"Line 1", "optical_depth"}},
        {"x,y,z,radius,optical_depth,albedo\n0,nan,0,1,1,1\n", {"Line 2", "y", "\"nan\""}},
        {"x,y,z,radius,optical_depth,albedo\n0,0,0,-1,1,1\n", {"Line 2", "radius", "\"-1\""}},
        {"x,y,z,radius,optical_depth,albedo\n0,0,0,1,-1,1\n", {"Line 2", "optical_depth"}},
        {"x,y,z,radius,optical_depth,albedo\n0,0,0,1,1,1.5\n", {"Line 2", "albedo", "\"1.5\""}},
        {"x,y,z,radius,optical_depth,albedo\n0,0,0,1,1,1\n0,0,0", {"Line 3", "3 fields"}}};
    for (const auto& [text, parts] : all) {
        write_file(in_folder("bad.csv"), text);
        words expected = parts;
        expected.push_back("bad.csv");
        expect_failed({"cloud", in_folder("bad.csv"), "-o", in_folder("a.png"), "--stats",
                       in_folder("s.json")},
                      expected);
    }
    expect_failed({"cloud", in_folder("none.csv"), "-o", in_folder("a.png")},
                  {"none.csv", "No such file"});
    std::filesystem::create_directory(folder / "folder.csv");
    expect_failed({"cloud", in_folder("folder.csv"), "-o", in_folder("a.png")}, {"directory"});
}

TEST_F(tool_clouds, draws_no_cloud_where_floats_cannot_tell_its_places) {
    const auto with_particle = [&](const std::string& row, const std::string& out) {
        write_file(in_folder("far.csv"), header + row + "\n");
        return words{"cloud", in_folder("far.csv"), "--volume", "8",
                     "-o",    in_folder(out),       "--quiet"};
    };
    expect_failed(with_particle("1e9,0,0,1,1,1", "a.png"),
                  {"far.csv", "2 m", "1e+09 m", "within 1e6 times"});
    EXPECT_EQ(skybark(with_particle("1e5,900,0,1,1,1", "a.png")).code, 0);
    // Its volume is as good as anywhere, but for voxels that doubles lose sight of.
    expect_failed(with_particle("1e9,0,0,1e-6,1,1", "a.png"), {"far.csv", "within 1e6 times"});
    write_file(in_folder("p.csv"), "x,y,z\n1e9,0,0\n");
    words probe = with_particle("1e9,0,0,1,2,1", "light.csv");
    probe.insert(probe.end(), {"--probe", in_folder("p.csv")});
    EXPECT_EQ(skybark(probe).code, 0);
    write_file(in_folder("far.csv"), header + "1e9,0,0,1e-6,2,1\n");
    std::filesystem::remove(folder / "light.csv");
    std::filesystem::remove(folder / "a.png");
    expect_failed(probe, {"far.csv", "1e-12 of that distance"});
}

TEST_F(tool_clouds, says_what_is_wrong_with_points) {
    const auto with_points = [&](const std::string& text, const words& parts) {
        write_file(in_folder("p.csv"), text);
        expect_failed({"cloud", in_folder("one.csv"), "--probe", in_folder("p.csv"), "-o",
                       in_folder("a.csv")},
                      parts);
    };
    with_points("", {"p.csv", "is empty", "x, y and z"});
    with_points("x,y\n1,2\n", {"p.csv", "Line 1", "\"z\""});
    with_points("x,y,z\n1,2,inf\n", {"p.csv", "Line 2", "\"inf\""});
    with_points("x,y,z\n", {"p.csv", "no points"});
    expect_failed(
        {"cloud", in_folder("one.csv"), "--probe", in_folder("none.csv"), "-o", in_folder("a.csv")},
        {"none.csv", "No such file"});
}

TEST_F(tool_clouds, says_what_is_wrong_with_densities) {
    if (const auto written = write_layers(in_folder("layers.vdb")); !written) {
        GTEST_SKIP() << written.error().message;
    }
    const std::string whole = read_file(folder / "layers.vdb");
    const auto damaged = [&](const std::string& bytes, const words& parts) {
        write_file(in_folder("bad.vdb"), bytes);
        expect_failed({"cloud", in_folder("bad.vdb"), "-o", in_folder("a.vdb")}, parts);
    };
    damaged("", {"bad.vdb", "is empty"});
    damaged("x,y,z\n", {"bad.vdb", "begins with"});
    for (const double part : {0.1, 0.4, 0.7, 0.99}) {
        const auto length = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
        damaged(whole.substr(0, length), {"bad.vdb", "ends too early"});
    }
    damaged(whole.substr(0, 8) + std::string(5000, '\xa7'), {"bad.vdb"});
}

// A billion voxels are 8 GB, and are refused before any is asked for.
TEST_F(tool_clouds, counts_voxels_before_it_makes_them) {
    for (const char* side : {"1000", "4000", "65536"}) {
        for (const std::string& backend : backends) {
            const outcome o = skybark({"cloud", in_folder("one.csv"), "--volume", side, "--backend",
                                       backend, "-o", in_folder("a.png")});
            if (o.code == 3 && !is_required(backend)) {
                continue;
            }
            EXPECT_EQ(o.code, 1) << o.err;
            EXPECT_TRUE(is_sentence(o.err));
            EXPECT_TRUE(has(o.err, {side, "voxels"})) << backend;
        }
    }
    EXPECT_EQ(names(), std::set<std::string>{"one.csv"});
}

TEST_F(tool_clouds, refuses_a_wrong_command_line) {
    const auto refused = [&](words arguments, const words& parts) {
        arguments.insert(arguments.begin(), "cloud");
        const outcome o = skybark(std::move(arguments));
        EXPECT_EQ(o.code, 2) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
        EXPECT_EQ(names(), std::set<std::string>{"one.csv"});
    };
    const std::string one = in_folder("one.csv");
    const std::string out = in_folder("a.png");
    refused({}, {"INPUT"});
    refused({one}, {"-o OUT"});
    refused({one, "-o", in_folder("a.jpg")}, {"-o", ".png", ".vdb"});
    refused({in_folder("a.obj"), "-o", out}, {"INPUT", "cumulus"});
    for (const char* side : {"0", "-5", "nan", "1e3", "100000", ""}) {
        refused({one, "-o", out, std::string("--volume=") + side}, {"--volume"});
    }
    refused({one, "-o", out, "--sun", "120"}, {"--sun", "AZIMUTH,ELEVATION"});
    refused({one, "-o", out, "--probe", "p.csv"}, {"--probe", ".csv"});
    refused({one, "-o", in_folder("a.csv")}, {"--probe POINTS.csv"});
    refused({one, "-o", in_folder("a.csv"), "--probe", one}, {"the same file"});
    refused({one, "-o", out, "--stats", out}, {"the same file"});
    refused({one, "-o", out, "--stats", ""}, {"--stats is empty"});
    refused({one, "-o", out, "--seed", "2"}, {"--seed", "is a file"});
    refused({one, "-o", in_folder("a.vdb"), "--size", "64x48"}, {"--size", "no picture"});
    refused({one, "-o", out, "--grid", "density"}, {"--grid", ".vdb"});
    refused({"--list", "-o", out}, {"--list", "-o"});
    refused({"--list", "cumulus"}, {"--list", "INPUT"});
    refused({one, "-o", out, "--backend", "metal"}, {"--backend", "metal"});
    refused({one, "-o", out, "--what"}, {"--what"});
    EXPECT_EQ(skybark({"cloud", one, "-o", out, "--device", "9"}).code, 3);
}

TEST_F(tool_clouds, leaves_no_half_of_a_file) {
    write_file(in_folder("p.csv"), "x,y,z\n0,0,0\n");
    const auto expect_unwritten = [&](const std::string& out, words more, const std::string& why) {
        more.insert(more.begin(), {"cloud", in_folder("one.csv"), "--volume", "16", "-o", out});
        const outcome o = skybark_after("ulimit -f 1", more);
        EXPECT_EQ(o.code, 1) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, {out, why}));
    };
    expect_unwritten(in_folder("a.png"), {}, "File too large");
    const outcome long_name =
        skybark({"cloud", in_folder("one.csv"), "-o", in_folder(std::string(252, 'n') + ".png")});
    EXPECT_EQ(long_name.code, 1);
    EXPECT_TRUE(has(long_name.err, {"can't be written: its name has 256 bytes"}));
    expect_unwritten(in_folder("no/such/a.png"), {}, "no folder");
    expect_unwritten(in_folder("no/such/a.csv"), {"--probe", in_folder("p.csv")}, "no folder");
    std::filesystem::create_symlink("/dev/full", folder / "full.vdb");
    std::filesystem::create_symlink("/dev/full", folder / "full.csv");
    if (write_layers(in_folder("layers.vdb"))) {
        expect_unwritten(in_folder("full.vdb"), {}, "No space left");
    }
    expect_unwritten(in_folder("full.csv"), {"--probe", in_folder("p.csv")}, "No space left");
    std::filesystem::remove(folder / "layers.vdb");
    EXPECT_EQ(names(), (std::set<std::string>{"one.csv", "p.csv", "full.csv", "full.vdb"}));
}
