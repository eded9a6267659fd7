#pragma once
// leaf_blade, four leaves at a time.
//
// Where four leaves are and how they are turned is computed in the lanes of one vector; then each
// leaf's ten vertices are written, a vertex being three vectors. The operations and their order are
// those of shaders/shared/leaf.glsl, so the bits are the same as the plain kernel's (a test
// compares them). GCC's and clang's vector types; other compilers run the plain kernel.

#include <skybark/cpu/hermite_branch.hpp>
#include <skybark/kernels/leaf_blade.hpp>

#if defined(__GNUC__)

namespace skybark::cpu {
namespace lanes {

using u4 = std::uint32_t __attribute__((vector_size(16)));

[[nodiscard]] inline u4 as_bits(f4 v) { return reinterpret_cast<u4>(v); }

/// Below 2^31, so that the signed conversion will do.
[[nodiscard]] inline f4 to_floats(u4 v) {
    return __builtin_convertvector(reinterpret_cast<i4>(v), f4);
}

[[nodiscard]] inline f4 at_least(f4 v, f4 low) { return choose(v < low, low, v); }
[[nodiscard]] inline f4 at_most(f4 v, f4 high) { return choose(high < v, high, v); }

[[nodiscard]] inline v3 cross(v3 a, v3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Quaternions in lanes.
struct q4 {
    f4 x, y, z, w;
};

[[nodiscard]] inline q4 times(const q4& a, const q4& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

/// shared::quaternion_move.
[[nodiscard]] inline v3 move(const q4& q, v3 v) {
    const v3 t{2.0f * (q.y * v.z - q.z * v.y), 2.0f * (q.z * v.x - q.x * v.z),
               2.0f * (q.x * v.y - q.y * v.x)};
    return {q.w * t.x + (q.y * t.z - q.z * t.y), q.w * t.y + (q.z * t.x - q.x * t.z),
            q.w * t.z + (q.x * t.y - q.y * t.x)};
}

[[nodiscard]] inline u4 leaf_bits(u4 seed, std::uint32_t salt) {
    u4 h = seed + (salt + 1u) * 0x9e3779b9u;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

[[nodiscard]] inline f4 oscillation(u4 seed, std::uint32_t salt, std::uint32_t time) {
    const u4 bits = leaf_bits(seed, salt);
    const u4 phase = time * (128u + (bits & 127u)) + bits;
    const u4 within = phase & 0x7fffffffu;
    // Both are below 2^31 or exactly 2^31 - something: compare as signed numbers.
    const i4 second = reinterpret_cast<i4>(within) > i4{} + 0x40000000;
    const u4 other = 0x80000000u - within;
    const u4 mask = reinterpret_cast<u4>(second);
    const u4 quarter = (mask & other) | (~mask & within);
    const f4 s = sin_quarter(to_floats(quarter >> 7) * 1.8725352e-7f);
    // The sign bit of the phase is the sign of the sine.
    return reinterpret_cast<f4>(as_bits(s) ^ (phase & 0x80000000u));
}

/// Three vectors of four floats in four lanes: as they lie in memory.
struct rows4 {
    f4 row[3][4];

    template <class T>
    [[nodiscard]] static rows4 gather(const T* const (&from)[4]) {
        static_assert(sizeof(T) == 48);
        rows4 r;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t lane = 0; lane < 4; ++lane) {
                r.row[i][lane] = load(reinterpret_cast<const std::byte*>(from[lane]) + 16 * i);
            }
            transpose(r.row[i][0], r.row[i][1], r.row[i][2], r.row[i][3]);
        }
        return r;
    }
};

/// shared::leaf_frame of four leaves; a lane's vectors are together. The fourth components are what
/// makes u out of the sum that makes a position.
struct leaves4 {
    f4 base[4];                         ///< w: ½
    f4 middle[4];                       ///< w: 0
    f4 right[4];                        ///< w: ½
    f4 left[4];                         ///< w: −½
    f4 right_across[4], left_across[4]; ///< w: 1
    f4 right_normal[4], left_normal[4]; ///< w: −0
    f4 axis, diagonal;
    f4 scale, morph;

    [[nodiscard]] static leaves4 of(const kernels::leaf_blade& k, const rows4& leaf,
                                    const rows4& pose, const f4 (&air)[4]) {
        const v3 rest{leaf.row[0][0], leaf.row[0][1], leaf.row[0][2]};
        const f4 width = leaf.row[0][3];
        const f4 length = leaf.row[2][0];
        const u4 seed = as_bits(leaf.row[2][2]);
        const q4 carried{pose.row[0][0], pose.row[0][1], pose.row[0][2], pose.row[0][3]};
        const v3 pivot{pose.row[1][0], pose.row[1][1], pose.row[1][2]};
        const v3 shift{pose.row[2][0], pose.row[2][1], pose.row[2][2]};
        const v3 base = rest + (shift + move(carried, rest - pivot));
        const q4 turned = turn(k, carried, leaf, seed, air);

        f4 scale = splat(1);
        f4 morph = splat(0);
        if (k.camera.w > 0.0f) {
            detail(k, base, width, length, seed, scale, morph);
        }
        leaves4 four =
            frame(base, turned, leaf.row[2][3], 0.5f * width * scale, 0.5f * length * scale, morph);
        four.scale = scale;
        four.morph = morph;
        return four;
    }

  private:
    static q4 turn(const kernels::leaf_blade& k, const q4& carried, const rows4& leaf, u4 seed,
                   const f4 (&air)[4]) {
        const q4 q =
            times(carried, {leaf.row[1][0], leaf.row[1][1], leaf.row[1][2], leaf.row[1][3]});
        const v3 d = growth(q.x, q.y, q.z, q.w);
        const f4 speed2 = air[3] * air[3];
        const f4 lean = k.lean * air[3] / (speed2 + k.lean_speed * k.lean_speed);
        const v3 t = cross(d, {air[0], air[1], air[2]}) * lean;
        const f4 f = 1.0f / square_root(1.0f + (t.x * t.x + t.y * t.y + t.z * t.z));
        const q4 leaning{t.x * f, t.y * f, t.z * f, f};

        const f4 most = k.flutter * (speed2 / (speed2 + k.flutter_speed * k.flutter_speed));
        const f4 y =
            most * (0.7f * oscillation(seed, 1, k.time) + 0.3f * oscillation(seed, 2, k.time));
        const f4 x = most * (0.5f * oscillation(seed, 3, k.time));
        const f4 g = 1.0f / square_root(1.0f + (x * x + y * y));
        return times(times(leaning, q), {x * g, y * g, splat(0), g});
    }

    static void detail(const kernels::leaf_blade& k, v3 base, f4 width, f4 length, u4 seed,
                       f4& scale, f4& morph) {
        const v3 d{base.x - k.camera.x, base.y - k.camera.y, base.z - k.camera.z};
        const f4 distance = at_least(square_root(d.x * d.x + d.y * d.y + d.z * d.z), splat(1e-6f));
        const f4 seen = k.camera.w * square_root(width * length) / distance;
        morph = at_most(at_least(2.0f - seen / k.quad, splat(0)), splat(1));
        const f4 part = seen / k.full;
        const f4 nu = at_least(2.0f * (part * part), splat(0.00048828125f));
        const f4 rest = 1.0f - 0.5f * nu;
        const f4 mean = choose(nu <= 1.0f, 0.75f * nu, 1.0f - rest * rest / nu);
        const f4 rank = to_floats(leaf_bits(seed, 0) >> 8) * (1.0f / 16777216.0f);
        const f4 area = at_most(at_least(2.0f * (nu - rank) / nu, splat(0)), splat(1));
        scale = choose(nu < 2.0f, square_root(area / mean), splat(1));
    }

    static leaves4 frame(v3 base, const q4& q, f4 fold, f4 half_width, f4 half_length, f4 morph) {
        const v3 x{1.0f - 2.0f * (q.y * q.y + q.z * q.z), 2.0f * (q.x * q.y + q.w * q.z),
                   2.0f * (q.x * q.z - q.w * q.y)};
        const v3 y = growth(q.x, q.y, q.z, q.w);
        const v3 z{2.0f * (q.x * q.z + q.w * q.y), 2.0f * (q.y * q.z - q.w * q.x),
                   1.0f - 2.0f * (q.x * q.x + q.y * q.y)};
        const f4 half_fold = 0.5f * at_most(at_least(fold, splat(-1.5707964f)), splat(1.5707964f));
        const f4 sine = sin_quarter(half_fold); // odd, bit for bit
        const f4 up = 2.0f * sine * square_root(1.0f - sine * sine);
        const f4 level = 1.0f - 2.0f * (sine * sine);
        const v3 right_across = x * level + z * up;
        const v3 left_across = x * level - z * up;
        leaves4 l;
        set(l.base, base, splat(0.5f));
        set(l.middle, y * half_length, splat(0));
        set(l.right_across, right_across, splat(1));
        set(l.left_across, left_across, splat(1));
        set(l.right_normal, z * level - x * up, splat(-0.0f));
        set(l.left_normal, z * level + x * up, splat(-0.0f));
        set(l.right, right_across * half_width, splat(0.5f));
        set(l.left, left_across * -half_width, splat(-0.5f));
        l.axis = 1.0f + morph * 0.18920712f;
        l.diagonal = 0.70710678f / l.axis;
        return l;
    }

    static void set(f4 (&to)[4], v3 v, f4 w) {
        to[0] = v.x;
        to[1] = v.y;
        to[2] = v.z;
        to[3] = w;
        transpose(to[0], to[1], to[2], to[3]);
    }
};

} // namespace lanes

template <>
struct program<kernels::leaf_blade> : plain_program<kernels::leaf_blade> {
    using kernel_type = kernels::leaf_blade;

