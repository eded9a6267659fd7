#pragma once
// The branches of a tree, or of a forest, meshed on a device every time they are asked for.
// Source: Akagi and Kitajima, sections 2.2 and 3.3.
//
//     auto mesh = trees::branch_mesh<B>::create(device, skeleton, {});
//     run(device, [&](auto& recorder) { mesh->record(recorder); });
//
// The device is sent the ends and segments of the skeleton once. `record` makes all vertices anew,
// at rest or where the poses of the segments (trees/sway.hpp) have carried them.
// A scene that does not fit the device's largest buffer is cut into chunks of whole segments.

#include <skybark/core/backend.hpp>
#include <skybark/kernels/branch_cap.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/pose_ends.hpp>
#include <skybark/kernels/ring_indices.hpp>
#include <skybark/kernels/unit_polygon.hpp>
#include <skybark/trees/branch_layout.hpp>

#include <cassert>
#include <unordered_map>

namespace skybark::trees {

/// How vertices are stored.
enum class mesh_form {
    rings, ///< each ring's vertices once, under an index buffer that is made once
    list,  ///< three vertices a triangle, as a geometry shader's strips give them
};

struct branch_mesh_options {
    std::uint32_t sides = 8; ///< of a ring, 3 … 1024
    std::uint32_t rings = 4; ///< a segment, both ends included, 2 … 1024
    kernels::branch_frame frame = kernels::branch_frame::slerp;
    mesh_form form = mesh_form::rings;
    padding policy = padding::compact; ///< of the list
};

/// A mesh on the host: what `branch_mesh::download` gives. Indices are 32 bits wide.
struct host_mesh {
    std::vector<surface_vertex> vertices;
    std::vector<std::uint32_t> indices; ///< three a triangle, counter-clockwise from outside
};

/// The branches of a skeleton as triangles in buffers of backend B.
template <backend B>
requires maps<B, kernels::ring_indices> && maps<B, kernels::pose_ends> &&
    expands_rings<B, kernels::hermite_branch> && expands_rings<B, kernels::branch_cap> &&
    expands<B, kernels::hermite_branch>
class branch_mesh {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Part of the mesh, small enough to be one draw.
    struct part {
        buffer segments; ///< branch_segment (tubes) or uint32 (caps)
        buffer ends;     ///< branch_end: where they are in this frame
        buffer rest;     ///< branch_end: where they are at rest
        buffer carriers; ///< end_carrier; empty where the layout has none
        buffer vertices; ///< surface_vertex; room for what `record` makes
        buffer count;    ///< one count_record, of the list form
        std::uint32_t end_count = 0;
        std::uint32_t elements = 0;
        std::uint32_t vertex_count = 0;
        std::uint32_t triangles = 0;
        bool caps = false; ///< made by branch_cap
    };

    /// Sends the skeleton to the device and makes room for its mesh.
    /// Errors: bad_input where the options are out of range or the mesh would have 2^32 vertices or
    /// more; whatever the device says of memory.
    [[nodiscard]] static result<branch_mesh> create(B& device, const skeleton& of,
                                                    branch_mesh_options options) {
        return create(device, layout_branches(of, options.frame), options);
    }

    [[nodiscard]] static result<branch_mesh> create(B& device, const branch_layout& layout,
                                                    branch_mesh_options options) {
        if (auto valid = check(options); !valid) {
            return failure(valid.error());
        }
        branch_mesh mesh;
        mesh.options_ = options;
        mesh.tube_ = {options.sides, options.rings, options.frame};
        mesh.cap_ = {options.sides};
        if (auto done = mesh.build(device, layout); !done) {
            return failure(done.error());
        }
        return mesh;
    }

    /// Appends the making of all vertices at rest. Allocates nothing.
    void record(recorder& to) const { record_vertices(to, &part::rest); }

    /// Appends the making of all vertices where `poses`, one segment_pose for each segment of the
    /// skeleton, carry them. The layout must have carriers. Allocates nothing.
    void record(recorder& to, const buffer_view<B>& poses) const {
        for (const part& p : parts_) {
            assert(p.carriers.size_bytes() != 0 || p.end_count == 0);
            to.map(kernels::pose_ends{},
                   {view<B>(p.rest), view<B>(p.carriers), poses, view<B>(p.ends)},
                   range{0, p.end_count});
        }
        record_vertices(to, &part::ends);
    }

    /// What to draw: a kernel's vertices are `part.vertices`.
    [[nodiscard]] std::span<const part> parts() const { return parts_; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        if (options_.form == mesh_form::list) {
            draw_geometry<B> list;
            list.count = 3 * p.triangles;
            list.length = view<B>(p.count);
            return list;
        }
        const std::uint32_t indices = 3 * p.triangles;
        return {view<B, std::uint32_t>(p.caps ? *cap_indices_ : *tube_indices_, 0, indices),
                0,
                indices,
                0,
                {}};
    }

