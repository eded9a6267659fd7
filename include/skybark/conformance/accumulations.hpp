#pragma once
// Cases: accumulate. The sums that are expected are made here in 64-bit integers.

#include <skybark/conformance/volumes.hpp>
#include <skybark/kernels/probe_slabs.hpp>

#include <glm/common.hpp>

namespace skybark::conformance {

/// How an accumulation reaches its voxels.
struct slab_route {
    accumulate_route route = accumulate_route::direct;
    padding policy = padding::compact;
};

/// What one accumulate call of a case is: elements [part.first, part.first + part.count).
template <backend B>
struct slab_probe {
    kernels::probe_slabs kernel{4, 3, -7, 1};
    std::vector<kernels::probe_box> boxes;
    guarded<B> boxes_in;

    [[nodiscard]] bindings<B, kernels::probe_slabs> buffers() const { return {boxes_in.view()}; }
    [[nodiscard]] range all() const { return {0, static_cast<std::uint32_t>(boxes.size())}; }
};

template <backend B>
[[nodiscard]] slab_probe<B> put_boxes(const context<B>& c, std::vector<kernels::probe_box> boxes,
                                      kernels::probe_slabs kernel = {4, 3, -7, 1}) {
    auto boxes_in = c.put(boxes);
    return {kernel, std::move(boxes), std::move(boxes_in)};
}

template <volume_backend B>
[[nodiscard]] accumulation<B> into(const typename B::volume& volume, bool clear, slab_route by) {
    return {&volume, clear, by.route, by.policy};
}

/// Adds what the boxes add. Nothing of it comes from the kernel: this is what its comment says.
inline void add_expected(std::vector<std::int64_t>& sums, glm::ivec3 size,
                         const kernels::probe_slabs& with,
                         std::span<const kernels::probe_box> boxes) {
    for (const kernels::probe_box& box : boxes) {
        const std::int64_t last =
            std::min<std::int64_t>({size.z, box.high.z, box.low.z + std::int64_t{with.most}});
        for (std::int64_t z = std::max(box.low.z, 0); z < last; ++z) {
            const std::int64_t s = z - box.low.z;
            for (std::int64_t y = std::max(box.low.y, 0);
                 y < std::min<std::int64_t>(size.y, box.high.y - s); ++y) {
                for (std::int64_t x = std::max<std::int64_t>(box.low.x + s, 0);
                     x < std::min(size.x, box.high.x); ++x) {
                    const std::int64_t amount =
                        box.low.w + with.per_x * x + with.per_z * z + box.high.w * y;
                    sums[static_cast<std::size_t>((z * size.y + y) * size.x + x)] +=
                        amount * with.factor;
                }
            }
        }
    }
}

template <volume_backend B>
void expect_sums(const context<B>& c, const typename B::volume& volume,
                 const std::vector<std::int64_t>& expected, const char* what = "sums") {
    const auto actual = get_volume<std::int32_t>(c, volume);
    comparison check = c.compare(what);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        check.same(actual[i], static_cast<double>(expected[i]));
    }
}

/// Boxes of all sizes, some of them empty, around and inside the volume; the first one is in it.
template <backend B>
[[nodiscard]] std::vector<kernels::probe_box> random_boxes(context<B>& c, glm::ivec3 size,
                                                           std::size_t count) {
    const auto between = [&](int low, int high) {
        return low + static_cast<int>(c.below(static_cast<std::uint32_t>(high - low + 1)));
    };
    std::vector<kernels::probe_box> boxes(count);
    for (kernels::probe_box& box : boxes) {
        for (int k = 0; k < 3; ++k) {
            box.low[k] = between(-4, size[k] + 2);
            box.high[k] = box.low[k] + between(-1, 9);
        }
        box.low.w = between(-50, 50);
        box.high.w = between(-3, 3);
    }
    if (count != 0) {
        boxes[0] = {{0, 0, 0, 17}, glm::ivec4(glm::min(size, glm::ivec3(4)), 2)};
    }
    return boxes;
}

