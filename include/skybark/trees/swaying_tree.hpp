#pragma once
// A tree, or a stand of them, alive: skeleton and wind in; branches, bark and leaves out, every
// frame, on a device.
//
//     auto leaves = trees::place_leaves(skeleton, trees::leaves_of(species));
//     auto air = trees::wind_field<B>::create(device, trees::segment_middles(skeleton),
//                                             trees::kaimal_gusts{.speed = 8});
//     auto tree = trees::swaying_tree<B>::create(device, skeleton, leaves, bark, {});
//     run(device, [&](auto& recorder) {
//         tree->advance(recorder, *air, seconds, 1.0f / 60);
//         tree->mesh(recorder);
//     });
//     tree->for_each_wood([&](auto vertices, auto geometry) { … draw … });
//     tree->for_each_leaf([&](auto vertices, auto geometry) { … draw … });
//
// It puts together what stands beside it and can be had alone: sway.hpp, wind.hpp, closed_mesh.hpp
// (or branch_mesh.hpp, or detail.hpp), bark_mesh.hpp, leaf_mesh.hpp.
// Source: Akagi and Kitajima, figure 6, with the sway on the device as well.

#include <skybark/core/when_used.hpp>
#include <skybark/trees/bark_mesh.hpp>
#include <skybark/trees/closed_mesh.hpp>
#include <skybark/trees/detail.hpp>
#include <skybark/trees/leaf_layout.hpp>
#include <skybark/trees/leaf_mesh.hpp>
#include <skybark/trees/sway.hpp>
#include <skybark/trees/view_detail.hpp>
#include <skybark/trees/wind.hpp>

namespace skybark::trees {

/// What a swaying tree is made of. `Mesh` is a closed_mesh, branch_mesh or detailed_branch_mesh.
template <class MeshOptions>
struct swaying_tree_options {
    MeshOptions branches;
    std::optional<bark_options> bark; ///< none: branches as they are meshed
    leaf_mesh_options leaves;
    float leaf_cover = 0.6f;    ///< part of a blade's octagon that its picture fills
    double leaf_area_index = 4; ///< m² of leaves over a m² of ground that count at most
    sway_options sway;
    drag_options drag;
    view_detail view; ///< from where it is looked at first; bark makes room for what is seen then
};

namespace detail {
template <class Mesh>
struct options_of;
template <backend B>
struct options_of<branch_mesh<B>> {
    using type = branch_mesh_options;
};
template <backend B>
struct options_of<closed_mesh<B>> {
    using type = closed_mesh_options;
};
template <backend B>
struct options_of<detailed_branch_mesh<B>> {
    using type = detailed_mesh_options;
};
} // namespace detail

namespace detail {

/// The crown of each tree: the box around its leaves, and their area.
template <class = when_used>
class crowns {
  public:
    crowns(const skeleton& of, std::span<const leaf> leaves, const std::vector<float>& area)
        : root_(of.size()), crown_(of.size()) {
        for (std::uint32_t i = 0; i < of.size(); ++i) {
            root_[i] = of.parent[i] == none ? i : root_[of.parent[i]];
            crown_[root_[i]].area += static_cast<double>(area[i]);
        }
        for (const leaf& l : leaves) {
            if (l.carrier < of.size()) {
                crown& c = crown_[root_[l.carrier]];
                c.low = glm::min(c.low, l.position);
                c.high = glm::max(c.high, l.position);
            }
        }
    }

    /// Scales a segment's area by `factor(area of all leaves, size of the box)` of its tree.
    template <class Factor>
    void scale(std::vector<float>& area, Factor&& factor) const {
        for (std::size_t i = 0; i < area.size(); ++i) {
            const crown& c = crown_[root_[i]];
            if (c.area > 0) {
                const glm::dvec3 size = glm::max(glm::dvec3(c.high) - glm::dvec3(c.low), 0.01);
                area[i] *= static_cast<float>(factor(c.area, size));
            }
        }
    }

