// Closed meshes: one surface a tree without border or handles, at rest and in any pose, on every
// backend; and whether the check of that sees what is wrong.

#include "support/allocations.hpp"
#include "support/closed_surface.hpp"
#include "support/devices.hpp"
#include "support/forward_kinematics.hpp"
#include "support/surface_topology.hpp"
#include "support/test_trees.hpp"

#include <skybark/core/validated.hpp>
#include <skybark/trees/closed_mesh.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using support::surface_topology;
using trees::closed_mesh_options;
using trees::host_mesh;

namespace {

trees::segment piece(glm::vec3 base, glm::vec3 tip, float base_radius, float radius,
                     std::uint32_t parent = trees::none) {
    return {base, tip, base_radius, radius, parent};
}

struct case_tree {
    std::string name;
    trees::skeleton skeleton;
    std::size_t trees = 1; ///< roots, and so surfaces
};

/// A trunk of three pieces with a fork at its middle joint.
std::vector<trees::segment> small_tree(glm::vec3 foot) {
    const glm::vec3 up(0, 1, 0);
    return {piece(foot, foot + up, 0.2f, 0.18f), piece(foot + up, foot + 2.0f * up, 0.18f, 0.1f, 0),
            piece(foot + up, foot + glm::vec3(0.7f, 1.7f, 0), 0.15f, 0.08f, 0),
            piece(foot + 1.5f * up, foot + glm::vec3(0, 1.8f, 0.6f), 0.05f, 0.01f, 1)};
}

std::vector<case_tree> hand_made() {
    const glm::vec3 zero(0);
    const glm::vec3 up(0, 1, 0);
    std::vector<case_tree> all;
    const auto add = [&](std::string name, const std::vector<trees::segment>& segments,
                         std::size_t count = 1) {
        all.push_back({std::move(name), support::built(segments), count});
    };
    add("single", {piece(zero, up, 0.2f, 0.1f)});
    add("fork", {piece(zero, up, 0.2f, 0.15f), piece(up, {0.8f, 1.8f, 0}, 0.15f, 0.1f, 0),
                 piece(up, {-0.8f, 1.8f, 0}, 0.15f, 0.1f, 0)});
    add("back", {piece(zero, up, 0.2f, 0.15f), piece(up, {0.3f, 0.2f, 0}, 0.1f, 0.1f, 0),
                 piece(up, {-0.3f, 0.2f, 0}, 0.1f, 0.1f, 0), piece(up, zero, 0.1f, 0.1f, 0)});
    std::vector<trees::segment> many{piece(zero, up, 0.2f, 0.2f)};
    for (int i = 0; i < 40; ++i) {
        const float angle = 2.4f * static_cast<float>(i);
        const glm::vec3 at(0, 0.05f + 0.0225f * static_cast<float>(i), 0);
        const glm::vec3 out(std::cos(angle), 0.4f, std::sin(angle));
        many.push_back(piece(at, at + out, 0.04f, 0.01f, 0));
    }
    add("forty", many);
    std::vector<trees::segment> same{piece(zero, up, 0.2f, 0.2f)};
    for (int i = 0; i < 40; ++i) {
        same.push_back(piece({0, 0.5f, 0}, {1, 0.8f, 0}, 0.05f, 0.02f, 0));
    }
    add("same spot", same);
    add("thick child",
        {piece(zero, up, 0.05f, 0.05f), piece({0, 0.5f, 0}, {1, 0.7f, 0}, 0.3f, 0.2f, 0)});
    add("parallel child", {piece(zero, up, 0.1f, 0.1f), piece(zero, 2.0f * up, 0.05f, 0.02f, 0)});
    add("no length, no radius",
        {piece(zero, up, 0.1f, 0), piece(up, up, 0, 0, 0), piece(up, 2.0f * up, 0, 0, 1),
         piece({0, 0.5f, 0}, {0, 0.5f, 0}, 0, 0, 0), piece({0, 1.5f, 0}, {1, 1.5f, 0}, 0, 0, 2)});
    std::vector<trees::segment> stand;
    for (int i = 0; i < 3; ++i) {
        const auto first = static_cast<std::uint32_t>(stand.size());
        for (trees::segment s : small_tree({3.0f * static_cast<float>(i), 0, 1})) {
            s.parent += s.parent == trees::none ? 0 : first;
            stand.push_back(s);
        }
    }
    add("stand", stand, 3);
    add("far away", small_tree({1000, 50, -700}));
    return all;
}

case_tree of(const support::test_tree& tree) {
    std::size_t roots = 0;
    while (roots < tree.skeleton.size() && tree.skeleton.parent[roots] == trees::none) {
        ++roots;
    }
    return {tree.name, tree.skeleton, roots};
}

closed_mesh_options with(std::uint32_t sides, std::uint32_t rings,
                         kernels::branch_frame frame = kernels::branch_frame::slerp) {
    closed_mesh_options options;
    options.sides = sides;
    options.rings = rings;
    options.frame = frame;
    return options;
}

template <backend B>
trees::closed_mesh<B> made(B& device, const trees::skeleton& of, closed_mesh_options options) {
    auto mesh = trees::closed_mesh<B>::create(device, of, options);
    if (!mesh) {
        throw std::runtime_error(mesh.error().message);
    }
    return *std::move(mesh);
}

/// What the device makes: at rest without poses.
template <backend B>
host_mesh meshed(B& device, const trees::closed_mesh<B>& mesh,
                 const std::vector<segment_pose>& poses = {}) {
    auto buffer = make_buffer<B, segment_pose>(device, poses);
    auto done = run(device, [&](auto& r) {
        if (poses.empty()) {
            mesh.record(r);
        } else {
            mesh.record(r, view<B>(*buffer));
        }
    });
    if (!done) {
        throw std::runtime_error(done.error().message);
    }
    auto down = mesh.download(device);
    if (!down) {
        throw std::runtime_error(down.error().message);
    }
    return *std::move(down);
}

std::string describe(const surface_topology& t) {
    return std::to_string(t.boundary_edges) + " edges of one triangle, " +
           std::to_string(t.crowded_edges) + " of many, " + std::to_string(t.unoriented_edges) +
           " unoriented, " + std::to_string(t.collapsed) + " collapsed triangles, " +
           std::to_string(t.pinched) + " pinched places, " + std::to_string(t.components.size()) +
           " components, the first of Euler characteristic " +
           (t.components.empty() ? std::string("none") : std::to_string(t.components[0].euler()));
}

/// Closed as far as the bits of the positions tell.
void expect_closed(const host_mesh& mesh, const std::vector<std::uint32_t>& places,
                   std::size_t trees, const std::string& what) {
    const std::vector<std::uint32_t> welded = support::weld(mesh.vertices);
    const surface_topology by_position = support::examine_surface(welded, mesh.indices);
    EXPECT_TRUE(by_position.spheres(trees)) << what << ": " << describe(by_position);
    EXPECT_GT(support::signed_volume(mesh.vertices, mesh.indices), 0) << what;
    // What `places` promises: equal numbers where positions are equal, and nowhere else.
    ASSERT_EQ(places.size(), mesh.vertices.size()) << what;
    constexpr std::uint32_t unseen = 0xffffffffu;
    std::vector<std::uint32_t> place_of(mesh.vertices.size(), unseen);
    std::vector<std::uint32_t> position_of;
    std::size_t wrong = 0;
    std::size_t not_unit = 0;
    for (const std::uint32_t i : mesh.indices) {
        const surface_vertex& v = mesh.vertices[i];
        not_unit += std::abs(glm::length(dvec3(v.normal)) - 1) < 1e-4 ? 0 : 1;
        ASSERT_NE(places[i], trees::none) << what;
        if (places[i] >= position_of.size()) {
            position_of.resize(places[i] + 1, unseen);
        }
        std::uint32_t& place = place_of[welded[i]];
        std::uint32_t& position = position_of[places[i]];
        wrong +=
            (place != unseen && place != places[i]) || (position != unseen && position != welded[i])
                ? 1
                : 0;
        place = places[i];
        position = welded[i];
    }
    EXPECT_EQ(wrong, 0u) << what;
    EXPECT_EQ(not_unit, 0u) << what;
}

/// At rest, in a breeze and with every joint bent by up to half a radian.
template <backend B>
void check_closed(B& device, const case_tree& tree, closed_mesh_options options) {
    const auto mesh = made(device, tree.skeleton, options);
    const auto places = mesh.places();
    const std::string what = tree.name + ", " + std::to_string(options.sides) + " sides, " +
                             std::to_string(options.rings) + " rings";
    expect_closed(meshed(device, mesh), places, tree.trees, what + ", at rest");
    for (const double angle : {0.05, 0.5}) {
        const auto poses = support::random_poses(tree.skeleton, angle, 3);
        expect_closed(meshed(device, mesh, poses), places, tree.trees,
                      what + ", bent by " + std::to_string(angle));
    }
}

double height_of(const trees::skeleton& skeleton) {
    const auto box = trees::bounds(skeleton);
    return glm::length(dvec3(box.max) - dvec3(box.min));
}

/// The device's mesh is the CPU's: the same triangles, positions to 1e-5 of the tree (a few ulps of
/// sqrt and of quaternions, over 10 m), normals and texture coordinates to 2e-3.
template <backend B>
void check_against_cpu(B& device, const case_tree& tree, closed_mesh_options options) {
    cpu::device host;
    const auto poses = support::random_poses(tree.skeleton, 0.1, 5);
    const auto here = made(host, tree.skeleton, options);
    const auto there = made(device, tree.skeleton, options);
    const host_mesh expected = meshed(host, here, poses);
    const host_mesh actual = meshed(device, there, poses);
    if (here.parts().size() == there.parts().size()) {
        ASSERT_EQ(expected.indices.size(), actual.indices.size()) << tree.name;
    }
    const double most = 1e-5 * height_of(tree.skeleton) + 1e-6 * 1000;
    for (std::size_t k = 0; k < expected.indices.size(); ++k) {
        const surface_vertex& a = expected.vertices[expected.indices[k]];
        const surface_vertex& b = actual.vertices[actual.indices[k]];
        ASSERT_LE(glm::length(dvec3(a.position) - dvec3(b.position)), most) << tree.name << k;
        ASSERT_EQ(a.tangent.w, b.tangent.w) << tree.name << k;
        ASSERT_NEAR(a.u, b.u, 1e-5) << tree.name << k;
        ASSERT_NEAR(a.v, b.v, most) << tree.name << k;
    }
}

template <backend B>
void check_backend(B& device) {
    for (const case_tree& tree : hand_made()) {
        check_closed(device, tree, with(5, 3));
        check_against_cpu(device, tree, with(5, 3));
    }
    const case_tree scan = of(support::scanned_tree());
    check_closed(device, scan, with(8, 4));
    check_against_cpu(device, scan, with(8, 4));
    check_closed(device, scan, with(3, 3, kernels::branch_frame::rotation_minimising));
}

template <backend B>
void check_all_species(B& device) {
    for (const support::test_tree& tree : support::grown_trees()) {
        check_closed(device, of(tree), with(8, 4));
        if (::testing::Test::HasFailure()) {
            return;
        }
    }
}

} // namespace

