// Level of detail of branches: full detail near by, within its errors farther off, without a jump
// in between, down to a handful of triangles, and the same on every backend.

#include "support/devices.hpp"
#include "support/test_trees.hpp"
#include "support/tree_mesh.hpp"

#include <skybark/kernels/cast_shadow.hpp>
#include <skybark/trees/detail.hpp>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using kernels::branch_frame;
using support::all_trees;
using trees::detailed_mesh_options;
using trees::view_detail;

namespace {

template <backend B>
using detailed = trees::detailed_branch_mesh<B>;

const support::test_tree& tree_called(std::string_view name) {
    for (const support::test_tree& tree : all_trees()) {
        if (tree.name == name) {
            return tree;
        }
    }
    throw std::runtime_error("no such tree");
}

/// The scanned tree, or what stands for it.
const char* any_scan() { return all_trees()[all_trees().size() - 2].name.c_str(); }

detailed_mesh_options with(std::uint32_t sides, std::uint32_t rings,
                           branch_frame frame = branch_frame::slerp,
                           padding policy = padding::compact) {
    detailed_mesh_options options;
    options.sides = sides;
    options.rings = rings;
    options.frame = frame;
    options.policy = policy;
    return options;
}

template <class Result>
auto take(Result&& made) {
    if (!made) {
        throw std::runtime_error(made.error().message);
    }
    return *std::move(made);
}

template <backend B, class... Arguments>
void record_now(B& device, const detailed<B>& mesh, const Arguments&... arguments) {
    auto done = run(device, [&](auto& r) { mesh.record(r, arguments...); });
    if (!done) {
        throw std::runtime_error(done.error().message);
    }
}

/// A view of the tree in which it is about this many pixels tall, from the south.
view_detail view_of(const trees::skeleton& tree, float pixels) {
    const auto box = trees::bounds(tree);
    const float height = box.max.y - box.min.y;
    view_detail view;
    view.camera = glm::vec3(0, 0.4f * height, 3 * height);
    view.pixels_per_radian = 3 * pixels;
    return view;
}

bool equal_bytes(const std::vector<surface_vertex>& a, const std::vector<surface_vertex>& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(surface_vertex)) == 0;
}

/// The branch_mesh that it is in full detail.
trees::branch_mesh_options plain_list(const detailed_mesh_options& options) {
    trees::branch_mesh_options like;
    like.sides = options.sides;
    like.rings = options.rings;
    like.frame = options.frame;
    like.form = trees::mesh_form::list;
    like.policy = options.policy;
    return like;
}

/// Triangles whose corners are not all in one place.
std::vector<surface_vertex> without_points(const std::vector<surface_vertex>& triangles) {
    std::vector<surface_vertex> kept;
    for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
        const glm::vec3 p = triangles[i].position;
        if (p != triangles[i + 1].position || p != triangles[i + 2].position) {
            kept.insert(kept.end(), &triangles[i], &triangles[i] + 3);
        }
    }
    return kept;
}

double area_of(const std::vector<surface_vertex>& triangles) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
        const dvec3 a(triangles[i].position);
        sum += glm::length(glm::cross(dvec3(triangles[i + 1].position) - a,
                                      dvec3(triangles[i + 2].position) - a)) /
               2;
    }
    return sum;
}

/// One straight piece of wood along +Y.
trees::skeleton rod(float radius, float length) {
    trees::segment s;
    s.tip = {0, length, 0};
    s.base_radius = s.radius = radius;
    return support::built({s});
}

