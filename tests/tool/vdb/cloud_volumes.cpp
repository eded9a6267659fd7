// Volumes that the tool writes, read by OpenVDB: each voxel is where a probe of the same place says
// the same.

#include "../support.hpp"

#include <cmath>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <sstream>

using namespace skybark::tests;

namespace {

openvdb::FloatGrid::Ptr read_grid(const std::string& path, const std::string& name) {
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
}

/// The last columns of a table of places.
std::vector<std::pair<double, double>> read_light(const std::filesystem::path& path) {
    std::istringstream lines(read_file(path));
    std::string line;
    std::getline(lines, line);
    std::vector<std::pair<double, double>> all;
    while (std::getline(lines, line)) {
        double x = 0, y = 0, z = 0, depth = 0, light = 0;
        char comma = 0;
        std::istringstream(line) >> x >> comma >> y >> comma >> z >> comma >> depth >> comma >>
            light;
        all.emplace_back(depth, light);
    }
    return all;
}

} // namespace

TEST_F(tool, a_volume_says_what_its_places_say) {
    write_file(in_folder("c.csv"), "x,y,z,radius,optical_depth,albedo\n"
                                   "1000,500,-200,30,2,1\n1010,520,-190,25,1,0.8\n");
    for (const char* backend : {"cpu", "opengl", "vulkan"}) {
        for (const char* format : {"", "--half"}) {
            const auto with = [&](words more) {
                more.insert(more.begin(),
                            {"cloud", in_folder("c.csv"), "--sun", "35,25", "--volume", "20",
                             "--light", "multiple", "--backend", backend});
                if (*format != '\0') {
                    more.push_back(format);
                }
                return skybark(more);
            };
            const outcome volume = with({"-o", in_folder("v.vdb")});
            SKYBARK_SKIP_UNAVAILABLE(volume, backend);
            ASSERT_EQ(volume.code, 0) << volume.err;
            const auto depth = read_grid(in_folder("v.vdb"), "optical_depth");
            const auto attenuation = read_grid(in_folder("v.vdb"), "attenuation");
            const auto fluence = read_grid(in_folder("v.vdb"), "diffuse_fluence");
            ASSERT_TRUE(depth && attenuation && fluence);
            EXPECT_EQ(depth->saveFloatAsHalf(), *format != '\0');
            EXPECT_EQ(attenuation->saveFloatAsHalf(), *format != '\0');
            EXPECT_FALSE(fluence->saveFloatAsHalf()) << "it is whole floats on the device";

            std::string points = "x,y,z\n";
            std::vector<openvdb::Coord> cells;
            for (auto value = depth->cbeginValueOn(); value; ++value) {
                const openvdb::Coord at = value.getCoord();
                cells.push_back(at);
                const openvdb::Vec3d place = depth->indexToWorld(at.asVec3d());
                points += std::to_string(place.x()) + "," + std::to_string(place.y()) + "," +
                          std::to_string(place.z()) + "\n";
            }
            ASSERT_GT(cells.size(), 1000u);
            write_file(in_folder("p.csv"), points);
            const outcome probes =
                with({"--probe", in_folder("p.csv"), "-o", in_folder("light.csv")});
            ASSERT_EQ(probes.code, 0) << probes.err;
            const auto found = read_light(folder / "light.csv");
            ASSERT_EQ(found.size(), cells.size());
            const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler>
                scattered(*fluence);
            std::size_t compared = 0;
            for (std::size_t i = 0; i < cells.size(); ++i) {
                // Places are rounded to 6e-5 m there, of voxels of 5 m: 1e-5 of what lies between
                // neighbours.
                ASSERT_NEAR(found[i].first, depth->tree().getValue(cells[i]), 1e-4) << backend;
                // What was never scattered, and what was: between the middles of cells twice as
                // wide, by OpenVDB's own sampler, which knows nothing outside the grid.
                const openvdb::Vec3d place = depth->indexToWorld(cells[i].asVec3d());
                const openvdb::Vec3d cell = fluence->worldToIndex(place);
                if (cell.x() < 0 || cell.y() < 0 || cell.z() < 0) {
                    continue;
                }
                const double direct = std::exp(-attenuation->tree().getValue(cells[i]));
                ASSERT_NEAR(found[i].second, direct + double{scattered.wsSample(place)}, 1e-4)
                    << backend;
                ++compared;
            }
            EXPECT_GT(compared, 1000u);
        }
    }
}