/// A volume with numbers in it, and a copy of them.
template <volume_backend B>
struct number_volume {
    typename B::volume volume;
    std::vector<std::int64_t> sums;
};
template <volume_backend B>
[[nodiscard]] number_volume<B> put_numbers(context<B>& c, glm::ivec3 size) {
    std::vector<std::int32_t> numbers(voxels_of(size));
    for (std::int32_t& number : numbers) {
        number = static_cast<std::int32_t>(c.below(2001)) - 1000;
    }
    auto volume = put_volume(c, size, volume_format::int32, numbers);
    return {std::move(volume), {numbers.begin(), numbers.end()}};
}

/// Clears a volume with numbers in it and adds boxes.
template <volume_backend B>
void accumulate_boxes(context<B>& c, glm::ivec3 size, std::vector<kernels::probe_box> boxes,
                      slab_route by, kernels::probe_slabs kernel = {4, 3, -7, 1}) {
    const auto to = put_numbers(c, size);
    const auto p = put_boxes(c, std::move(boxes), kernel);
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), p.all(), into<B>(to.volume, true, by));
    });
    std::vector<std::int64_t> expected(voxels_of(size));
    add_expected(expected, size, p.kernel, p.boxes);
    expect_sums(c, to.volume, expected);
    (void)c.template get<kernels::probe_box>(p.boxes_in);
}

template <volume_backend B>
void accumulate_count(context<B>& c, std::uint32_t count, slab_route by) {
    const glm::ivec3 size{33, 17, 9};
    accumulate_boxes(c, size, random_boxes(c, size, count), by);
}

template <volume_backend B>
void accumulate_sizes(context<B>& c, slab_route by) {
    for (const glm::ivec3 size : odd_sizes) {
        accumulate_boxes(c, size, random_boxes(c, size, 150), by);
    }
}

/// A part of the elements, to what is there; then other parameters; then none.
template <volume_backend B>
void accumulate_adds(context<B>& c, slab_route by) {
    const glm::ivec3 size{20, 30, 11};
    auto to = put_numbers(c, size);
    const auto p = put_boxes(c, random_boxes(c, size, 300));
    auto other = p.kernel;
    other.per_x = 5;
    other.factor = -2;
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), range{100, 77}, into<B>(to.volume, false, by));
        r.accumulate(other, p.buffers(), range{150, 150}, into<B>(to.volume, false, by));
        r.accumulate(other, p.buffers(), range{300, 0}, into<B>(to.volume, false, by));
    });
    add_expected(to.sums, size, p.kernel, std::span(p.boxes).subspan(100, 77));
    add_expected(to.sums, size, other, std::span(p.boxes).subspan(150));
    expect_sums(c, to.volume, to.sums);
}

/// No elements: a volume is cleared, or kept, all the same.
template <volume_backend B>
void accumulate_nothing(context<B>& c, slab_route by) {
    const glm::ivec3 size{5, 6, 7};
    const auto cleared = put_numbers(c, size);
    const auto kept = put_numbers(c, size);
    const auto p = put_boxes(c, random_boxes(c, size, 10));
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), range{3, 0}, into<B>(cleared.volume, true, by));
        r.accumulate(p.kernel, p.buffers(), range{3, 0}, into<B>(kept.volume, false, by));
    });
    expect_sums(c, cleared.volume, std::vector<std::int64_t>(voxels_of(size)), "cleared sums");
    expect_sums(c, kept.volume, kept.sums, "kept sums");
}

template <volume_backend B>
void accumulate_counted(context<B>& c, std::uint32_t written, std::uint32_t limit, slab_route by) {
    const glm::ivec3 size{33, 17, 9};
    auto to = put_numbers(c, size);
    const auto p = put_boxes(c, random_boxes(c, size, 500));
    const auto count = c.put_count(written);
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), counted<B>{count.view(), limit},
                     into<B>(to.volume, false, by));
    });
    add_expected(to.sums, size, p.kernel, std::span(p.boxes).first(std::min(written, limit)));
    expect_sums(c, to.volume, to.sums);
}

