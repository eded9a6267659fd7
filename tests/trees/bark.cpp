// Bark on meshes, on all backends: closed, fine enough, the same everywhere, and within its room.

#include "support/bark_surfaces.hpp"
#include "support/closed_surface.hpp"
#include "support/devices.hpp"
#include "support/test_trees.hpp"

#include <picture/tree_picture.hpp>
#include <skybark/core/validated.hpp>
#include <skybark/trees/bark_mesh.hpp>
#include <skybark/trees/closed_mesh.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using support::one_part_mesh;
using trees::bark_mesh;
using trees::bark_options;

namespace {

const trees::bark_texture& test_texture() {
    static const trees::bark_texture texture = trees::furrowed_bark(3, 64, 48);
    return texture;
}

bark_options coarse_bark(float threshold) {
    bark_options options;
    options.threshold = threshold;
    options.relief = 0.06f;
    options.repeats_around = 2;
    options.most_passes = 12;
    options.narrowest = 0;
    return options;
}

template <backend B, class Mesh>
bark_mesh<B> bark_on(B& device, const Mesh& mesh, const bark_options& options) {
    auto bark = bark_mesh<B>::create(device, mesh, options, test_texture());
    if (!bark) {
        throw std::runtime_error(bark.error().message);
    }
    return *std::move(bark);
}

template <backend B, class Mesh>
trees::host_mesh refined(B& device, const Mesh& mesh, const bark_mesh<B>& bark) {
    const auto done = run(device, [&](auto& r) { bark.record(r, mesh); });
    EXPECT_TRUE(done);
    auto all = bark.download(device, mesh);
    EXPECT_TRUE(all);
    return *std::move(all);
}

template <backend B>
trees::host_mesh bark_of(B& device, const trees::host_mesh& surface, const bark_options& options) {
    const auto mesh = one_part_mesh<B>::make(device, surface);
    return refined(device, mesh, bark_on(device, mesh, options));
}

/// The surface's triangles without those of zero bytes.
std::vector<std::array<surface_vertex, 3>> triangles_of(const trees::host_mesh& mesh) {
    std::vector<std::array<surface_vertex, 3>> all;
    const std::array<surface_vertex, 3> zeros{};
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        all.push_back({mesh.vertices[mesh.indices[k]], mesh.vertices[mesh.indices[k + 1]],
                       mesh.vertices[mesh.indices[k + 2]]});
        if (std::memcmp(&all.back(), &zeros, sizeof zeros) == 0) {
            all.pop_back();
        }
    }
    return all;
}

void expect_equal_bits(const trees::host_mesh& actual, const trees::host_mesh& expected,
                       const std::string& what) {
    const auto a = triangles_of(actual);
    const auto b = triangles_of(expected);
    ASSERT_EQ(a.size(), b.size()) << what;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof a[i]), 0) << what << ", triangle " << i;
    }
}

/// Both paddings and several sizes on a device, against the CPU's bits.
template <backend B>
void expect_the_cpus_bark(B& device) {
    cpu::device cpu;
    for (const float threshold : {0.5f, 0.2f}) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            bark_options options = coarse_bark(threshold);
            options.policy = policy;
            const trees::host_mesh stem = support::closed_stem(8, 5);
            const auto actual = bark_of(device, stem, options);
            const std::string what = std::to_string(threshold) + " m, padding " +
                                     std::to_string(static_cast<int>(policy));
            expect_equal_bits(actual, bark_of(cpu, stem, options), what);
            if (::testing::Test::HasFatalFailure()) {
                return;
            }
        }
    }
}

