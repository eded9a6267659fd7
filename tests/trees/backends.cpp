// One tree on every backend: the same mesh, where the equations say, and the same picture.

#include "support/devices.hpp"
#include "support/test_trees.hpp"
#include "support/tree_mesh.hpp"

#include <picture/tree_picture.hpp>
#include <skybark/conformance/branch_reference.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using kernels::branch_frame;
using support::all_trees;
using support::open_opengl;
using support::open_vulkan;
using trees::branch_mesh_options;
using trees::mesh_form;

namespace reference = skybark::conformance::reference;

namespace {

struct variant {
    branch_frame frame;
    mesh_form form;
    padding policy;

    [[nodiscard]] branch_mesh_options options() const {
        branch_mesh_options o;
        o.sides = 5;
        o.rings = 3;
        o.frame = frame;
        o.form = form;
        o.policy = policy;
        return o;
    }
};
constexpr variant variants[] = {
    {branch_frame::slerp, mesh_form::rings, padding::compact},
    {branch_frame::rotation_minimising, mesh_form::rings, padding::compact},
    {branch_frame::slerp, mesh_form::list, padding::compact},
    {branch_frame::slerp, mesh_form::list, padding::degenerate},
    {branch_frame::rotation_minimising, mesh_form::list, padding::compact},
};

std::string name_of(const support::test_tree& tree, const variant& v) {
    return tree.name + ", frame " + std::to_string(static_cast<int>(v.frame)) + ", form " +
           std::to_string(static_cast<int>(v.form)) + ", padding " +
           std::to_string(static_cast<int>(v.policy));
}

/// Tubes of the ring form: positions to 1e-5 of the tree's height, normals to 1e-3.
void expect_where_the_equations_say(const support::tree_mesh& mesh, double height,
                                    const std::string& what) {
    const bool minimising = mesh.options.frame == branch_frame::rotation_minimising;
    const std::uint32_t last = mesh.options.rings - 1;
    for (std::size_t i = 0; i < mesh.layout.segments.size(); ++i) {
        if (minimising && mesh.has_no_length(i)) {
            continue; // no curve, so no frame along it
        }
        const branch_segment& s = mesh.layout.segments[i];
        for (std::uint32_t k = 0; k <= last; ++k) {
            const auto ring = reference::ring_at(mesh.layout.ends[s.start], mesh.layout.ends[s.end],
                                                 k, last, minimising);
            for (std::uint32_t corner = 0; corner <= mesh.options.sides; ++corner) {
                const auto expected = reference::side_vertex(ring, corner, mesh.options.sides);
                const surface_vertex& actual = mesh.vertex(i, k, corner);
                ASSERT_LE(glm::length(dvec3(actual.position) - expected.position), 1e-5 * height)
                    << what << ", segment " << i << ", ring " << k;
                ASSERT_LE(glm::length(dvec3(actual.normal) - expected.normal), 1e-3)
                    << what << ", segment " << i << ", ring " << k;
                ASSERT_NEAR(actual.v, expected.v, 1e-5 * (1 + expected.v)) << what;
            }
        }
    }
}

/// As many vertices as the CPU makes, in the same order and close to its own.
void expect_like_the_cpus(const trees::host_mesh& actual, const trees::host_mesh& cpus,
                          double height, const std::string& what) {
    ASSERT_EQ(actual.vertices.size(), cpus.vertices.size()) << what;
    ASSERT_EQ(actual.indices, cpus.indices) << what;
    for (std::size_t i = 0; i < cpus.vertices.size(); ++i) {
        const surface_vertex& a = actual.vertices[i];
        const surface_vertex& b = cpus.vertices[i];
        ASSERT_LE(glm::distance(a.position, b.position), 2e-5 * height) << what << ' ' << i;
        ASSERT_LE(glm::distance(a.normal, b.normal), 2e-3f) << what << ' ' << i;
        ASSERT_LE(glm::distance(a.tangent, b.tangent), 2e-3f) << what << ' ' << i;
        ASSERT_NEAR(a.u, b.u, 1e-5f) << what << ' ' << i;
    }
}

template <backend B>
void check_trees(B& device) {
    cpu::device cpu;
    for (const support::test_tree& tree : all_trees()) {
        const double height = std::max(1.0, double{trees::height(tree.skeleton)});
        for (const variant& v : variants) {
            const std::string what = name_of(tree, v);
            const auto layout = trees::layout_branches(tree.skeleton, v.frame);
            support::tree_mesh mesh{layout, v.options(),
                                    support::mesh_on(device, layout, v.options())};
            expect_like_the_cpus(mesh.mesh, support::mesh_on(cpu, layout, v.options()), height,
                                 what);
            if (v.form == mesh_form::rings) {
                expect_where_the_equations_say(mesh, height, what);
            }
            if (::testing::Test::HasFatalFailure()) {
                return;
            }
        }
    }
}

/// A row of bent branches with so many triangles in all.
trees::branch_layout row_of_branches(std::uint32_t segments) {
    trees::branch_layout layout;
    for (std::uint32_t i = 0; i <= segments; ++i) {
        branch_end e;
        e.position = {static_cast<float>(i % 4096), static_cast<float>(i / 4096), 0};
        e.radius = 0.1f;
        // +Y turned to +X, and a little to and fro.
        const double half = -0.7853981633974483 + 0.05 * (i % 7);
        e.orientation = glm::vec4(glm::dvec4(0, 0, std::sin(half), std::cos(half)));
        e.path = static_cast<float>(i);
        layout.ends.push_back(e);
    }
    for (std::uint32_t i = 0; i < segments; ++i) {
        const bool first = i % 4096 == 0;
        layout.segments.push_back({i, i + 1, first ? cap_start : 0, 0});
    }
    return layout;
}

/// The triangles between two rings, as the contract's strips (upper, lower, upper, …) say: side j
/// is (U_j, L_j, U_j+1) and (U_j+1, L_j, L_j+1).
std::vector<std::uint32_t> tube_pattern(std::uint32_t sides, std::uint32_t rings) {
    std::vector<std::uint32_t> pattern;
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
        const std::uint32_t lower = ring * (sides + 1);
        const std::uint32_t upper = lower + sides + 1;
        for (std::uint32_t j = 0; j < sides; ++j) {
            pattern.insert(pattern.end(), {upper + j, lower + j, upper + j + 1});
            pattern.insert(pattern.end(), {upper + j + 1, lower + j, lower + j + 1});
        }
    }
    return pattern;
}

