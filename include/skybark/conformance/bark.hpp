#pragma once
// Cases: bark, the kernel that splits triangles, on flat triangles where its points have a closed
// form.
//
// Tolerances: 1e-6 m on triangles of 2 m, a few roundings.

#include <skybark/conformance/context.hpp>
#include <skybark/kernels/bark.hpp>

#include <glm/geometric.hpp>

namespace skybark::conformance {

/// Flat triangles (0, 0), (x, 0), (0, y) one behind the other in z, with u = x and v = y.
struct bark_input {
    std::vector<surface_vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<float> heights{0, 1};
    std::vector<glm::dvec2> sides;

    /// `textured`: whether the corners have a texture direction.
    void add(double x, double y, bool textured = true) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        const auto z = static_cast<float>(sides.size());
        for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(x, 0), glm::dvec2(0, y)}) {
            surface_vertex v;
            v.position = {static_cast<float>(at.x), static_cast<float>(at.y), z};
            v.normal = {0, 0, 1};
            v.u = v.position.x;
            v.v = v.position.y;
            v.tangent = {1, 0, 0, textured ? 1 : 0};
            vertices.push_back(v);
        }
        indices.insert(indices.end(), {first, first + 1, first + 2});
        sides.emplace_back(x, y);
    }
};

/// Two texels around, so that the height at u is a saw: 0 at 0.25, 1 at 0.75, straight between.
[[nodiscard]] inline kernels::bark bark_kernel() {
    kernels::bark k;
    k.indexed = 1;
    k.width = 2;
    k.height = 1;
    k.relief = 0.125f;
    k.threshold = 1;
    k.steepest = 0.5f;
    return k;
}
[[nodiscard]] inline double saw(double u) {
    const double part = u + 0.25 - std::floor(u + 0.25); // 0.5 at the lowest
    return std::fabs(1 - 2 * part);
}

template <backend B>
[[nodiscard]] std::vector<surface_vertex> bark_list(const context<B>& c, const bark_input& in,
                                                    const kernels::bark& kernel, padding policy,
                                                    std::uint64_t room, std::uint64_t required) {
    const auto vertices = c.put(in.vertices);
    const auto indices = c.put(in.indices);
    const auto heights = c.put(in.heights);
    const auto out = c.template room<surface_vertex>(3 * room);
    const auto count = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(kernel, {vertices.view(), indices.view(), heights.view()},
                 range{0, static_cast<std::uint32_t>(in.indices.size() / 3)},
                 triangle_list<B>{out.view(), count.view(), policy});
    });
    c.expect_count(count, std::min(room, required), required);
    return c.template get<surface_vertex>(out);
}

/// One to four pieces, in order, with their areas; corners and midpoints where they should be.
template <backend B>
void bark_patterns(context<B>& c, padding policy) {
    bark_input in;
    in.add(0.5, 0.5);          // nothing is longer than 1
    in.add(0.8, 0.8);          // the long side only
    in.add(1.5, 0.75);         // the long side and x
    in.add(0.75, 1.5);         // the long side and y
    in.add(1.75, 1.25);        // all
    in.add(1.25, 1.75, false); // all, without a texture direction
    const std::uint32_t pieces[] = {1, 2, 3, 3, 4, 4};
    const bool spare = policy == padding::degenerate;
    const std::uint64_t triangles = spare ? 4 * 6 : 1 + 2 + 3 + 3 + 4 + 4;
    const auto list = bark_list(c, in, bark_kernel(), policy, triangles, triangles);
    comparison heights = c.compare("how far points stand out");
    comparison areas = c.compare("areas of pieces");
    comparison zeros = c.compare("coordinates of spare triangles");
    std::size_t at = 0;
    for (std::size_t i = 0; i < in.sides.size(); ++i) {
        const double x = in.sides[i].x;
        const double y = in.sides[i].y;
        double area = 0;
        for (std::uint32_t piece = 0; piece < pieces[i]; ++piece) {
            for (int k = 0; k < 3; ++k) {
                const surface_vertex& v = list[at + static_cast<std::size_t>(k)];
                const double u = double{v.u};
                // On an edge's middle both coordinates are halves of the sides, or 0.
                const bool corner = (u == 0 || u == double(static_cast<float>(x))) &&
                                    (v.v == 0 || v.v == static_cast<float>(y));
                const bool along_y = u == 0;
                const double from = along_y ? saw(0) : saw(x);
                double rise = corner ? 0 : saw(u) - (saw(0) + from) / 2;
                rise = in.vertices[3 * i].tangent.w == 0 ? 0 : 0.125 * rise;
                heights.close_to(double{v.position.z}, double(i) + rise, 1e-6);
                heights.close_to(double{v.position.x}, u, 1e-6);
                heights.close_to(double{v.position.y}, double{v.v}, 1e-6);
            }
            const glm::dvec3 a(list[at].position), b(list[at + 1].position),
                d(list[at + 2].position);
            area += glm::cross(b - a, d - a).z / 2;
            at += 3;
        }
        areas.close_to(area, x * y / 2, 1e-6);
        for (std::uint32_t k = 3 * pieces[i]; spare && k < 12; ++k, ++at) {
            const surface_vertex nothing{};
            zeros.same(std::memcmp(&list[at], &nothing, sizeof nothing), 0);
        }
    }
}