/// A stem with bark, 160 x 120 pixels.
template <backend B>
std::vector<std::uint8_t> picture_of(B& device) {
    const bark_options options = coarse_bark(0.2f);
    const auto mesh = one_part_mesh<B>::make(device, support::closed_stem(8, 5));
    const auto bark = bark_on(device, mesh, options);
    EXPECT_TRUE(run(device, [&](auto& r) { bark.record(r, mesh); }));
    picture::picture_options size;
    size.width = 160;
    size.height = 120;
    size.supersampling = 1;
    size.eye = glm::vec3(0.5f, 1.6f, 4);
    size.target = glm::vec3(0.3f, 1.5f, 0);
    picture::surface_maps maps;
    maps.bark_width = test_texture().width;
    maps.bark_height = test_texture().height;
    maps.bark = trees::normal_map(test_texture(), options.relief, 0.5f, 0.7f);
    const auto painter = picture::tree_painter<B>::create(device, size, maps);
    EXPECT_TRUE(painter);
    std::vector<picture::drawable<B>> all;
    bark.for_each_draw(mesh, [&](auto vertices, auto which) {
        all.push_back({vertices, which, picture::look::bark});
    });
    const auto scene = picture::scene_around(glm::vec3(-1, 0, -1), glm::vec3(1, 3, 1), size);
    EXPECT_TRUE(run(device, [&](auto& r) { painter->record(r, scene, all, 0, 1200); }));
    auto pixels = painter->download(device);
    EXPECT_TRUE(pixels);
    return *std::move(pixels);
}

/// The same to the eye: edges may fall on the other side of a pixel's centre.
template <backend B>
void expect_the_cpus_picture(B& device) {
    cpu::device cpu;
    const auto expected = picture_of(cpu);
    const auto actual = picture_of(device);
    ASSERT_EQ(actual.size(), expected.size());
    double sum = 0;
    double darkest = 255;
    double lightest = 0;
    for (std::size_t i = 0; i < actual.size(); ++i) {
        sum += std::abs(int{actual[i]} - int{expected[i]});
        if (i % 4 == 0) {
            darkest = std::min(darkest, static_cast<double>(actual[i]));
            lightest = std::max(lightest, static_cast<double>(actual[i]));
        }
    }
    EXPECT_LT(sum / static_cast<double>(actual.size()), 1.0);
    EXPECT_GT(lightest - darkest, 100); // something is there: furrows, and sky
}

} // namespace

TEST(bark, opengl_draws_the_cpus_picture) {
    support::with_device("opengl", [](auto& device) { expect_the_cpus_picture(device); });
}

TEST(bark, vulkan_draws_the_cpus_picture) {
    support::with_device("vulkan", [](auto& device) { expect_the_cpus_picture(device); });
}

TEST(bark, opengl_has_the_cpus_bits) {
    support::with_device("opengl", [](auto& device) { expect_the_cpus_bark(device); });
}

TEST(bark, vulkan_has_the_cpus_bits) {
    support::with_device("vulkan", [](auto& device) { expect_the_cpus_bark(device); });
}

TEST(bark, every_edge_is_below_the_threshold_and_none_is_open) {
    cpu::device device;
    for (const float threshold : {0.6f, 0.3f, 0.17f, 0.06f, 0.03f}) {
        for (const auto& [sides, rings] : {std::pair{8u, 5u}, {3u, 2u}, {23u, 17u}}) {
            const trees::host_mesh stem = support::closed_stem(sides, rings);
            const trees::host_mesh mesh = bark_of(device, stem, coarse_bark(threshold));
            const auto edges = support::count_edges(support::weld(mesh.vertices), mesh.indices);
            EXPECT_EQ(edges.open, 0u) << threshold << ' ' << sides;
            EXPECT_EQ(edges.degenerate_triangles, 0u) << threshold << ' ' << sides;
            EXPECT_LE(support::longest_edge(mesh), double{threshold} * (1 + 1e-6));
            // Still a sphere: V − E + F = 2.
            const auto welded = support::weld(mesh.vertices);
            std::vector<bool> used(welded.size());
            for (const std::uint32_t index : mesh.indices) {
                used[welded[index]] = true;
            }
            const auto vertices = std::count(used.begin(), used.end(), true);
            EXPECT_EQ(vertices - static_cast<std::ptrdiff_t>(edges.edges) +
                          static_cast<std::ptrdiff_t>(mesh.indices.size() / 3),
                      2);
        }
    }
}

