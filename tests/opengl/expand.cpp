// expand and expand_rings against a plain loop over the kernel.

#include "support.hpp"

#include <cmath>
#include <numbers>

namespace skybark::opengl::tests {
namespace {

using kernels::branch_frame;
using kernels::hermite_branch;
using kernels::probe_ring_vertex;
using kernels::probe_rings;
using kernels::probe_strip_vertex;
using kernels::probe_strips;

/// The triangle list of elements [first, first + count) as the contract has it.
template <class K, class... Spans>
std::vector<typename K::vertex> list_of(const K& k, range elements, padding policy,
                                        Spans... spans) {
    using vertex = typename K::vertex;
    std::vector<vertex> list;
    for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
        for (std::uint32_t s = 0; s < k.strips(); ++s) {
            const std::uint32_t has = k.triangles(i, s, spans...);
            std::vector<vertex> strip;
            if (has != 0) {
                k.strip(
                    i, s, 0, has + 2, [&](const vertex& v) { strip.push_back(v); }, spans...);
            }
            for (std::uint32_t t = 0; t < has; ++t) {
                list.push_back(strip[t + t % 2]);
                list.push_back(strip[t + 1 - t % 2]);
                list.push_back(strip[t + 2]);
            }
            if (policy == padding::degenerate) {
                list.resize(list.size() + std::size_t{3} * (k.strip_triangles() - has), vertex{});
            }
        }
    }
    return list;
}

/// Strips of every length from none to the longest, in no order.
struct strips_scene {
    strips_scene(std::uint32_t elements, std::uint32_t strips, std::uint32_t most)
        : kernel{strips, most} {
        std::uint32_t random = 12345;
        for (std::uint32_t i = 0; i < elements * strips; ++i) {
            random = random * 1664525 + 1013904223;
            const std::uint32_t n = random >> 8;
            counts.push_back(n % 5 == 0 ? 0 : (n % 7 == 0 ? most : n % (most + 1)));
        }
        for (std::uint32_t i = 0; i < elements; ++i) {
            const auto f = static_cast<float>(i);
            payloads.emplace_back(f, f + 0.5f, -f, 3.0f);
        }
    }
    [[nodiscard]] std::vector<probe_strip_vertex> list(range elements, padding policy) const {
        return list_of(kernel, elements, policy, std::span<const std::uint32_t>(counts),
                       std::span<const glm::vec4>(payloads));
    }

    probe_strips kernel;
    std::vector<std::uint32_t> counts;
    std::vector<glm::vec4> payloads;
};

/// A crooked branch whose segments have all four kinds of caps.
struct branch_scene {
    branch_scene(std::uint32_t elements, hermite_branch k) : kernel(k) {
        for (std::uint32_t i = 0; i < elements; ++i) {
            segments.push_back({i, i + 1, i % 4, 0});
        }
        for (std::uint32_t i = 0; i <= elements; ++i) {
            const float a = 0.2f * static_cast<float>(i % 5);
            branch_end end;
            end.position = {std::sin(static_cast<float>(i)), 0.25f * static_cast<float>(i % 64), 0};
            end.radius = 0.1f + 0.01f * static_cast<float>(i % 3);
            end.orientation = {std::sin(a / 2), 0, 0, std::cos(a / 2)};
            end.path = static_cast<float>(i % 64);
            end.slope = 0.1f;
            ends.push_back(end);
        }
        for (std::uint32_t i = 0; i <= kernel.sides; ++i) {
            const float turn = static_cast<float>(i) / static_cast<float>(kernel.sides);
            const float angle = 2 * std::numbers::pi_v<float> * turn;
            corners.emplace_back(std::cos(angle), std::sin(angle), turn, 0);
        }
    }

    hermite_branch kernel;
    std::vector<branch_segment> segments;
    std::vector<branch_end> ends;
    std::vector<glm::vec4> corners;
};

constexpr float untouched = -77.0f;

class expand_test : public device_test {
  protected:
    struct outcome {
        count_record count;
        std::vector<probe_strip_vertex> vertices; ///< the whole buffer, guard included
    };