    static void rings(const kernel_type& kernel, range elements, std::byte* to,
                      kernel_type::leaves_span leaves, kernel_type::poses_span poses,
                      kernel_type::air_span air) {
        constexpr std::size_t each = 10 * vertex_floats;
        for (std::uint32_t done = 0; done < elements.count; done += 4) {
            const std::uint32_t count = std::min(4u, elements.count - done);
            const lanes::leaves4 four =
                gather(kernel, elements.first + done, count, leaves, poses, air);
            for (std::uint32_t lane = 0; lane < count; ++lane) {
                float* out = reinterpret_cast<float*>(to) + (done + lane) * each;
                for (const blade_half& half : halves_of(four, lane)) {
                    for (std::size_t corner = 0; corner < 5; ++corner) {
                        out = write(out, half, corner);
                    }
                }
            }
        }
    }

    [[nodiscard]] static std::uint64_t count(const kernel_type& kernel, range elements,
                                             kernel_type::leaves_span leaves,
                                             kernel_type::poses_span poses,
                                             kernel_type::air_span air) {
        if (!(kernel.camera.w > 0.0f)) {
            return std::uint64_t{6} * elements.count;
        }
        std::uint64_t triangles = 0;
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            triangles += 2 * kernel.triangles(i, 0, leaves, poses, air);
        }
        return triangles;
    }

