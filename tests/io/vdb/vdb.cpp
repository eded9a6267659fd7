// VDB files: what OpenVDB wrote is read, what we write OpenVDB reads, and nothing that is broken
// brings anything down.

#include "support/temporary_name.hpp"

#include <io/vdb.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <random>
#include <sys/stat.h>
#include <tbb/global_control.h>

using namespace skybark;

namespace {

struct temporary_path {
    explicit temporary_path(const std::string& name)
        : path(support::temporary_name(name).string()) {}
    temporary_path(const temporary_path&) = delete;
    temporary_path& operator=(const temporary_path&) = delete;
    ~temporary_path() { std::filesystem::remove(path); }
    void write(const std::string& bytes) const { std::ofstream(path, std::ios::binary) << bytes; }
    [[nodiscard]] std::string bytes() const {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::string path;
};

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

/// The sentence that the file gets; empty if it is read.
std::string complaint(const std::string& path, std::string_view grid = {}) {
    const auto read = io::read_vdb(path, grid);
    return read ? std::string() : read.error().message;
}

class vdb : public testing::Test {
  protected:
    void SetUp() override { openvdb::initialize(); }

    /// The files are made here, in the process that the reader forks. A worker of OpenVDB's that is
    /// inside of a lock at that time is gone in the child, and the lock is never opened: no
    /// workers.
    tbb::global_control no_workers{tbb::global_control::max_allowed_parallelism, 1};

    static openvdb::FloatGrid::Ptr fog(const std::string& name) {
        auto grid = openvdb::FloatGrid::create(0.0f);
        grid->setName(name);
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        return grid;
    }
    /// 21 x 13 x 17 values around the origin, some of them 0 and inactive.
    static openvdb::FloatGrid::Ptr blob() {
        auto grid = fog("density");
        auto values = grid->getAccessor();
        for (int x = -10; x <= 10; ++x)
            for (int y = -6; y <= 6; ++y)
                for (int z = 3; z < 20; ++z)
                    if (value_at(x, y, z) > 0)
                        values.setValue({x, y, z}, value_at(x, y, z));
        return grid;
    }
    static float value_at(int x, int y, int z) {
        return (x + y + z) % 3 == 0 && std::abs(x) != 10
                   ? 0.0f
                   : static_cast<float>(100 * x * x + 10 * z) + static_cast<float>(y + 7) / 16;
    }
    static void save(const std::string& path, const openvdb::GridPtrVec& grids,
                     std::uint32_t compression = openvdb::io::COMPRESS_BLOSC |
                                                 openvdb::io::COMPRESS_ACTIVE_MASK) {
        openvdb::io::File file(path);
        file.setCompression(compression);
        file.write(grids);
        file.close();
    }
    static void expect_blob(const io::density_grid& grid) {
        ASSERT_EQ(grid.voxels, glm::uvec3(21, 13, 17));
        ASSERT_EQ(grid.density.size(), 21u * 13 * 17);
        for (int z = 0; z < 17; ++z)
            for (int y = 0; y < 13; ++y)
                for (int x = 0; x < 21; ++x)
                    ASSERT_EQ(grid.density[static_cast<std::size_t>(x + 21 * (y + 13 * z))],
                              value_at(x - 10, y - 6, z + 3))
                        << x << ' ' << y << ' ' << z;
    }
};

} // namespace

TEST_F(vdb, reads_each_voxel_where_it_is) {
    const temporary_path file("blob.vdb");
    const auto grid = blob();
    auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    transform->postScale(openvdb::Vec3d(1, 2, 4));
    transform->postTranslate(openvdb::Vec3d(10, 20, -30));
    grid->setTransform(transform);
    save(file.path, {grid});
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    expect_blob(*read);
    EXPECT_EQ(read->voxel, glm::vec3(0.5f, 1, 2));
    // The library says where the middle of the first voxel is.
    const openvdb::Vec3d middle = grid->indexToWorld(openvdb::Vec3d(-10, -6, 3));
    const glm::vec3 ours = read->low + 0.5f * read->voxel;
    EXPECT_EQ(ours, glm::vec3(middle.x(), middle.y(), middle.z()));
    EXPECT_EQ(read->low, glm::vec3(4.75f, 13.5f, -25));
}

TEST_F(vdb, reads_every_compression) {
    const temporary_path file("compressed.vdb");
    using namespace openvdb::io;
    const std::uint32_t all[] = {COMPRESS_NONE, COMPRESS_ZIP, COMPRESS_ACTIVE_MASK,
                                 COMPRESS_ZIP | COMPRESS_ACTIVE_MASK,
                                 COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK};
    for (const std::uint32_t compression : all) {
        save(file.path, {blob()}, compression);
        const auto read = io::read_vdb(file.path);
        ASSERT_TRUE(read) << read.error().message;
        expect_blob(*read);
    }
    // A stream, without the places of its grids.
    std::ofstream out(file.path, std::ios::binary);
    openvdb::io::Stream(out).write(openvdb::GridCPtrVec{blob()});
    out.close();
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    expect_blob(*read);
}

TEST_F(vdb, reads_floats_of_sixteen_bits) {
    const temporary_path file("half.vdb");
    const auto grid = fog("density");
    grid->tree().setValue({0, 0, 0}, 0.375f);
    grid->tree().setValue({1, 0, 0}, 100.0f);
    grid->setSaveFloatAsHalf(true);
    save(file.path, {grid});
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->density, (std::vector<float>{0.375f, 100.0f}));
}

