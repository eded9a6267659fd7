#pragma once
// The branches of a tree, or of a forest, meshed with as much detail as can be seen from a place.
//
//     auto mesh = trees::detailed_branch_mesh<B>::create(device, skeleton, {});
//     auto view = trees::view_from(camera, picture_height, field_of_view);
//     run(device, [&](auto& recorder) { mesh->record(recorder, *view); });
//
// The device chooses, every time anew: sides and rings by how far the surface would be off in
// pixels, and how many of the branches that are thinner than a pixel are worth drawing, the others
// widened in their place (Cook, Halstead, Planck and Ryu 2007); segments in a row become one where
// that is close enough. All of it is continuous in the camera's place: nothing appears or goes away
// but where it has no size, or is where it would be without.
//
// A scene that does not fit the device's largest buffer is cut into chunks of whole segments. Where
// a chunk ends, so does the merging of segments; the surface is whole across.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/kernels/detailed_branch.hpp>
#include <skybark/kernels/merge_ends.hpp>
#include <skybark/kernels/pose_ends.hpp>
#include <skybark/kernels/unit_polygon.hpp>
#include <skybark/trees/branch_layout.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/view_detail.hpp>

#include <numeric>
#include <optional>
#include <unordered_map>

namespace skybark::trees {

namespace detail {

/// A chain of a skeleton: a segment and its continuations.
struct skeleton_chain {
    std::uint32_t first = 0; ///< segment
    std::uint32_t tree = 0;  ///< root segment
    float radius = 0;        ///< m, where it starts
};

/// Turns of the golden angle: any so many numbers in a row are spread evenly over 0…1 (Weyl).
[[nodiscard]] inline float golden_rank(std::uint32_t n) {
    return static_cast<float>((n * 2654435769u) >> 8) * 0x1p-24f;
}

} // namespace detail

/// When each end's chain is left out as it gets thin: one share an end of `layout`, which is that
/// of `from`. A tree's chains are ranked by thickness, so that what stays stands for others as
/// thick, and a tree's thickest chain is never left out.
template <class = when_used>
[[nodiscard]] std::vector<kernels::chain_share> chain_shares(const skeleton& from,
                                                             const branch_layout& layout) {
    std::vector<detail::skeleton_chain> chains;
    std::vector<std::uint32_t> chain_of(from.size());
    for (std::uint32_t i = 0; i < from.size(); ++i) {
        const std::uint32_t p = from.parent[i];
        if (p != none && from.continuation[p] == i) {
            chain_of[i] = chain_of[p];
            continue;
        }
        chain_of[i] = static_cast<std::uint32_t>(chains.size());
        const std::uint32_t tree = p == none ? i : chains[chain_of[p]].tree;
        chains.push_back({i, tree, layout.ends[layout.segments[i].start].radius});
    }
    std::vector<std::uint32_t> order(chains.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return chains[a].tree != chains[b].tree ? chains[a].tree < chains[b].tree
                                                : chains[a].radius > chains[b].radius;
    });
    std::vector<kernels::chain_share> of_chain(chains.size());
    std::uint32_t place = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool thickest = k == 0 || chains[order[k]].tree != chains[order[k - 1]].tree;
        place = thickest ? 0 : place + 1;
        // A cut of 3/2 leaves nothing out. The n-th thickest stands for n chains at most.
        of_chain[order[k]] = {detail::golden_rank(place), 1.5f / static_cast<float>(place + 1), 0,
                              0}; // its place is the mesh's own
    }
    std::vector<kernels::chain_share> shares(layout.ends.size());
    for (std::uint32_t i = 0; i < from.size(); ++i) {
        shares[layout.segments[i].start] = of_chain[chain_of[i]];
        shares[layout.segments[i].end] = of_chain[chain_of[i]];
    }
    return shares;
}

