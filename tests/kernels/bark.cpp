// bark on the CPU: where the split points lie, that neighbours agree, paddings, and the same bits
// from the vectorised program as from the plain kernel.

#include "support/bark_surfaces.hpp"
#include "support/closed_surface.hpp"

#include <skybark/cpu/cpu.hpp>
#include <skybark/kernels/bark.hpp>
#include <skybark/trees/bark_texture.hpp>

#include <gtest/gtest.h>
#include <limits>
#include <random>

using namespace skybark;
using glm::dvec3;

namespace {

constexpr std::uint32_t map_width = 7;
constexpr std::uint32_t map_height = 5;

std::vector<float> random_heights(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<float> heights(map_width * map_height);
    for (float& h : heights) {
        h = static_cast<float>(random() % 1001) / 1000;
    }
    return heights;
}

kernels::bark test_kernel(float threshold) {
    kernels::bark k;
    k.indexed = 1;
    k.width = map_width;
    k.height = map_height;
    k.repeats_around = 3;
    k.repeats_along = 1.7f;
    k.relief = 0.08f;
    k.threshold = threshold;
    k.steepest = 0.15f;
    k.rounding = 0.75f;
    return k;
}

struct collect {
    std::vector<surface_vertex>* to;
    void operator()(const surface_vertex& v) { to->push_back(v); }
};

/// The kernel's own functions, triangle by triangle.
std::vector<surface_vertex> plain(const kernels::bark& kernel, const trees::host_mesh& mesh,
                                  const std::vector<float>& heights) {
    std::vector<surface_vertex> list;
    for (std::uint32_t i = 0; i < mesh.indices.size() / 3; ++i) {
        for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
            if (kernel.triangles(i, s, mesh.vertices, mesh.indices, heights) != 0) {
                kernel.strip(i, s, 0, 3, collect{&list}, mesh.vertices, mesh.indices, heights);
            }
        }
    }
    return list;
}

struct expanded {
    std::vector<surface_vertex> list; ///< all that the buffer holds
    count_record count;
};

/// The same by a CPU device, into a buffer with room for so many triangles and guards behind.
expanded by_device(const kernels::bark& kernel, const trees::host_mesh& mesh,
                   const std::vector<float>& heights, padding policy, std::uint64_t room) {
    cpu::device device;
    const auto vertices = make_buffer<cpu::device, surface_vertex>(device, mesh.vertices);
    const auto indices = make_buffer<cpu::device, std::uint32_t>(device, mesh.indices);
    const auto map = make_buffer<cpu::device, float>(device, heights);
    expanded made;
    surface_vertex guard;
    guard.u = 12345;
    made.list.assign(3 * room + 3, guard);
    const auto out = make_buffer<cpu::device, surface_vertex>(device, made.list);
    const auto count = device.create_buffer(sizeof(count_record));
    EXPECT_TRUE(run(device, [&](auto& r) {
        r.expand(
            kernel,
            {view<cpu::device>(*vertices), view<cpu::device>(*indices), view<cpu::device>(*map)},
            range{0, static_cast<std::uint32_t>(mesh.indices.size() / 3)},
            triangle_list<cpu::device>{view<cpu::device, surface_vertex>(*out, 0, 3 * room),
                                       view<cpu::device>(*count), policy});
    }));
    EXPECT_TRUE((read_back<cpu::device, surface_vertex>(device, *out, std::span(made.list))));
    EXPECT_TRUE((read_back<cpu::device, count_record>(device, *count, {&made.count, 1})));
    EXPECT_EQ(made.list.back().u, 12345) << "written past the view";
    made.list.resize(3 * room);
    return made;
}

/// A list without the triangles whose vertices are all zero bytes.
std::vector<surface_vertex> without_spare(const std::vector<surface_vertex>& list) {
    std::vector<surface_vertex> kept;
    const surface_vertex zeros[3]{};
    for (std::size_t k = 0; k + 2 < list.size(); k += 3) {
        if (std::memcmp(&list[k], zeros, sizeof zeros) != 0) {
            kept.insert(kept.end(), list.begin() + static_cast<std::ptrdiff_t>(k),
                        list.begin() + static_cast<std::ptrdiff_t>(k + 3));
        }
    }
    return kept;
}