TEST_F(vdb, fills_tiles) {
    const temporary_path file("tiles.vdb");
    const auto grid = fog("density");
    // 8³ voxels are a leaf; a box of 40³ has leaves inside that are stored as one value.
    grid->fill(openvdb::CoordBBox({-20, -20, -20}, {19, 19, 19}), 0.25f);
    grid->tree().setValue({-21, 0, 0}, 1.0f);
    ASSERT_GT(grid->tree().activeTileCount(), 0u);
    save(file.path, {grid});
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->voxels, glm::uvec3(41, 40, 40));
    std::size_t quarters = 0;
    for (const float value : read->density)
        quarters += value == 0.25f ? 1 : 0;
    EXPECT_EQ(quarters, 64000u);
    EXPECT_EQ(read->density[0 + 41 * (20 + 40 * 20)], 1.0f);
    EXPECT_EQ(read->density[0], 0.0f);
}

TEST_F(vdb, takes_no_value_from_what_is_inactive) {
    const temporary_path file("background.vdb");
    const auto grid = openvdb::FloatGrid::create(5.0f);
    grid->tree().setValue({0, 0, 0}, 1.0f);
    grid->tree().setValue({2, 0, 0}, 2.0f);
    save(file.path, {grid});
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->density, (std::vector<float>{1, 0, 2}));
}

TEST_F(vdb, chooses_the_grid_of_density) {
    const temporary_path file("several.vdb");
    const auto velocity = openvdb::Vec3SGrid::create();
    velocity->setName("vel");
    velocity->tree().setValue({0, 0, 0}, openvdb::Vec3s(1, 2, 3));
    const auto surface =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.0f, {0, 0, 0}, 1.0f);
    surface->setName("surface");
    const auto heat = fog("temperature");
    heat->tree().setValue({0, 0, 0}, 300.0f);
    const auto density = fog("density");
    density->tree().setValue({4, 5, 6}, 0.5f);

    save(file.path, {velocity, surface, heat, density});
    auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->density, std::vector<float>{0.5f}) << "by name";
    EXPECT_EQ(read->low, glm::vec3(3.5f, 4.5f, 5.5f));

    save(file.path, {velocity, surface, heat});
    read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->density, std::vector<float>{300.0f}) << "the only one that can be one";

    save(file.path, {velocity, surface});
    EXPECT_TRUE(has(complaint(file.path), "has no density but \"vel\" (vec3s), \"surface\" "
                                          "(float); expected a grid of float or double"));
    save(file.path, {});
    EXPECT_TRUE(has(complaint(file.path), "has no grid; expected a density."));
    save(file.path, {fog("density")});
    EXPECT_TRUE(has(complaint(file.path), "has no active voxel in its grid \"density\""));
}

