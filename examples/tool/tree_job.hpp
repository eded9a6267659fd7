#pragma once
// What the tree command is asked for, and what it finds on the way.

#include "options.hpp"
#include "stages.hpp"

#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>

namespace skybark::tool {

/// What becomes of the tree.
enum class tree_output { picture, obj, glb, ply };

struct tree_job {
    explicit tree_job(bool quiet) : time({"read", "build", "mesh", "draw", "write"}, quiet) {}

    common_options common;
    std::string input;
    std::string out;
    tree_output kind = tree_output::picture;
    trees::branch_mesh_options mesh;
    bool skeleton = false; ///< the segments alone

    stages time;

    // Filled by `read_layout`.
    trees::branch_layout layout;
    glm::vec3 low{0}; ///< m, the box around the tree
    glm::vec3 high{0};

    // Filled by `make_tree`, for the report.
    std::uint64_t vertices = 0;
    std::uint64_t indices = 0;
    std::uint64_t triangles = 0;
    std::uint64_t parts = 0;
    std::string device;
    std::string driver;
    device_traffic traffic;
};

/// Reads the tree and lays it out for the branch kernels.
[[nodiscard]] result<void> read_layout(tree_job& job);
/// Takes the padding out of a triangle list: no file has a use for it.
void remove_degenerate(trees::host_mesh& list);
/// Writes a downloaded mesh as the job's file.
[[nodiscard]] result<void> write_mesh(const tree_job& job, const trees::host_mesh& mesh);
/// Writes the job's picture.
[[nodiscard]] result<void> write_picture(const tree_job& job, std::span<const std::uint8_t> rgba);

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] result<void> make_tree_on_cpu(tree_job& job);
[[nodiscard]] result<void> make_tree_on_opengl(tree_job& job);
[[nodiscard]] result<void> make_tree_on_vulkan(tree_job& job);

} // namespace skybark::tool
