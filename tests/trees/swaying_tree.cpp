// Whole trees: wind, sway, branches, bark and leaves together, the same on every backend, whole in
// every gale, and at no cost but their work from frame to frame.

#include "support/allocations.hpp"
#include "support/closed_surface.hpp"
#include "support/devices.hpp"
#include "support/results.hpp"
#include "support/surface_topology.hpp"
#include "support/test_trees.hpp"

#include <skybark/conformance/null_backend.hpp>
#include <skybark/core/validated.hpp>
#include <skybark/trees/swaying_tree.hpp>

#include <gtest/gtest.h>
#include <limits>
#include <numbers>

using namespace skybark;
using glm::vec3;
using support::expect_done;
using support::value_of;
using trees::skeleton;
using trees::swaying_tree;

namespace {

/// A tree with its leaves.
struct plant {
    std::string name;
    skeleton wood;
    std::vector<leaf> leaves;

    [[nodiscard]] std::size_t trees() const {
        std::size_t roots = 0;
        while (roots < wood.size() && wood.parent[roots] == trees::none) {
            ++roots;
        }
        return roots;
    }
    [[nodiscard]] double height() const {
        const trees::bounding_box box = trees::bounds(wood);
        return double{box.max.y} - double{box.min.y};
    }
};

plant grown(const trees::species_entry& species, int levels) {
    trees::weber_penn_parameters parameters = species.parameters;
    parameters.levels = std::min(parameters.levels, levels);
    plant made{std::string(species.name), support::built(value_of(trees::grow(parameters, 1))), {}};
    made.leaves = trees::place_leaves(made.wood, trees::leaves_of(species));
    return made;
}
/// A trunk and its boughs, in leaf: some hundred segments.
plant young_aspen() { return grown(*trees::find_species("quaking_aspen"), 2); }
plant full_aspen() { return grown(*trees::find_species("quaking_aspen"), 4); }

plant scan() {
    const support::test_tree tree = support::scanned_tree();
    return {tree.name, tree.skeleton, trees::place_leaves(tree.skeleton, {})};
}

trees::kaimal_gusts gusts_of(double speed) {
    trees::kaimal_gusts model;
    model.speed = speed;
    return model;
}

template <class B, class Mesh>
using options_of = typename swaying_tree<B, Mesh>::options_type;

template <class B, class Mesh>
options_of<B, Mesh> plain(std::uint32_t sides = 5, std::uint32_t rings = 3) {
    options_of<B, Mesh> options;
    options.branches.sides = sides;
    options.branches.rings = rings;
    return options;
}
trees::bark_options some_bark() {
    trees::bark_options bark;
    bark.threshold = 0.08f;
    bark.relief = 0.01f;
    return bark;
}
const trees::bark_texture& furrows() {
    static const trees::bark_texture texture = trees::furrowed_bark(1);
    return texture;
}

/// A tree in the wind on a device.
template <backend B, class Mesh = trees::closed_mesh<B>>
struct scene {
    B& device;
    swaying_tree<B, Mesh> tree;
    trees::wind_field<B> air;
    int frames = 0;

    scene(B& on, const plant& of, const trees::kaimal_gusts& wind,
          const options_of<B, Mesh>& options)
        : device(on),
          tree(value_of(swaying_tree<B, Mesh>::create(on, of.wood, of.leaves, furrows(), options))),
          air(value_of(trees::wind_field<B>::create(on, trees::segment_middles(of.wood), wind))) {}

    void advance(typename B::recorder& to) {
        ++frames;
        tree.advance(to, air, frames / 60.0, 1.0f / 60);
    }
    void sway(int count) {
        for (int i = 0; i < count; ++i) {
            expect_done(run(device, [&](auto& to) { advance(to); }));
        }
    }
    void mesh() {
        expect_done(run(device, [&](auto& to) { tree.mesh(to); }));
    }
    [[nodiscard]] trees::host_mesh branches() const {
        return value_of(tree.branches().download(device));
    }
    [[nodiscard]] trees::host_mesh leaves() const {
        return value_of(tree.leaves().download(device));
    }
    [[nodiscard]] trees::host_mesh bark() const {
        return value_of(tree.bark()->download(device, tree.branches()));
    }
    [[nodiscard]] std::vector<segment_pose> poses() const {
        std::vector<segment_pose> all(tree.motion().size());
        const auto view = tree.motion().poses();
        expect_done(
            device.download(*view.buffer, view.offset, std::as_writable_bytes(std::span(all))));
        return all;
    }
};

/// What a frame left behind.
struct frame {
    trees::host_mesh branches, bark, leaves;
};

template <backend B>
frame frame_of(B& device, const plant& of, int frames, const trees::bark_options& bark) {
    auto options = plain<B, trees::closed_mesh<B>>();
    options.bark = bark;
    scene<B> s(device, of, gusts_of(12), options);
    s.sway(frames);
    for (bool again = true; again;) {
        s.mesh();
        again = value_of(s.tree.update(device));
    }
    return {s.branches(), s.bark(), s.leaves()};
}

/// The largest distance between the vertices of two meshes, m.
double farthest(const trees::host_mesh& a, const trees::host_mesh& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        const double d =
            glm::distance(glm::dvec3(a.vertices[i].position), glm::dvec3(b.vertices[i].position));
        most = d >= 0 ? std::max(most, d) : std::numeric_limits<double>::infinity(); // NaN
    }
    return most;
}

