#pragma once
// vdb: OpenVDB's files of volumes.
//
// All of OpenVDB is behind these functions, in one translation unit (vdb/openvdb.cpp). Where the
// library wasn't there when this was built, each is an error that says so (vdb/absent.cpp).

#include <io/density_grid.hpp>
#include <skybark/core/result.hpp>

#include <array>
#include <glm/mat4x4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace skybark::io {

/// The most voxels that a density may have within the box of its active ones.
inline constexpr std::uint64_t most_voxels = std::uint64_t{1} << 30u;

/// Reads a density: the grid called `name` or, without a name, the one called "density" or the only
/// one there is. It holds floats or doubles, which become floats, and is no level set. The box is
/// that of the active voxels; others in it are 0. Places are as the file has them, in metres, and a
/// voxel's value belongs to its middle.
///
/// The transform may move and scale, each axis by its own factor, mirror, and turn by quarters:
/// voxels are put in the order of the world's axes. Other turns, shears and tapers are errors.
///
/// The file is read in a process of its own, which it may bring down, since the library trusts its
/// input; this one only waits.
///
/// Errors: it can't be opened, is no plain file, is empty, is no VDB file, is cut off or damaged;
/// there is no such grid, or there are several and none was named, or no active voxel is in it; a
/// transform as above; more than `most_voxels`, said with the box before they are asked for; a box
/// more than 1e6 times its sides away from the origin; a value that is not finite or is negative,
/// with its index; memory.
[[nodiscard]] result<density_grid> read_vdb(const std::string& path, std::string_view name = {});

/// What a grid says of itself, in its metadata.
using vdb_note = std::pair<std::string, std::variant<std::string, float, glm::vec3>>;

/// A volume on its way to a file.
struct vdb_volume {
    std::string name;              ///< of the grid
    std::span<const float> values; ///< x runs fastest, then y, then z
    std::array<std::uint32_t, 3> voxels{};
    glm::dmat4 to_world{1}; ///< from voxel coordinates to metres; a voxel's middle is at its index
                            ///< + ½ there, and at its index in the file
    bool half = false;      ///< 16 bits a value in the file
    std::vector<vdb_note> notes;
};

/// Writes them as fog volumes; voxels of 0 take no room. The same volumes make the same bytes.
/// Errors: `values` has another size, `to_world` can't be inverted, the file can't be written.
[[nodiscard]] result<void> write_vdb(const std::string& path, std::span<const vdb_volume> volumes);

} // namespace skybark::io
