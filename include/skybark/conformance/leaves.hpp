#pragma once
// Cases: the kernel that makes leaves, against a double-precision reference of its own.
//
// Tolerances: positions 1e-5 of the scene's size (10 m), directions and texture coordinates 1e-5
// where 1 is whole.

#include <skybark/conformance/context.hpp>
#include <skybark/conformance/leaf_reference.hpp>

namespace skybark::conformance {

struct leaf_input {
    std::vector<leaf> leaves;
    std::vector<segment_pose> poses;
    std::vector<glm::vec4> air;
};

/// Leaves of all folds and turns on a dozen segments that have moved, in calm and in wind.
template <backend B>
[[nodiscard]] leaf_input random_leaves(context<B>& c, std::uint32_t count) {
    constexpr std::uint32_t carriers = 12;
    const auto unit = [&] { return c.below(20001) / 10000.0 - 1; };
    const auto place = [&](double size) { return glm::dvec3(unit(), unit(), unit()) * size; };
    const auto turn = [&] {
        const glm::dvec4 q(unit(), unit(), unit(), 0.1 + std::fabs(unit()));
        return glm::vec4(q / std::sqrt(glm::dot(q, q)));
    };
    leaf_input in;
    for (std::uint32_t i = 0; i < carriers; ++i) {
        segment_pose pose;
        pose.rotation = turn();
        pose.base = glm::vec3(place(4));
        pose.shift = glm::vec3(place(1));
        in.poses.push_back(pose);
        const glm::dvec3 wind = place(i % 3 == 0 ? 0 : 12);
        in.air.emplace_back(glm::vec3(wind), static_cast<float>(std::sqrt(glm::dot(wind, wind))));
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        leaf l;
        l.position = glm::vec3(place(4));
        l.length = static_cast<float>(0.1 + 0.09 * unit());
        l.width = static_cast<float>(l.length * (0.6 + 0.4 * unit()));
        l.orientation = turn();
        l.fold = i % 5 == 0 ? 0.0f : static_cast<float>(1.5 * unit());
        l.carrier = c.below(carriers);
        l.seed = static_cast<std::uint32_t>(c.random());
        in.leaves.push_back(l);
    }
    return in;
}

/// In full, and from an eye from where some leaves are dropped and some are quadrilaterals.
[[nodiscard]] inline std::array<kernels::leaf_blade, 2> leaf_kernels() {
    kernels::leaf_blade whole;
    whole.time = kernels::flutter_time(12.34);
    kernels::leaf_blade thinned = whole;
    thinned.camera = {0, 0, 20, 700};
    return {whole, thinned};
}

/// The leaves' blades. Where a size or a shape is about to change its number of triangles, rounding
/// decides: such leaves are left out.
[[nodiscard]] inline std::vector<reference::leaf_blade_now> leaves_now(const kernels::leaf_blade& k,
                                                                       leaf_input& in) {
    std::vector<reference::leaf_blade_now> now;
    std::vector<leaf> kept;
    for (const leaf& l : in.leaves) {
        const auto blade = reference::leaf_now(k, l, in.poses[l.carrier], in.air[l.carrier]);
        const bool fades = blade.scale > 0 && blade.scale < 0.05;
        const bool turns = blade.morph > 0.999 && blade.morph < 1;
        if (!fades && !turns) {
            kept.push_back(l);
            now.push_back(blade);
        }
    }
    in.leaves = std::move(kept);
    return now;
}

template <backend B>
class leaf_check {
  public:
    explicit leaf_check(const context<B>& c)
        : positions_(c.compare("coordinates of positions")),
          directions_(c.compare("coordinates of normals and tangents")),
          texture_(c.compare("texture coordinates")) {}

    void vertex(const surface_vertex& actual, const reference::leaf_corner& e) {
        for (int k = 0; k < 3; ++k) {
            positions_.close_to(double{actual.position[k]}, e.position[k], 1e-4);
            directions_.close_to(double{actual.normal[k]}, e.normal[k], 1e-5);
            directions_.close_to(double{actual.tangent[k]}, e.tangent[k], 1e-5);
        }
        directions_.close_to(double{actual.tangent.w}, 1, 0);
        texture_.close_to(double{actual.u}, e.u, 1e-5);
        texture_.close_to(double{actual.v}, e.v, 1e-5);
    }
    void spare(const surface_vertex& actual) {
        const surface_vertex zeros{};
        positions_.same(std::memcmp(&actual, &zeros, sizeof zeros), 0);
    }