void expect_equal_bits(std::span<const surface_vertex> a, std::span<const surface_vertex> b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof a[i]), 0) << "vertex " << i;
    }
}

/// Triangles of any shape, some with a corner or two without a texture direction.
trees::host_mesh triangle_soup(std::uint32_t seed, std::uint32_t triangles) {
    std::mt19937 random(seed);
    const auto number = [&] { return static_cast<float>(random() % 20001) / 10000 - 1; };
    trees::host_mesh mesh;
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
        surface_vertex v;
        v.position = {number(), number(), number()};
        v.normal = glm::normalize(glm::vec3(number(), number(), 1.1f));
        v.tangent = glm::vec4(glm::normalize(glm::vec3(number(), 1.1f, number())),
                              random() % 4 == 0 ? 0 : 1);
        v.u = number() * 2;
        v.v = number() * 5;
        mesh.vertices.push_back(v);
        mesh.indices.push_back(i);
    }
    return mesh;
}

/// Double precision, written from the documented rule alone.
namespace reference {

struct point {
    dvec3 p, n;
    double u, v;
    bool textured;
};

double wrap(double i, double n) { return i - n * std::floor(i / n); }

double height(const kernels::bark& k, const std::vector<float>& map, double u, double v) {
    // Texel centres at halves; the map repeats.
    const double x = u * double{k.repeats_around} * k.width - 0.5;
    const double y = v * double{k.repeats_along} * k.height - 0.5;
    const auto texel = [&](double i, double j) {
        return double{map[static_cast<std::size_t>(wrap(j, k.height)) * k.width +
                          static_cast<std::size_t>(wrap(i, k.width))]};
    };
    const double i = std::floor(x), j = std::floor(y), s = x - i, t = y - j;
    return (texel(i, j) * (1 - s) + texel(i + 1, j) * s) * (1 - t) +
           (texel(i, j + 1) * (1 - s) + texel(i + 1, j + 1) * s) * t;
}

point middle(const kernels::bark& k, const std::vector<float>& map, const point& a,
             const point& b) {
    point m{(a.p + b.p) / 2.0, glm::normalize(a.n + b.n), (a.u + b.u) / 2, (a.v + b.v) / 2,
            a.textured && b.textured};
    if (!m.textured) {
        return m;
    }
    // The Bézier edge whose inner control points are the thirds of the chord, projected onto the
    // tangent planes at the ends.
    const dvec3 third = a.p + (b.p - a.p) / 3.0;
    const dvec3 two_thirds = b.p + (a.p - b.p) / 3.0;
    const dvec3 c1 = third - glm::dot(third - a.p, a.n) * a.n;
    const dvec3 c2 = two_thirds - glm::dot(two_thirds - b.p, b.n) * b.n;
    const dvec3 curve = (a.p + 3.0 * c1 + 3.0 * c2 + b.p) / 8.0;
    const double most = double{k.steepest} * glm::distance(a.p, b.p);
    const double rise =
        double{k.relief} *
        (height(k, map, m.u, m.v) - (height(k, map, a.u, a.v) + height(k, map, b.u, b.v)) / 2);
    m.p += double{k.rounding} * (curve - m.p) + std::clamp(rise, -most, most) * m.n;
    return m;
}

/// All triangles after so many passes; `margin`: how close a decision came to a tie.
void split(const kernels::bark& k, const std::vector<float>& map, std::array<point, 3> t,
           int passes, std::vector<std::array<point, 3>>& to, double& margin) {
    std::array<bool, 3> cut{};
    std::array<point, 3> m;
    int cuts = 0;
    for (std::size_t e = 0; e < 3 && passes > 0; ++e) {
        const point& a = t[e];
        const point& b = t[(e + 1) % 3];
        const double length = glm::distance(a.p, b.p);
        margin = std::min(margin, std::fabs(length - double{k.threshold}));
        cut[e] = length > double{k.threshold};
        m[e] = middle(k, map, a, b);
        cuts += cut[e] ? 1 : 0;
    }
    const auto go_on = [&](const point& a, const point& b, const point& c) {
        split(k, map, {a, b, c}, passes - 1, to, margin);
    };
    if (cuts == 0) {
        to.push_back(t);
    } else if (cuts == 3) {
        go_on(t[0], m[0], m[2]);
        go_on(t[1], m[1], m[0]);
        go_on(t[2], m[2], m[1]);
        go_on(m[0], m[1], m[2]);
    } else if (cuts == 1) {
        const std::size_t e = cut[0] ? 0 : (cut[1] ? 1 : 2);
        go_on(m[e], t[(e + 2) % 3], t[e]);
        go_on(m[e], t[(e + 1) % 3], t[(e + 2) % 3]);
    } else {
        // The corner between the two cut edges comes off; the rest along its shorter diagonal.
        const std::size_t whole = !cut[0] ? 0 : (!cut[1] ? 1 : 2);
        const point& a = t[whole];
        const point& b = t[(whole + 1) % 3];
        const point& tip = t[(whole + 2) % 3];
        const point& mb = m[(whole + 1) % 3]; // of b and the tip
        const point& ma = m[(whole + 2) % 3]; // of the tip and a
        const double to_ma = glm::distance(b.p, ma.p);
        const double to_mb = glm::distance(a.p, mb.p);
        margin = std::min(margin, std::fabs(to_ma - to_mb));
        go_on(tip, ma, mb);
        if (to_ma < to_mb) {
            go_on(a, b, ma);
            go_on(b, mb, ma);
        } else {
            go_on(a, b, mb);
            go_on(a, mb, ma);
        }
    }
}

} // namespace reference

