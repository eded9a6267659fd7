#pragma once
// Cases: expand into a list of triangles, with both padding policies.

#include <skybark/conformance/context.hpp>
#include <skybark/kernels/probe_strips.hpp>

namespace skybark::conformance {

/// Input for probe_strips: how many triangles each strip has, and a payload an element.
struct strip_input {
    kernels::probe_strips kernel{2, 5};
    std::vector<std::uint32_t> counts;
    std::vector<glm::vec4> payloads;

    [[nodiscard]] std::uint32_t elements() const {
        return static_cast<std::uint32_t>(payloads.size());
    }
};

template <backend B>
[[nodiscard]] strip_input random_strips(context<B>& c, std::uint32_t elements,
                                        kernels::probe_strips kernel = {2, 5}) {
    strip_input in{kernel, {}, {}};
    for (std::uint32_t i = 0; i < elements; ++i) {
        for (std::uint32_t s = 0; s < kernel.strip_count; ++s) {
            in.counts.push_back(c.below(kernel.most + 1));
        }
        in.payloads.push_back(c.small_vector());
    }
    return in;
}

/// A vertex that is expected: where it comes from, or a spare one of zeros.
struct expected_vertex {
    std::uint32_t element, strip, vertex;
    bool spare;
};

/// The whole list that a range of elements should become: three vertices a triangle.
[[nodiscard]] inline std::vector<expected_vertex> expected_list(const strip_input& in,
                                                                range elements, padding policy) {
    std::vector<expected_vertex> list;
    for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
        for (std::uint32_t s = 0; s < in.kernel.strip_count; ++s) {
            const std::uint32_t n = in.counts[i * in.kernel.strip_count + s];
            for (std::uint32_t t = 0; t < n; ++t) {
                const bool even = t % 2 == 0;
                list.push_back({i, s, even ? t : t + 1, false});
                list.push_back({i, s, even ? t + 1 : t, false});
                list.push_back({i, s, t + 2, false});
            }
            if (policy == padding::degenerate) {
                list.insert(list.end(), 3 * std::size_t{in.kernel.most - n}, {i, s, 0, true});
            }
        }
    }
    return list;
}

/// `written` triangles of the list are there; what is left of the view is as it was.
template <backend B>
void expect_list(const context<B>& c, const strip_input& in, range elements, padding policy,
                 const guarded<B>& vertices, const guarded<B>& count) {
    const auto expected = expected_list(in, elements, policy);
    const std::uint64_t room = vertices.size / (3 * sizeof(kernels::probe_strip_vertex));
    const std::uint64_t required = expected.size() / 3;
    const std::uint64_t written = std::min(room, required);
    c.expect_count(count, written, required);
    const auto actual = c.template get<kernels::probe_strip_vertex>(vertices);
    comparison places = c.compare("components of (element, strip, vertex, 1) in the list");
    comparison payloads = c.compare("components of payloads in the list");
    for (std::size_t v = 0; v < 3 * written; ++v) {
        const expected_vertex& e = expected[v];
        const double place[4] = {double(e.element), double(e.strip), double(e.vertex), 1};
        for (int k = 0; k < 4; ++k) {
            places.same(actual[v].place[k], e.spare ? 0 : place[k]);
            payloads.same(actual[v].payload[k], e.spare ? 0 : double{in.payloads[e.element][k]});
        }
    }
    comparison rest = c.compare("words behind the last whole triangle");
    if (written < room) {
        return; // nobody says what the rest of a view holds
    }
    for (std::size_t v = 3 * written; v < actual.size(); ++v) {
        std::uint32_t word = 0;
        std::memcpy(&word, &actual[v], sizeof word);
        rest.same(word, 0xa5a5a5a5u);
    }
}

/// A strip_input in its buffers.
template <backend B>
struct strip_buffers {
    guarded<B> counts, payloads;

    [[nodiscard]] bindings<B, kernels::probe_strips> views() const {
        return {counts.view(), payloads.view()};
    }
};
template <backend B>
[[nodiscard]] strip_buffers<B> put_strips(const context<B>& c, const strip_input& in) {
    return {c.put(in.counts), c.put(in.payloads)};
}

[[nodiscard]] inline std::uint64_t triangles_of(const strip_input& in, range elements,
                                                padding policy) {
    return expected_list(in, elements, policy).size() / 3;
}