  private:
    comparison positions_, directions_, texture_;
};

template <backend B>
struct leaf_buffers {
    guarded<B> leaves, poses, air;

    [[nodiscard]] bindings<B, kernels::leaf_blade> views() const {
        return {leaves.view(), poses.view(), air.view()};
    }
};
template <backend B>
[[nodiscard]] leaf_buffers<B> put_leaves(const context<B>& c, const leaf_input& in) {
    return {c.put(in.leaves), c.put(in.poses), c.put(in.air)};
}

template <backend B>
void leaf_rings(context<B>& c, std::uint32_t leaves) {
    for (const kernels::leaf_blade& kernel : leaf_kernels()) {
        leaf_input in = random_leaves(c, leaves);
        const auto expected = leaves_now(kernel, in);
        const auto buffers = put_leaves(c, in);
        const auto count = static_cast<std::uint32_t>(in.leaves.size());
        const auto out = c.template room<surface_vertex>(std::uint64_t{10} * count);
        c.run([&](auto& r) {
            r.expand_rings(kernel, buffers.views(), range{0, count}, out.view());
        });
        const auto actual = c.template get<surface_vertex>(out);
        leaf_check check(c);
        for (std::size_t i = 0; i < actual.size(); ++i) {
            check.vertex(actual[i], expected[i / 10].corners[i % 10]);
        }
    }
}

/// The corners of a blade's triangles: three a half, or one of a quadrilateral, or none.
[[nodiscard]] inline std::vector<std::size_t>
leaf_triangle_corners(const reference::leaf_blade_now& blade, std::size_t half) {
    if (!(blade.scale > 0)) {
        return {};
    }
    if (blade.morph < 1) {
        return half == 0 ? std::vector<std::size_t>{0, 1, 4, 4, 1, 2, 4, 2, 3}
                         : std::vector<std::size_t>{9, 8, 5, 5, 8, 7, 5, 7, 6};
    }
    return half == 0 ? std::vector<std::size_t>{0, 2, 4} : std::vector<std::size_t>{9, 7, 5};
}

template <backend B>
void leaf_list(context<B>& c, std::uint32_t leaves, padding policy) {
    for (const kernels::leaf_blade& kernel : leaf_kernels()) {
        leaf_input in = random_leaves(c, leaves);
        const auto expected = leaves_now(kernel, in);
        const auto count = static_cast<std::uint32_t>(in.leaves.size());
        std::uint64_t triangles = 0;
        for (const auto& blade : expected) {
            for (const std::size_t half : {0u, 1u}) {
                triangles += policy == padding::degenerate
                                 ? 3
                                 : leaf_triangle_corners(blade, half).size() / 3;
            }
        }
        const auto buffers = put_leaves(c, in);
        const auto out = c.template room<surface_vertex>(3 * triangles);
        const auto written = c.template room<count_record>(1);
        c.run([&](auto& r) {
            r.expand(kernel, buffers.views(), range{0, count},
                     triangle_list<B>{out.view(), written.view(), policy});
        });
        c.expect_count(written, triangles, triangles);
        const auto actual = c.template get<surface_vertex>(out);
        leaf_check check(c);
        std::size_t at = 0;
        for (const auto& blade : expected) {
            for (const std::size_t half : {0u, 1u}) {
                const auto corners = leaf_triangle_corners(blade, half);
                for (const std::size_t corner : corners) {
                    check.vertex(actual.at(at++), blade.corners[corner]);
                }
                for (std::size_t k = corners.size(); policy == padding::degenerate && k < 9; ++k) {
                    check.spare(actual.at(at++));
                }
            }
        }
    }
}

/// A list that has room for all but the last triangles is filled in order.
template <backend B>
void leaf_list_too_short(context<B>& c) {
    leaf_input in = random_leaves(c, 70);
    const kernels::leaf_blade kernel = leaf_kernels()[0];
    const auto expected = leaves_now(kernel, in);
    const auto count = static_cast<std::uint32_t>(in.leaves.size());
    const auto buffers = put_leaves(c, in);
    const std::uint64_t room = 6ull * count - 8; // ends within a leaf's first strip
    const auto out = c.template room<surface_vertex>(3 * room);
    const auto written = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(kernel, buffers.views(), range{0, count},
                 triangle_list<B>{out.view(), written.view(), padding::compact});
    });
    c.expect_count(written, room, 6ull * count);
    const auto actual = c.template get<surface_vertex>(out);
    leaf_check check(c);
    for (std::size_t i = 0; i < actual.size(); ++i) {
        const auto& blade = expected[i / 18];
        check.vertex(actual[i], blade.corners[leaf_triangle_corners(blade, i / 9 % 2)[i % 9]]);
    }
}