TEST(closed_mesh, small_trees_are_closed) {
    cpu::device device;
    for (const case_tree& tree : hand_made()) {
        for (const auto& options : {with(8, 4), with(3, 2), with(5, 3), with(16, 2),
                                    with(6, 5, kernels::branch_frame::rotation_minimising)}) {
            check_closed(device, tree, options);
        }
    }
}

TEST(closed_mesh, scans_are_closed) {
    cpu::device device;
    check_closed(device, of(support::scanned_tree()), with(8, 4));
    check_closed(device, of(support::scanned_tree()), with(3, 2));
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        check_closed(device, of(support::wild_scan(seed)), with(5, 3));
    }
}

// The coarsest meshes, in the worst pose; all_species_slow has the usual ones at rest too.
TEST(closed_mesh, every_species_is_closed) {
    cpu::device device;
    for (const support::test_tree& tree : support::grown_trees()) {
        const case_tree grown = of(tree);
        const auto mesh = made(device, grown.skeleton, with(3, 2));
        const auto poses = support::random_poses(grown.skeleton, 0.5, 3);
        expect_closed(meshed(device, mesh, poses), mesh.places(), grown.trees, grown.name);
    }
}

TEST(closed_mesh, opengl_meshes_are_closed) {
    support::with_device("opengl", [](auto& device) { check_backend(device); });
}