  private:
    struct crown {
        glm::vec3 low{std::numeric_limits<float>::max()};
        glm::vec3 high{std::numeric_limits<float>::lowest()};
        double area = 0;
    };
    std::vector<std::uint32_t> root_;
    std::vector<crown> crown_; // of the roots
};

inline constexpr double ellipse = 0.78539816339744831; // of its box

} // namespace detail

/// The area of the leaves of each tree by its crown, m² on each segment, scaled in place.
///
/// Pictures have fewer and larger leaves than trees, one for several: where they come to more than
/// `most_index` m² for each m² of ground below the crown, they count for that much (a leaf area
/// index of 3 to 6 is that of broad-leaved crowns: Asner, Scurlock and Hicke 2003).
template <class = when_used>
void limit_leaf_area(const skeleton& of, std::span<const leaf> leaves, double most_index,
                     std::vector<float>& area) {
    detail::crowns<>(of, leaves, area).scale(area, [&](double all, const glm::dvec3& size) {
        return std::min(1.0, most_index * detail::ellipse * size.x * size.z / all);
    });
}

/// What of it the wind finds: leaves stand in each other's lee. By Beer and Lambert's law, as Monsi
/// and Saeki (1953) have it for light: of leaves of area A whose crown's outline has area S, as
/// much as S (1 − e^(−k A / S)) / k is in the open, k = ½ for leaves that look everywhere.
template <class = when_used>
void shelter_leaves(const skeleton& of, std::span<const leaf> leaves, std::vector<float>& area) {
    detail::crowns<>(of, leaves, area).scale(area, [&](double all, const glm::dvec3& size) {
        const double outline = detail::ellipse * std::max(size.x, size.z) * size.y;
        const double depth = 0.5 * all / outline;
        return depth > 1e-6 ? -std::expm1(-depth) / depth : 1.0;
    });
}

/// The skeleton with radii that can carry it: descriptions let boughs and twigs end in a point, or
/// thinner than a hair where they grow near one, and such a twig with leaves on it hangs and swings
/// as no twig does. A branch that goes on for l m to its farthest tip is made `tip` + l / `slender`
/// m thick at least. Real ones are 50 to 150 times as long as thick (McMahon and Kronauer 1976), so
/// that only what is out of all proportion changes. Lengths and places stay.
template <class = when_used>
[[nodiscard]] skeleton load_bearing(skeleton of, float tip = 0.0015f, float slender = 250) {
    std::vector<float> beyond(of.size(), 0.0f); // from a segment's tip to the farthest one
    for (std::size_t i = of.size(); i-- > 0;) {
        const float from_base = beyond[i] + of.length[i];
        of.radius[i] = std::max(of.radius[i], tip + beyond[i] / slender);
        of.base_radius[i] = std::max(of.base_radius[i], tip + from_base / slender);
        if (of.parent[i] != none) {
            float& parent = beyond[of.parent[i]];
            parent = std::max(parent, from_base);
        }
    }
    return of;
}

/// The tree on backend B.
template <backend B, class Mesh = closed_mesh<B>>
class swaying_tree {
  public:
    using recorder = typename B::recorder;
    using options_type = swaying_tree_options<typename detail::options_of<Mesh>::type>;

    /// Sends everything to the device and makes room. `bark` is not looked at without bark options.
    /// Errors: bad_input where a leaf hangs on no segment or is nowhere or of no size, or where the
    /// leaf area index is no number from 0 up; those of the parts, for which no segments is none.
    [[nodiscard]] static result<swaying_tree> create(B& device, const skeleton& of,
                                                     std::span<const leaf> leaves,
                                                     const bark_texture& bark,
                                                     const options_type& options) {
        if (auto valid = check(of, leaves, options); !valid) {
            return failure(valid.error());
        }
        auto mesh = Mesh::create(device, of, options.branches);
        if (!mesh) {
            return failure(mesh.error());
        }
        return create(device, of, std::move(*mesh), leaves, bark, options);
    }

