// VDB files through OpenVDB.

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <io/vdb.hpp>
#include <io/vdb/child_process.hpp>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace skybark::io {

namespace {

// ---- In the child ------------------------------------------------------------------------------

/// A sentence about the file, on its way out of the reader.
struct complaint {
    std::string text;
};

/// What the child says before the voxels come, layer of z after layer.
struct grid_header {
    glm::vec3 low{0};
    glm::vec3 voxel{1};
    glm::uvec3 voxels{0};
};

std::string number_text(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
}

std::string index_text(const openvdb::Coord& at) {
    std::string text = "(";
    text += std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()) +
            ")";
    return text;
}

/// "density" (float), "v" (vec3s)
std::string names_of(const openvdb::GridPtrVec& grids) {
    constexpr std::size_t most_named = 8;
    std::string text;
    for (std::size_t i = 0; i < grids.size() && i < most_named; ++i) {
        text += i == 0 ? "" : ", ";
        text += in_quotes(grids[i]->getName()) + " (" + grids[i]->valueType() + ")";
    }
    return text + (grids.size() > most_named ? ", …" : "");
}

/// Throws what the library throws; std::ios_base::failure where the file ends too early.
openvdb::FloatGrid::Ptr read_density(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    file.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::io::Stream stream(file, false);
    const openvdb::GridPtrVecPtr grids = stream.getGrids();
    openvdb::FloatGrid::Ptr chosen;
    for (const openvdb::GridBase::Ptr& grid : *grids) {
        const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
        if (!floats || floats->getGridClass() == openvdb::GRID_LEVEL_SET)
            continue;
        if (!chosen || grid->getName() == "density")
            chosen = floats;
        if (grid->getName() == "density")
            break;
    }
    if (!chosen) {
        if (grids->empty())
            throw complaint{"has no grid; expected a density."};
        throw complaint{"has no density but " + names_of(*grids) +
                        "; expected a grid of float that is no level set."};
    }
    return chosen;
}

/// Sides of a voxel and the place of the index (0, 0, 0), m.
struct placed {
    openvdb::Vec3d scale;
    openvdb::Vec3d shift;
};

placed placement_of(const openvdb::FloatGrid& grid) {
    const complaint bad{"has a transform that turns, mirrors, shears or tapers; expected one that "
                        "only moves and scales, such as one over the sides of its voxels."};
    if (!grid.transform().isLinear())
        throw bad;
    const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
    placed at{{m(0, 0), m(1, 1), m(2, 2)}, {m(3, 0), m(3, 1), m(3, 2)}};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            // Products of rotations leave a little of what should be nothing.
            constexpr double rounding = 1e-6;
            if (row != column && !(std::abs(m(row, column)) <= rounding * std::abs(at.scale[row])))
                throw bad;
        }
        if (!(at.scale[row] > 0))
            throw bad;
        constexpr double smallest = 1e-6;
        constexpr double farthest = 1e9;
        if (!(at.scale[row] >= smallest && at.scale[row] <= farthest &&
              std::abs(at.shift[row]) <= farthest))
            throw complaint{"has voxels of " + number_text(at.scale[row]) + " m that begin at " +
                            number_text(at.shift[row]) +
                            " m; expected sides from 1e-6 to 1e9 m, at most 1e9 m away."};
    }
    return at;
}

/// The box of the active voxels.
openvdb::CoordBBox box_of(const openvdb::FloatGrid& grid) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty())
        throw complaint{"has no active voxel in its grid " + in_quotes(grid.getName()) +
                        "; expected one at least."};
    std::uint64_t voxels = 1;
    std::array<std::uint64_t, 3> sides{};
    bool too_many = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sides[axis] =
            static_cast<std::uint64_t>(std::int64_t{box.max()[axis]} - box.min()[axis] + 1);
        too_many = too_many || sides[axis] > most_voxels / voxels;
        voxels = too_many ? voxels : voxels * sides[axis];
    }
    if (too_many)
        throw complaint{"has active voxels in a box of " + std::to_string(sides[0]) + " x " +
                        std::to_string(sides[1]) + " x " + std::to_string(sides[2]) +
                        "; expected at most " + std::to_string(most_voxels) +
                        " in all, which are 4 GiB."};
    return box;
}

/// Whether floats tell the box's places apart.
void check_distance(const placed& at, const openvdb::CoordBBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
        constexpr double most = 1e6;
        const auto a = static_cast<std::size_t>(axis);
        const double low = at.scale[axis] * (box.min()[a] - 0.5) + at.shift[axis];
        const double side = at.scale[axis] * box.dim()[a];
        const double farthest = std::max(std::abs(low), std::abs(low + side));
        if (!(farthest <= most * side))
            throw complaint{"has active voxels in a box that is " + number_text(side) +
                            " m long and reaches " + number_text(farthest) +
                            " m from the origin; expected it within 1e6 times its sides."};
    }
}

