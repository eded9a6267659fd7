#pragma once
// Cases: volumes, there and back. And what the cases about volumes share.

#include <skybark/conformance/buffers.hpp>

#include <algorithm>

namespace skybark::conformance {

template <volume_backend B>
[[nodiscard]] typename B::volume new_volume(const context<B>& c, glm::ivec3 size,
                                            volume_format format) {
    const glm::uvec3 sides(size);
    return c.need(c.device.create_volume({sides.x, sides.y, sides.z, format}), "create_volume");
}

[[nodiscard]] inline std::size_t voxels_of(glm::ivec3 size) {
    const glm::uvec3 sides(size);
    return std::size_t{sides.x} * sides.y * sides.z;
}

/// Where a voxel lies in memory.
[[nodiscard]] inline std::size_t voxel_index(glm::ivec3 at, glm::ivec3 size) {
    const glm::uvec3 voxel(at);
    const glm::uvec3 sides(size);
    return (std::size_t{voxel.z} * sides.y + voxel.y) * sides.x + voxel.x;
}

/// Calls `visit(ivec3)` for each voxel, in the order in which they lie in memory.
template <class Visit>
void each_voxel(glm::ivec3 size, Visit&& visit) {
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                visit(glm::ivec3{x, y, z});
            }
        }
    }
}

template <volume_backend B, class T>
[[nodiscard]] typename B::volume put_volume(const context<B>& c, glm::ivec3 size,
                                            volume_format format, const std::vector<T>& voxels) {
    auto volume = new_volume(c, size, format);
    c.need(c.device.upload(volume, std::as_bytes(std::span(voxels))), "upload of a volume");
    return volume;
}

template <class T, volume_backend B>
[[nodiscard]] std::vector<T> get_volume(const context<B>& c, const typename B::volume& volume) {
    const volume_description what = volume.description();
    std::vector<T> voxels(std::size_t{what.width} * what.height * what.depth);
    c.need(c.device.download(volume, std::as_writable_bytes(std::span(voxels))),
           "download of a volume");
    return voxels;
}

/// The number that a float16 stands for: sign, 5 bits of exponent, 10 of mantissa (IEEE 754).
[[nodiscard]] inline double float16_value(std::uint32_t bits) {
    const auto exponent = static_cast<int>(bits >> 10 & 31);
    const double mantissa = bits & 0x3ff;
    double size = std::ldexp(mantissa + (exponent == 0 ? 0 : 1024), std::max(exponent, 1) - 25);
    if (exponent == 31) {
        size = mantissa == 0 ? std::numeric_limits<double>::infinity()
                             : std::numeric_limits<double>::quiet_NaN();
    }
    return (bits & 0x8000) != 0 ? -size : size;
}

/// The finite float16 next to a number, the even one of two that are as near. Found among them all:
/// their values grow with their bits.
[[nodiscard]] inline std::uint16_t nearest_float16(double value) {
    const std::uint32_t sign = std::signbit(value) ? 0x8000 : 0;
    const double size = std::fabs(value);
    if (size >= 65504) { // the largest
        return static_cast<std::uint16_t>(sign | 0x7bff);
    }
    std::uint32_t low = 0;
    std::uint32_t high = 0x7bff;
    while (low < high) {
        const std::uint32_t middle = (low + high + 1) / 2;
        if (float16_value(middle) <= size) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    const double below = size - float16_value(low);
    const double above = float16_value(low + 1) - size;
    const bool up = above < below || (above == below && low % 2 == 1);
    return static_cast<std::uint16_t>(sign | (low + (up ? 1 : 0)));
}

/// Sides that no group of threads is made for.
inline constexpr glm::ivec3 odd_sizes[] = {{1, 1, 1},  {3, 5, 7},  {64, 1, 3},
                                           {1, 67, 2}, {2, 1, 65}, {33, 17, 9}};

/// Whatever bits there can be in a volume, but no NaN.
template <class Word, backend B>
[[nodiscard]] std::vector<Word> random_voxels(context<B>& c, std::size_t count,
                                              volume_format format) {
    std::vector<Word> voxels(count);
    for (Word& voxel : voxels) {
        voxel = static_cast<Word>(c.random());
        const auto infinite = static_cast<Word>(format == volume_format::float16   ? 0x7c00
                                                : format == volume_format::float32 ? 0x7f800000
                                                                                   : 0);
        if (infinite != 0 && (voxel & infinite) == infinite) {
            voxel = infinite;
        }
    }
    return voxels;
}

template <class Word, volume_backend B>
void volume_round_trip(context<B>& c, glm::ivec3 size, volume_format format) {
    const auto voxels = random_voxels<Word>(c, voxels_of(size), format);
    const auto volume = put_volume(c, size, format, voxels);
    const volume_description what = volume.description();
    comparison sides = c.compare("sides and format of a volume");
    sides.same(what.width, size.x);
    sides.same(what.height, size.y);
    sides.same(what.depth, size.z);
    sides.same(static_cast<int>(what.format), static_cast<int>(format));
    const auto back = get_volume<Word>(c, volume);
    comparison check = c.compare("bits of voxels");
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        check.same(back[i], voxels[i]);
    }
}