/// Expands a range of `in` into room for `spare_vertices` more (or less) than it needs.
template <backend B>
void expand_range(context<B>& c, const strip_input& in, range elements, padding policy,
                  std::int64_t spare_vertices = 0) {
    const auto needed = static_cast<std::int64_t>(3 * triangles_of(in, elements, policy));
    const auto buffers = put_strips(c, in);
    const auto vertices = c.template room<kernels::probe_strip_vertex>(
        static_cast<std::uint64_t>(std::max<std::int64_t>(0, needed + spare_vertices)));
    const auto count = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(in.kernel, buffers.views(), elements,
                 triangle_list<B>{vertices.view(), count.view(), policy});
    });
    expect_list(c, in, elements, policy, vertices, count);
}

template <backend B>
void expand_counted(context<B>& c, std::uint32_t written, std::uint32_t limit, padding policy,
                    std::int64_t spare_vertices = 0) {
    const auto in = random_strips(c, 400);
    const range elements{0, std::min(written, limit)};
    const auto needed = static_cast<std::int64_t>(3 * triangles_of(in, elements, policy));
    const auto buffers = put_strips(c, in);
    const auto vertices = c.template room<kernels::probe_strip_vertex>(
        static_cast<std::uint64_t>(std::max<std::int64_t>(0, needed + spare_vertices)));
    const auto length = c.put_count(written);
    const auto count = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(in.kernel, buffers.views(), counted<B>{length.view(), limit},
                 triangle_list<B>{vertices.view(), count.view(), policy});
    });
    expect_list(c, in, elements, policy, vertices, count);
}

/// Two expansions into two lists: what the first used for itself is free for the second.
template <backend B>
void expand_twice(context<B>& c, padding policy) {
    const auto a = random_strips(c, 300);
    const auto b = random_strips(c, 170, {3, 4});
    const range all_a{0, 300};
    const range all_b{0, 170};
    const auto buffers_a = put_strips(c, a);
    const auto buffers_b = put_strips(c, b);
    const auto list_a =
        c.template room<kernels::probe_strip_vertex>(3 * triangles_of(a, all_a, policy));
    const auto list_b =
        c.template room<kernels::probe_strip_vertex>(3 * triangles_of(b, all_b, policy));
    const auto count_a = c.template room<count_record>(1);
    const auto count_b = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(a.kernel, buffers_a.views(), all_a,
                 triangle_list<B>{list_a.view(), count_a.view(), policy});
        r.expand(b.kernel, buffers_b.views(), all_b,
                 triangle_list<B>{list_b.view(), count_b.view(), policy});
    });
    expect_list(c, a, all_a, policy, list_a, count_a);
    expect_list(c, b, all_b, policy, list_b, count_b);
}

template <backend B>
void expand_two_recorders(context<B>& c, padding policy) {
    const auto a = random_strips(c, 300);
    const auto b = random_strips(c, 170, {3, 4});
    const range all_a{0, 300};
    const range all_b{0, 170};
    const auto buffers_a = put_strips(c, a);
    const auto buffers_b = put_strips(c, b);
    const auto list_a =
        c.template room<kernels::probe_strip_vertex>(3 * triangles_of(a, all_a, policy));
    const auto list_b =
        c.template room<kernels::probe_strip_vertex>(3 * triangles_of(b, all_b, policy));
    const auto count_a = c.template room<count_record>(1);
    const auto count_b = c.template room<count_record>(1);
    auto first = c.begin();
    auto second = c.begin();
    second.expand(b.kernel, buffers_b.views(), all_b,
                  triangle_list<B>{list_b.view(), count_b.view(), policy});
    first.expand(a.kernel, buffers_a.views(), all_a,
                 triangle_list<B>{list_a.view(), count_a.view(), policy});
    c.submit(second);
    c.submit(first);
    expect_list(c, a, all_a, policy, list_a, count_a);
    expect_list(c, b, all_b, policy, list_b, count_b);
}

/// Two lists behind each other in one buffer, as chunks of a large scene are: the second starts
/// where the first one's view ends.
template <backend B>
void expand_behind_each_other(context<B>& c, padding policy) {
    const auto in = random_strips(c, 200);
    const auto buffers = put_strips(c, in);
    const range halves[2] = {{0, 128}, {128, 72}};
    const std::uint64_t align = c.device.limits().view_alignment;
    std::uint64_t sizes[2];
    for (int h = 0; h < 2; ++h) {
        sizes[h] = 3 * sizeof(kernels::probe_strip_vertex) * triangles_of(in, halves[h], policy);
    }
    const std::uint64_t second_at = (sizes[0] + align - 1) / align * align;
    const auto both = c.template room<std::uint32_t>((second_at + sizes[1]) / 4);
    const auto count_a = c.template room<count_record>(1);
    const auto count_b = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(in.kernel, buffers.views(), halves[0],
                 triangle_list<B>{both.view(sizes[0]), count_a.view(), policy});
        r.expand(in.kernel, buffers.views(), halves[1],
                 triangle_list<B>{
                     {&both.buffer, both.before + second_at, sizes[1]}, count_b.view(), policy});
    });
    const auto words = c.template get<std::uint32_t>(both);
    for (int h = 0; h < 2; ++h) {
        auto part = c.template room<kernels::probe_strip_vertex>(
            sizes[h] / sizeof(kernels::probe_strip_vertex));
        c.need(c.device.upload(
                   part.buffer, part.before,
                   std::as_bytes(std::span(words)).subspan(h == 0 ? 0 : second_at, sizes[h])),
               "upload");
        expect_list(c, in, halves[h], policy, part, h == 0 ? count_a : count_b);
    }
}

