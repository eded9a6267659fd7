// map, expand, expand_rings and scan against plain loops over the same kernels in C++.
#include "support.hpp"

namespace skybark::testing {
namespace {

using kernels::hermite_branch;
using kernels::probe_level;
using kernels::probe_map;
using kernels::probe_node;
using kernels::probe_rings;
using kernels::probe_strips;
using probe_strip_vertex = probe_strips::vertex;

class patterns : public both_ways {};
INSTANTIATE_TEST_SUITE_P(vulkan, patterns, ::testing::Bool(), way_name);

constexpr std::uint32_t sizes[] = {0, 1, 63, 64, 65, 1000};

// ---- map

struct map_case {
    std::vector<std::uint32_t> numbers;
    std::vector<glm::vec4> vectors;
    vulkan::buffer in, in_vectors, out, out_vectors;

    map_case(device& d, std::uint32_t n)
        : numbers(make_numbers(n)), vectors(n, glm::vec4{1, 2, 3, 4}), in(upload(d, numbers)),
          in_vectors(upload(d, vectors)), out(must(d.create_buffer(n * 4ull))),
          out_vectors(must(d.create_buffer(n * 16ull))) {}

    static std::vector<std::uint32_t> make_numbers(std::uint32_t n) {
        std::vector<std::uint32_t> v(n);
        noise random;
        for (auto& x : v) {
            x = random();
        }
        return v;
    }
    [[nodiscard]] bound<probe_map> bindings() const {
        return {view<device>(in), view<device>(in_vectors), view<device>(out),
                view<device>(out_vectors)};
    }
    /// What the first `n` numbers out should be, the rest being zero.
    [[nodiscard]] std::vector<std::uint32_t> expected(const probe_map& k, range r) const {
        std::vector<std::uint32_t> e(numbers.size());
        for (std::uint32_t i = r.first; i < r.first + r.count; ++i) {
            e[i] = numbers[i] * k.factor + k.offset + i;
        }
        return e;
    }
};

TEST_P(patterns, map_runs_each_element_of_a_range_once) {
    const probe_map k{3, 7, 2.0f, 1.0f};
    for (const std::uint32_t n : sizes) {
        map_case c(gpu(), n);
        const range r{n / 3, n - n / 3};
        go(gpu(), [&](auto& rec) { rec.map(k, c.bindings(), r); });
        EXPECT_EQ(download<std::uint32_t>(gpu(), c.out, n), c.expected(k, r)) << n;
        const auto vectors = download<glm::vec4>(gpu(), c.out_vectors, n);
        for (std::uint32_t i = r.first; i < n; ++i) {
            ASSERT_EQ(vectors[i], (glm::vec4{3, 5, 7, 9}));
        }
    }
}

TEST_P(patterns, map_goes_past_65535_groups) {
    const std::uint32_t n = 65535 * 64 + 1;
    if (n * 16ull > gpu().limits().max_buffer_bytes) {
        GTEST_SKIP() << "views of this device are too small";
    }
    const probe_map k{5, 1, 1.0f, 0.0f};
    map_case c(gpu(), n);
    go(gpu(), [&](auto& rec) { rec.map(k, c.bindings(), range{0, n}); });
    EXPECT_TRUE(download<std::uint32_t>(gpu(), c.out, n) == c.expected(k, {0, n}));
}

TEST_P(patterns, map_takes_its_length_from_the_device) {
    const probe_map k{1, 0, 1.0f, 0.0f};
    for (const std::uint32_t limit : {100u, 40000u}) {
        for (const std::uint32_t length : {0u, 1u, 64u, 99u, 100u, 39999u, 50000u}) {
            map_case c(gpu(), limit);
            const auto count = upload(gpu(), std::vector<count_record>{{length, ~0u, {}}});
            go(gpu(), [&](auto& rec) {
                rec.map(k, c.bindings(), counted<device>{view<device>(count), limit});
            });
            EXPECT_EQ(download<std::uint32_t>(gpu(), c.out, limit),
                      c.expected(k, {0, std::min(limit, length)}))
                << limit << " " << length;
        }
    }
}

/// Trees of 150 levels, some empty and some too large for a shared workgroup.
struct levels_case {
    std::vector<probe_node> nodes;
    std::vector<range> levels;

