// Leaves on trees: where they are placed, and the same mesh from every backend in every form.

#include "support/devices.hpp"
#include "support/test_trees.hpp"

#include <skybark/conformance/leaf_reference.hpp>
#include <skybark/trees/leaf_layout.hpp>
#include <skybark/trees/leaf_mesh.hpp>

#include <gtest/gtest.h>
#include <numeric>

using namespace skybark;
using glm::dvec3;
using support::all_trees;
using trees::leaf_mesh_options;
using trees::mesh_form;

namespace reference = skybark::conformance::reference;

namespace {

std::vector<leaf> some_leaves(const trees::skeleton& on, std::size_t most) {
    trees::leaf_options options;
    options.most = most;
    return trees::place_leaves(on, options);
}

/// Poses that turn every segment about its base, and wind in all of them.
struct blown {
    std::vector<segment_pose> poses;
    std::vector<glm::vec4> air;

    explicit blown(const trees::skeleton& tree, std::uint32_t seed = 3) {
        support::random_source random(seed);
        for (std::size_t i = 0; i < tree.size(); ++i) {
            segment_pose pose;
            pose.base = tree.position[i];
            pose.shift = glm::vec3(random.direction() * random.between(0, 0.3));
            pose.rotation = glm::vec4(random.rotation(1));
            poses.push_back(pose);
            const double speed = random.between(0, 15);
            air.emplace_back(glm::vec3(random.direction() * speed), static_cast<float>(speed));
        }
    }
};

template <backend B>
trees::host_mesh mesh_of(B& device, std::span<const leaf> leaves, leaf_mesh_options options,
                         const blown* wind, const trees::view_detail& seen = {}) {
    auto mesh = trees::leaf_mesh<B>::create(device, leaves, options);
    EXPECT_TRUE(mesh) << mesh.error().message;
    trees::leaf_motion<B> motion;
    std::optional<typename B::buffer> poses, air;
    if (wind != nullptr) {
        poses = *make_buffer<B, segment_pose>(device, wind->poses);
        air = *make_buffer<B, glm::vec4>(device, wind->air);
        motion = {view<B>(*poses), view<B>(*air), 4.2};
    }
    auto done = run(device, [&](auto& r) { mesh->record(r, motion, seen); });
    EXPECT_TRUE(done) << done.error().message;
    auto down = mesh->download(device);
    EXPECT_TRUE(down) << down.error().message;
    return *std::move(down);
}

/// The corners of all triangles in order, without those that have no area.
std::vector<surface_vertex> corners_of(const trees::host_mesh& mesh) {
    std::vector<surface_vertex> corners;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const surface_vertex& a = mesh.vertices[mesh.indices[t]];
        const surface_vertex& b = mesh.vertices[mesh.indices[t + 1]];
        const surface_vertex& c = mesh.vertices[mesh.indices[t + 2]];
        if (a.position != b.position || b.position != c.position) {
            corners.insert(corners.end(), {a, b, c});
        }
    }
    return corners;
}

bool same_bits(std::span<const surface_vertex> a, std::span<const surface_vertex> b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

double distance_to_segment(const trees::skeleton& tree, const leaf& l) {
    const dvec3 a(tree.position[l.carrier]);
    const dvec3 axis = dvec3(tree.tip(l.carrier)) - a;
    const double l2 = glm::dot(axis, axis);
    const dvec3 p(l.position);
    const double t = l2 > 0 ? std::clamp(glm::dot(p - a, axis) / l2, 0.0, 1.0) : 0;
    return glm::distance(p, a + axis * t);
}

/// The same formulas of + - * / and sqrt, but a driver may multiply by constants in another order:
/// a few roundings apart, positions 2e-6 of the tree's height and directions 2e-6.
void expect_like_the_cpus(const trees::host_mesh& actual, const trees::host_mesh& cpus,
                          double height, const std::string& what) {
    ASSERT_EQ(actual.vertices.size(), cpus.vertices.size()) << what;
    ASSERT_EQ(actual.indices, cpus.indices) << what;
    for (std::size_t i = 0; i < cpus.vertices.size(); ++i) {
        const surface_vertex& a = actual.vertices[i];
        const surface_vertex& b = cpus.vertices[i];
        ASSERT_LE(glm::distance(a.position, b.position), 2e-6 * height) << what << ' ' << i;
        ASSERT_LE(glm::distance(a.normal, b.normal), 2e-6f) << what << ' ' << i;
        ASSERT_LE(glm::distance(a.tangent, b.tangent), 2e-6f) << what << ' ' << i;
    }
}

template <backend B>
void check_backend(B& device) {
    cpu::device cpu;
    for (const support::test_tree& tree : all_trees()) {
        const double height = std::max(1.0, double{trees::height(tree.skeleton)});
        const auto leaves = some_leaves(tree.skeleton, 2000);
        ASSERT_GT(leaves.size(), 100u) << tree.name;
        const blown wind(tree.skeleton);
        for (const leaf_mesh_options& options :
             {leaf_mesh_options{}, leaf_mesh_options{mesh_form::list, padding::compact},
              leaf_mesh_options{mesh_form::list, padding::degenerate}}) {
            for (const float pixels : {0.0f, 300.0f}) {
                trees::view_detail seen;
                seen.camera = {0, 2, 20};
                seen.pixels_per_radian = pixels;
                expect_like_the_cpus(mesh_of(device, leaves, options, &wind, seen),
                                     mesh_of(cpu, leaves, options, &wind, seen), height,
                                     tree.name + (pixels > 0 ? ", from far" : ""));
                if (::testing::Test::HasFatalFailure()) {
                    return;
                }
            }
        }
    }
}

} // namespace

