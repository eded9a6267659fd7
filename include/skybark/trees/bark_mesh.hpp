#pragma once
// Bark on the triangles that a mesh left in device memory: large ones are split at their edges'
// midpoints, which a height map moves, until every edge is under a threshold; small ones pass.
// Source: Akagi and Kitajima, sections 2.3 and 3.3 (the second stage, GS2).
//
//     auto mesh = trees::branch_mesh<B>::create(device, skeleton, {});
//     run(device, [&](auto& recorder) { mesh->record(recorder); });
//     auto bark = trees::bark_mesh<B>::create(device, *mesh, {}, trees::furrowed_bark(1));
//     run(device, [&](auto& recorder) { mesh->record(recorder); bark->record(recorder, *mesh); });
//
// Most triangles of a tree are twigs far below the threshold. Those stay where they are, in the
// mesh's own vertices, under an index buffer of their own; only the others become a list. Counts
// stay on the device. The list's room has a reserve; `update` gives more where it was too little.
//
// Each pass splits as many levels as the device likes to make at once
// (device_limits::amplification), with the same result.
//
// A triangle with two long edges becomes three in each level, so long narrow ones cost more than
// their area: best are meshes whose rings lie about as far apart as their corners.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/kernels/bark.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/branch_mesh.hpp>

#include <array>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

namespace skybark::trees {

struct bark_options {
    float threshold = 0.03f;          ///< m; longer edges are split
    float relief = 0.025f;            ///< m, from the map's height 0 to its height 1
    std::uint32_t repeats_around = 2; ///< of the map, once around a branch
    float repeats_per_metre = 1.4f;   ///< of the map, along a branch
    float steepest = 0.2f;            ///< a midpoint rises by at most this much of its edge
    float rounding = 1; ///< 1: midpoints on the curve that the normals ask for; 0: on the chord
    std::uint32_t most_passes = 6;     ///< levels of splitting: each halves the edges; 1 … 12
    padding policy = padding::compact; ///< degenerate: room for four times as many in each level
    float stretch = 1.25f;  ///< ≥ 1; edges that this makes longer than the threshold may be split
    float narrowest = 0.5f; ///< of the threshold, 0 … 0.75: what is narrower around stays whole
    float reserve = 0.25f;  ///< of the lists' room, for sway
    /// m: a branch of this radius has all of the relief, a thinner one as much less as it is
    /// thinner, in steps of a half. 0: all branches have all of it.
    float thickness = 0;
};

namespace detail {

/// The most that a triangle's edges reach around the branch, by its corners' tangents, m. Infinite
/// where no corner has one.
[[nodiscard]] inline float width_around(const surface_vertex& a, const surface_vertex& b,
                                        const surface_vertex& c) {
    float width = 0;
    bool any = false;
    for (const surface_vertex* corner : {&a, &b, &c}) {
        if (corner->tangent.w == 0) {
            continue;
        }
        any = true;
        const glm::vec3 t(corner->tangent);
        for (const glm::vec3& edge :
             {b.position - a.position, c.position - b.position, a.position - c.position}) {
            width = std::max(width, std::abs(glm::dot(edge, t)));
        }
    }
    return any ? width : std::numeric_limits<float>::infinity();
}

/// Finds which triangles hang together by edges that may be split.
template <class = when_used>
class long_edge_groups {
  public:
    long_edge_groups(const std::vector<surface_vertex>& vertices,
                     const std::vector<std::uint32_t>& indices, float shortest)
        : group_(indices.size() / 3) {
        for (std::uint32_t t = 0; t < group_.size(); ++t) {
            group_[t] = t;
        }
        std::unordered_map<edge, std::uint32_t, edge_hash> first;
        for (std::uint32_t k = 0; k < 3 * group_.size(); ++k) {
            const std::uint32_t n = k % 3 == 2 ? k - 2 : k + 1;
            const glm::vec3& a = vertices[indices[k]].position;
            const glm::vec3& b = vertices[indices[n]].position;
            if (shared::bark_edge_square(a, b) > shortest * shortest) {
                const bool in_order = shared::bark_in_order(a, b);
                const auto [place, added] =
                    first.try_emplace(in_order ? edge{a, b} : edge{b, a}, k / 3);
                if (!added) {
                    group_[of(k / 3)] = of(place->second);
                }
            }
        }
    }