    levels_case() {
        noise random;
        std::uint32_t parents_first = 0;
        std::uint32_t parents = 0;
        for (std::uint32_t level = 0; level < 150; ++level) {
            const std::uint32_t count = level % 50 == 40   ? 0
                                        : level % 50 == 20 ? 5000
                                                           : 1 + random() % 600;
            const auto first = static_cast<std::uint32_t>(nodes.size());
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint32_t parent =
                    level == 0 ? first + i : parents_first + random() % parents;
                nodes.push_back({parent, random()});
            }
            levels.push_back({first, count});
            if (count != 0) {
                parents_first = first;
                parents = count;
            }
        }
    }
    [[nodiscard]] std::vector<std::uint32_t> expected() const {
        std::vector<std::uint32_t> values(nodes.size());
        for (std::uint32_t i = 0; i < nodes.size(); ++i) { // parents come before children
            probe_level{}.map(i, nodes, values, values);
        }
        return values;
    }
};

TEST_P(patterns, consecutive_ranges_see_what_the_ones_before_wrote) {
    const levels_case c;
    const auto nodes = upload(gpu(), c.nodes);
    const auto values = must(gpu().create_buffer(c.nodes.size() * 4));
    const bound<probe_level> b{view<device>(nodes), view<device>(values), view<device>(values)};
    go(gpu(), [&](auto& rec) { rec.map(probe_level{}, b, std::span<const range>(c.levels)); });
    EXPECT_EQ(download<std::uint32_t>(gpu(), values, c.nodes.size()), c.expected());
}

TEST_P(patterns, very_many_small_ranges_are_cut_into_several_runs) {
    // A software rasteriser ends a shader's loops after 65,535 turns and says nothing.
    const std::uint32_t n = 70000;
    std::vector<probe_node> nodes(n);
    std::vector<range> ranges(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        nodes[i] = {i == 0 ? 0 : i - 1, 1};
        ranges[i] = {i, 1};
    }
    const auto in = upload(gpu(), nodes);
    const auto values = must(gpu().create_buffer(n * 4ull));
    const bound<probe_level> b{view<device>(in), view<device>(values), view<device>(values)};
    go(gpu(), [&](auto& rec) { rec.map(probe_level{}, b, std::span<const range>(ranges)); });
    std::vector<std::uint32_t> expected(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        expected[i] = i == 0 ? 1 : expected[i - 1] * 3 + 1;
    }
    EXPECT_TRUE(download<std::uint32_t>(gpu(), values, n) == expected);
}

TEST_P(patterns, a_range_after_another_in_one_recorder_sees_its_results) {
    const levels_case c;
    const auto nodes = upload(gpu(), c.nodes);
    const auto values = must(gpu().create_buffer(c.nodes.size() * 4));
    const bound<probe_level> b{view<device>(nodes), view<device>(values), view<device>(values)};
    go(gpu(), [&](auto& rec) {
        for (const range r : c.levels) {
            rec.map(probe_level{}, b, r);
        }
    });
    EXPECT_EQ(download<std::uint32_t>(gpu(), values, c.nodes.size()), c.expected());
}

// ---- scan

TEST_P(patterns, scan_is_exact_at_any_length) {
    for (const std::uint32_t n : {0u, 1u, 4095u, 4096u, 4097u, 1000001u, 4096u * 4096u + 1}) {
        std::vector<std::uint32_t> values(n);
        noise random;
        for (auto& v : values) {
            v = random() % 200;
        }
        const auto b = upload(gpu(), values);
        const auto total = must(gpu().create_buffer(16));
        go(gpu(), [&](auto& rec) { rec.scan(view<device>(b), view<device>(total)); });
        std::uint32_t sum = 0;
        for (auto& v : values) {
            sum += std::exchange(v, sum);
        }
        EXPECT_TRUE(download<std::uint32_t>(gpu(), b, n) == values) << n;
        EXPECT_EQ(download<std::uint32_t>(gpu(), total, 1)[0], sum) << n;
    }
}

TEST_P(patterns, scan_stops_at_the_largest_number) {
    const std::vector<std::uint32_t> values{1u << 31, 5, 1u << 31, 7, 0};
    const auto b = upload(gpu(), values);
    const auto total = must(gpu().create_buffer(16));
    go(gpu(), [&](auto& rec) { rec.scan(view<device>(b), view<device>(total)); });
    EXPECT_EQ(download<std::uint32_t>(gpu(), b, 5),
              (std::vector<std::uint32_t>{0, 1u << 31, (1u << 31) + 5, ~0u, ~0u}));
    EXPECT_EQ(download<std::uint32_t>(gpu(), total, 1)[0], ~0u);
}

// ---- sort

static_assert(sorts<device>);

/// Pairs sorted by fewer bits, against a stable sort; whatever the number of passes.
TEST_P(patterns, sort_takes_only_the_bits_that_keys_have) {
    noise random;
    for (const std::uint32_t bits : {0u, 1u, 4u, 5u, 8u, 11u, 17u, 20u, 32u}) {
        const std::uint32_t n = 2500;
        std::vector<std::uint32_t> keys(n);
        std::vector<std::uint32_t> order(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            keys[i] = bits == 0 ? 0 : random() >> (32 - bits);
            order[i] = i;
        }
        for (const std::uint32_t length : {n, 1500u}) {
            const auto in = upload(gpu(), keys);
            const auto values = upload(gpu(), order);
            const auto count = upload(gpu(), std::vector<count_record>{{length, length, {}}});
            go(gpu(), [&](auto& rec) {
                const auto k = view<device>(in);
                const auto v = view<device>(values);
                if (length == n) {
                    rec.sort(k, v, bits);
                } else {
                    rec.sort(k, v, counted<device>{view<device>(count), n}, bits);
                }
            });
            auto expected = order;
            std::stable_sort(expected.begin(), expected.begin() + length,
                             [&](auto a, auto b) { return keys[a] < keys[b]; });
            std::vector<std::uint32_t> expected_keys(n);
            for (std::uint32_t i = 0; i < n; ++i) {
                expected_keys[i] = keys[expected[i]];
            }
            EXPECT_EQ(download<std::uint32_t>(gpu(), values, n), expected) << bits << " " << length;
            EXPECT_EQ(download<std::uint32_t>(gpu(), in, n), expected_keys) << bits;
        }
    }
}

// ---- expand into a list

/// Elements with random numbers of triangles, and their list by a plain loop.
struct strips_case {
    probe_strips kernel;
    std::vector<std::uint32_t> counts;
    std::vector<glm::vec4> payloads;

