// Meshes of real, grown and impossible trees: closed, unfolded, and where the equations say.

#include "support/closed_surface.hpp"
#include "support/test_trees.hpp"
#include "support/tree_mesh.hpp"

#include <skybark/conformance/branch_reference.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using kernels::branch_frame;
using support::tree_mesh;
using trees::branch_mesh_options;
using trees::mesh_form;
using trees::none;

namespace reference = skybark::conformance::reference;

namespace {

constexpr branch_frame both_frames[] = {branch_frame::slerp, branch_frame::rotation_minimising};
using cpu_mesh = trees::branch_mesh<cpu::device>;

const std::vector<support::test_tree>& real_trees() {
    static const std::vector<support::test_tree> all = [] {
        auto trees = support::grown_trees();
        trees.push_back(support::scanned_tree());
        return trees;
    }();
    return all;
}

const std::vector<support::test_tree>& wild_trees() {
    static const std::vector<support::test_tree> all = [] {
        std::vector<support::test_tree> trees;
        for (std::uint32_t seed = 1; seed <= 20; ++seed) {
            trees.push_back(support::wild_scan(seed));
        }
        return trees;
    }();
    return all;
}

template <class Check>
void for_all_trees(Check&& check) {
    for (const auto* trees : {&real_trees(), &wild_trees()}) {
        for (const support::test_tree& tree : *trees) {
            check(tree);
            if (::testing::Test::HasFatalFailure()) {
                return;
            }
        }
    }
}

branch_mesh_options with(std::uint32_t sides, std::uint32_t rings, branch_frame frame) {
    branch_mesh_options options;
    options.sides = sides;
    options.rings = rings;
    options.frame = frame;
    return options;
}

bool equal_bits(const surface_vertex& a, const surface_vertex& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The largest coordinate: floats near it are 2⁻²³ of it apart.
double farthest(const trees::host_mesh& mesh) {
    double most = 0;
    for (const surface_vertex& v : mesh.vertices) {
        const glm::vec3 p = glm::abs(v.position);
        most = std::max(most, double{std::max({p.x, p.y, p.z})});
    }
    return most;
}

struct face_check {
    std::size_t triangles = 0;
    std::size_t slivers = 0;
    std::size_t turned = 0;
    std::size_t first_turned = 0;
};

/// Triangles that face against their vertices' normals. Left out are those whose height is less
/// than the rounding of their corners, 2⁻²³ of the largest coordinate, by a few times, and the flat
/// step between the two radii of a segment without length, which normals stand across.
face_check check_faces(const tree_mesh& tree) {
    const trees::host_mesh& mesh = tree.mesh;
    const double rounding = 4 * farthest(mesh) * 1.2e-7;
    face_check found;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const std::size_t segment = k / tree.tube_indices();
        if (segment < tree.layout.segments.size() && tree.has_no_length(segment)) {
            continue;
        }
        const surface_vertex* v[3];
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = &mesh.vertices[mesh.indices[k + i]];
        }
        const dvec3 a = dvec3(v[1]->position) - dvec3(v[0]->position);
        const dvec3 b = dvec3(v[2]->position) - dvec3(v[0]->position);
        const dvec3 face = glm::cross(a, b);
        const double longest = std::max({glm::length(a), glm::length(b), glm::length(a - b)});
        ++found.triangles;
        if (glm::length(face) <= rounding * longest) {
            ++found.slivers;
            continue;
        }
        const dvec3 mean = dvec3(v[0]->normal) + dvec3(v[1]->normal) + dvec3(v[2]->normal);
        if (glm::dot(face, mean) <= 0) {
            found.first_turned = found.turned++ == 0 ? k / 3 : found.first_turned;
        }
    }
    return found;
}

} // namespace

TEST(branch_mesh, no_triangle_is_turned_against_its_normals) {
    for_all_trees([](const support::test_tree& tree) {
        for (const branch_frame frame : both_frames) {
            for (const std::uint32_t rings : {2u, 4u, 8u}) {
                const auto mesh = tree_mesh::make(tree.skeleton, with(8, rings, frame));
                const face_check found = check_faces(mesh);
                EXPECT_EQ(found.turned, 0u)
                    << tree.name << ", rings " << rings << ", frame " << static_cast<int>(frame)
                    << ", first in segment " << found.first_turned * 3 / mesh.tube_indices()
                    << " of " << tree.skeleton.size();
                EXPECT_LT(found.slivers, found.triangles / 2) << tree.name;
            }
        }
    });
}