bool near(const surface_vertex* a, const surface_vertex* b, double bound) {
    for (int k = 0; k < 3; ++k) {
        if (!(glm::distance(glm::dvec3(a[k].position), glm::dvec3(b[k].position)) <= bound)) {
            return false;
        }
    }
    return true;
}

/// Triangles of one list that the other has not at its turn, counted over both: gaps of up to
/// sixteen triangles are passed over where three in a row are equal again.
std::size_t unmatched(const std::vector<surface_vertex>& a, const std::vector<surface_vertex>& b,
                      double bound) {
    const std::size_t m = a.size() / 3;
    const std::size_t n = b.size() / 3;
    const auto again = [&](std::size_t i, std::size_t j) {
        for (std::size_t k = 0; k < 3 && i + k < m && j + k < n; ++k) {
            if (!near(&a[3 * (i + k)], &b[3 * (j + k)], bound)) {
                return false;
            }
        }
        return true;
    };
    std::size_t count = 0;
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < m && j < n) {
        if (near(&a[3 * i], &b[3 * j], bound)) {
            ++i;
            ++j;
            continue;
        }
        std::size_t gap = 1;
        std::size_t of_a = 0;
        for (bool found = false; gap <= 32 && !found; gap += found ? 0 : 1) {
            for (of_a = 0; of_a <= gap && !found; of_a += found ? 0 : 1) {
                found = of_a <= 16 && gap - of_a <= 16 && again(i + of_a, j + gap - of_a);
            }
        }
        if (gap > 32) {
            return m + n; // lost
        }
        count += gap;
        i += of_a;
        j += gap - of_a;
    }
    return count + (m - i) + (n - j);
}

/// Frames of 1/60 s in a strong wind: positions within 1e-4 of the tree's height, as the library
/// promises. An edge of bark that is as long as the threshold to the last bits may be split on one
/// backend alone, which changes the two triangles at it: lists are compared but for a few.
void check_agreement(const std::string& backend, const plant& of, int frames) {
    cpu::device reference;
    const frame expected = frame_of(reference, of, frames, some_bark());
    const double bound = 1e-4 * of.height();
    {
        // That anything moved: far more than the bound.
        const frame still = frame_of(reference, of, 0, some_bark());
        EXPECT_GT(farthest(still.branches, expected.branches), 100 * bound);
        EXPECT_GT(farthest(still.leaves, expected.leaves), 100 * bound);
    }
    support::with_device(backend, [&](auto& device) {
        const frame made = frame_of(device, of, frames, some_bark());
        ASSERT_EQ(made.branches.indices, expected.branches.indices);
        ASSERT_EQ(made.branches.vertices.size(), expected.branches.vertices.size());
        ASSERT_EQ(made.leaves.indices, expected.leaves.indices);
        ASSERT_EQ(made.leaves.vertices.size(), expected.leaves.vertices.size());
        const double branches = farthest(made.branches, expected.branches);
        const double leaves = farthest(made.leaves, expected.leaves);
        EXPECT_LE(branches, bound);
        EXPECT_LE(leaves, bound);
        testing::Test::RecordProperty("branches_m", std::to_string(branches));
        testing::Test::RecordProperty("leaves_m", std::to_string(leaves));
        const std::size_t count = expected.bark.vertices.size() / 3;
        const std::size_t other = unmatched(made.bark.vertices, expected.bark.vertices, bound);
        EXPECT_LE(other, count / 1000) << "of " << count << " triangles of bark";
        testing::Test::RecordProperty("bark_triangles", std::to_string(count));
        testing::Test::RecordProperty("other_triangles", std::to_string(other));
    });
}