struct detailed_mesh_options {
    /// Of a ring in full detail, 3 … 1024. Halved as long as three or more are left: 8 and 16 go
    /// down to 4, 12 and 24 to 3, odd numbers stay.
    std::uint32_t sides = 8;
    /// A segment in full detail, both ends included, 2 … 1024. The gaps between are divided by
    /// their prime factors, down to one: 5 rings go to 3 and 2, 4 rings to 2.
    std::uint32_t rings = 4;
    kernels::branch_frame frame = kernels::branch_frame::slerp;
    padding policy = padding::compact;
    /// Room for so many triangles in all, shared out by segments. 0: for full detail.
    std::uint64_t room = 0;
};

/// What a record made, and what it would have made with room for all of it.
struct made_triangles {
    std::uint64_t written = 0;
    std::uint64_t required = 0;
};

/// The branches of a skeleton as a triangle list in buffers of backend B, as detailed as a view
/// asks for. In full detail it is the list of a `branch_mesh` with the same sides and rings.
template <backend B>
requires maps<B, kernels::pose_ends> && maps<B, kernels::branch_detail> &&
    maps<B, kernels::merge_chains> && maps<B, kernels::merge_ends> &&
    maps<B, kernels::segment_rings> && expands<B, kernels::detailed_branch>
class detailed_branch_mesh {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Part of the mesh, small enough to be one draw.
    struct part {
        buffer segments; ///< branch_segment
        buffer rest;     ///< branch_end
        buffer carriers; ///< end_carrier
        buffer shares;   ///< chain_share
        buffer chains;   ///< end_chain
        buffer now;      ///< branch_end, posed
        buffer pieces;   ///< chain_detail
        buffer merged;   ///< branch_end, that are drawn
        buffer details;  ///< end_detail
        buffer drawn;    ///< branch_segment
        buffer rings;    ///< segment_detail
        buffer vertices; ///< surface_vertex; room for `triangles`
        buffer count;    ///< one count_record
        std::uint32_t elements = 0;
        std::uint32_t ends = 0;
        std::uint32_t runs = 0; ///< chains
        std::uint32_t triangles = 0;
        std::uint32_t most = 0; ///< triangles in full detail
    };

    /// Sends the skeleton to the device and makes room for its mesh.
    /// Errors: bad_input where the options are out of range or a part would have 2^32 vertices or
    /// more; whatever the device says of memory.
    [[nodiscard]] static result<detailed_branch_mesh> create(B& device, const skeleton& of,
                                                             detailed_mesh_options options) {
        const branch_layout layout = layout_branches(of, options.frame);
        return create(device, layout, chain_shares(of, layout), options);
    }

    /// The same from a layout, with one share an end.
    [[nodiscard]] static result<detailed_branch_mesh>
    create(B& device, const branch_layout& layout, std::span<const kernels::chain_share> shares,
           detailed_mesh_options options) {
        if (auto valid = check(options, layout, shares); !valid) {
            return failure(valid.error());
        }
        detailed_branch_mesh mesh;
        mesh.options_ = options;
        mesh.tube_ = {options.sides, options.rings, options.frame,
                      kernels::least_sides(options.sides)};
        if (auto done = mesh.build(device, layout, shares); !done) {
            return failure(done.error());
        }
        return mesh;
    }

    /// Appends the making of all triangles, at rest. Allocates nothing.
    void record(recorder& to, const view_detail& view) const {
        for (const part& p : parts_) {
            record_part(to, p, p.rest, view);
        }
    }

    /// The same with the segments moved: `poses` has one segment_pose a segment of the skeleton.
    void record(recorder& to, const buffer_view<B>& poses, const view_detail& view) const {
        for (const part& p : parts_) {
            to.map(kernels::pose_ends{},
                   {skybark::view<B>(p.rest), skybark::view<B>(p.carriers), poses,
                    skybark::view<B>(p.now)},
                   range{0, p.ends});
            record_part(to, p, p.now, view);
        }
    }

