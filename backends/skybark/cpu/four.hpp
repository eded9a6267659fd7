#pragma once
// Four numbers in the lanes of one vector, with the names that the formulas in shaders/shared have
// for one, so that their text computes four elements at a time (programs/sway.hpp). Each operation
// is the one of shared/glsl.hpp and shared/pose.hpp, lane by lane, so the bits are the same.

#include <skybark/cpu/hermite_branch.hpp>

#if defined(__GNUC__)

namespace skybark::cpu::four {

struct number {
    lanes::f4 v;

    number() = default;
    number(float x) : v(lanes::splat(x)) {}
    number(lanes::f4 x) : v(x) {}

    friend number operator+(number a, number b) { return a.v + b.v; }
    friend number operator-(number a, number b) { return a.v - b.v; }
    friend number operator*(number a, number b) { return a.v * b.v; }
    friend number operator/(number a, number b) { return a.v / b.v; }
    friend number operator-(number a) { return -a.v; }
    friend number sqrt(number a) { return lanes::square_root(a.v); }
    friend number min(number a, number b) { return lanes::choose(b.v < a.v, b.v, a.v); }
    friend number max(number a, number b) { return lanes::choose(a.v < b.v, b.v, a.v); }
    friend number floor(number a) {
        // From 2^23 on every float is whole.
        const lanes::i4 broken =
            (a.v < lanes::splat(8388608.0f)) & (a.v > lanes::splat(-8388608.0f));
        const lanes::f4 whole = lanes::choose(broken, a.v, lanes::splat(0));
        const lanes::f4 cut =
            __builtin_convertvector(__builtin_convertvector(whole, lanes::i4), lanes::f4);
        const lanes::f4 down = cut - lanes::choose(whole < cut, lanes::splat(1), lanes::splat(0));
        return lanes::choose(broken, down, a.v);
    }
};

struct vec3 {
    number x, y, z;
    vec3() = default;
    vec3(number a, number b, number c) : x(a), y(b), z(c) {}
    friend vec3 operator+(vec3 a, vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend vec3 operator-(vec3 a, vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend vec3 operator*(vec3 a, number s) { return {a.x * s, a.y * s, a.z * s}; }
};

struct vec4 {
    number x, y, z, w;
    vec4() = default;
    vec4(number a, number b, number c, number d) : x(a), y(b), z(c), w(d) {}
    vec4(vec3 a, number d) : x(a.x), y(a.y), z(a.z), w(d) {}
    friend vec4 operator+(vec4 a, vec4 b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
    friend vec4 operator*(vec4 a, number s) { return {a.x * s, a.y * s, a.z * s, a.w * s}; }
};

// The records of core that the formulas take.
struct segment_pose {
    vec4 rotation;
    vec3 base;
    number reserved0;
    vec3 shift;
    number reserved1;
};
struct segment_load {
    vec3 force;
    number drag;
};

inline vec4 quaternion_times(vec4 a, vec4 b) {
    return vec4(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
                a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
}
inline vec3 quaternion_move(vec4 q, vec3 v) {
    const vec3 t(2.0f * (q.y * v.z - q.z * v.y), 2.0f * (q.z * v.x - q.x * v.z),
                 2.0f * (q.x * v.y - q.y * v.x));
    return vec3(q.w * t.x + (q.y * t.z - q.z * t.y), q.w * t.y + (q.z * t.x - q.x * t.z),
                q.w * t.z + (q.x * t.y - q.y * t.x));
}
inline vec3 quaternion_rotate(vec4 q, vec3 v) { return v + quaternion_move(q, v); }

namespace detail {
template <std::size_t Row, class Four, class Record>
void gather_row(Four& all, const Record* const (&from)[4]) {
    lanes::f4 r[4] = {lanes::load(reinterpret_cast<const std::byte*>(from[0]) + 16 * Row),
                      lanes::load(reinterpret_cast<const std::byte*>(from[1]) + 16 * Row),
                      lanes::load(reinterpret_cast<const std::byte*>(from[2]) + 16 * Row),
                      lanes::load(reinterpret_cast<const std::byte*>(from[3]) + 16 * Row)};
    lanes::transpose(r[0], r[1], r[2], r[3]);
    std::memcpy(reinterpret_cast<std::byte*>(&all) + 64 * Row, r, sizeof r);
}
template <std::size_t Row, class Four, class Record>
void scatter_row(const Four& all, Record* to, std::uint32_t count) {
    lanes::f4 r[4];
    std::memcpy(r, reinterpret_cast<const std::byte*>(&all) + 64 * Row, sizeof r);
    lanes::transpose(r[0], r[1], r[2], r[3]);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
        std::memcpy(reinterpret_cast<std::byte*>(to + lane) + 16 * Row, &r[lane], 16);
    }
}
} // namespace detail

/// Four records, a lane each. Four has the record's members, each number for a float. Rows are
/// unrolled by hand, which compilers do at -O3 alone.
template <class Four, class Record>
[[nodiscard]] Four gather(const Record* const (&from)[4]) {
    static_assert(sizeof(Four) == 4 * sizeof(Record) && sizeof(Record) % 16 == 0);
    Four all;
    [&]<std::size_t... Row>(std::index_sequence<Row...>) {
        (detail::gather_row<Row>(all, from), ...);
    }
    (std::make_index_sequence<sizeof(Record) / 16>{});
    return all;
}

/// The first `count` lanes back into consecutive records.
template <class Record, class Four>
void scatter(const Four& all, Record* to, std::uint32_t count) {
    static_assert(sizeof(Four) == 4 * sizeof(Record) && sizeof(Record) % 16 == 0);
    [&]<std::size_t... Row>(std::index_sequence<Row...>) {
        (detail::scatter_row<Row>(all, to, count), ...);
    }
    (std::make_index_sequence<sizeof(Record) / 16>{});
}

} // namespace skybark::cpu::four

#endif