bool near_cyclic(const surface_vertex* actual, const std::array<reference::point, 3>& expected,
                 double tolerance) {
    for (std::size_t turn = 0; turn < 3; ++turn) {
        double worst = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const surface_vertex& v = actual[(k + turn) % 3];
            const reference::point& e = expected[k];
            worst = std::max({worst, glm::distance(dvec3(v.position), e.p),
                              glm::distance(dvec3(v.normal), e.n), std::fabs(v.u - e.u),
                              std::fabs(v.v - e.v), (v.tangent.w != 0) == e.textured ? 0.0 : 1.0});
        }
        if (worst <= tolerance) {
            return true;
        }
    }
    return false;
}

trees::host_mesh as_mesh(std::vector<surface_vertex> list) {
    trees::host_mesh mesh;
    mesh.vertices = std::move(list);
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        mesh.indices.push_back(i);
    }
    return mesh;
}

} // namespace

TEST(bark_kernel, points_lie_where_the_rule_in_double_precision_says) {
    const auto heights = random_heights(1);
    int compared = 0;
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        const auto kernel = test_kernel(0.45f);
        const trees::host_mesh soup = triangle_soup(seed, 6);
        trees::host_mesh mesh = soup;
        constexpr int passes = 3;
        for (int pass = 0; pass < passes; ++pass) {
            mesh = as_mesh(plain(kernel, mesh, heights));
        }
        std::vector<std::array<reference::point, 3>> expected;
        double margin = 1;
        for (std::size_t k = 0; k < soup.indices.size(); k += 3) {
            std::array<reference::point, 3> t;
            for (std::size_t c = 0; c < 3; ++c) {
                const surface_vertex& v = soup.vertices[k + c];
                t[c] = {dvec3(v.position), dvec3(v.normal), v.u, v.v, v.tangent.w != 0};
            }
            reference::split(kernel, heights, t, passes, expected, margin);
        }
        if (margin < 2e-6) {
            continue; // floats may decide otherwise
        }
        ++compared;
        // Coordinates up to 10 texels a metre and heights of 0.08 m: 1e-5 is some 50 roundings.
        constexpr double tolerance = 1e-5;
        ASSERT_EQ(mesh.vertices.size(), 3 * expected.size()) << seed;
        std::vector<bool> used(expected.size());
        for (std::size_t t = 0; t < expected.size(); ++t) {
            bool found = false;
            for (std::size_t e = 0; e < expected.size() && !found; ++e) {
                if (!used[e] && near_cyclic(&mesh.vertices[3 * t], expected[e], tolerance)) {
                    found = used[e] = true;
                }
            }
            ASSERT_TRUE(found) << "seed " << seed << ", triangle " << t;
        }
    }
    EXPECT_GE(compared, 20);
}