TEST(closed_mesh, vulkan_meshes_are_closed) {
    support::with_device("vulkan", [](auto& device) { check_backend(device); });
}

TEST(closed_mesh, cpu_all_species_slow) {
    support::with_device("cpu", [](auto& device) { check_all_species(device); });
}

TEST(closed_mesh, opengl_all_species_slow) {
    support::with_device("opengl", [](auto& device) { check_all_species(device); });
}

TEST(closed_mesh, vulkan_all_species_slow) {
    support::with_device("vulkan", [](auto& device) { check_all_species(device); });
}

// A prism over the regular octagon, and the pyramid of half a radius on top of it.
TEST(closed_mesh, a_straight_branch_has_its_volume) {
    cpu::device device;
    const auto skeleton = support::built({piece({0, 0, 0}, {0, 2, 0}, 0.25f, 0.25f)});
    const host_mesh mesh = meshed(device, made(device, skeleton, with(8, 4)));
    const double octagon = 0.5 * 8 * std::sin(6.283185307179586 / 8) * 0.25 * 0.25;
    // Positions round to 2^-24 of a metre, over a surface of 4 m².
    EXPECT_NEAR(support::signed_volume(mesh.vertices, mesh.indices), octagon * (2 + 0.5 * 0.25 / 3),
                1e-6);
}