/// Equal bits in each vertex, but for the words that no one fills.
::testing::AssertionResult same(const trees::host_mesh& a, const trees::host_mesh& b) {
    if (a.vertices.size() != b.vertices.size() || a.indices != b.indices) {
        return ::testing::AssertionFailure() << "other triangles";
    }
    for (std::size_t i = 0; i < a.vertices.size(); ++i) {
        if (std::memcmp(&a.vertices[i], &b.vertices[i], sizeof(surface_vertex)) != 0) {
            return ::testing::AssertionFailure() << "vertex " << i;
        }
    }
    return ::testing::AssertionSuccess();
}

} // namespace

TEST(swaying_tree, opengl_agrees_with_the_cpu) { check_agreement("opengl", young_aspen(), 600); }
TEST(swaying_tree, vulkan_agrees_with_the_cpu) { check_agreement("vulkan", young_aspen(), 600); }
TEST(swaying_tree, opengl_agrees_with_the_cpu_slow) {
    check_agreement("opengl", full_aspen(), 600);
}
TEST(swaying_tree, vulkan_agrees_with_the_cpu_slow) {
    check_agreement("vulkan", full_aspen(), 600);
}

// ---- At rest ------------------------------------------------------------------------------------

namespace {

template <backend B, class Mesh>
void check_rest(B& device, const plant& of) {
    auto options = plain<B, Mesh>();
    scene<B, Mesh> s(device, of, gusts_of(0), options);
    s.mesh();
    const trees::host_mesh before = s.branches();
    const trees::host_mesh leaves_before = s.leaves();
    s.sway(5);
    s.mesh();
    EXPECT_TRUE(same(s.branches(), before)) << "a calm moves nothing";
    EXPECT_TRUE(same(s.leaves(), leaves_before));

    const Mesh alone = value_of(Mesh::create(device, of.wood, options.branches));
    const auto leaves = value_of(trees::leaf_mesh<B>::create(device, of.leaves, options.leaves));
    expect_done(run(device, [&](auto& to) {
        if constexpr (requires { alone.record(to); }) {
            alone.record(to);
        } else {
            alone.record(to, trees::view_detail{});
        }
        leaves.record(to);
    }));
    EXPECT_TRUE(same(before, value_of(alone.download(device))));
    EXPECT_TRUE(same(leaves_before, value_of(leaves.download(device))));
    EXPECT_FALSE(before.indices.empty());
    EXPECT_FALSE(leaves_before.indices.empty());
}

class swaying_tree_on : public testing::TestWithParam<const char*> {};

} // namespace

TEST_P(swaying_tree_on, is_its_parts_at_rest) {
    const plant aspen = young_aspen();
    support::with_device(GetParam(), [&]<class B>(B& device) {
        check_rest<B, trees::closed_mesh<B>>(device, aspen);
        check_rest<B, trees::branch_mesh<B>>(device, aspen);
        check_rest<B, trees::detailed_branch_mesh<B>>(device, aspen);
    });
}

// ---- What a frame costs -------------------------------------------------------------------------

namespace {

/// The phases of a wind's 128 waves are 512 bytes. Besides that a backend may send what its calls
/// are told, such as parameters and where the levels of the skeleton begin: some dozen calls of at
/// most 128 bytes. Of what there is one of a segment nothing goes up: that would be 48 bytes each.
constexpr std::uint64_t frame_bytes = 512 + 12 * 128;

template <backend B, class Mesh>
void check_traffic(B& device, const plant& of, bool bark) {
    ASSERT_GT(48 * of.wood.size(), 2 * frame_bytes);
    auto options = plain<B, Mesh>();
    if (bark) {
        options.bark = some_bark();
    }
    scene<B, Mesh> s(device, of, gusts_of(8), options);
    s.sway(1);
    s.mesh();
    const device_traffic before = device.traffic();
    constexpr int frames = 5;
    for (int i = 0; i < frames; ++i) {
        expect_done(run(device, [&](auto& to) {
            s.advance(to);
            s.tree.mesh(to);
        }));
    }
    EXPECT_LE(device.traffic().up - before.up, frames * frame_bytes);
    EXPECT_EQ(device.traffic().down, before.down);
}

/// Allocations on the host in 50 frames after the first few.
template <class Mesh>
std::uint64_t allocations_of_50_frames(const plant& of, bool bark) {
    cpu::device device;
    auto options = plain<cpu::device, Mesh>();
    if (bark) {
        options.bark = some_bark();
    }
    scene<cpu::device, Mesh> s(device, of, gusts_of(8), options);
    const auto one = [&] {
        expect_done(run(device, [&](auto& to) {
            s.advance(to);
            s.tree.mesh(to);
        }));
    };
    for (int i = 0; i < 3; ++i) {
        one();
    }
    const std::uint64_t before = support::allocations;
    for (int i = 0; i < 50; ++i) {
        one();
    }
    return support::allocations - before;
}

template <class Mesh>
void check_objects(const plant& of, bool bark) {
    using null = conformance::null_device;
    null device;
    auto options = plain<null, Mesh>();
    if (bark) {
        options.bark = some_bark();
    }
    scene<null, Mesh> s(device, of, gusts_of(8), options);
    const auto before = device.counts();
    for (int i = 0; i < 3; ++i) {
        expect_done(run(device, [&](auto& to) {
            s.advance(to);
            s.tree.mesh(to);
        }));
    }
    EXPECT_EQ(device.counts().buffers_made, before.buffers_made);
    EXPECT_EQ(device.counts().downloads, before.downloads);
    EXPECT_GT(device.counts().maps, before.maps);
}

} // namespace

