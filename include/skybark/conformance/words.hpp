#pragma once
// Cases: running sums of words, and sorts of pairs of a key and a value.

#include <skybark/conformance/buffers.hpp>
#include <skybark/kernels/probe_map.hpp>

#include <algorithm>

namespace skybark::conformance {

/// Random words below a limit.
template <backend B>
[[nodiscard]] std::vector<std::uint32_t> random_words(context<B>& c, std::size_t count,
                                                      std::uint64_t limit) {
    std::vector<std::uint32_t> words(count);
    for (std::uint32_t& word : words) {
        word = static_cast<std::uint32_t>(std::uint64_t{c.random()} % limit);
    }
    return words;
}

/// What comes before each word, and the sum of all, as far as 32 bits go.
struct running_sums {
    std::vector<std::uint32_t> before;
    std::uint32_t total;
};
[[nodiscard]] inline running_sums sums_of(const std::vector<std::uint32_t>& words) {
    running_sums sums{{}, 0};
    std::uint64_t sum = 0;
    const auto clipped = [&] {
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, 0xffffffff));
    };
    for (const std::uint32_t word : words) {
        sums.before.push_back(clipped());
        sum += word; // far below 2^64: a case has less than 2^25 words
    }
    sums.total = clipped();
    return sums;
}

template <scans B>
void scan_these_words(context<B>& c, const std::vector<std::uint32_t>& words) {
    const auto in_place = c.put(words);
    const auto total = c.template room<std::uint32_t>(1);
    c.run([&](auto& r) { r.scan(in_place.view(), total.view()); });
    const running_sums expected = sums_of(words);
    expect_numbers(c, in_place, expected.before, "sums before a word");
    expect_numbers(c, total, {expected.total}, "sum of all words");
}

template <scans B>
void scan_words(context<B>& c, std::size_t count) {
    scan_these_words(c, random_words(c, count, count > 1000000 ? 100 : 4000));
}

/// Sums that end just below 2^32, at it, and that reach it early, late, in the first word or in the
/// last one, or again and again.
template <scans B>
void scan_words_saturated(context<B>& c) {
    constexpr std::uint32_t most = 0xffffffff;
    for (const std::uint32_t count : {1u, 2u, 300u, 5000u, 70000u}) {
        std::vector<std::uint32_t> words(count, 1);
        words[count / 2] = most - (count - 1);
        scan_these_words(c, words); // exactly 2^32 − 1
        words[count - 1] += count / 2 == count - 1 ? 0 : 1;
        scan_these_words(c, words);
        scan_these_words(c, std::vector<std::uint32_t>(count, most));
        scan_these_words(c, random_words(c, count, std::uint64_t{1} << 32));
        words.assign(count, 0);
        words[0] = most;
        words[count - 1] = most;
        scan_these_words(c, words);
    }
}

/// The words and the total are parts of one buffer, with numbers around them.
template <scans B>
void scan_words_in_a_view(context<B>& c) {
    const std::uint64_t step = std::max<std::uint64_t>(c.device.limits().view_alignment, 256);
    auto numbers = random_words(c, step / 4 * 40, 1000);
    const auto g = c.put(numbers);
    const buffer_view<B> words{&g.buffer, g.before + 3 * step, 20 * step + 12};
    const buffer_view<B> total{&g.buffer, g.before + 30 * step, 4};
    c.run([&](auto& r) { r.scan(words, total); });
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(3 * step / 4);
    const std::vector<std::uint32_t> in(first, first + static_cast<std::ptrdiff_t>(words.size / 4));
    const running_sums expected = sums_of(in);
    std::copy(expected.before.begin(), expected.before.end(), first);
    numbers[30 * step / 4] = expected.total;
    expect_numbers(c, g, numbers);
}

/// A map writes what is scanned, and the sums are scanned again; another recorder does the same
/// turn by turn.
template <scans B>
void scan_words_twice(context<B>& c) {
    const auto a = random_words(c, 9000, 100);
    const auto b = random_words(c, 5000, 100);
    const auto a_in = c.put(a);
    const auto b_in = c.put(b);
    const auto totals = c.template room<std::uint32_t>(1);
    const auto again = c.template room<std::uint32_t>(1);
    const auto others = c.template room<std::uint32_t>(1);
    auto first = c.begin();
    auto second = c.begin();
    first.scan(a_in.view(), totals.view());
    second.scan(b_in.view(), others.view());
    first.scan(a_in.view(), again.view());
    c.submit(second);
    c.submit(first);
    const running_sums once = sums_of(a);
    const running_sums twice = sums_of(once.before);
    const running_sums other = sums_of(b);
    expect_numbers(c, a_in, twice.before, "sums of sums");
    expect_numbers(c, totals, {once.total}, "sum of all words");
    expect_numbers(c, again, {twice.total}, "sum of all sums");
    expect_numbers(c, b_in, other.before, "sums of the second recorder");
    expect_numbers(c, others, {other.total}, "sum of all words of the second recorder");
}

