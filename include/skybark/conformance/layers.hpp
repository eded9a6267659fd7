#pragma once
// Cases: peel. Expectations are made in double precision at pixel centres away from edges: devices
// may place a corner up to 1/16 pixel aside, so nothing is expected of centres nearer than 1/8 to
// an edge, and depths may be off by what 1/16 pixel makes on a triangle's slope.

#include <skybark/conformance/buffers.hpp>
#include <skybark/conformance/draws.hpp>
#include <skybark/kernels/probe_peel.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace skybark::conformance {

/// Corners in clip space, three a triangle.
using corner_list = std::vector<glm::vec4>;

struct layer_size {
    std::uint32_t width = 1;
    std::uint32_t height = 1;

    [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
    /// The first row is at clip y = −1.
    [[nodiscard]] glm::vec4 corner(double x, double y, double z) const {
        return {static_cast<float>(x / width * 2 - 1), static_cast<float>(y / height * 2 - 1),
                static_cast<float>(z), 1};
    }
    [[nodiscard]] glm::dvec2 place(const glm::vec4& corner) const {
        return {(0.5 * double{corner.x} + 0.5) * width, (0.5 * double{corner.y} + 0.5) * height};
    }
};

inline void add_triangle(corner_list& to, const glm::vec4& a, const glm::vec4& b,
                         const glm::vec4& c) {
    to.insert(to.end(), {a, b, c});
}
/// The pixels from (x0, y0) to (x1, y1), at one depth.
inline void add_plane(corner_list& to, layer_size size, double x0, double y0, double x1, double y1,
                      double z) {
    add_triangle(to, size.corner(x0, y0, z), size.corner(x1, y0, z), size.corner(x0, y1, z));
    add_triangle(to, size.corner(x1, y0, z), size.corner(x1, y1, z), size.corner(x0, y1, z));
}

/// What one pixel sees of one triangle.
struct peel_fragment {
    double depth;
    double tolerance;
    std::uint32_t triangle;
};
/// All of a pixel's fragments from far to near, or that they cannot be foretold.
struct peel_pixel {
    std::vector<peel_fragment> fragments;
    bool is_sure = true;
};

/// The depth of a triangle at a place, and how it grows with a pixel to the right and upwards.
struct depth_plane {
    double at = 0;
    glm::dvec2 slope{0};
    bool is_there = false;
};
[[nodiscard]] inline depth_plane plane_at(const std::array<glm::dvec2, 3>& p,
                                          const std::array<double, 3>& z, glm::dvec2 at) {
    const glm::dvec2 u = p[1] - p[0];
    const glm::dvec2 v = p[2] - p[0];
    const double area = u.x * v.y - u.y * v.x;
    if (!(std::fabs(area) > 1e-6) || !std::isfinite(area + z[0] + z[1] + z[2])) {
        return {};
    }
    const glm::dvec2 slope{((z[1] - z[0]) * v.y - (z[2] - z[0]) * u.y) / area,
                           ((z[2] - z[0]) * u.x - (z[1] - z[0]) * v.x) / area};
    return {z[0] + slope.x * (at.x - p[0].x) + slope.y * (at.y - p[0].y), slope, true};
}

[[nodiscard]] inline peel_pixel pixel_of(const corner_list& corners, range triangles,
                                         layer_size size, glm::dvec2 at) {
    peel_pixel seen;
    for (std::uint32_t t = triangles.first; t < triangles.first + triangles.count; ++t) {
        std::array<glm::dvec2, 3> p;
        std::array<double, 3> z{};
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = size.place(corners[3 * t + k]);
            z[k] = double{corners[3 * t + k].z};
        }
        const depth_plane plane = plane_at(p, z, at);
        if (!plane.is_there) {
            continue; // no area, or no number
        }
        const double inside = flat_triangle{p[0], p[1], p[2]}.depth_inside(at);
        const double tolerance = 2e-6 + (std::fabs(plane.slope.x) + std::fabs(plane.slope.y)) / 16;
        const auto is_near = [&](double limit) {
            return plane.at != limit && std::fabs(plane.at - limit) <= tolerance;
        };
        if (inside <= -edge_slack || plane.at < -tolerance || plane.at > 1 + tolerance) {
            continue;
        }
        seen.is_sure &= inside >= edge_slack && !is_near(0) && !is_near(1);
        if (plane.at > 0 && plane.at < 1) {
            seen.fragments.push_back({plane.at, tolerance, t});
        }
    }
    std::sort(seen.fragments.begin(), seen.fragments.end(),
              [](const peel_fragment& a, const peel_fragment& b) {
                  return a.depth != b.depth ? a.depth > b.depth : a.triangle < b.triangle;
              });
    for (std::size_t i = 1; i < seen.fragments.size(); ++i) {
        const peel_fragment& a = seen.fragments[i - 1];
        const peel_fragment& b = seen.fragments[i];
        seen.is_sure &= a.depth - b.depth > a.tolerance + b.tolerance;
    }
    return seen;
}
[[nodiscard]] inline std::vector<peel_pixel> pixels_of(const corner_list& corners, range triangles,
                                                       layer_size size) {
    std::vector<peel_pixel> all;
    for (std::uint32_t y = 0; y < size.height; ++y) {
        for (std::uint32_t x = 0; x < size.width; ++x) {
            all.push_back(pixel_of(corners, triangles, size, {x + 0.5, y + 0.5}));
        }
    }
    return all;
}