TEST(bark_kernel, every_pattern_covers_its_triangle_with_its_orientation) {
    // Flat, without relief: the areas of the pieces add up, and all face the same way.
    auto kernel = test_kernel(1);
    kernel.relief = 0;
    kernel.rounding = 0;
    const auto heights = random_heights(2);
    std::mt19937 random(3);
    int seen[5] = {};
    for (int i = 0; i < 2000; ++i) {
        trees::host_mesh mesh;
        for (int c = 0; c < 3; ++c) {
            surface_vertex v;
            v.position = {static_cast<float>(random() % 1000) / 600,
                          static_cast<float>(random() % 1000) / 600, 0};
            v.normal = {0, 0, 1};
            v.tangent = {1, 0, 0, 1};
            mesh.vertices.push_back(v);
        }
        mesh.indices = {0, 1, 2};
        const auto area = [](const surface_vertex* t) {
            const dvec3 a(t[0].position), b(t[1].position), c(t[2].position);
            return glm::cross(b - a, c - a).z / 2;
        };
        const double whole = area(mesh.vertices.data());
        const auto pieces = plain(kernel, mesh, heights);
        ASSERT_LE(pieces.size(), 12u);
        ++seen[pieces.size() / 3];
        double sum = 0;
        for (std::size_t k = 0; k < pieces.size(); k += 3) {
            const double piece = area(&pieces[k]);
            // A split of an edge halves an area, so no piece is below a quarter; 1e-6: rounding.
            ASSERT_GE(piece * (whole < 0 ? -1 : 1), std::fabs(whole) / 4 - 1e-6);
            sum += piece;
        }
        ASSERT_NEAR(sum, whole, 2e-6);
    }
    for (int n = 1; n <= 4; ++n) {
        EXPECT_GT(seen[n], 50) << n << " pieces";
    }
}

TEST(bark_kernel, the_devices_program_has_the_plain_kernels_bits) {
    const auto heights = random_heights(4);
    for (const float threshold : {0.02f, 0.3f, 0.9f, 1.4f, 5.0f}) {
        for (const trees::host_mesh& mesh :
             {triangle_soup(5, 700), support::closed_stem(9, 7), support::closed_stem(33, 40)}) {
            const auto kernel = test_kernel(threshold);
            const auto expected = plain(kernel, mesh, heights);
            const std::uint64_t triangles = expected.size() / 3;
            const auto compact = by_device(kernel, mesh, heights, padding::compact, triangles);
            ASSERT_EQ(compact.count.written, triangles);
            ASSERT_EQ(compact.count.required, triangles);
            expect_equal_bits(compact.list, expected);
            const std::uint64_t slots = 4 * (mesh.indices.size() / 3);
            const auto padded = by_device(kernel, mesh, heights, padding::degenerate, slots);
            ASSERT_EQ(padded.count.written, slots);
            expect_equal_bits(without_spare(padded.list), expected);
        }
    }
}

/// As many passes of one level, by the kernel's own functions.
std::vector<surface_vertex> pass_by_pass(kernels::bark kernel, trees::host_mesh mesh,
                                         const std::vector<float>& heights, std::uint32_t passes) {
    kernel.levels = 1;
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        mesh = as_mesh(plain(kernel, mesh, heights));
    }
    return mesh.vertices;
}