/// A scan sees what a map wrote, and a map what the scan made.
template <scans B>
void scan_words_between_maps(context<B>& c) {
    if constexpr (maps<B, kernels::probe_map>) {
        const auto words = random_words(c, 3000, 500);
        const auto vectors = c.put(std::vector<glm::vec4>(3000));
        const auto in = c.put(words);
        const auto middle = c.template room<std::uint32_t>(3000);
        const auto out = c.template room<std::uint32_t>(3000);
        const auto total = c.template room<std::uint32_t>(1);
        const auto unused = c.template room<glm::vec4>(3000);
        c.run([&](auto& r) {
            r.map(kernels::probe_map{2, 1, 1, 0},
                  {in.view(), vectors.view(), middle.view(), unused.view()}, range{0, 3000});
            r.scan(middle.view(), total.view());
            r.map(kernels::probe_map{3, 0, 1, 0},
                  {middle.view(), vectors.view(), out.view(), unused.view()}, range{0, 3000});
        });
        std::vector<std::uint32_t> mapped(3000);
        for (std::uint32_t i = 0; i < 3000; ++i) {
            mapped[i] = words[i] * 2 + 1 + i;
        }
        const running_sums sums = sums_of(mapped);
        for (std::uint32_t i = 0; i < 3000; ++i) {
            mapped[i] = sums.before[i] * 3 + i;
        }
        expect_numbers(c, out, mapped);
        expect_numbers(c, total, {sums.total}, "sum of all words");
    }
}

template <backend B>
void add_word_scan_cases(cases<B>& to) {
    if constexpr (scans<B>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"scan", "words_" + std::move(name), std::move(body)});
        };
        for (const named_size n : edge_sizes) {
            add(n.name, [n](context<B>& c) { scan_words(c, n.size); });
        }
        const named_size sizes[] = {{"three", 3},         {"level_minus_1", 4095},
                                    {"level", 4096},      {"level_plus_1", 4097},
                                    {"million", 1000003}, {"huge", 4096 * 4096 + 4097}};
        for (const named_size n : sizes) {
            add(n.name, [n](context<B>& c) { scan_words(c, n.size); });
        }
        add("saturated", scan_words_saturated<B>);
        add("in_a_view", scan_words_in_a_view<B>);
        add("twice", scan_words_twice<B>);
        add("between_maps", scan_words_between_maps<B>);
    }
}

/// Keys and their values, guarded: each value is another one, so that it tells where its key was.
template <backend B>
struct pair_probe {
    std::vector<std::uint32_t> keys, values;
    guarded<B> keys_in, values_in;
};
template <backend B>
[[nodiscard]] pair_probe<B> put_pairs(context<B>& c, std::vector<std::uint32_t> keys) {
    std::vector<std::uint32_t> values(keys.size());
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        values[i] = (i + 12345) * 2654435761u; // odd, and so one to one
    }
    auto keys_in = c.put(keys);
    auto values_in = c.put(values);
    return {std::move(keys), std::move(values), std::move(keys_in), std::move(values_in)};
}

/// The first `count` pairs are sorted and the others as they were.
template <backend B>
void expect_sorted(const context<B>& c, const pair_probe<B>& p, std::size_t count) {
    std::vector<std::uint64_t> order(count); // a key, and where it was: no two are equal
    for (std::size_t i = 0; i < count; ++i) {
        order[i] = (std::uint64_t{p.keys[i]} << 32) + i;
    }
    std::sort(order.begin(), order.end());
    auto keys = p.keys;
    auto values = p.values;
    for (std::size_t i = 0; i < count; ++i) {
        keys[i] = static_cast<std::uint32_t>(order[i] >> 32);
        values[i] = p.values[order[i] & 0xffffffff];
    }
    expect_numbers(c, p.keys_in, keys, "keys");
    expect_numbers(c, p.values_in, values, "values");
}