    template <class Sink>
    static void triangles(const kernel_type& kernel, range elements, Sink& sink,
                          kernel_type::leaves_span leaves, kernel_type::poses_span poses,
                          kernel_type::air_span air) {
        for (std::uint32_t done = 0; done < elements.count; done += 4) {
            const range some{elements.first + done, std::min(4u, elements.count - done)};
            if (sink.room() < std::uint64_t{6} * some.count) {
                plain_program<kernel_type>::triangles(kernel, some, sink, leaves, poses, air);
                continue;
            }
            const lanes::leaves4 four = gather(kernel, some.first, some.count, leaves, poses, air);
            for (std::uint32_t lane = 0; lane < some.count; ++lane) {
                if (four.scale[lane] > 0.0f) {
                    sink.skip(write_list(sink.place(), four, lane));
                }
            }
        }
    }

  private:
    static constexpr std::size_t vertex_floats = sizeof(surface_vertex) / sizeof(float);

    /// Leaves [first, first + count), count ≤ 4; spare lanes repeat the last leaf.
    static lanes::leaves4 gather(const kernel_type& kernel, std::uint32_t first,
                                 std::uint32_t count, kernel_type::leaves_span leaves,
                                 kernel_type::poses_span poses, kernel_type::air_span air) {
        using namespace lanes;
        const leaf* leaf_of[4];
        const segment_pose* pose_of[4];
        f4 blowing[4];
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            const leaf& l = leaves[first + std::min(lane, count - 1)];
            leaf_of[lane] = &l;
            pose_of[lane] = &poses[l.carrier * kernel.pose_step];
            blowing[lane] = load(&air[l.carrier * kernel.air_step]);
        }
        transpose(blowing[0], blowing[1], blowing[2], blowing[3]);
        return leaves4::of(kernel, rows4::gather(leaf_of), rows4::gather(pose_of), blowing);
    }

