#pragma once
// bark, all levels in one go, a small batch of triangles at a time.
//
// A level's split edges, each once, fill the lanes of vectors whichever triangles they are of.
// Points stay where they were made, with the map's height there, until the triangles below them are
// written. The operations and their order are those of shaders/shared/bark.glsl, so the bits are
// the same as the plain kernel's (a test compares them). GCC's and clang's vector types; other
// compilers run the plain kernel.

#include <skybark/cpu/hermite_branch.hpp>
#include <skybark/kernels/bark.hpp>

#include <optional>

#if defined(__GNUC__)

namespace skybark::cpu {
namespace lanes {

[[nodiscard]] inline f4 dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline v3 choose(i4 mask, v3 yes, v3 no) {
    return {choose(mask, yes.x, no.x), choose(mask, yes.y, no.y), choose(mask, yes.z, no.z)};
}
[[nodiscard]] inline v3 unit_or_itself(v3 v) {
    const f4 l2 = dot(v, v);
    return choose(l2 > splat(1e-30f), v * (1.0f / square_root(l2)), v);
}

/// floor: from 2^23 on, floats are whole.
[[nodiscard]] inline f4 floor(f4 v) {
    const f4 whole = __builtin_convertvector(__builtin_convertvector(v, i4), f4);
    const f4 low = choose(whole > v, whole - 1.0f, whole);
    return choose((v < splat(8388608.0f)) & (v > splat(-8388608.0f)), low, v);
}

/// Bits 0 … 2: which of the first three lanes are all ones.
[[nodiscard]] inline std::uint32_t first_three(i4 mask) {
#    if defined(__SSE2__)
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(mask))) & 7u;
#    else
    return (mask[0] != 0 ? 1u : 0u) | (mask[1] != 0 ? 2u : 0u) | (mask[2] != 0 ? 4u : 0u);
#    endif
}

} // namespace lanes

/// A vertex as in memory, and the map's height there.
struct bark_point {
    lanes::f4 rows[3];
    float height;
};
struct bark_triangle {
    const bark_point* corners[3];
    std::uint32_t split; ///< shared::bark_pattern; 0 after the last level
};

/// Splits triangles and hands those that stay to `output(triangles)`, in order. An output that only
/// counts has `add(n)`, and gets neither tangents nor the last level's midpoints.
template <class Output>
class bark_splitter {
  public:
    using heights_span = kernels::bark::heights_span;

    bark_splitter(const kernels::bark& kernel, heights_span heights, Output& output)
        : kernel_(kernel), heights_(heights), output_(output), codes_(all_codes()) {}

    void elements(range all, kernels::bark::vertices_span vertices,
                  kernels::bark::indices_span indices) {
        for (std::uint32_t done = 0; done < all.count && output_.wants_more(); done += batch) {
            some_elements({all.first + done, std::min(batch, all.count - done)}, vertices, indices);
        }
    }

  private:
    using point = bark_point;
    using triangle = bark_triangle;

    /// So many triangles of one level are split at a time, between up to thrice as many others.
    static constexpr std::uint32_t batch = 16;
    static constexpr std::uint32_t longest = 4 * batch;
    static constexpr std::uint32_t most_edges = 3 * batch; ///< and corners
    static constexpr bool counts = requires(Output & o) { o.add(1u); };

    /// Where things of a batch are, by a number that says little: what's there must be compared.
    struct places {
        std::uint8_t at[128]{};
        [[nodiscard]] std::uint8_t& of(std::size_t number) { return at[number % 128]; }
    };

    /// Texture coordinates, and the map's heights there. Sizes are multiples of 8.
    struct lookups {
        float u[most_edges];
        float v[most_edges];
        float height[most_edges];

        void add(std::uint32_t i, float at_u, float at_v) {
            u[i] = at_u;
            v[i] = at_v;
        }
    };
    static_assert(most_edges % 8 == 0);

    /// shared::bark_corner, by the other diagonal, pattern, triangle and corner.
    struct corner_codes {
        std::uint8_t of[2][8][12];

