#pragma once
// The leaves of a tree, or of a forest, meshed on a device every time they are asked for.
// Source: Akagi and Kitajima, section 3.4.
//
//     const auto leaves = trees::place_leaves(skeleton, {});
//     auto mesh = trees::leaf_mesh<B>::create(device, leaves, {});
//     run(device, [&](auto& recorder) { mesh->record(recorder, {poses, air, seconds}); });
//
// The device is sent the leaves once. `record` makes all vertices anew, from where the segments
// are and how the air blows. Leaves that do not fit the device's largest buffer go in chunks.

#include <skybark/kernels/leaf_blade.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/view_detail.hpp>

#include <numeric>

namespace skybark::trees {

struct leaf_mesh_options {
    mesh_form form = mesh_form::rings;
    padding policy = padding::compact; ///< of the list
    /// Of the list: room for so many triangles in all, shared out by leaves. 0: for full detail.
    std::uint64_t room = 0;
    float flutter = 0.5f;       ///< tangent of half the largest twist
    float flutter_speed = 3.0f; ///< m/s where half of it is reached, > 0
    float lean = 0.6f;          ///< tangent of half the largest lean with the wind
    float lean_speed = 10.0f;   ///< m/s where half of it is reached, > 0
    float full = 3;             ///< pixels: smaller leaves are thinned out by a view's `thin`
    float quad = 4; ///< pixels: smaller ones are quadrilaterals by its `error`, half so up to twice
};

/// How the leaves are carried and what blows.
template <backend B>
struct leaf_motion {
    buffer_view<B> poses; ///< segment_pose, one a segment, or one for all; absent: at rest
    buffer_view<B> air;   ///< vec4 (velocity, speed) in m/s, the same way; absent: calm
    double time = 0;      ///< s
};

/// Leaves as triangles in buffers of backend B.
template <backend B>
requires maps<B, kernels::ring_indices> && expands_rings<B, kernels::leaf_blade> &&
    expands<B, kernels::leaf_blade>
class leaf_mesh {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Part of the mesh, small enough to be one draw.
    struct part {
        buffer leaves;   ///< leaf
        buffer vertices; ///< surface_vertex; room for what `record` makes
        buffer count;    ///< one count_record, of the list form
        std::uint32_t elements = 0;
        std::uint32_t vertex_count = 0;
        std::uint32_t triangles = 0; ///< in the list form, the most that there is room for
    };

    /// Sends the leaves to the device and makes room for their mesh. None is fine.
    /// Errors: bad_input where the mesh would have 2^32 vertices or more; whatever the device says
    /// of memory.
    [[nodiscard]] static result<leaf_mesh> create(B& device, std::span<const leaf> leaves,
                                                  leaf_mesh_options options) {
        leaf_mesh mesh;
        mesh.options_ = options;
        mesh.blade_.flutter = options.flutter;
        mesh.blade_.flutter_speed = options.flutter_speed;
        mesh.blade_.lean = options.lean;
        mesh.blade_.lean_speed = options.lean_speed;
        if (auto done = mesh.build(device, leaves); !done) {
            return failure(done.error());
        }
        return mesh;
    }

    /// Appends the making of all vertices, as detailed as the view asks. Allocates nothing.
    void record(recorder& to, const leaf_motion<B>& motion = {},
                const view_detail& seen = {}) const {
        kernels::leaf_blade blade = blade_;
        blade.time = kernels::flutter_time(motion.time);
        blade.camera = camera_of(seen);
        blade.full = seen.thin > 0 ? options_.full : none_so_small;
        blade.quad = seen.error > 0 ? options_.quad : none_so_small;
        const buffer_view<B> poses = motion.poses ? motion.poses : view<B>(*rest_);
        const buffer_view<B> air = motion.air ? motion.air : view<B>(*calm_);
        blade.pose_step = poses.size == sizeof(segment_pose) ? 0 : 1;
        blade.air_step = air.size == sizeof(glm::vec4) ? 0 : 1;
        for (const part& p : parts_) {
            const bindings<B, kernels::leaf_blade> buffers{view<B>(p.leaves), poses, air};
            const range all{0, p.elements};
            if (options_.form == mesh_form::rings) {
                to.expand_rings(blade, buffers, all, view<B>(p.vertices));
            } else {
                to.expand(blade, buffers, all,
                          triangle_list<B>{view<B>(p.vertices), view<B>(p.count), options_.policy});
            }
        }
    }