    strips_case(std::uint32_t elements, std::uint32_t strips, std::uint32_t most)
        : kernel{strips, most}, counts(std::size_t{elements} * strips), payloads(elements) {
        noise random;
        for (auto& c : counts) {
            c = random() % (most + 1);
        }
        for (auto& p : payloads) {
            p = {random.unit(), random.unit(), random.unit(), random.unit()};
        }
    }

    [[nodiscard]] std::vector<probe_strip_vertex> expected(range r, padding policy) const {
        std::vector<probe_strip_vertex> list;
        for (std::uint32_t i = r.first; i < r.first + r.count; ++i) {
            for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
                const std::uint32_t n = kernel.triangles(i, s, counts, payloads);
                std::vector<probe_strip_vertex> v;
                if (n != 0) {
                    kernel.strip(
                        i, s, 0, n + 2, [&](const auto& one) { v.push_back(one); }, counts,
                        payloads);
                }
                for (std::uint32_t t = 0; t < n; ++t) {
                    list.push_back(v[t + t % 2]);
                    list.push_back(v[t + 1 - t % 2]);
                    list.push_back(v[t + 2]);
                }
                if (policy == padding::degenerate) {
                    list.resize(list.size() + std::size_t{3} * (kernel.most - n));
                }
            }
        }
        return list;
    }
};

