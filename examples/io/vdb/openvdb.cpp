// VDB files through OpenVDB.

#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <io/vdb.hpp>
#include <io/vdb/child_process.hpp>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

namespace skybark::io {

namespace {

// ---- In the child ------------------------------------------------------------------------------

/// A sentence about the file, on its way out of the reader.
struct complaint {
    std::string text;
};

/// An axis of the world in the grid.
struct axis_in_grid {
    std::uint32_t index = 0; ///< which of the indices grows or falls along it
    std::uint32_t falls = 0; ///< 1: it falls
};

/// What the child says before the voxels come, layer after layer of the last index.
struct grid_header {
    glm::vec3 low{0};
    glm::vec3 voxel{1};
    glm::uvec3 voxels{0}; ///< along the indices
    std::array<axis_in_grid, 3> axes{};
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

bool may_be_density(const openvdb::GridBase& grid) {
    return grid.getGridClass() != openvdb::GRID_LEVEL_SET &&
           (grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>());
}

/// The one called `name`; without a name, the one called "density" or the only one.
openvdb::GridBase::Ptr choose(const openvdb::GridPtrVec& grids, std::string_view name) {
    if (grids.empty())
        throw complaint{"has no grid; expected a density."};
    openvdb::GridPtrVec able;
    for (const openvdb::GridBase::Ptr& grid : grids) {
        if (!may_be_density(*grid))
            continue;
        able.push_back(grid);
        if (grid->getName() == (name.empty() ? "density" : name))
            return grid;
    }
    if (!name.empty())
        throw complaint{"has no density " + in_quotes(name) + " but " + names_of(grids) +
                        "; expected the name of a grid of float or double that is no level set."};
    if (able.empty())
        throw complaint{"has no density but " + names_of(grids) +
                        "; expected a grid of float or double that is no level set."};
    if (able.size() > 1)
        throw complaint{"has several grids, and none is called \"density\": " + names_of(able) +
                        "; expected the name of one of them (--grid)."};
    return able.front();
}

/// Throws what the library throws; std::ios_base::failure where the file ends too early.
openvdb::FloatGrid::Ptr read_density(const std::string& path, std::string_view name) {
    std::ifstream file(path, std::ios::binary);
    file.exceptions(std::ios::badbit | std::ios::failbit);
    openvdb::io::Stream stream(file, false);
    const openvdb::GridBase::Ptr chosen = choose(*stream.getGrids(), name);
    if (const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(chosen)) {
        auto floats = std::make_shared<openvdb::FloatGrid>(
            std::make_shared<openvdb::FloatTree>(doubles->tree()));
        floats->insertMeta(*doubles);
        floats->setTransform(doubles->transformPtr());
        return floats;
    }
    return openvdb::gridPtrCast<openvdb::FloatGrid>(chosen);
}

/// Where voxels lie along each axis of the world, m: at shift + side · index, where the index falls
/// at shift − side · index.
struct placed {
    std::array<axis_in_grid, 3> axes{};
    openvdb::Vec3d side; ///< > 0
    openvdb::Vec3d shift;