TEST(leaves, opengl_has_the_cpus_leaves) {
    support::with_device("opengl", [](auto& device) { check_backend(device); });
}
TEST(leaves, vulkan_has_the_cpus_leaves) {
    support::with_device("vulkan", [](auto& device) { check_backend(device); });
}

TEST(leaves, rings_and_both_paddings_are_the_same_triangles) {
    cpu::device device;
    for (const support::test_tree& tree : all_trees()) {
        const auto leaves = some_leaves(tree.skeleton, 3000);
        const blown wind(tree.skeleton);
        const auto rings = mesh_of(device, leaves, {}, &wind);
        ASSERT_EQ(rings.indices.size(), 18 * leaves.size());
        const auto expected = corners_of(rings);
        for (const padding policy : {padding::compact, padding::degenerate}) {
            const auto list = mesh_of(device, leaves, {mesh_form::list, policy}, &wind);
            EXPECT_TRUE(same_bits(corners_of(list), expected)) << tree.name;
        }
        // From far: the same list, whether or not the spare triangles are in it.
        trees::view_detail seen;
        seen.camera = {0, 5, 60};
        seen.pixels_per_radian = 400;
        const auto far = mesh_of(device, leaves, {mesh_form::list, padding::compact}, &wind, seen);
        EXPECT_LT(far.indices.size(), 18 * leaves.size()) << tree.name;
        EXPECT_TRUE(
            same_bits(corners_of(mesh_of(device, leaves, {mesh_form::list, padding::degenerate},
                                         &wind, seen)),
                      corners_of(far)))
            << tree.name;
    }
}

// The mesh is where the reference has the same leaf: 1e-5 of the tree's height.
TEST(leaves, mesh_is_where_the_reference_says) {
    cpu::device device;
    for (const support::test_tree& tree : all_trees()) {
        const auto leaves = some_leaves(tree.skeleton, 1000);
        const blown wind(tree.skeleton);
        const auto mesh = mesh_of(device, leaves, {}, &wind);
        kernels::leaf_blade kernel;
        kernel.time = kernels::flutter_time(4.2);
        const double height = std::max(1.0, double{trees::height(tree.skeleton)});
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const std::uint32_t carrier = leaves[i].carrier;
            const auto now =
                reference::leaf_now(kernel, leaves[i], wind.poses[carrier], wind.air[carrier]);
            for (std::size_t k = 0; k < 10; ++k) {
                ASSERT_LE(glm::distance(dvec3(mesh.vertices[10 * i + k].position),
                                        now.corners[k].position),
                          1e-5 * height)
                    << tree.name << ", leaf " << i;
            }
        }
    }
}

TEST(leaves, at_rest_they_are_where_they_were_placed) {
    cpu::device device;
    const auto leaves = some_leaves(all_trees()[0].skeleton, 500);
    const auto mesh = mesh_of(device, leaves, {}, nullptr);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        EXPECT_EQ(mesh.vertices[10 * i].position, leaves[i].position);
    }
}