template <backend B>
void add_list_cases(cases<B>& to) {
    if constexpr (expands<B, kernels::probe_strips>) {
        using C = context<B>;
        for (const padding p : {padding::degenerate, padding::compact}) {
            const std::string prefix = p == padding::degenerate ? "degenerate_" : "compact_";
            const auto add = [&](std::string name, std::function<void(C&)> body) {
                to.push_back({"expand", prefix + name, std::move(body)});
            };
            for (const named_size n : edge_sizes) {
                add(n.name, [n, p](C& c) {
                    expand_range(c, random_strips(c, n.size), {0, n.size}, p);
                });
            }
            add("no_triangles", [p](C& c) {
                auto in = random_strips(c, 100);
                in.counts.assign(in.counts.size(), 0);
                expand_range(c, in, {0, 100}, p);
            });
            add("full_strips", [p](C& c) {
                auto in = random_strips(c, 100);
                in.counts.assign(in.counts.size(), in.kernel.most);
                expand_range(c, in, {0, 100}, p);
            });
            add("one_long_strip_among_empty_ones", [p](C& c) {
                auto in = random_strips(c, 1000);
                in.counts.assign(in.counts.size(), 0);
                in.counts[1337] = 5;
                expand_range(c, in, {0, 1000}, p);
            });
            add("part", [p](C& c) { expand_range(c, random_strips(c, 700), {129, 333}, p); });
            add("many_strips", [p](C& c) {
                expand_range(c, random_strips(c, 90, {37, 3}), {0, 90}, p);
            });
            // More than the 1,024 components that a geometry shader may put out.
            add("long_strips", [p](C& c) {
                expand_range(c, random_strips(c, 40, {3, 301}), {0, 40}, p);
            });
            add("components_limit", [p](C& c) {
                for (const std::uint32_t most : {29u, 30u, 31u, 61u, 62u, 63u, 125u, 126u, 127u}) {
                    expand_range(c, random_strips(c, 20, {1, most}), {0, 20}, p);
                }
            });
            add("one_huge_element", [p](C& c) {
                expand_range(c, random_strips(c, 2, {1, 70001}), {0, 2}, p);
            });
            add("nan", [p](C& c) {
                auto in = random_strips(c, 200);
                for (std::size_t i = 0; i < 200; i += 3) {
                    in.payloads[i] = {std::numeric_limits<float>::quiet_NaN(),
                                      std::numeric_limits<float>::infinity(), -0.0f, 1e-42f};
                    in.payloads[i].w = 1;
                }
                expand_range(c, in, {0, 200}, p);
            });
            add("short_by_one_triangle", [p](C& c) {
                expand_range(c, random_strips(c, 300), {0, 300}, p, -3);
            });
            add("short_by_one_vertex", [p](C& c) {
                expand_range(c, random_strips(c, 300), {0, 300}, p, -1);
            });
            add("short_by_much", [p](C& c) {
                expand_range(c, random_strips(c, 3000), {0, 3000}, p, -6500);
            });
            add("room_for_none", [p](C& c) {
                expand_range(c, random_strips(c, 1, {1, 1}), {0, 1}, p, -1);
                expand_range(c, random_strips(c, 300), {0, 300}, p, -1000000);
            });
            add("room_to_spare", [p](C& c) {
                expand_range(c, random_strips(c, 300), {0, 300}, p, 100);
            });
            add("counted", [p](C& c) { expand_counted(c, 333, 400, p); });
            add("counted_empty", [p](C& c) { expand_counted(c, 0, 400, p); });
            add("counted_above_limit", [p](C& c) { expand_counted(c, 399, 65, p); });
            add("counted_short_by_one_triangle", [p](C& c) { expand_counted(c, 257, 400, p, -3); });
            add("twice_in_one_recorder", [p](C& c) { expand_twice(c, p); });
            add("two_recorders", [p](C& c) { expand_two_recorders(c, p); });
            add("behind_each_other", [p](C& c) { expand_behind_each_other(c, p); });
        }
    }
}

} // namespace skybark::conformance