    [[nodiscard]] std::size_t index(int axis) const {
        return axes[static_cast<std::size_t>(axis)].index;
    }
    /// Where the box begins.
    [[nodiscard]] double low(int axis, const openvdb::CoordBBox& box) const {
        const std::size_t i = index(axis);
        return axes[static_cast<std::size_t>(axis)].falls != 0
                   ? shift[axis] - side[axis] * (box.max()[i] + 0.5)
                   : shift[axis] + side[axis] * (box.min()[i] - 0.5);
    }
};

placed placement_of(const openvdb::FloatGrid& grid) {
    const complaint bad{"has a transform that turns by other than quarters, shears or tapers; "
                        "expected one that moves and scales, such as one over the sides of its "
                        "voxels."};
    if (!grid.transform().isLinear())
        throw bad;
    // A row for each index: the step in the world from one voxel to the next.
    const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
    placed at;
    std::array<bool, 3> taken{};
    for (int row = 0; row < 3; ++row) {
        int axis = 0;
        for (int column = 1; column < 3; ++column)
            axis = std::abs(m(row, column)) > std::abs(m(row, axis)) ? column : axis;
        const double step = m(row, axis);
        for (int column = 0; column < 3; ++column) {
            // Products of rotations leave a little of what should be nothing.
            constexpr double rounding = 1e-6;
            if (column != axis && !(std::abs(m(row, column)) <= rounding * std::abs(step)))
                throw bad;
        }
        const auto a = static_cast<std::size_t>(axis);
        if (taken[a])
            throw bad;
        taken[a] = true;
        at.axes[a] = {static_cast<std::uint32_t>(row), step < 0 ? 1u : 0u};
        at.side[axis] = std::abs(step);
        at.shift[axis] = m(3, axis);
        constexpr double smallest = 1e-6;
        constexpr double farthest = 1e9;
        if (!(at.side[axis] >= smallest && at.side[axis] <= farthest &&
              std::abs(at.shift[axis]) <= farthest))
            throw complaint{"has voxels of " + number_text(at.side[axis]) + " m that begin at " +
                            number_text(at.shift[axis]) +
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
                        " in its grid " + in_quotes(grid.getName()) + ", from the index " +
                        index_text(box.min()) + " to " + index_text(box.max()) +
                        "; expected at most " + std::to_string(most_voxels) +
                        " in all, which are 4 GiB. A voxel far from the others is enough for "
                        "that."};
    return box;
}

/// Whether floats tell the box's places apart.
void check_distance(const placed& at, const openvdb::CoordBBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
        constexpr double most = 1e6;
        const double low = at.low(axis, box);
        const double side = at.side[axis] * box.dim()[at.index(axis)];
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
void send_density(const std::string& path, std::string_view name, byte_sink& to) {
    openvdb::initialize();
    openvdb::FloatGrid::Ptr grid;
    {
        // Nodes take 32 times as much room as their masks in the file, which are never compressed.
        const memory_limit limit(64 * std::filesystem::file_size(path) + (std::uint64_t{1} << 30u));
        grid = read_density(path, name);
    }
    const placed at = placement_of(*grid);
    const openvdb::CoordBBox box = box_of(*grid);
    check_distance(at, box);
    dense_layers layers(*grid, box);
    grid_header header;
    header.axes = at.axes;
    for (int axis = 0; axis < 3; ++axis) {
        header.low[axis] = static_cast<float>(at.low(axis, box));
        header.voxel[axis] = static_cast<float>(at.side[axis]);
        header.voxels[axis] = static_cast<std::uint32_t>(box.dim()[static_cast<std::size_t>(axis)]);
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

/// Puts voxels that came in the order of the indices in the order of the world's axes.
void turn_to_world(const std::array<axis_in_grid, 3>& axes, density_grid& grid) {
    const glm::uvec3 from = grid.voxels;
    const std::array<std::int64_t, 3> strides{1, from.x, std::int64_t{from.x} * from.y};
    std::array<std::int64_t, 3> step{};
    std::int64_t first = 0;
    bool same = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [index, falls] = axes[axis];
        const std::uint32_t side = from[static_cast<int>(index)];
        grid.voxels[static_cast<int>(axis)] = side;
        step[axis] = falls != 0 ? -strides[index] : strides[index];
        first += falls != 0 ? strides[index] * (std::int64_t{side} - 1) : 0;
        same = same && index == axis && falls == 0;
    }
    if (same)
        return;
    std::vector<float> turned;
    turned.reserve(grid.density.size());
    for (std::int64_t z = 0; z < grid.voxels.z; ++z)
        for (std::int64_t y = 0; y < grid.voxels.y; ++y)
            for (std::int64_t x = 0; x < grid.voxels.x; ++x)
                turned.push_back(grid.density[static_cast<std::size_t>(first + x * step[0] +
                                                                       y * step[1] + z * step[2])]);
    grid.density = std::move(turned);
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
    turn_to_world(header.axes, grid);
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

/// The header's identifier is made of the bytes, where the library makes it of random numbers: two
/// files are the same exactly where what is in them is.
void identify(std::string& bytes) {
    // Behind a magic number of 8 bytes, three versions of 4, and whether grids have offsets.
    constexpr std::size_t at = 21;
    constexpr std::size_t size = 36;
    constexpr std::string_view form = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
    if (bytes.size() < at + size)
        return;
    for (std::size_t i = 0; i < size; ++i) {
        const bool digit = std::isxdigit(static_cast<unsigned char>(bytes[at + i])) != 0;
        if (form[i] == 'x' ? !digit : bytes[at + i] != '-')
            return; // another version's header
    }
    bytes.replace(at, size, form);
    // FNV-1a, once for each half, of 64 bits.
    std::array<std::uint64_t, 2> hash{0xcbf29ce484222325u, 0x84222325cbf29ce4u};
    for (const char byte : bytes)
        for (std::uint64_t& h : hash)
            h = (h ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
    std::size_t digit = 0;
    for (std::size_t i = 0; i < size; ++i) {
        if (form[i] != 'x')
            continue;
        std::uint64_t value = hash[digit / 16] >> (4 * (digit % 16)) & 15u;
        value = digit == 12 ? 8 : digit == 16 ? 8 | (value & 3) : value; // RFC 9562's version 8
        bytes[at + i] = "0123456789abcdef"[value];
        ++digit;
    }
}

void add_note(openvdb::GridBase& to, const std::string& key, const std::string& text) {
    to.insertMeta(key, openvdb::StringMetadata(text));
}
void add_note(openvdb::GridBase& to, const std::string& key, float number) {
    to.insertMeta(key, openvdb::FloatMetadata(number));
}
void add_note(openvdb::GridBase& to, const std::string& key, glm::vec3 v) {
    to.insertMeta(key, openvdb::Vec3SMetadata(openvdb::Vec3s(v.x, v.y, v.z)));
}

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
    grid->setSaveFloatAsHalf(volume.half);
    for (const auto& [key, value] : volume.notes)
        std::visit([&, &key = key](const auto& v) { add_note(*grid, key, v); }, value);
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
    std::string bytes = memory_archive().bytes_of(grids);
    identify(bytes);
    return bytes;
}

} // namespace

result<density_grid> read_vdb(const std::string& path, std::string_view name) {
    if (auto good = check_magic(path); !good)
        return failure(good.error());
    return within_memory(path, [&]() -> result<density_grid> {
        auto child = child_process::start([&](byte_sink& to) {
            try {
                send_density(path, name, to);
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