    [[nodiscard]] std::uint32_t of(std::uint32_t triangle) {
        while (group_[triangle] != triangle) {
            group_[triangle] = group_[group_[triangle]];
            triangle = group_[triangle];
        }
        return triangle;
    }

  private:
    struct edge {
        glm::vec3 from, to;
        bool operator==(const edge& other) const { return from == other.from && to == other.to; }
    };
    struct edge_hash {
        std::size_t operator()(const edge& e) const {
            std::uint64_t h = 0;
            for (const float x : {e.from.x, e.from.y, e.from.z, e.to.x, e.to.y, e.to.z}) {
                std::uint32_t word = 0;
                const float no_minus = x + 0.0f; // -0 equals 0
                std::memcpy(&word, &no_minus, sizeof word);
                h = (h ^ word) * 0x9e3779b97f4a7c15ull;
                h ^= h >> 29;
            }
            return static_cast<std::size_t>(h);
        }
    };

    std::vector<std::uint32_t> group_;
};

/// How many times the relief is halved for a triangle, 0 … 7, if it may ever be refined, or this.
inline constexpr std::uint8_t not_refined = 255;

/// The mean radius of the branches in each group, by how far u goes over so much of their width.
template <class = when_used>
[[nodiscard]] std::vector<float> radii_of_groups(const std::vector<surface_vertex>& vertices,
                                                 const std::vector<std::uint32_t>& indices,
                                                 long_edge_groups<>& groups) {
    const std::size_t triangles = indices.size() / 3;
    std::vector<float> sum(triangles, 0.0f), count(triangles, 0.0f);
    for (std::size_t t = 0; t < triangles; ++t) {
        const surface_vertex& a = vertices[indices[3 * t]];
        const surface_vertex& b = vertices[indices[3 * t + 1]];
        const surface_vertex& c = vertices[indices[3 * t + 2]];
        const float width = width_around(a, b, c);
        const float turn = std::max({a.u, b.u, c.u}) - std::min({a.u, b.u, c.u});
        if (turn > 1e-4f && std::isfinite(width)) {
            const std::uint32_t group = groups.of(static_cast<std::uint32_t>(t));
            sum[group] += width / (6.2831853f * turn);
            count[group] += 1;
        }
    }
    for (std::size_t t = 0; t < triangles; ++t) {
        sum[t] = count[t] > 0 ? sum[t] / count[t] : std::numeric_limits<float>::infinity();
    }
    return sum;
}

/// Which triangles may ever be refined: those with edges that sway may make longer than the
/// threshold, unless all that hang together by such edges are too narrow around for bark to show.
/// So an edge between one that is refined and one that is not, or between two with other halvings,
/// isn't split at rest, nor in any pose that stretches it less than that.
template <class = when_used>
[[nodiscard]] std::vector<std::uint8_t>
triangles_to_refine(const std::vector<surface_vertex>& vertices,
                    const std::vector<std::uint32_t>& indices, const bark_options& options) {
    const std::size_t triangles = indices.size() / 3;
    const float shortest = options.threshold / options.stretch;
    const auto corner = [&](std::size_t t, std::size_t k) -> const surface_vertex& {
        return vertices[indices[3 * t + k]];
    };
    long_edge_groups<> groups(vertices, indices, shortest);
    std::vector<bool> wide(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        if (width_around(corner(t, 0), corner(t, 1), corner(t, 2)) >=
            options.narrowest * options.threshold) {
            wide[groups.of(static_cast<std::uint32_t>(t))] = true;
        }
    }
    std::vector<float> radius;
    if (options.thickness > 0) {
        radius = radii_of_groups(vertices, indices, groups);
    }
    const auto halvings_of = [&](std::uint32_t group) {
        std::uint8_t halvings = 0;
        for (float r = options.thickness;
             !radius.empty() && halvings < 7 && r > 1.4f * radius[group]; r *= 0.5f) {
            ++halvings;
        }
        return halvings;
    };
    std::vector<std::uint8_t> refine(triangles, not_refined);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::uint32_t group = groups.of(static_cast<std::uint32_t>(t));
        if (wide[group] && shared::bark_pattern(corner(t, 0).position, corner(t, 1).position,
                                                corner(t, 2).position, shortest) != 0) {
            refine[t] = halvings_of(group);
        }
    }
    return refine;
}

} // namespace detail