/// A layer as it came back.
struct seen_layer {
    std::vector<float> depth;
    std::vector<std::uint32_t> triangle;
    count_record count;
};

/// A picture whose layers are peeled one after another, between guards.
template <backend B>
class peeling {
  public:
    peeling(context<B>& c, const corner_list& corners, layer_size size)
        : c_(c), size_(size), triangles_{0, static_cast<std::uint32_t>(corners.size() / 3)},
          corners_(c.put(corners)), depth_(c.put(std::vector<float>(size.pixels(), 1.0f))),
          triangle_(c.template room<std::uint32_t>(size.pixels())),
          count_(c.template room<count_record>(1)) {}

    kernels::probe_peel kernel;

    [[nodiscard]] range triangles() const { return triangles_; }
    void only(range triangles) { triangles_ = triangles; }
    [[nodiscard]] layer_size size() const { return size_; }
    [[nodiscard]] const guarded<B>& depth() const { return depth_; }

    void record(typename B::recorder& r) const {
        r.peel(kernel, {corners_.view()}, triangles_,
               peeled_layer<B>{size_.width, size_.height, depth_.view(), triangle_.view(),
                               count_.view()});
    }
    [[nodiscard]] seen_layer get() const {
        return {c_.template get<float>(depth_), c_.template get<std::uint32_t>(triangle_),
                c_.template get<count_record>(count_)[0]};
    }
    [[nodiscard]] seen_layer next() const {
        c_.run([&](auto& r) { record(r); });
        return get();
    }

  private:
    context<B>& c_;
    layer_size size_;
    range triangles_;
    guarded<B> corners_;
    guarded<B> depth_;
    guarded<B> triangle_;
    guarded<B> count_;
};

/// What holds of any layer: it is nearer than the one before it, names its triangles, and is
/// counted.
template <backend B>
void expect_layer(const context<B>& c, range triangles, const std::vector<float>& before,
                  const seen_layer& seen) {
    comparison check = c.compare("depths and triangles of a layer, before, empty or there");
    std::uint32_t left = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const double depth = double{seen.depth[i]};
        const bool is_there = depth != 0;
        left += is_there ? 1 : 0;
        if (is_there) {
            check.within(depth, 0, std::nextafter(before[i], 0.0f));
            check.within(seen.triangle[i], triangles.first, triangles.first + triangles.count - 1);
        } else {
            check.same(seen.triangle[i], no_surface);
        }
    }
    comparison counts = c.compare("count of a layer (written, required)");
    counts.same(seen.count.written, left);
    counts.same(seen.count.required, left);
}

/// Layer `number` of the pixels whose fragments are known.
template <backend B>
void expect_fragments(const context<B>& c, const std::vector<peel_pixel>& expected,
                      std::size_t number, const seen_layer& seen) {
    comparison check = c.compare("depth and triangle of a pixel");
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (!expected[i].is_sure) {
            continue;
        }
        if (number < expected[i].fragments.size()) {
            const peel_fragment& f = expected[i].fragments[number];
            check.close_to(double{seen.depth[i]}, f.depth, f.tolerance);
            check.same(seen.triangle[i], f.triangle);
        } else {
            check.same(double{seen.depth[i]}, 0);
        }
    }
}

