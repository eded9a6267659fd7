#pragma once
// hermite_branch, four segments at a time.
//
// The curve and the frames of four segments are computed in the lanes of one vector; then each
// ring's vertices are written, a vertex being three vectors. The operations and their order are
// those of shaders/shared/branch.glsl, so the bits are the same as the plain kernel's (a test
// compares them). GCC's and clang's vector types; other compilers run the plain kernel.

#include <skybark/cpu/program.hpp>
#include <skybark/kernels/hermite_branch.hpp>

#if defined(__GNUC__)

#    if defined(__x86_64__)
#        include <immintrin.h>
#    endif

namespace skybark::cpu {
namespace lanes {

using f4 = float __attribute__((vector_size(16)));
using i4 = std::int32_t __attribute__((vector_size(16)));

[[nodiscard]] inline f4 splat(float x) { return f4{x, x, x, x}; }

[[nodiscard]] inline f4 load(const void* from) {
    f4 v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

inline void stream(float* to, f4 v) {
#    if defined(__SSE2__)
    _mm_stream_ps(to, reinterpret_cast<__m128>(v));
#    else
    std::memcpy(to, &v, sizeof v);
#    endif
}

[[nodiscard]] inline f4 square_root(f4 v) {
#    if defined(__SSE2__)
    return reinterpret_cast<f4>(_mm_sqrt_ps(reinterpret_cast<__m128>(v)));
#    else
    return f4{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
#    endif
}

/// `yes` where the mask's lanes are all ones, `no` where they are zero.
[[nodiscard]] inline f4 choose(i4 mask, f4 yes, f4 no) {
    return reinterpret_cast<f4>((mask & reinterpret_cast<i4>(yes)) |
                                (~mask & reinterpret_cast<i4>(no)));
}

/// Rows become columns.
inline void transpose(f4& a, f4& b, f4& c, f4& d) {
    const f4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const f4 ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const f4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const f4 cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
    c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
    d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// Three coordinates of four things.
struct v3 {
    f4 x, y, z;
};
[[nodiscard]] inline v3 operator+(v3 a, v3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline v3 operator-(v3 a, v3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] inline v3 operator*(v3 a, f4 s) { return {a.x * s, a.y * s, a.z * s}; }

/// The same `branch_end` of four segments.
struct ends4 {
    v3 position;
    f4 radius;
    f4 qx, qy, qz, qw;
    f4 path, slope;

    [[nodiscard]] static ends4 gather(const branch_end* const (&from)[4]) {
        f4 rows[3][4];
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t lane = 0; lane < 4; ++lane) {
                rows[row][lane] = load(reinterpret_cast<const std::byte*>(from[lane]) + 16 * row);
            }
            transpose(rows[row][0], rows[row][1], rows[row][2], rows[row][3]);
        }
        return {{rows[0][0], rows[0][1], rows[0][2]},
                rows[0][3],
                rows[1][0],
                rows[1][1],
                rows[1][2],
                rows[1][3],
                rows[2][0],
                rows[2][1]};
    }
};

[[nodiscard]] inline f4 arctan_unit(f4 x) {
    const f4 s = x * x;
    return x * (1.0f + s * (-0.3333314528f +
                            s * (0.1999355085f +
                                 s * (-0.1420889944f +
                                      s * (0.1065626393f +
                                           s * (-0.0752896400f +
                                                s * (0.0429096138f + s * (-0.0161657367f +
                                                                          s * 0.0028662257f))))))));
}

[[nodiscard]] inline f4 sin_quarter(f4 x) {
    const f4 s = x * x;
    return x * (1.0f + s * (-0.1666666664f +
                            s * (0.0083333315f +
                                 s * (-0.0001984090f + s * (0.0000027526f + s * -0.0000000239f)))));
}

[[nodiscard]] inline v3 growth(f4 x, f4 y, f4 z, f4 w) {
    return {2.0f * (x * y - w * z), 1.0f - 2.0f * (x * x + z * z), 2.0f * (y * z + w * x)};
}

/// What all rings of four segments share: shared::branch_curve in lanes.
struct curve4 {
    ends4 a, b;
    v3 n1, n2;
    f4 bx, by, bz, bw; ///< b's quaternion on a's side
    f4 angle, inverse_sin;

    [[nodiscard]] static curve4 between(const ends4& a, const ends4& b) {
        curve4 c;
        c.a = a;
        c.b = b;
        const v3 chord = b.position - a.position;
        const f4 length = square_root(chord.x * chord.x + chord.y * chord.y + chord.z * chord.z);
        c.n1 = growth(a.qx, a.qy, a.qz, a.qw) * length;
        c.n2 = growth(b.qx, b.qy, b.qz, b.qw) * length;
        const f4 cosine = a.qx * b.qx + a.qy * b.qy + a.qz * b.qz + a.qw * b.qw;
        const f4 side = choose(cosine < splat(0), splat(-1), splat(1));
        c.bx = b.qx * side;
        c.by = b.qy * side;
        c.bz = b.qz * side;
        c.bw = b.qw * side;
        const f4 dx = a.qx - c.bx, dy = a.qy - c.by, dz = a.qz - c.bz, dw = a.qw - c.bw;
        const f4 sx = a.qx + c.bx, sy = a.qy + c.by, sz = a.qz + c.bz, sw = a.qw + c.bw;
        const f4 d2 = dx * dx + dy * dy + dz * dz + dw * dw;
        const f4 s2 = sx * sx + sy * sy + sz * sz + sw * sw;
        c.angle = choose(s2 > splat(0), 2.0f * arctan_unit(square_root(d2 / s2)), splat(0));
        c.inverse_sin = choose(c.angle > splat(0.001f), 1.0f / sin_quarter(c.angle), splat(0));
        return c;
    }
};

/// One ring of each of four segments, turned so that a lane's vectors are together.
struct rings4 {
    f4 centre[4]; ///< w: 0
    f4 x[4];      ///< w: 0
    f4 z[4];      ///< w: 0
    f4 lean[4];   ///< y · slope · lean, w: −path
    f4 radius, lean_length;

    [[nodiscard]] static rings4 at(const curve4& c, float t) {
        const float s = 1.0f - t;
        f4 wa = splat(s);
        f4 wb = splat(t);
        if (t > 0.0f && t < 1.0f) {
            const i4 curved = c.inverse_sin > splat(0);
            wa = choose(curved, sin_quarter(s * c.angle) * c.inverse_sin, wa);
            wb = choose(curved, sin_quarter(t * c.angle) * c.inverse_sin, wb);
        }
        f4 qx = c.a.qx * wa + c.bx * wb;
        f4 qy = c.a.qy * wa + c.by * wb;
        f4 qz = c.a.qz * wa + c.bz * wb;
        f4 qw = c.a.qw * wa + c.bw * wb;
        const f4 unit = 1.0f / square_root(qx * qx + qy * qy + qz * qz + qw * qw);
        qx *= unit;
        qy *= unit;
        qz *= unit;
        qw *= unit;

        const v3 centre =
            (c.a.position * splat((1.0f + 2.0f * t) * (s * s)) + c.n1 * splat(t * (s * s))) +
            (c.b.position * splat((t * t) * (1.0f + 2.0f * s)) - c.n2 * splat((t * t) * s));
        const f4 slope = c.a.slope * s + c.b.slope * t;
        const f4 lean = 1.0f / square_root(1.0f + slope * slope);
        const v3 y = growth(qx, qy, qz, qw) * (slope * lean);

        rings4 r;
        r.radius = c.a.radius * s + c.b.radius * t;
        r.lean_length = lean;
        set(r.centre, centre, splat(0));
        set(r.x,
            {1.0f - 2.0f * (qy * qy + qz * qz), 2.0f * (qx * qy + qw * qz),
             2.0f * (qx * qz - qw * qy)},
            splat(0));
        set(r.z,
            {2.0f * (qx * qz + qw * qy), 2.0f * (qy * qz - qw * qx),
             1.0f - 2.0f * (qx * qx + qy * qy)},
            splat(0));
        set(r.lean, y, -(c.a.path * s + c.b.path * t));
        return r;
    }

  private:
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
struct program<kernels::hermite_branch> : plain_program<kernels::hermite_branch> {
    using kernel_type = kernels::hermite_branch;

    static void rings(const kernel_type& kernel, range elements, std::byte* to,
                      kernel_type::segments_span segments, kernel_type::ends_span ends,
                      kernel_type::corners_span corners) {
        if (kernel.frame != kernels::branch_frame::slerp) {
            vertex_sink<surface_vertex> sink{to};
            for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
                kernel.ring(i, 0, kernel.ring_vertices(), sink, segments, ends, corners);
            }
            return;
        }
        const std::size_t stride = std::size_t{kernel.ring_vertices()} * sizeof(surface_vertex);
        for (std::uint32_t done = 0; done < elements.count; done += 4) {
            const std::uint32_t lanes = std::min(4u, elements.count - done);
            four(kernel, elements.first + done, lanes, to + done * stride, segments, ends, corners);
        }
    }

  private:
    /// Segments [first, first + count), count ≤ 4; spare lanes repeat the last segment.
    static void four(const kernel_type& kernel, std::uint32_t first, std::uint32_t count,
                     std::byte* to, kernel_type::segments_span segments,
                     kernel_type::ends_span ends, kernel_type::corners_span corners) {
        using namespace lanes;
        const branch_end* start[4];
        const branch_end* end[4];
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            const branch_segment& segment = segments[first + std::min(lane, count - 1)];
            start[lane] = &ends[segment.start];
            end[lane] = &ends[segment.end];
        }
        const curve4 curve = curve4::between(ends4::gather(start), ends4::gather(end));
        const std::size_t ring_floats = std::size_t{kernel.sides + 1} * 12;
        // A segment's rings one after another: lines that are streamed in pieces, with others in
        // between, are written twice.
        constexpr std::uint32_t most_rings = 16;
        rings4 rings[most_rings];
#    if defined(__x86_64__)
        const auto write = __builtin_cpu_supports("avx2") ? write_ring_avx2 : write_ring;
#    else
        const auto write = write_ring;
#    endif
        for (std::uint32_t done = 0; done < kernel.rings; done += most_rings) {
            const std::uint32_t some = std::min(most_rings, kernel.rings - done);
            for (std::uint32_t k = 0; k < some; ++k) {
                rings[k] = rings4::at(curve, static_cast<float>(done + k) /
                                                 static_cast<float>(kernel.rings - 1));
            }
            for (std::uint32_t lane = 0; lane < count; ++lane) {
                float* out = reinterpret_cast<float*>(to) +
                             (std::size_t{lane} * kernel.rings + done) * ring_floats;
                for (std::uint32_t k = 0; k < some; ++k) {
                    write(rings[k], lane, out + k * ring_floats, corners.first(kernel.sides + 1));
                }
            }
        }
    }

    /// shared::branch_vertex for every corner. The fourth lanes carry u, v and the handedness.
    static void write_ring(const lanes::rings4& ring, std::uint32_t lane, float* out,
                           kernel_type::corners_span corners) {
        using namespace lanes;
        const f4 centre = ring.centre[lane];
        const f4 x = ring.x[lane];
        const f4 z = ring.z[lane];
        const f4 lean = ring.lean[lane];
        // No fourth lane: a radius that is not a number must not reach u.
        const float r = ring.radius[lane];
        const float l = ring.lean_length[lane];
        const f4 radius{r, r, r, 0};
        const f4 length{l, l, l, 0};
        for (const glm::vec4& corner : corners) {
            const f4 cosine = splat(corner.x);
            const f4 sine = splat(corner.y);
            const f4 outward = x * cosine - z * sine;
            const f4 along = x * sine + z * cosine;
            // -0 changes nothing that it is added to, not even a zero's sign.
            stream(out, centre + outward * radius + f4{-0.0f, -0.0f, -0.0f, corner.z});
            stream(out + 4, outward * length - lean);
            stream(out + 8, f4{-0.0f, -0.0f, -0.0f, 1} - along);
            out += 12;
        }
    }

#    if defined(__x86_64__)
    [[gnu::target("avx2")]] static __m256 both(const lanes::f4& v) {
        return _mm256_broadcast_ps(reinterpret_cast<const __m128*>(&v));
    }

    /// The same, two corners at a time.
    [[gnu::target("avx2")]] static void write_ring_avx2(const lanes::rings4& ring,
                                                        std::uint32_t lane, float* out,
                                                        kernel_type::corners_span corners) {
        const __m256 centre = both(ring.centre[lane]);
        const __m256 x = both(ring.x[lane]);
        const __m256 z = both(ring.z[lane]);
        const __m256 lean = both(ring.lean[lane]);
        const float r = ring.radius[lane];
        const float l = ring.lean_length[lane];
        const __m256 radius = both(lanes::f4{r, r, r, 0});
        const __m256 length = both(lanes::f4{l, l, l, 0});
        const __m256 u_lane = both(lanes::f4{-0.0f, -0.0f, -0.0f, 0});
        const __m256 handed = both(lanes::f4{-0.0f, -0.0f, -0.0f, 1});
        const std::size_t pairs = corners.size() / 2;
        for (std::size_t i = 0; i < pairs; ++i) {
            const __m256 corner = _mm256_loadu_ps(&corners[2 * i].x);
            const __m256 cosine = _mm256_permute_ps(corner, 0x00);
            const __m256 sine = _mm256_permute_ps(corner, 0x55);
            const __m256 u = _mm256_blend_ps(u_lane, _mm256_permute_ps(corner, 0xaa), 0x88);
            const __m256 outward = _mm256_sub_ps(_mm256_mul_ps(x, cosine), _mm256_mul_ps(z, sine));
            const __m256 along = _mm256_add_ps(_mm256_mul_ps(x, sine), _mm256_mul_ps(z, cosine));
            const __m256 position =
                _mm256_add_ps(_mm256_add_ps(centre, _mm256_mul_ps(outward, radius)), u);
            const __m256 normal = _mm256_sub_ps(_mm256_mul_ps(outward, length), lean);
            const __m256 tangent = _mm256_sub_ps(handed, along);
            _mm_stream_ps(out, _mm256_castps256_ps128(position));
            _mm_stream_ps(out + 4, _mm256_castps256_ps128(normal));
            _mm_stream_ps(out + 8, _mm256_castps256_ps128(tangent));
            _mm_stream_ps(out + 12, _mm256_extractf128_ps(position, 1));
            _mm_stream_ps(out + 16, _mm256_extractf128_ps(normal, 1));
            _mm_stream_ps(out + 20, _mm256_extractf128_ps(tangent, 1));
            out += 24;
        }
        if (corners.size() % 2 != 0) {
            write_ring(ring, lane, out, corners.last(1));
        }
    }
#    endif
};

} // namespace skybark::cpu

#endif