/// The bark of a mesh with `parts()`, each with its `vertices` (a buffer of surface_vertex), and
/// `geometry(part)`, such as branch_mesh. Parts that say `caps` pass as they are: these flat caps
/// share no normals with the tubes that they close.
///
/// What may be refined is settled by `create`, at rest. An edge between a refined triangle and one
/// that stays is shorter than threshold / stretch then; where a gale stretches it beyond the
/// threshold (collars of twigs on boughs that bend a lot, with thresholds of a few centimetres),
/// one side splits it and the other doesn't, and the surface opens there by the midpoint's rise.
template <backend B>
requires expands<B, kernels::bark>
class bark_mesh {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// A list of refined triangles, from part of one of the mesh's parts.
    struct part {
        std::uint32_t of = 0;    ///< which of the mesh's parts
        std::uint32_t first = 0; ///< triangle of that part, where it has no indices of its own
        std::uint32_t elements = 0;
        float relief = 0;                  ///< m
        std::optional<buffer> indices;     ///< of the triangles to refine
        std::optional<buffer> vertices;    ///< surface_vertex, three a triangle; there after create
        std::vector<buffer> counts;        ///< a count_record for each pass
        std::vector<std::uint32_t> rooms;  ///< triangles, after each pass
        std::vector<std::uint32_t> levels; ///< of each pass
    };

    /// Triangles that stay as they are in the mesh's own vertices.
    struct plain_part {
        std::uint32_t of = 0;          ///< which of the mesh's parts
        std::optional<buffer> indices; ///< of these triangles; none: all that the part has
        std::uint32_t triangles = 0;
    };

    /// Sorts out what is to be refined and makes room. The mesh's vertices must have been made; as
    /// they are now they decide which triangles may ever be refined (edges longer than threshold /
    /// stretch), how many levels there are, and how much room.
    /// Errors: bad_input where the options are out of range or the texture has no texels, another
    /// number of heights than its size says, or heights that are not numbers; whatever the device
    /// says of memory.
    template <class Mesh>
    [[nodiscard]] static result<bark_mesh>
    create(B& device, const Mesh& mesh, const bark_options& options, const bark_texture& texture) {
        if (auto valid = check(options); !valid) {
            return failure(valid.error());
        }
        if (auto valid = check(texture); !valid) {
            return failure(valid.error());
        }
        bark_mesh made(options, texture);
        if (auto done = made.build(device, mesh, texture); !done) {
            return failure(done.error());
        }
        return made;
    }

    /// Appends all passes; the mesh's own record comes before. Allocates nothing.
    template <class Mesh>
    void record(recorder& to, const Mesh& mesh) const {
        for (const part& p : parts_) {
            for (std::uint32_t pass = 0; pass < p.rooms.size(); ++pass) {
                const bool last = pass + 1 == p.rooms.size();
                const buffer_view<B> list = view<B, surface_vertex>(
                    last ? *p.vertices : *scratch_[pass % 2], 0, std::uint64_t{3} * p.rooms[pass]);
                const triangle_list<B> out{list, view<B>(p.counts[pass]), options_.policy};
                kernels::bark kernel = kernel_;
                kernel.relief = p.relief;
                kernel.levels = p.levels[pass];
                if (pass == 0) {
                    record_first(to, mesh, p, kernel, out);
                } else {
                    to.expand(kernel, later_bindings(*scratch_[(pass - 1) % 2]),
                              counted<B>{view<B>(p.counts[pass - 1]), p.rooms[pass - 1]}, out);
                }
            }
        }
    }