/// Boxes that touch the volume's sides from without, reach over one of them, over all, or are far
/// away. What is taken around a side would show at the other one.
template <volume_backend B>
void accumulate_outside(context<B>& c, slab_route by) {
    const glm::ivec3 size{12, 10, 8};
    std::vector<kernels::probe_box> boxes;
    for (int k = 0; k < 3; ++k) {
        for (const int away : {1, 3, 1000, 1000000}) {
            for (const glm::ivec2 reach : {glm::ivec2{-away, 0},
                                           {-away, 1},
                                           {-away, size[k] + away},
                                           {size[k], size[k] + away},
                                           {size[k] - 1, size[k] + away}}) {
                kernels::probe_box box{{4, 4, 4, 100 * k + away % 7}, {9, 9, 6, 2}};
                box.low[k] = reach.x;
                box.high[k] = reach.y;
                boxes.push_back(box);
            }
        }
    }
    boxes.push_back({{-1000000, -1000000, -3, 5}, {1000000, 1000000, 1000000, 1}});
    boxes.push_back({{-1000000, -1000000, 5, 5}, {1000000, 1000000, 1000000, 1}});
    accumulate_boxes(c, size, std::move(boxes), by, {4, 3, -7, 1});
}

/// Elements of no slabs, and of one, among others with all that there may be.
template <volume_backend B>
void accumulate_slab_counts(context<B>& c, std::uint32_t most, slab_route by) {
    const glm::ivec3 size{17, 23, 90};
    std::vector<kernels::probe_box> boxes;
    for (int i = 0; i < 60; ++i) {
        const int layers = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : i * 2;
        boxes.push_back({{-20, i % 5, i % 10, i + 1}, {17, 40 + i, i % 10 + layers, -1}});
    }
    accumulate_boxes(c, size, std::move(boxes), by, {most, 1, 2, 1});
}

/// A few elements that fill the volume.
template <volume_backend B>
void accumulate_wide(context<B>& c, slab_route by) {
    const glm::ivec3 size{150, 61, 5};
    accumulate_boxes(c, size,
                     {{{-5, -5, 0, 3}, {200, 100, 5, 1}},
                      {{0, 0, 0, -9}, {150, 61, 5, 2}},
                      {{70, 20, 2, 11}, {150, 61, 3, -4}}},
                     by, {5, 3, -7, 1});
}

/// All on the same few voxels.
template <volume_backend B>
void accumulate_crowd(context<B>& c, std::uint32_t count, slab_route by) {
    const glm::ivec3 size{6, 6, 6};
    std::vector<kernels::probe_box> boxes(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const int at = static_cast<int>(i % 2);
        boxes[i] = {{2, 2, 2 + at, static_cast<int>(i % 201) - 90}, {4, 4, 3 + at, 0}};
    }
    accumulate_boxes(c, size, std::move(boxes), by, {1, 0, 0, 1});
}

/// More elements than 65,535 groups of 64 have room for, and their number on the device.
template <volume_backend B>
void accumulate_groups(context<B>& c) {
    const glm::ivec3 size{5, 4, 3};
    constexpr std::uint32_t count = 65535 * 64 + 1;
    std::vector<kernels::probe_box> boxes(count); // most of them have no slabs
    for (std::uint32_t i = 0; i < count; i += 64) {
        boxes[i] = {{1, 1, 1, 1}, {3, 2, 2, 0}};
    }
    boxes.back() = {{0, 0, 0, 1000}, {1, 1, 1, 0}};
    const auto p = put_boxes(c, std::move(boxes), {1, 0, 0, 1});
    const auto sums = put_numbers(c, size);
    const auto length = c.put_count(count);
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), p.all(), into<B>(sums.volume, true, {}));
        r.accumulate(p.kernel, p.buffers(), counted<B>{length.view(), count},
                     into<B>(sums.volume, false, {}));
    });
    std::vector<std::int64_t> expected(voxels_of(size));
    expected[voxel_index({0, 0, 0}, size)] = 2000;
    expected[voxel_index({1, 1, 1}, size)] = 2 * (count / 64);
    expected[voxel_index({2, 1, 1}, size)] = 2 * (count / 64);
    expect_sums(c, sums.volume, expected);
}