/// How much of each pixel the mesh covers, of `size` × `size`, drawn with `samples` a side of each.
std::vector<float> coverage(cpu::device& device, const detailed<cpu::device>& mesh,
                            const glm::mat4& to_clip, std::uint32_t size, std::uint32_t samples) {
    const std::uint32_t side = size * samples;
    const auto depth = take(device.create_image({side, side, image_format::depth32f}));
    kernels::scene_record scene{};
    scene.to_shadow = to_clip;
    const auto scene_buffer =
        take(make_buffer<cpu::device, kernels::scene_record>(device, std::span(&scene, 1)));
    auto done = run(device, [&](auto& r) {
        draw_target<cpu::device> target{nullptr, &depth, {}, 1.0f};
        for (const auto& part : mesh.parts()) {
            r.draw(kernels::cast_shadow{},
                   {view<cpu::device>(part.vertices), view<cpu::device>(scene_buffer)}, {},
                   mesh.geometry(part), target, draw_state{});
            target.clear_depth.reset();
        }
    });
    std::vector<float> depths(std::size_t{side} * side);
    if (!done || !device.download(depth, std::as_writable_bytes(std::span(depths)))) {
        throw std::runtime_error("no picture");
    }
    std::vector<float> pixels(std::size_t{size} * size);
    const float each = 1.0f / static_cast<float>(samples * samples);
    for (std::size_t i = 0; i < depths.size(); ++i) {
        const std::size_t x = i % side / samples;
        const std::size_t y = i / side / samples;
        pixels[y * size + x] += depths[i] < 1 ? each : 0;
    }
    return pixels;
}

/// The picture that `view_of(tree, pixels)` describes, 1.3 times as tall as the tree.
glm::mat4 lens_of(const trees::skeleton& tree, const view_detail& seen_from, std::uint32_t size) {
    const auto box = trees::bounds(tree);
    const glm::vec3 middle(0, 0.5f * (box.min.y + box.max.y), 0);
    const float field = 2 * std::atan(static_cast<float>(size) / (2 * seen_from.pixels_per_radian));
    return glm::perspectiveRH_ZO(field, 1.0f, 0.1f, 1000.0f) *
           glm::lookAtRH(seen_from.camera, middle, glm::vec3(0, 1, 0));
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += std::abs(double{a[i]} - double{b[i]});
    }
    return sum / static_cast<double>(a.size());
}

double total(const std::vector<float>& a) {
    double sum = 0;
    for (const float x : a) {
        sum += double{x};
    }
    return sum;
}

double distance_to_line(dvec3 p, dvec3 a, dvec3 b) {
    const dvec3 along = b - a;
    const double l2 = glm::dot(along, along);
    const double t = l2 > 0 ? std::clamp(glm::dot(p - a, along) / l2, 0.0, 1.0) : 0;
    return glm::distance(p, a + along * t);
}

} // namespace

TEST(detail, in_full_it_is_the_branch_mesh_bit_for_bit) {
    cpu::device device;
    for (const char* name : {"quaking_aspen", "wild scan 1"}) {
        const support::test_tree& tree = tree_called(name);
        for (const branch_frame frame : {branch_frame::slerp, branch_frame::rotation_minimising}) {
            for (const padding policy : {padding::compact, padding::degenerate}) {
                const auto options = with(6, 3, frame, policy);
                const auto mesh =
                    take(detailed<cpu::device>::create(device, tree.skeleton, options));
                const auto plain =
                    support::mesh_on(device, trees::layout_branches(tree.skeleton, frame),
                                     plain_list(options))
                        .vertices;
                record_now(device, mesh, view_detail{});
                EXPECT_TRUE(equal_bytes(take(mesh.download(device)).vertices, plain)) << name;
                if (std::string_view(name).starts_with("wild")) {
                    continue; // has segments without radius, which no view makes thick
                }
                // Near by, in a picture of 10^9 pixels: without a permitted error the bits …
                view_detail near = view_of(tree.skeleton, 1e9f);
                near.error = 0;
                record_now(device, mesh, near);
                EXPECT_TRUE(equal_bytes(take(mesh.download(device)).vertices, plain)) << name;
                // … and with one the surface, if fewer triangles where it is straight.
                record_now(device, mesh, view_of(tree.skeleton, 1e9f));
                const auto made = take(mesh.download(device));
                EXPECT_LE(made.vertices.size(), plain.size());
                EXPECT_NEAR(area_of(made.vertices), area_of(plain), 1e-5 * area_of(plain));
            }
        }
    }
}