        corner_codes() {
            for (std::uint32_t i = 0; i < 2 * 8 * 12; ++i) {
                of[i / 96][i / 12 % 8][i % 12] = static_cast<std::uint8_t>(
                    shared::bark_corner(i / 12 % 8, i >= 96, i % 12 / 3, i % 3));
            }
        }
    };
    [[nodiscard]] static const corner_codes& all_codes() {
        static const corner_codes codes;
        return codes;
    }

    /// A row of four points, in columns.
    struct row_columns {
        lanes::v3 xyz;
        lanes::f4 w;
    };
    [[nodiscard]] static row_columns columns(const point* const (&p)[4], std::uint32_t row) {
        lanes::f4 v[4] = {p[0]->rows[row], p[1]->rows[row], p[2]->rows[row], p[3]->rows[row]};
        lanes::transpose(v[0], v[1], v[2], v[3]);
        return {{v[0], v[1], v[2]}, v[3]};
    }

    /// At most a batch. A vertex of several triangles is mostly found to be there already.
    void some_elements(range all, kernels::bark::vertices_span vertices,
                       kernels::bark::indices_span indices) {
        point corners[most_edges];
        std::uint32_t index_of[most_edges];
        triangle triangles[batch];
        places known;
        std::uint32_t count = 0;
        for (std::uint32_t c = 0; c < 3 * all.count; ++c) {
            const std::uint32_t at = 3 * all.first + c;
            const std::uint32_t index =
                kernel_.indexed != 0 ? kernel_.base_vertex + indices[at] : at;
            std::uint8_t& place = known.of(index);
            if (place >= count || index_of[place] != index) {
                place = static_cast<std::uint8_t>(count);
                index_of[count] = index;
                const auto* from = reinterpret_cast<const std::byte*>(&vertices[index]);
                for (std::uint32_t row = 0; row < 3; ++row) {
                    corners[count].rows[row] = lanes::load(from + 16 * row);
                }
                ++count;
            }
            triangles[c / 3].corners[c % 3] = &corners[place];
        }
        std::uint32_t active = 0;
        for (std::uint32_t t = 0; t < all.count; ++t) {
            triangles[t].split = pattern(triangles[t].corners);
            active += triangles[t].split != 0 ? 1 : 0;
        }
        if (active != 0) {
            lookups map;
            for (std::uint32_t c = 0; c < count; ++c) {
                map.add(c, corners[c].rows[0][3], corners[c].rows[1][3]);
            }
            find_heights(map, count);
            for (std::uint32_t c = 0; c < count; ++c) {
                corners[c].height = map.height[c];
            }
        }
        hand_on({triangles, all.count}, active, kernel_.levels);
    }

    /// shared::bark_pattern: sums of squares in the same order, edge by edge.
    [[nodiscard]] std::uint32_t pattern(const point* const (&c)[3]) const {
        using namespace lanes;
        f4 d[4];
        for (int k = 0; k < 3; ++k) {
            const f4 edge = c[k == 2 ? 0 : k + 1]->rows[0] - c[k]->rows[0];
            d[k] = edge * edge;
        }
        d[3] = splat(0);
        transpose(d[0], d[1], d[2], d[3]);
        return first_three(d[0] + d[1] + d[2] > splat(kernel_.threshold * kernel_.threshold));
    }

    /// What becomes of triangles with so many levels to go, of which `active` are to be split:
    /// those that stay are put out, and batches with others divided.
    void hand_on(std::span<const triangle> all, std::uint32_t active, std::uint32_t levels) {
        if (levels == 0 || active == 0) {
            output_(all);
            return;
        }
        if constexpr (counts) {
            if (levels == 1) {
                for (const triangle& t : all) {
                    output_.add(shared::bark_triangles(t.split));
                }
                return;
            }
        }
        const std::uint32_t batches = (active - 1) / batch + 1;
        const std::uint32_t each = (active - 1) / batches + 1;
        for (std::size_t first = 0; first < all.size();) {
            std::size_t end = first;
            for (std::uint32_t found = 0; end < all.size() && end - first < longest && found < each;
                 ++end) {
                found += all[end].split != 0 ? 1 : 0;
            }
            divide(all.subspan(first, end - first), levels);
            first = end;
        }
    }