TEST(branch_mesh, continuing_segments_share_their_ring) {
    for_all_trees([](const support::test_tree& tree) {
        for (const branch_frame frame : both_frames) {
            const auto mesh = tree_mesh::make(tree.skeleton, with(7, 4, frame));
            std::size_t joints = 0;
            for (std::uint32_t i = 0; i < tree.skeleton.size(); ++i) {
                const std::uint32_t p = tree.skeleton.parent[i];
                if (p == none || mesh.layout.segments[p].end != mesh.layout.segments[i].start) {
                    continue;
                }
                ++joints;
                for (std::size_t corner = 0; corner < 8; ++corner) {
                    const surface_vertex& above = mesh.vertex(p, 3, corner);
                    const surface_vertex& below = mesh.vertex(i, 0, corner);
                    ASSERT_EQ(above.position, below.position) << tree.name << ' ' << i;
                    ASSERT_EQ(above.normal, below.normal) << tree.name << ' ' << i;
                    ASSERT_EQ(above.tangent, below.tangent) << tree.name << ' ' << i;
                    ASSERT_EQ(above.u, below.u);
                    ASSERT_EQ(above.v, below.v);
                }
            }
            ASSERT_GT(joints, tree.skeleton.size() / 10) << tree.name;
        }
    });
}

TEST(branch_mesh, every_chain_is_closed) {
    for_all_trees([](const support::test_tree& tree) {
        for (const branch_frame frame : both_frames) {
            const auto mesh = tree_mesh::make(tree.skeleton, with(6, 3, frame));
            std::size_t unresolved = 0;
            const auto chains = mesh.chains();
            for (const auto& chain : chains) {
                if (!chain.resolved) {
                    ++unresolved;
                    continue;
                }
                // Only this chain's vertices: two chains may touch.
                std::vector<surface_vertex> own;
                std::vector<std::uint32_t> indices;
                for (const std::uint32_t index : chain.indices) {
                    indices.push_back(static_cast<std::uint32_t>(own.size()));
                    own.push_back(mesh.mesh.vertices[index]);
                }
                const auto edges = support::count_edges(support::weld(own), indices);
                ASSERT_EQ(edges.open, 0u) << tree.name;
                // A chain without length has no volume, but for the rounding of its discs.
                const double rounding = 1e-6 * support::surface_area(own, indices);
                ASSERT_GE(support::signed_volume(own, indices), -rounding) << tree.name;
            }
            ASSERT_LE(unresolved, chains.size() / 50) << tree.name;
        }
    });
}

TEST(branch_mesh, chains_of_real_trees_have_a_volume) {
    for (const support::test_tree& tree : real_trees()) {
        const auto mesh = tree_mesh::make(tree.skeleton, with(8, 4, branch_frame::slerp));
        for (const auto& chain : mesh.chains()) {
            ASSERT_GT(support::signed_volume(mesh.mesh.vertices, chain.indices), 0) << tree.name;
        }
    }
}

// All segments as prisms between their ends: what the curves add and what bends take off is little.
TEST(branch_mesh, volume_is_that_of_the_wood) {
    for (const support::test_tree& tree : real_trees()) {
        const auto mesh = tree_mesh::make(tree.skeleton, with(16, 4, branch_frame::slerp));
        double wood = 0;
        for (const branch_segment& s : mesh.layout.segments) {
            const branch_end& a = mesh.layout.ends[s.start];
            const branch_end& b = mesh.layout.ends[s.end];
            const double r1 = double{a.radius}, r2 = double{b.radius};
            wood += glm::length(dvec3(b.position) - dvec3(a.position)) / 3 *
                    (r1 * r1 + r1 * r2 + r2 * r2);
        }
        wood *= 8 * std::sin(2 * reference::pi / 16); // the polygon's area at radius 1
        double volume = 0;
        for (const auto& chain : mesh.chains()) {
            volume += support::signed_volume(mesh.mesh.vertices, chain.indices);
        }
        EXPECT_NEAR(volume / wood, 1, 0.1) << tree.name;
    }
}