/// A second pass over the first one's list, by the count that the device has.
template <backend B>
void bark_twice(context<B>& c) {
    bark_input in;
    for (int i = 0; i < 70; ++i) {
        in.add(2, 2 + i % 3);
    }
    const auto kernel = bark_kernel();
    auto later = kernel;
    later.indexed = 0;
    const auto vertices = c.put(in.vertices);
    const auto indices = c.put(in.indices);
    const auto heights = c.put(in.heights);
    const auto first = c.template room<surface_vertex>(3 * 4 * 70);
    const auto second = c.template room<surface_vertex>(3 * 16 * 70);
    const auto count = c.template room<count_record>(1);
    const auto end = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(kernel, {vertices.view(), indices.view(), heights.view()}, range{0, 70},
                 triangle_list<B>{first.view(), count.view(), padding::compact});
        r.expand(later, {first.view(), indices.view(), heights.view()},
                 counted<B>{count.view(), 4 * 70},
                 triangle_list<B>{second.view(), end.view(), padding::compact});
    });
    c.expect_count(count, 4 * 70, 4 * 70);
    const auto made = c.template get<count_record>(end)[0];
    const auto list = c.template get<surface_vertex>(second);
    comparison areas = c.compare("area of all pieces");
    double area = 0;
    for (std::size_t k = 0; k < 3 * std::size_t{made.written}; k += 3) {
        const glm::dvec3 a(list[k].position), b(list[k + 1].position), d(list[k + 2].position);
        area += glm::cross(b - a, d - a).z / 2;
    }
    double expected = 0;
    for (const glm::dvec2& side : in.sides) {
        expected += side.x * side.y / 2;
    }
    areas.close_to(area, expected, 1e-4);
}

/// Levels of one pass against as many passes: the same triangles, in the same order.
template <backend B>
void bark_levels(context<B>& c, std::uint32_t levels, padding policy) {
    bark_input in;
    for (int i = 0; i < 70; ++i) {
        in.add(0.5 + 0.09 * i, 4.4 - 0.06 * i, i % 5 != 0);
    }
    auto one = bark_kernel();
    bark_input now = in;
    std::uint64_t triangles = 70;
    for (std::uint32_t level = 0; level < levels; ++level) {
        // The room is as if all were split; the count says what there is.
        const auto vertices = c.put(now.vertices);
        const auto indices = c.put(in.indices);
        const auto heights = c.put(in.heights);
        const auto out = c.template room<surface_vertex>(12 * triangles);
        const auto count = c.template room<count_record>(1);
        c.run([&](auto& r) {
            r.expand(one, {vertices.view(), indices.view(), heights.view()},
                     range{0, static_cast<std::uint32_t>(triangles)},
                     triangle_list<B>{out.view(), count.view(), padding::compact});
        });
        triangles = c.template get<count_record>(count)[0].written;
        now.vertices = c.template get<surface_vertex>(out);
        now.vertices.resize(3 * triangles);
        one.indexed = 0;
    }
    auto all = bark_kernel();
    all.levels = levels;
    const bool spare = policy == padding::degenerate;
    const std::uint64_t room = spare ? std::uint64_t{70} * all.strips() : triangles;
    const auto list = bark_list(c, in, all, policy, room, room);
    comparison words = c.compare("vertices of one pass, and of many");
    const surface_vertex nothing[3]{};
    std::size_t at = 0;
    for (std::size_t t = 0; t < list.size(); t += 3) {
        if (spare && std::memcmp(&list[t], nothing, sizeof nothing) == 0) {
            continue;
        }
        const bool there = at + 3 <= now.vertices.size();
        words.same(there ? std::memcmp(&list[t], &now.vertices[at], sizeof nothing) : 1, 0);
        at += 3;
    }
    words.same(static_cast<int>(at), static_cast<int>(now.vertices.size()));
}

template <backend B>
void add_bark_cases(cases<B>& to) {
    if constexpr (expands<B, kernels::bark>) {
        using C = context<B>;
        const auto add = [&](std::string name, std::function<void(C&)> body) {
            to.push_back({"bark", std::move(name), std::move(body)});
        };
        add("patterns_degenerate", [](C& c) { bark_patterns(c, padding::degenerate); });
        add("patterns_compact", [](C& c) { bark_patterns(c, padding::compact); });
        add("twice", bark_twice<B>);
        add("two_levels_degenerate", [](C& c) { bark_levels(c, 2, padding::degenerate); });
        add("two_levels_compact", [](C& c) { bark_levels(c, 2, padding::compact); });
        add("three_levels_degenerate", [](C& c) { bark_levels(c, 3, padding::degenerate); });
        add("three_levels_compact", [](C& c) { bark_levels(c, 3, padding::compact); });
        add("short_by_one_triangle", [](C& c) {
            bark_input in;
            for (int i = 0; i < 100; ++i) {
                in.add(1.5, 1.5);
            }
            const auto all = bark_list(c, in, bark_kernel(), padding::compact, 400, 400);
            const auto some = bark_list(c, in, bark_kernel(), padding::compact, 399, 400);
            comparison words = c.compare("vertices before the end of the room");
            for (std::size_t i = 0; i < some.size(); ++i) {
                words.same(std::memcmp(&some[i], &all[i], sizeof some[i]), 0);
            }
        });
    }
}

} // namespace skybark::conformance