    /// Splits the triangles of a batch, and their children as far as there are `levels`.
    void divide(std::span<const triangle> triangles, std::uint32_t levels) {
        point middles[most_edges];
        std::uint8_t middle_of[most_edges]; // of each split edge, triangle by triangle
        triangle children[longest + 3 * batch];
        add_midpoints(triangles, middles, middle_of);
        std::uint32_t active = 0;
        const std::size_t count =
            add_children(triangles, middles, middle_of, levels > 1, children, active);
        hand_on({children, count}, active, levels - 1);
    }

    /// The midpoints of all split edges, and which is whose: triangle by triangle, ab, bc, ca.
    void add_midpoints(std::span<const triangle> triangles, point* to,
                       std::uint8_t* middle_of) const {
        const point* a[most_edges];
        const point* b[most_edges];
        lookups map;
        places known;
        std::uint32_t edges = 0;
        for (const triangle& t : triangles) {
            for (std::uint32_t k = 0; k < 3 && t.split != 0; ++k) {
                if (((t.split >> k) & 1u) == 0) {
                    continue;
                }
                const point* from = t.corners[k];
                const point* end = t.corners[k == 2 ? 0 : k + 1];
                const auto x = reinterpret_cast<std::uintptr_t>(from) / sizeof(point);
                const auto y = reinterpret_cast<std::uintptr_t>(end) / sizeof(point);
                std::uint8_t& place = known.of((x + y) * 3 + (x ^ y) * 7);
                // The triangle on the other side has the edge the other way round.
                if (place >= edges || a[place] != end || b[place] != from) {
                    place = static_cast<std::uint8_t>(edges);
                    a[edges] = from;
                    b[edges] = end;
                    map.add(edges++, (from->rows[0][3] + end->rows[0][3]) * 0.5f,
                            (from->rows[1][3] + end->rows[1][3]) * 0.5f);
                }
                *middle_of++ = place;
            }
        }
        find_heights(map, edges);
        for (std::uint32_t spare = edges; spare % 4 != 0; ++spare) {
            a[spare] = a[0];
            b[spare] = b[0];
        }
        for (std::uint32_t first = 0; first < edges; first += 4) {
            four_midpoints({a[first], a[first + 1], a[first + 2], a[first + 3]},
                           {b[first], b[first + 1], b[first + 2], b[first + 3]}, &map.height[first],
                           to + first);
        }
    }

    /// All triangles of the next level, in order, and how many; adds those to be split to `active`.
    std::size_t add_children(std::span<const triangle> triangles, const point* middles,
                             const std::uint8_t* middle_of, bool split_again, triangle* to,
                             std::uint32_t& active) const {
        const triangle* const begin = to;
        for (const triangle& t : triangles) {
            if (t.split == 0) {
                *to++ = t;
                continue;
            }
            const point* all[6] = {t.corners[0], t.corners[1], t.corners[2],
                                   nullptr,      nullptr,      nullptr};
            for (std::uint32_t k = 0; k < 3; ++k) {
                if (((t.split >> k) & 1u) != 0) {
                    all[3 + k] = middles + *middle_of++;
                }
            }
            const std::uint32_t count = shared::bark_triangles(t.split);
            const bool other = count == 3 && takes_other_diagonal(all, t.split);
            const std::uint8_t* code = codes_.of[other ? 1 : 0][t.split];
            for (std::uint32_t child = 0; child < count; ++child, code += 3, ++to) {
                *to = {{all[code[0]], all[code[1]], all[code[2]]}, 0};
                to->split = split_again ? pattern(to->corners) : 0;
                active += to->split != 0 ? 1 : 0;
            }
        }
        return static_cast<std::size_t>(to - begin);
    }

    [[nodiscard]] bool takes_other_diagonal(const point* const (&all)[6],
                                            std::uint32_t split) const {
        const auto square = [&](bool other) {
            const std::uint8_t* child = codes_.of[other ? 1 : 0][split] + 3;
            const lanes::f4 d = all[child[2]]->rows[0] - all[child[other ? 0 : 1]]->rows[0];
            return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        };
        return square(true) < square(false);
    }