TEST_F(tool, a_volume_says_what_it_is) {
    write_file(in_folder("c.csv"), "x,y,z,radius,optical_depth,albedo\n0,0,0,30,2,1\n");
    const outcome o =
        skybark({"cloud", in_folder("c.csv"), "--sun", "90,30", "--volume", "16", "--light",
                 "multiple", "--phase", "hg:0.5", "-o", in_folder("v.vdb")});
    ASSERT_EQ(o.code, 0) << o.err;
    const auto text = [](const openvdb::FloatGrid& grid, const char* key) {
        return grid.metaValue<std::string>(key);
    };
    for (const char* name : {"optical_depth", "attenuation", "diffuse_fluence"}) {
        const auto grid = read_grid(in_folder("v.vdb"), name);
        ASSERT_TRUE(grid);
        // At 90,30 the sun stands in the east, half as high as far: cos 30°, sin 30°.
        const auto sun = grid->metaValue<openvdb::Vec3s>("to_sun");
        EXPECT_NEAR(sun.x(), std::sqrt(0.75), 1e-6);
        EXPECT_NEAR(sun.y(), 0.5, 1e-6);
        EXPECT_NEAR(sun.z(), 0, 1e-6);
        EXPECT_EQ(grid->metaValue<float>("sun_azimuth"), 90);
        EXPECT_EQ(grid->metaValue<float>("sun_elevation"), 30);
        EXPECT_EQ(text(*grid, "units"), "1");
        EXPECT_EQ(text(*grid, "profile"), "erf");
        EXPECT_EQ(text(*grid, "method"), "impulse_scan");
        EXPECT_EQ(grid->metaValue<float>("sigmas"), 3);
        EXPECT_TRUE(has(text(*grid, "creator"), {"Skybark 0."}));
        EXPECT_GT(text(*grid, "description").size(), 40u);
    }
    const auto depth = read_grid(in_folder("v.vdb"), "optical_depth");
    EXPECT_TRUE(has(text(*depth, "outside"), {"undermost layer", "goes on"}));
    EXPECT_EQ(text(*depth, "light"), "extinction");
    const auto attenuation = read_grid(in_folder("v.vdb"), "attenuation");
    EXPECT_EQ(text(*attenuation, "light"), "continuum");
    EXPECT_EQ(attenuation->metaValue<float>("forward"), 0.25f) << "g²";
    EXPECT_EQ(text(*read_grid(in_folder("v.vdb"), "diffuse_fluence"), "light"), "multiple");
}

// One voxel that a simulation left far away: the sentence says how far.
TEST_F(tool, says_where_a_stray_voxel_is) {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(0.0f);
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(2.0));
    grid->tree().setValue({0, 0, 0}, 1.0f);
    const auto refused = [&](int far) {
        grid->tree().setValue({far, 9, 9}, 1.0f);
        openvdb::io::File file(in_folder("stray.vdb"));
        file.write({grid});
        file.close();
        const outcome o = skybark({"cloud", in_folder("stray.vdb"), "-o", in_folder("a.png")});
        EXPECT_EQ(o.code, 1);
        EXPECT_TRUE(is_sentence(o.err));
        return o.err;
    };
    // More than a volume's side may have on any device, and more than any file.
    EXPECT_TRUE(has(refused(99999), {"stray.vdb", "100000 x 10 x 10",
                                     "reach from (-1, -1, -1) to (199999, 19, 19) m."}));
    EXPECT_TRUE(
        has(refused(99999999), {"stray.vdb", "100000000 x 10 x 10 in its grid \"density\"",
                                "from the index (0, 0, 0) to (99999999, 9, 9); expected at most"}));
}