/// Peels until nothing is left, and once more. Of the pixels, at least `sure` in a hundred must be
/// ones whose fragments are known. Returns how many layers had something.
template <backend B>
std::size_t expect_layers(context<B>& c, const peeling<B>& of, const corner_list& corners,
                          std::uint32_t sure) {
    const auto expected = pixels_of(corners, of.triangles(), of.size());
    const auto known = std::count_if(expected.begin(), expected.end(),
                                     [](const peel_pixel& p) { return p.is_sure; });
    if (static_cast<std::size_t>(known) * 100 < of.size().pixels() * sure) {
        context<B>::stop("The case knows too few of its pixels: " + std::to_string(known));
    }
    std::vector<float> before(of.size().pixels(), 1.0f);
    std::size_t layers = 0;
    while (true) {
        const seen_layer seen = of.next();
        expect_layer(c, of.triangles(), before, seen);
        expect_fragments(c, expected, layers, seen);
        if (seen.count.written == 0) {
            break;
        }
        if (++layers > of.triangles().count) {
            context<B>::stop("There are more layers than triangles: peeling does not end.");
        }
        before = seen.depth;
    }
    const seen_layer after = of.next();
    expect_layer(c, of.triangles(), std::vector<float>(of.size().pixels(), 0.0f), after);
    return layers;
}

template <backend B>
void peel_these(context<B>& c, const corner_list& corners, layer_size size, std::uint32_t sure) {
    const peeling<B> of(c, corners, size);
    (void)expect_layers(c, of, corners, sure);
}

/// No triangles: nothing is there, and whatever was in the views is gone.
template <backend B>
void peel_nothing(context<B>& c) {
    corner_list corners;
    add_plane(corners, {9, 7}, 0, 0, 9, 7, 0.5);
    peeling<B> of(c, corners, {9, 7});
    of.only({0, 0});
    const seen_layer seen = of.next();
    expect_layer(c, {0, 0}, std::vector<float>(63, 1.0f), seen);
    comparison check = c.compare("depths where there are no triangles");
    for (const float depth : seen.depth) {
        check.same(double{depth}, 0);
    }
}

/// Wound either way, in the lower left of the picture, so that rows and columns can't be swapped.
template <backend B>
void peel_one(context<B>& c) {
    const layer_size size{30, 20};
    for (const bool turned : {false, true}) {
        const glm::vec4 a = size.corner(2, 1, 0.25);
        const glm::vec4 b = size.corner(25, 3, 0.5);
        const glm::vec4 d = size.corner(5, 15, 0.75);
        corner_list corners;
        add_triangle(corners, a, turned ? d : b, turned ? b : d);
        peel_these(c, corners, size, 85);
    }
}

/// Planes of different sizes that come in no order, each with something in it.
template <backend B>
void peel_planes(context<B>& c) {
    const layer_size size{24, 18};
    corner_list corners;
    for (const int k : {3, 0, 5, 1, 4, 2}) {
        add_plane(corners, size, k, 0, 24, 18 - k, 0.125 * (k + 1));
    }
    const peeling<B> of(c, corners, size);
    comparison check = c.compare("how many layers there are");
    check.same(static_cast<double>(expect_layers(c, of, corners, 60)), 6);
}

/// Fragments of the same depth are one layer; any of their triangles may be named.
template <backend B>
void peel_equal_depths(context<B>& c) {
    const layer_size size{16, 12};
    corner_list corners;
    for (const double z : {0.75, 0.25, 0.75, 0.75, 0.25}) {
        add_triangle(corners, size.corner(-16, 0, z), size.corner(32, 0, z), size.corner(8, 36, z));
    }
    const peeling<B> of(c, corners, size);
    std::vector<float> before(size.pixels(), 1.0f);
    comparison check = c.compare("depth, and which plane a triangle is of");
    for (const double z : {0.75, 0.25, 0.0}) {
        const seen_layer seen = of.next();
        expect_layer(c, of.triangles(), before, seen);
        for (std::size_t i = 0; i < size.pixels(); ++i) {
            check.close_to(double{seen.depth[i]}, z, z == 0 ? 0 : 2e-6);
            if (z != 0) {
                const bool is_near = seen.triangle[i] == 1 || seen.triangle[i] == 4;
                check.same(is_near ? 0.25 : 0.75, z);
            }
        }
        before = seen.depth;
    }
}

/// What lies at depth 0 or 1, or beyond, is not there; nor is the part of a slope that does.
template <backend B>
void peel_limits(context<B>& c) {
    const layer_size size{20, 20};
    corner_list corners;
    for (const double z : {0.0, 1.0, -0.25, 1.5, -1e-3, 1.001}) {
        add_plane(corners, size, 0, 0, 20, 20, z);
    }
    peel_these(c, corners, size, 50);
    add_plane(corners, size, 0, 0, 20, 20, 0.5);
    const glm::vec4 low = size.corner(-10, -10, -0.6);
    const glm::vec4 high = size.corner(30, -10, 1.7);
    add_triangle(corners, low, high, size.corner(10, 45, 0.55));
    peel_these(c, corners, size, 30);
}