TEST_F(vdb, takes_the_grid_that_is_named) {
    const temporary_path file("named.vdb");
    const auto velocity = openvdb::Vec3SGrid::create();
    velocity->setName("vel");
    velocity->tree().setValue({0, 0, 0}, openvdb::Vec3s(1, 2, 3));
    openvdb::GridPtrVec grids{velocity};
    float value = 1;
    for (const char* name : {"smoke", "heat", "density"}) {
        const auto grid = fog(name);
        grid->tree().setValue({0, 0, 0}, value++);
        grids.push_back(grid);
    }
    save(file.path, grids);
    for (const auto& [name, expected] :
         {std::pair{"", 3.0f}, std::pair{"smoke", 1.0f}, std::pair{"heat", 2.0f}}) {
        const auto read = io::read_vdb(file.path, name);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(read->density, std::vector<float>{expected}) << name;
    }
    EXPECT_TRUE(has(complaint(file.path, "fire"), "has no density \"fire\" but \"vel\" (vec3s), "
                                                  "\"smoke\" (float), \"heat\" (float)"));
    EXPECT_TRUE(has(complaint(file.path, "vel"), "has no density \"vel\" but"));
    grids.pop_back();
    save(file.path, grids);
    EXPECT_TRUE(
        has(complaint(file.path),
            "has several grids, and none is called \"density\": \"smoke\" (float), \"heat\" "
            "(float); expected the name of one of them (--grid)."));
}

TEST_F(vdb, reads_doubles) {
    const temporary_path file("doubles.vdb");
    const auto grid = openvdb::DoubleGrid::create(0.0);
    grid->setName("density");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(2.0));
    // A tile as well, of 8³ voxels.
    grid->fill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), 0.1);
    grid->tree().setValue({8, 0, 0}, 1e300);
    save(file.path, {grid});
    EXPECT_TRUE(has(complaint(file.path), "has the density inf at the index (8, 0, 0)"));
    grid->tree().setValue({8, 0, 0}, 0.25);
    save(file.path, {grid});
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->voxels, glm::uvec3(9, 8, 8));
    EXPECT_EQ(read->voxel, glm::vec3(2));
    EXPECT_EQ(read->low, glm::vec3(-1));
    EXPECT_EQ(read->density[0], 0.1f);
    EXPECT_EQ(read->density[8], 0.25f);
    EXPECT_EQ(read->density[17], 0.0f);
}

// Each voxel is where the library says that it is, in any of the 48 ways to lay it along the axes.
TEST_F(vdb, turns_by_quarters_and_mirrors) {
    const temporary_path file("turned.vdb");
    const double sides[] = {0.5, 1, 2};
    int axes[] = {0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            openvdb::Mat4d m = openvdb::Mat4d::identity();
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column)
                    m(row, column) =
                        axes[row] == column ? ((signs >> row & 1) != 0 ? -1 : 1) * sides[row] : 0;
            m.setTranslation(openvdb::Vec3d(10, 20, -30));
            const auto grid = fog("density");
            const openvdb::Coord cells[] = {{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {1, 2, 4}, {-1, 3, 2}};
            for (int i = 0; i < 5; ++i)
                grid->tree().setValue(cells[i], static_cast<float>(i + 1));
            grid->setTransform(openvdb::math::Transform::createLinearTransform(m));
            save(file.path, {grid});
            const auto read = io::read_vdb(file.path);
            ASSERT_TRUE(read) << read.error().message;
            ASSERT_EQ(read->density.size(), 3u * 4 * 5);
            double sum = 0;
            for (const float value : read->density)
                sum += double{value};
            EXPECT_EQ(sum, 15);
            for (int i = 0; i < 5; ++i) {
                const openvdb::Vec3d place = grid->indexToWorld(cells[i]);
                const glm::vec3 at =
                    (glm::vec3(place.x(), place.y(), place.z()) - read->low) / read->voxel - 0.5f;
                const glm::uvec3 cell(at);
                ASSERT_EQ(at, glm::vec3(cell)) << signs;
                ASSERT_EQ(
                    read->density[cell.x + read->voxels.x * (cell.y + read->voxels.y * cell.z)],
                    static_cast<float>(i + 1))
                    << signs;
            }
        }
    } while (std::next_permutation(axes, axes + 3));
}