    /// Expands into room for `capacity` triangles, behind and before which lie guards.
    outcome expand(const strips_scene& scene, range elements, padding policy,
                   std::uint64_t capacity, std::optional<count_record> counted_by = {}) {
        const buffer counts = make(scene.counts);
        const buffer payloads = make(scene.payloads);
        const std::vector<probe_strip_vertex> filled(capacity * 3 + 16,
                                                     {glm::vec4(untouched), glm::vec4(untouched)});
        const buffer out = make(filled);
        const buffer count = make(std::vector<count_record>{{9, 9, {9, 9}}, {9, 9, {9, 9}}});
        const triangle_list<gpu> list{view<gpu, probe_strip_vertex>(out, 8, capacity * 3),
                                      view<gpu, count_record>(count, 1, 1), policy};
        const bindings<gpu, probe_strips> bound{view<gpu>(counts), view<gpu>(payloads)};
        buffer length;
        run([&](recorder& r) {
            if (counted_by) {
                length = make(std::vector<count_record>{*counted_by});
                r.expand(scene.kernel, bound, counted<gpu>{view<gpu>(length), elements.count},
                         list);
            } else {
                r.expand(scene.kernel, bound, elements, list);
            }
        });
        EXPECT_EQ(read<count_record>(count, 1)[0].written, 9u);
        return {read<count_record>(count, 1, 1)[0], read<probe_strip_vertex>(out, filled.size())};
    }

    static void expect_list(const outcome& got, const std::vector<probe_strip_vertex>& expected,
                            std::uint64_t capacity) {
        const std::size_t written = std::min<std::size_t>(expected.size(), capacity * 3);
        EXPECT_EQ(got.count.required, expected.size() / 3);
        EXPECT_EQ(got.count.written, written / 3);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < got.vertices.size(); ++i) {
            const bool inside = i >= 8 && i < 8 + written;
            const probe_strip_vertex wanted =
                inside ? expected[i - 8]
                       : probe_strip_vertex{glm::vec4(untouched), glm::vec4(untouched)};
            if (std::memcmp(&got.vertices[i], &wanted, sizeof(wanted)) != 0 && wrong++ == 0) {
                ADD_FAILURE() << "vertex " << static_cast<std::ptrdiff_t>(i) - 8 << " of "
                              << written << ": element " << got.vertices[i].place.x << ", strip "
                              << got.vertices[i].place.y << ", vertex " << got.vertices[i].place.z
                              << "; expected " << wanted.place.x << ", " << wanted.place.y << ", "
                              << wanted.place.z;
            }
        }
        EXPECT_EQ(wrong, 0u);
    }
};

TEST_F(expand_test, any_number_of_elements_with_both_paddings) {
    for (const std::uint32_t n : {0u, 1u, 63u, 64u, 65u, 10000u}) {
        const strips_scene scene(n, 3, 5);
        for (const padding policy : {padding::compact, padding::degenerate}) {
            SCOPED_TRACE(std::to_string(n) + " elements, padding " +
                         std::to_string(static_cast<int>(policy)));
            const std::uint64_t capacity = n * max_triangles(scene.kernel);
            expect_list(expand(scene, {0, n}, policy, capacity), scene.list({0, n}, policy),
                        capacity);
        }
    }
}

// 128 vertices of 8 components fit into a part: whole strips, one strip, pieces of a strip.
TEST_F(expand_test, strips_longer_than_a_part_keep_their_winding) {
    for (const std::uint32_t most :
         {1u, 2u, 31u, 123u, 124u, 125u, 126u, 127u, 128u, 300u, 1000u}) {
        for (const std::uint32_t strips : {1u, 2u, 7u}) {
            const strips_scene scene(40, strips, most);
            for (const padding policy : {padding::compact, padding::degenerate}) {
                SCOPED_TRACE(std::to_string(strips) + " strips of " + std::to_string(most) +
                             ", padding " + std::to_string(static_cast<int>(policy)));
                const std::uint64_t capacity = 40 * max_triangles(scene.kernel);
                expect_list(expand(scene, {0, 40}, policy, capacity), scene.list({0, 40}, policy),
                            capacity);
            }
        }
    }
}

TEST_F(expand_test, a_part_of_the_elements) {
    const strips_scene scene(100, 2, 9);
    expect_list(expand(scene, {17, 50}, padding::compact, 2000),
                scene.list({17, 50}, padding::compact), 2000);
}

TEST_F(expand_test, nothing_is_written_beyond_the_capacity) {
    const strips_scene scene(100, 3, 7);
    for (const padding policy : {padding::compact, padding::degenerate}) {
        const auto expected = scene.list({0, 100}, policy);
        for (const std::uint64_t capacity :
             {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{100},
              std::uint64_t{expected.size() / 3 - 1}, std::uint64_t{expected.size() / 3},
              std::uint64_t{expected.size() / 3 + 1}}) {
            SCOPED_TRACE(capacity);
            expect_list(expand(scene, {0, 100}, policy, capacity), expected, capacity);
        }
    }
}