/// Corners far outside the picture cover what lies between them.
template <backend B>
void peel_beyond_the_picture(context<B>& c) {
    const layer_size size{32, 24};
    corner_list corners;
    add_triangle(corners, size.corner(-40, -30, 0.3), size.corner(80, -20, 0.4),
                 size.corner(20, 70, 0.6));
    add_triangle(corners, size.corner(16, -50, 0.7), size.corner(70, 12, 0.8),
                 size.corner(16, 60, 0.9));
    add_plane(corners, size, 33, 0, 60, 24, 0.5); // to the right of it
    add_plane(corners, size, 0, -30, 32, -1, 0.5);
    peel_these(c, corners, size, 80);
}

/// Triangles without an area, and those with a corner that is no number, are not there. The others
/// are.
template <backend B>
void peel_degenerate(context<B>& c) {
    const layer_size size{20, 16};
    corner_list corners;
    add_plane(corners, size, 0, 0, 20, 16, 0.75);
    const glm::vec4 p = size.corner(3, 3, 0.5);
    const glm::vec4 q = size.corner(17, 13, 0.5);
    add_triangle(corners, p, p, p);
    add_triangle(corners, p, q, q);
    add_triangle(corners, p, size.corner(10, 8, 0.5), q);
    add_plane(corners, size, 2, 2, 18, 14, 0.25);
    peel_these(c, corners, size, 70);
}
template <backend B>
void peel_no_numbers(context<B>& c) {
    const layer_size size{20, 16};
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    corner_list corners;
    add_plane(corners, size, 0, 0, 20, 16, 0.75);
    for (const float wrong : {nan, inf, -inf}) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int k = 0; k < 3; ++k) {
                std::array<glm::vec4, 3> t{size.corner(-10, -10, 0.5), size.corner(50, -10, 0.5),
                                           size.corner(-10, 50, 0.5)};
                t[static_cast<std::size_t>(k)][axis] = wrong;
                add_triangle(corners, t[0], t[1], t[2]);
            }
        }
    }
    add_plane(corners, size, 2, 2, 18, 14, 0.25);
    peel_these(c, corners, size, 70);
}

/// Triangles of any shape, each in a range of depths of its own.
template <backend B>
void peel_random(context<B>& c, layer_size size, std::uint32_t triangles, std::uint32_t sure) {
    std::vector<std::uint32_t> order = counting(triangles, 0);
    std::shuffle(order.begin(), order.end(), c.random);
    const auto between = [&](double low, double high) {
        return low + (high - low) * c.below(10000) / 10000.0;
    };
    corner_list corners;
    for (const std::uint32_t k : order) {
        const auto corner = [&] {
            return size.corner(between(-0.2, 1.2) * size.width, between(-0.2, 1.2) * size.height,
                               (k + between(0.1, 0.9)) / triangles);
        };
        const glm::vec4 a = corner();
        const glm::vec4 b = corner();
        add_triangle(corners, a, b, corner());
    }
    peel_these(c, corners, size, sure);
}

/// Two slopes that run through each other: which is farther changes in the middle.
template <backend B>
void peel_intersecting(context<B>& c) {
    const layer_size size{40, 30};
    corner_list corners;
    const auto slope = [&](double left, double right) {
        add_triangle(corners, size.corner(-20, -15, left), size.corner(60, -15, right),
                     size.corner(60, 65, right));
        add_triangle(corners, size.corner(-20, -15, left), size.corner(60, 65, right),
                     size.corner(-20, 65, left));
    };
    slope(0.125, 0.875);
    slope(0.875, 0.125);
    peel_these(c, corners, size, 75);
}