// Poses of no turn carry everything to where it is, to the bit.
TEST(closed_mesh, poses_at_rest_are_the_rest) {
    cpu::device device;
    const auto tree = of(support::scanned_tree());
    const auto mesh = made(device, tree.skeleton, with(6, 3));
    const host_mesh rest = meshed(device, mesh);
    const host_mesh still = meshed(device, mesh, support::random_poses(tree.skeleton, 0, 1));
    for (std::size_t i = 0; i < rest.vertices.size(); ++i) {
        ASSERT_EQ(rest.vertices[i].position, still.vertices[i].position) << i;
    }
}

// Both surfaces that meet along a collar have the same normals there, so that light sees no edge.
TEST(closed_mesh, collars_have_one_normal) {
    cpu::device device;
    const auto tree = of(support::scanned_tree());
    const auto mesh = made(device, tree.skeleton, with(8, 4));
    const host_mesh rest = meshed(device, mesh);
    const auto places = mesh.places();
    std::unordered_map<std::uint32_t, glm::vec3> normals;
    std::size_t pairs = 0;
    for (const std::uint32_t i : rest.indices) {
        const surface_vertex& v = rest.vertices[i];
        if (v.tangent.w == 0) {
            const auto [at, added] = normals.try_emplace(places[i], v.normal);
            pairs += added ? 0 : 1;
            ASSERT_LE(glm::length(at->second - v.normal), 1e-5f);
        }
    }
    EXPECT_GT(pairs, 1000u);
}