    /// Reads how many triangles the last frame's lists wanted and makes more room, for the next
    /// frame, where there was too little. True if there was.
    template <class Mesh>
    [[nodiscard]] result<bool> update(B& device, const Mesh& mesh) {
        std::vector<part> before = std::move(parts_);
        parts_.clear();
        bool grown = false;
        for (part& p : before) {
            const result<bool> full = was_short(device, p);
            if (!full) {
                return failure(full.error());
            }
            if (!*full) {
                parts_.push_back(std::move(p));
                continue;
            }
            grown = true;
            if (auto done = fit(device, mesh, std::move(p)); !done) {
                return failure(done.error());
            }
        }
        return grown;
    }

    [[nodiscard]] std::span<const part> parts() const { return parts_; }
    [[nodiscard]] std::span<const plain_part> plain_parts() const { return plain_; }
    [[nodiscard]] const bark_options& options() const { return options_; }
    [[nodiscard]] const kernels::bark& kernel() const { return kernel_; }

    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        draw_geometry<B> list;
        list.count = 3 * p.rooms.back();
        list.length = view<B>(p.counts.back());
        return list;
    }
    template <class Mesh>
    [[nodiscard]] draw_geometry<B> geometry(const Mesh& mesh, const plain_part& p) const {
        draw_geometry<B> own = mesh.geometry(mesh.parts()[p.of]);
        if (p.indices) {
            own.indices = view<B>(*p.indices);
            own.first = 0;
            own.count = 3 * p.triangles;
        }
        return own;
    }

    /// Calls `draw(vertices, geometry)` for everything that the tree's surface now is: a view of
    /// surface_vertex, and which of them.
    template <class Mesh, class Draw>
    void for_each_draw(const Mesh& mesh, Draw&& draw) const {
        for (const part& p : parts_) {
            draw(view<B>(*p.vertices), geometry(p));
        }
        for (const plain_part& p : plain_) {
            draw(view<B>(mesh.parts()[p.of].vertices), geometry(mesh, p));
        }
    }

    /// How many triangles the lists have and how many they wanted, summed; plain ones apart.
    struct list_count {
        std::uint64_t written = 0;
        std::uint64_t required = 0;
    };
    [[nodiscard]] result<list_count> count(B& device) const {
        list_count sum;
        for (const part& p : parts_) {
            const auto made = read_count(device, p.counts.back());
            if (!made) {
                return failure(made.error());
            }
            sum.written += made->written;
            sum.required += made->required;
        }
        return sum;
    }

    /// The whole surface: the lists' triangles, then the plain ones.
    template <class Mesh>
    [[nodiscard]] result<host_mesh> download(B& device, const Mesh& mesh) const {
        host_mesh all;
        for (const part& p : parts_) {
            const auto made = read_count(device, p.counts.back());
            if (!made) {
                return failure(made.error());
            }
            const auto first = static_cast<std::uint32_t>(all.vertices.size());
            const std::uint32_t count = 3 * made->written;
            if (auto done = append_vertices(device, *p.vertices, count, all); !done) {
                return failure(done.error());
            }
            for (std::uint32_t i = 0; i < count; ++i) {
                all.indices.push_back(first + i);
            }
        }
        for (const plain_part& p : plain_) {
            const auto first = static_cast<std::uint32_t>(all.vertices.size());
            const buffer& vertices = mesh.parts()[p.of].vertices;
            const std::uint64_t count = vertices.size_bytes() / sizeof(surface_vertex);
            if (auto done = append_vertices(device, vertices, count, all); !done) {
                return failure(done.error());
            }
            const auto indices = indices_of(device, geometry(mesh, p));
            if (!indices) {
                return failure(indices.error());
            }
            for (const std::uint32_t index : *indices) {
                all.indices.push_back(first + index);
            }
        }
        return all;
    }

  private:
    bark_mesh(const bark_options& options, const bark_texture& texture) : options_(options) {
        kernel_.width = texture.width;
        kernel_.height = texture.height;
        kernel_.repeats_around = static_cast<float>(options.repeats_around);
        kernel_.repeats_along = options.repeats_per_metre;
        kernel_.relief = options.relief;
        kernel_.threshold = options.threshold;
        kernel_.steepest = options.steepest;
        kernel_.rounding = options.rounding;
    }

    [[nodiscard]] static result<void> check(const bark_options& options) {
        const auto within = [](const char* what, float value, float least, float most) {
            return value >= least && value <= most
                       ? result<void>{}
                       : fail(error_code::bad_input, std::string("Bark cannot have a ") + what +
                                                         " of " + std::to_string(value) +
                                                         "; it takes " + std::to_string(least) +
                                                         " to " + std::to_string(most) + ".");
        };
        for (const result<void>& valid :
             {within("threshold", options.threshold, 1e-6f, 1e6f),
              within("relief", options.relief, -1e3f, 1e3f),
              within("number of repeats around", static_cast<float>(options.repeats_around), 1,
                     1024),
              within("number of repeats a metre", options.repeats_per_metre, 1e-4f, 1e4f),
              within("steepest rise", options.steepest, 0, 0.5f),
              within("rounding", options.rounding, 0, 1),
              within("number of passes", static_cast<float>(options.most_passes), 1, 12),
              within("stretch", options.stretch, 1, 1e3f),
              within("narrowest part of the threshold", options.narrowest, 0, 0.75f),
              within("thickness of full relief", options.thickness, 0, 1e3f),
              within("reserve", options.reserve, 0, 1e2f)}) {
            if (!valid) {
                return valid;
            }
        }
        return {};
    }

    [[nodiscard]] static result<void> check(const bark_texture& texture) {
        const std::uint64_t texels = std::uint64_t{texture.width} * texture.height;
        const std::string size =
            std::to_string(texture.width) + " x " + std::to_string(texture.height);
        // Texel numbers are 32 bits wide, and exact as floats along each side.
        constexpr std::uint32_t longest = 32768;
        if (texels == 0 || texels != texture.heights.size() || texture.width > longest ||
            texture.height > longest) {
            return fail(error_code::bad_input,
                        std::string("A bark texture of ")
                            .append(size)
                            .append(" texels with ")
                            .append(std::to_string(texture.heights.size()))
                            .append(" heights isn't possible; sides are 1 to 32768."));
        }
        for (const float h : texture.heights) {
            if (!std::isfinite(h)) {
                return fail(error_code::bad_input, std::string("A height of the bark texture of ")
                                                       .append(size)
                                                       .append(" texels is not a number."));
            }
        }
        return {};
    }

    template <class Mesh>
    [[nodiscard]] result<void> build(B& device, const Mesh& mesh, const bark_texture& texture) {
        auto heights = make_buffer<B, float>(device, texture.heights);
        if (!heights) {
            return failure(heights.error());
        }
        heights_ = std::move(*heights);
        for (std::uint32_t i = 0; i < mesh.parts().size(); ++i) {
            const auto& p = mesh.parts()[i];
            const draw_geometry<B> g = mesh.geometry(p);
            result<void> done;
            if (is_cap(p)) {
                plain_.push_back({i, {}, g.count / 3});
            } else if (g.indices && !g.length) {
                done = sort_out(device, mesh, i, g);
            } else {
                part whole;
                whole.of = i;
                whole.relief = options_.relief;
                whole.elements = g.count / 3;
                done = fit(device, mesh, std::move(whole));
            }
            if (!done) {
                return done;
            }
        }
        return {};
    }

    template <class Part>
    [[nodiscard]] static bool is_cap(const Part& p) {
        if constexpr (requires { p.caps; }) {
            return p.caps;
        } else {
            return false;
        }
    }

    /// Divides a part's triangles into those that may be refined and those that stay.
    template <class Mesh>
    [[nodiscard]] result<void> sort_out(B& device, const Mesh& mesh, std::uint32_t of,
                                        const draw_geometry<B>& g) {
        const buffer& vertices = mesh.parts()[of].vertices;
        host_mesh rest;
        if (auto done = append_vertices(device, vertices,
                                        vertices.size_bytes() / sizeof(surface_vertex), rest);
            !done) {
            return done;
        }
        const auto indices = indices_of(device, g);
        if (!indices) {
            return failure(indices.error());
        }
        const std::vector<std::uint8_t> refine =
            detail::triangles_to_refine(rest.vertices, *indices, options_);
        std::array<std::vector<std::uint32_t>, 8> large; // by halvings
        std::vector<std::uint32_t> whole;
        for (std::size_t k = 0; k < 3 * refine.size(); ++k) {
            const std::uint8_t halvings = refine[k / 3];
            (halvings == detail::not_refined ? whole : large[halvings])
                .push_back((*indices)[k] - g.base_vertex);
        }
        if (whole.size() == indices->size()) {
            plain_.push_back({of, {}, g.count / 3});
            return {};
        }
        if (!whole.empty()) {
            auto made = make_buffer<B, std::uint32_t>(device, whole);
            if (!made) {
                return failure(made.error());
            }
            plain_.push_back({of, std::move(*made), static_cast<std::uint32_t>(whole.size() / 3)});
        }
        float relief = options_.relief;
        for (const std::vector<std::uint32_t>& some : large) {
            if (!some.empty()) {
                auto made = make_buffer<B, std::uint32_t>(device, some);
                if (!made) {
                    return failure(made.error());
                }
                part refined;
                refined.of = of;
                refined.elements = static_cast<std::uint32_t>(some.size() / 3);
                refined.relief = relief;
                refined.indices = std::move(*made);
                if (auto done = fit(device, mesh, std::move(refined)); !done) {
                    return done;
                }
            }
            relief *= 0.5f;
        }
        return {};
    }

    /// Most triangles that one list may have.
    [[nodiscard]] static std::uint64_t longest_list(const B& device) {
        const device_limits limits = device.limits();
        return std::min({limits.max_elements, limits.max_buffer_bytes / triangle_bytes,
                         std::uint64_t{0xffffffffu} / 3});
    }

    /// Runs the passes of a part one by one to see how many there are, and makes room for each; or
    /// does so for each half of the part, where a list of the whole would be too long.
    template <class Mesh>
    [[nodiscard]] result<void> fit(B& device, const Mesh& mesh, part p) {
        p.counts.clear();
        p.rooms.clear();
        p.levels.clear();
        p.vertices.reset();
        const std::uint64_t most = longest_list(device);
        std::vector<pass_size> needed;
        bool too_long = p.elements > most;
        if (!too_long) {
            auto counts = probe(device, mesh, p, most);
            if (!counts) {
                return failure(counts.error());
            }
            needed = std::move(*counts);
            too_long = needed.back().triangles > most;
        }
        if (too_long) {
            return fit_halves(device, mesh, std::move(p));
        }
        for (std::size_t pass = 0; pass < needed.size(); ++pass) {
            const double spare = options_.policy == padding::compact ? options_.reserve : 0;
            const auto room = static_cast<std::uint64_t>(
                static_cast<double>(needed[pass].triangles) * (1 + spare));
            p.levels.push_back(needed[pass].levels);
            p.rooms.push_back(static_cast<std::uint32_t>(std::min(room, most)));
            auto count = device.create_buffer(sizeof(count_record));
            if (!count) {
                return failure(count.error());
            }
            p.counts.push_back(std::move(*count));
            const std::uint64_t bytes = p.rooms.back() * triangle_bytes;
            if (pass + 1 == needed.size()) {
                auto made = device.create_buffer(bytes);
                if (!made) {
                    return failure(made.error());
                }
                p.vertices = std::move(*made);
            } else if (auto made = grow(device, scratch_[pass % 2], bytes); !made) {
                return made;
            }
        }
        parts_.push_back(std::move(p));
        return {};
    }

    [[nodiscard]] static result<void> grow(B& device, std::optional<buffer>& to,
                                           std::uint64_t bytes) {
        if (to && to->size_bytes() >= bytes) {
            return {};
        }
        to.reset();
        auto made = device.create_buffer(bytes);
        if (!made) {
            return failure(made.error());
        }
        to = std::move(*made);
        return {};
    }

    template <class Mesh>
    [[nodiscard]] result<void> fit_halves(B& device, const Mesh& mesh, part p) {
        const draw_geometry<B> g = mesh.geometry(mesh.parts()[p.of]);
        if (p.elements < 2 || (!p.indices && g.length)) {
            return fail(error_code::out_of_memory,
                        "Bark would need a longer list of triangles than the device can bind; use "
                        "a larger threshold or fewer passes.");
        }
        std::vector<std::uint32_t> indices(p.indices ? std::size_t{3} * p.elements : 0);
        if (p.indices) {
            auto read = device.download(*p.indices, 0, writable_bytes_of(indices));
            if (!read) {
                return read;
            }
        }
        const std::uint32_t half = p.elements / 2;
        for (const bool second : {false, true}) {
            part piece;
            piece.of = p.of;
            piece.relief = p.relief;
            piece.first = p.first + (second && !p.indices ? half : 0);
            piece.elements = second ? p.elements - half : half;
            if (p.indices) {
                auto made = make_buffer<B, std::uint32_t>(
                    device,
                    std::span<const std::uint32_t>(indices).subspan(
                        second ? std::size_t{3} * half : 0, std::size_t{3} * piece.elements));
                if (!made) {
                    return failure(made.error());
                }
                piece.indices = std::move(*made);
            }
            if (auto done = fit(device, mesh, std::move(piece)); !done) {
                return done;
            }
        }
        return {};
    }

    /// What a pass splits, and how many triangles there are after it.
    struct pass_size {
        std::uint32_t levels = 1;
        std::uint64_t triangles = 0;
    };

    /// How many levels a pass has, where as many are wanted. Spare triangles of degenerate padding
    /// grow fourfold with each level, so there it is one.
    [[nodiscard]] std::uint32_t levels_a_pass(const B& device) const {
        std::uint32_t levels = 1;
        for (std::uint32_t more = device.limits().amplification / 4;
             more >= 4 && options_.policy == padding::compact; more /= 4) {
            ++levels;
        }
        return std::min(levels, options_.most_passes);
    }

    /// The passes for as many levels as edges need that are a twentieth longer than now; ends early
    /// where one makes more than `most` triangles. Each level is first counted, without a list.
    template <class Mesh>
    [[nodiscard]] result<std::vector<pass_size>> probe(B& device, const Mesh& mesh, const part& p,
                                                       std::uint64_t most) {
        auto elements = length_now(device, mesh, p);
        auto count = device.create_buffer(sizeof(count_record));
        if (!elements || !count) {
            return failure(!elements ? elements.error() : count.error());
        }
        const std::uint32_t at_once = levels_a_pass(device);
        std::vector<pass_size> passes;
        std::optional<buffer> before;
        std::uint32_t levels = 0; // of all passes
        while (true) {
            std::optional<buffer> list;
            const auto required = [&](std::uint32_t of, std::uint64_t room) {
                return probe_pass(device, mesh, p, before, *elements, of, *count, list, room);
            };
            pass_size now{0, *elements};
            bool split = true;
            while (split && now.levels < at_once && levels < options_.most_passes &&
                   now.triangles <= most) {
                const auto made = required(now.levels + 1, 1);
                if (!made) {
                    return failure(made.error());
                }
                split = *made > now.triangles;
                if (split) {
                    now = {now.levels + 1, *made};
                    ++levels;
                }
            }
            if (now.levels != 0 || passes.empty()) {
                const std::uint64_t places =
                    4 * (passes.empty() ? std::uint64_t{p.elements} : passes.back().triangles);
                passes.push_back({std::max(1u, now.levels),
                                  options_.policy == padding::compact ? now.triangles : places});
            }
            if (!split || levels == options_.most_passes || now.triangles > most ||
                passes.back().triangles > most) {
                return passes;
            }
            if (const auto made = required(now.levels, now.triangles); !made) {
                return failure(made.error());
            }
            elements = now.triangles;
            before = std::move(list);
        }
    }

    /// How many triangles a part has before the first pass.
    template <class Mesh>
    [[nodiscard]] static result<std::uint64_t> length_now(B& device, const Mesh& mesh,
                                                          const part& p) {
        const draw_geometry<B> g = mesh.geometry(mesh.parts()[p.of]);
        if (p.indices || !g.length) {
            return std::uint64_t{p.elements};
        }
        const auto length = read_count(device, *g.length.buffer, g.length.offset);
        if (!length) {
            return failure(length.error());
        }
        return std::uint64_t{std::min(p.elements, length->written)};
    }

    /// How many triangles a pass makes, and into `list` those for which there is room: from the
    /// list `before`, or the mesh.
    template <class Mesh>
    [[nodiscard]] result<std::uint64_t>
    probe_pass(B& device, const Mesh& mesh, const part& p, const std::optional<buffer>& before,
               std::uint64_t elements, std::uint32_t levels, const buffer& count,
               std::optional<buffer>& list, std::uint64_t room) const {
        kernels::bark kernel = kernel_;
        kernel.relief = p.relief;
        kernel.threshold *= 1 / 1.05f;
        kernel.levels = levels;
        if (auto grown = grow(device, list, room * triangle_bytes); !grown) {
            return failure(grown.error());
        }
        const triangle_list<B> out{view<B>(*list), view<B>(count), padding::compact};
        auto done = run(device, [&](recorder& r) {
            if (!before) {
                record_first(r, mesh, p, kernel, out);
            } else {
                r.expand(kernel, later_bindings(*before),
                         range{0, static_cast<std::uint32_t>(elements)}, out);
            }
        });
        if (!done) {
            return failure(done.error());
        }
        const auto made = read_count(device, count);
        return made ? result<std::uint64_t>(made->required) : failure(made.error());
    }

    template <class Mesh>
    void record_first(recorder& to, const Mesh& mesh, const part& p, kernels::bark kernel,
                      const triangle_list<B>& out) const {
        const auto& whole = mesh.parts()[p.of];
        const draw_geometry<B> g = mesh.geometry(whole);
        bindings<B, kernels::bark> bound{view<B>(whole.vertices), view<B>(*heights_),
                                         view<B>(*heights_)};
        std::uint32_t first = p.first;
        kernel.base_vertex = g.base_vertex;
        if (p.indices) {
            kernel.indexed = 1;
            bound[1] = view<B>(*p.indices);
        } else if (g.indices) {
            kernel.indexed = 1;
            bound[1] = g.indices;
            first += g.first / 3;
        } else {
            first += (g.first + g.base_vertex) / 3;
        }
        if (!p.indices && g.length) {
            to.expand(kernel, bound, counted<B>{g.length, p.elements}, out);
        } else {
            to.expand(kernel, bound, range{first, p.elements}, out);
        }
    }

    [[nodiscard]] bindings<B, kernels::bark> later_bindings(const buffer& triangles) const {
        return {view<B>(triangles), view<B>(*heights_), view<B>(*heights_)};
    }

    [[nodiscard]] static result<count_record> read_count(B& device, const buffer& count,
                                                         std::uint64_t offset = 0) {
        count_record made;
        auto done = device.download(count, offset, writable_bytes_of_one(made));
        return done ? result<count_record>(made) : result<count_record>(failure(done.error()));
    }

    [[nodiscard]] static result<bool> was_short(B& device, const part& p) {
        for (const buffer& count : p.counts) {
            const auto made = read_count(device, count);
            if (!made) {
                return failure(made.error());
            }
            if (made->required > made->written) {
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] static result<void> append_vertices(B& device, const buffer& from,
                                                      std::uint64_t count, host_mesh& to) {
        const std::size_t first = to.vertices.size();
        to.vertices.resize(first + count);
        return device.download(from, 0, writable_bytes_of(to.vertices, first));
    }

    /// The vertices that a geometry draws, three a triangle.
    [[nodiscard]] static result<std::vector<std::uint32_t>> indices_of(B& device,
                                                                       const draw_geometry<B>& g) {
        std::vector<std::uint32_t> indices(g.count);
        for (std::uint32_t i = 0; i < g.count; ++i) {
            indices[i] = g.first + i;
        }
        if (g.indices) {
            auto done = device.download(*g.indices.buffer,
                                        g.indices.offset + sizeof(std::uint32_t) * g.first,
                                        writable_bytes_of(indices));
            if (!done) {
                return failure(done.error());
            }
        }
        for (std::uint32_t& index : indices) {
            index += g.base_vertex;
        }
        return indices;
    }

    static constexpr std::uint64_t triangle_bytes = 3 * sizeof(surface_vertex);

    bark_options options_;
    kernels::bark kernel_;
    std::optional<buffer> heights_; // there after create
    std::optional<buffer> scratch_[2];
    std::vector<part> parts_;
    std::vector<plain_part> plain_;
};

} // namespace skybark::trees