TEST(detail, what_is_no_view_means_full_detail) {
    cpu::device device;
    const auto& tree = tree_called("quaking_aspen").skeleton;
    const auto mesh = take(detailed<cpu::device>::create(device, tree, with(4, 2)));
    record_now(device, mesh, view_detail{});
    const std::uint64_t full = take(mesh.made(device)).written;
    EXPECT_EQ(full, mesh.triangles());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    std::vector<view_detail> bad(9, view_of(tree, 30));
    record_now(device, mesh, bad[0]);
    ASSERT_LT(take(mesh.made(device)).written, full / 4);
    bad[0].camera.x = nan;
    bad[1].camera.y = infinite;
    bad[2].pixels_per_radian = nan;
    bad[3].pixels_per_radian = -1;
    bad[4].pixels_per_radian = infinite;
    bad[5].error = nan;
    bad[6].error = -1;
    bad[7].thin = -1;
    bad[8].thin = nan;
    for (std::size_t i = 0; i < bad.size(); ++i) {
        record_now(device, mesh, bad[i]);
        EXPECT_EQ(take(mesh.made(device)).written, full) << i;
    }
    // A camera at an end, and far beyond any star.
    view_detail view = view_of(tree, 30);
    view.camera = trees::layout_branches(tree, branch_frame::slerp).ends[7].position;
    record_now(device, mesh, view);
    view.camera = glm::vec3(1e30f);
    record_now(device, mesh, view);
    for (const surface_vertex& v : take(mesh.download(device)).vertices) {
        ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
    }
}

TEST(detail, view_from_says_what_is_wrong) {
    const auto view = trees::view_from(glm::vec3(0, 2, 10), 1000, 1.0f);
    ASSERT_TRUE(view);
    // Half of the picture over the tangent of half the field: 500 / 0.5463024898.
    EXPECT_NEAR(view->pixels_per_radian, 915.2438f, 1e-2f);
    for (const float bad : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), 4.0f}) {
        EXPECT_FALSE(trees::view_from(glm::vec3(0), 1000, bad));
        EXPECT_FALSE(trees::view_from(glm::vec3(std::numeric_limits<float>::infinity()), bad, 1));
    }
    EXPECT_FALSE(trees::view_from(glm::vec3(0), -5, 1));
}

// A rod's outline is within one permitted error of its circle, at every size and on the way from
// one level of the polygon to the next, and its perimeter is that of the full polygon.
TEST(detail, a_rod_is_round_to_within_the_error) {
    cpu::device device;
    constexpr double pi = 3.14159265358979;
    std::size_t fewest = 1000;
    for (const std::uint32_t sides : {96u, 64u, 5u}) {
        const auto mesh = take(detailed<cpu::device>::create(device, rod(0.1f, 1), with(sides, 2)));
        const double perimeter = 2 * sides * std::sin(pi / sides) * 0.1;
        for (double pixels = 0.05; pixels < 300; pixels *= 1.013) {
            view_detail view;
            view.camera = {10, 0, 0};
            view.pixels_per_radian = static_cast<float>(pixels / 0.1 * 10);
            view.thin = 0;
            record_now(device, mesh, view);
            const auto made = take(mesh.download(device));
            // The tube begins after the cap, if there is one; corners at y = 0 in its order.
            std::vector<dvec3> ring;
            for (const surface_vertex& v : made.vertices) {
                const bool side = std::abs(v.normal.y) < 0.5f;
                if (side && v.position.y == 0 &&
                    (ring.empty() || ring.back() != dvec3(v.position))) {
                    ring.emplace_back(v.position);
                }
            }
            ASSERT_GE(ring.size(), 4u);
            double around = 0;
            double off = 0;
            for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
                around += glm::distance(ring[i], ring[i + 1]);
                const double inside = distance_to_line(dvec3(0), ring[i], ring[i + 1]);
                off = std::max({off, std::abs(glm::length(ring[i]) - 0.1), 0.1 - inside});
            }
            fewest = std::min(fewest, ring.size() - 1);
            EXPECT_NEAR(around, perimeter, 1e-6 * perimeter) << sides << ' ' << pixels;
            if (sides > 5) { // five are all that there are
                // The full polygon itself is off by up to (1 - cos(pi / n)).
                const double own = (1 - std::cos(pi / sides)) * pixels;
                EXPECT_LE(off / 0.1 * pixels, std::max(0.25, own) + 1e-4) << sides << ' ' << pixels;
            }
        }
    }
    EXPECT_EQ(fewest, 3u);
}

