// map over ranges, over consecutive ranges, and over a length that only the device knows.

#include "support.hpp"

namespace skybark::opengl::tests {
namespace {

using kernels::probe_level;
using kernels::probe_map;
using kernels::probe_node;

class map_test : public device_test {
  protected:
    /// Maps over `work(recorder, kernel, bindings)` and says which elements were written.
    template <class Work>
    std::vector<std::uint32_t> mapped(std::uint32_t n, Work&& work) {
        std::vector<std::uint32_t> numbers(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            numbers[i] = i * 7;
        }
        const buffer in = make(numbers);
        const buffer vectors = make(std::vector<glm::vec4>(n, glm::vec4(1, 2, 3, 4)));
        const buffer out = zeros(n * sizeof(std::uint32_t));
        const buffer vectors_out = zeros(n * sizeof(glm::vec4));
        const probe_map kernel{3, 5, 2.0f, 1.0f};
        run([&](recorder& r) {
            work(r, kernel,
                 bindings<gpu, probe_map>{view<gpu>(in), view<gpu>(vectors), view<gpu>(out),
                                          view<gpu>(vectors_out)});
        });
        const auto scaled = read<glm::vec4>(vectors_out, n);
        const auto got = read<std::uint32_t>(out, n);
        for (std::uint32_t i = 0; i < n; ++i) {
            EXPECT_EQ(scaled[i], got[i] != 0 ? glm::vec4(3, 5, 7, 9) : glm::vec4(0)) << i;
            if (testing::Test::HasFailure()) {
                break;
            }
        }
        return got;
    }
    static void expect_mapped(const std::vector<std::uint32_t>& got, std::uint32_t first,
                              std::uint32_t count) {
        for (std::uint32_t i = 0; i < got.size(); ++i) {
            const bool inside = i >= first && i - first < count;
            ASSERT_EQ(got[i], inside ? i * 7 * 3 + 5 + i : 0) << i;
        }
    }
};

TEST_F(map_test, each_element_of_a_range_and_no_other) {
    for (const std::uint32_t n : {1u, 63u, 64u, 65u, 10000u}) {
        for (const range r : {range{0, n}, range{n / 2, n - n / 2}, range{n / 3, n / 3}}) {
            SCOPED_TRACE(n);
            expect_mapped(mapped(n, [&](recorder& to, const probe_map& k,
                                        const auto& b) { to.map(k, b, r); }),
                          r.first, r.count);
        }
    }
}

// 65,535 groups of 64 are one row of a dispatch.
TEST_F(map_test, more_groups_than_a_row_holds) {
    const std::uint32_t n = 65535 * 64 + 100;
    expect_mapped(mapped(n,
                         [&](recorder& to, const probe_map& k, const auto& b) {
                             to.map(k, b, range{0, n});
                         }),
                  0, n);
    const buffer count = make(std::vector<count_record>{{n - 1, 0, {0, 0}}});
    expect_mapped(mapped(n,
                         [&](recorder& to, const probe_map& k, const auto& b) {
                             to.map(k, b, counted<gpu>{view<gpu>(count), n});
                         }),
                  0, n - 1);
}

TEST_F(map_test, a_length_that_only_the_device_knows) {
    for (const std::uint32_t written : {0u, 1u, 63u, 64u, 65u, 500u, 1000u, 4000000000u}) {
        SCOPED_TRACE(written);
        const buffer count = make(std::vector<count_record>{{1, 1, {0, 0}}, {written, 0, {0, 0}}});
        expect_mapped(
            mapped(1000,
                   [&](recorder& to, const probe_map& k, const auto& b) {
                       to.map(k, b, counted<gpu>{view<gpu, count_record>(count, 1, 1), 900});
                   }),
            0, std::min(written, 900u));
    }
}

// ---- Consecutive ranges -------------------------------------------------------------------------

/// A tree of levels of these sizes, each node's parent anywhere in the last level that has any.
struct tree {
    explicit tree(const std::vector<std::uint32_t>& sizes) {
        range parents{};
        std::uint32_t random = 7;
        for (const std::uint32_t size : sizes) {
            const range level{static_cast<std::uint32_t>(nodes.size()), size};
            for (std::uint32_t i = level.first; i < level.first + size; ++i) {
                random = random * 1664525 + 1013904223;
                const std::uint32_t parent =
                    parents.count == 0 ? i : parents.first + (random >> 8) % parents.count;
                nodes.push_back({parent, random >> 16});
                values.push_back(parent == i ? nodes[i].weight
                                             : values[parent] * 3 + nodes[i].weight);
            }
            levels.push_back(level);
            parents = size != 0 ? level : parents;
        }
    }
    std::vector<probe_node> nodes;
    std::vector<std::uint32_t> values;
    std::vector<range> levels;
};

class levels_test : public device_test {
  protected:
    void expect_levels(const std::vector<std::uint32_t>& sizes) {
        const tree t(sizes);
        const buffer nodes = make(t.nodes);
        const buffer values = zeros(t.nodes.size() * 4);
        run([&](recorder& r) {
            r.map(probe_level{}, {view<gpu>(nodes), view<gpu>(values), view<gpu>(values)},
                  std::span<const range>(t.levels));
        });
        EXPECT_EQ(read<std::uint32_t>(values, t.nodes.size()), t.values);
    }
};

TEST_F(levels_test, a_deep_tree_with_empty_levels) {
    std::vector<std::uint32_t> sizes;
    for (std::uint32_t i = 0; i < 150; ++i) {
        sizes.push_back(i % 10 == 3 ? 0 : 1 + i * 37 % 700);
    }
    expect_levels(sizes);
}

TEST_F(levels_test, levels_on_both_sides_of_the_limit_of_a_workgroup) {
    expect_levels({1, 256, 257, 4095, 4096, 4097, 20000, 1, 1, 4097, 4097, 0, 4096, 0, 30000, 5});
}

TEST_F(levels_test, none_one_and_empty_ones) {
    expect_levels({});
    expect_levels({0});
    expect_levels({1});
    expect_levels({0, 0, 5, 0});
}

// More rounds than Mesa's software rasterisers give to one dispatch's loop.
TEST_F(levels_test, a_chain_of_more_levels_than_a_loop_has_rounds) {
    expect_levels(std::vector<std::uint32_t>(70000, 1));
    expect_levels(std::vector<std::uint32_t>(5000, 4096));
}

} // namespace
} // namespace skybark::opengl::tests