TEST(leaves, grow_on_last_segments_and_on_the_bark) {
    for (const support::test_tree& tree : all_trees()) {
        trees::leaf_options options;
        options.per_twig = 3;
        const auto leaves = trees::place_leaves(tree.skeleton, options);
        std::size_t ends = 0;
        for (const std::uint32_t children : tree.skeleton.child_count) {
            ends += children == 0 ? 1 : 0;
        }
        EXPECT_NEAR(static_cast<double>(leaves.size()), 3.0 * static_cast<double>(ends), 1);
        for (std::size_t i = 0; i < leaves.size(); i += 1 + leaves.size() / 20'000) {
            const leaf& l = leaves[i];
            ASSERT_LT(l.carrier, tree.skeleton.size());
            ASSERT_EQ(tree.skeleton.child_count[l.carrier], 0u) << tree.name;
            const float thickest =
                std::max(tree.skeleton.base_radius[l.carrier], tree.skeleton.radius[l.carrier]);
            const double size = std::max(1.0, double{glm::length(l.position)});
            ASSERT_LE(distance_to_segment(tree.skeleton, l), thickest + 1e-5 * size) << tree.name;
            ASSERT_NEAR(glm::length(l.orientation), 1, 1e-6);
            ASSERT_GE(l.length, 0.08f * 0.749f);
            ASSERT_LE(l.length, 0.08f * 1.251f);
            ASSERT_NEAR(l.width, 0.7f * l.length, 1e-7);
        }
    }
}

/// Whether segment `i` is one of the last `reach` metres' of a chain that ends without children.
bool is_within(const trees::skeleton& tree, std::uint32_t i, double reach) {
    double beyond = 0;
    while (tree.continuation[i] != trees::none) {
        i = tree.continuation[i];
        beyond += double{tree.length[i]};
    }
    return tree.child_count[i] == 0 && beyond <= reach + 1e-4;
}

TEST(leaves, of_species_grow_along_their_twigs) {
    for (const trees::species_entry& species : trees::all_species()) {
        const auto of_species = [&](const support::test_tree& t) { return t.name == species.name; };
        const auto& tree =
            std::find_if(all_trees().begin(), all_trees().end(), of_species)->skeleton;
        trees::leaf_options options = trees::leaves_of(species);
        const auto leaves = trees::place_leaves(tree, options);
        EXPECT_GE(leaves.size(), 10'000u) << species.name;
        EXPECT_LE(leaves.size(), 1'000'000u) << species.name;
        std::size_t on_ends = 0;
        std::size_t checked = 0;
        for (std::size_t i = 0; i < leaves.size(); i += 1 + leaves.size() / 20'000) {
            const leaf& l = leaves[i];
            ASSERT_TRUE(is_within(tree, l.carrier, options.reach)) << species.name;
            ++checked;
            on_ends += tree.child_count[l.carrier] == 0 ? 1 : 0;
        }
        if (species.parameters.level[species.parameters.levels - 1].curve_res > 1) {
            EXPECT_LT(on_ends, checked) << species.name; // along the twig, not at its end
        }
        if (leaves.size() > 200'000) {
            continue;
        }
        // Twice as many of half the area.
        options.multiplier = 2;
        const auto more = trees::place_leaves(tree, options);
        EXPECT_NEAR(static_cast<double>(more.size()), 2.0 * static_cast<double>(leaves.size()), 1);
        const auto sum = [&](const std::vector<leaf>& of) {
            const auto area = trees::leaf_area(of, tree.size());
            return std::accumulate(area.begin(), area.end(), 0.0);
        };
        EXPECT_NEAR(sum(more), sum(leaves), 0.02 * sum(leaves)) << species.name;
    }
}

TEST(leaves, upper_faces_look_to_the_sky_where_they_are_told_to) {
    const auto& tree = all_trees()[0].skeleton;
    trees::leaf_options options;
    options.light = 1;
    options.disorder = 0;
    options.droop = 1; // hanging leaves have no upper side
    for (const leaf& l : trees::place_leaves(tree, options)) {
        const dvec3 y = reference::quaternion_of(l.orientation) * dvec3(0, 1, 0);
        ASSERT_NEAR(y.y, -1, 1e-5);
    }
    options.droop = 0.2f;
    for (const leaf& l : trees::place_leaves(tree, options)) {
        const glm::dquat q = reference::quaternion_of(l.orientation);
        const dvec3 y = q * dvec3(0, 1, 0);
        const dvec3 z = q * dvec3(0, 0, 1);
        // As upright as a face across y can be: sin of the midrib's angle to the vertical.
        if (std::abs(y.y) < 0.99) {
            ASSERT_NEAR(z.y, std::sqrt(1 - y.y * y.y), 1e-4);
        }
    }
}

TEST(leaves, spirals_turn_by_the_golden_angle) {
    trees::segment stem;
    stem.tip = {0, 1, 0};
    stem.base_radius = stem.radius = 0.01f;
    const auto tree = support::built({stem});
    trees::leaf_options options;
    options.per_twig = 30;
    const auto leaves = trees::place_leaves(tree, options);
    ASSERT_EQ(leaves.size(), 30u);
    const double golden = 3.14159265358979 * (3 - std::sqrt(5.0));
    for (std::size_t i = 0; i + 1 < leaves.size(); ++i) {
        const dvec3 a = glm::normalize(dvec3(leaves[i].position.x, 0, leaves[i].position.z));
        const dvec3 b =
            glm::normalize(dvec3(leaves[i + 1].position.x, 0, leaves[i + 1].position.z));
        EXPECT_NEAR(glm::dot(a, b), std::cos(golden), 1e-4);
        EXPECT_LT(leaves[i + 1].position.y, leaves[i].position.y);
    }
    options.arrangement = trees::leaf_arrangement::alternate;
    const auto sides = trees::place_leaves(tree, options);
    options.arrangement = trees::leaf_arrangement::opposite;
    const auto pairs = trees::place_leaves(tree, options);
    for (std::size_t i = 0; i + 1 < 30; ++i) {
        EXPECT_NEAR(sides[i].position.x, -sides[i + 1].position.x, 1e-6);
        EXPECT_NEAR(sides[i].position.z, -sides[i + 1].position.z, 1e-6);
        if (i % 2 == 0) {
            EXPECT_EQ(pairs[i].position.y, pairs[i + 1].position.y);
            EXPECT_NEAR(pairs[i].position.x, -pairs[i + 1].position.x, 1e-6);
        }
    }
}

TEST(leaves, the_same_seed_gives_the_same_and_another_gives_others) {
    const auto& tree = all_trees()[2].skeleton;
    trees::leaf_options options;
    const auto a = trees::place_leaves(tree, options);
    const auto b = trees::place_leaves(tree, options);
    options.seed = 2;
    const auto c = trees::place_leaves(tree, options);
    ASSERT_EQ(a.size(), b.size());
    ASSERT_EQ(a.size(), c.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(leaf)), 0);
    EXPECT_NE(std::memcmp(a.data(), c.data(), a.size() * sizeof(leaf)), 0);
}