template <sorts B>
void sort_these(context<B>& c, std::vector<std::uint32_t> keys) {
    const auto p = put_pairs(c, std::move(keys));
    c.run([&](auto& r) { r.sort(p.keys_in.view(), p.values_in.view()); });
    expect_sorted(c, p, p.keys.size());
}

template <sorts B>
void sort_orders(context<B>& c, std::uint32_t count) {
    sort_these(c, counting(count, 0xfffff000)); // in order, and over the end of 32 bits
    auto reversed = counting(count, 70000 - count);
    std::reverse(reversed.begin(), reversed.end());
    sort_these(c, reversed);
    sort_these(c, std::vector<std::uint32_t>(count, 0xffffffff));
    sort_these(c, std::vector<std::uint32_t>(count, 0));
    sort_these(c, random_words(c, count, 2));
    sort_these(c, random_words(c, count, 7));
}

/// One byte, one bit, or any of the bits differ.
template <sorts B>
void sort_bits(context<B>& c) {
    for (int shift = 0; shift < 32; shift += 4) {
        auto keys = random_words(c, 1500, 16);
        for (std::uint32_t& key : keys) {
            key = key << shift ^ 0x5a5a5a5a;
        }
        sort_these(c, keys);
    }
    std::vector<std::uint32_t> keys;
    for (std::uint32_t i = 0; i < 640; ++i) {
        keys.push_back(i / 32 % 2 == 0 ? 1u << i % 32 : ~(1u << i % 32));
    }
    sort_these(c, keys);
}

template <sorts B>
void sort_counted(context<B>& c, std::uint32_t written, std::uint32_t limit) {
    const auto p = put_pairs(c, random_words(c, 5000, 300));
    const auto count = c.put_count(written);
    c.run([&](auto& r) {
        r.sort(p.keys_in.view(), p.values_in.view(), counted<B>{count.view(), limit});
    });
    expect_sorted(c, p, std::min(written, limit));
}

/// Keys below 2^bits, the largest of them among them.
template <sorts B>
[[nodiscard]] std::vector<std::uint32_t> short_keys(context<B>& c, std::size_t count,
                                                    std::uint32_t bits) {
    auto keys = random_words(c, count, std::uint64_t{1} << bits);
    const auto most = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    for (std::size_t i = 0; i < keys.size(); i += 37) {
        keys[i] = i % 2 == 0 ? most : most / 2;
    }
    return keys;
}

/// A caller who knows how many bits the keys have gets the same order.
template <sorts B>
void sort_key_bits(context<B>& c, std::uint32_t bits) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2},
                                    std::size_t{257}, std::size_t{5000}, std::size_t{70001}}) {
        const auto p = put_pairs(c, short_keys(c, count, bits));
        c.run([&](auto& r) { r.sort(p.keys_in.view(), p.values_in.view(), bits); });
        expect_sorted(c, p, count);
    }
}
template <sorts B>
void sort_key_bits_counted(context<B>& c) {
    for (const std::uint32_t bits : {1u, 5u, 8u, 13u, 24u, 31u, 32u}) {
        const auto p = put_pairs(c, short_keys(c, 5000, bits));
        const auto count = c.put_count(3210);
        c.run([&](auto& r) {
            r.sort(p.keys_in.view(), p.values_in.view(), counted<B>{count.view(), 5000}, bits);
        });
        expect_sorted(c, p, 3210);
    }
}
/// Sorts by different numbers of bits in one stream: each as if it were alone.
template <sorts B>
void sort_key_bits_in_turn(context<B>& c) {
    std::vector<pair_probe<B>> probes;
    constexpr std::array<std::uint32_t, 5> bits{3, 32, 9, 17, 1};
    for (const std::uint32_t b : bits) {
        probes.push_back(put_pairs(c, short_keys(c, 3000 + 500 * b, b)));
    }
    c.run([&](auto& r) {
        for (std::size_t i = 0; i < bits.size(); ++i) {
            r.sort(probes[i].keys_in.view(), probes[i].values_in.view(), bits[i]);
        }
    });
    for (const pair_probe<B>& p : probes) {
        expect_sorted(c, p, p.keys.size());
    }
}

