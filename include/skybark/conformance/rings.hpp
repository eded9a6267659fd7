#pragma once
// Cases: expand into rings, and the index buffer that they share.

#include <skybark/conformance/context.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/ring_indices.hpp>

namespace skybark::conformance {

/// The vertices of `elements`, in a view that they fill exactly or with some to spare.
template <backend B>
void expect_rings(const context<B>& c, const std::vector<glm::vec4>& payloads, std::uint32_t around,
                  range elements, const guarded<B>& vertices) {
    const auto actual = c.template get<kernels::probe_ring_vertex>(vertices);
    comparison check = c.compare("components of ring vertices");
    for (std::uint32_t e = 0; e < elements.count; ++e) {
        const std::uint32_t i = elements.first + e;
        for (std::uint32_t j = 0; j < around; ++j) {
            const glm::vec4& place = actual[std::size_t{e} * around + j].place;
            check.same(place.x, i);
            check.same(place.y, j);
            check.same(place.z, payloads[i].x);
            check.same(place.w, payloads[i].y);
        }
    }
}

template <backend B>
[[nodiscard]] std::vector<glm::vec4> random_payloads(context<B>& c, std::uint32_t count) {
    std::vector<glm::vec4> payloads(count);
    for (glm::vec4& payload : payloads) {
        payload = c.small_vector();
    }
    return payloads;
}

template <backend B>
void rings_of(context<B>& c, const std::vector<glm::vec4>& payloads, std::uint32_t around,
              range elements) {
    const auto in = c.put(payloads);
    const auto out =
        c.template room<kernels::probe_ring_vertex>(std::uint64_t{elements.count} * around);
    c.run([&](auto& r) {
        r.expand_rings(kernels::probe_rings{around}, {in.view()}, elements, out.view());
    });
    expect_rings(c, payloads, around, elements, out);
}

template <backend B>
void rings_twice(context<B>& c) {
    const auto payloads = random_payloads(c, 100);
    const auto in = c.put(payloads);
    const auto a = c.template room<kernels::probe_ring_vertex>(100 * 7);
    const auto b = c.template room<kernels::probe_ring_vertex>(60 * 5);
    c.run([&](auto& r) {
        r.expand_rings(kernels::probe_rings{7}, {in.view()}, range{0, 100}, a.view());
        r.expand_rings(kernels::probe_rings{5}, {in.view()}, range{40, 60}, b.view());
    });
    expect_rings(c, payloads, 7, {0, 100}, a);
    expect_rings(c, payloads, 5, {40, 60}, b);
}

template <backend B>
void rings_two_recorders(context<B>& c) {
    const auto payloads = random_payloads(c, 100);
    const auto in = c.put(payloads);
    const auto a = c.template room<kernels::probe_ring_vertex>(100 * 7);
    const auto b = c.template room<kernels::probe_ring_vertex>(60 * 5);
    auto first = c.begin();
    auto second = c.begin();
    second.expand_rings(kernels::probe_rings{5}, {in.view()}, range{40, 60}, b.view());
    first.expand_rings(kernels::probe_rings{7}, {in.view()}, range{0, 100}, a.view());
    c.submit(second);
    c.submit(first);
    expect_rings(c, payloads, 7, {0, 100}, a);
    expect_rings(c, payloads, 5, {40, 60}, b);
}

/// ring_indices against the pattern of a fan, written out.
template <backend B>
void ring_index_buffer(context<B>& c) {
    constexpr std::uint32_t around = 6;
    constexpr std::uint32_t elements = 77;
    const std::vector<std::uint32_t> pattern{0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5};
    const auto in = c.put(pattern);
    const auto out = c.template room<std::uint32_t>(elements * 12);
    c.run([&](auto& r) {
        r.map(kernels::ring_indices{12, around, 1000}, {in.view(), out.view()},
              range{0, elements * 12});
    });
    const auto actual = c.template get<std::uint32_t>(out);
    comparison check = c.compare("indices");
    for (std::uint32_t e = 0; e < elements; ++e) {
        for (std::uint32_t k = 0; k < 12; ++k) {
            check.same(actual[e * 12 + k], 1000 + e * around + pattern[k]);
        }
    }
}

template <backend B>
void add_ring_cases(cases<B>& to) {
    using C = context<B>;
    const auto add = [&](std::string name, std::function<void(C&)> body) {
        to.push_back({"rings", std::move(name), std::move(body)});
    };
    if constexpr (expands_rings<B, kernels::probe_rings>) {
        for (const named_size n : edge_sizes) {
            add(n.name, [n](C& c) { rings_of(c, random_payloads(c, n.size), 5, {0, n.size}); });
        }
        add("part", [](C& c) { rings_of(c, random_payloads(c, 500), 9, {77, 300}); });
        // More than the 1,024 components that a geometry shader may put out.
        add("many_vertices", [](C& c) { rings_of(c, random_payloads(c, 33), 1031, {0, 33}); });
        add("components_limit", [](C& c) {
            for (const std::uint32_t around : {127u, 128u, 129u, 255u, 256u, 257u}) {
                rings_of(c, random_payloads(c, 20), around, {0, 20});
            }
        });
        add("one_huge_element", [](C& c) { rings_of(c, random_payloads(c, 2), 70001, {0, 2}); });
        add("nan", [](C& c) {
            auto payloads = random_payloads(c, 100);
            for (std::size_t i = 0; i < 100; i += 3) {
                payloads[i].x = std::numeric_limits<float>::quiet_NaN();
                payloads[i].y = -std::numeric_limits<float>::infinity();
            }
            rings_of(c, payloads, 4, {0, 100});
        });
        add("twice_in_one_recorder", rings_twice<B>);
        add("two_recorders", rings_two_recorders<B>);
    }
    if constexpr (maps<B, kernels::ring_indices>) {
        add("index_buffer", ring_index_buffer<B>);
    }
}

} // namespace skybark::conformance