/// A mesh that covers the picture, its corners on pixel centres, pixel corners and between, leaves
/// no hole.
template <backend B>
void peel_shared_edges(context<B>& c, bool on_centres) {
    const layer_size size{64, 64};
    constexpr int cells = 16;
    std::vector<glm::dvec2> grid;
    for (int y = 0; y <= cells; ++y) {
        for (int x = 0; x <= cells; ++x) {
            const bool border = x == 0 || y == 0 || x == cells || y == cells;
            const glm::dvec2 moved{c.below(257) / 128.0, c.below(257) / 128.0};
            const glm::dvec2 at(4.0 * x, 4.0 * y);
            grid.push_back(border ? glm::dvec2{x * 4.5 - 4, y * 4.5 - 4}
                                  : at + (on_centres ? glm::dvec2{0.5, 0.5} : moved));
        }
    }
    corner_list corners;
    const auto corner = [&](int x, int y) {
        const glm::dvec2 p = grid[static_cast<std::size_t>(y * (cells + 1) + x)];
        return size.corner(p.x, p.y, 0.5);
    };
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            const bool flip = (x + y) % 2 == 0;
            add_triangle(corners, corner(x, y), corner(x, y + 1), corner(x + 1, flip ? y + 1 : y));
            add_triangle(corners, corner(x, flip ? y : y + 1), corner(x + 1, y + 1),
                         corner(x + 1, y));
        }
    }
    const peeling<B> of(c, corners, size);
    const seen_layer seen = of.next();
    comparison check = c.compare("depths of a picture without holes");
    for (const float depth : seen.depth) {
        check.close_to(double{depth}, 0.5, 2e-6);
    }
    expect_layer(c, of.triangles(), std::vector<float>(size.pixels(), 1.0f), seen);
}

/// A triangle for each pixel, more of them than 16 bits count, and one behind all.
template <backend B>
void peel_many(context<B>& c) {
    const layer_size size{301, 233};
    corner_list corners;
    for (std::uint32_t y = 0; y < size.height; ++y) {
        for (std::uint32_t x = 0; x < size.width; ++x) {
            add_triangle(corners, size.corner(x + 0.1, y + 0.1, 0.25),
                         size.corner(x + 0.9, y + 0.1, 0.25), size.corner(x + 0.5, y + 0.9, 0.25));
        }
    }
    add_triangle(corners, size.corner(-400, -300, 0.5), size.corner(900, -300, 0.5),
                 size.corner(150, 900, 0.5));
    const peeling<B> of(c, corners, size);
    comparison check = c.compare("triangles of the first and the second layer");
    const seen_layer first = of.next();
    const seen_layer second = of.next();
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        check.same(first.triangle[i], static_cast<double>(size.pixels()));
        check.same(second.triangle[i], static_cast<double>(i));
    }
    check.same(of.next().count.written, 0);
}

/// Triangles from the middle of a list keep their numbers, and the others are not there.
template <backend B>
void peel_part(context<B>& c) {
    const layer_size size{16, 16};
    corner_list corners;
    for (int k = 0; k < 7; ++k) {
        add_plane(corners, size, k, 0, 16, 16, 0.9 - 0.1 * k);
    }
    peeling<B> of(c, corners, size);
    of.only({5, 6});
    (void)expect_layers(c, of, corners, 50);
}

/// The kernel's parameters reach the device.
template <backend B>
void peel_parameters(context<B>& c) {
    const layer_size size{16, 12};
    corner_list corners;
    add_plane(corners, size, 2, 1, 12, 9, 0.5);
    peeling<B> of(c, corners, size);
    of.kernel.scale = {0.5f, 1, 0.5f, 0};
    of.kernel.shift = {0.25f, -0.125f, 0.125f, 0};
    for (glm::vec4& p : corners) {
        p = {p.x * 0.5f + 0.25f, p.y - 0.125f, p.z * 0.5f + 0.125f, 1};
    }
    (void)expect_layers(c, of, corners, 50);
}

/// In one stream: two layers, and then the first once more, as the depths have been put back.
template <backend B>
void peel_twice_in_one_recorder(context<B>& c) {
    const layer_size size{19, 13};
    corner_list corners;
    for (const double z : {0.25, 0.75, 0.5}) {
        add_plane(corners, size, 0, 0, 19, 13, z);
    }
    const peeling<B> of(c, corners, size);
    const auto ones = c.put(std::vector<float>(size.pixels(), 1.0f));
    const auto check = [&](double z, auto&& record) {
        c.run(record);
        const seen_layer seen = of.get();
        comparison depths = c.compare("depths of the last layer of a stream");
        for (const float depth : seen.depth) {
            depths.close_to(double{depth}, z, 2e-6);
        }
        comparison counts = c.compare("count of the last layer of a stream");
        counts.same(seen.count.written, static_cast<double>(size.pixels()));
    };
    check(0.5, [&](auto& r) {
        of.record(r);
        of.record(r);
    });
    check(0.75, [&](auto& r) {
        of.record(r);
        r.copy(ones.view(), of.depth().view());
        of.record(r);
    });
    check(0.25, [&](auto& r) {
        of.record(r);
        of.record(r);
    });
}