/// Sums near the ends of an int32, of amounts as large: a float holds neither.
template <volume_backend B>
void accumulate_large_sums(context<B>& c, slab_route by) {
    const glm::ivec3 size{9, 9, 3};
    std::vector<kernels::probe_box> boxes;
    for (int i = 0; i < 30; ++i) { // 15 times 131,200,000: less than 2^31
        const bool left = i % 2 == 0;
        boxes.push_back({{left ? 0 : 5, 0, 0, left ? 18724 : -18724}, {left ? 5 : 9, 9, 3, i % 2}});
    }
    accumulate_boxes(c, size, std::move(boxes), by, {3, 1, 1, 7000});
}

template <volume_backend B>
void accumulate_shuffled(context<B>& c, slab_route by) {
    const glm::ivec3 size{24, 24, 24};
    auto boxes = random_boxes(c, size, 2000);
    const auto a = new_volume(c, size, volume_format::int32);
    const auto b = new_volume(c, size, volume_format::int32);
    const auto p = put_boxes(c, boxes);
    std::shuffle(boxes.begin(), boxes.end(), c.random);
    const auto q = put_boxes(c, std::move(boxes));
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), p.all(), into<B>(a, true, by));
        r.accumulate(q.kernel, q.buffers(), q.all(), into<B>(b, true, by));
    });
    const auto sums = get_volume<std::int32_t>(c, b);
    expect_sums(c, a, {sums.begin(), sums.end()}, "sums of elements in another order");
    std::vector<std::int64_t> expected(voxels_of(size));
    add_expected(expected, size, p.kernel, p.boxes);
    expect_sums(c, a, expected);
}

/// Each accumulation sees what the one before it left, and its scan is of that moment.
template <volume_backend B>
void accumulate_twice(context<B>& c, slab_route by) {
    const glm::ivec3 size{19, 14, 10};
    const auto sums = new_volume(c, size, volume_format::int32);
    const auto first = new_volume(c, size, volume_format::int32);
    const auto second = new_volume(c, size, volume_format::int32);
    const auto p = put_boxes(c, random_boxes(c, size, 200));
    const auto q = put_boxes(c, random_boxes(c, size, 70));
    const volume_scan as_it_is{scan_axis::none, scan_direction::ascending, scan_share::whole, 1};
    c.run([&](auto& r) {
        r.accumulate(p.kernel, p.buffers(), p.all(), into<B>(sums, true, by));
        r.scan(sums, first, as_it_is);
        r.accumulate(q.kernel, q.buffers(), q.all(), into<B>(sums, false, by));
        r.scan(sums, second, as_it_is);
        r.accumulate(q.kernel, q.buffers(), range{10, 20}, into<B>(sums, true, by));
    });
    std::vector<std::int64_t> expected(voxels_of(size));
    add_expected(expected, size, p.kernel, p.boxes);
    expect_sums(c, first, expected, "sums of the first");
    add_expected(expected, size, q.kernel, q.boxes);
    expect_sums(c, second, expected, "sums of both");
    expected.assign(expected.size(), 0);
    add_expected(expected, size, q.kernel, std::span(q.boxes).subspan(10, 20));
    expect_sums(c, sums, expected, "sums of the last");
}

