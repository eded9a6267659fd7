#pragma once
// Cases: running sums along the axes of volumes, and their formats.

#include <skybark/conformance/accumulations.hpp>

#include <limits>

namespace skybark::conformance {

[[nodiscard]] inline int scanned_axis(scan_axis axis) { // 0 … 2, or −1
    return static_cast<int>(axis) - static_cast<int>(scan_axis::x);
}

/// For each line along the axis: calls `line(indices)` with its voxels, from where the sum begins.
template <class Line>
void each_line(glm::ivec3 size, volume_scan how, Line&& line) {
    const int axis = how.axis == scan_axis::none ? -1 : scanned_axis(how.axis);
    glm::ivec3 starts = size;
    if (axis >= 0) {
        starts[axis] = 1;
    }
    each_voxel(starts, [&](glm::ivec3 at) {
        std::vector<std::size_t> indices{voxel_index(at, size)};
        for (int i = 1; axis >= 0 && i < size[axis]; ++i) {
            at[axis] = i;
            indices.push_back(voxel_index(at, size));
        }
        if (how.direction == scan_direction::descending) {
            std::reverse(indices.begin(), indices.end());
        }
        line(indices);
    });
}

/// Twice the sums, as halves are whole then, in integers.
[[nodiscard]] inline std::vector<std::int64_t> twice_the_sums(const std::vector<std::int64_t>& own,
                                                              glm::ivec3 size, volume_scan how) {
    std::vector<std::int64_t> sums(own.size());
    each_line(size, how, [&](const std::vector<std::size_t>& line) {
        std::int64_t before = 0;
        for (const std::size_t i : line) {
            const int halves = how.share == scan_share::whole  ? 2
                               : how.share == scan_share::half ? 1
                                                               : 0;
            sums[i] = 2 * before + halves * own[i];
            before += own[i];
        }
    });
    return sums;
}

[[nodiscard]] inline const char* name_of(volume_format format) {
    return format == volume_format::int32     ? "int32"
           : format == volume_format::float32 ? "float32"
                                              : "float16";
}

/// What a volume holds, as numbers.
template <volume_backend B>
[[nodiscard]] std::vector<double> get_numbers(const context<B>& c,
                                              const typename B::volume& volume) {
    const volume_description what = volume.description();
    if (what.format == volume_format::int32) {
        const auto voxels = get_volume<std::int32_t>(c, volume);
        return {voxels.begin(), voxels.end()};
    }
    if (what.format == volume_format::float32) {
        const auto voxels = get_volume<float>(c, volume);
        return {voxels.begin(), voxels.end()};
    }
    std::vector<double> numbers;
    for (const std::uint16_t voxel : get_volume<std::uint16_t>(c, volume)) {
        numbers.push_back(float16_value(voxel));
    }
    return numbers;
}

/// A volume of int32 or float32 with whole numbers from −largest to largest.
template <volume_backend B>
[[nodiscard]] number_volume<B> put_whole_numbers(context<B>& c, glm::ivec3 size,
                                                 volume_format format, std::int32_t largest) {
    std::vector<std::int64_t> numbers(voxels_of(size));
    for (std::int64_t& number : numbers) {
        number = std::int64_t{c.below(2 * static_cast<std::uint32_t>(largest) + 1)} - largest;
    }
    auto volume =
        format == volume_format::int32
            ? put_volume(c, size, format, std::vector<std::int32_t>(numbers.begin(), numbers.end()))
            : put_volume(c, size, format, std::vector<float>(numbers.begin(), numbers.end()));
    return {std::move(volume), std::move(numbers)};
}

/// Whole numbers, so few and so small that every format holds every sum, and that any order and any
/// device gives the same: twice a sum stays below 2^11 for float16, and below 2^24 for float32.
template <volume_backend B>
void scan_whole_numbers(context<B>& c, glm::ivec3 size, volume_scan how, volume_format from,
                        volume_format to) {
    const bool half_size = to == volume_format::float16;
    const auto in = put_whole_numbers(c, size, from, half_size ? 3 : 20000);
    how.scale = to == volume_format::int32 ? 1.0f : 0.0625f;
    const auto out = new_volume(c, size, to);
    c.run([&](auto& r) { r.scan(in.volume, out, how); });
    const auto expected = twice_the_sums(in.sums, size, how);
    const auto actual = get_numbers(c, out);
    const auto untouched = get_numbers(c, in.volume);
    const char* share = how.share == scan_share::whole  ? "whole"
                        : how.share == scan_share::half ? "half"
                                                        : "none";
    comparison check = c.compare(std::string("sums from ") + name_of(from) + " to " + name_of(to) +
                                 ", share " + share + ",");
    comparison source = c.compare("voxels of the source");
    for (std::size_t i = 0; i < expected.size(); ++i) {
        check.same(actual[i], static_cast<double>(expected[i]) / 2 * double{how.scale});
        source.same(untouched[i], static_cast<double>(in.sums[i]));
    }
}

template <volume_backend B>
void scan_formats(context<B>& c, scan_axis axis, scan_direction direction) {
    using enum volume_format;
    for (const scan_share share : {scan_share::whole, scan_share::half, scan_share::none}) {
        const volume_scan how{axis, direction, share, 1};
        for (const glm::ivec3 size : {glm::ivec3{3, 5, 7}, {66, 3, 130}, {1, 300, 2}}) {
            scan_whole_numbers(c, size, how, int32, float32);
            scan_whole_numbers(c, size, how, int32, float16);
            scan_whole_numbers(c, size, how, float32, float32);
            scan_whole_numbers(c, size, how, float32, float16);
            if (share != scan_share::half) {
                scan_whole_numbers(c, size, how, int32, int32);
            }
        }
    }
}

template <volume_backend B>
void scan_sizes(context<B>& c, scan_axis axis) {
    for (const glm::ivec3 size : odd_sizes) {
        scan_whole_numbers(c, size, {axis, scan_direction::descending, scan_share::half, 1},
                           volume_format::int32, volume_format::float32);
    }
}

/// Floats whose sum is another one in any other order: it goes from voxel to voxel. Each sum is
/// rounded once, the half of a voxel is exact, and so is a scale that is a power of two.
template <volume_backend B>
void scan_float_order(context<B>& c, scan_axis axis, scan_direction direction) {
    const glm::ivec3 size{40, 33, 70};
    std::vector<float> own(voxels_of(size));
    for (float& voxel : own) {
        voxel = std::ldexp(c.small_number() + 0.25f, static_cast<int>(c.below(24)) - 12);
    }
    const auto in = put_volume(c, size, volume_format::float32, own);
    for (const scan_share share : {scan_share::whole, scan_share::half, scan_share::none}) {
        const volume_scan how{axis, direction, share, 0.25f};
        const auto out = new_volume(c, size, volume_format::float32);
        c.run([&](auto& r) { r.scan(in, out, how); });
        const auto actual = get_volume<float>(c, out);
        comparison check = c.compare("sums of floats in order");
        each_line(size, how, [&](const std::vector<std::size_t>& line) {
            float before = 0;
            for (const std::size_t i : line) {
                const float after = before + own[i];
                const float sum = share == scan_share::whole  ? after
                                  : share == scan_share::half ? before + own[i] * 0.5f
                                                              : before;
                check.same(actual[i], sum * 0.25f);
                before = after;
            }
        });
    }
}

/// Sums of int32 up to its ends. Those of int32 are exact. A float of one is rounded once for each
/// number that goes into it and once by the scale: 2^-22 of the largest of them is enough.
template <volume_backend B>
void scan_large_sums(context<B>& c, volume_format to) {
    const glm::ivec3 size{5, 90, 6};
    constexpr std::int64_t most = (1 << 30) - 1;
    std::vector<std::int64_t> own(voxels_of(size));
    volume_scan how{scan_axis::y, scan_direction::descending, scan_share::whole, 1};
    each_line(size, how, [&](const std::vector<std::size_t>& line) {
        std::int64_t before = 0;
        for (const std::size_t i : line) {
            const std::int64_t after = std::int64_t{c.below(2 * most + 1)} - most;
            own[i] = after - before;
            before = after;
        }
    });
    const auto in = put_volume(c, size, volume_format::int32,
                               std::vector<std::int32_t>(own.begin(), own.end()));
    how.scale = to == volume_format::int32 ? 1.0f : 0x1.8p-22f;
    for (const scan_share share : {scan_share::whole, scan_share::half, scan_share::none}) {
        if (share == scan_share::half && to == volume_format::int32) {
            continue;
        }
        how.share = share;
        const auto out = new_volume(c, size, to);
        c.run([&](auto& r) { r.scan(in, out, how); });
        const auto expected = twice_the_sums(own, size, how);
        const auto actual = get_numbers(c, out);
        const double scale = double{how.scale};
        const double rounding = to == volume_format::int32 ? 0 : 0x1p31 * scale * 0x1p-22;
        comparison check = c.compare(std::string("large sums as ") + name_of(to));
        for (std::size_t i = 0; i < expected.size(); ++i) {
            check.close_to(actual[i], static_cast<double>(expected[i]) / 2 * scale, rounding);
        }
    }
}

/// Every float16 there is, what lies half way between two of them, and next to that on both sides:
/// the nearest one is stored, the even one of two that are as near; from 65,504 on that is 65,504.
template <volume_backend B>
void scan_rounds_to_float16(context<B>& c, bool subnormal) {
    std::vector<float> values;
    for (std::uint32_t bits = subnormal ? 0 : 0x400; bits < (subnormal ? 0x400u : 0x7c00u);
         ++bits) {
        const double low = float16_value(bits);
        const double next = bits == 0x7bff ? 65536 : float16_value(bits + 1);
        const auto middle = static_cast<float>((low + next) / 2);
        const float sign = bits % 2 == 0 ? 1.0f : -1.0f;
        for (const float value : {static_cast<float>(low), middle, std::nextafter(middle, 0.0f),
                                  std::nextafter(middle, 1e9f)}) {
            values.push_back(value * sign);
        }
    }
    for (const float value :
         {65504.0f, 65519.996f, 65520.0f, 1e6f, -1e30f, std::numeric_limits<float>::infinity()}) {
        values.push_back(subnormal ? 1.0f : value);
    }
    const glm::ivec3 size{64, static_cast<int>(values.size() / 64 / 4) + 1, 4};
    values.resize(voxels_of(size), 1.0f);
    const auto in = put_volume(c, size, volume_format::float32, values);
    const auto out = new_volume(c, size, volume_format::float16);
    c.run([&](auto& r) {
        r.scan(in, out, {scan_axis::none, scan_direction::ascending, scan_share::whole, 1});
    });
    const auto actual = get_volume<std::uint16_t>(c, out);
    comparison check = c.compare("values of float16");
    for (std::size_t i = 0; i < values.size(); ++i) {
        check.same(float16_value(actual[i]), float16_value(nearest_float16(double{values[i]})));
    }
}

/// Sums of whole numbers beyond what 16 bits hold, up and down again: the largest of their sign.
template <volume_backend B>
void scan_ends_of_float16(context<B>& c) {
    const glm::ivec3 size{75, 6, 3};
    std::vector<std::int64_t> own(voxels_of(size));
    for (std::size_t i = 0; i < own.size(); ++i) {
        const auto row = static_cast<int>(i) / size.x % size.y;
        own[i] = (i % 2 == 0 ? 1 : -1) * (row < size.y / 2 ? -40000 : 40000);
    }
    const auto in = put_volume(c, size, volume_format::int32,
                               std::vector<std::int32_t>(own.begin(), own.end()));
    const auto out = new_volume(c, size, volume_format::float16);
    for (const scan_share share : {scan_share::whole, scan_share::half, scan_share::none}) {
        const volume_scan how{scan_axis::y, scan_direction::descending, share, 1};
        c.run([&](auto& r) { r.scan(in, out, how); });
        const auto expected = twice_the_sums(own, size, how);
        const auto actual = get_numbers(c, out);
        comparison check = c.compare("sums beyond float16");
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const double sum = static_cast<double>(expected[i]) / 2;
            check.same(actual[i], float16_value(nearest_float16(sum)));
        }
    }
}