// Positions to 1e-5 of the height, normals to 1e-3 rad, against double precision.
TEST(branch_mesh, vertices_are_where_the_equations_say) {
    for_all_trees([](const support::test_tree& tree) {
        const double height = std::max(1.0, double{trees::height(tree.skeleton)});
        for (const branch_frame frame : both_frames) {
            const bool minimising = frame == branch_frame::rotation_minimising;
            const auto mesh = tree_mesh::make(tree.skeleton, with(5, 5, frame));
            for (std::size_t i = 0; i < mesh.layout.segments.size(); ++i) {
                const branch_end& a = mesh.layout.ends[mesh.layout.segments[i].start];
                const branch_end& b = mesh.layout.ends[mesh.layout.segments[i].end];
                if (minimising && mesh.has_no_length(i)) {
                    continue; // no curve, so no frame along it
                }
                for (std::uint32_t k = 0; k < 5; ++k) {
                    const auto ring = reference::ring_at(a, b, k, 4, minimising);
                    for (std::uint32_t corner = 0; corner <= 5; ++corner) {
                        const auto expected = reference::side_vertex(ring, corner, 5);
                        const surface_vertex& actual = mesh.vertex(i, k, corner);
                        ASSERT_LE(glm::length(dvec3(actual.position) - expected.position),
                                  1e-5 * height)
                            << tree.name << ", segment " << i << ", ring " << k;
                        ASSERT_LE(glm::length(dvec3(actual.normal) - expected.normal), 1e-3)
                            << tree.name << ", segment " << i << ", ring " << k;
                        ASSERT_LE(glm::length(dvec3(actual.tangent) - expected.tangent), 1e-3)
                            << tree.name << ", segment " << i << ", ring " << k;
                    }
                }
            }
        }
    });
}

// The list is the rings gathered, each segment's caps around it.
TEST(branch_mesh, list_is_the_rings_gathered) {
    for_all_trees([](const support::test_tree& tree) {
        cpu::device device;
        branch_mesh_options options = with(5, 3, branch_frame::slerp);
        const auto rings = tree_mesh::make(tree.skeleton, options);
        options.form = mesh_form::list;
        const auto list = support::mesh_on(device, rings.layout, options);
        options.policy = padding::degenerate;
        const auto padded = support::mesh_on(device, rings.layout, options);
        std::size_t at = 0, cap = 0, at_padded = 0;
        const surface_vertex zeros{};
        const auto expect_run = [&](std::span<const std::uint32_t> indices) {
            for (const std::uint32_t index : indices) {
                ASSERT_TRUE(equal_bits(list.vertices[at++], rings.mesh.vertices[index]));
                ASSERT_TRUE(equal_bits(padded.vertices[at_padded++], rings.mesh.vertices[index]));
            }
        };
        const auto expect_zeros = [&](std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_TRUE(equal_bits(padded.vertices[at_padded++], zeros));
            }
        };
        const std::size_t strip = std::size_t{6} * options.sides;
        for (std::size_t i = 0; i < rings.layout.segments.size(); ++i) {
            const auto expect_cap = [&](std::uint32_t bit) {
                const bool there = (rings.layout.segments[i].caps & bit) != 0;
                if (there) {
                    expect_run(rings.cap(cap++));
                }
                expect_zeros(strip - (there ? rings.cap_indices() : 0));
            };
            expect_cap(cap_start);
            expect_run(rings.tube(i));
            expect_cap(cap_end);
        }
        ASSERT_EQ(at, list.vertices.size());
        ASSERT_EQ(at_padded, padded.vertices.size());
        for (std::size_t k = 0; k < list.indices.size(); ++k) {
            ASSERT_EQ(list.indices[k], k);
        }
        ASSERT_EQ(list.indices.size(), list.vertices.size());
    });
}

TEST(branch_mesh, chunks_make_the_same_mesh) {
    const support::test_tree& tree = real_trees().back();
    for (const mesh_form form : {mesh_form::rings, mesh_form::list}) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            branch_mesh_options options = with(8, 4, branch_frame::slerp);
            options.form = form;
            options.policy = policy;
            const auto layout = trees::layout_branches(tree.skeleton, options.frame);
            cpu::device device;
            const auto whole = support::mesh_on(device, layout, options);
            // One segment's list takes 80 · 3 · 48 bytes.
            for (const std::uint64_t bytes : {11'520u, 20'000u, 100'000u, 1'000'000u}) {
                cpu::device_options small;
                small.limits.max_buffer_bytes = bytes;
                cpu::device small_device(small);
                auto mesh = cpu_mesh::create(small_device, layout, options);
                ASSERT_TRUE(mesh) << mesh.error().message;
                EXPECT_GT(mesh->parts().size(), 1u);
                for (const auto& part : mesh->parts()) {
                    EXPECT_LE(part.vertices.size_bytes(), bytes);
                    EXPECT_LE(mesh->geometry(part).indices.size, bytes);
                }
                const auto chunked = support::mesh_on(small_device, layout, options);
                ASSERT_EQ(chunked.vertices.size(), whole.vertices.size());
                for (std::size_t i = 0; i < whole.vertices.size(); ++i) {
                    ASSERT_TRUE(equal_bits(chunked.vertices[i], whole.vertices[i])) << i;
                }
                ASSERT_EQ(chunked.indices, whole.indices);
            }
            // Fewer elements than segments in a pattern call do the same.
            cpu::device_options few;
            few.limits.max_elements = 7;
            cpu::device few_device(few);
            auto mesh = cpu_mesh::create(few_device, layout, options);
            ASSERT_TRUE(mesh);
            for (const auto& part : mesh->parts()) {
                EXPECT_LE(part.elements, 7u);
            }
        }
    }
}

