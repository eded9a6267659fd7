#pragma once
// Cases: map over a range, over consecutive ranges, over a length that the device knows.

#include <skybark/conformance/buffers.hpp>
#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>

namespace skybark::conformance {

/// One probe_map: its input on the host and its buffers.
template <backend B>
struct map_probe {
    kernels::probe_map kernel{3, 17, 2.0f, -5.0f};
    std::vector<std::uint32_t> numbers;
    std::vector<glm::vec4> vectors;
    guarded<B> numbers_in, vectors_in, numbers_out, vectors_out;

    [[nodiscard]] bindings<B, kernels::probe_map> buffers() const {
        return {numbers_in.view(), vectors_in.view(), numbers_out.view(), vectors_out.view()};
    }
};

template <backend B>
[[nodiscard]] map_probe<B> make_map_probe(context<B>& c, std::uint32_t count) {
    std::vector<std::uint32_t> numbers(count);
    std::vector<glm::vec4> vectors(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        numbers[i] = static_cast<std::uint32_t>(c.random());
        vectors[i] = c.small_vector();
    }
    auto numbers_in = c.put(numbers);
    auto vectors_in = c.put(vectors);
    return {{3, 17, 2.0f, -5.0f},
            std::move(numbers),
            std::move(vectors),
            std::move(numbers_in),
            std::move(vectors_in),
            c.template room<std::uint32_t>(count),
            c.template room<glm::vec4>(count)};
}

/// Elements of [first, first + count) are mapped, the others untouched.
template <backend B>
void expect_mapped(const context<B>& c, const map_probe<B>& p, range mapped) {
    const auto numbers = c.template get<std::uint32_t>(p.numbers_out);
    const auto vectors = c.template get<glm::vec4>(p.vectors_out);
    float untouched_vector = 0;
    std::memset(&untouched_vector, std::to_integer<int>(guard_byte), sizeof untouched_vector);
    comparison number_check = c.compare("numbers");
    comparison vector_check = c.compare("components of vectors");
    for (std::uint32_t i = 0; i < numbers.size(); ++i) {
        const bool is_mapped = i - mapped.first < mapped.count;
        const std::uint64_t number = (std::uint64_t{p.numbers[i]} * 3 + 17 + i) % (1ull << 32);
        number_check.same(numbers[i], is_mapped ? static_cast<double>(number) : 0xa5a5a5a5u);
        for (int k = 0; k < 4; ++k) {
            vector_check.same(vectors[i][k], is_mapped ? double{p.vectors[i][k]} * 2 - 5
                                                       : double{untouched_vector});
        }
    }
}

template <backend B>
void map_range(context<B>& c, std::uint32_t count) {
    const auto p = make_map_probe(c, count);
    c.run([&](auto& r) { r.map(p.kernel, p.buffers(), range{0, count}); });
    expect_mapped(c, p, {0, count});
}

template <backend B>
void map_part(context<B>& c) {
    const auto p = make_map_probe(c, 1000);
    c.run([&](auto& r) { r.map(p.kernel, p.buffers(), range{100, 333}); });
    expect_mapped(c, p, {100, 333});
}

template <backend B>
void map_nan(context<B>& c) {
    auto p = make_map_probe(c, 100);
    for (std::uint32_t i = 0; i < 100; i += 3) {
        p.vectors[i][static_cast<int>(i % 4)] = std::numeric_limits<float>::quiet_NaN();
        p.vectors[i][static_cast<int>((i + 1) % 4)] = std::numeric_limits<float>::infinity();
    }
    p.vectors_in = c.put(p.vectors);
    c.run([&](auto& r) { r.map(p.kernel, p.buffers(), range{0, 100}); });
    expect_mapped(c, p, {0, 100});
}

template <backend B>
void map_counted(context<B>& c, std::uint32_t written, std::uint32_t limit) {
    const auto p = make_map_probe(c, 500);
    const auto count = c.put_count(written);
    c.run([&](auto& r) { r.map(p.kernel, p.buffers(), counted<B>{count.view(), limit}); });
    expect_mapped(c, p, {0, std::min(written, limit)});
}

/// The second map reads what the first wrote, and the first's input is replaced in between.
template <backend B>
void map_twice(context<B>& c) {
    const auto p = make_map_probe(c, 300);
    const auto second = make_map_probe(c, 300);
    const bindings<B, kernels::probe_map> chained{p.numbers_out.view(), p.vectors_out.view(),
                                                  second.numbers_out.view(),
                                                  second.vectors_out.view()};
    c.run([&](auto& r) {
        r.map(p.kernel, p.buffers(), range{0, 300});
        r.map(p.kernel, chained, range{0, 300});
    });
    expect_mapped(c, p, {0, 300});
    const auto numbers = c.template get<std::uint32_t>(second.numbers_out);
    const auto vectors = c.template get<glm::vec4>(second.vectors_out);
    comparison number_check = c.compare("numbers of the second map");
    comparison vector_check = c.compare("vectors of the second map");
    for (std::uint32_t i = 0; i < 300; ++i) {
        const std::uint64_t once = (std::uint64_t{p.numbers[i]} * 3 + 17 + i) % (1ull << 32);
        number_check.same(numbers[i], static_cast<double>((once * 3 + 17 + i) % (1ull << 32)));
        for (int k = 0; k < 4; ++k) {
            vector_check.same(vectors[i][k], (double{p.vectors[i][k]} * 2 - 5) * 2 - 5);
        }
    }
}

/// Each map gets the parameters that it was recorded with, and the input as it was in the stream.
template <backend B>
void map_parameters_and_uploads(context<B>& c) {
    auto p = make_map_probe(c, 64);
    const auto other = make_map_probe(c, 64);
    const bindings<B, kernels::probe_map> into_other{p.numbers_in.view(), p.vectors_in.view(),
                                                     other.numbers_out.view(),
                                                     other.vectors_out.view()};
    const auto replaced = counting(64, 900);
    c.run([&](auto& r) {
        r.map(p.kernel, p.buffers(), range{0, 64});
        r.upload(p.numbers_in.view(), std::as_bytes(std::span(replaced)));
        auto kernel = p.kernel;
        kernel.factor = 1;
        kernel.offset = 0;
        r.map(kernel, into_other, range{0, 64});
    });
    expect_mapped(c, p, {0, 64});
    auto expected = replaced;
    for (std::uint32_t i = 0; i < 64; ++i) {
        expected[i] += i;
    }
    expect_numbers(c, other.numbers_out, expected, "numbers after the upload");
}

template <backend B>
void map_two_recorders(context<B>& c) {
    const auto a = make_map_probe(c, 200);
    const auto b = make_map_probe(c, 200);
    auto first = c.begin();
    auto second = c.begin();
    second.map(b.kernel, b.buffers(), range{0, 100});
    first.map(a.kernel, a.buffers(), range{0, 150});
    second.map(b.kernel, b.buffers(), range{100, 60});
    c.submit(second);
    c.submit(first);
    expect_mapped(c, a, {0, 150});
    expect_mapped(c, b, {0, 160});
}

/// A forest whose levels are consecutive ranges of these sizes; each element's parent is a random
/// one of the level before.
template <backend B>
void map_levels(context<B>& c, const std::vector<std::uint32_t>& sizes) {
    std::vector<range> levels;
    std::vector<kernels::probe_node> nodes;
    std::vector<std::uint64_t> expected;
    range before{};
    for (const std::uint32_t size : sizes) {
        const range level{before.first + before.count, size};
        for (std::uint32_t i = level.first; i < level.first + size; ++i) {
            const std::uint32_t parent =
                before.count == 0 ? i : before.first + c.below(before.count);
            const std::uint32_t weight = c.below(1000);
            nodes.push_back({parent, weight});
            expected.push_back(parent == i ? weight
                                           : (expected[parent] * 3 + weight) % (1ull << 32));
        }
        levels.push_back(level);
        if (size != 0) {
            before = level;
        }
    }
    const auto nodes_in = c.put(nodes);
    const auto values = c.template room<std::uint32_t>(nodes.size());
    c.run([&](auto& r) {
        r.map(kernels::probe_level{}, {nodes_in.view(), values.view(), values.view()},
              std::span<const range>(levels));
    });
    const auto actual = c.template get<std::uint32_t>(values);
    comparison check = c.compare("values of elements");
    for (std::size_t i = 0; i < expected.size(); ++i) {
        check.same(actual[i], static_cast<double>(expected[i]));
    }
}

/// A range for each element of a chain, longer than the 65,535 iterions that some shader compilers
/// end a loop after.
template <backend B>
void map_long_chain(context<B>& c) {
    map_levels(c, std::vector<std::uint32_t>(70000, 1));
}

template <backend B>
void add_map_cases(cases<B>& to) {
    if constexpr (maps<B, kernels::probe_map>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"map", std::move(name), std::move(body)});
        };
        for (const named_size n : edge_sizes) {
            add(std::string("range_") + n.name, [n](context<B>& c) { map_range(c, n.size); });
        }
        // 65,535 workgroups of 64: the most in one dimension of a dispatch.
        constexpr std::uint32_t groups = 65535 * 64;
        add("range_groups_minus_1_slow", [](context<B>& c) { map_range(c, groups - 1); });
        add("range_groups_slow", [](context<B>& c) { map_range(c, groups); });
        add("range_groups_plus_1", [](context<B>& c) { map_range(c, groups + 1); });
        add("range_part", map_part<B>);
        add("nan", map_nan<B>);
        add("counted", [](context<B>& c) { map_counted(c, 321, 500); });
        add("counted_empty", [](context<B>& c) { map_counted(c, 0, 500); });
        add("counted_one", [](context<B>& c) { map_counted(c, 1, 500); });
        add("counted_above_limit", [](context<B>& c) { map_counted(c, 499, 130); });
        add("counted_limit_0", [](context<B>& c) { map_counted(c, 499, 0); });
        add("twice_in_one_recorder", map_twice<B>);
        add("parameters_and_uploads", map_parameters_and_uploads<B>);
        add("two_recorders", map_two_recorders<B>);
    }
    if constexpr (maps<B, kernels::probe_level>) {
        const auto add = [&](std::string name, std::vector<std::uint32_t> sizes) {
            to.push_back(
                {"map", std::move(name), [sizes](context<B>& c) { map_levels(c, sizes); }});
        };
        add("levels_none", {});
        add("levels_empty", {0, 0, 5, 0, 7, 0});
        add("levels_one", {1});
        add("levels_limit", {255, 256, 257, 63, 64, 65, 1});
        add("levels_tree", {1, 2, 5, 11, 23, 47, 93, 187, 374, 749, 1500, 3001});
        add("levels_deep", std::vector<std::uint32_t>(150, 7));
        add("levels_wide", {3, 70000, 5, 70000, 2});
        add("levels_wide_and_deep", std::vector<std::uint32_t>(60, 1100));
        to.push_back({"map", "levels_long_chain", map_long_chain<B>});
    }
}

} // namespace skybark::conformance