TEST_F(vdb, refuses_values_that_are_none) {
    const temporary_path file("values.vdb");
    const float infinity = std::numeric_limits<float>::infinity();
    for (const auto& [value, text] :
         {std::pair{std::numeric_limits<float>::quiet_NaN(), "nan"}, std::pair{-0.5f, "-0.5"},
          std::pair{infinity, "inf"}, std::pair{-infinity, "-inf"}}) {
        const auto grid = blob();
        grid->tree().setValue({-3, 2, 14}, value);
        save(file.path, {grid});
        const std::string sentence = complaint(file.path);
        EXPECT_TRUE(has(sentence, file.path));
        EXPECT_TRUE(has(sentence, std::string("has the density ") + text +
                                      " at the index (-3, 2, 14); expected finite numbers"));
    }
    const auto tiles = fog("density");
    tiles->fill(openvdb::CoordBBox({0, 0, 0}, {127, 127, 127}), -1.0f);
    save(file.path, {tiles});
    EXPECT_TRUE(has(complaint(file.path), "has the density -1 at the index ("));
}

TEST_F(vdb, refuses_transforms_that_lay_no_box_along_the_axes) {
    const temporary_path file("transform.vdb");
    const auto expect_refused = [&](const openvdb::math::Transform::Ptr& transform,
                                    std::string_view part) {
        const auto grid = blob();
        grid->setTransform(transform);
        save(file.path, {grid});
        EXPECT_TRUE(has(complaint(file.path), part));
    };
    using openvdb::math::Transform;
    auto turned = Transform::createLinearTransform(1.0);
    turned->postRotate(0.1, openvdb::math::Y_AXIS);
    expect_refused(turned, "has a transform that turns by other than quarters, shears or tapers");
    auto sheared = Transform::createLinearTransform(1.0);
    sheared->postShear(0.5, openvdb::math::X_AXIS, openvdb::math::Z_AXIS);
    expect_refused(sheared, "shears or tapers");
    expect_refused(Transform::createFrustumTransform(
                       openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 10.0, 1.0),
                   "shears or tapers");
    auto far = Transform::createLinearTransform(1.0);
    far->postTranslate(openvdb::Vec3d(1e12, 0, 0));
    expect_refused(far, "1e+12 m");
    // Four quarters of a turn leave a little of what should be nothing.
    auto round = Transform::createLinearTransform(2.0);
    for (int i = 0; i < 4; ++i)
        round->postRotate(std::acos(-1.0) / 2, openvdb::math::Y_AXIS);
    const auto grid = blob();
    grid->setTransform(round);
    save(file.path, {grid});
    EXPECT_EQ(complaint(file.path), "");
}