// Parts of a small device: the same triangles over the same places, each part complete.
TEST(closed_mesh, parts_close_together) {
    const auto tree = of(support::scanned_tree());
    cpu::device large;
    cpu::device_options options;
    options.limits.max_buffer_bytes = 1 << 16;
    cpu::device small(options);
    const auto whole = made(large, tree.skeleton, with(5, 3));
    const auto parts = made(small, tree.skeleton, with(5, 3));
    ASSERT_EQ(whole.parts().size(), 1u);
    ASSERT_GE(parts.parts().size(), 8u);
    const auto poses = support::random_poses(tree.skeleton, 0.5, 3);
    const host_mesh a = meshed(large, whole, poses);
    const host_mesh b = meshed(small, parts, poses);
    expect_closed(b, parts.places(), tree.trees, "in parts");
    const auto a_places = whole.places();
    const auto b_places = parts.places();
    ASSERT_EQ(a.indices.size(), b.indices.size());
    for (std::size_t k = 0; k < a.indices.size(); ++k) {
        ASSERT_EQ(a_places[a.indices[k]], b_places[b.indices[k]]) << k;
        ASSERT_EQ(a.vertices[a.indices[k]].position, b.vertices[b.indices[k]].position) << k;
    }
    for (const auto& part : parts.parts()) {
        EXPECT_LE(part.vertices.size_bytes(), options.limits.max_buffer_bytes);
        EXPECT_LE(part.indices.size_bytes(), options.limits.max_buffer_bytes);
    }
    options.limits.max_buffer_bytes = 1024;
    cpu::device tiny(options);
    const auto none = trees::closed_mesh<cpu::device>::create(tiny, tree.skeleton, {});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, error_code::out_of_memory);
}

// A frame sends nothing, asks for no memory and keeps to the contract of every pattern.
TEST(closed_mesh, steady_frames_cost_no_more_than_their_work) {
    using checked = validated<cpu::device>;
    cpu::device inner;
    std::vector<std::string> misuse;
    checked device(inner, [&](std::string_view sentence) { misuse.emplace_back(sentence); });
    const auto tree = of(support::scanned_tree());
    const auto mesh = made(device, tree.skeleton, with(8, 4));
    const auto poses = support::random_poses(tree.skeleton, 0.1, 3);
    const auto buffer = make_buffer<checked, segment_pose>(device, poses);
    ASSERT_TRUE(buffer);
    const device_traffic before = device.traffic();
    ASSERT_TRUE(run(device, [&](auto& r) { mesh.record(r, view<checked>(*buffer)); }));
    EXPECT_EQ(device.traffic().up, before.up);
    EXPECT_EQ(device.traffic().down, before.down);
    EXPECT_TRUE(misuse.empty()) << misuse.front();

    const auto plain = made(inner, tree.skeleton, with(8, 4));
    const auto plain_buffer = make_buffer<cpu::device, segment_pose>(inner, poses);
    ASSERT_TRUE(plain_buffer);
    std::uint64_t allocations[2] = {0, 0};
    for (std::uint64_t& count : allocations) {
        auto recorder = inner.begin();
        ASSERT_TRUE(recorder);
        const std::uint64_t so_far = support::allocations;
        plain.record(*recorder, view<cpu::device>(*plain_buffer));
        count = support::allocations - so_far;
        ASSERT_TRUE(inner.submit(*recorder));
    }
    EXPECT_EQ(allocations[1], 0u);
}

TEST(closed_mesh, refuses_what_it_cannot_make) {
    cpu::device device;
    const auto skeleton = support::built({piece({0, 0, 0}, {0, 2, 0}, 0.25f, 0.25f)});
    for (const auto& options : {with(2, 4), with(1025, 4), with(8, 1), with(8, 1025)}) {
        const auto mesh = trees::closed_mesh<cpu::device>::create(device, skeleton, options);
        ASSERT_FALSE(mesh);
        EXPECT_EQ(mesh.error().code, error_code::bad_input);
    }
    const auto empty = made(device, trees::skeleton{}, with(8, 4));
    EXPECT_EQ(empty.triangles(), 0u);
    EXPECT_TRUE(meshed(device, empty).indices.empty());
}

// ---- The check itself ---------------------------------------------------------------------------

