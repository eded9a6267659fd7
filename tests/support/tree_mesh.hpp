#pragma once
// A tree's mesh on the CPU, and which of its vertices and triangles are whose.

#include <skybark/cpu/cpu.hpp>
#include <skybark/trees/branch_mesh.hpp>

#include <stdexcept>

namespace skybark::support {

template <backend B>
[[nodiscard]] trees::host_mesh mesh_on(B& device, const trees::branch_layout& layout,
                                       trees::branch_mesh_options options) {
    auto mesh = trees::branch_mesh<B>::create(device, layout, options);
    if (!mesh) {
        throw std::runtime_error(mesh.error().message);
    }
    if (auto done = run(device, [&](auto& r) { mesh->record(r); }); !done) {
        throw std::runtime_error(done.error().message);
    }
    auto down = mesh->download(device);
    if (!down) {
        throw std::runtime_error(down.error().message);
    }
    return *std::move(down);
}

/// A mesh of the ring form: all tubes in the segments' order, then all caps in theirs.
struct tree_mesh {
    trees::branch_layout layout;
    trees::branch_mesh_options options;
    trees::host_mesh mesh;

    static tree_mesh make(const trees::skeleton& of, trees::branch_mesh_options options) {
        cpu::device device;
        options.form = trees::mesh_form::rings;
        tree_mesh made{trees::layout_branches(of, options.frame), options, {}};
        made.mesh = mesh_on(device, made.layout, options);
        return made;
    }

    [[nodiscard]] std::size_t around() const { return options.sides + std::size_t{1}; }
    [[nodiscard]] std::size_t tube_vertices() const { return options.rings * around(); }
    [[nodiscard]] std::size_t tube_indices() const {
        return std::size_t{6} * options.sides * (options.rings - 1);
    }
    [[nodiscard]] std::size_t cap_indices() const { return std::size_t{3} * (options.sides - 2); }

    [[nodiscard]] const surface_vertex& vertex(std::size_t segment, std::size_t ring,
                                               std::size_t corner) const {
        return mesh.vertices[segment * tube_vertices() + ring * around() + corner];
    }

    [[nodiscard]] bool has_no_length(std::size_t segment) const {
        const branch_segment& s = layout.segments[segment];
        return layout.ends[s.start].position == layout.ends[s.end].position;
    }

    [[nodiscard]] std::span<const std::uint32_t> tube(std::size_t segment) const {
        return std::span(mesh.indices).subspan(segment * tube_indices(), tube_indices());
    }
    /// The n-th cap's triangles.
    [[nodiscard]] std::span<const std::uint32_t> cap(std::size_t n) const {
        return std::span(mesh.indices)
            .subspan(layout.segments.size() * tube_indices() + n * cap_indices(), cap_indices());
    }

    /// Segments that share ends, and their caps.
    struct chain {
        std::vector<std::uint32_t> indices; ///< three a triangle
        /// Whether all its polygons are so wide that the corners have places of their own, in
        /// floats this far from the origin. (A point is one place.)
        bool resolved = true;
    };

    [[nodiscard]] std::vector<chain> chains() const {
        std::vector<std::size_t> at_end(layout.ends.size(), no_chain);
        std::vector<chain> all;
        std::size_t caps = 0;
        for (std::size_t i = 0; i < layout.segments.size(); ++i) {
            const branch_segment& s = layout.segments[i];
            if (at_end[s.start] == no_chain) {
                at_end[s.start] = all.size();
                all.emplace_back();
            }
            at_end[s.end] = at_end[s.start];
            chain& own = all[at_end[s.start]];
            const auto add = [&](std::span<const std::uint32_t> more) {
                own.indices.insert(own.indices.end(), more.begin(), more.end());
            };
            add(tube(i));
            for (const std::uint32_t bit : {cap_start, cap_end}) {
                if ((s.caps & bit) != 0) {
                    add(cap(caps++));
                }
            }
            own.resolved =
                own.resolved && is_wide(layout.ends[s.start]) && is_wide(layout.ends[s.end]);
        }
        return all;
    }

  private:
    static constexpr std::size_t no_chain = ~std::size_t{0};

    [[nodiscard]] bool is_wide(const branch_end& e) const {
        const glm::vec3 p = glm::abs(e.position);
        const float rounding = 1.2e-7f * std::max({p.x, p.y, p.z});
        return e.radius == 0 || e.radius > rounding * static_cast<float>(options.sides);
    }
};

} // namespace skybark::support