TEST(leaves, numbers_that_make_no_leaves) {
    const auto& tree = all_trees()[2].skeleton;
    EXPECT_TRUE(trees::place_leaves({}, {}).empty());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float bad : {0.0f, -1.0f, nan, std::numeric_limits<float>::infinity()}) {
        trees::leaf_options options;
        options.per_twig = bad;
        EXPECT_TRUE(trees::place_leaves(tree, options).empty()) << bad;
        options = {};
        options.length = bad;
        EXPECT_TRUE(trees::place_leaves(tree, options).empty()) << bad;
        options = {};
        options.multiplier = bad;
        EXPECT_TRUE(trees::place_leaves(tree, options).empty()) << bad;
    }
    trees::leaf_options options;
    options.most = 0;
    EXPECT_TRUE(trees::place_leaves(tree, options).empty());
    options.most = 1000;
    options.per_twig = 1e30f; // thinned out evenly: on many twigs, and never more
    const auto leaves = trees::place_leaves(tree, options);
    EXPECT_LE(leaves.size(), 1000u);
    EXPECT_GE(leaves.size(), 999u);
    EXPECT_GT(leaves.back().carrier, leaves.front().carrier + 100);
}

TEST(leaves, area_and_mass_of_the_segments) {
    std::vector<leaf> leaves(3);
    for (leaf& l : leaves) {
        l.width = 0.04f;
        l.length = 0.05f;
    }
    leaves[1].carrier = leaves[2].carrier = 2;
    const auto area = trees::leaf_area(leaves, 3);
    const double one = 0.04 * 0.05 / std::sqrt(2.0);
    ASSERT_EQ(area.size(), 3u);
    EXPECT_NEAR(area[0], one, 1e-9);
    EXPECT_EQ(area[1], 0.0f);
    EXPECT_NEAR(area[2], 2 * one, 1e-9);
    const auto mass = trees::leaf_mass(leaves, 3, 0.5f, 0.2f);
    EXPECT_NEAR(mass[2], 2 * one * 0.5 * 0.2, 1e-9);
    EXPECT_EQ(trees::leaf_area(leaves, 1).size(), 1u); // carriers beyond are left out
}