    /// shared::bark_middle and bark_raised of four edges.
    void four_midpoints(const point* const (&from)[4], const point* const (&end)[4],
                        const float* heights, point* to) const {
        using namespace lanes;
        const auto [p1, u1] = columns(from, 0);
        const auto [n1, v1] = columns(from, 1);
        const auto [t1, w1] = columns(from, 2);
        const auto [p2, u2] = columns(end, 0);
        const auto [n2, v2] = columns(end, 1);
        const auto [t2, w2] = columns(end, 2);
        const i4 in_order =
            (p1.x < p2.x) | ((p1.x == p2.x) & ((p1.y < p2.y) | ((p1.y == p2.y) & (p1.z < p2.z))));
        const v3 a = choose(in_order, p1, p2);
        const v3 b = choose(in_order, p2, p1);
        const v3 na = choose(in_order, n1, n2);
        const v3 nb = choose(in_order, n2, n1);

        const v3 middle = (p1 + p2) * splat(0.5f);
        const f4 u = (u1 + u2) * 0.5f;
        const f4 v = (v1 + v2) * 0.5f;
        const v3 n = unit_or_itself(n1 + n2);
        const f4 w = choose((w1 == splat(0)) | (w2 == splat(0)), splat(0), (w1 + w2) * 0.5f);

        const v3 ab = b - a;
        const f4 h = load(heights);
        const f4 h1{from[0]->height, from[1]->height, from[2]->height, from[3]->height};
        const f4 h2{end[0]->height, end[1]->height, end[2]->height, end[3]->height};
        const f4 most = splat(kernel_.steepest) * square_root(dot(ab, ab));
        const f4 wanted = kernel_.relief * (h - 0.5f * (h1 + h2));
        const f4 rise = choose(wanted > most, most, choose(wanted < -most, -most, wanted));
        const v3 round = na * dot(ab, na) - nb * dot(ab, nb);
        const v3 raised = middle - round * splat(0.125f * kernel_.rounding) + n * rise;

        put(to, 0, choose(w == splat(0), middle, raised), u);
        put(to, 1, n, v);
        if constexpr (counts) {
            put(to, 2, {splat(0), splat(0), splat(0)}, w);
        } else {
            put(to, 2, unit_or_itself(t1 + t2), w);
        }
        for (int k = 0; k < 4; ++k) {
            to[k].height = h[k];
        }
    }

    static void put(point* to, std::uint32_t row, lanes::v3 xyz, lanes::f4 w) {
        lanes::transpose(xyz.x, xyz.y, xyz.z, w);
        to[0].rows[row] = xyz.x;
        to[1].rows[row] = xyz.y;
        to[2].rows[row] = xyz.z;
        to[3].rows[row] = w;
    }

    /// shared::bark_texel.
    [[nodiscard]] static lanes::f4 texel(lanes::f4 coordinate, std::uint32_t size) {
        using namespace lanes;
        const f4 part = coordinate - floor(coordinate);
        const f4 sure = choose((part >= splat(0)) & (part <= splat(1)), part, splat(0));
        const float n = static_cast<float>(size);
        const f4 x = sure * n - 0.5f;
        return choose(x < splat(0), x + n, x);
    }