// Two voxels far apart: the file has a kilobyte and the box has more voxels than atoms in a cup.
TEST_F(vdb, counts_voxels_before_it_asks_for_memory) {
    const temporary_path file("sparse.vdb");
    for (const int far : {3000, 2'000'000'000}) {
        const auto grid = fog("density");
        grid->tree().setValue({-far, -far, -far}, 1.0f);
        grid->tree().setValue({far, far, far}, 1.0f);
        save(file.path, {grid});
        const std::string side = std::to_string(2 * std::int64_t{far} + 1);
        const std::string sentence = complaint(file.path);
        EXPECT_TRUE(has(sentence, file.path));
        EXPECT_TRUE(has(sentence, "in a box of " + side + " x " + side + " x " + side +
                                      " in its grid \"density\", from the index "));
        const std::string last = std::to_string(far);
        EXPECT_TRUE(has(sentence, "(-" + last + ", -" + last + ", -" + last + ") to (" + last +
                                      ", " + last + ", " + last +
                                      "); expected at most 1073741824"));
    }
    // A line of 2^31, whose number of layers and rows no int has.
    const auto line = fog("density");
    line->tree().setValue({-(1 << 30), 0, 0}, 1.0f);
    line->tree().setValue({(1 << 30) - 1, 0, 0}, 1.0f);
    save(file.path, {line});
    EXPECT_TRUE(has(complaint(file.path), "in a box of 2147483648 x 1 x 1 in its grid"));
}

TEST_F(vdb, refuses_places_that_floats_cannot_tell_apart) {
    const temporary_path file("far.vdb");
    const auto saved_at = [&](double side, double x) {
        const auto grid = fog("density");
        grid->tree().setValue({0, 0, 0}, 1.0f);
        grid->tree().setValue({3, 3, 3}, 1.0f);
        auto placed = openvdb::math::Transform::createLinearTransform(side);
        placed->postTranslate(openvdb::Vec3d(x, 0, 0));
        grid->setTransform(placed);
        save(file.path, {grid});
        return complaint(file.path);
    };
    EXPECT_TRUE(has(saved_at(1e-3, 1e9), "0.004 m long and reaches 1e+09 m"));
    EXPECT_TRUE(has(saved_at(1, -1e7), "within 1e6 times its sides"));
    EXPECT_EQ(saved_at(100, 1e8), "");
}

// A child would wait for a second writer, for ever.
TEST_F(vdb, reads_no_pipes) {
    const temporary_path file("pipe.vdb");
    ASSERT_EQ(::mkfifo(file.path.c_str(), 0600), 0);
    EXPECT_TRUE(has(complaint(file.path), "is a pipe or a device"));
    EXPECT_TRUE(has(complaint("/dev/null"), "is a pipe or a device"));
}

TEST_F(vdb, refuses_what_is_no_file_of_its_kind) {
    const std::string folder = std::filesystem::temp_directory_path().string();
    EXPECT_TRUE(has(complaint(folder), "is a directory; expected a file."));
    EXPECT_TRUE(has(complaint(folder + "/skybark_no_such.vdb"), "can't be opened: No such file"));
    const temporary_path file("other.vdb");
    file.write("");
    EXPECT_TRUE(has(complaint(file.path), "is empty; expected a VDB file."));
    file.write("x,y,z\n1,2,3\n");
    EXPECT_TRUE(has(complaint(file.path), "begins with \"x,y,z\\x0a1,\"; expected a VDB file."));
    file.write(std::string(" BDV\0\0\0\0", 8));
    EXPECT_TRUE(has(complaint(file.path), "ends too early"));
}

TEST_F(vdb, says_at_every_length_that_a_file_is_cut_off) {
    const temporary_path file("cut.vdb");
    save(file.path, {blob()});
    const std::string whole = file.bytes();
    ASSERT_GT(whole.size(), 1000u);
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 12) {
        file.write(whole.substr(0, length));
        const std::string sentence = complaint(file.path);
        EXPECT_TRUE(has(sentence, file.path)) << length;
        EXPECT_TRUE(has(sentence, length == 0  ? "is empty"
                                  : length < 8 ? "begins with"
                                               : "ends too early or is damaged"))
            << length;
    }
    file.write(whole.substr(0, whole.size() - 1));
    EXPECT_TRUE(has(complaint(file.path), "ends too early or is damaged"));
}