TEST_F(expand_test, a_length_that_only_the_device_knows) {
    const strips_scene scene(100, 3, 7);
    for (const std::uint32_t written : {0u, 1u, 64u, 99u, 100u, 5000u}) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            SCOPED_TRACE(written);
            const std::uint32_t n = std::min(written, 100u);
            expect_list(expand(scene, {0, 100}, policy, 2100, count_record{written, 7, {0, 0}}),
                        scene.list({0, n}, policy), 2100);
        }
    }
}

TEST_F(expand_test, without_a_count_and_without_room) {
    const strips_scene scene(10, 2, 3);
    const buffer counts = make(scene.counts);
    const buffer payloads = make(scene.payloads);
    const buffer count = zeros(16);
    const buffer out = zeros(60 * 3 * sizeof(probe_strip_vertex));
    const bindings<gpu, probe_strips> bound{view<gpu>(counts), view<gpu>(payloads)};
    run([&](recorder& r) {
        r.expand(scene.kernel, bound, range{0, 10}, {view<gpu>(out), {}, padding::degenerate});
        r.expand(scene.kernel, bound, range{0, 10}, {{}, view<gpu>(count), padding::degenerate});
    });
    const auto expected = scene.list({0, 10}, padding::degenerate);
    const auto got = read<probe_strip_vertex>(out, expected.size());
    EXPECT_EQ(std::memcmp(got.data(), expected.data(), expected.size() * sizeof(expected[0])), 0);
    EXPECT_EQ(read<count_record>(count, 1)[0].written, 0u);
    EXPECT_EQ(read<count_record>(count, 1)[0].required, 60u);
}

TEST_F(expand_test, twice_in_a_recorder_and_two_recorders_at_once) {
    const strips_scene scene(70, 2, 3);
    const buffer counts = make(scene.counts);
    const buffer payloads = make(scene.payloads);
    const auto expected = scene.list({0, 70}, padding::compact);
    const std::uint64_t bytes = expected.size() * sizeof(probe_strip_vertex);
    const buffer outs[] = {zeros(bytes), zeros(bytes), zeros(bytes)};
    const buffer count = zeros(16 * 3);
    const bindings<gpu, probe_strips> bound{view<gpu>(counts), view<gpu>(payloads)};
    auto first = device().begin();
    auto second = device().begin();
    ASSERT_TRUE(first && second);
    const auto expand_into = [&](recorder& r, std::uint32_t i) {
        r.expand(scene.kernel, bound, range{0, 70},
                 {view<gpu>(outs[i]), view<gpu, count_record>(count, i, 1), padding::compact});
    };
    expand_into(*first, 0);
    expand_into(*second, 1);
    expand_into(*first, 2);
    EXPECT_TRUE(device().submit(*second));
    EXPECT_TRUE(device().submit(*first));
    for (std::uint32_t i = 0; i < 3; ++i) {
        const auto got = read<probe_strip_vertex>(outs[i], expected.size());
        EXPECT_EQ(std::memcmp(got.data(), expected.data(), bytes), 0) << i;
        EXPECT_EQ(read<count_record>(count, 1, i)[0].written, expected.size() / 3);
    }
}

// ---- Branches: floating point, so within a bound ------------------------------------------------

void expect_near(const std::vector<surface_vertex>& got,
                 const std::vector<surface_vertex>& expected) {
    ASSERT_EQ(got.size(), expected.size());
    // Positions reach 16 m, where a float's last bit is 1e-6 m; a few operations are rounded.
    const auto worst = [](glm::vec3 a, glm::vec3 b) {
        return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
    };
    for (std::size_t i = 0; i < got.size(); ++i) {
        const surface_vertex& g = got[i];
        const surface_vertex& e = expected[i];
        const bool near = worst(g.position, e.position) < 2e-5f && std::abs(g.u - e.u) < 1e-6f &&
                          worst(g.normal, e.normal) < 1e-5f && std::abs(g.v - e.v) < 2e-5f &&
                          worst(glm::vec3(g.tangent), glm::vec3(e.tangent)) < 1e-5f &&
                          g.tangent.w == e.tangent.w;
        ASSERT_TRUE(near) << "vertex " << i << " at " << g.position.x << ", " << g.position.y
                          << ", " << g.position.z << "; expected " << e.position.x << ", "
                          << e.position.y << ", " << e.position.z;
    }
}