// A cone's surface is within the error as well, although its tip needs no sides.
TEST(detail, a_cone_is_round_to_within_the_error) {
    cpu::device device;
    trees::segment s;
    s.tip = {0, 1, 0};
    s.base_radius = 0.1f;
    s.radius = 0;
    const auto mesh = take(detailed<cpu::device>::create(device, support::built({s}), with(96, 5)));
    for (const double pixels : {1.0, 5.0, 20.0, 100.0, 400.0}) {
        view_detail view;
        view.camera = {0, 0, 10};
        view.pixels_per_radian = static_cast<float>(pixels / 0.1 * 10);
        record_now(device, mesh, view);
        const auto triangles = take(mesh.download(device)).vertices;
        ASSERT_GE(triangles.size(), 9u);
        for (std::size_t i = 0; i < triangles.size(); i += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                // The middle of an edge is the worst of it. Caps have nothing to be round.
                const dvec3 p = (dvec3(triangles[i + k].position) +
                                 dvec3(triangles[i + (k + 1) % 3].position)) *
                                0.5;
                if (std::abs(triangles[i].normal.y) > 0.5f) {
                    continue;
                }
                const double off = glm::length(dvec3(p.x, 0, p.z)) - 0.1 * (1 - p.y);
                EXPECT_LE(std::abs(off) / 0.1 * pixels, 0.25 + 1e-3) << pixels << ' ' << p.y;
            }
        }
    }
}

// Farther off there are never more triangles (but for 1 %: where a corner is left out a little
// later than the widening of another branch asks for it), and in the end next to none.
TEST(detail, triangles_fall_with_the_distance) {
    cpu::device device;
    for (const char* name : {"quaking_aspen", "black_tupelo"}) {
        const trees::skeleton& tree = tree_called(name).skeleton;
        const auto mesh = take(detailed<cpu::device>::create(device, tree, with(12, 5)));
        std::uint64_t before = mesh.triangles();
        for (float pixels = 4096; pixels > 0.01f; pixels *= 0.6f) {
            record_now(device, mesh, view_of(tree, pixels));
            const auto made = take(mesh.made(device));
            EXPECT_EQ(made.written, made.required);
            EXPECT_LE(static_cast<double>(made.written), 1.01 * static_cast<double>(before))
                << name << ' ' << pixels;
            before = made.written;
        }
        // Of the n-th thickest chains those below a rank of 2 / n stay, three sides each.
        std::size_t chains = 0;
        for (std::size_t i = 0; i < tree.size(); ++i) {
            const std::uint32_t p = tree.parent[i];
            chains += p == trees::none || tree.continuation[p] != i ? 1 : 0;
        }
        EXPECT_LE(static_cast<double>(before), 6 * (3 + 2 * std::log(static_cast<double>(chains))))
            << name;
        EXPECT_GE(before, 6u) << name;
    }
}

// The picture changes without a jump as only the detail does, by steps of half a percent of the
// distance, drawn from one place.
TEST(detail, nothing_jumps) {
    cpu::device device;
    const auto& tree = tree_called("quaking_aspen").skeleton;
    const auto mesh = take(detailed<cpu::device>::create(device, tree, with(12, 5)));
    for (const float pixels : {100.0f, 30.0f}) {
        const auto size = static_cast<std::uint32_t>(1.3f * pixels);
        const glm::mat4 lens = lens_of(tree, view_of(tree, pixels), size);
        std::vector<double> steps;
        std::vector<float> before;
        for (int i = 0; i < 60; ++i) {
            const float closer = std::pow(1.005f, static_cast<float>(i));
            record_now(device, mesh, view_of(tree, pixels * closer));
            auto now = coverage(device, mesh, lens, size, 6);
            if (!before.empty()) {
                steps.push_back(255 * mean_difference(before, now));
            }
            before = std::move(now);
        }
        std::sort(steps.begin(), steps.end());
        const double median = steps[steps.size() / 2];
        RecordProperty("median_" + std::to_string(size), std::to_string(median));
        RecordProperty("largest_" + std::to_string(size), std::to_string(steps.back()));
        EXPECT_LE(steps.back(), 0.5) << pixels;
        EXPECT_LE(steps.back(), 3 * median) << pixels;
    }
}