TEST(bark_kernel, levels_in_one_pass_are_passes_of_one_level_bit_for_bit) {
    const auto heights = random_heights(13);
    std::size_t uneven = 0;
    for (const float threshold : {0.05f, 0.3f, 0.7f, 1.4f, 5.0f}) {
        for (const trees::host_mesh& mesh :
             {triangle_soup(14, 75), support::closed_stem(9, 4), triangle_soup(15, 1)}) {
            for (std::uint32_t levels = 1; levels <= 4; ++levels) {
                auto kernel = test_kernel(threshold);
                kernel.levels = levels;
                const auto expected = pass_by_pass(kernel, mesh, heights, levels);
                const std::uint64_t triangles = expected.size() / 3;
                uneven += triangles % (mesh.indices.size() / 3) != 0 ? 1 : 0;
                ASSERT_EQ(kernel.strips(), 1u << (2 * levels));
                if (levels < 4) {
                    expect_equal_bits(plain(kernel, mesh, heights), expected);
                }
                const auto compact = by_device(kernel, mesh, heights, padding::compact, triangles);
                ASSERT_EQ(compact.count.written, triangles);
                ASSERT_EQ(compact.count.required, triangles);
                expect_equal_bits(compact.list, expected);
                if (levels == 2) {
                    const std::uint64_t slots = 16 * (mesh.indices.size() / 3);
                    const auto padded =
                        by_device(kernel, mesh, heights, padding::degenerate, slots);
                    ASSERT_EQ(padded.count.written, slots);
                    expect_equal_bits(without_spare(padded.list), expected);
                }
            }
        }
    }
    EXPECT_GT(uneven, 10u) << "triangles that are split less often than others";
}

TEST(bark_kernel, a_path_that_no_triangle_takes_is_empty) {
    // One long edge makes two children, which stay.
    auto kernel = test_kernel(1);
    kernel.levels = 2;
    kernel.relief = 0;
    trees::host_mesh mesh = triangle_soup(16, 1);
    mesh.vertices[0].position = {0, 0, 0};
    mesh.vertices[1].position = {4, 0, 0};
    mesh.vertices[2].position = {2, 0.5f, 0};
    kernel.threshold = 2.1f; // the long side, and no other
    const auto heights = random_heights(17);
    const auto at = [&](std::uint32_t strip) {
        return kernel.triangles(0, strip, mesh.vertices, mesh.indices, heights);
    };
    for (std::uint32_t strip = 0; strip < 16; ++strip) {
        EXPECT_EQ(at(strip), strip == 0 || strip == 4 ? 1u : 0u) << strip; // paths 0 0 and 1 0
    }
    kernel.threshold = 1.5f; // all sides first, then some of the pieces' long sides
    std::uint32_t all = 0;
    for (std::uint32_t strip = 0; strip < 16; ++strip) {
        all += at(strip);
    }
    EXPECT_EQ(all, pass_by_pass(kernel, mesh, heights, 2).size() / 3);
}

TEST(bark_kernel, too_little_room_takes_whole_triangles_in_order) {
    const auto heights = random_heights(6);
    const trees::host_mesh mesh = triangle_soup(7, 100);
    const auto kernel = test_kernel(0.9f);
    const auto expected = plain(kernel, mesh, heights);
    const std::uint64_t triangles = expected.size() / 3;
    for (const std::uint64_t room :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{5}, triangles / 2, triangles - 1}) {
        const auto made = by_device(kernel, mesh, heights, padding::compact, room);
        EXPECT_EQ(made.count.written, room);
        EXPECT_EQ(made.count.required, triangles);
        expect_equal_bits(made.list, std::span(expected).first(3 * room));
    }
    auto deep = test_kernel(0.3f);
    deep.levels = 3;
    const auto all = pass_by_pass(deep, mesh, heights, 3);
    for (const std::uint64_t room : {std::uint64_t{0}, std::uint64_t{7}, all.size() / 3 - 1}) {
        const auto made = by_device(deep, mesh, heights, padding::compact, room);
        EXPECT_EQ(made.count.written, room);
        EXPECT_EQ(made.count.required, all.size() / 3);
        expect_equal_bits(made.list, std::span(all).first(3 * room));
    }
}

TEST(bark_kernel, vertices_that_are_not_numbers_neither_hang_nor_crash) {
    const auto heights = random_heights(8);
    const float wild[] = {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(),
                          3e38f,
                          -3e38f,
                          1e-42f,
                          -0.0f};
    std::mt19937 random(9);
    trees::host_mesh mesh = triangle_soup(10, 500);
    for (surface_vertex& v : mesh.vertices) {
        float words[12];
        std::memcpy(words, &v, sizeof v);
        words[random() % 12] = wild[random() % 7];
        words[random() % 12] = wild[random() % 7];
        std::memcpy(&v, words, sizeof v);
    }
    const auto kernel = test_kernel(0.5f);
    const auto expected = plain(kernel, mesh, heights);
    ASSERT_LE(expected.size(), 12u * 500);
    ASSERT_GE(expected.size(), 3u * 500);
    const auto made = by_device(kernel, mesh, heights, padding::compact, expected.size() / 3);
    EXPECT_EQ(made.count.written, expected.size() / 3);
    // A triangle with a NaN for a corner has no edge there that is longer than the threshold.
    mesh.indices.resize(3);
    for (std::size_t k = 0; k < 3; ++k) {
        mesh.vertices[k].position = glm::vec3(wild[0]);
    }
    expect_equal_bits(plain(kernel, mesh, heights), std::span(mesh.vertices).first(3));
}

