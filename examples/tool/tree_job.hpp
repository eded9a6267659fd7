#pragma once
// What the tree command is asked for, and what it finds on the way.

#include "job.hpp"
#include "tree_options.hpp"

#include <io/surface_scene.hpp>
#include <picture/tree_picture.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/leaf_layout.hpp>
#include <skybark/trees/leaf_texture.hpp>

namespace skybark::tool {

/// What becomes of the tree.
enum class tree_output { picture, animation, obj, glb, ply };

/// How the branches are meshed.
enum class tree_surface { closed, tubes, detailed, sticks };

struct tree_job : command_job {
    explicit tree_job(bool quiet)
        : command_job({"read", "build", "sway", "mesh", "draw", "write"}, quiet) {}

    tree_options more;
    tree_output kind = tree_output::picture;
    tree_surface surface = tree_surface::closed;
    trees::branch_mesh_options mesh;

    // Filled by `read_skeleton`.
    trees::skeleton tree;
    glm::vec3 low{0}; ///< m, the box around the tree
    glm::vec3 high{0};

    // Filled by `dress`.
    std::vector<leaf> leaves;
    trees::leaf_picture leaf_picture; ///< the first row at the stalk
    trees::bark_texture bark;
    picture::surface_maps maps;

    // Filled by `make_tree`, for the report.
    std::uint64_t vertices = 0;
    std::uint64_t indices = 0;
    std::uint64_t triangles = 0;
    std::uint64_t parts = 0;

    /// How deep the bark's relief is where it is drawn from its map alone, m.
    [[nodiscard]] float relief() const { return more.bark_depth > 0 ? more.bark_depth : 0.025f; }
};

/// A mesh on its way to a file.
struct finished_surface {
    trees::host_mesh mesh;
    std::vector<std::uint32_t> places;        ///< io::surface_mesh::places
    std::vector<io::vertex_carrier> carriers; ///< of an animation
};

/// All of them: wood, and leaves where there are some.
struct finished_tree {
    finished_surface wood;
    finished_surface leaves;
    std::vector<segment_pose> poses; ///< frame after frame, of an animation
};

/// Reads the tree.
[[nodiscard]] result<void> read_skeleton(tree_job& job);
/// Places leaves and makes or reads the maps of leaves and bark.
[[nodiscard]] result<void> dress(tree_job& job);
/// Takes the padding out of a triangle list: no file has a use for it.
void remove_degenerate(trees::host_mesh& list);
/// Numbers the places that vertices are at, equal positions alike.
[[nodiscard]] std::vector<std::uint32_t> weld(std::span<const surface_vertex> vertices);
/// Writes a mesh as frame `frame` of the job's files, without vertices that no triangle has.
[[nodiscard]] result<void> write_mesh(const tree_job& job, finished_tree made, std::uint32_t frame);
/// The name of frame `frame`'s file.
[[nodiscard]] std::string name_of(const tree_job& job, std::uint32_t frame);

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] result<void> make_tree_on_cpu(tree_job& job);
[[nodiscard]] result<void> make_tree_on_opengl(tree_job& job);
[[nodiscard]] result<void> make_tree_on_vulkan(tree_job& job);

} // namespace skybark::tool