class branch_test : public device_test {
  protected:
    void expect_branch(const branch_scene& scene, padding policy) {
        const auto n = static_cast<std::uint32_t>(scene.segments.size());
        const auto expected = list_of(
            scene.kernel, {0, n}, policy, std::span<const branch_segment>(scene.segments),
            std::span<const branch_end>(scene.ends), std::span<const glm::vec4>(scene.corners));
        const buffer segments = make(scene.segments);
        const buffer ends = make(scene.ends);
        const buffer corners = make(scene.corners);
        const buffer out = zeros(expected.size() * sizeof(surface_vertex));
        const buffer count = zeros(16);
        run([&](recorder& r) {
            r.expand(scene.kernel, {view<gpu>(segments), view<gpu>(ends), view<gpu>(corners)},
                     range{0, n}, {view<gpu>(out), view<gpu>(count), policy});
        });
        const count_record counted = read<count_record>(count, 1)[0];
        EXPECT_EQ(counted.written, expected.size() / 3);
        EXPECT_EQ(counted.required, expected.size() / 3);
        expect_near(read<surface_vertex>(out, expected.size()), expected);
    }
    void expect_rings(const branch_scene& scene) {
        const auto n = static_cast<std::uint32_t>(scene.segments.size());
        const hermite_branch& k = scene.kernel;
        std::vector<surface_vertex> expected;
        for (std::uint32_t i = 0; i < n; ++i) {
            k.ring(
                i, 0, k.ring_vertices(), [&](const surface_vertex& v) { expected.push_back(v); },
                scene.segments, scene.ends, scene.corners);
        }
        const buffer segments = make(scene.segments);
        const buffer ends = make(scene.ends);
        const buffer corners = make(scene.corners);
        const buffer out = zeros(expected.size() * sizeof(surface_vertex));
        run([&](recorder& r) {
            r.expand_rings(k, {view<gpu>(segments), view<gpu>(ends), view<gpu>(corners)},
                           range{0, n}, view<gpu>(out));
        });
        expect_near(read<surface_vertex>(out, expected.size()), expected);
    }
};

TEST_F(branch_test, lists_of_any_number_of_segments) {
    for (const std::uint32_t n : {0u, 1u, 63u, 64u, 65u, 10000u}) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            SCOPED_TRACE(n);
            expect_branch(branch_scene(n, {3, 2, branch_frame::slerp}), policy);
        }
    }
}

// 85 vertices of 12 components fit into a part.
TEST_F(branch_test, lists_of_polygons_with_few_and_many_sides) {
    for (const std::uint32_t sides : {3u, 8u, 40u, 41u, 42u, 100u}) {
        for (const padding policy : {padding::compact, padding::degenerate}) {
            for (const branch_frame frame :
                 {branch_frame::slerp, branch_frame::rotation_minimising}) {
                SCOPED_TRACE(sides);
                expect_branch(branch_scene(30, {sides, 4, frame}), policy);
            }
        }
    }
}

TEST_F(branch_test, rings_of_any_number_of_segments) {
    for (const std::uint32_t n : {0u, 1u, 63u, 64u, 65u, 10000u}) {
        SCOPED_TRACE(n);
        expect_rings(branch_scene(n, {8, 4, branch_frame::slerp}));
    }
}

TEST_F(branch_test, rings_that_are_cut_into_parts) {
    for (const std::uint32_t sides : {3u, 20u, 21u, 83u, 84u, 85u, 100u}) {
        for (const branch_frame frame : {branch_frame::slerp, branch_frame::rotation_minimising}) {
            SCOPED_TRACE(sides);
            expect_rings(branch_scene(30, {sides, 4, frame}));
        }
    }
}