TEST_P(swaying_tree_on, frames_send_phases_up_and_nothing_down) {
    const plant aspen = young_aspen();
    support::with_device(GetParam(), [&]<class B>(B& device) {
        check_traffic<B, trees::closed_mesh<B>>(device, aspen, true);
        check_traffic<B, trees::branch_mesh<B>>(device, aspen, false);
        check_traffic<B, trees::detailed_branch_mesh<B>>(device, aspen, false);
    });
}

INSTANTIATE_TEST_SUITE_P(backends, swaying_tree_on, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& p) { return std::string(p.param); });

TEST(swaying_tree, frames_allocate_nothing) {
    if (SKYBARK_TEST_COUNTS_ALLOCATIONS == 0) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    const std::uint64_t before = support::allocations;
    ::operator delete(::operator new(1000));
    ASSERT_EQ(support::allocations, before + 1) << "the counting works";
    const plant aspen = young_aspen();
    using device = cpu::device;
    for (const bool bark : {false, true}) {
        EXPECT_EQ(allocations_of_50_frames<trees::closed_mesh<device>>(aspen, bark), 0u) << bark;
        EXPECT_EQ(allocations_of_50_frames<trees::branch_mesh<device>>(aspen, bark), 0u) << bark;
        EXPECT_EQ(allocations_of_50_frames<trees::detailed_branch_mesh<device>>(aspen, bark), 0u)
            << bark;
    }
}

TEST(swaying_tree, frames_make_no_objects) {
    const plant aspen = young_aspen();
    using null = conformance::null_device;
    check_objects<trees::closed_mesh<null>>(aspen, false);
    check_objects<trees::closed_mesh<null>>(aspen, true);
    check_objects<trees::branch_mesh<null>>(aspen, false);
    check_objects<trees::detailed_branch_mesh<null>>(aspen, false);
}

// ---- Inputs -------------------------------------------------------------------------------------

namespace {

using checked = validated<cpu::device>;

/// A CPU whose contract is checked.
struct checked_device {
    cpu::device inner;
    std::vector<std::string> misuse;
    checked device{inner, [this](std::string_view s) { misuse.emplace_back(s); }};
};

template <class T>
void expect_bad_input(const result<T>& made, std::initializer_list<const char*> parts) {
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::bad_input);
    for (const char* part : parts) {
        EXPECT_NE(made.error().message.find(part), std::string::npos) << made.error().message;
    }
    EXPECT_EQ(made.error().message.back(), '.');
}

result<swaying_tree<checked>> create(checked& device, const plant& of) {
    return swaying_tree<checked>::create(device, of.wood, of.leaves, furrows(),
                                         plain<checked, trees::closed_mesh<checked>>());
}

bool is_finite(const trees::host_mesh& mesh) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const surface_vertex& v) {
        return std::isfinite(v.position.x) && std::isfinite(v.position.y) &&
               std::isfinite(v.position.z);
    });
}

} // namespace

TEST(swaying_tree, refuses_leaves_that_nothing_carries) {
    checked_device on;
    plant aspen = young_aspen();
    aspen.leaves[7].carrier = static_cast<std::uint32_t>(aspen.wood.size());
    expect_bad_input(create(on.device, aspen),
                     {"Leaf 7", std::to_string(aspen.wood.size()).c_str()});
    aspen.leaves[7].carrier = trees::none;
    expect_bad_input(create(on.device, aspen), {"Leaf 7"});
    EXPECT_TRUE(on.misuse.empty()) << on.misuse.front();
}