bool same(const std::vector<probe_strip_vertex>& a, const std::vector<probe_strip_vertex>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

constexpr std::size_t guard = 64; // vertices behind the view that nobody may touch
const probe_strip_vertex guarded{{1, 2, 3, 4}, {5, 6, 7, 8}};

/// Expands into a list with room for `room` triangles, and checks all that was and wasn't written.
void check_list(device& d, const strips_case& c, range r, padding policy, std::uint32_t room,
                std::optional<std::uint32_t> length = {}) {
    SCOPED_TRACE("elements " + std::to_string(r.count) + ", strips " +
                 std::to_string(c.kernel.strip_count) + ", most " + std::to_string(c.kernel.most) +
                 ", room " + std::to_string(room) +
                 (policy == padding::compact ? ", compact" : ", degenerate"));
    const auto counts = upload(d, c.counts);
    const auto payloads = upload(d, c.payloads);
    const std::size_t vertices = std::size_t{3} * room;
    const auto out = upload(d, std::vector<probe_strip_vertex>(vertices + guard, guarded));
    const auto record = must(d.create_buffer(16));
    const auto count = upload(d, std::vector<count_record>{{length.value_or(0), 0, {}}});
    const bound<probe_strips> b{view<device>(counts), view<device>(payloads)};
    // Two bytes short of another triangle.
    const buffer_view<device> place{&out, 0, vertices * sizeof(probe_strip_vertex) + 92};
    const triangle_list<device> list{place, view<device>(record), policy};
    go(d, [&](auto& rec) {
        if (length) {
            rec.expand(c.kernel, b, counted<device>{view<device>(count), r.count}, list);
        } else {
            rec.expand(c.kernel, b, r, list);
        }
    });
    if (length) {
        r.count = std::min(r.count, *length);
    }
    auto expected = c.expected(r, policy);
    const auto required = static_cast<std::uint32_t>(expected.size() / 3);
    const auto got = download<count_record>(d, record, 1)[0];
    EXPECT_EQ(got.required, required);
    EXPECT_EQ(got.written, std::min(required, room));
    expected.resize(std::min(expected.size(), vertices));
    expected.resize(vertices + guard, guarded);
    EXPECT_TRUE(same(download<probe_strip_vertex>(d, out, vertices + guard), expected));
}

TEST_P(patterns, expand_makes_the_same_list_as_a_plain_loop) {
    for (const padding policy : {padding::degenerate, padding::compact}) {
        for (const std::uint32_t n : sizes) {
            check_list(gpu(), strips_case(n, 3, 7), {0, n}, policy, n * 21);
        }
        check_list(gpu(), strips_case(100, 1, 1), {30, 50}, policy, 100);
        check_list(gpu(), strips_case(20, 1, 3000), {0, 20}, policy, 60000); // many parts
        check_list(gpu(), strips_case(5, 700, 2), {0, 5}, policy, 7000);
    }
}

TEST_P(patterns, expand_writes_what_fits_and_nothing_behind_it) {
    const strips_case c(200, 2, 9);
    for (const padding policy : {padding::degenerate, padding::compact}) {
        const auto all = static_cast<std::uint32_t>(c.expected({0, 200}, policy).size() / 3);
        for (const std::uint32_t room : {0u, 1u, 17u, 18u, 19u, all - 1, all, all + 1}) {
            check_list(gpu(), c, {0, 200}, policy, room);
        }
    }
}

TEST_P(patterns, expand_takes_its_length_from_the_device) {
    const strips_case c(300, 2, 5);
    for (const padding policy : {padding::degenerate, padding::compact}) {
        for (const std::uint32_t length : {0u, 1u, 64u, 299u, 300u, 1000u}) {
            check_list(gpu(), c, {0, 300}, policy, 3000, length);
        }
    }
    const strips_case many(30000, 1, 2); // above this many, dispatches are indirect
    for (const padding policy : {padding::degenerate, padding::compact}) {
        check_list(gpu(), many, {0, 30000}, policy, 60000, 20001);
        check_list(gpu(), many, {0, 30000}, policy, 60000, 0);
    }
}

TEST_P(patterns, expand_goes_past_65535_groups) {
    const std::uint32_t n = 65535 * 64 + 1;
    if (n * 16ull > gpu().limits().max_buffer_bytes) {
        GTEST_SKIP() << "views of this device are too small";
    }
    strips_case c(n, 1, 1);
    for (std::uint32_t i = 0; i < n; ++i) { // a list that fits: every 64th element has a triangle
        c.counts[i] = i % 64 == 0;
    }
    check_list(gpu(), c, {0, n}, padding::compact, n / 64 + 1);
}

TEST_P(patterns, required_stops_at_the_largest_number) {
    // 2^17 elements of 2^16 triangles are 2^33.
    const std::uint32_t n = 1u << 17;
    probe_strips k{1, 1u << 16};
    const auto counts = upload(gpu(), std::vector<std::uint32_t>(n, 1u << 16));
    const auto payloads = upload(gpu(), std::vector<glm::vec4>(n));
    const auto out = must(gpu().create_buffer(100 * 96));
    const auto record = must(gpu().create_buffer(16));
    const bound<probe_strips> b{view<device>(counts), view<device>(payloads)};
    for (const padding policy : {padding::degenerate, padding::compact}) {
        if (policy == padding::compact && GetParam()) {
            continue; // 2^32 invocations that find nothing to do: minutes on a software device
        }
        go(gpu(), [&](auto& rec) {
            rec.expand(k, b, range{0, n}, {view<device>(out), view<device>(record), policy});
        });
        const auto got = download<count_record>(gpu(), record, 1)[0];
        EXPECT_EQ(got.written, 100u);
        EXPECT_EQ(got.required, ~0u);
        EXPECT_EQ(download<probe_strip_vertex>(gpu(), out, 300)[299].place.z, 101.0f);
    }
}

TEST_P(patterns, an_expansion_gives_the_next_pattern_its_length) {
    const strips_case c(100, 2, 5);
    const auto list = c.expected({0, 100}, padding::compact);
    const auto triangles = static_cast<std::uint32_t>(list.size() / 3);
    const auto counts = upload(gpu(), c.counts);
    const auto payloads = upload(gpu(), c.payloads);
    const auto out = must(gpu().create_buffer(1000 * 96));
    const auto record = must(gpu().create_buffer(16));
    map_case mapped(gpu(), 1000);
    const probe_map k{1, 9, 1.0f, 0.0f};
    const bound<probe_strips> b{view<device>(counts), view<device>(payloads)};
    go(gpu(), [&](auto& rec) {
        rec.expand(c.kernel, b, range{0, 100},
                   {view<device>(out), view<device>(record), padding::compact});
        rec.map(k, mapped.bindings(), counted<device>{view<device>(record), 1000});
    });
    EXPECT_EQ(download<std::uint32_t>(gpu(), mapped.out, 1000), mapped.expected(k, {0, triangles}));
}

// ---- expand into rings

TEST_P(patterns, rings_are_the_same_as_a_plain_loop_and_only_whole_elements_are_written) {
    for (const std::uint32_t around : {3u, 64u, 5000u}) {
        for (const std::uint32_t n : sizes) {
            if (n * around > 100000) {
                continue;
            }
            std::vector<glm::vec4> payloads(n + 3, glm::vec4{0.5f, 0.25f, 0, 0});
            const auto in = upload(gpu(), payloads);
            const probe_rings k{around};
            // Room for one element less, and some.
            const std::uint32_t fit = n == 0 ? 0 : n - 1;
            const std::vector<glm::vec4> before((n + 1) * std::size_t{around}, glm::vec4{-1});
            const auto out = upload(gpu(), before);
            go(gpu(), [&](auto& rec) {
                rec.expand_rings(k, bound<probe_rings>{view<device>(in)}, range{3, n},
                                 buffer_view<device>{&out, 0, fit * around * 16ull + 32});
            });
            std::vector<glm::vec4> expected = before;
            for (std::uint32_t i = 0; i < fit; ++i) {
                for (std::uint32_t j = 0; j < around; ++j) {
                    expected[std::size_t{i} * around + j] = {static_cast<float>(3 + i),
                                                             static_cast<float>(j), 0.5f, 0.25f};
                }
            }
            EXPECT_TRUE(download<glm::vec4>(gpu(), out, before.size()) == expected)
                << n << " of " << around;
        }
    }
}

TEST_P(patterns, branches_are_the_same_as_on_the_host) {
    const hermite_branch k{6, 5, kernels::branch_frame::slerp};
    noise random;
    std::vector<branch_end> ends(201);
    std::vector<branch_segment> segments(200);
    for (auto& e : ends) {
        const glm::vec4 q{random.unit() - 0.5f, random.unit() - 0.5f, random.unit() - 0.5f, 1.0f};
        e.position = {random.unit(), random.unit(), random.unit()};
        e.orientation = q / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        e.radius = random.unit();
    }
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
        segments[i] = {i, i + 1, i % 4, 0};
    }
    std::vector<glm::vec4> corners;
    for (std::uint32_t i = 0; i <= 6; ++i) {
        const double angle = 6.283185307179586 * (i % 6) / 6;
        corners.push_back({std::cos(angle), std::sin(angle), static_cast<float>(i) / 6, 0});
    }
    const auto bs = upload(gpu(), segments);
    const auto be = upload(gpu(), ends);
    const auto bc = upload(gpu(), corners);
    const std::size_t vertices = segments.size() * k.ring_vertices();
    const auto out = must(gpu().create_buffer(vertices * sizeof(surface_vertex)));
    go(gpu(), [&](auto& rec) {
        rec.expand_rings(k, {view<device>(bs), view<device>(be), view<device>(bc)}, range{0, 200},
                         view<device>(out));
    });
    const auto got = download<surface_vertex>(gpu(), out, vertices);
    std::size_t at = 0;
    float worst = 0;
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
        k.ring(
            i, 0, k.ring_vertices(),
            [&](const surface_vertex& v) {
                const glm::vec3 d = v.position - got[at].position;
                const glm::vec3 n = v.normal - got[at++].normal;
                worst = std::max({worst, std::abs(d.x), std::abs(d.y), std::abs(d.z), std::abs(n.x),
                                  std::abs(n.y), std::abs(n.z)});
            },
            std::span<const branch_segment>(segments), std::span<const branch_end>(ends),
            std::span<const glm::vec4>(corners));
    }
    EXPECT_LE(worst, 4e-6f); // positions of about 1 m, a few roundings of the driver's own choosing
}