/// The sums of a scan are scanned again, turn by turn with another recorder.
template <volume_backend B>
void scan_of_a_scan(context<B>& c) {
    const glm::ivec3 size{7, 30, 12};
    using enum volume_format;
    const volume_scan down{scan_axis::y, scan_direction::descending, scan_share::whole, 1};
    const volume_scan along{scan_axis::x, scan_direction::ascending, scan_share::half, 0.5f};
    const auto a = put_whole_numbers(c, size, int32, 500);
    const auto b = put_whole_numbers(c, size, int32, 500);
    const auto a1 = new_volume(c, size, int32);
    const auto a2 = new_volume(c, size, float32);
    const auto b1 = new_volume(c, size, float32);
    const auto b2 = new_volume(c, size, float32);
    auto first = c.begin();
    auto second = c.begin();
    second.scan(b.volume, b1, along);
    first.scan(a.volume, a1, down);
    second.scan(b1, b2, down);
    first.scan(a1, a2, along);
    c.submit(second);
    c.submit(first);
    const auto expect = [&](const typename B::volume& volume, const std::vector<std::int64_t>& own,
                            const volume_scan& then, const volume_scan& last) {
        const auto expected = twice_the_sums(twice_the_sums(own, size, then), size, last);
        const auto actual = get_numbers(c, volume);
        comparison check = c.compare("sums of sums");
        for (std::size_t i = 0; i < expected.size(); ++i) {
            check.same(actual[i], static_cast<double>(expected[i]) * 0.125);
        }
    };
    expect(a2, a.sums, down, along);
    expect(b2, b.sums, along, down);
}