TEST(swaying_tree, refuses_leaves_that_are_not_numbers) {
    checked_device on;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (int field = 0; field < 4; ++field) {
        plant aspen = young_aspen();
        leaf& l = aspen.leaves[3];
        (field == 0 ? l.position.y : field == 1 ? l.width : field == 2 ? l.length : l.fold) = nan;
        expect_bad_input(create(on.device, aspen), {"Leaf 3"});
    }
    plant aspen = young_aspen();
    aspen.leaves[3].width = -1;
    expect_bad_input(create(on.device, aspen), {"Leaf 3"});
}

TEST(swaying_tree, can_be_bare_and_cannot_be_nothing) {
    checked_device on;
    plant aspen = young_aspen();
    aspen.leaves.clear();
    scene<checked> s(on.device, aspen, gusts_of(10), plain<checked, trees::closed_mesh<checked>>());
    s.sway(3);
    s.mesh();
    EXPECT_TRUE(s.leaves().indices.empty());
    EXPECT_EQ(value_of(s.tree.triangles(on.device)), s.branches().indices.size() / 3);
    expect_bad_input(create(on.device, plant{}), {"segments"});
    plant nothing_but_leaves;
    nothing_but_leaves.leaves = aspen.leaves;
    expect_bad_input(create(on.device, nothing_but_leaves), {});
    EXPECT_TRUE(on.misuse.empty()) << on.misuse.front();
}

TEST(swaying_tree, refuses_options_that_are_not_numbers) {
    checked_device on;
    const plant aspen = young_aspen();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    using options = options_of<checked, trees::closed_mesh<checked>>;
    const std::function<void(options&)> faults[] = {
        [&](options& o) { o.drag.leaves = nan; },
        [&](options& o) { o.sway.material.elasticity = nan; },
        [&](options& o) { o.leaf_cover = static_cast<float>(nan); },
        [&](options& o) { o.leaf_cover = -1; },
        [&](options& o) { o.leaf_area_index = nan; },
        [&](options& o) { o.leaf_area_index = -1; },
        [&](options& o) { o.branches.sides = 2; },
        [&](options& o) {
            o.bark = some_bark();
            o.bark->threshold = static_cast<float>(nan);
        }};
    int which = 0;
    for (const auto& fault : faults) {
        auto o = plain<checked, trees::closed_mesh<checked>>();
        fault(o);
        const auto made =
            swaying_tree<checked>::create(on.device, aspen.wood, aspen.leaves, furrows(), o);
        ASSERT_FALSE(made) << which;
        EXPECT_EQ(made.error().code, error_code::bad_input) << which;
        ++which;
    }
    expect_bad_input(trees::wind_field<checked>::create(
                         on.device, trees::segment_middles(aspen.wood), gusts_of(nan)),
                     {});
    EXPECT_TRUE(on.misuse.empty()) << on.misuse.front();
}

// A caller's own wind may say anything: the tree stays where numbers are.
TEST(swaying_tree, a_wind_that_is_not_a_number_leaves_no_trace) {
    checked_device on;
    const plant aspen = young_aspen();
    auto tree = value_of(create(on.device, aspen));
    double speed = 8;
    auto air = value_of(
        trees::make_wind_function(on.device, trees::segment_middles(aspen.wood), [&](vec3, double) {
            return vec3(static_cast<float>(speed), 0, 0);
        }));
    const auto frame = [&](double time) {
        expect_done(run(on.device, [&](auto& to) {
            tree.advance(to, air, time, 1.0f / 60);
            tree.mesh(to);
        }));
        const auto branches = value_of(tree.branches().download(on.device));
        const auto leaves = value_of(tree.leaves().download(on.device));
        return is_finite(branches) && is_finite(leaves);
    };
    EXPECT_TRUE(frame(0));
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e30, -1e38}) {
        speed = wrong;
        EXPECT_TRUE(frame(1)) << wrong;
        speed = 8;
        EXPECT_TRUE(frame(2)) << "after " << wrong;
    }
    EXPECT_TRUE(on.misuse.empty()) << on.misuse.front();
}

TEST(swaying_tree, no_time_and_time_that_goes_back_move_nothing) {
    checked_device on;
    const plant aspen = young_aspen();
    scene<checked> s(on.device, aspen, gusts_of(12), plain<checked, trees::closed_mesh<checked>>());
    s.sway(20);
    s.mesh();
    const trees::host_mesh before = s.branches();
    for (const float step : {0.0f, -0.0f, -1.0f, -std::numeric_limits<float>::infinity(),
                             std::numeric_limits<float>::quiet_NaN()}) {
        expect_done(run(on.device, [&](auto& to) {
            s.tree.advance(to, s.air, 0.5, step);
            s.tree.mesh(to);
        }));
        EXPECT_TRUE(same(s.branches(), before)) << step;
        EXPECT_TRUE(is_finite(s.leaves())) << step;
    }
    // As long as the longest step, whatever is asked for.
    expect_done(run(on.device, [&](auto& to) {
        s.tree.advance(to, s.air, 1, std::numeric_limits<float>::infinity());
        s.tree.mesh(to);
    }));
    EXPECT_FALSE(same(s.branches(), before));
    EXPECT_TRUE(is_finite(s.branches()));
    EXPECT_TRUE(on.misuse.empty()) << on.misuse.front();
}

