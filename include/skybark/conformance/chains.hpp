#pragma once
// Cases: patterns behind each other in one recorder. What one wrote, the next one sees, and no
// length visits the host.

#include <skybark/conformance/draws.hpp>
#include <skybark/conformance/lists.hpp>
#include <skybark/conformance/maps.hpp>

namespace skybark::conformance {

/// Strips of `each` triangles, one strip an element.
[[nodiscard]] inline strip_input even_strips(std::uint32_t elements, std::uint32_t each) {
    strip_input in{{1, each}, {}, {}};
    in.counts.assign(elements, each);
    in.payloads.assign(elements, {1, 2, 3, 4});
    return in;
}

/// expand → map over its count → expand over its count → draw by that one's count.
template <backend B>
void counts_go_on(context<B>& c, padding policy) {
    auto first = random_strips(c, 30, {2, 3});
    first.counts.assign(first.counts.size(), 0);
    first.counts[5] = 3;
    first.counts[40] = 2; // five triangles in all, or 180 with the spare ones
    const std::uint32_t triangles = policy == padding::compact ? 5 : 180;
    const auto second = even_strips(200, 4);
    const std::uint32_t limit = 15;
    const std::uint32_t elements = std::min(triangles, limit);

    const auto first_buffers = put_strips(c, first);
    const auto second_buffers = put_strips(c, second);
    const auto first_list = c.template room<kernels::probe_strip_vertex>(3 * 180);
    const auto second_list = c.template room<kernels::probe_strip_vertex>(3 * 4 * limit);
    const auto first_count = c.template room<count_record>(1);
    const auto second_count = c.template room<count_record>(1);
    const auto mapped = make_map_probe(c, 200);
    const auto corners = c.put(numbered_cells(cell_picture));
    const auto tints = c.put(std::vector<glm::vec4>{{1, 1, 1, 1}});
    const auto image = new_image(c, cell_picture);
    draw_geometry<B> geometry;
    geometry.length = second_count.view();
    draw_target<B> target;
    target.color = &image;
    target.clear_color = glm::vec4(0);
    c.run([&](auto& r) {
        r.expand(first.kernel, first_buffers.views(), range{0, 30},
                 triangle_list<B>{first_list.view(), first_count.view(), policy});
        r.map(mapped.kernel, mapped.buffers(), counted<B>{first_count.view(), 200});
        r.expand(second.kernel, second_buffers.views(), counted<B>{first_count.view(), limit},
                 triangle_list<B>{second_list.view(), second_count.view(), policy});
        r.draw(kernels::probe_surface{}, {corners.view(), tints.view()}, {}, geometry, target,
               draw_state{});
    });
    c.expect_count(first_count, triangles, triangles);
    expect_mapped(c, mapped, {0, triangles});
    c.expect_count(second_count, 4 * elements, 4 * elements);
    expect_cells(c, read_image(c, image), 0, 2 * elements);
}

/// A list is expanded, copied, and expanded over, in one recorder.
template <backend B>
void list_is_used_again(context<B>& c) {
    const auto a = random_strips(c, 100);
    const auto b = random_strips(c, 100);
    const range all{0, 100};
    const std::uint64_t size = 3 * std::max(triangles_of(a, all, padding::compact),
                                            triangles_of(b, all, padding::compact));
    const auto buffers_a = put_strips(c, a);
    const auto buffers_b = put_strips(c, b);
    const auto list = c.template room<kernels::probe_strip_vertex>(size);
    const auto kept = c.template room<kernels::probe_strip_vertex>(size);
    const auto count = c.template room<count_record>(1);
    const auto kept_count = c.template room<count_record>(1);
    const triangle_list<B> out{list.view(), count.view(), padding::compact};
    c.run([&](auto& r) {
        r.expand(a.kernel, buffers_a.views(), all, out);
        r.copy(list.view(), kept.view());
        r.copy(count.view(), kept_count.view());
        r.expand(b.kernel, buffers_b.views(), all, out);
    });
    expect_list(c, a, all, padding::compact, kept, kept_count);
    expect_list(c, b, all, padding::compact, list, count);
}

/// Levels make the numbers that an expansion takes as its triangle counts.
template <backend B>
void levels_feed_an_expansion(context<B>& c) {
    strip_input in = even_strips(300, 5);
    std::vector<kernels::probe_node> nodes;
    for (std::uint32_t i = 0; i < 300; ++i) { // roots with 0 or 1, then 3 · parent + 0…2
        nodes.push_back(i < 100 ? kernels::probe_node{i, c.below(2)}
                                : kernels::probe_node{c.below(100), c.below(3)});
        in.counts[i] = i < 100 ? nodes[i].weight : in.counts[nodes[i].parent] * 3 + nodes[i].weight;
    }
    const auto nodes_in = c.put(nodes);
    // Zeros: a backend that gets the levels wrong still finds no more triangles than there may be.
    const auto counts = c.put(std::vector<std::uint32_t>(300, 0));
    const auto payloads = c.put(in.payloads);
    const auto list = c.template room<kernels::probe_strip_vertex>(3 * 5 * 300);
    const auto count = c.template room<count_record>(1);
    const range levels[] = {{0, 100}, {100, 200}};
    c.run([&](auto& r) {
        r.map(kernels::probe_level{}, {nodes_in.view(), counts.view(), counts.view()},
              std::span<const range>(levels));
        r.expand(in.kernel, {counts.view(), payloads.view()}, range{0, 300},
                 triangle_list<B>{list.view(), count.view(), padding::compact});
    });
    expect_list(c, in, {0, 300}, padding::compact, list, count);
}

/// A map makes the tint that a draw's fragments read, twice over.
template <backend B>
void map_feeds_a_draw(context<B>& c) {
    const image_description what{8, 8, image_format::rgba32f};
    const auto corners = c.put(rectangle(what, 0, 0, 8, 8, 0.5, {1, 1, 1, 1}));
    const auto p = make_map_probe(c, 1);
    const auto first = new_image(c, what);
    const auto second = new_image(c, what);
    draw_geometry<B> geometry;
    geometry.count = 6;
    draw_target<B> target;
    c.run([&](auto& r) {
        kernels::probe_map kernel = p.kernel;
        for (const auto* image : {&first, &second}) {
            target.color = image;
            r.map(kernel, p.buffers(), range{0, 1});
            r.draw(kernels::probe_surface{kernels::probe_show::color, 0, -1e9f},
                   {corners.view(), p.vectors_out.view()}, {}, geometry, target, draw_state{});
            kernel.bias += 100;
        }
    });
    comparison check = c.compare("channels");
    for (const glm::vec4& pixel : read_image(c, first).pixels) {
        check.close_to(pixel, p.vectors[0] * 2.0f - 5.0f, 1e-3);
    }
    for (const glm::vec4& pixel : read_image(c, second).pixels) {
        check.close_to(pixel, p.vectors[0] * 2.0f + 95.0f, 1e-3);
    }
}

/// What is drawn into an image (or its depth), the next draw reads; then it's drawn over again.
template <backend B>
void draw_reads_a_drawn_image(context<B>& c) {
    const image_description what{16, 16, image_format::rgba32f};
    const auto image = new_image(c, what);
    const auto depth = new_image(c, {16, 16, image_format::depth32f});
    const auto seen = new_image(c, what);
    const auto seen_depth = new_image(c, what);
    const auto left = c.put(rectangle(what, 0, 0, 8, 16, 0.25, red));
    const auto all = c.put(textured(what, 0, 0, 1, 1));
    const auto tints = c.put(std::vector<glm::vec4>{{1, 1, 1, 1}, {0, 1, 0, 1}});
    draw_geometry<B> geometry;
    geometry.count = 6;
    draw_target<B> target;
    target.color = &image;
    target.depth = &depth;
    target.clear_color = blue;
    target.clear_depth = 1.0f;
    draw_target<B> to_seen;
    to_seen.color = &seen;
    draw_target<B> to_seen_depth;
    to_seen_depth.color = &seen_depth;
    const image_bindings<B, kernels::probe_image> images{{{&image}, {&depth}}};
    c.run([&](auto& r) {
        r.draw(kernels::probe_surface{}, {left.view(), tints.view()}, {}, geometry, target,
               draw_state{});
        r.draw(kernels::probe_image{kernels::probe_read::fetch, 0, 0}, {all.view()}, images,
               geometry, to_seen, draw_state{});
        r.draw(kernels::probe_image{kernels::probe_read::fetch_second, 0, 0}, {all.view()}, images,
               geometry, to_seen_depth, draw_state{});
        target.clear_color = green;
        r.draw(kernels::probe_surface{kernels::probe_show::color, 1, 0},
               {left.view(), tints.view()}, {}, geometry, target, draw_state{});
    });
    const picture colors = read_image(c, seen);
    const picture depths = read_image(c, seen_depth);
    const picture last = read_image(c, image);
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            check.same(colors.at(x, y), x < 8 ? red : blue);
            check.close_to(depths.at(x, y), {x < 8 ? 0.25f : 1.0f, 0, 0, 1}, 1e-6);
            check.same(last.at(x, y), x < 8 ? glm::vec4(0, 0, 0, 1) : green);
        }
    }
}

template <backend B>
void add_chain_cases(cases<B>& to) {
    using C = context<B>;
    const auto add = [&](std::string name, std::function<void(C&)> body) {
        to.push_back({"chain", std::move(name), std::move(body)});
    };
    if constexpr (expands<B, kernels::probe_strips>) {
        add("list_is_used_again", list_is_used_again<B>);
        if constexpr (maps<B, kernels::probe_level>) {
            add("levels_feed_an_expansion", levels_feed_an_expansion<B>);
        }
    }
    if constexpr (maps<B, kernels::probe_map> && draws<B, kernels::probe_surface>) {
        add("map_feeds_a_draw", map_feeds_a_draw<B>);
        if constexpr (expands<B, kernels::probe_strips>) {
            add("counts_go_on_compact", [](C& c) { counts_go_on(c, padding::compact); });
            add("counts_go_on_degenerate", [](C& c) { counts_go_on(c, padding::degenerate); });
        }
    }
    if constexpr (draws<B, kernels::probe_surface> && draws<B, kernels::probe_image>) {
        add("draw_reads_a_drawn_image", draw_reads_a_drawn_image<B>);
    }
}

} // namespace skybark::conformance