/// More than 128 MiB: a few boxes are added and summed. The oracle knows the columns.
template <volume_backend B>
void scan_large_volume(context<B>& c) {
    if constexpr (accumulates<B, kernels::probe_slabs>) {
        const glm::ivec3 size = large_size;
        const auto sums = new_volume(c, size, volume_format::int32);
        const auto out = new_volume(c, size, volume_format::float32);
        std::vector<kernels::probe_box> boxes;
        for (int i = 0; i < 12; ++i) { // slabs of one layer each, of everything or of a corner
            const int low = i % 3 * 90;
            boxes.push_back({{low, low, 23 * i, 1 + i}, {size.x, size.y, 23 * i + 1, 0}});
        }
        const auto p = put_boxes(c, boxes, {1, 0, 0, 1});
        c.run([&](auto& r) {
            r.accumulate(p.kernel, p.buffers(), p.all(), into<B>(sums, true, {}));
            r.scan(sums, out, {scan_axis::y, scan_direction::descending, scan_share::whole, 1});
        });
        const auto actual = get_volume<float>(c, out);
        comparison check = c.compare("sums");
        each_voxel(size, [&](glm::ivec3 at) {
            const int i = at.z / 23;
            const bool inside = at.z == 23 * i && i < 12 && at.x >= i % 3 * 90;
            const int rows = std::min(size.y - at.y, size.y - i % 3 * 90);
            check.same(actual[voxel_index(at, size)], inside ? rows * (1 + i) : 0);
        });
    }
}