// ---- Leaves in the wind, and wood that carries them ---------------------------------------------

namespace {

/// Two trees of one segment, ten metres apart.
skeleton two_stakes() {
    return support::built(
        {{{0, 0, 0}, {0, 2, 0}, 0.1f, 0.1f}, {{10, 0, 0}, {10, 2, 0}, 0.1f, 0.1f}});
}

/// Leaves at the corners of a box, carried by `carrier`.
void add_corners(std::vector<leaf>& to, vec3 low, vec3 high, std::uint32_t carrier) {
    for (int i = 0; i < 8; ++i) {
        leaf l;
        l.position = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                      (i & 4) != 0 ? high.z : low.z};
        l.carrier = carrier;
        to.push_back(l);
    }
}

} // namespace

// The ground below a crown is the ellipse in its box's base.
TEST(swaying_tree, leaves_count_for_so_many_layers_at_most) {
    const skeleton two = two_stakes();
    std::vector<leaf> leaves;
    add_corners(leaves, {-1, 1, -2}, {1, 4, 2}, 0); // an ellipse of π/4 · 2 · 4 m²
    add_corners(leaves, {9, 1, -1}, {11, 2, 1}, 1); // of π/4 · 2 · 2 m²
    const float first = 2 * std::numbers::pi_v<float>;
    const float second = std::numbers::pi_v<float>;
    std::vector<float> area{8 * first, 2 * second}; // 8 layers and 2
    trees::limit_leaf_area(two, leaves, 4, area);
    EXPECT_NEAR(area[0], 4 * first, 1e-5 * area[0]) << "half of it";
    EXPECT_EQ(area[1], 2 * second) << "fewer than four layers: all of it";
    trees::limit_leaf_area(two, leaves, 0, area);
    EXPECT_EQ(area[0], 0);
    std::vector<float> none(2, 0.0f);
    trees::limit_leaf_area(two, {}, 4, none);
    EXPECT_EQ(none, std::vector<float>(2, 0.0f));
}

// (1 − e^−τ) / τ with τ = A / 2S; a crown that is seen as an ellipse of its box.
TEST(swaying_tree, leaves_stand_in_each_others_lee) {
    const skeleton two = two_stakes();
    std::vector<leaf> leaves;
    add_corners(leaves, {-1, 1, -2}, {1, 4, 2}, 0); // an outline of π/4 · 4 · 3 m²
    add_corners(leaves, {9, 1, -1}, {11, 2, 1}, 1);
    const double outline = 3 * std::numbers::pi;
    for (const double depth : {1e-3, 0.1, 1.0, 5.0, 50.0}) {
        std::vector<float> area{static_cast<float>(2 * outline * depth), 0};
        trees::shelter_leaves(two, leaves, area);
        const double expected = 2 * outline * (1 - std::exp(-depth));
        EXPECT_NEAR(area[0], expected, 1e-5 * expected) << depth;
        EXPECT_EQ(area[1], 0);
    }
    // Ever more leaves show no more than twice the outline: k = 1/2.
    std::vector<float> many{1e6f, 1};
    trees::shelter_leaves(two, leaves, many);
    EXPECT_NEAR(many[0], 2 * outline, 1e-5 * outline);
    EXPECT_LT(many[1], 1);
    EXPECT_GT(many[1], 0.8f);
}