// What is damaged is a grid or a sentence: it never takes this process with it, nor is it waited
// for.
TEST_F(vdb, survives_any_damage) {
    const temporary_path file("damaged.vdb");
    save(file.path, {blob()});
    const std::string whole = file.bytes();
    std::mt19937 random(11);
    int sentences = 0;
    constexpr int times = 120;
    for (int i = 0; i < times; ++i) {
        std::string bytes = whole;
        const auto at = [&] { return random() % bytes.size(); };
        switch (i % 3) {
        case 0: // some bytes
            for (int k = 0; k < 4; ++k)
                bytes[at()] = static_cast<char>(random());
            break;
        case 1: { // a run of noise
            const std::size_t from = 8 + at() % (bytes.size() - 8);
            for (std::size_t k = from; k < std::min(bytes.size(), from + 64); ++k)
                bytes[k] = static_cast<char>(random());
            break;
        }
        default: // all but the beginning
            for (std::size_t k = 8 + at() / 4; k < bytes.size(); ++k)
                bytes[k] = static_cast<char>(random());
        }
        file.write(bytes);
        const auto read = io::read_vdb(file.path);
        if (read) {
            EXPECT_EQ(read->density.size(),
                      std::size_t{read->voxels.x} * read->voxels.y * read->voxels.z);
            continue;
        }
        ++sentences;
        EXPECT_TRUE(has(read.error().message, file.path));
        EXPECT_EQ(read.error().message.back(), '.');
    }
    EXPECT_GT(sentences, times / 3);
}

TEST_F(vdb, writes_what_the_library_reads) {
    const temporary_path file("written.vdb");
    const std::uint32_t sides[] = {5, 3, 11};
    std::vector<float> values(5 * 3 * 11);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = i % 4 == 0 ? 0.0f : static_cast<float>(i) / 8;
    // Voxel coordinates to metres: turned a quarter about x, sides of 2, 3 and 4 m, moved.
    io::vdb_volume volume;
    volume.name = "optical_depth";
    volume.values = values;
    volume.voxels = {sides[0], sides[1], sides[2]};
    volume.to_world = glm::dmat4(glm::dvec4(2, 0, 0, 0), glm::dvec4(0, 0, 3, 0),
                                 glm::dvec4(0, -4, 0, 0), glm::dvec4(100, 200, 300, 1));
    const auto written = io::write_vdb(file.path, std::span(&volume, 1));
    ASSERT_TRUE(written) << written.error().message;

    openvdb::io::File in(file.path);
    in.open(false);
    ASSERT_TRUE(in.hasGrid("optical_depth"));
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(in.readGrid("optical_depth"));
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
    for (int z = 0; z < 11; ++z)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 5; ++x) {
                const float value = values[static_cast<std::size_t>(x + 5 * (y + 3 * z))];
                const openvdb::Coord at(x, y, z);
                ASSERT_EQ(grid->tree().getValue(at), value);
                ASSERT_EQ(grid->tree().isValueOn(at), value != 0);
                // The voxel's middle, half a voxel from its lower corner.
                const openvdb::Vec3d world = grid->indexToWorld(at.asVec3d());
                ASSERT_NEAR(world.x(), 100 + 2 * (x + 0.5), 1e-9);
                ASSERT_NEAR(world.y(), 200 - 4 * (z + 0.5), 1e-9);
                ASSERT_NEAR(world.z(), 300 + 3 * (y + 0.5), 1e-9);
            }
}

TEST_F(vdb, reads_what_it_wrote) {
    const temporary_path file("again.vdb");
    const std::vector<float> values{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    io::vdb_volume volume;
    volume.name = "density";
    volume.values = values;
    volume.voxels = {2, 3, 2};
    volume.to_world = glm::dmat4(glm::dvec4(0.5, 0, 0, 0), glm::dvec4(0, 0.25, 0, 0),
                                 glm::dvec4(0, 0, 8, 0), glm::dvec4(-1, -2, -3, 1));
    ASSERT_TRUE(io::write_vdb(file.path, std::span(&volume, 1)));
    const auto read = io::read_vdb(file.path);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->density, values);
    EXPECT_EQ(read->voxels, glm::uvec3(2, 3, 2));
    EXPECT_EQ(read->voxel, glm::vec3(0.5f, 0.25f, 8));
    EXPECT_EQ(read->low, glm::vec3(-1, -2, -3));
}