// ---- copies

TEST_P(patterns, copies_and_uploads_keep_their_order) {
    const auto a = upload(gpu(), std::vector<std::uint32_t>(64, 1));
    const auto b = must(gpu().create_buffer(256));
    auto recorder = must(gpu().begin());
    {
        std::vector<std::uint32_t> soon_gone(64, 2);
        recorder.copy(view<device>(a), view<device>(b)); // b = 1
        recorder.upload(view<device>(a), bytes_of(soon_gone));
        recorder.copy({&a, 0, 128}, {&b, 128, 128}); // the second half of b = 2
    }
    must(gpu().submit(recorder));
    std::vector<std::uint32_t> expected(64, 1);
    std::fill(expected.begin() + 32, expected.end(), 2);
    EXPECT_EQ(download<std::uint32_t>(gpu(), b, 64), expected);
    EXPECT_EQ(download<std::uint32_t>(gpu(), a, 64), std::vector<std::uint32_t>(64, 2));
}

TEST_P(patterns, large_transfers_go_in_pieces) {
    std::vector<std::uint32_t> words((20u << 20) / 4 + 3);
    noise random;
    for (auto& w : words) {
        w = random();
    }
    const auto b = upload(gpu(), words);
    EXPECT_TRUE(download<std::uint32_t>(gpu(), b, words.size()) == words);
}

TEST_P(patterns, new_buffers_hold_zeros) {
    for (int i = 0; i < 3; ++i) {
        auto b = must(gpu().create_buffer(100003 * 4));
        EXPECT_TRUE(download<std::uint32_t>(gpu(), b, 100003) ==
                    std::vector<std::uint32_t>(100003));
        must(gpu().upload(b, 0, bytes_of(std::vector<std::uint32_t>(100003, ~0u))));
    }
}

TEST_P(patterns, traffic_counts_what_crosses) {
    const auto before = gpu().traffic();
    const auto b = upload(gpu(), std::vector<std::uint32_t>(100));
    go(gpu(), [&](auto& rec) {
        rec.upload({&b, 0, 40}, bytes_of(std::vector<std::uint32_t>(10)));
        rec.copy({&b, 0, 40}, {&b, 256, 40});
    });
    (void)download<std::uint32_t>(gpu(), b, 50);
    const auto after = gpu().traffic();
    EXPECT_EQ(after.up - before.up, 440u);
    EXPECT_EQ(after.down - before.down, 200u);
}

} // namespace
} // namespace skybark::testing