TEST(branch_mesh, counts_are_those_of_its_parts) {
    cpu::device device;
    const auto& tree = real_trees().back();
    auto mesh = cpu_mesh::create(device, tree.skeleton, with(8, 4, branch_frame::slerp));
    ASSERT_TRUE(mesh);
    const auto down = support::mesh_on(
        device, trees::layout_branches(tree.skeleton, branch_frame::slerp), mesh->options());
    EXPECT_EQ(mesh->vertices(), down.vertices.size());
    EXPECT_EQ(3 * mesh->triangles(), down.indices.size());
}

TEST(branch_mesh, options_out_of_range_are_named) {
    cpu::device device;
    const auto& tree = real_trees().back().skeleton;
    const auto complaint = [&](std::uint32_t sides, std::uint32_t rings) {
        const auto mesh = cpu_mesh::create(device, tree, with(sides, rings, branch_frame::slerp));
        EXPECT_FALSE(mesh);
        return mesh ? std::string() : mesh.error().message;
    };
    EXPECT_EQ(complaint(2, 4), "A branch mesh cannot have 2 sides; it takes 3 to 1024.");
    EXPECT_EQ(complaint(1025, 4), "A branch mesh cannot have 1025 sides; it takes 3 to 1024.");
    EXPECT_EQ(complaint(0, 4), "A branch mesh cannot have 0 sides; it takes 3 to 1024.");
    EXPECT_EQ(complaint(8, 1), "A branch mesh cannot have 1 rings; it takes 2 to 1024.");
    EXPECT_EQ(complaint(8, 1025), "A branch mesh cannot have 1025 rings; it takes 2 to 1024.");
    EXPECT_TRUE(cpu_mesh::create(device, tree, with(3, 2, branch_frame::slerp)));
}

TEST(branch_mesh, device_too_small_for_one_segment_is_an_error) {
    cpu::device_options small;
    small.limits.max_buffer_bytes = 1000;
    cpu::device device(small);
    const auto mesh = cpu_mesh::create(device, real_trees().back().skeleton, {});
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, error_code::out_of_memory);
    EXPECT_EQ(mesh.error().message,
              "One branch segment needs a buffer of 1728 bytes, more than the "
              "device can bind; use fewer sides or rings.");
}

TEST(branch_mesh, one_segment_without_length_or_radius) {
    for (const branch_frame frame : both_frames) {
        for (const glm::vec3 tip : {glm::vec3(0, 1, 0), glm::vec3(0)}) {
            for (const float radius : {0.1f, 0.0f}) {
                trees::segment s;
                s.tip = tip;
                s.base_radius = s.radius = radius;
                const auto mesh = tree_mesh::make(support::built({s}), with(8, 4, frame));
                EXPECT_EQ(mesh.mesh.vertices.size(), 36u + 16u);
                EXPECT_EQ(mesh.mesh.indices.size(), 3u * (48 + 12));
                for (const surface_vertex& v : mesh.mesh.vertices) {
                    ASSERT_NEAR(glm::length(v.normal), 1, 1e-5f);
                    ASSERT_LE(glm::length(v.position), 1.1f);
                }
            }
        }
    }
}

TEST(branch_mesh, empty_skeleton_is_an_empty_mesh) {
    cpu::device device;
    for (const mesh_form form : {mesh_form::rings, mesh_form::list}) {
        branch_mesh_options options;
        options.form = form;
        const auto mesh =
            support::mesh_on(device, trees::layout_branches({}, options.frame), options);
        EXPECT_TRUE(mesh.vertices.empty());
        EXPECT_TRUE(mesh.indices.empty());
    }
}