// The picture is that of full detail, and covers as much. What stays of branches that cover a
// fraction c of a pixel is c / (2 · thin) pieces, and where they are is chance: their number has
// the standard deviation of its root, so the pixel has sqrt(2 · thin · c), at most. (Overlaps are
// as many as before.) Thick branches may be off by the error at both sides.
TEST(detail, looks_like_full_detail) {
    cpu::device device;
    for (const char* name : {"quaking_aspen", "black_tupelo"}) {
        const trees::skeleton& tree = tree_called(name).skeleton;
        const auto mesh = take(detailed<cpu::device>::create(device, tree, with(8, 4)));
        for (const float pixels : {100.0f, 30.0f, 8.0f}) {
            const view_detail view = view_of(tree, pixels);
            const auto size = static_cast<std::uint32_t>(1.3f * pixels);
            const std::uint32_t samples = std::max(4u, 600 / size);
            const glm::mat4 lens = lens_of(tree, view, size);
            record_now(device, mesh, view);
            const auto seen = coverage(device, mesh, lens, size, samples);
            record_now(device, mesh, view_detail{});
            const auto full = coverage(device, mesh, lens, size, samples);
            double deviation = 0;
            for (const float c : full) {
                deviation += std::sqrt(double{2 * view.thin * c * (1 - c)});
            }
            deviation /= static_cast<double>(full.size());
            const double difference = mean_difference(seen, full);
            RecordProperty(name + std::to_string(size), std::to_string(255 * difference));
            EXPECT_LE(difference, deviation) << name << ' ' << pixels;
            // A tree of 8 pixels stands on a dozen of branches.
            EXPECT_NEAR(total(seen), total(full), (pixels > 10 ? 0.12 : 0.2) * total(full))
                << name << ' ' << pixels;
        }
    }
}

namespace {

/// Positions to 2e-5 of the tree's height, as branches without level of detail; normals to 2e-3. A
/// device that rounds otherwise may make another choice where two are equally good, and then has
/// another number of triangles: by no more than 0.2 %.
void expect_like_the_cpus(const std::vector<surface_vertex>& actual,
                          const std::vector<surface_vertex>& cpus, float height,
                          const std::string& what) {
    EXPECT_NEAR(static_cast<double>(actual.size()), static_cast<double>(cpus.size()),
                0.002 * static_cast<double>(cpus.size()))
        << what;
    if (actual.size() != cpus.size()) {
        return;
    }
    for (std::size_t i = 0; i < cpus.size(); ++i) {
        ASSERT_LE(glm::distance(actual[i].position, cpus[i].position), 2e-5f * height) << what;
        ASSERT_LE(glm::distance(actual[i].normal, cpus[i].normal), 2e-3f) << what;
        ASSERT_LE(glm::distance(actual[i].tangent, cpus[i].tangent), 2e-3f) << what;
        ASSERT_NEAR(actual[i].u, cpus[i].u, 1e-5f) << what;
    }
}

/// Full, near, middling and far, at rest and moved, on a device and on the CPU.
template <backend B>
void check_against_the_cpu(B& device) {
    cpu::device cpu;
    for (const char* name : {any_scan(), "wild scan 1"}) {
        const trees::skeleton& tree = tree_called(name).skeleton;
        const float height = std::max(1.0f, trees::height(tree));
        support::random_source random(5);
        std::vector<segment_pose> poses(tree.size());
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const glm::dvec3 axis = random.direction() * 0.05;
            poses[i].rotation = glm::vec4(glm::vec3(axis), std::sqrt(1 - 0.05f * 0.05f));
            poses[i].base = tree.position[i];
            poses[i].shift = glm::vec3(random.direction() * 0.02);
        }
        const auto there = take(make_buffer<B, segment_pose>(device, std::span(poses)));
        const auto here = take(make_buffer<cpu::device, segment_pose>(cpu, std::span(poses)));
        for (const padding policy : {padding::compact, padding::degenerate}) {
            const auto options = with(8, 4, branch_frame::slerp, policy);
            const auto a = take(detailed<B>::create(device, tree, options));
            const auto b = take(detailed<cpu::device>::create(cpu, tree, options));
            for (const float pixels : {300.0f, 10.0f}) {
                const view_detail seen_from = view_of(tree, pixels);
                const std::string what = std::string(name) + ' ' + std::to_string(pixels);
                record_now(device, a, seen_from);
                record_now(cpu, b, seen_from);
                const auto rest = take(b.download(cpu)).vertices;
                expect_like_the_cpus(take(a.download(device)).vertices, rest, height, what);
                record_now(device, a, view<B>(there), seen_from);
                record_now(cpu, b, view<cpu::device>(here), seen_from);
                const auto moved = take(b.download(cpu)).vertices;
                expect_like_the_cpus(take(a.download(device)).vertices, moved, height,
                                     what + ", moved");
                EXPECT_FALSE(equal_bytes(rest, moved));
            }
        }
    }
}

} // namespace