    [[nodiscard]] std::uint64_t triangles() const { return total(&part::triangles); }
    [[nodiscard]] std::uint64_t vertices() const { return total(&part::vertex_count); }
    [[nodiscard]] const branch_mesh_options& options() const { return options_; }

    /// The whole mesh. In the list form the vertices are the triangles' corners in order.
    [[nodiscard]] result<host_mesh> download(B& device) const {
        host_mesh mesh;
        for (const part& p : parts_) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            std::uint32_t count = p.vertex_count;
            if (options_.form == mesh_form::list) {
                count_record made;
                if (auto done = read_back<B, count_record>(device, p.count, {&made, 1}); !done) {
                    return failure(done.error());
                }
                count = 3 * made.written;
            }
            mesh.vertices.resize(std::size_t{first} + count);
            if (auto done = device.download(p.vertices, 0, writable_bytes_of(mesh.vertices, first));
                !done) {
                return failure(done.error());
            }
            if (auto done = download_indices(device, p, first, count, mesh.indices); !done) {
                return failure(done.error());
            }
        }
        return mesh;
    }

  private:
    branch_mesh() = default;

    void record_vertices(recorder& to, buffer part::*ends) const {
        for (const part& p : parts_) {
            const bindings<B, kernels::hermite_branch> from = {
                view<B>(p.segments), view<B>(p.*ends), view<B>(*corners_)};
            if (p.caps) {
                to.expand_rings(cap_, from, range{0, p.elements}, view<B>(p.vertices));
            } else if (options_.form == mesh_form::rings) {
                to.expand_rings(tube_, from, range{0, p.elements}, view<B>(p.vertices));
            } else {
                to.expand(tube_, from, range{0, p.elements},
                          triangle_list<B>{view<B>(p.vertices), view<B>(p.count), options_.policy});
            }
        }
    }

    [[nodiscard]] static result<void> check(const branch_mesh_options& options) {
        const auto out_of_range = [](const char* what, std::uint32_t value, std::uint32_t least) {
            return fail(error_code::bad_input,
                        std::string("A branch mesh cannot have ") + std::to_string(value) + " " +
                            what + "; it takes " + std::to_string(least) + " to 1024.");
        };
        if (options.sides < 3 || options.sides > 1024) {
            return out_of_range("sides", options.sides, 3);
        }
        if (options.rings < 2 || options.rings > 1024) {
            return out_of_range("rings", options.rings, 2);
        }
        return {};
    }

    [[nodiscard]] std::uint64_t total(std::uint32_t part::*of) const {
        std::uint64_t sum = 0;
        for (const part& p : parts_) {
            sum += p.*of;
        }
        return sum;
    }

    [[nodiscard]] result<void> build(B& device, const branch_layout& layout) {
        const std::vector<glm::vec4> corners = kernels::unit_polygon(options_.sides);
        auto made = make_buffer<B, glm::vec4>(device, corners);
        if (!made) {
            return failure(made.error());
        }
        corners_ = std::move(*made);
        return options_.form == mesh_form::rings ? build_rings(device, layout)
                                                 : build_list(device, layout);
    }

    /// How many elements of so many vertices and index bytes fit the device's largest buffer.
    [[nodiscard]] static std::uint64_t chunk_of(const B& device, std::uint64_t vertex_bytes,
                                                std::uint64_t index_bytes) {
        const device_limits limits = device.limits();
        // Two ends a segment at worst.
        const std::uint64_t widest =
            std::max({vertex_bytes, index_bytes, std::uint64_t{2 * sizeof(branch_end)}});
        return std::min(limits.max_elements, limits.max_buffer_bytes / widest);
    }

    [[nodiscard]] static failure too_small(std::uint64_t bytes) {
        return fail(error_code::out_of_memory,
                    "One branch segment needs a buffer of " + std::to_string(bytes) +
                        " bytes, more than the device can bind; use fewer sides or rings.");
    }

    [[nodiscard]] result<void> check_vertices(std::uint64_t elements, std::uint64_t each) const {
        if (elements * each >= 0xffffffffull) {
            return fail(error_code::bad_input,
                        "A mesh of " + std::to_string(elements * each) +
                            " vertices is beyond 32-bit indices; mesh the trees one by one.");
        }
        return {};
    }