/// 60 million triangles: every index exact, and vertices of each chunk's first and last segment.
template <backend B>
void check_large_scene(B& device) {
    constexpr std::uint32_t sides = 32, rings = 16, segments = 62'600;
    branch_mesh_options options;
    options.sides = sides;
    options.rings = rings;
    const trees::branch_layout layout = row_of_branches(segments);
    auto mesh = trees::branch_mesh<B>::create(device, layout, options);
    ASSERT_TRUE(mesh) << mesh.error().message;
    ASSERT_GT(mesh->triangles(), 60'000'000u);
    for (const auto& part : mesh->parts()) {
        ASSERT_LE(part.vertices.size_bytes(), device.limits().max_buffer_bytes);
    }
    ::testing::Test::RecordProperty("parts", static_cast<int>(mesh->parts().size()));
    auto done = run(device, [&](auto& r) { mesh->record(r); });
    ASSERT_TRUE(done) << done.error().message;
    const auto pattern = tube_pattern(sides, rings);
    const std::uint32_t each = rings * (sides + 1);
    std::uint32_t first_segment = 0;
    std::uint64_t triangles = 0;
    for (const auto& part : mesh->parts()) {
        const auto geometry = mesh->geometry(part);
        std::vector<std::uint32_t> indices(geometry.count);
        auto read =
            read_back<B, std::uint32_t>(device, *geometry.indices.buffer, std::span(indices));
        ASSERT_TRUE(read) << read.error().message;
        triangles += indices.size() / 3;
        if (part.caps) {
            for (const std::uint32_t index : indices) {
                ASSERT_LT(index, part.vertex_count);
            }
            continue;
        }
        ASSERT_EQ(indices.size(), pattern.size() * part.elements);
        for (std::uint32_t element = 0; element < part.elements; ++element) {
            const std::uint32_t* own = indices.data() + std::size_t{element} * pattern.size();
            for (std::size_t k = 0; k < pattern.size(); ++k) {
                ASSERT_EQ(own[k], element * each + pattern[k]) << element << ' ' << k;
            }
        }
        for (const std::uint32_t element : {0u, part.elements - 1}) {
            std::vector<surface_vertex> vertices(each);
            auto got = read_back<B, surface_vertex>(device, part.vertices, std::span(vertices),
                                                    std::uint64_t{element} * each);
            ASSERT_TRUE(got) << got.error().message;
            const std::uint32_t s = first_segment + element;
            for (std::uint32_t k = 0; k < rings; ++k) {
                const auto ring =
                    reference::ring_at(layout.ends[s], layout.ends[s + 1], k, rings - 1, false);
                const auto expected = reference::side_vertex(ring, 3, sides);
                const surface_vertex& actual = vertices[k * (sides + 1) + 3];
                // Neighbours in the row lie up to 4096 m off: an ulp there is 5e-4 m.
                ASSERT_LE(glm::length(dvec3(actual.position) - expected.position), 2e-3) << s;
            }
        }
        first_segment += part.elements;
    }
    EXPECT_EQ(first_segment, segments);
    EXPECT_EQ(triangles, mesh->triangles());
}

template <backend B>
std::vector<std::uint8_t> picture_of(B& device, const support::test_tree& tree) {
    auto mesh = trees::branch_mesh<B>::create(device, tree.skeleton, {});
    if (!mesh) {
        ADD_FAILURE() << mesh.error().message;
        return {};
    }
    if (auto done = run(device, [&](auto& r) { mesh->record(r); }); !done) {
        ADD_FAILURE() << done.error().message;
        return {};
    }
    picture::picture_options options;
    options.width = 320;
    options.height = 200;
    options.supersampling = 1;
    const auto box = trees::bounds(tree.skeleton);
    auto pixels = picture::draw_tree(device, *mesh, box.min, box.max, options);
    EXPECT_TRUE(pixels) << pixels.error().message;
    return pixels ? *std::move(pixels) : std::vector<std::uint8_t>{};
}

