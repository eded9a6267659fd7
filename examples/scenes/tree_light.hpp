#pragma once
// A swaying tree as triangles that light meets, copied on the device from wherever the sway has
// carried it: wood, and leaves with their outlines, two sides, and light that comes through.
//
//     auto tree = scenes::tree_surfaces<B>::create(device, swaying, leaf_picture);
//     auto scene = gather::gather_scene<B>::create(device, tree->describe());
//     run(device, [&](auto& recorder) {
//         swaying.advance(recorder, air, seconds, step);
//         swaying.mesh(recorder);
//         tree->record(recorder, swaying, scene->triangles());
//         scene->record_samples(recorder);
//     });

#include <scenes/surface_list.hpp>
#include <skybark/gather/scene.hpp>
#include <skybark/kernels/surface_triangles.hpp>
#include <skybark/trees/swaying_tree.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

namespace skybark::scenes {

/// Bark that reflects a fifth, brown.
[[nodiscard]] inline gather_material bark_material() {
    gather_material bark;
    bark.diffuse = {0.24f, 0.19f, 0.15f};
    return bark;
}

/// A green leaf, about as Jacquemoud and Baret's PROSPECT (1990) has one: what comes through is
/// greener than what comes back.
[[nodiscard]] inline gather_material leaf_material() {
    gather_material leaf;
    leaf.diffuse = {0.08f, 0.16f, 0.04f};
    leaf.transmission = {0.07f, 0.22f, 0.02f};
    leaf.two_sided = 1;
    return leaf;
}

/// Its triangles are the first of the scene: wood, then leaves. It must have no bark, and leaves
/// as rings: then their number stays.
template <backend B>
requires maps<B, kernels::surface_triangles>
class tree_surfaces {
  public:
    static constexpr std::uint32_t wood = 0; ///< materials
    static constexpr std::uint32_t foliage = 1;

    /// Reads the tree's mesh back once, as it is now. With a picture that has no pixels, leaves
    /// have no outlines but their blades'.
    [[nodiscard]] static result<tree_surfaces> create(B& device, const trees::swaying_tree<B>& tree,
                                                      const trees::leaf_picture& picture) {
        if (auto made = run(device, [&](auto& recorder) { tree.mesh(recorder); }); !made) {
            return failure(made.error());
        }
        const auto branches = tree.branches().download(device);
        if (!branches) {
            return failure(branches.error());
        }
        const auto leaves = tree.leaves().download(device);
        if (!leaves) {
            return failure(leaves.error());
        }
        tree_surfaces made;
        made.scene_.materials = {bark_material(), leaf_material()};
        made.add(*branches, wood);
        made.leaves_ = static_cast<std::uint32_t>(made.scene_.triangles.size());
        made.add(*leaves, foliage);
        made.count_ = static_cast<std::uint32_t>(made.scene_.triangles.size());
        made.cut_out(*leaves, picture);
        return made;
    }

    /// More that stands around: add to it before `describe`.
    [[nodiscard]] surface_list& surroundings() { return scene_; }

    /// The scene at rest, in a box that has room for the sway.
    [[nodiscard]] gather::scene_description describe() const {
        gather::scene_description what;
        what.triangles = scene_.triangles;
        what.materials = scene_.materials;
        what.alpha = alpha_;
        gather::bounds box = gather::bounds_of(scene_.triangles);
        const gather::bounds tree =
            gather::bounds_of(std::span(scene_.triangles).subspan(0, count_));
        const float room = 0.3f * (tree.high.y - tree.low.y);
        box.add(tree.low - glm::vec3(room, 0, room));
        box.add(tree.high + glm::vec3(room));
        what.box = box;
        return what;
    }

    [[nodiscard]] std::uint32_t triangles() const { return count_; } ///< of the tree
    [[nodiscard]] std::uint32_t first_leaf() const { return leaves_; }

    /// Copies the tree's triangles, as `tree.mesh` made them, to the start of `to`.
    void record(typename B::recorder& recorder, const trees::swaying_tree<B>& tree,
                const buffer_view<B>& to) const {
        kernels::surface_triangles copy;
        copy.indexed = 1;
        const auto copy_all = [&](const buffer_view<B>& vertices, const draw_geometry<B>& which) {
            const std::uint32_t count = which.count / 3;
            recorder.map(copy, {vertices, which.indices, to}, range{0, count});
            copy.first += count;
            copy.alpha += copy.alpha == 0 ? 0 : count;
        };
        copy.material = wood;
        tree.for_each_wood(copy_all);
        copy.material = foliage;
        copy.alpha = alpha_.empty() ? 0 : 1;
        tree.for_each_leaf(copy_all);
    }

  private:
    void add(const trees::host_mesh& mesh, std::uint32_t material) {
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) {
                return mesh.vertices[mesh.indices[i + k]].position;
            };
            add_triangle(scene_, material, corner(0), corner(1), corner(2));
        }
    }

    /// One alpha_coordinates a triangle of the leaves, then the picture's coverage.
    void cut_out(const trees::host_mesh& mesh, const trees::leaf_picture& picture) {
        const std::size_t texels = std::size_t{picture.width} * picture.height;
        if (texels == 0) {
            return;
        }
        const std::size_t map = (count_ - leaves_) * sizeof(alpha_coordinates) / 4;
        alpha_.resize(map + texels);
        for (std::uint32_t i = 0; i < count_ - leaves_; ++i) {
            const auto place = [&](std::uint32_t k) {
                const surface_vertex& v = mesh.vertices[mesh.indices[3 * i + k]];
                return glm::clamp(glm::vec2(v.u, v.v), 0.0f, 0.99999f);
            };
            alpha_coordinates at;
            at.a = place(0);
            at.b = place(1);
            at.c = place(2);
            at.map = static_cast<std::uint32_t>(map);
            at.size = picture.width + 65536 * picture.height;
            std::memcpy(&alpha_[i * sizeof(at) / 4], &at, sizeof(at));
            scene_.triangles[leaves_ + i].alpha = i + 1;
        }
        for (std::size_t k = 0; k < texels; ++k) {
            const float cover = static_cast<float>(picture.rgba[4 * k + 3]) / 255;
            alpha_[map + k] = std::bit_cast<std::uint32_t>(cover);
        }
    }

    surface_list scene_;
    std::vector<std::uint32_t> alpha_;
    std::uint32_t leaves_ = 0;
    std::uint32_t count_ = 0;
};

} // namespace skybark::scenes
