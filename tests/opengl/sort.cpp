// sort by as many bits as keys have: any number of bits, against the standard library, in place
// between words that nobody may touch.

#include "support.hpp"

#include <algorithm>
#include <random>

namespace skybark::opengl::tests {
namespace {

static_assert(sorts<gpu>);

struct pair {
    std::uint32_t key = 0;
    std::uint32_t value = 0;

    [[nodiscard]] bool operator==(const pair&) const = default;
};

constexpr std::uint32_t guard = 0xabadcafeu;
/// Words before and after what is sorted: a multiple of any view's alignment.
constexpr std::uint32_t guards = 64;

class sort_test : public device_test {
  protected:
    using words = std::vector<std::uint32_t>;

    static std::vector<pair> pairs_below(std::uint32_t n, std::uint32_t bits, std::uint32_t seed) {
        std::mt19937 random(seed);
        std::vector<pair> pairs(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            const auto key = static_cast<std::uint32_t>(random());
            pairs[i] = {bits == 0 ? 0 : key >> (32 - bits), i};
        }
        return pairs;
    }
    static std::vector<pair> sorted(std::vector<pair> pairs, std::size_t count) {
        std::stable_sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(count),
                         [](const pair& a, const pair& b) { return a.key < b.key; });
        return pairs;
    }
    /// The pairs after `work(recorder, keys, values)`, with guards around both views.
    template <class Work>
    std::vector<pair> run_on(const std::vector<pair>& pairs, Work&& work) {
        words keys(pairs.size() + 2 * guards, guard);
        words values = keys;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            keys[guards + i] = pairs[i].key;
            values[guards + i] = pairs[i].value;
        }
        const buffer key_buffer = make(keys);
        const buffer value_buffer = make(values);
        run([&](recorder& r) {
            work(r, view<gpu, std::uint32_t>(key_buffer, guards, pairs.size()),
                 view<gpu, std::uint32_t>(value_buffer, guards, pairs.size()));
        });
        keys = read<std::uint32_t>(key_buffer, keys.size());
        values = read<std::uint32_t>(value_buffer, values.size());
        std::vector<pair> got(pairs.size());
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (i >= guards && i < guards + got.size()) {
                got[i - guards] = {keys[i], values[i]};
            } else {
                EXPECT_EQ(keys[i], guard) << i;
                EXPECT_EQ(values[i], guard) << i;
            }
        }
        return got;
    }
};

TEST_F(sort_test, of_keys_below_a_power_of_two) {
    for (const std::uint32_t n : {1u, 2u, 1023u, 1024u, 1025u, 20001u}) {
        for (const std::uint32_t bits : {0u, 1u, 4u, 5u, 8u, 9u, 13u, 16u, 17u, 19u, 24u, 31u}) {
            SCOPED_TRACE(std::to_string(n) + " pairs of " + std::to_string(bits) + " bits");
            const auto pairs = pairs_below(n, bits, n + bits);
            const auto got = run_on(
                pairs, [&](recorder& r, auto keys, auto values) { r.sort(keys, values, bits); });
            ASSERT_EQ(got, sorted(pairs, n));
        }
    }
}

TEST_F(sort_test, by_all_bits_where_there_are_no_more) {
    const auto pairs = pairs_below(5000, 32, 1);
    for (const std::uint32_t bits : {29u, 32u, 33u, 0xffffffffu}) {
        const auto got =
            run_on(pairs, [&](recorder& r, auto keys, auto values) { r.sort(keys, values, bits); });
        EXPECT_EQ(got, sorted(pairs, 5000)) << bits;
    }
}

TEST_F(sort_test, of_a_number_of_pairs_that_the_device_knows) {
    for (const std::uint32_t known : {0u, 1u, 3000u, 4999u, 9999u}) {
        const buffer count = make(std::vector<count_record>{{known, known, {0, 0}}});
        for (const std::uint32_t bits : {3u, 11u, 20u}) {
            SCOPED_TRACE(std::to_string(known) + " pairs of " + std::to_string(bits) + " bits");
            const auto pairs = pairs_below(5000, bits, known);
            const auto got = run_on(pairs, [&](recorder& r, auto keys, auto values) {
                r.sort(keys, values, {view<gpu>(count), 4000}, bits);
            });
            ASSERT_EQ(got, sorted(pairs, std::min(known, 4000u)));
        }
    }
}

} // namespace
} // namespace skybark::opengl::tests