template <volume_backend B>
void accumulate_two_recorders(context<B>& c, slab_route by) {
    const glm::ivec3 size{13, 8, 21};
    auto a = put_numbers(c, size);
    auto b = put_numbers(c, size);
    const auto p = put_boxes(c, random_boxes(c, size, 90));
    const auto q = put_boxes(c, random_boxes(c, size, 110));
    auto first = c.begin();
    auto second = c.begin();
    second.accumulate(q.kernel, q.buffers(), range{0, 60}, into<B>(b.volume, false, by));
    first.accumulate(p.kernel, p.buffers(), p.all(), into<B>(a.volume, false, by));
    second.accumulate(q.kernel, q.buffers(), range{60, 50}, into<B>(b.volume, false, by));
    c.submit(second);
    c.submit(first);
    add_expected(a.sums, size, p.kernel, p.boxes);
    add_expected(b.sums, size, q.kernel, q.boxes);
    expect_sums(c, a.volume, a.sums, "sums of the first recorder");
    expect_sums(c, b.volume, b.sums, "sums of the second recorder");
}

template <backend B>
void add_accumulate_cases(cases<B>& to, const std::string& prefix, slab_route by) {
    const auto add = [&](const std::string& name, std::function<void(context<B>&)> body) {
        to.push_back({"accumulate", prefix + name, std::move(body)});
    };
    add("nothing", [by](context<B>& c) { accumulate_nothing(c, by); });
    add("one", [by](context<B>& c) { accumulate_count(c, 1, by); });
    add("limit_plus_1", [by](context<B>& c) { accumulate_count(c, 65, by); });
    add("block_plus_1", [by](context<B>& c) { accumulate_count(c, 257, by); });
    add("sizes", [by](context<B>& c) { accumulate_sizes(c, by); });
    add("adds", [by](context<B>& c) { accumulate_adds(c, by); });
    add("counted", [by](context<B>& c) { accumulate_counted(c, 321, 500, by); });
    add("counted_empty", [by](context<B>& c) { accumulate_counted(c, 0, 500, by); });
    add("counted_above_limit", [by](context<B>& c) { accumulate_counted(c, 499, 130, by); });
    add("counted_limit_0", [by](context<B>& c) { accumulate_counted(c, 499, 0, by); });
    add("outside", [by](context<B>& c) { accumulate_outside(c, by); });
    add("slabs_none", [by](context<B>& c) { accumulate_slab_counts(c, 0, by); });
    add("slabs_one", [by](context<B>& c) { accumulate_slab_counts(c, 1, by); });
    add("slabs_fewer", [by](context<B>& c) { accumulate_slab_counts(c, 21, by); });
    add("slabs_hundred", [by](context<B>& c) { accumulate_slab_counts(c, 100, by); });
    add("wide", [by](context<B>& c) { accumulate_wide(c, by); });
    add("crowd", [by](context<B>& c) { accumulate_crowd(c, 3000, by); });
    add("large_sums", [by](context<B>& c) { accumulate_large_sums(c, by); });
    add("shuffled", [by](context<B>& c) { accumulate_shuffled(c, by); });
    add("twice_in_one_recorder", [by](context<B>& c) { accumulate_twice(c, by); });
    add("two_recorders", [by](context<B>& c) { accumulate_two_recorders(c, by); });
    add("many", [by](context<B>& c) { accumulate_crowd(c, 70000, by); });
}

template <backend B>
void add_accumulation_cases(cases<B>& to) {
    if constexpr (accumulates<B, kernels::probe_slabs>) {
        using enum accumulate_route;
        const std::pair<const char*, accumulate_route> routes[] = {{"direct", direct},
                                                                   {"tiles_copied", tiles_copied},
                                                                   {"tiles_drawn", tiles_drawn},
                                                                   {"layers", layers}};
        for (const auto& [name, route] : routes) {
            const auto prefix = std::string(name) + "_";
            add_accumulate_cases(to, prefix + "compact_", {route, padding::compact});
            if (route != direct) { // which knows no padding
                add_accumulate_cases(to, prefix + "degenerate_", {route, padding::degenerate});
            }
        }
        to.push_back({"accumulate", "direct_groups_plus_1", accumulate_groups<B>});
    }
}

} // namespace skybark::conformance