template <volume_backend B>
void volume_round_trips(context<B>& c, volume_format format) {
    for (const glm::ivec3 size : odd_sizes) {
        if (format == volume_format::float16) {
            volume_round_trip<std::uint16_t>(c, size, format);
        } else {
            volume_round_trip<std::uint32_t>(c, size, format);
        }
    }
}

/// What is uploaded last is there; two volumes do not share their memory.
template <volume_backend B>
void volume_uploads(context<B>& c) {
    const glm::ivec3 size{9, 7, 5};
    const auto first = random_voxels<std::uint32_t>(c, voxels_of(size), volume_format::int32);
    const auto second = random_voxels<std::uint32_t>(c, voxels_of(size), volume_format::int32);
    const auto a = put_volume(c, size, volume_format::int32, first);
    const auto b = put_volume(c, size, volume_format::int32, first);
    c.need(c.device.upload(a, std::as_bytes(std::span(second))), "upload of a volume");
    const auto a_now = get_volume<std::uint32_t>(c, a);
    const auto b_now = get_volume<std::uint32_t>(c, b);
    comparison check = c.compare("bits of voxels");
    for (std::size_t i = 0; i < first.size(); ++i) {
        check.same(a_now[i], second[i]);
        check.same(b_now[i], first[i]);
    }
}

template <volume_backend B>
void volume_traffic(context<B>& c) {
    const glm::ivec3 size{6, 5, 3};
    const std::vector<std::uint16_t> voxels(voxels_of(size));
    const auto before = c.device.traffic();
    const auto volume = put_volume(c, size, volume_format::float16, voxels);
    const auto between = c.device.traffic();
    (void)get_volume<std::uint16_t>(c, volume);
    const auto after = c.device.traffic();
    comparison traffic = c.compare("bytes of traffic (up, down)");
    traffic.same(static_cast<double>(between.up - before.up), 180);
    traffic.same(static_cast<double>(after.down - between.down), 180);
}

template <volume_backend B>
void volume_limits(context<B>& c) {
    const device_limits limits = c.device.limits();
    comparison sane = c.compare("limits (side of a volume, the direct route)");
    sane.within(limits.max_volume_size, 256, 1e30);
    sane.same(limits.accumulate_routes & route_bit(accumulate_route::direct), 1);
}

/// More than the 128 MiB that a kernel may see of a buffer on some devices.
inline constexpr glm::ivec3 large_size{256, 550, 256};

template <volume_backend B>
void volume_large(context<B>& c) {
    std::vector<std::uint32_t> voxels(voxels_of(large_size));
    std::uint32_t number = 1;
    for (std::uint32_t& voxel : voxels) {
        voxel = number;
        number = number * 1664525u + 1013904223u;
    }
    const auto volume = put_volume(c, large_size, volume_format::int32, voxels);
    const auto back = get_volume<std::uint32_t>(c, volume);
    comparison check = c.compare("bits of voxels");
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        check.same(back[i], voxels[i]);
    }
}

template <backend B>
void add_volume_cases(cases<B>& to) {
    if constexpr (volume_backend<B>) {
        const auto add = [&](std::string name, std::function<void(context<B>&)> body) {
            to.push_back({"volumes", std::move(name), std::move(body)});
        };
        add("int32", [](context<B>& c) { volume_round_trips(c, volume_format::int32); });
        add("float32", [](context<B>& c) { volume_round_trips(c, volume_format::float32); });
        add("float16", [](context<B>& c) { volume_round_trips(c, volume_format::float16); });
        add("uploads", volume_uploads<B>);
        add("traffic", volume_traffic<B>);
        add("limits", volume_limits<B>);
        add("huge", volume_large<B>);
    }
}

} // namespace skybark::conformance