TEST(bark_kernel, original_corners_stay_where_they_are) {
    const auto heights = random_heights(11);
    const trees::host_mesh stem = support::closed_stem(8, 5);
    const auto list = plain(test_kernel(0.1f), stem, heights);
    std::size_t found = 0;
    for (const surface_vertex& v : stem.vertices) {
        for (const surface_vertex& w : list) {
            if (std::memcmp(&v, &w, sizeof v) == 0) {
                ++found;
                break;
            }
        }
    }
    EXPECT_EQ(found, stem.vertices.size());
}

TEST(bark_kernel, the_seam_and_the_poles_stay_closed_whatever_the_threshold) {
    const auto heights = random_heights(12);
    for (const float threshold : {0.7f, 0.5f, 0.35f, 0.27f, 0.2f, 0.13f, 0.07f}) {
        for (const trees::host_mesh& stem :
             {support::closed_stem(8, 5), support::closed_stem(5, 11)}) {
            trees::host_mesh mesh = stem;
            const auto before = support::count_edges(support::weld(mesh.vertices), mesh.indices);
            ASSERT_EQ(before.open, 0u);
            for (int pass = 0; pass < 4; ++pass) {
                mesh = as_mesh(plain(test_kernel(threshold), mesh, heights));
                const auto now = support::count_edges(support::weld(mesh.vertices), mesh.indices);
                ASSERT_EQ(now.open, 0u) << threshold << ", pass " << pass;
                ASSERT_EQ(now.degenerate_triangles, 0u);
            }
        }
    }
}

// The map's heights in a closed form: a cosine around, so that the octave that each pass adds is
// known.
TEST(bark_kernel, a_vertex_stands_out_by_its_height_less_the_corners_own) {
    constexpr std::uint32_t size = 4096;
    constexpr double pi = 3.14159265358979;
    std::vector<float> heights(size);
    for (std::uint32_t i = 0; i < size; ++i) {
        heights[i] = static_cast<float>(0.5 + 0.5 * std::cos(2 * pi * (i + 0.5) / size));
    }
    kernels::bark kernel;
    kernel.indexed = 1;
    kernel.width = size;
    kernel.height = 1;
    kernel.relief = 0.01f;
    kernel.threshold = 0.05f;
    kernel.steepest = 0.5f;
    // A flat square from u = 0.1 to u = 0.6, 1 m wide, that looks along z.
    trees::host_mesh mesh;
    for (int i = 0; i < 4; ++i) {
        surface_vertex v;
        v.position = {i % 2, i / 2, 0};
        v.normal = {0, 0, 1};
        v.u = 0.1f + 0.5f * static_cast<float>(i % 2);
        v.v = static_cast<float>(i / 2);
        v.tangent = {1, 0, 0, 1};
        mesh.vertices.push_back(v);
    }
    mesh.indices = {0, 1, 2, 2, 1, 3};
    for (int pass = 0; pass < 6; ++pass) {
        mesh = as_mesh(plain(kernel, mesh, heights));
    }
    ASSERT_GT(mesh.vertices.size(), 3u * 500);
    const auto height = [&](double u) { return 0.5 + 0.5 * std::cos(2 * pi * u); };
    for (const surface_vertex& v : mesh.vertices) {
        const double x = v.position.x;
        const double chord = height(0.1) * (1 - x) + height(0.6) * x;
        // 1e-6 of bilinear lookup in 4096 texels, and rounding.
        ASSERT_NEAR(v.position.z, 0.01 * (height(0.1 + 0.5 * x) - chord), 2e-7) << x;
    }
}