TEST(bark, passes_end_where_the_options_say) {
    cpu::device device;
    bark_options options = coarse_bark(0.01f);
    options.most_passes = 2;
    const trees::host_mesh stem = support::closed_stem(8, 5);
    const auto mesh = bark_of(device, stem, options);
    EXPECT_EQ(mesh.indices.size(), 16 * stem.indices.size()); // all edges split, twice
    EXPECT_EQ(support::count_edges(support::weld(mesh.vertices), mesh.indices).open, 0u);
}

TEST(bark, levels_a_pass_change_nothing) {
    const trees::host_mesh stem = support::closed_stem(8, 5);
    bark_options options = coarse_bark(0.06f);
    cpu::device plain;
    const trees::host_mesh expected = bark_of(plain, stem, options);
    std::size_t passes = 99;
    for (const std::uint32_t amplification : {0u, 4u, 15u, 16u, 64u, 0xffffffffu}) {
        cpu::device_options chosen;
        chosen.limits.amplification = amplification;
        cpu::device device(chosen);
        const auto mesh = one_part_mesh<cpu::device>::make(device, stem);
        const auto bark = bark_on(device, mesh, options);
        const std::string what = std::to_string(amplification) + " triangles a pass";
        expect_equal_bits(refined(device, mesh, bark), expected, what);
        EXPECT_LE(bark.parts()[0].levels.size(), passes) << what;
        passes = bark.parts()[0].levels.size();
        for (const std::uint32_t levels : bark.parts()[0].levels) {
            EXPECT_LE(1u << (2 * (levels - 1)), std::max(1u, amplification / 4)) << what;
        }
    }
    EXPECT_EQ(passes, 1u);
}

TEST(bark, without_relief_and_rounding_the_surface_stays) {
    cpu::device device;
    bark_options options = coarse_bark(0.08f);
    options.relief = 0;
    options.rounding = 0;
    const trees::host_mesh stem = support::closed_stem(8, 5);
    const auto mesh = bark_of(device, stem, options);
    EXPECT_GT(mesh.indices.size(), 20 * stem.indices.size());
    // Sums of some 10^4 areas and volumes of floats: 1e-6.
    EXPECT_NEAR(support::signed_volume(mesh.vertices, mesh.indices) /
                    support::signed_volume(stem.vertices, stem.indices),
                1, 1e-6);
    EXPECT_NEAR(support::surface_area(mesh.vertices, mesh.indices) /
                    support::surface_area(stem.vertices, stem.indices),
                1, 1e-6);
}

TEST(bark, rounding_brings_an_octagon_close_to_its_circle) {
    // One ring band of a straight cylinder of radius 1: without rounding the midpoint of a side is
    // at cos(π/8) = 0.924, on the curve within 1 % of the circle.
    cpu::device device;
    trees::host_mesh band;
    for (std::uint32_t k = 0; k < 2; ++k) {
        for (std::uint32_t i = 0; i <= 8; ++i) {
            const double angle = 0.7853981633974483 * (i % 8);
            surface_vertex v;
            v.normal = glm::vec3(glm::dvec3(std::cos(angle), 0, -std::sin(angle)));
            v.position = v.normal + glm::vec3(0, k, 0);
            v.u = static_cast<float>(i) / 8;
            v.tangent = {v.normal.z, 0, -v.normal.x, 1};
            band.vertices.push_back(v);
        }
    }
    for (std::uint32_t i = 0; i < 8; ++i) {
        band.indices.insert(band.indices.end(), {9 + i, i, 10 + i, 10 + i, i, i + 1});
    }
    bark_options options = coarse_bark(0.1f);
    options.relief = 0;
    for (const float rounding : {0.0f, 1.0f}) {
        options.rounding = rounding;
        const auto mesh = bark_of(device, band, options);
        double least = 2;
        double most = 0;
        for (const surface_vertex& v : mesh.vertices) {
            const double r = std::hypot(double{v.position.x}, double{v.position.z});
            least = std::min(least, r);
            most = std::max(most, r);
        }
        EXPECT_NEAR(least, rounding == 0 ? 0.92388 : 1, rounding == 0 ? 1e-4 : 0.01);
        EXPECT_NEAR(most, 1, 0.01);
    }
}