TEST(swaying_tree, wood_is_as_thick_as_what_it_carries_is_long) {
    // A trunk of 10 m whose middle fork carries 5 m and 2.5 m; the tips end in points.
    const skeleton thin = support::built({{{0, 0, 0}, {0, 5, 0}, 0.01f, 0.005f},
                                          {{0, 5, 0}, {0, 10, 0}, 0.005f, 0, 0},
                                          {{0, 5, 0}, {2.5f, 5, 0}, 0.5f, 0, 0}});
    const skeleton made = trees::load_bearing(thin, 0.002f, 100);
    const auto of = [&](float reach) { // the segment that ends so far beyond its base
        for (std::uint32_t i = 1; i < 3; ++i) {
            if (std::abs(made.length[i] - reach) < 1e-6f) {
                return i;
            }
        }
        return trees::none;
    };
    const std::uint32_t up = of(5);
    const std::uint32_t side = of(2.5f);
    ASSERT_NE(up, trees::none);
    ASSERT_NE(side, trees::none);
    EXPECT_FLOAT_EQ(made.base_radius[0], 0.002f + 0.1f) << "10 m to go";
    EXPECT_FLOAT_EQ(made.radius[0], 0.002f + 0.05f) << "5 m, the longer way";
    EXPECT_FLOAT_EQ(made.base_radius[up], 0.002f + 0.05f);
    EXPECT_FLOAT_EQ(made.radius[up], 0.002f);
    EXPECT_FLOAT_EQ(made.base_radius[side], 0.5f) << "thick enough already";
    EXPECT_FLOAT_EQ(made.radius[side], 0.002f);
    EXPECT_EQ(made.length, thin.length);
    EXPECT_EQ(made.position, thin.position);
}

// Full-grown trees in leaf sway at 0.2 to 2 Hz (Moore and Maguire 2004: 0.1 to 1 Hz for conifers of
// 5 to 30 m; broad-leaved trees lie in the upper part and above).
TEST(swaying_tree, species_in_leaf_sway_as_trees_do) {
    for (const trees::species_entry& species : trees::all_species()) {
        const plant of = grown(species, 4);
        cpu::device device;
        const auto tree =
            value_of(swaying_tree<cpu::device, trees::branch_mesh<cpu::device>>::create(
                device, of.wood, of.leaves, furrows(),
                plain<cpu::device, trees::branch_mesh<cpu::device>>(3, 2)));
        ASSERT_EQ(tree.motion().trees().size(), 1u);
        const double hertz = tree.motion().trees()[0].frequency / (2 * std::numbers::pi);
        EXPECT_GE(hertz, 0.2) << of.name;
        EXPECT_LE(hertz, 2.0) << of.name;
    }
}

// ---- Several trees ------------------------------------------------------------------------------

namespace {

/// A tree and the same tree `away`, in one skeleton. The first one's segments come first in each
/// level.
plant pair_of(const trees::species_entry& species, vec3 away, std::vector<bool>& is_second) {
    trees::weber_penn_parameters parameters = species.parameters;
    parameters.levels = 2;
    std::vector<trees::segment> both = value_of(trees::grow(parameters, 1));
    const auto count = static_cast<std::uint32_t>(both.size());
    both.resize(std::size_t{2} * count);
    for (std::uint32_t i = 0; i < count; ++i) {
        trees::segment& s = both[count + i] = both[i];
        s.base += away;
        s.tip += away;
        s.parent += s.parent == trees::none ? 0 : count;
    }
    plant made{"pair", support::built(both), {}};
    made.leaves = trees::place_leaves(made.wood, trees::leaves_of(species));
    is_second.resize(made.wood.size());
    for (std::uint32_t i = 0; i < made.wood.size(); ++i) {
        const std::uint32_t p = made.wood.parent[i];
        is_second[i] = p == trees::none ? i == 1 : is_second[p];
    }
    return made;
}

} // namespace