/// The pairs of a part of both buffers; those around it stay.
template <sorts B>
void sort_views(context<B>& c) {
    const std::uint64_t step = std::max<std::uint64_t>(c.device.limits().view_alignment, 256);
    auto p = put_pairs(c, random_words(c, step, std::uint64_t{1} << 32));
    const buffer_view<B> keys{&p.keys_in.buffer, p.keys_in.before + step, 2 * step + 20};
    const buffer_view<B> values{&p.values_in.buffer, p.values_in.before + step, 2 * step + 20};
    c.run([&](auto& r) { r.sort(keys, values); });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs; // random keys: no two are equal
    for (std::uint64_t i = step / 4; i < step / 4 + keys.size / 4; ++i) {
        pairs.emplace_back(p.keys[i], p.values[i]);
    }
    std::sort(pairs.begin(), pairs.end());
    for (std::uint64_t i = 0; i < pairs.size(); ++i) {
        p.keys[step / 4 + i] = pairs[i].first;
        p.values[step / 4 + i] = pairs[i].second;
    }
    expect_numbers(c, p.keys_in, p.keys, "keys");
    expect_numbers(c, p.values_in, p.values, "values");
}

/// Sorted by one key, and then, in the same stream, by another one: the second goes first, and the
/// first decides where it is the same. Another recorder sorts turn by turn.
template <sorts B>
void sort_twice(context<B>& c) {
    const auto p = put_pairs(c, random_words(c, 3000, 1000));
    const auto q = put_pairs(c, random_words(c, 2000, 50));
    const auto r = put_pairs(c, random_words(c, 3000, 20));
    const auto stays = c.put_count(1500);
    auto first = c.begin();
    auto second = c.begin();
    first.sort(p.keys_in.view(), p.values_in.view());
    second.sort(q.keys_in.view(), q.values_in.view());
    first.sort(r.keys_in.view(), p.keys_in.view(), counted<B>{stays.view(), 3000});
    c.submit(second);
    c.submit(first);
    expect_sorted(c, q, 2000);
    auto sorted = p.keys;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint64_t> order(1500);
    for (std::size_t i = 0; i < 1500; ++i) {
        order[i] = (std::uint64_t{r.keys[i]} << 32) + i;
    }
    std::sort(order.begin(), order.end());
    auto expected = sorted;
    for (std::size_t i = 0; i < 1500; ++i) {
        expected[i] = sorted[order[i] & 0xffffffff];
    }
    expect_numbers(c, p.keys_in, expected, "keys that were sorted as values");
}

template <backend B>
void add_sort_cases(cases<B>& to) {
    if constexpr (sorts<B>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"sort", std::move(name), std::move(body)});
        };
        const auto add_size = [&](named_size n) {
            add(n.name, [n](context<B>& c) {
                sort_these(c, random_words(c, n.size, std::uint64_t{1} << 32));
            });
        };
        for (const named_size n : edge_sizes) {
            add_size(n);
        }
        for (const named_size n : {named_size{"two", 2},
                                   {"level_minus_1", 4095},
                                   {"level", 4096},
                                   {"level_plus_1", 4097},
                                   {"million", 1000000}}) {
            add_size(n);
        }
        add("equal_keys", [](context<B>& c) { sort_these(c, random_words(c, 1000, 3)); });
        add("orders_limit_plus_1", [](context<B>& c) { sort_orders(c, 65); });
        add("orders_block_plus_1", [](context<B>& c) { sort_orders(c, 257); });
        add("orders_level_plus_1", [](context<B>& c) { sort_orders(c, 4097); });
        add("orders_many", [](context<B>& c) { sort_orders(c, 65537); });
        add("bits", sort_bits<B>);
        add("counted", [](context<B>& c) { sort_counted(c, 3210, 5000); });
        add("counted_empty", [](context<B>& c) { sort_counted(c, 0, 5000); });
        add("counted_one", [](context<B>& c) { sort_counted(c, 1, 5000); });
        add("counted_above_limit", [](context<B>& c) { sort_counted(c, 4999, 1300); });
        add("counted_limit_0", [](context<B>& c) { sort_counted(c, 4999, 0); });
        add("in_views", sort_views<B>);
        add("twice", sort_twice<B>);
        for (const std::uint32_t bits : {0u, 1u, 4u, 7u, 8u, 19u, 31u, 32u}) {
            add("key_bits_" + std::to_string(bits),
                [bits](context<B>& c) { sort_key_bits(c, bits); });
        }
        add("key_bits_counted", sort_key_bits_counted<B>);
        add("key_bits_in_turn", sort_key_bits_in_turn<B>);
    }
}

} // namespace skybark::conformance