TEST_F(device_test, rings_come_in_order_and_stop_at_the_last_whole_element) {
    std::vector<glm::vec4> payload_values;
    for (int i = 0; i < 70; ++i) {
        payload_values.emplace_back(i * 2, i * 3, 0, 0);
    }
    const buffer payloads = make(payload_values);
    // 256 vertices fit into a part.
    for (const std::uint32_t around : {3u, 255u, 256u, 257u, 1000u}) {
        for (const std::uint32_t room : {0u, 1u, 65 * around - 1, 65 * around}) {
            SCOPED_TRACE(std::to_string(around) + " around, room for " + std::to_string(room));
            const std::vector<probe_ring_vertex> filled(room + 8, {glm::vec4(untouched)});
            const buffer out = make(filled);
            run([&](recorder& r) {
                r.expand_rings(probe_rings{around}, {view<gpu>(payloads)}, range{5, 65},
                               view<gpu, probe_ring_vertex>(out, 4, room));
            });
            const auto got = read<probe_ring_vertex>(out, filled.size());
            std::size_t wrong = 0;
            for (std::uint32_t i = 0; i < got.size(); ++i) {
                glm::vec4 expected(untouched);
                if (i >= 4 && i < 4 + room / around * around) {
                    const std::uint32_t element = 5 + (i - 4) / around;
                    expected = {element, (i - 4) % around, element * 2, element * 3};
                }
                wrong += got[i].place == expected ? 0 : 1;
            }
            EXPECT_EQ(wrong, 0u);
        }
    }
}

// More points than one draw takes, which nobody has the memory to test, by smaller draws.
TEST_F(expand_test, several_draws_are_as_one) {
    const strips_scene scene(100, 3, 60);
    const buffer counts = make(scene.counts);
    const buffer payloads = make(scene.payloads);
    const buffer length = make(std::vector<count_record>{{77, 0, {0, 0}}});
    auto made = detail::context::create(
        {[](const char* name, void* user) { return static_cast<headless*>(user)->find(name); },
         owner.get(), nullptr, nullptr});
    ASSERT_TRUE(made);
    detail::context& context = **made;
    const auto expected = scene.list({0, 77}, padding::compact);
    const std::uint64_t bytes = expected.size() * sizeof(probe_strip_vertex);
    const auto whole = [](const buffer& b) {
        return detail::bound_range{b.name(), 0, static_cast<std::ptrdiff_t>(b.size_bytes())};
    };
    const detail::bound_range buffers[] = {whole(counts), whole(payloads)};
    for (const bool counted : {false, true}) {
        const buffer out = zeros(bytes);
        const buffer count = zeros(16);
        detail::expansion expansion;
        expansion.vertex_text = program<probe_strips>::expand_vert;
        expansion.geometry_text = program<probe_strips>::strips_geom;
        expansion.primitive = gl::triangles;
        expansion.parts = detail::strip_parts(3, 60, sizeof(probe_strip_vertex), padding::compact);
        expansion.vertices = whole(out);
        expansion.count = whole(count);
        expansion.points_a_draw = 23;
        const auto done = detail::expand(
            context, {detail::bytes_of(scene.kernel), buffers},
            {0, counted ? 100u : 77u, counted ? whole(length) : detail::bound_range{}}, expansion);
        ASSERT_TRUE(done) << done.error().message;
        const auto checked = context.check("testing");
        ASSERT_TRUE(checked) << checked.error().message;
        const auto got = read<probe_strip_vertex>(out, expected.size());
        EXPECT_EQ(std::memcmp(got.data(), expected.data(), bytes), 0);
        EXPECT_EQ(read<count_record>(count, 1)[0].written, expected.size() / 3);
    }
}

// ---- How elements are cut -----------------------------------------------------------------------

TEST(element_parts, never_exceed_what_a_geometry_shader_may_emit) {
    for (const std::size_t bytes : {16u, 32u, 48u, 64u, 256u}) {
        const std::uint64_t components = bytes / 4;
        for (std::uint32_t vertices = 1; vertices < 2000; ++vertices) {
            const auto parts = detail::ring_parts(vertices, bytes);
            ASSERT_LE(parts.max_vertices * components, 1024u) << vertices;
            ASSERT_LE(parts.max_vertices, 256u);
            ASSERT_GE(parts.count * parts.size, vertices);
            ASSERT_LT((parts.count - 1) * parts.size, vertices);
        }
        for (std::uint32_t triangles = 1; triangles < 600; ++triangles) {
            for (const std::uint32_t strips : {1u, 2u, 5u, 100u}) {
                for (const padding policy : {padding::compact, padding::degenerate}) {
                    const auto parts = detail::strip_parts(strips, triangles, bytes, policy);
                    ASSERT_LE(parts.max_vertices * components, 1024u) << triangles;
                    ASSERT_LE(parts.max_vertices, 256u);
                    ASSERT_TRUE(parts.size % triangles == 0 || parts.size % 2 == 0);
                    ASSERT_GE(parts.count * parts.size, std::uint64_t{strips} * triangles);
                }
            }
        }
    }
}

} // namespace
} // namespace skybark::opengl::tests