    /// The same with branches that have been created; of the options theirs are not looked at.
    [[nodiscard]] static result<swaying_tree> create(B& device, const skeleton& of, Mesh mesh,
                                                     std::span<const leaf> leaves,
                                                     const bark_texture& bark,
                                                     const options_type& options) {
        if (auto valid = check(of, leaves, options); !valid) {
            return failure(valid.error());
        }
        auto blades = leaf_mesh<B>::create(device, leaves, options.leaves);
        if (!blades) {
            return failure(blades.error());
        }
        std::vector<float> area = leaf_area(leaves, of.size(), options.leaf_cover);
        limit_leaf_area(of, leaves, options.leaf_area_index, area);
        std::vector<float> mass(area);
        std::transform(mass.begin(), mass.end(), mass.begin(),
                       [](float each) { return fresh_leaf_mass * each; });
        shelter_leaves(of, leaves, area);
        auto moving = trees::sway<B>::create(device, load_bearing(of), options.sway, mass);
        if (!moving) {
            return failure(moving.error());
        }
        auto loads = wind_loads<B>::create(device, of, area, options.drag);
        if (!loads) {
            return failure(loads.error());
        }
        swaying_tree made(std::move(mesh), std::move(*blades), std::move(*moving),
                          std::move(*loads));
        made.view_ = options.view;
        if (options.bark) {
            if (auto done = made.make_bark(device, *options.bark, bark); !done) {
                return failure(done.error());
            }
        }
        return made;
    }

    /// Appends one step of the sway to `time`, in s, `step` s after the last one. Allocates
    /// nothing.
    template <class Wind>
    requires wind<Wind, B>
    void advance(recorder& to, Wind& blowing, double time, float step) {
        blowing.record(to, time);
        loads_.record(to, sway_.poses(), blowing.air());
        sway_.record(to, loads_.loads(), step);
        air_ = blowing.air();
        time_ = time;
    }

    /// Appends the making of all triangles where the sway has carried them. Allocates nothing.
    void mesh(recorder& to) const {
        record_branches(to);
        if (bark_) {
            bark_->record(to, mesh_);
        }
        leaves_.record(to, leaf_motion<B>{sway_.poses(), air_, time_}, view_);
    }

    /// From where it is looked at from the next `mesh` on: leaves, and branches that are a
    /// detailed_branch_mesh, are thinned out with distance.
    void look_from(const view_detail& view) { view_ = view; }

    /// Makes more room for bark, for leaves, or for branches that are a detailed_branch_mesh, where
    /// the last frame had too little: true if it did.
    [[nodiscard]] result<bool> update(B& device) {
        const auto more_leaves = leaves_.grow(device);
        if (!more_leaves) {
            return more_leaves;
        }
        bool grown = *more_leaves;
        if constexpr (requires { mesh_.grow(device); }) {
            const auto more = mesh_.grow(device);
            if (!more) {
                return more;
            }
            grown = grown || *more;
        }
        if (!bark_) {
            return grown;
        }
        const auto more = bark_->update(device, mesh_);
        return more ? result<bool>(grown || *more) : more;
    }

    /// Calls `draw(vertices, geometry)` for all of the wood: a view of surface_vertex, and which.
    template <class Draw>
    void for_each_wood(Draw&& draw) const {
        if (bark_) {
            bark_->for_each_draw(mesh_, draw);
            return;
        }
        for (const auto& p : mesh_.parts()) {
            draw(view<B>(p.vertices), mesh_.geometry(p));
        }
    }
    template <class Draw>
    void for_each_leaf(Draw&& draw) const {
        for (const auto& p : leaves_.parts()) {
            draw(view<B>(p.vertices), leaves_.geometry(p));
        }
    }