TEST(swaying_tree, trees_of_one_skeleton_sway_on_their_own) {
    const auto& species = *trees::find_species("quaking_aspen");
    std::vector<bool> is_second;
    const plant both = pair_of(species, {40, 0, 0}, is_second);
    plant one = grown(species, 2);
    // The leaves that the first of both has, as places differ in their random parts.
    one.leaves.clear();
    std::vector<std::uint32_t> own(both.wood.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
        own[i] = is_second[i] ? trees::none : next++;
    }
    ASSERT_EQ(next, one.wood.size());
    for (leaf l : both.leaves) {
        if (!is_second[l.carrier]) {
            l.carrier = own[l.carrier];
            one.leaves.push_back(l);
        }
    }
    ASSERT_GT(both.leaves.size(), one.leaves.size());

    cpu::device device;
    using mesh = trees::branch_mesh<cpu::device>;
    const auto options = plain<cpu::device, mesh>(3, 2);
    auto pair = value_of(swaying_tree<cpu::device, mesh>::create(device, both.wood, both.leaves,
                                                                 furrows(), options));
    auto alone = value_of(
        swaying_tree<cpu::device, mesh>::create(device, one.wood, one.leaves, furrows(), options));
    // Gusts at the first, and a hurricane at the second.
    const auto blow = [](vec3 at, double t) {
        return vec3(at.x > 20 ? 60.0f : 6 + 4 * static_cast<float>(std::sin(3 * t)), 0, 2);
    };
    auto air_of_both =
        value_of(trees::make_wind_function(device, trees::segment_middles(both.wood), blow));
    auto air_of_one =
        value_of(trees::make_wind_function(device, trees::segment_middles(one.wood), blow));
    for (int i = 1; i <= 120; ++i) {
        expect_done(run(device, [&](auto& to) {
            pair.advance(to, air_of_both, i / 60.0, 1.0f / 60);
            alone.advance(to, air_of_one, i / 60.0, 1.0f / 60);
        }));
    }
    const auto poses_of = [&](const auto& tree, std::size_t count) {
        std::vector<segment_pose> poses(count);
        expect_done(device.download(*tree.motion().poses().buffer, 0,
                                    std::as_writable_bytes(std::span(poses))));
        return poses;
    };
    const auto in_pair = poses_of(pair, both.wood.size());
    const auto by_itself = poses_of(alone, one.wood.size());
    float moved = 0;
    for (std::size_t i = 0; i < in_pair.size(); ++i) {
        if (is_second[i]) {
            continue;
        }
        const segment_pose& expected = by_itself[own[i]];
        ASSERT_EQ(in_pair[i].rotation, expected.rotation) << i;
        ASSERT_EQ(in_pair[i].shift, expected.shift) << i;
        moved = std::max(moved, glm::length(expected.shift));
    }
    EXPECT_GT(moved, 0.01f);
}

// ---- Bark ---------------------------------------------------------------------------------------

// Made for a view from afar, then looked at from near by: too little room once, and never again.
TEST(swaying_tree, bark_gets_the_room_that_a_nearer_view_needs) {
    using device_type = cpu::device;
    using mesh = trees::detailed_branch_mesh<device_type>;
    cpu::device device;
    const plant aspen = young_aspen();
    auto options = plain<device_type, mesh>(12, 5);
    options.bark = some_bark();
    options.bark->reserve = 0;
    options.leaves.form = trees::mesh_form::list;
    scene<device_type, mesh> near(device, aspen, gusts_of(0), options);
    near.mesh();
    const std::uint64_t all = value_of(near.tree.triangles(device));
    const trees::host_mesh expected = near.bark();

    options.view.camera = {3000, 2, 0};
    options.view.pixels_per_radian = 500;
    scene<device_type, mesh> far(device, aspen, gusts_of(0), options);
    far.mesh();
    EXPECT_FALSE(value_of(far.tree.update(device)));
    EXPECT_LT(far.bark().vertices.size(), expected.vertices.size() / 2);

    far.tree.look_from({});
    far.mesh();
    EXPECT_LT(value_of(far.tree.triangles(device)), all) << "whole triangles, but not all";
    EXPECT_TRUE(value_of(far.tree.update(device)));
    far.mesh();
    EXPECT_FALSE(value_of(far.tree.update(device)));
    EXPECT_TRUE(same(far.bark(), expected));
    EXPECT_EQ(value_of(far.tree.triangles(device)), all);
}

// ---- In a gale ----------------------------------------------------------------------------------

namespace {

/// After 5 s in gusts about 25 m/s, a storm's wind: closed, one surface a tree, no handles.
void check_closed_in_a_gale(const plant& of) {
    cpu::device device;
    scene<cpu::device> s(device, of, gusts_of(25),
                         plain<cpu::device, trees::closed_mesh<cpu::device>>(6, 3));
    s.mesh();
    const trees::host_mesh still = s.branches();
    s.sway(300);
    s.mesh();
    const trees::host_mesh bent = s.branches();
    EXPECT_GT(farthest(still, bent), 0.01 * of.height()) << of.name << " hardly moves";
    const auto found = support::examine_surface(support::weld(bent.vertices), bent.indices);
    EXPECT_EQ(found.boundary_edges, 0u) << of.name;
    EXPECT_EQ(found.crowded_edges, 0u) << of.name;
    EXPECT_EQ(found.pinched, 0u) << of.name;
    EXPECT_TRUE(found.spheres(of.trees())) << of.name;
    EXPECT_TRUE(is_finite(bent)) << of.name;
}

} // namespace

TEST(swaying_tree, stays_whole_in_a_gale) { check_closed_in_a_gale(full_aspen()); }

TEST(swaying_tree, stays_whole_in_a_gale_slow) {
    for (const trees::species_entry& species : trees::all_species()) {
        check_closed_in_a_gale(grown(species, 4));
    }
    check_closed_in_a_gale(scan());
}