// A branch's seam and joints: the only open edges are the rings where caps pass as they are.
TEST(bark, branches_stay_whole_but_for_their_flat_caps) {
    cpu::device device;
    const std::vector<trees::segment> segments{{{0, 0, 0}, {0.1f, 1, 0}, 0.30f, 0.28f, trees::none},
                                               {{0.1f, 1, 0}, {0, 2, 0.2f}, 0.28f, 0.20f, 0},
                                               {{0, 2, 0.2f}, {0, 3, 0.2f}, 0.20f, 0.005f, 1}};
    trees::branch_mesh_options branch;
    branch.sides = 9;
    auto mesh = trees::branch_mesh<cpu::device>::create(device, support::built(segments), branch);
    ASSERT_TRUE(mesh);
    ASSERT_TRUE(run(device, [&](auto& r) { mesh->record(r); }));
    for (const float threshold : {0.15f, 0.07f, 0.03f}) {
        const auto bark = bark_on(device, *mesh, coarse_bark(threshold));
        const auto all = refined(device, *mesh, bark);
        const auto welded = support::weld(all.vertices);
        std::unordered_map<std::uint64_t, int> open;
        for (std::size_t k = 0; k < all.indices.size(); ++k) {
            const std::size_t n = k % 3 == 2 ? k - 2 : k + 1;
            const std::uint32_t a = welded[all.indices[k]], b = welded[all.indices[n]];
            open[std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)] += a < b ? 1 : -1;
        }
        for (const auto& [edge, sum] : open) {
            if (sum != 0) {
                const float y = all.vertices[edge & 0xffffffffu].position.y;
                ASSERT_LT(y, 0.05f) << threshold; // the cap at the foot, which is on the ground
            }
        }
    }
}

// Forks and tips too, at rest and bent: a segment turned by 0.15 rad against the one before it.
TEST(bark, closed_trees_stay_closed_at_rest_and_bent) {
    cpu::device device;
    const std::vector<trees::segment> segments{
        {{0, -0.3f, 0}, {0.02f, 0.5f, 0}, 0.52f, 0.42f, trees::none},
        {{0.02f, 0.5f, 0}, {0.05f, 1.2f, 0}, 0.42f, 0.385f, 0},
        {{0.05f, 1.2f, 0}, {0.06f, 1.9f, 0.02f}, 0.385f, 0.36f, 1},
        {{0.06f, 1.9f, 0.02f}, {0, 2.7f, 0}, 0.36f, 0.33f, 2},
        {{0, 2.7f, 0}, {-0.1f, 3.6f, 0}, 0.33f, 0.28f, 3},
        {{0.05f, 1.75f, 0.05f}, {0.7f, 2.4f, 0.5f}, 0.16f, 0.12f, 2},
        {{0.7f, 2.4f, 0.5f}, {1.3f, 3.2f, 0.7f}, 0.12f, 0.09f, 5}};
    const trees::skeleton skeleton = support::built(segments);
    const auto mesh = trees::closed_mesh<cpu::device>::create(device, skeleton, {});
    ASSERT_TRUE(mesh) << mesh.error().message;
    std::vector<segment_pose> poses(skeleton.size());
    for (std::uint32_t i = 0; i < skeleton.size(); ++i) {
        poses[i].base = skeleton.position[i];
        if (skeleton.parent[i] != trees::none) {
            const segment_pose& parent = poses[skeleton.parent[i]];
            const double half = 0.15 * i / 2;
            poses[i].rotation = glm::vec4(glm::dvec4(0, 0, std::sin(half), std::cos(half)));
            poses[i].shift = shared::posed_point(parent, poses[i].base) - poses[i].base;
        }
    }
    const auto pose_buffer =
        make_buffer<cpu::device, segment_pose>(device, std::span(std::as_const(poses)));
    ASSERT_TRUE(pose_buffer);
    for (const float threshold : {0.3f, 0.15f, 0.07f, 0.04f}) {
        ASSERT_TRUE(run(device, [&](auto& r) { mesh->record(r); }));
        bark_options options = coarse_bark(threshold);
        options.narrowest = 0.5f;
        const auto bark = bark_on(device, *mesh, options);
        for (const bool bent : {false, true}) {
            ASSERT_TRUE(run(device, [&](auto& r) {
                bent ? mesh->record(r, view<cpu::device>(*pose_buffer)) : mesh->record(r);
            }));
            const auto all = refined(device, *mesh, bark);
            const auto edges = support::count_edges(support::weld(all.vertices), all.indices);
            EXPECT_EQ(edges.open, 0u) << threshold << " m, bent: " << bent;
            EXPECT_EQ(edges.degenerate_triangles, 0u) << threshold << " m, bent: " << bent;
            EXPECT_GT(all.indices.size(), 3u * 382);
        }
    }
}