    /// What to draw: a kernel's vertices are `part.vertices`.
    [[nodiscard]] std::span<const part> parts() const { return parts_; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        draw_geometry<B> list;
        list.count = 3 * p.triangles;
        list.length = view<B>(p.count);
        return list;
    }

    /// The most that there is room for.
    [[nodiscard]] std::uint64_t triangles() const {
        std::uint64_t sum = 0;
        for (const part& p : parts_) {
            sum += p.triangles;
        }
        return sum;
    }
    [[nodiscard]] const detailed_mesh_options& options() const { return options_; }

    /// What the last record made. Waits for the device.
    [[nodiscard]] result<made_triangles> made(B& device) const {
        made_triangles sum;
        for (const part& p : parts_) {
            count_record count;
            if (auto done = read_back<B, count_record>(device, p.count, {&count, 1}); !done) {
                return failure(done.error());
            }
            sum.written += count.written;
            sum.required += count.required;
        }
        return sum;
    }

    /// Makes room where the last record had too little, a quarter more than it needed. True if any
    /// was made: then record again. What had been made is gone. Waits for the device.
    [[nodiscard]] result<bool> grow(B& device) {
        bool grown = false;
        for (part& p : parts_) {
            count_record count;
            if (auto done = read_back<B, count_record>(device, p.count, {&count, 1}); !done) {
                return failure(done.error());
            }
            if (count.required <= p.triangles) {
                continue;
            }
            const std::uint64_t wanted = std::uint64_t{count.required} + count.required / 4;
            const auto room = static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, p.most));
            auto larger = device.create_buffer(bytes_of(room));
            if (!larger) {
                return failure(larger.error());
            }
            p.vertices = std::move(*larger);
            p.triangles = room;
            grown = true;
        }
        return grown;
    }

    /// The whole mesh as it was last made: the vertices are the triangles' corners in order.
    [[nodiscard]] result<host_mesh> download(B& device) const {
        host_mesh mesh;
        for (const part& p : parts_) {
            count_record count;
            if (auto done = read_back<B, count_record>(device, p.count, {&count, 1}); !done) {
                return failure(done.error());
            }
            const std::size_t first = mesh.vertices.size();
            mesh.vertices.resize(first + std::size_t{3} * count.written);
            if (auto done = device.download(p.vertices, 0, writable_bytes_of(mesh.vertices, first));
                !done) {
                return failure(done.error());
            }
        }
        mesh.indices.resize(mesh.vertices.size());
        std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
        return mesh;
    }

  private:
    detailed_branch_mesh() = default;

    [[nodiscard]] static result<void> check(const detailed_mesh_options& options,
                                            const branch_layout& layout,
                                            std::span<const kernels::chain_share> shares) {
        const auto out_of_range = [](const char* what, std::uint32_t value, std::uint32_t least) {
            std::string sentence = "A branch mesh cannot have ";
            sentence.append(std::to_string(value)).append(" ").append(what);
            sentence.append("; it takes ").append(std::to_string(least)).append(" to 1024.");
            return fail(error_code::bad_input, std::move(sentence));
        };
        if (options.sides < 3 || options.sides > 1024) {
            return out_of_range("sides", options.sides, 3);
        }
        if (options.rings < 2 || options.rings > 1024) {
            return out_of_range("rings", options.rings, 2);
        }
        if (shares.size() != layout.ends.size() || layout.carriers.size() != layout.ends.size()) {
            return fail(error_code::bad_input,
                        "A detailed branch mesh needs one share and one carrier an end.");
        }
        return {};
    }

    void record_part(recorder& to, const part& p, const buffer& ends,
                     const view_detail& seen_from) const {
        const glm::vec4 camera = camera_of(seen_from);
        const bool full = camera.w == 0;
        const float error = full ? 0 : seen_from.error;
        const float thin = full ? 0 : seen_from.thin;
        const std::uint32_t fewest = tube_.fewest_sides;
        to.map(kernels::merge_chains{camera, error},
               {view<B>(p.chains), view<B>(ends), view<B>(p.pieces)}, range{0, p.runs});
        to.map(kernels::merge_ends{},
               {view<B>(ends), view<B>(p.shares), view<B>(p.pieces), view<B>(p.merged)},
               range{0, p.ends});
        to.map(kernels::branch_detail{camera, error, thin, fewest, options_.sides},
               {view<B>(p.merged), view<B>(p.shares), view<B>(p.details)}, range{0, p.ends});
        to.map(kernels::segment_rings{camera.w, error, fewest, options_.sides, options_.rings - 1},
               {view<B>(p.segments), view<B>(p.merged), view<B>(p.shares), view<B>(p.pieces),
                view<B>(p.details), view<B>(p.drawn), view<B>(p.rings)},
               range{0, p.elements});
        to.expand(tube_,
                  {view<B>(p.drawn), view<B>(p.merged), view<B>(*corners_), view<B>(p.details),
                   view<B>(p.rings)},
                  range{0, p.elements},
                  triangle_list<B>{view<B>(p.vertices), view<B>(p.count), options_.policy});
    }

    [[nodiscard]] static std::uint64_t bytes_of(std::uint64_t triangles) {
        return triangles * 3 * sizeof(surface_vertex);
    }

    [[nodiscard]] result<void> build(B& device, const branch_layout& layout,
                                     std::span<const kernels::chain_share> shares) {
        const std::vector<glm::vec4> corners = kernels::unit_polygon(options_.sides);
        auto made = make_buffer<B, glm::vec4>(device, corners);
        if (!made) {
            return failure(made.error());
        }
        corners_ = std::move(*made);
        // Two ends a segment at worst; a draw's vertices are numbered with 32 bits.
        const std::uint64_t each = bytes_of(max_triangles(tube_));
        const device_limits limits = device.limits();
        const std::uint64_t most = std::min(
            {limits.max_elements, limits.max_buffer_bytes / std::max<std::uint64_t>(each, 96),
             std::uint64_t{0xfffffffe} / (3 * max_triangles(tube_))});
        if (most == 0) {
            std::string sentence = "One branch segment needs a buffer of ";
            sentence.append(std::to_string(each))
                .append(" bytes, more than the device can bind; use fewer sides or rings.");
            return fail(error_code::out_of_memory, std::move(sentence));
        }
        for (std::uint64_t first = 0; first < layout.segments.size(); first += most) {
            const std::uint64_t count =
                std::min<std::uint64_t>(most, layout.segments.size() - first);
            if (auto added = add_part(device, layout, shares, first, count); !added) {
                return added;
            }
        }
        return {};
    }

    /// How many triangles these segments have in full detail.
    [[nodiscard]] std::uint64_t full_triangles(const std::vector<branch_segment>& segments) const {
        if (options_.policy == padding::degenerate) {
            return segments.size() * max_triangles(tube_);
        }
        std::uint64_t triangles =
            std::uint64_t{2} * options_.sides * (options_.rings - 1) * segments.size();
        for (const branch_segment& s : segments) {
            triangles +=
                std::uint64_t{options_.sides - 2} *
                (((s.caps & cap_start) != 0 ? 1u : 0u) + ((s.caps & cap_end) != 0 ? 1u : 0u));
        }
        return triangles;
    }

    /// What a part sends to the device: its ends numbered from 0 on, chain by chain.
    struct part_data {
        std::vector<branch_segment> segments;
        std::vector<branch_end> ends;
        std::vector<end_carrier> carriers;
        std::vector<kernels::chain_share> shares;
        std::vector<kernels::end_chain> chains;
    };

    [[nodiscard]] static part_data data_of(const branch_layout& layout,
                                           std::span<const kernels::chain_share> shares,
                                           std::uint64_t first, std::uint64_t count) {
        // Chains as these segments have them, each a list of segments.
        std::vector<std::vector<std::uint32_t>> chains;
        std::unordered_map<std::uint32_t, std::size_t> chain_to; // by the end that it has reached
        for (std::uint64_t i = first; i < first + count; ++i) {
            const branch_segment& s = layout.segments[i];
            const auto found = chain_to.find(s.start);
            const std::size_t chain = found != chain_to.end() ? found->second : chains.size();
            if (found != chain_to.end()) {
                chain_to.erase(found);
            } else {
                chains.emplace_back();
            }
            chains[chain].push_back(static_cast<std::uint32_t>(i));
            chain_to.emplace(s.end, chain);
        }
        part_data data;
        data.segments.resize(count);
        for (const std::vector<std::uint32_t>& chain : chains) {
            const auto base = static_cast<std::uint32_t>(data.ends.size());
            const auto add = [&](std::uint32_t end) {
                const auto place = static_cast<std::uint32_t>(data.ends.size()) - base;
                data.ends.push_back(layout.ends[end]);
                data.carriers.push_back(layout.carriers[end]);
                data.shares.push_back({shares[end].rank, shares[end].least,
                                       static_cast<std::uint32_t>(data.chains.size()), place});
                return base + place;
            };
            std::uint32_t end = add(layout.segments[chain.front()].start);
            for (const std::uint32_t i : chain) {
                const std::uint32_t start = end;
                end = add(layout.segments[i].end);
                data.segments[i - first] = {start, end, layout.segments[i].caps, 0};
            }
            data.chains.push_back({base, end, layout.segments[chain.back()].caps, 0});
        }
        return data;
    }

    [[nodiscard]] result<void> add_part(B& device, const branch_layout& layout,
                                        std::span<const kernels::chain_share> shares,
                                        std::uint64_t first, std::uint64_t count) {
        const part_data data = data_of(layout, shares, first, count);
        const std::uint64_t most = full_triangles(data.segments);
        std::uint64_t room = most;
        if (options_.room != 0) {
            // Rounded up, so that no part is left without any.
            const std::uint64_t share =
                (options_.room * count + layout.segments.size() - 1) / layout.segments.size();
            room = std::min(most, share);
        }
        std::array<result<buffer>, 13> made{
            make_buffer<B, branch_segment>(device, data.segments),
            make_buffer<B, branch_end>(device, data.ends),
            make_buffer<B, end_carrier>(device, data.carriers),
            make_buffer<B, kernels::chain_share>(device, data.shares),
            make_buffer<B, kernels::end_chain>(device, data.chains),
            device.create_buffer(data.ends.size() * sizeof(branch_end)),
            device.create_buffer(data.chains.size() * sizeof(kernels::chain_detail)),
            device.create_buffer(data.ends.size() * sizeof(branch_end)),
            device.create_buffer(data.ends.size() * sizeof(kernels::end_detail)),
            device.create_buffer(count * sizeof(branch_segment)),
            device.create_buffer(count * sizeof(kernels::segment_detail)),
            device.create_buffer(bytes_of(room)),
            device.create_buffer(sizeof(count_record))};
        for (const result<buffer>& one : made) {
            if (!one) {
                return failure(one.error());
            }
        }
        parts_.push_back({std::move(*made[0]), std::move(*made[1]), std::move(*made[2]),
                          std::move(*made[3]), std::move(*made[4]), std::move(*made[5]),
                          std::move(*made[6]), std::move(*made[7]), std::move(*made[8]),
                          std::move(*made[9]), std::move(*made[10]), std::move(*made[11]),
                          std::move(*made[12]), static_cast<std::uint32_t>(count),
                          static_cast<std::uint32_t>(data.ends.size()),
                          static_cast<std::uint32_t>(data.chains.size()),
                          static_cast<std::uint32_t>(room), static_cast<std::uint32_t>(most)});
        return {};
    }

    detailed_mesh_options options_;
    kernels::detailed_branch tube_;
    std::optional<buffer> corners_; // there after create
    std::vector<part> parts_;
};

} // namespace skybark::trees