    /// One half's five vertices: positions with u, normals with v, and the tangent.
    struct blade_half {
        lanes::f4 position[5];
        lanes::f4 normal[5];
        lanes::f4 tangent;
    };

    /// shared::leaf_vertex for the corners of both halves.
    static std::array<blade_half, 2> halves_of(const lanes::leaves4& four, std::uint32_t lane) {
        using namespace lanes;
        const float axis = four.axis[lane];
        const float diagonal = four.diagonal[lane];
        const float across[5] = {0, diagonal, axis, diagonal, 0};
        const float along[5] = {-axis, -diagonal, 0, diagonal, axis};
        std::array<blade_half, 2> halves;
        halves[0].tangent = four.right_across[lane];
        halves[1].tangent = four.left_across[lane];
        for (std::size_t i = 0; i < 5; ++i) {
            const f4 up = four.middle[lane] * splat(1.0f + along[i]);
            // -0 changes nothing that it is added to, not even a zero's sign.
            const f4 v{-0.0f, -0.0f, -0.0f, 0.5f + 0.5f * along[i]};
            halves[0].position[i] = four.base[lane] + (four.right[lane] * splat(across[i]) + up);
            halves[1].position[i] = four.base[lane] + (four.left[lane] * splat(across[i]) + up);
            halves[0].normal[i] = four.right_normal[lane] + v;
            halves[1].normal[i] = four.left_normal[lane] + v;
        }
        return halves;
    }

    static float* write(float* out, const blade_half& half, std::size_t corner) {
        lanes::stream(out, half.position[corner]);
        lanes::stream(out + 4, half.normal[corner]);
        lanes::stream(out + 8, half.tangent);
        return out + vertex_floats;
    }

    /// The triangles of a leaf's two strips.
    static std::uint64_t write_list(std::byte* to, const lanes::leaves4& four, std::uint32_t lane) {
        static constexpr std::uint8_t octagon[2][9] = {{0, 1, 4, 4, 1, 2, 4, 2, 3},
                                                       {4, 3, 0, 0, 3, 2, 0, 2, 1}};
        static constexpr std::uint8_t quadrilateral[2][3] = {{0, 2, 4}, {4, 2, 0}};
        const bool whole = four.morph[lane] < 1.0f;
        const auto halves = halves_of(four, lane);
        float* out = reinterpret_cast<float*>(to);
        for (std::size_t half = 0; half < 2; ++half) {
            const std::uint8_t* corners = whole ? octagon[half] : quadrilateral[half];
            for (std::size_t k = 0; k < (whole ? 9u : 3u); ++k) {
                out = write(out, halves[half], corners[k]);
            }
        }
        return whole ? 6 : 2;
    }
};

} // namespace skybark::cpu

#endif