TEST(bark, twigs_stay_in_the_meshs_own_vertices) {
    cpu::device device;
    const auto skeleton = support::grown_trees()[0].skeleton;
    auto mesh = trees::closed_mesh<cpu::device>::create(device, skeleton, {});
    ASSERT_TRUE(mesh);
    ASSERT_TRUE(run(device, [&](auto& r) { mesh->record(r); }));
    bark_options options;
    options.threshold = 0.08f;
    const auto bark = bark_on(device, *mesh, options);
    std::uint64_t coarse = 0, plain = 0;
    for (const auto& p : bark.parts()) {
        coarse += p.elements;
    }
    for (const auto& p : bark.plain_parts()) {
        plain += p.triangles;
    }
    EXPECT_EQ(coarse + plain, mesh->triangles());
    EXPECT_LT(coarse, mesh->triangles() / 4);
    EXPECT_GT(coarse, 0u);
    // No crack between what is refined and what stays.
    const auto all = refined(device, *mesh, bark);
    const auto edges = support::count_edges(support::weld(all.vertices), all.indices);
    EXPECT_EQ(edges.open, 0u);
}

TEST(bark, a_part_too_long_for_a_buffer_is_cut_and_gives_the_same) {
    cpu::device_options small;
    small.limits.max_buffer_bytes = 200'000; // 1,388 triangles
    cpu::device limited(small);
    cpu::device device;
    const trees::host_mesh stem = support::closed_stem(8, 5);
    const bark_options options = coarse_bark(0.1f);
    const auto mesh = one_part_mesh<cpu::device>::make(limited, stem);
    const auto bark = bark_on(limited, mesh, options);
    EXPECT_GT(bark.parts().size(), 3u);
    for (const auto& p : bark.parts()) {
        EXPECT_LE(p.vertices->size_bytes(), small.limits.max_buffer_bytes);
    }
    expect_equal_bits(refined(limited, mesh, bark), bark_of(device, stem, options), "cut");
}

TEST(bark, a_list_too_short_is_whole_triangles_and_grows_for_the_next_frame) {
    cpu::device device;
    const trees::host_mesh stem = support::closed_stem(8, 5);
    bark_options options = coarse_bark(0.2f);
    options.reserve = 0;
    const auto mesh = one_part_mesh<cpu::device>::make(device, stem);
    auto bark = bark_on(device, mesh, options);
    // Twice the size: more is split than there is room for.
    trees::host_mesh larger = stem;
    for (surface_vertex& v : larger.vertices) {
        v.position *= 2.0f;
    }
    ASSERT_TRUE(device.upload(mesh.all[0].vertices, 0,
                              std::as_bytes(std::span(std::as_const(larger.vertices)))));
    ASSERT_TRUE(run(device, [&](auto& r) { bark.record(r, mesh); }));
    const auto before = bark.count(device);
    ASSERT_TRUE(before);
    EXPECT_GT(before->required, before->written);
    const auto grown = bark.update(device, mesh);
    ASSERT_TRUE(grown);
    EXPECT_TRUE(*grown);
    expect_equal_bits(refined(device, mesh, bark), bark_of(device, larger, options), "grown");
    const auto again = bark.update(device, mesh);
    ASSERT_TRUE(again);
    EXPECT_FALSE(*again);
}