    /// The map's heights at the first `count` of some places.
    void find_heights(lookups& at, std::uint32_t count) const {
        for (std::uint32_t spare = count; spare % 8 != 0; ++spare) {
            at.add(spare, 0, 0);
        }
#    if defined(__x86_64__)
        if (__builtin_cpu_supports("avx2")) {
            find_heights_avx2(at, count);
            return;
        }
#    endif
        for (std::uint32_t i = 0; i < count; i += 4) {
            const lanes::f4 h = heights_at(lanes::load(at.u + i), lanes::load(at.v + i));
            std::memcpy(at.height + i, &h, sizeof h);
        }
    }

#    if defined(__x86_64__)
    [[gnu::target("avx2")]] static __m256 texel_avx2(__m256 coordinate, std::uint32_t size) {
        const __m256 part = _mm256_sub_ps(coordinate, _mm256_floor_ps(coordinate));
        const __m256 zero = _mm256_setzero_ps();
        const __m256 sure =
            _mm256_and_ps(part, _mm256_and_ps(_mm256_cmp_ps(part, zero, _CMP_GE_OQ),
                                              _mm256_cmp_ps(part, _mm256_set1_ps(1), _CMP_LE_OQ)));
        const __m256 n = _mm256_set1_ps(static_cast<float>(size));
        const __m256 x = _mm256_sub_ps(_mm256_mul_ps(sure, n), _mm256_set1_ps(0.5f));
        return _mm256_blendv_ps(x, _mm256_add_ps(x, n), _mm256_cmp_ps(x, zero, _CMP_LT_OQ));
    }

    /// 0 in place of `size`.
    [[gnu::target("avx2")]] static __m256i wrapped_avx2(__m256i at, std::uint32_t size) {
        const __m256i n = _mm256_set1_epi32(static_cast<std::int32_t>(size));
        return _mm256_and_si256(at, _mm256_cmpgt_epi32(n, at));
    }

    [[gnu::target("avx2")]] static __m256 mix_avx2(__m256 a, __m256 b, __m256 t) {
        return _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), t));
    }

    [[gnu::target("avx2")]] void find_heights_avx2(lookups& at, std::uint32_t count) const {
        for (std::uint32_t i = 0; i < count; i += 8) {
            const __m256 x = texel_avx2(
                _mm256_mul_ps(_mm256_loadu_ps(at.u + i), _mm256_set1_ps(kernel_.repeats_around)),
                kernel_.width);
            const __m256 y = texel_avx2(
                _mm256_mul_ps(_mm256_loadu_ps(at.v + i), _mm256_set1_ps(kernel_.repeats_along)),
                kernel_.height);
            const __m256 left = _mm256_floor_ps(x);
            const __m256 low = _mm256_floor_ps(y);
            const __m256i one = _mm256_set1_epi32(1);
            const __m256i width = _mm256_set1_epi32(static_cast<std::int32_t>(kernel_.width));
            const __m256i x0 = wrapped_avx2(_mm256_cvttps_epi32(left), kernel_.width);
            const __m256i x1 = wrapped_avx2(_mm256_add_epi32(x0, one), kernel_.width);
            const __m256i y0 = wrapped_avx2(_mm256_cvttps_epi32(low), kernel_.height);
            const __m256i y1 = wrapped_avx2(_mm256_add_epi32(y0, one), kernel_.height);
            const __m256i row0 = _mm256_mullo_epi32(y0, width);
            const __m256i row1 = _mm256_mullo_epi32(y1, width);
            const float* map = heights_.data();
            const __m256 h00 = _mm256_i32gather_ps(map, _mm256_add_epi32(row0, x0), 4);
            const __m256 h10 = _mm256_i32gather_ps(map, _mm256_add_epi32(row0, x1), 4);
            const __m256 h01 = _mm256_i32gather_ps(map, _mm256_add_epi32(row1, x0), 4);
            const __m256 h11 = _mm256_i32gather_ps(map, _mm256_add_epi32(row1, x1), 4);
            const __m256 tx = _mm256_sub_ps(x, left);
            const __m256 h =
                mix_avx2(mix_avx2(h00, h10, tx), mix_avx2(h01, h11, tx), _mm256_sub_ps(y, low));
            _mm256_storeu_ps(at.height + i, h);
        }
    }