    [[nodiscard]] result<void> build_rings(B& device, const branch_layout& layout) {
        const std::uint64_t each = tube_.ring_vertices();
        const std::uint64_t vertex_bytes = each * sizeof(surface_vertex);
        const std::uint64_t index_bytes = 3ull * tube_.ring_triangles() * sizeof(std::uint32_t);
        const std::uint64_t most = chunk_of(device, vertex_bytes, index_bytes);
        if (most == 0) {
            return too_small(std::max(vertex_bytes, index_bytes));
        }
        const std::vector<std::uint32_t> caps = caps_of(layout);
        if (auto valid = check_vertices(1, each * layout.segments.size() +
                                               std::uint64_t{options_.sides} * caps.size());
            !valid) {
            return valid;
        }
        for (std::uint64_t first = 0; first < layout.segments.size(); first += most) {
            const std::uint64_t count =
                std::min<std::uint64_t>(most, layout.segments.size() - first);
            auto added = add_tubes(device, layout, first, count, count * vertex_bytes);
            if (!added) {
                return added;
            }
            parts_.back().vertex_count = static_cast<std::uint32_t>(count * each);
            parts_.back().triangles = static_cast<std::uint32_t>(count * tube_.ring_triangles());
        }
        const std::uint64_t cap_bytes = std::uint64_t{options_.sides} * sizeof(surface_vertex);
        const std::uint64_t most_caps = chunk_of(device, cap_bytes, 0);
        for (std::uint64_t first = 0; first < caps.size(); first += most_caps) {
            const std::uint64_t count = std::min<std::uint64_t>(most_caps, caps.size() - first);
            if (auto added = add_caps(device, layout, caps.data() + first, count); !added) {
                return added;
            }
        }
        if (auto made = make_indices(device, tube_, false, tube_indices_); !made) {
            return made;
        }
        return make_indices(device, cap_, true, cap_indices_);
    }

    [[nodiscard]] result<void> build_list(B& device, const branch_layout& layout) {
        const std::uint64_t each = max_triangles(tube_);
        const std::uint64_t bytes = 3 * each * sizeof(surface_vertex);
        const std::uint64_t most = chunk_of(device, bytes, 0);
        if (most == 0) {
            return too_small(bytes);
        }
        if (auto valid = check_vertices(layout.segments.size(), 3 * each); !valid) {
            return valid;
        }
        for (std::uint64_t first = 0; first < layout.segments.size(); first += most) {
            const std::uint64_t count =
                std::min<std::uint64_t>(most, layout.segments.size() - first);
            const std::uint64_t triangles = list_triangles(layout, first, count);
            auto added =
                add_tubes(device, layout, first, count, triangles * 3 * sizeof(surface_vertex));
            if (!added) {
                return added;
            }
            parts_.back().vertex_count = static_cast<std::uint32_t>(3 * triangles);
            parts_.back().triangles = static_cast<std::uint32_t>(triangles);
        }
        return {};
    }

    /// How many triangles the list form makes of these segments.
    [[nodiscard]] std::uint64_t list_triangles(const branch_layout& layout, std::uint64_t first,
                                               std::uint64_t count) const {
        if (options_.policy == padding::degenerate) {
            return count * max_triangles(tube_);
        }
        std::uint64_t triangles = count * tube_.ring_triangles();
        for (std::uint64_t i = first; i < first + count; ++i) {
            const std::uint32_t caps = layout.segments[i].caps;
            triangles += std::uint64_t{options_.sides - 2} *
                         (((caps & cap_start) != 0 ? 1u : 0u) + ((caps & cap_end) != 0 ? 1u : 0u));
        }
        return triangles;
    }

    /// Caps in the order of their segments, a segment's start before its end.
    [[nodiscard]] static std::vector<std::uint32_t> caps_of(const branch_layout& layout) {
        std::vector<std::uint32_t> caps;
        for (const branch_segment& s : layout.segments) {
            if ((s.caps & cap_start) != 0) {
                caps.push_back(2 * s.start + 1);
            }
            if ((s.caps & cap_end) != 0) {
                caps.push_back(2 * s.end);
            }
        }
        return caps;
    }

    /// Numbers the ends that a chunk needs from 0 on.
    class local_ends {
      public:
        explicit local_ends(const branch_layout& layout) : layout_(layout) {}
        [[nodiscard]] std::uint32_t operator()(std::uint32_t end) {
            const auto next = static_cast<std::uint32_t>(ends.size());
            const auto [place, added] = number_.try_emplace(end, next);
            if (added) {
                ends.push_back(layout_.ends[end]);
                if (!layout_.carriers.empty()) {
                    carriers.push_back(layout_.carriers[end]);
                }
            }
            return place->second;
        }
        std::vector<branch_end> ends;
        std::vector<end_carrier> carriers;

      private:
        const branch_layout& layout_;
        std::unordered_map<std::uint32_t, std::uint32_t> number_;
    };