namespace {

host_mesh small_mesh() {
    cpu::device device;
    return meshed(device, made(device, support::built(small_tree({0, 0, 0})), with(6, 3)));
}

/// A tetrahedron over four places from `first` on.
std::vector<std::uint32_t> tetrahedron(std::uint32_t first) {
    std::vector<std::uint32_t> t{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    for (std::uint32_t& i : t) {
        i += first;
    }
    return t;
}

std::vector<std::uint32_t> numbers(std::uint32_t count) {
    std::vector<std::uint32_t> n(count);
    std::iota(n.begin(), n.end(), 0u);
    return n;
}

} // namespace

TEST(surface_topology, finds_a_crack) {
    host_mesh mesh = small_mesh();
    ASSERT_TRUE(support::examine_surface(support::weld(mesh.vertices), mesh.indices).spheres(1));
    // One copy of a vertex one rounding off, as if computed twice in different ways.
    const std::uint32_t at = mesh.indices[mesh.indices.size() / 2];
    float& x = mesh.vertices[at].position.x;
    x = std::nextafter(x, 10.0f);
    mesh.vertices.push_back(small_mesh().vertices[at]);
    mesh.indices[mesh.indices.size() / 2] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    const auto found = support::examine_surface(support::weld(mesh.vertices), mesh.indices);
    EXPECT_FALSE(found.closed());
    EXPECT_GE(found.boundary_edges, 2u);
}

TEST(surface_topology, finds_a_hole) {
    host_mesh mesh = small_mesh();
    mesh.indices.resize(mesh.indices.size() - 3);
    const auto found = support::examine_surface(support::weld(mesh.vertices), mesh.indices);
    EXPECT_FALSE(found.closed());
    EXPECT_EQ(found.boundary_edges, 3u);
    EXPECT_EQ(found.components.at(0).euler(), 1);
}

TEST(surface_topology, finds_a_loose_branch) {
    host_mesh mesh = small_mesh();
    host_mesh loose = small_mesh();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (surface_vertex& v : loose.vertices) {
        v.position += glm::vec3(0.01f, 0.02f, 0.03f);
        mesh.vertices.push_back(v);
    }
    for (const std::uint32_t index : loose.indices) {
        mesh.indices.push_back(index + first);
    }
    const auto found = support::examine_surface(support::weld(mesh.vertices), mesh.indices);
    EXPECT_TRUE(found.closed());
    EXPECT_FALSE(found.spheres(1));
    EXPECT_TRUE(found.spheres(2));
}

TEST(surface_topology, finds_a_tube_in_a_tube_and_a_turned_triangle) {
    const auto places = numbers(9);
    // A branch that only touches: two closed surfaces with one place in common.
    std::vector<std::uint32_t> touching = tetrahedron(0);
    for (const std::uint32_t i : tetrahedron(3)) {
        touching.push_back(i);
    }
    const auto pinched = support::examine_surface(places, touching);
    EXPECT_EQ(pinched.pinched, 1u);
    EXPECT_FALSE(pinched.closed());
    // Two that share a face which both kept.
    std::vector<std::uint32_t> kept = tetrahedron(0);
    for (const std::uint32_t i : tetrahedron(1)) {
        kept.push_back(i);
    }
    EXPECT_EQ(support::examine_surface(places, kept).crowded_edges, 3u);
    std::vector<std::uint32_t> turned = tetrahedron(0);
    std::swap(turned[0], turned[1]);
    EXPECT_EQ(support::examine_surface(places, turned).unoriented_edges, 3u);
    std::vector<std::uint32_t> flat = tetrahedron(0);
    flat[1] = flat[0];
    EXPECT_EQ(support::examine_surface(places, flat).collapsed, 1u);
}

TEST(surface_topology, counts_a_handle) {
    // A torus of 3 x 3 squares.
    std::vector<std::uint32_t> torus;
    for (std::uint32_t i = 0; i < 9; ++i) {
        const std::uint32_t right = i / 3 * 3 + (i + 1) % 3;
        const std::uint32_t up = (i + 3) % 9;
        const std::uint32_t both = up / 3 * 3 + right % 3;
        for (const std::uint32_t v : {i, right, both, i, both, up}) {
            torus.push_back(v);
        }
    }
    const auto found = support::examine_surface(numbers(9), torus);
    EXPECT_TRUE(found.closed()) << describe(found);
    EXPECT_FALSE(found.spheres(1));
    EXPECT_EQ(found.components.at(0).euler(), 0);
}