float checked(float value, const openvdb::Coord& at) {
    if (!(value >= 0 && value <= std::numeric_limits<float>::max()))
        throw complaint{"has the density " + number_text(double{value}) + " at the index " +
                        index_text(at) + "; expected finite numbers of at least 0."};
    return value;
}

/// Active boxes of one value each, which stand for many voxels.
struct tile {
    openvdb::CoordBBox box;
    float value = 0;
};

/// The grid as dense voxels, a few layers at a time.
class dense_layers {
  public:
    dense_layers(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& box) : box_(box) {
        for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
            leaves_.push_back(&*leaf);
        std::sort(leaves_.begin(), leaves_.end(), [](const leaf_node* a, const leaf_node* b) {
            return a->origin().z() < b->origin().z();
        });
        auto value = grid.cbeginValueOn();
        value.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
        for (; value; ++value) {
            tile t;
            value.getBoundingBox(t.box);
            t.value = checked(*value, t.box.min());
            tiles_.push_back(t);
        }
    }

    /// Calls `take` with layers of z, from the lowest up.
    template <class Take>
    void for_each(Take&& take) {
        std::size_t next = 0;
        const std::int64_t layer = std::int64_t{box_.dim().x()} * box_.dim().y();
        // Leaves begin at multiples of their size, so that each lies in one slab.
        constexpr std::int64_t thick = leaf_node::DIM;
        std::int64_t z = box_.min().z();
        while (z <= box_.max().z()) {
            const std::int64_t end = std::min<std::int64_t>(floor_to(z, thick) + thick,
                                                            box_.max().z() + std::int64_t{1});
            voxels_.assign(static_cast<std::size_t>(layer * (end - z)), 0.0f);
            first_ = z;
            end_ = end;
            for (const tile& t : tiles_)
                fill(t);
            for (; next < leaves_.size() && leaves_[next]->origin().z() < end; ++next)
                fill(*leaves_[next]);
            take(std::span<const float>(voxels_));
            z = end;
        }
    }

  private:
    using leaf_node = openvdb::FloatTree::LeafNodeType;

    [[nodiscard]] static std::int64_t floor_to(std::int64_t value, std::int64_t step) {
        return value - ((value % step) + step) % step;
    }
    [[nodiscard]] float& at(std::int64_t x, std::int64_t y, std::int64_t z) {
        const std::int64_t width = box_.dim().x();
        const std::int64_t height = box_.dim().y();
        return voxels_[static_cast<std::size_t>(
            (x - box_.min().x()) + width * ((y - box_.min().y()) + height * (z - first_)))];
    }
    void fill(const tile& t) {
        const std::int64_t from = std::max<std::int64_t>(t.box.min().z(), first_);
        const std::int64_t to = std::min<std::int64_t>(t.box.max().z(), end_ - 1);
        for (std::int64_t z = from; z <= to; ++z)
            for (std::int64_t y = t.box.min().y(); y <= t.box.max().y(); ++y)
                for (std::int64_t x = t.box.min().x(); x <= t.box.max().x(); ++x)
                    at(x, y, z) = t.value;
    }
    void fill(const leaf_node& leaf) {
        for (auto value = leaf.cbeginValueOn(); value; ++value) {
            const openvdb::Coord c = value.getCoord();
            at(c.x(), c.y(), c.z()) = checked(*value, c);
        }
    }

    openvdb::CoordBBox box_;
    std::vector<const leaf_node*> leaves_;
    std::vector<tile> tiles_;
    std::vector<float> voxels_;
    std::int64_t first_ = 0; ///< the layers of z in `voxels_`, up to `end_`
    std::int64_t end_ = 0;
};

/// Reads, checks, and hands the grid on: its header, and its voxels.
void send_density(const std::string& path, byte_sink& to) {
    openvdb::initialize();
    openvdb::FloatGrid::Ptr grid;
    {
        // Nodes take 32 times as much room as their masks in the file, which are never compressed.
        const memory_limit limit(64 * std::filesystem::file_size(path) + (std::uint64_t{1} << 30u));
        grid = read_density(path);
    }
    const placed at = placement_of(*grid);
    const openvdb::CoordBBox box = box_of(*grid);
    check_distance(at, box);
    dense_layers layers(*grid, box);
    grid_header header;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        header.low[axis] =
            static_cast<float>(at.scale[axis] * (box.min()[a] - 0.5) + at.shift[axis]);
        header.voxel[axis] = static_cast<float>(at.scale[axis]);
        header.voxels[axis] = static_cast<std::uint32_t>(box.dim()[a]);
    }
    to.write(std::as_bytes(std::span(&header, 1)));
    layers.for_each([&](std::span<const float> voxels) { to.write(std::as_bytes(voxels)); });
}

// ---- In the program itself ---------------------------------------------------------------------