TEST(detail, opengl_makes_what_the_cpu_makes) {
    support::with_device("opengl", [](auto& device) { check_against_the_cpu(device); });
}

TEST(detail, vulkan_makes_what_the_cpu_makes) {
    support::with_device("vulkan", [](auto& device) { check_against_the_cpu(device); });
}

// Padding only adds triangles of zero bytes.
TEST(detail, both_paddings_have_the_same_triangles) {
    cpu::device device;
    const auto& tree = tree_called("quaking_aspen").skeleton;
    std::vector<surface_vertex> of[2];
    for (const padding policy : {padding::compact, padding::degenerate}) {
        const auto options = with(8, 4, branch_frame::slerp, policy);
        const auto mesh = take(detailed<cpu::device>::create(device, tree, options));
        record_now(device, mesh, view_of(tree, 60));
        const bool padded = policy == padding::degenerate;
        of[padded ? 1 : 0] = without_points(take(mesh.download(device)).vertices);
        if (padded) {
            EXPECT_EQ(take(mesh.made(device)).written, mesh.triangles());
        }
    }
    EXPECT_GT(of[0].size(), 3000u);
    EXPECT_TRUE(equal_bytes(of[0], of[1]));
}

// Unmoved poses give the bits at rest; the tree and the camera moved alike, as many triangles.
TEST(detail, follows_poses) {
    cpu::device device;
    const auto& tree = tree_called("quaking_aspen").skeleton;
    const auto mesh = take(detailed<cpu::device>::create(device, tree, with(8, 4)));
    std::vector<segment_pose> poses(tree.size());
    const auto unmoved = take(make_buffer<cpu::device, segment_pose>(device, std::span(poses)));
    for (segment_pose& p : poses) {
        p.shift = {16, 0, 0};
    }
    const auto moved = take(make_buffer<cpu::device, segment_pose>(device, std::span(poses)));
    view_detail seen_from = view_of(tree, 80);
    record_now(device, mesh, seen_from);
    const auto rest = take(mesh.download(device)).vertices;
    record_now(device, mesh, view<cpu::device>(unmoved), seen_from);
    EXPECT_TRUE(equal_bytes(take(mesh.download(device)).vertices, rest));
    seen_from.camera.x += 16;
    record_now(device, mesh, view<cpu::device>(moved), seen_from);
    const auto made = take(mesh.made(device));
    // Rounding may settle a choice between levels the other way: a few in thousands.
    EXPECT_NEAR(static_cast<double>(made.written), static_cast<double>(rest.size()) / 3,
                0.002 * static_cast<double>(rest.size()));
    glm::dvec3 a(0);
    glm::dvec3 b(0);
    const auto there = take(mesh.download(device)).vertices;
    for (const surface_vertex& v : rest) {
        a += glm::dvec3(v.position) / static_cast<double>(rest.size());
    }
    for (const surface_vertex& v : there) {
        b += glm::dvec3(v.position) / static_cast<double>(there.size());
    }
    EXPECT_NEAR(b.x - a.x, 16, 0.02);
}