/// The same to the eye: edges of branches may fall on the other side of a pixel's centre.
void expect_same_picture(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                         const std::string& what) {
    ASSERT_EQ(a.size(), 320u * 200u * 4u) << what;
    ASSERT_EQ(b.size(), a.size()) << what;
    double sum = 0;
    std::size_t far_off = 0;
    for (std::size_t p = 0; p < a.size(); p += 4) {
        int most = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            const int difference = std::abs(int{a[p + c]} - int{b[p + c]});
            sum += difference;
            most = std::max(most, difference);
        }
        far_off += most > 16 ? 1 : 0;
    }
    EXPECT_LT(sum / static_cast<double>(a.size()), 1.0) << what;
    EXPECT_LE(far_off, a.size() / 4 / 200) << what;
}

/// How many pixels are darker than any of the sky and the meadow: the tree itself.
std::size_t dark_pixels(const std::vector<std::uint8_t>& picture) {
    std::size_t dark = 0;
    for (std::size_t p = 0; p < picture.size(); p += 4) {
        dark += picture[p] < 60 && picture[p + 2] < 60 ? 1 : 0;
    }
    return dark;
}

} // namespace

TEST(backends, opengl_makes_the_trees) {
    std::string why;
    const auto gl = open_opengl(why);
    SKYBARK_SKIP_WITHOUT(gl, "opengl", why);
    check_trees(gl->device());
}

TEST(backends, vulkan_makes_the_trees) {
    std::string why;
    const auto vk = open_vulkan(why);
    SKYBARK_SKIP_WITHOUT(vk, "vulkan", why);
    check_trees(vk->device());
}

// One vendor's two drivers on one machine: geometry shaders and compute give the same bits.
TEST(backends, opengl_and_vulkan_agree_bit_for_bit_on_mesa) {
    std::string why;
    const auto gl = open_opengl(why);
    SKYBARK_SKIP_WITHOUT(gl, "opengl", why);
    const auto vk = open_vulkan(why);
    SKYBARK_SKIP_WITHOUT(vk, "vulkan", why);
    const std::string devices = gl->device().device_name() + " and " + vk->device().device_name();
    const std::size_t first = devices.find("llvmpipe");
    if (first == std::string::npos || devices.find("llvmpipe", first + 1) == std::string::npos) {
        GTEST_SKIP() << "Not both Mesa's software: " << devices;
    }
    for (const support::test_tree& tree : all_trees()) {
        for (const variant& v : variants) {
            const auto layout = trees::layout_branches(tree.skeleton, v.frame);
            const auto a = support::mesh_on(gl->device(), layout, v.options());
            const auto b = support::mesh_on(vk->device(), layout, v.options());
            ASSERT_EQ(a.vertices.size(), b.vertices.size()) << name_of(tree, v);
            ASSERT_EQ(a.indices, b.indices) << name_of(tree, v);
            ASSERT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(),
                                  a.vertices.size() * sizeof(surface_vertex)),
                      0)
                << name_of(tree, v);
        }
    }
}

TEST(backends, pictures_are_the_same_to_the_eye) {
    std::string why;
    const auto gl = open_opengl(why);
    SKYBARK_SKIP_WITHOUT(gl, "opengl", why);
    const auto vk = open_vulkan(why);
    SKYBARK_SKIP_WITHOUT(vk, "vulkan", why);
    cpu::device cpu;
    for (const support::test_tree& tree : all_trees()) {
        if (tree.name.starts_with("wild")) {
            continue; // stands on nothing
        }
        const auto on_cpu = picture_of(cpu, tree);
        const auto on_gl = picture_of(gl->device(), tree);
        const auto on_vk = picture_of(vk->device(), tree);
        expect_same_picture(on_cpu, on_gl, tree.name + ", cpu and opengl");
        expect_same_picture(on_cpu, on_vk, tree.name + ", cpu and vulkan");
        expect_same_picture(on_gl, on_vk, tree.name + ", opengl and vulkan");
        EXPECT_GT(dark_pixels(on_cpu), 200u) << tree.name; // and something is in it
    }
}

TEST(backends, cpu_large_scene_slow) {
    cpu::device_options options;
    options.limits.max_buffer_bytes = std::uint64_t{128} << 20;
    cpu::device device(options);
    check_large_scene(device); // in a dozen chunks
}

TEST(backends, opengl_large_scene_slow) {
    std::string why;
    const auto gl = open_opengl(why);
    SKYBARK_SKIP_WITHOUT(gl, "opengl", why);
    check_large_scene(gl->device());
}

TEST(backends, vulkan_large_scene_slow) {
    std::string why;
    const auto vk = open_vulkan(why);
    SKYBARK_SKIP_WITHOUT(vk, "vulkan", why);
    check_large_scene(vk->device());
}