/// Whether it begins as VDB files do; the others needn't bother a child.
result<void> check_magic(const std::string& path) {
    constexpr std::string_view magic(" BDV\0\0\0\0", 8);
    std::error_code ignored;
    const std::filesystem::file_status kind = std::filesystem::status(path, ignored);
    const bool plain = std::filesystem::is_regular_file(kind);
    if (std::filesystem::exists(kind) && !plain && !std::filesystem::is_directory(kind))
        return fail(error_code::bad_input,
                    in_quotes(path) + " is a pipe or a device; expected a file, which is read "
                                      "twice.");
    const auto start = load_start(path, magic.size());
    if (!start)
        return failure(start.error());
    if (start->empty())
        return fail(error_code::bad_input, in_quotes(path) + " is empty; expected a VDB file.");
    if (*start != magic)
        return fail(error_code::bad_input, in_quotes(path) + " begins with " + in_quotes(*start) +
                                               "; expected a VDB file.");
    return {};
}

result<density_grid> receive(const std::string& path, child_process& child) {
    density_grid grid;
    grid_header header;
    if (!child.read(std::as_writable_bytes(std::span(&header, 1))))
        return fail(error_code::bad_input, in_quotes(path) + " " + child.complaint());
    grid.low = header.low;
    grid.voxel = header.voxel;
    grid.voxels = header.voxels;
    grid.density.resize(std::size_t{header.voxels.x} * header.voxels.y * header.voxels.z);
    if (!child.read(std::as_writable_bytes(std::span(grid.density))))
        return fail(error_code::bad_input, in_quotes(path) + " " + child.complaint());
    return grid;
}

/// Writes into memory as into a file in which one can go back: other programs then find a grid
/// without reading those before it.
class memory_archive : public openvdb::io::Archive {
  public:
    [[nodiscard]] std::string bytes_of(const openvdb::GridPtrVec& grids) const {
        std::ostringstream bytes(std::ios::binary);
        bytes.exceptions(std::ios::badbit | std::ios::failbit);
        openvdb::io::Archive::write(bytes, grids, true);
        return std::move(bytes).str();
    }
};

openvdb::FloatGrid::Ptr grid_of(const vdb_volume& volume) {
    openvdb::Mat4d to_world;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            to_world(row, column) = volume.to_world[row][column]; // a row here is a column there
    // A value belongs to the middle of its voxel.
    to_world.preTranslate(openvdb::Vec3d(0.5));
    const auto grid = openvdb::FloatGrid::create(0.0f);
    grid->setName(volume.name);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(to_world));
    const auto side = [&](std::size_t axis) { return static_cast<int>(volume.voxels[axis]) - 1; };
    const openvdb::tools::Dense<const float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox({0, 0, 0}, {side(0), side(1), side(2)}), volume.values.data());
    openvdb::tools::copyFromDense(dense, *grid, 0.0f);
    return grid;
}

std::string encode(std::span<const vdb_volume> volumes) {
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (const vdb_volume& volume : volumes)
        grids.push_back(grid_of(volume));
    return memory_archive().bytes_of(grids);
}

} // namespace

result<density_grid> read_vdb(const std::string& path) {
    if (auto good = check_magic(path); !good)
        return failure(good.error());
    return within_memory(path, [&]() -> result<density_grid> {
        auto child = child_process::start([&](byte_sink& to) {
            try {
                send_density(path, to);
            } catch (const complaint& c) {
                to.complain(c.text);
            } catch (const std::bad_alloc&) {
                to.complain(
                    "asks for more memory than a file of its size can; expected a whole VDB file.");
            } catch (const std::ios_base::failure&) {
                to.complain("ends too early or is damaged; expected a whole VDB file.");
            } catch (const std::exception& e) {
                to.complain("can't be read as a VDB file: " + in_quotes(e.what()) + ".");
            }
        });
        if (!child)
            return failure(child.error());
        return receive(path, *child);
    });
}

result<void> write_vdb(const std::string& path, std::span<const vdb_volume> volumes) {
    for (const vdb_volume& volume : volumes) {
        std::uint64_t voxels = 1;
        for (const std::uint32_t side : volume.voxels)
            voxels *= side;
        if (voxels == 0 || voxels != volume.values.size())
            return fail(error_code::bad_input, in_quotes(path) + " can't be written: a volume of " +
                                                   std::to_string(voxels) + " voxels has " +
                                                   std::to_string(volume.values.size()) +
                                                   " values.");
    }
    std::string bytes;
    try {
        bytes = encode(volumes);
    } catch (const std::bad_alloc&) {
        return fail(error_code::out_of_memory,
                    "There is not enough memory to write " + in_quotes(path) + ".");
    } catch (const std::exception& e) {
        return fail(error_code::bad_input,
                    in_quotes(path) + " can't be written: " + in_quotes(e.what()) + ".");
    }
    return write_file(path, bytes);
}

} // namespace skybark::io