TEST(leaves, none_and_chunks) {
    cpu::device whole;
    EXPECT_TRUE(mesh_of(whole, {}, {}, nullptr).vertices.empty());
    EXPECT_TRUE(mesh_of(whole, {}, {mesh_form::list}, nullptr).vertices.empty());
    const auto leaves = some_leaves(all_trees()[1].skeleton, 1000);
    cpu::device_options small;
    small.limits.max_buffer_bytes = 100'000;
    cpu::device chunked(small);
    for (const mesh_form form : {mesh_form::rings, mesh_form::list}) {
        const auto a = mesh_of(whole, leaves, {form}, nullptr);
        const auto b = mesh_of(chunked, leaves, {form}, nullptr);
        EXPECT_TRUE(same_bits(a.vertices, b.vertices));
        EXPECT_EQ(a.indices, b.indices);
    }
    small.limits.max_buffer_bytes = 300;
    cpu::device tiny(small);
    const auto made = trees::leaf_mesh<cpu::device>::create(tiny, leaves, {});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::out_of_memory);
}

TEST(leaves, room_grows_to_what_is_seen) {
    const auto leaves = some_leaves(all_trees()[1].skeleton, 1000);
    trees::leaf_mesh_options options;
    options.form = mesh_form::list;
    for (const std::uint64_t chunk : {std::uint64_t{1} << 30, std::uint64_t{100'000}}) {
        cpu::device_options limits;
        limits.limits.max_buffer_bytes = chunk;
        cpu::device device(limits);
        const auto create = [&](std::uint64_t room) {
            options.room = room;
            auto made = trees::leaf_mesh<cpu::device>::create(device, leaves, options);
            EXPECT_TRUE(made) << made.error().message;
            return *std::move(made);
        };
        const auto made_by = [&](trees::leaf_mesh<cpu::device>& mesh) {
            EXPECT_TRUE(run(device, [&](auto& r) { mesh.record(r); }));
            return *mesh.download(device);
        };
        auto full = create(0);
        EXPECT_EQ(full.triangles(), 6 * leaves.size());
        const auto wanted = made_by(full);
        EXPECT_FALSE(*full.grow(device));
        auto scant = create(1000);
        EXPECT_GE(scant.triangles(), 1000u);
        EXPECT_LT(scant.triangles(), 1000u + 100);
        EXPECT_EQ(made_by(scant).indices.size(), 3 * scant.triangles()); // what fits, whole
        EXPECT_TRUE(*scant.grow(device));
        EXPECT_TRUE(same_bits(made_by(scant).vertices, wanted.vertices));
        EXPECT_FALSE(*scant.grow(device));
        EXPECT_LE(create(1'000'000).triangles(), 6 * leaves.size());
    }
}

TEST(leaves, pictures_have_an_outline_within_the_octagon) {
    using trees::leaf_shape;
    for (const leaf_shape shape :
         {leaf_shape::ovate, leaf_shape::lanceolate, leaf_shape::round, leaf_shape::lobed}) {
        const auto picture = trees::draw_leaf(shape, 128);
        ASSERT_EQ(picture.rgba.size(), 4u * 128 * 128);
        const auto alpha = [&](std::size_t x, std::size_t y) {
            return int{picture.rgba[(y * 128 + x) * 4 + 3]};
        };
        int beyond = 0;
        for (std::size_t i = 0; i < 128; ++i) {
            EXPECT_EQ(alpha(0, i) + alpha(127, i) + alpha(i, 127), 0);
            EXPECT_EQ(alpha(i, 20), alpha(127 - i, 20)); // both sides alike
            for (std::size_t j = 0; j < 128; ++j) {
                // The octagon's slanted sides: |x| + (√2 - 1) |y| ≤ 1 and the like.
                const double x = std::abs((static_cast<double>(i) + 0.5) / 64 - 1);
                const double y = std::abs((static_cast<double>(j) + 0.5) / 64 - 1);
                const double t = std::sqrt(2.0) - 1;
                const bool outside = x + t * y > 1.02 || y + t * x > 1.02;
                beyond += outside && alpha(i, j) > 128 ? 1 : 0;
            }
        }
        EXPECT_EQ(beyond, 0) << static_cast<int>(shape);
        EXPECT_GT(alpha(63, 2), 128); // the stalk
        EXPECT_GT(alpha(63, 70), 250);
        EXPECT_GT(picture.cover(), 0.35);
        EXPECT_LT(picture.cover(), 0.95);
        const auto turned = trees::turned_over(picture);
        EXPECT_EQ(turned.rgba[(125 * 128 + 63) * 4 + 3], picture.rgba[(2 * 128 + 63) * 4 + 3]);
        EXPECT_EQ(trees::turned_over(turned).rgba, picture.rgba);
    }
    EXPECT_EQ(trees::draw_leaf(leaf_shape::ovate, 0).width, 1u);
}