/// An accumulation and its scan in one call, where a backend has that.
template <volume_backend B>
void scan_fused(context<B>& c, scan_axis axis, scan_share share, volume_format format) {
    if constexpr (fuses_accumulate_scan<B, kernels::probe_slabs>) {
        const glm::ivec3 size{33, 40, 21};
        const auto scratch = put_numbers(c, size);
        const auto out = new_volume(c, size, format);
        const auto p = put_boxes(c, random_boxes(c, size, 400));
        const volume_scan how{axis, scan_direction::descending, share, 0x1p-8f};
        const range part{30, 300};
        c.run([&](auto& r) {
            r.accumulate_scan(p.kernel, p.buffers(), part, scratch.volume, out, how);
        });
        std::vector<std::int64_t> own(voxels_of(size));
        add_expected(own, size, p.kernel, std::span(p.boxes).subspan(30, 300));
        const auto expected = twice_the_sums(own, size, how);
        const auto actual = get_numbers(c, out);
        comparison check = c.compare("sums of an accumulation and scan");
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const double sum = static_cast<double>(expected[i]) * 0x1p-9;
            check.same(actual[i], format == volume_format::float16
                                      ? float16_value(nearest_float16(sum))
                                      : sum);
        }
    }
}

template <backend B>
void add_fused_cases(cases<B>& to) {
    if constexpr (fuses_accumulate_scan<B, kernels::probe_slabs>) {
        const auto add = [&](std::string name, scan_axis axis, scan_share share,
                             volume_format format) {
            to.push_back({"accumulate", "then_scan_" + std::move(name),
                          [=](context<B>& c) { scan_fused(c, axis, share, format); }});
        };
        add("x", scan_axis::x, scan_share::none, volume_format::float32);
        add("y", scan_axis::y, scan_share::half, volume_format::float32);
        add("z", scan_axis::z, scan_share::whole, volume_format::float32);
        add("none", scan_axis::none, scan_share::whole, volume_format::float32);
        add("float16", scan_axis::y, scan_share::whole, volume_format::float16);
    }
}

template <backend B>
void add_volume_scan_cases(cases<B>& to) {
    if constexpr (volume_backend<B>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"scan", "volume_" + std::move(name), std::move(body)});
        };
        const std::pair<const char*, scan_axis> axes[] = {{"none", scan_axis::none},
                                                          {"x", scan_axis::x},
                                                          {"y", scan_axis::y},
                                                          {"z", scan_axis::z}};
        for (const auto& named : axes) {
            const std::string name = named.first;
            const scan_axis axis = named.second;
            for (const auto direction : {scan_direction::ascending, scan_direction::descending}) {
                const std::string along =
                    name + (direction == scan_direction::ascending ? "_ascending" : "_descending");
                add(along, [=](context<B>& c) { scan_formats(c, axis, direction); });
                add(along + "_float_order",
                    [=](context<B>& c) { scan_float_order(c, axis, direction); });
            }
            add(name + "_sizes", [=](context<B>& c) { scan_sizes(c, axis); });
        }
        add("large_sums_int32", [](context<B>& c) { scan_large_sums(c, volume_format::int32); });
        add("large_sums_float32",
            [](context<B>& c) { scan_large_sums(c, volume_format::float32); });
        add("rounds_to_float16", [](context<B>& c) { scan_rounds_to_float16(c, false); });
        add("rounds_to_subnormal_float16", [](context<B>& c) { scan_rounds_to_float16(c, true); });
        add("ends_of_float16", scan_ends_of_float16<B>);
        add("of_a_scan", scan_of_a_scan<B>);
        if constexpr (accumulates<B, kernels::probe_slabs>) {
            add("huge", scan_large_volume<B>);
        }
        add_fused_cases(to);
    }
}

} // namespace skybark::conformance