/// One pose and one wind for all: steps of zero.
template <backend B>
void leaves_carried_by_one(context<B>& c) {
    leaf_input in = random_leaves(c, 65);
    kernels::leaf_blade kernel = leaf_kernels()[0];
    kernel.pose_step = kernel.air_step = 0;
    in.poses.resize(1);
    in.air = {{3, 0, 4, 5}};
    const auto buffers = put_leaves(c, in);
    const auto out = c.template room<surface_vertex>(650);
    c.run([&](auto& r) { r.expand_rings(kernel, buffers.views(), range{0, 65}, out.view()); });
    const auto actual = c.template get<surface_vertex>(out);
    leaf_check check(c);
    for (std::size_t i = 0; i < 65; ++i) {
        const auto blade = reference::leaf_now(kernel, in.leaves[i], in.poses[0], in.air[0]);
        for (std::size_t k = 0; k < 10; ++k) {
            check.vertex(actual[10 * i + k], blade.corners[k]);
        }
    }
}

/// No size, no wind speed to divide by, an eye in the stalk: finite everywhere.
template <backend B>
void leaf_degenerate(context<B>& c) {
    leaf_input in = random_leaves(c, 4);
    in.leaves[0].length = in.leaves[0].width = 0;
    in.leaves[1].position = {0, 0, 20};
    in.leaves[2].fold = 100;
    kernels::leaf_blade kernel = leaf_kernels()[1];
    kernel.pose_step = kernel.air_step = 0;
    in.poses = {segment_pose{}};
    in.air = {{0, 0, 0, 0}};
    const auto buffers = put_leaves(c, in);
    const auto out = c.template room<surface_vertex>(40);
    c.run([&](auto& r) { r.expand_rings(kernel, buffers.views(), range{0, 4}, out.view()); });
    comparison check = c.compare("coordinates that are finite");
    for (const surface_vertex& v : c.template get<surface_vertex>(out)) {
        for (int k = 0; k < 3; ++k) {
            check.within(double{v.position[k]}, -1e3, 1e3);
            check.within(double{v.normal[k]}, -1.01, 1.01);
            check.within(double{v.tangent[k]}, -1.01, 1.01);
        }
    }
}

template <backend B>
void add_leaf_cases(cases<B>& to) {
    using C = context<B>;
    const auto add = [&](std::string name, std::function<void(C&)> body) {
        to.push_back({"leaf", std::move(name), std::move(body)});
    };
    if constexpr (expands_rings<B, kernels::leaf_blade>) {
        add("rings", [](C& c) { leaf_rings(c, 300); });
        add("rings_empty", [](C& c) { leaf_rings(c, 0); });
        add("carried_by_one", leaves_carried_by_one<B>);
        add("degenerate", leaf_degenerate<B>);
    }
    if constexpr (expands<B, kernels::leaf_blade>) {
        add("list_compact", [](C& c) { leaf_list(c, 300, padding::compact); });
        add("list_degenerate", [](C& c) { leaf_list(c, 300, padding::degenerate); });
        add("list_too_short", leaf_list_too_short<B>);
    }
}

} // namespace skybark::conformance