TEST(bark, it_keeps_to_the_contract) {
    cpu::device checked;
    validated<cpu::device> device(checked);
    const trees::host_mesh stem = support::closed_stem(8, 5);
    for (const padding policy : {padding::compact, padding::degenerate}) {
        bark_options options = coarse_bark(0.2f);
        options.policy = policy;
        cpu::device plain;
        expect_equal_bits(bark_of(device, stem, options), bark_of(plain, stem, options), "valid");
    }
}

TEST(bark, options_and_textures_out_of_range_are_refused) {
    cpu::device device;
    const auto mesh = one_part_mesh<cpu::device>::make(device, support::closed_stem(3, 2));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refuses = [&](const bark_options& o, const trees::bark_texture& t) {
        const auto made = bark_mesh<cpu::device>::create(device, mesh, o, t);
        return !made && made.error().code == error_code::bad_input;
    };
    for (const float threshold : {0.0f, -1.0f, nan}) {
        bark_options o;
        o.threshold = threshold;
        EXPECT_TRUE(refuses(o, test_texture()));
    }
    bark_options o;
    o.repeats_around = 0;
    EXPECT_TRUE(refuses(o, test_texture()));
    o = {};
    o.most_passes = 0;
    EXPECT_TRUE(refuses(o, test_texture()));
    trees::bark_texture t = test_texture();
    t.heights.pop_back();
    EXPECT_TRUE(refuses({}, t));
    EXPECT_TRUE(refuses({}, {}));
    t = test_texture();
    t.heights[5] = nan;
    EXPECT_TRUE(refuses({}, t));
}

TEST(bark_texture, built_in_barks_repeat_without_a_seam) {
    for (const trees::bark_texture& t :
         {trees::furrowed_bark(1, 256, 256), trees::smooth_bark(1, 256, 256)}) {
        const auto at = [&](std::uint32_t x, std::uint32_t y) {
            return double{t.heights[std::size_t{y} * t.width + x]};
        };
        // Steps across the border are of the size of those inside.
        double inside = 0, across_x = 0, across_y = 0;
        for (std::uint32_t y = 0; y < 256; ++y) {
            for (std::uint32_t x = 0; x < 256; ++x) {
                ASSERT_GE(at(x, y), 0.0);
                ASSERT_LE(at(x, y), 1.0);
            }
            inside += std::fabs(at(128, y) - at(127, y)) + std::fabs(at(y, 128) - at(y, 127));
            across_x += std::fabs(at(0, y) - at(255, y));
            across_y += std::fabs(at(y, 0) - at(y, 255));
        }
        EXPECT_LT(across_x, 2 * inside);
        EXPECT_LT(across_y, 2 * inside);
        const auto [low, high] = std::minmax_element(t.heights.begin(), t.heights.end());
        EXPECT_EQ(*low, 0);
        EXPECT_NEAR(*high, 1, 1e-6);
    }
}

TEST(bark_texture, the_normal_map_is_the_slope_of_the_heights) {
    // A sine around: slope at texel x in closed form.
    constexpr double pi = 3.14159265358979;
    trees::bark_texture t{256, 2, {}};
    for (std::uint32_t i = 0; i < 512; ++i) {
        t.heights.push_back(static_cast<float>(0.5 + 0.5 * std::sin(2 * pi * (i % 256) / 256)));
    }
    const auto map = trees::normal_map(t, 0.02f, 0.5f, 0.5f);
    for (std::uint32_t x = 0; x < 256; ++x) {
        const double slope = 0.02 * 0.5 * 2 * pi / 0.5 * std::cos(2 * pi * x / 256);
        const double length = std::sqrt(1 + slope * slope);
        // Half a step of a byte, and 1e-4 of the central difference.
        EXPECT_NEAR(map[4 * x], 255 * (0.5 - 0.5 * slope / length), 0.52);
        EXPECT_NEAR(map[4 * x + 1], 127.5, 0.52);
        EXPECT_NEAR(map[4 * x + 2], 255 * (0.5 + 0.5 / length), 0.52);
        EXPECT_NEAR(map[4 * x + 3], 255 * (0.5 + 0.5 * std::sin(2 * pi * x / 256)), 0.52);
    }
}