#    endif

    /// kernels::bark::height_at in lanes.
    [[nodiscard]] lanes::f4 heights_at(lanes::f4 u, lanes::f4 v) const {
        using namespace lanes;
        const f4 x = texel(u * kernel_.repeats_around, kernel_.width);
        const f4 y = texel(v * kernel_.repeats_along, kernel_.height);
        const f4 left = floor(x);
        const f4 low = floor(y);
        const auto wrapped = [](i4 at, std::uint32_t size) {
            const auto n = static_cast<std::int32_t>(size);
            return at & (at < i4{n, n, n, n});
        };
        const i4 x0 = wrapped(__builtin_convertvector(left, i4), kernel_.width);
        const i4 x1 = wrapped(x0 + 1, kernel_.width);
        const i4 y0 = wrapped(__builtin_convertvector(low, i4), kernel_.height);
        const i4 y1 = wrapped(y0 + 1, kernel_.height);
        const auto gather = [&](i4 column, i4 row) {
            const auto at = [&](int k) {
                return heights_[static_cast<std::size_t>(row[k]) * kernel_.width +
                                static_cast<std::size_t>(column[k])];
            };
            return f4{at(0), at(1), at(2), at(3)};
        };
        const f4 h00 = gather(x0, y0);
        const f4 h10 = gather(x1, y0);
        const f4 h01 = gather(x0, y1);
        const f4 h11 = gather(x1, y1);
        const f4 tx = x - left;
        const f4 ty = y - low;
        const f4 bottom = h00 + (h10 - h00) * tx;
        const f4 top = h01 + (h11 - h01) * tx;
        return bottom + (top - bottom) * ty;
    }

    const kernels::bark& kernel_;
    heights_span heights_;
    Output& output_;
    const corner_codes& codes_;
};

template <>
struct program<kernels::bark> : plain_program<kernels::bark> {
    using kernel_type = kernels::bark;
    using vertices_span = kernel_type::vertices_span;
    using indices_span = kernel_type::indices_span;
    using heights_span = kernel_type::heights_span;

    [[nodiscard]] static std::uint64_t count(const kernel_type& kernel, range elements,
                                             vertices_span vertices, indices_span indices,
                                             heights_span heights) {
        counter counted;
        bark_splitter<counter>(kernel, heights, counted).elements(elements, vertices, indices);
        return counted.triangles;
    }

    /// To count is to split, so what has been split is kept.
    static constexpr bool keeps_what_it_counts = true;

    /// Puts the triangles at `to` and says how many; none where there are as many as `room`, or
    /// more.
    [[nodiscard]] static std::optional<std::uint64_t>
    keep(const kernel_type& kernel, range elements, std::byte* to, std::uint64_t room,
         vertices_span vertices, indices_span indices, heights_span heights) {
        writer<false> kept{to, room};
        bark_splitter<writer<false>>(kernel, heights, kept).elements(elements, vertices, indices);
        return kept.room != 0 ? std::optional(room - kept.room) : std::nullopt;
    }

    template <class Sink>
    static void triangles(const kernel_type& kernel, range elements, Sink& sink,
                          vertices_span vertices, indices_span indices, heights_span heights) {
        writer<true> written{sink.place(), sink.room()};
        bark_splitter<writer<true>>(kernel, heights, written).elements(elements, vertices, indices);
        sink.skip(sink.room() - written.room);
    }

  private:
    struct counter {
        std::uint64_t triangles = 0;

        [[nodiscard]] static bool wants_more() { return true; }
        void operator()(std::span<const bark_triangle> more) { triangles += more.size(); }
        void add(std::uint32_t more) { triangles += more; }
    };

    /// Triangles one after another, as long as there is room.
    template <bool past_the_cache>
    struct writer {
        std::byte* to;
        std::uint64_t room;

        [[nodiscard]] bool wants_more() const { return room != 0; }
        void operator()(std::span<const bark_triangle> more) {
            const std::size_t count = std::min<std::uint64_t>(more.size(), room);
            room -= count;
            float* out = reinterpret_cast<float*>(to);
            for (const bark_triangle& t : more.first(count)) {
                for (const bark_point* corner : t.corners) {
                    for (const lanes::f4& row : corner->rows) {
                        if constexpr (past_the_cache) {
                            lanes::stream(out, row);
                        } else {
                            std::memcpy(out, &row, sizeof row);
                        }
                        out += 4;
                    }
                }
            }
            to = reinterpret_cast<std::byte*>(out);
        }
    };
};

} // namespace skybark::cpu

#endif
