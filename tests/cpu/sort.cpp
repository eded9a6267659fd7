// The CPU backend's sort and its running sums of words.

#include "support/cpu_work.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

using namespace skybark;
using support::expect_value;

namespace {

using device = cpu::device;
using words = std::vector<std::uint32_t>;

static_assert(sorts<device> && scans<device>);

device with_threads(std::uint32_t threads) {
    cpu::device_options options;
    options.threads = threads;
    return device(options);
}

cpu::buffer put(device& on, const words& all) {
    return expect_value(make_buffer<device, std::uint32_t>(on, all));
}
words words_of(const cpu::buffer& from) {
    const auto* first = reinterpret_cast<const std::uint32_t*>(from.data());
    return {first, first + from.size_bytes() / 4};
}

void expect_sorted(device& d, const words& keys, std::size_t count) {
    words values(keys.size());
    std::iota(values.begin(), values.end(), 7u);
    words order = values;
    std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](std::uint32_t a, std::uint32_t b) { return keys[a - 7] < keys[b - 7]; });
    const auto k = put(d, keys);
    const auto v = put(d, values);
    const auto length = expect_value(
        make_buffer<device, count_record>(d, {{{static_cast<std::uint32_t>(count), 0, {}}}}));
    ASSERT_TRUE(run(d, [&](auto& r) {
        if (count == keys.size()) {
            r.sort(view<device>(k), view<device>(v));
        } else {
            r.sort(view<device>(k), view<device>(v),
                   counted<device>{view<device>(length), 0xffffffff});
        }
    }));
    EXPECT_TRUE(words_of(v) == order) << keys.size();
    const words sorted = words_of(k);
    for (std::size_t i = 0; i < keys.size(); ++i) {
        ASSERT_EQ(sorted[i], keys[order[i] - 7]) << i;
    }
}

TEST(sort, keeps_the_order_of_equal_keys) {
    support::random_source random(21);
    for (const std::uint32_t threads : {1u, 3u}) {
        device d = with_threads(threads);
        for (const std::uint32_t count : {0u, 1u, 2u, 257u, 8191u, 16384u, 100'003u}) {
            for (const std::uint32_t mask : {0xffffffffu, 0xffu, 0xff00u, 0x80000000u, 0u}) {
                words keys(count);
                for (std::uint32_t& key : keys) {
                    key = random.bits() & mask;
                }
                expect_sorted(d, keys, count);
            }
        }
    }
}

TEST(sort, takes_the_first_pairs_of_a_length_of_the_devices) {
    support::random_source random(22);
    device d = with_threads(2);
    words keys(50'000);
    for (std::uint32_t& key : keys) {
        key = random.bits();
    }
    for (const std::size_t count : {0u, 1u, 30'000u, 49'999u}) {
        expect_sorted(d, keys, count);
    }
}

TEST(sort, takes_keys_of_few_bits) {
    support::random_source random(24);
    device d = with_threads(3);
    const auto length = expect_value(make_buffer<device, count_record>(d, {{{50'000, 0, {}}}}));
    for (const std::uint32_t bits : {0u, 1u, 8u, 9u, 22u, 31u, 32u, 40u}) {
        for (const bool counts : {false, true}) {
            words keys(60'000);
            for (std::uint32_t& key : keys) {
                key = static_cast<std::uint32_t>(random.bits() & ((std::uint64_t{1} << bits) - 1));
            }
            words values(keys.size());
            std::iota(values.begin(), values.end(), 0u);
            words order = values;
            std::stable_sort(order.begin(), counts ? order.begin() + 50'000 : order.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
            const auto k = put(d, keys);
            const auto v = put(d, values);
            ASSERT_TRUE(run(d, [&](auto& r) {
                if (counts) {
                    r.sort(view<device>(k), view<device>(v),
                           counted<device>{view<device>(length), 0xffffffff}, bits);
                } else {
                    r.sort(view<device>(k), view<device>(v), bits);
                }
            }));
            EXPECT_TRUE(words_of(v) == order) << bits << ' ' << counts;
        }
    }
}

TEST(sort, leaves_out_the_bits_that_keys_do_not_have) {
    device d = with_threads(1);
    const auto k = put(d, {0x100, 0x003, 0x001});
    const auto v = put(d, {0, 1, 2});
    ASSERT_TRUE(run(d, [&](auto& r) { r.sort(view<device>(k), view<device>(v), 8); }));
    // The key that breaks the promise counts as zero.
    EXPECT_EQ(words_of(v), (words{0, 2, 1}));
}

TEST(scan_of_words, leaves_each_words_own_value_out) {
    support::random_source random(23);
    for (const std::uint32_t threads : {1u, 3u}) {
        device d = with_threads(threads);
        for (const std::uint32_t count : {0u, 1u, 2u, 1000u, 70'001u}) {
            for (const std::uint32_t most : {10u, 60'000u, 0xffffffffu}) {
                words all(count);
                words expected;
                std::uint64_t sum = 0;
                for (std::uint32_t& word : all) {
                    word = random.below(most);
                    expected.push_back(
                        static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, 0xffffffffu)));
                    sum += word;
                }
                const auto buffer = put(d, all);
                const auto total = put(d, {1, 2});
                ASSERT_TRUE(
                    run(d, [&](auto& r) { r.scan(view<device>(buffer), view<device>(total)); }));
                EXPECT_TRUE(words_of(buffer) == expected) << count << ' ' << most;
                EXPECT_EQ(words_of(total)[0], std::min<std::uint64_t>(sum, 0xffffffffu));
                EXPECT_EQ(words_of(total)[1], 2u);
            }
        }
    }
}

} // namespace