TEST(detail, too_little_room_is_reported_and_grows) {
    cpu::device device;
    const auto& tree = tree_called("quaking_aspen").skeleton;
    auto options = with(8, 4);
    const auto whole = take(detailed<cpu::device>::create(device, tree, options));
    options.room = 1000;
    auto mesh = take(detailed<cpu::device>::create(device, tree, options));
    EXPECT_EQ(mesh.triangles(), 1000u);
    const view_detail seen_from = view_of(tree, 100);
    record_now(device, whole, seen_from);
    record_now(device, mesh, seen_from);
    const auto all = take(whole.download(device)).vertices;
    auto made = take(mesh.made(device));
    EXPECT_EQ(made.written, 1000u);
    EXPECT_EQ(made.required, all.size() / 3);
    const auto some = take(mesh.download(device)).vertices;
    EXPECT_TRUE(equal_bytes(some, {all.begin(), all.begin() + 3000}));
    EXPECT_TRUE(take(mesh.grow(device)));
    record_now(device, mesh, seen_from);
    EXPECT_FALSE(take(mesh.grow(device)));
    EXPECT_TRUE(equal_bytes(take(mesh.download(device)).vertices, all));
}

// In chunks the triangles are the same in full detail. Farther off only chains that are cut differ.
TEST(detail, works_in_chunks) {
    cpu::device_options small;
    small.limits.max_buffer_bytes = 1 << 20;
    cpu::device device(small);
    const auto& tree = tree_called("quaking_aspen").skeleton;
    const auto mesh = take(detailed<cpu::device>::create(device, tree, with(8, 4)));
    EXPECT_GT(mesh.parts().size(), 10u);
    record_now(device, mesh, view_detail{});
    const auto plain = support::mesh_on(device, trees::layout_branches(tree, branch_frame::slerp),
                                        plain_list(with(8, 4)));
    EXPECT_TRUE(equal_bytes(take(mesh.download(device)).vertices, plain.vertices));
    const std::uint64_t up = device.traffic().up;
    record_now(device, mesh, view_of(tree, 50));
    EXPECT_EQ(device.traffic().up, up);
    const auto made = take(mesh.made(device));
    EXPECT_LT(made.written, mesh.triangles() / 8);
}

TEST(detail, options_out_of_range_are_errors) {
    cpu::device device;
    const trees::skeleton tree = rod(0.1f, 1);
    const auto complaint = [&](std::uint32_t sides, std::uint32_t rings) {
        const auto mesh = detailed<cpu::device>::create(device, tree, with(sides, rings));
        return mesh ? std::string() : mesh.error().message;
    };
    EXPECT_EQ(complaint(2, 4), "A branch mesh cannot have 2 sides; it takes 3 to 1024.");
    EXPECT_EQ(complaint(1025, 4), "A branch mesh cannot have 1025 sides; it takes 3 to 1024.");
    EXPECT_EQ(complaint(8, 1), "A branch mesh cannot have 1 rings; it takes 2 to 1024.");
    EXPECT_EQ(complaint(8, 1025), "A branch mesh cannot have 1025 rings; it takes 2 to 1024.");
    EXPECT_EQ(complaint(3, 2), "");
    const auto layout = trees::layout_branches(tree, branch_frame::slerp);
    EXPECT_FALSE(detailed<cpu::device>::create(device, layout, {}, {}));
    EXPECT_TRUE(detailed<cpu::device>::create(device, trees::skeleton{}, {}));
}