    [[nodiscard]] result<void> add_tubes(B& device, const branch_layout& layout,
                                         std::uint64_t first, std::uint64_t count,
                                         std::uint64_t vertex_bytes) {
        if (count == layout.segments.size()) {
            return add_part<branch_segment>(device, layout.segments, layout.ends, layout.carriers,
                                            vertex_bytes);
        }
        local_ends local(layout);
        std::vector<branch_segment> segments(
            layout.segments.begin() + static_cast<std::ptrdiff_t>(first),
            layout.segments.begin() + static_cast<std::ptrdiff_t>(first + count));
        for (branch_segment& s : segments) {
            s.start = local(s.start);
            s.end = local(s.end);
        }
        return add_part<branch_segment>(device, segments, local.ends, local.carriers, vertex_bytes);
    }

    [[nodiscard]] result<void> add_caps(B& device, const branch_layout& layout,
                                        const std::uint32_t* caps, std::uint64_t count) {
        local_ends local(layout);
        std::vector<std::uint32_t> numbered(count);
        for (std::size_t i = 0; i < count; ++i) {
            numbered[i] = 2 * local(caps[i] / 2) + caps[i] % 2;
        }
        const std::uint64_t vertices = std::uint64_t{options_.sides} * count;
        auto added = add_part<std::uint32_t>(device, numbered, local.ends, local.carriers,
                                             vertices * sizeof(surface_vertex));
        if (added) {
            parts_.back().caps = true;
            parts_.back().vertex_count = static_cast<std::uint32_t>(vertices);
            parts_.back().triangles = static_cast<std::uint32_t>(count * cap_.ring_triangles());
        }
        return added;
    }

    template <class Element>
    [[nodiscard]] result<void>
    add_part(B& device, std::span<const Element> elements, std::span<const branch_end> ends,
             std::span<const end_carrier> carriers, std::uint64_t vertex_bytes) {
        result<buffer> made[] = {make_buffer<B, Element>(device, elements),
                                 make_buffer<B, branch_end>(device, ends),
                                 make_buffer<B, branch_end>(device, ends),
                                 make_buffer<B, end_carrier>(device, carriers),
                                 device.create_buffer(vertex_bytes),
                                 device.create_buffer(sizeof(count_record))};
        for (const result<buffer>& each : made) {
            if (!each) {
                return failure(each.error());
            }
        }
        parts_.push_back({std::move(*made[0]), std::move(*made[1]), std::move(*made[2]),
                          std::move(*made[3]), std::move(*made[4]), std::move(*made[5]),
                          static_cast<std::uint32_t>(ends.size()),
                          static_cast<std::uint32_t>(elements.size()), 0, 0, false});
        return {};
    }

    /// The index buffer that the largest part needs, made on the device from one element's.
    template <class Kernel>
    [[nodiscard]] result<void> make_indices(B& device, const Kernel& kernel, bool caps,
                                            std::optional<buffer>& indices) {
        std::uint32_t most = 0;
        for (const part& p : parts_) {
            most = p.caps == caps ? std::max(most, p.elements) : most;
        }
        std::vector<std::uint32_t> pattern(std::size_t{3} * kernel.ring_triangles());
        for (std::uint32_t k = 0; k < pattern.size(); ++k) {
            pattern[k] = kernel.ring_index(k);
        }
        auto pattern_buffer = make_buffer<B, std::uint32_t>(device, pattern);
        if (!pattern_buffer) {
            return failure(pattern_buffer.error());
        }
        const std::uint64_t count = pattern.size() * most;
        auto made = device.create_buffer(count * sizeof(std::uint32_t));
        if (!made) {
            return failure(made.error());
        }
        indices = std::move(*made);
        const kernels::ring_indices fill{static_cast<std::uint32_t>(pattern.size()),
                                         kernel.ring_vertices(), 0};
        return run(device, [&](recorder& r) {
            r.map(fill, {view<B>(*pattern_buffer), view<B>(*indices)},
                  range{0, static_cast<std::uint32_t>(count)});
        });
    }

    [[nodiscard]] result<void> download_indices(B& device, const part& p, std::uint32_t first,
                                                std::uint32_t vertex_count,
                                                std::vector<std::uint32_t>& to) const {
        const std::size_t before = to.size();
        if (options_.form == mesh_form::list) {
            to.resize(before + vertex_count);
            for (std::uint32_t i = 0; i < vertex_count; ++i) {
                to[before + i] = first + i;
            }
            return {};
        }
        to.resize(before + std::size_t{3} * p.triangles);
        auto done = device.download(p.caps ? *cap_indices_ : *tube_indices_, 0,
                                    writable_bytes_of(to, before));
        for (std::size_t i = before; i < to.size(); ++i) {
            to[i] += first;
        }
        return done;
    }

    branch_mesh_options options_;
    kernels::hermite_branch tube_;
    kernels::branch_cap cap_;
    std::optional<buffer> corners_; // all three are there after create
    std::optional<buffer> tube_indices_;
    std::optional<buffer> cap_indices_;
    std::vector<part> parts_;
};

} // namespace skybark::trees