    [[nodiscard]] const Mesh& branches() const { return mesh_; }
    [[nodiscard]] const bark_mesh<B>* bark() const { return bark_ ? &*bark_ : nullptr; }
    [[nodiscard]] const leaf_mesh<B>& leaves() const { return leaves_; }
    [[nodiscard]] const trees::sway<B>& motion() const { return sway_; }
    [[nodiscard]] trees::sway<B>& motion() { return sway_; }

    /// Triangles of the last frame: waits for the device where it alone knows how many.
    [[nodiscard]] result<std::uint64_t> triangles(B& device) const {
        std::uint64_t sum = 0;
        for (const auto& p : leaves_.parts()) {
            count_record made{p.triangles, p.triangles};
            if (leaves_.options().form == mesh_form::list) {
                auto done = read_back<B, count_record>(device, p.count, {&made, 1});
                if (!done) {
                    return failure(done.error());
                }
            }
            sum += made.written;
        }
        if (!bark_) {
            if constexpr (requires { mesh_.made(device); }) {
                const auto made = mesh_.made(device);
                return made ? result<std::uint64_t>(sum + made->written) : failure(made.error());
            } else {
                return sum + mesh_.triangles();
            }
        }
        const auto refined = bark_->count(device);
        if (!refined) {
            return failure(refined.error());
        }
        for (const auto& p : bark_->plain_parts()) {
            sum += p.triangles;
        }
        return sum + refined->written;
    }

  private:
    swaying_tree(Mesh mesh, leaf_mesh<B> leaves, trees::sway<B> moving, wind_loads<B> loads)
        : mesh_(std::move(mesh)), leaves_(std::move(leaves)), sway_(std::move(moving)),
          loads_(std::move(loads)) {}

    /// A kernel takes a leaf's carrier at its word.
    [[nodiscard]] static result<void> check(const skeleton& of, std::span<const leaf> leaves,
                                            const options_type& options) {
        if (!(options.leaf_area_index >= 0)) {
            return fail(error_code::bad_input, "The leaf area index is not a number from 0 up.");
        }
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const leaf& l = leaves[i];
            if (l.carrier >= of.size()) {
                return fail(error_code::bad_input, std::string("Leaf ")
                                                       .append(std::to_string(i))
                                                       .append(" hangs on segment ")
                                                       .append(std::to_string(l.carrier))
                                                       .append("; the number of segments is ")
                                                       .append(std::to_string(of.size()))
                                                       .append("."));
            }
            const glm::vec4& q = l.orientation;
            const float sum =
                l.position.x + l.position.y + l.position.z + l.fold + (q.x + q.y) + (q.z + q.w);
            if (!std::isfinite(sum) || !(l.width >= 0 && l.width < 1e6f) ||
                !(l.length >= 0 && l.length < 1e6f)) {
                return fail(error_code::bad_input,
                            std::string("Leaf ")
                                .append(std::to_string(i))
                                .append(" has a place, a turn or a size that is not a number, or "
                                        "less than nothing."));
            }
        }
        return {};
    }

    void record_branches(recorder& to) const {
        if constexpr (requires { mesh_.record(to, sway_.poses(), view_); }) {
            mesh_.record(to, sway_.poses(), view_);
        } else {
            mesh_.record(to, sway_.poses());
        }
    }

    [[nodiscard]] result<void> make_bark(B& device, const bark_options& options,
                                         const bark_texture& texture) {
        if (auto done = run(device, [&](recorder& r) { record_branches(r); }); !done) {
            return done;
        }
        auto made = bark_mesh<B>::create(device, mesh_, options, texture);
        if (!made) {
            return failure(made.error());
        }
        bark_ = std::move(*made);
        return {};
    }

    Mesh mesh_;
    std::optional<bark_mesh<B>> bark_;
    leaf_mesh<B> leaves_;
    trees::sway<B> sway_;
    wind_loads<B> loads_;
    buffer_view<B> air_;
    double time_ = 0;
    view_detail view_;
};

} // namespace skybark::trees