/// Two recorders turn by turn, with pictures of different sizes.
template <backend B>
void peel_interleaved(context<B>& c) {
    const layer_size other{7, 5};
    const layer_size large{33, 41};
    corner_list corners;
    corner_list others;
    for (const double z : {0.625, 0.25, 0.875}) {
        add_plane(corners, other, 0, 0, 7, 5, z);
        add_plane(others, large, 0, 0, 33, 41, z / 2);
    }
    const peeling<B> a(c, corners, other);
    const peeling<B> b(c, others, large);
    auto first = c.begin();
    auto second = c.begin();
    a.record(first);
    b.record(second);
    a.record(first);
    b.record(second);
    b.record(second);
    c.submit(second);
    c.submit(first);
    comparison check = c.compare("depths of two recorders");
    for (const float depth : a.get().depth) {
        check.close_to(double{depth}, 0.625, 2e-6);
    }
    for (const float depth : b.get().depth) {
        check.close_to(double{depth}, 0.125, 2e-6);
    }
}

/// Depths, triangles and the count are parts of one buffer, with numbers around them.
template <backend B>
void peel_in_views(context<B>& c) {
    const layer_size size{21, 11};
    corner_list corners;
    add_plane(corners, size, 0, 0, 21, 11, 0.5);
    const auto in = c.put(corners);
    const std::uint64_t step = std::max<std::uint64_t>(c.device.limits().view_alignment, 256);
    const std::uint64_t bytes = size.pixels() * 4;
    const std::uint64_t stride = (bytes / step + 2) * step;
    auto numbers = counting(3 * stride / 4, 1000);
    std::fill_n(numbers.begin(), size.pixels(), 0x3f800000u); // 1.0f
    const auto g = c.put(numbers);
    c.run([&](auto& r) {
        r.peel(kernels::probe_peel{}, {in.view()}, range{0, 2},
               peeled_layer<B>{size.width,
                               size.height,
                               {&g.buffer, g.before, bytes},
                               {&g.buffer, g.before + stride, bytes},
                               {&g.buffer, g.before + 2 * stride, 16}});
    });
    const auto seen = c.template get<std::uint32_t>(g);
    const auto pixels = static_cast<std::uint32_t>(size.pixels());
    comparison check = c.compare("words of a buffer with a layer in it");
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const std::size_t part = i / (stride / 4);
        const std::size_t word = i % (stride / 4);
        if (part == 0 && word < pixels) {
            check.close_to(double{std::bit_cast<float>(seen[i])}, 0.5, 2e-6);
        } else if (part == 1 && word < pixels) {
            check.within(seen[i], 0, 1);
        } else if (part == 2 && word < 2) {
            check.same(seen[i], pixels);
        } else if (part != 2 || word >= 4) {
            check.same(seen[i], numbers[i]);
        }
    }
}

template <backend B>
void add_peel_cases(cases<B>& to) {
    if constexpr (peels<B, kernels::probe_peel>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"peel", std::move(name), std::move(body)});
        };
        add("nothing", peel_nothing<B>);
        add("one", peel_one<B>);
        add("planes", peel_planes<B>);
        add("equal_depths", peel_equal_depths<B>);
        add("limits", peel_limits<B>);
        add("beyond_the_picture", peel_beyond_the_picture<B>);
        add("degenerate", peel_degenerate<B>);
        add("no_numbers", peel_no_numbers<B>);
        add("random", [](context<B>& c) { peel_random(c, {61, 47}, 12, 50); });
        add("intersecting", peel_intersecting<B>);
        add("shared_edges", [](context<B>& c) { peel_shared_edges(c, false); });
        add("shared_edges_on_centres", [](context<B>& c) { peel_shared_edges(c, true); });
        for (const layer_size size : {layer_size{1, 1}, {1, 9}, {9, 1}, {3, 5}, {257, 3}}) {
            add("size_" + std::to_string(size.width) + "_" + std::to_string(size.height),
                [size](context<B>& c) { peel_random(c, size, 5, 0); });
        }
        add("size_large", [](context<B>& c) { peel_random(c, {517, 259}, 3, 90); });
        add("many", peel_many<B>);
        add("part", peel_part<B>);
        add("parameters", peel_parameters<B>);
        add("twice_in_one_recorder", peel_twice_in_one_recorder<B>);
        add("interleaved", peel_interleaved<B>);
        add("in_views", peel_in_views<B>);
    }
}

} // namespace skybark::conformance