    /// What to draw: a kernel's vertices are `part.vertices`.
    [[nodiscard]] std::span<const part> parts() const { return parts_; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        draw_geometry<B> g;
        g.count = 3 * p.triangles;
        if (options_.form == mesh_form::list) {
            g.length = view<B>(p.count);
        } else {
            g.indices = view<B, std::uint32_t>(*indices_, 0, g.count);
        }
        return g;
    }

    /// Makes room where the last record of a list had too little, a quarter more than it needed.
    /// True if any was made: then record again. What had been made is gone. Waits for the device.
    [[nodiscard]] result<bool> grow(B& device) {
        bool grown = false;
        for (part& p : parts_) {
            if (options_.form != mesh_form::list) {
                break;
            }
            count_record count;
            if (auto done = read_back<B, count_record>(device, p.count, {&count, 1}); !done) {
                return failure(done.error());
            }
            if (count.required <= p.triangles) {
                continue;
            }
            const std::uint64_t full = std::uint64_t{p.elements} * blade_.ring_triangles();
            const std::uint64_t wanted = std::uint64_t{count.required} + count.required / 4;
            if (auto done = make_room(device, p, std::min(full, wanted)); !done) {
                return failure(done.error());
            }
            grown = true;
        }
        return grown;
    }

    /// The most that there is room for; level of detail makes fewer.
    [[nodiscard]] std::uint64_t triangles() const { return total(&part::triangles); }
    [[nodiscard]] std::uint64_t vertices() const { return total(&part::vertex_count); }
    [[nodiscard]] const leaf_mesh_options& options() const { return options_; }

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
            const bool list = options_.form == mesh_form::list;
            const std::size_t before = mesh.indices.size();
            mesh.indices.resize(before + (list ? count : std::size_t{3} * p.triangles));
            if (list) {
                std::iota(mesh.indices.data() + before, mesh.indices.data() + mesh.indices.size(),
                          0u);
            } else if (auto done =
                           device.download(*indices_, 0, writable_bytes_of(mesh.indices, before));
                       !done) {
                return failure(done.error());
            }
            for (std::size_t i = before; i < mesh.indices.size(); ++i) {
                mesh.indices[i] += first;
            }
        }
        return mesh;
    }

  private:
    leaf_mesh() = default;

    static constexpr float none_so_small = 1e-30f; ///< pixels

    [[nodiscard]] std::uint64_t total(std::uint32_t part::*of) const {
        std::uint64_t sum = 0;
        for (const part& p : parts_) {
            sum += p.*of;
        }
        return sum;
    }

    [[nodiscard]] result<void> build(B& device, std::span<const leaf> leaves) {
        const segment_pose rest;
        const glm::vec4 calm(0);
        if (auto done = keep(make_buffer<B, segment_pose>(device, {&rest, 1}), rest_); !done) {
            return done;
        }
        if (auto done = keep(make_buffer<B, glm::vec4>(device, {&calm, 1}), calm_); !done) {
            return done;
        }
        const bool list = options_.form == mesh_form::list;
        const std::uint64_t triangles = blade_.ring_triangles(); // as many as in its strips
        const std::uint64_t each = list ? 3 * triangles : blade_.ring_vertices();
        const std::uint64_t bytes = each * sizeof(surface_vertex);
        const device_limits limits = device.limits();
        const std::uint64_t most = std::min(limits.max_elements, limits.max_buffer_bytes / bytes);
        if (leaves.size() * each >= 0xffffffffull) {
            return fail(error_code::bad_input,
                        std::string("A mesh of ")
                            .append(std::to_string(leaves.size() * each))
                            .append(" vertices of leaves is beyond 32-bit indices; mesh the trees "
                                    "one by one."));
        }
        if (most == 0 && !leaves.empty()) {
            return fail(error_code::out_of_memory,
                        std::string("One leaf needs a buffer of ")
                            .append(std::to_string(bytes))
                            .append(" bytes, more than the device can bind."));
        }
        for (std::uint64_t first = 0; first < leaves.size(); first += most) {
            const std::uint64_t count = std::min<std::uint64_t>(most, leaves.size() - first);
            // Rounded up, so that no part is left without any.
            const std::uint64_t share = (options_.room * count + leaves.size() - 1) / leaves.size();
            const bool full = !list || options_.room == 0;
            const std::uint64_t room =
                full ? count * triangles : std::min(count * triangles, share);
            if (auto done = add_part(device, leaves.subspan(first, count), room); !done) {
                return done;
            }
        }
        return list || parts_.empty() ? result<void>{} : make_indices(device);
    }

    [[nodiscard]] static result<void> keep(result<buffer> made, std::optional<buffer>& as) {
        if (!made) {
            return failure(made.error());
        }
        as = std::move(*made);
        return {};
    }

    /// A part of these leaves, with room for so many triangles.
    [[nodiscard]] result<void> add_part(B& device, std::span<const leaf> leaves,
                                        std::uint64_t triangles) {
        auto leaf_buffer = make_buffer<B, leaf>(device, leaves);
        if (!leaf_buffer) {
            return failure(leaf_buffer.error());
        }
        auto vertex_buffer = device.create_buffer(0);
        if (!vertex_buffer) {
            return failure(vertex_buffer.error());
        }
        auto count_buffer = device.create_buffer(sizeof(count_record));
        if (!count_buffer) {
            return failure(count_buffer.error());
        }
        parts_.push_back({std::move(*leaf_buffer), std::move(*vertex_buffer),
                          std::move(*count_buffer), static_cast<std::uint32_t>(leaves.size()), 0,
                          0});
        return make_room(device, parts_.back(), triangles);
    }

    [[nodiscard]] result<void> make_room(B& device, part& p, std::uint64_t triangles) const {
        const std::uint64_t vertices = options_.form == mesh_form::list
                                           ? 3 * triangles
                                           : std::uint64_t{p.elements} * blade_.ring_vertices();
        auto room = device.create_buffer(vertices * sizeof(surface_vertex));
        if (!room) {
            return failure(room.error());
        }
        p.vertices = std::move(*room);
        p.vertex_count = static_cast<std::uint32_t>(vertices);
        p.triangles = static_cast<std::uint32_t>(triangles);
        return {};
    }

    /// The index buffer that the first part needs, which is the largest.
    [[nodiscard]] result<void> make_indices(B& device) {
        std::vector<std::uint32_t> pattern(std::size_t{3} * blade_.ring_triangles());
        for (std::uint32_t k = 0; k < pattern.size(); ++k) {
            pattern[k] = blade_.ring_index(k);
        }
        auto pattern_buffer = make_buffer<B, std::uint32_t>(device, pattern);
        if (!pattern_buffer) {
            return failure(pattern_buffer.error());
        }
        const std::uint64_t count = pattern.size() * parts_.front().elements;
        if (auto done = keep(device.create_buffer(count * sizeof(std::uint32_t)), indices_);
            !done) {
            return done;
        }
        const kernels::ring_indices fill{static_cast<std::uint32_t>(pattern.size()),
                                         blade_.ring_vertices(), 0};
        return run(device, [&](recorder& r) {
            r.map(fill, {view<B>(*pattern_buffer), view<B>(*indices_)},
                  range{0, static_cast<std::uint32_t>(count)});
        });
    }

    leaf_mesh_options options_;
    kernels::leaf_blade blade_;
    std::optional<buffer> rest_; // both are there after create
    std::optional<buffer> calm_;
    std::optional<buffer> indices_; // of the ring form
    std::vector<part> parts_;
};

} // namespace skybark::trees