// The library would put a number from a dice into each header.
TEST_F(vdb, writes_the_same_bytes_of_the_same_volume) {
    const temporary_path one("one.vdb");
    const temporary_path other("other.vdb");
    std::vector<float> values(20 * 30 * 10);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i % 7);
    io::vdb_volume volume;
    volume.name = "density";
    volume.values = values;
    volume.voxels = {20, 30, 10};
    volume.notes = {{"units", "1"}};
    const auto identifier = [](const temporary_path& file) {
        openvdb::io::File in(file.path);
        in.open(false);
        return in.getUniqueTag();
    };
    ASSERT_TRUE(io::write_vdb(one.path, std::span(&volume, 1)));
    ASSERT_TRUE(io::write_vdb(other.path, std::span(&volume, 1)));
    EXPECT_EQ(one.bytes(), other.bytes());
    const std::string tag = identifier(one);
    EXPECT_EQ(identifier(other), tag);
    ASSERT_EQ(tag.size(), 36u);
    EXPECT_EQ(tag[14], '8') << "the version of such an identifier, RFC 9562";
    EXPECT_TRUE(has("89ab", std::string(1, tag[19]))) << "its variant";
    values[4000] = 1.5f;
    ASSERT_TRUE(io::write_vdb(other.path, std::span(&volume, 1)));
    EXPECT_NE(identifier(other), tag) << "of other values";
}

TEST_F(vdb, writes_floats_of_sixteen_bits_and_what_they_are) {
    const temporary_path whole("whole.vdb");
    const temporary_path halved("half_out.vdb");
    std::vector<float> values(16 * 16 * 16);
    std::mt19937 random(3);
    for (float& value : values) // what 16 bits hold
        value = static_cast<float>(1 + random() % 2047) / 64;
    io::vdb_volume volume;
    volume.name = "optical_depth";
    volume.values = values;
    volume.voxels = {16, 16, 16};
    volume.notes = {
        {"description", "What it is."}, {"sigmas", 3.0f}, {"to_sun", glm::vec3(0, 1, 0)}};
    ASSERT_TRUE(io::write_vdb(whole.path, std::span(&volume, 1)));
    volume.half = true;
    ASSERT_TRUE(io::write_vdb(halved.path, std::span(&volume, 1)));
    // 8 KiB of values in place of 16, before they are compressed.
    EXPECT_LT(halved.bytes().size() + 2000, whole.bytes().size());
    for (const temporary_path* file : {&whole, &halved}) {
        openvdb::io::File in(file->path);
        in.open(false);
        const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(in.readGrid("optical_depth"));
        ASSERT_TRUE(grid);
        EXPECT_EQ(grid->saveFloatAsHalf(), file == &halved);
        for (int i = 0; i < 4096; ++i)
            ASSERT_EQ(grid->tree().getValue({i % 16, i / 16 % 16, i / 256}),
                      values[static_cast<std::size_t>(i)]);
        EXPECT_EQ(grid->metaValue<std::string>("description"), "What it is.");
        EXPECT_EQ(grid->metaValue<float>("sigmas"), 3.0f);
        EXPECT_EQ(grid->metaValue<openvdb::Vec3s>("to_sun"), openvdb::Vec3s(0, 1, 0));
    }
}

TEST_F(vdb, leaves_no_half_of_a_file) {
    const std::vector<float> one{1};
    io::vdb_volume volume;
    volume.name = "density";
    volume.values = one;
    volume.voxels = {2, 1, 1};
    const temporary_path file("none.vdb");
    auto written = io::write_vdb(file.path, std::span(&volume, 1));
    ASSERT_FALSE(written);
    EXPECT_TRUE(has(written.error().message, "a volume of 2 voxels has 1 values"));
    volume.voxels = {1, 1, 1};
    volume.to_world = glm::dmat4(0);
    written = io::write_vdb(file.path, std::span(&volume, 1));
    ASSERT_FALSE(written) << "no inverse";
    EXPECT_FALSE(std::filesystem::exists(file.path));
    volume.to_world = glm::dmat4(1);
    written = io::write_vdb("/no/such/folder/a.vdb", std::span(&volume, 1));
    ASSERT_FALSE(written);
    EXPECT_TRUE(has(written.error().message, "/no/such/folder"));
    ASSERT_TRUE(io::write_vdb(file.path, std::span(&volume, 1)));
}
