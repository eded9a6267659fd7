#pragma once
// particle_impulse and shadow_slab, eight voxels of a row at a time.
//
// What a particle has in common for all its layers is made once, and sorted by the first layer that
// it cuts; a layer then goes through the particles of its neighbourhood, which lie one after
// another, and makes four times eight columns at once. The operations and their order are the
// kernels' own, so the bits are the same (a test compares them). Without AVX2 the kernels' own
// functions run.

#include <skybark/cpu/eight.hpp>
#include <skybark/cpu/layers.hpp>
#include <skybark/kernels/particle_impulse.hpp>
#include <skybark/kernels/shadow_slab.hpp>

#include <bit>

#if defined(SKYBARK_HAS_EIGHT)

namespace skybark::cpu {

/// A particle as its layers need it; lengths across the light in m, along it in rows.
struct alignas(64) layered_particle {
    float x;             ///< its centre, in voxels
    float z;             ///< the same
    float radius2;       ///< m²
    float optical_depth; ///< along a line through the centre
    float kept;          ///< light 1: 1 − a f; light 2: a f
    std::int32_t first;  ///< layer
    std::int32_t end;    ///< one past the last layer
    std::int32_t top;    ///< the highest row that it adds to
    std::int32_t bottom; ///< the highest row below all of it
    std::int32_t left;   ///< the columns that a shadow slab covers
    std::int32_t right;
    std::int32_t start;    ///< the columns that it may add to at all, in eights …
    std::uint32_t vectors; ///< … and how many eights; 0: more than a row has
    std::uint32_t element;
};

/// Slabs of K by layers: see slab_bins. K is particle_impulse or shadow_slab.
template <class K>
class particle_bins {
    using particles_span = std::span<const cloud_particle>;

  public:
    particle_bins(const K& kernel, particles_span particles)
        : plain_(kernel, particles), kernel_(&kernel), particles_(particles),
          fast_(__builtin_cpu_supports("avx2")), shades_(make_shades()) {}

    /// So many that they take a few hundred MiB at most.
    [[nodiscard]] std::uint32_t batch() const {
        if (!fast_) {
            return plain_.batch();
        }
        const light_grid& grid = kernel_->shade.grid;
        const float rows = static_cast<float>(kernel_->shade.slices) *
                               std::max(1.0f, grid.voxel.z / grid.voxel.y) +
                           16;
        const float bytes = sizeof(layered_particle) + sizeof(float) * rows;
        return static_cast<std::uint32_t>(std::clamp(0x1p28f / bytes, 256.0f, 0x1p21f));
    }

    template <class Device>
    [[nodiscard]] bool fill(Device& device, layer_scratch& scratch, range elements,
                            const volume_description& what) {
        return fast_ ? sort(device, scratch, elements, what)
                     : plain_.fill(device, scratch, elements, what);
    }

    void add(std::uint32_t z, const layer_sums& to) const {
        if (!fast_) {
            plain_.add(z, to);
            return;
        }
        add_fast(z, to);
    }

  private:
    /// Particles that cut 4^c to 4^(c + 1) − 1 layers are of class c: a few large ones then do not
    /// make every layer look at all the small ones.
    static constexpr std::uint32_t classes = 6;
    static constexpr std::uint32_t most_pieces = 8;
    static constexpr std::uint32_t least_of_piece = 2048;
    static constexpr std::uint32_t none = 0xffffffff;
    static constexpr bool whole_columns = std::is_same_v<K, kernels::shadow_slab>;

    struct extent {
        std::uint32_t layers = 0;
        std::uint32_t rows = 0; ///< that are neither above nor below all of it, and one more
    };

    /// Layers [first, end) that the particle cuts, rows [bottom, top] and the columns that it adds
    /// to, and the bin that this puts it in.
    struct cut {
        std::int32_t first;
        std::int32_t end;
        std::int32_t top;
        std::int32_t bottom;
        std::int32_t left;
        std::int32_t right;
        std::uint32_t bin;
    };
    [[nodiscard]] cut cut_of(const kernels::particle_shade::placed& at) const {
        const kernels::particle_shade& shade = kernel_->shade;
        cut c;
        c.first = shade.first_slice(at);
        c.end = static_cast<std::int32_t>(
            std::min<std::int64_t>(std::int64_t{c.first} + shade.slice_count(at), layers_));
        c.top = shared::top_row(at.centre.y, at.radius.y);
        c.bottom = shade.profile == 0
                       ? c.top
                       : std::min(c.top, shared::bottom_row(at.centre.y, at.radius.y));
        // A little more than the diameter, because of rounding.
        c.left = std::max(static_cast<std::int32_t>(at.centre.x - at.radius.x + 0.49f), 0);
        c.right = std::min(static_cast<std::int32_t>(at.centre.x + at.radius.x + 0.51f), width_);
        const std::int32_t low = std::max(c.first, 0);
        const bool inside =
            low < c.end && c.left < c.right && c.top >= 0 && (whole_columns || c.bottom < height_);
        c.bin = none;
        if (inside) {
            const auto span = static_cast<std::uint32_t>(c.end - low);
            const auto of = (static_cast<std::uint32_t>(std::bit_width(span)) - 1) / 2;
            c.bin = of * layers_ + static_cast<std::uint32_t>(low);
        }
        return c;
    }
    [[nodiscard]] std::uint32_t class_of(std::uint32_t bin) const { return bin / layers_; }

    template <class Device>
    [[nodiscard]] bool sort(Device& device, layer_scratch& scratch, range elements,
                            const volume_description& what) {
        layers_ = what.depth;
        width_ = static_cast<std::int32_t>(what.width);
        height_ = static_cast<std::int32_t>(what.height);
        const std::uint32_t bins = classes * layers_;
        const std::uint32_t pieces =
            std::clamp(elements.count / least_of_piece, std::uint32_t{1}, most_pieces);
        const auto start = [&](std::uint32_t p) {
            return static_cast<std::uint32_t>(std::uint64_t{elements.count} * p / pieces);
        };
        auto* const counts =
            scratch.counts.room_for<std::uint32_t>(std::uint64_t{pieces} * bins + elements.count);
        records_ = scratch.slabs.room_for<layered_particle>(elements.count);
        if (counts == nullptr || records_ == nullptr) {
            return false;
        }
        std::uint32_t* const bin_of = counts + std::uint64_t{pieces} * bins;
        std::array<std::array<extent, classes>, most_pieces> most{};
        device.parallel(pieces, [&](std::uint32_t piece) {
            std::uint32_t* const count = counts + std::uint64_t{piece} * bins;
            std::fill_n(count, bins, 0u);
            for (std::uint32_t i = start(piece); i < start(piece + 1); ++i) {
                const auto at = kernel_->shade.place(particles_[elements.first + i]);
                const cut c = cut_of(at);
                bin_of[i] = c.bin;
                if (c.bin != none) {
                    ++count[c.bin];
                    extent& e = most[piece][class_of(c.bin)];
                    e.layers = std::max(e.layers,
                                        static_cast<std::uint32_t>(c.end - std::max(c.first, 0)));
                    e.rows = std::max(e.rows, static_cast<std::uint32_t>(c.top - c.bottom));
                }
            }
        });
        std::uint32_t sum = 0;
        for (std::uint32_t bin = 0; bin < bins; ++bin) {
            for (std::uint32_t piece = 0; piece < pieces; ++piece) {
                std::uint32_t& place = counts[std::uint64_t{piece} * bins + bin];
                const std::uint32_t count = place;
                place = sum;
                sum += count;
            }
        }
        std::uint64_t parts = 0;
        for (std::uint32_t c = 0; c < classes; ++c) {
            most_[c] = {};
            for (std::uint32_t piece = 0; piece < pieces; ++piece) {
                most_[c].layers = std::max(most_[c].layers, most[piece][c].layers);
                most_[c].rows = std::max(most_[c].rows, most[piece][c].rows);
            }
            first_of_[c] = counts[c * layers_];
            const std::uint32_t next = c + 1 < classes ? counts[(c + 1) * layers_] : sum;
            // One more than between top and bottom, in whole eights; none where all end at once.
            most_[c].rows = most_[c].rows == 0 ? 0 : (most_[c].rows + 8) / 8 * 8;
            parts_of_[c] = parts;
            parts += std::uint64_t{next - first_of_[c]} * most_[c].rows;
        }
        parts_ = scratch.parts.room_for<float>(parts);
        if (parts_ == nullptr) {
            return false;
        }
        device.parallel(pieces, [&](std::uint32_t piece) {
            std::uint32_t* const place = counts + std::uint64_t{piece} * bins;
            for (std::uint32_t i = start(piece); i < start(piece + 1); ++i) {
                if (bin_of[i] != none) {
                    put(elements.first + i, class_of(bin_of[i]), place[bin_of[i]]++);
                }
            }
        });
        // The last piece's places have moved on to where the bins end.
        ends_ = counts + std::uint64_t{pieces - 1} * bins;
        return true;
    }

    [[nodiscard]] float* parts_at(std::uint32_t c, std::uint32_t place) const {
        return parts_ + parts_of_[c] + std::uint64_t{place - first_of_[c]} * most_[c].rows;
    }

    void put(std::uint32_t element, std::uint32_t c, std::uint32_t place) const {
        const kernels::particle_shade& shade = kernel_->shade;
        const cloud_particle& p = particles_[element];
        const auto at = shade.place(p);
        const cut all = cut_of(at);
        layered_particle& to = records_[place];
        to.x = at.centre.x;
        to.z = at.centre.z;
        to.radius2 = p.radius * p.radius;
        to.optical_depth = shared::bounded(p.optical_depth, 1e6f);
        const float forward = shared::bounded(p.albedo, 1.0f) * shade.forward;
        to.kept = shade.light == 0 ? 1.0f : shade.light == 1 ? 1.0f - forward : forward;
        to.first = all.first;
        to.end = all.end;
        to.top = all.top;
        to.bottom = all.bottom;
        to.left = static_cast<std::int32_t>(std::ceil(at.centre.x - at.radius.x - 0.5f));
        to.right = static_cast<std::int32_t>(std::ceil(at.centre.x + at.radius.x - 0.5f));
        const std::int32_t columns = (all.right - all.left + 7) / 8 * 8;
        to.start = std::min(all.left, width_ - columns);
        to.vectors = to.start < 0 ? 0 : static_cast<std::uint32_t>(columns) / 8;
        to.element = element;
        if (all.top > all.bottom) {
            put_parts(all, at, parts_at(c, place));
        }
    }

    /// What part of the particle lies above the rows from `top` downwards, `bottom` the last.
    [[gnu::target("avx2")]] void put_parts(const cut& p, const kernels::particle_shade::placed& at,
                                           float* parts) const {
        using namespace eight;
        const std::int32_t count = p.top - p.bottom + 1;
        for (std::int32_t done = 0; done < count; done += 32) {
            const f8 first = plus(_mm256_set1_ps(static_cast<float>(p.top - done)),
                                  _mm256_setr_ps(0, -1, -2, -3, -4, -5, -6, -7));
            const f32 rows{first, minus(first, _mm256_set1_ps(8)), minus(first, _mm256_set1_ps(16)),
                           minus(first, _mm256_set1_ps(24))};
            const f32 height = minus(plus(rows, splat<f32>(0.5f)), splat<f32>(at.centre.y));
            const f32 u =
                times(over(height, splat<f32>(at.radius.y)), splat<f32>(kernel_->shade.sigmas));
            const f32 above = less(splat<f32>(static_cast<float>(p.bottom)), rows);
            const f32 part = choose(above, gaussian_above(u), splat<f32>(1.0f));
            const f8 all[] = {part.a, part.b, part.c, part.d};
            for (std::int32_t k = 0; k < 4 && done + 8 * k < count; ++k) {
                _mm256_storeu_ps(parts + done + 8 * k, all[k]);
            }
        }
    }

    /// What all rows of a layer have in common.
    struct shades {
        float width;         ///< of a voxel, m
        float inverse_width; ///< 1/m
        float decay;         ///< 0.5 σs²
        float quantum;
        float inverse_quantum; ///< 0 where a division would round otherwise
        std::uint32_t light;
    };

    /// Eight columns of a particle in a layer.
    struct job {
        const layered_particle* particle;
        const float* parts;
        float dz2; ///< m²
        std::int32_t column;
    };
    static constexpr std::size_t most_jobs = 64; ///< that wait: whole fours of them

    /// −ln G in quanta on the lines through the columns of four jobs: particle_shade::lateral.
    [[gnu::target("avx2")]] void lateral(const job* jobs, eight::f8* out) const {
        using namespace eight;
        const layered_particle& pa = *jobs[0].particle;
        const layered_particle& pb = *jobs[1].particle;
        const layered_particle& pc = *jobs[2].particle;
        const layered_particle& pd = *jobs[3].particle;
        const f8 steps = _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
        const f32 columns{plus(_mm256_set1_ps(static_cast<float>(jobs[0].column)), steps),
                          plus(_mm256_set1_ps(static_cast<float>(jobs[1].column)), steps),
                          plus(_mm256_set1_ps(static_cast<float>(jobs[2].column)), steps),
                          plus(_mm256_set1_ps(static_cast<float>(jobs[3].column)), steps)};
        const f32 x = each(pa.x, pb.x, pc.x, pd.x);
        const f32 r2 = each(pa.radius2, pb.radius2, pc.radius2, pd.radius2);
        const f32 dx = times(minus(plus(columns, splat<f32>(0.5f)), x), splat<f32>(shades_.width));
        const f32 d2 =
            plus(times(dx, dx), each(jobs[0].dz2, jobs[1].dz2, jobs[2].dz2, jobs[3].dz2));
        const f32 depth =
            each(pa.optical_depth, pb.optical_depth, pc.optical_depth, pd.optical_depth);
        const f32 kept = each(pa.kept, pb.kept, pc.kept, pd.kept);
        const f32 tau = times(depth, exp_minus(over(times(splat<f32>(shades_.decay), d2), r2)));
        f32 amount;
        if (shades_.light == 2) {
            const f32 on = times(kept, tau);
            amount = choose(less(splat<f32>(0.0f), on), negative(log_of_product(tau, on)), tau);
        } else {
            amount = times(tau, kept);
        }
        amount = both(amount, not_up_to(d2, r2));
        amount = shades_.inverse_quantum != 0.0f
                     ? times(amount, splat<f32>(shades_.inverse_quantum))
                     : over(amount, splat<f32>(shades_.quantum));
        amount = summable(amount);
        out[0] = amount.a;
        out[1] = amount.b;
        out[2] = amount.c;
        out[3] = amount.d;
    }
    [[gnu::target("avx2"), gnu::always_inline]] static eight::f32 each(float a, float b, float c,
                                                                       float d) {
        return {_mm256_set1_ps(a), _mm256_set1_ps(b), _mm256_set1_ps(c), _mm256_set1_ps(d)};
    }

    [[nodiscard]] shades make_shades() const {
        const kernels::particle_shade& shade = kernel_->shade;
        const float quantum = shade.grid.voxel.w;
        // Division by a power of two and multiplication with its inverse are the same.
        int exponent = 0;
        const bool power_of_two =
            std::frexp(quantum, &exponent) == 0.5f && std::abs(exponent) < 100;
        return {shade.grid.voxel.x,
                1.0f / shade.grid.voxel.x,
                0.5f * shade.sigmas * shade.sigmas,
                quantum,
                power_of_two ? 1.0f / quantum : 0.0f,
                shade.light};
    }

    [[gnu::target("avx2"), gnu::always_inline]] static void add_to(std::int32_t* sums,
                                                                   __m256i amounts) {
        auto* const at = reinterpret_cast<__m256i*>(sums);
        _mm256_storeu_si256(at, _mm256_add_epi32(_mm256_loadu_si256(at), amounts));
    }

    /// Rows of a particle from the highest downwards, and what of it lies above each.
    struct row_run {
        std::int32_t* sums;
        std::int64_t stride;
        const float* parts;
        std::int32_t count;
        bool starts_above; ///< the first of `parts` is of the row above the highest
    };

    /// Adds N times eight columns to rows: what lies above each, less what the row above it got.
    template <std::size_t N>
    [[gnu::target("avx2"), gnu::always_inline]] static void add_rows(const row_run& to,
                                                                     const eight::f8* lines) {
        using namespace eight;
        i8 above[N];
        for (std::size_t k = 0; k < N; ++k) {
            above[k] = to.starts_above ? quanta(times(lines[k], _mm256_set1_ps(to.parts[0])))
                                       : _mm256_setzero_si256();
        }
        const float* const parts = to.parts + (to.starts_above ? 1 : 0);
        std::int32_t* sums = to.sums;
        for (std::int32_t i = 0; i < to.count; ++i, sums -= to.stride) {
            for (std::size_t k = 0; k < N; ++k) {
                const i8 here = quanta(times(lines[k], _mm256_set1_ps(parts[i])));
                add_to(sums + 8 * k, _mm256_sub_epi32(here, above[k]));
                above[k] = whole_columns ? above[k] : here;
            }
        }
    }

    /// Adds N jobs of a particle that lie side by side.
    template <std::size_t N>
    [[gnu::target("avx2"), gnu::always_inline]] void
    add_columns(const job& of, const eight::f8* lines, const layer_sums& to) const {
        using namespace eight;
        const layered_particle& p = *of.particle;
        const std::int32_t highest = std::min(p.top, height_ - 1);
        const std::int32_t lowest = std::max(p.bottom, 0);
        const std::int64_t stride = to.stride;
        std::int32_t* const sums = to.sums + of.column;
        if (p.top == p.bottom) {
            if (p.top == highest) {
                for (std::size_t k = 0; k < N; ++k) {
                    add_to(sums + p.top * stride + 8 * k, quanta(lines[k]));
                }
            }
        } else if (highest >= lowest) {
            const std::int32_t cut_off = p.top - highest;
            const bool starts_above = !whole_columns && cut_off != 0;
            const row_run all{sums + highest * stride, stride,
                              of.parts + cut_off - (starts_above ? 1 : 0), highest - lowest + 1,
                              starts_above};
            add_rows<N>(all, lines);
        }
        if constexpr (whole_columns) {
            i8 whole[N];
            for (std::size_t k = 0; k < N; ++k) {
                whole[k] = quanta(lines[k]);
            }
            for (std::int32_t row = std::min(highest, p.bottom - 1); row >= 0; --row) {
                for (std::size_t k = 0; k < N; ++k) {
                    add_to(sums + row * stride + 8 * k, whole[k]);
                }
            }
        }
    }

    /// Does the first `count` jobs. Those up to the next multiple of four are something already.
    [[gnu::target("avx2")]] void finish(const job* jobs, std::size_t count,
                                        const layer_sums& to) const {
        eight::f8 lines[most_jobs];
        for (std::size_t i = 0; i < count; i += 4) {
            lateral(jobs + i, lines + i);
        }
        if constexpr (whole_columns) {
            for (std::size_t i = 0; i < count; ++i) {
                lines[i] = eight::both(lines[i], in_slab(jobs[i]));
            }
        }
        for (std::size_t i = 0; i < count;) {
            if (i + 1 < count && jobs[i + 1].particle == jobs[i].particle &&
                jobs[i + 1].column == jobs[i].column + 8) {
                add_columns<2>(jobs[i], lines + i, to);
                i += 2;
            } else {
                add_columns<1>(jobs[i], lines + i, to);
                i += 1;
            }
        }
    }

    /// The columns that a shadow slab covers: rounding apart, those within the radius.
    [[gnu::target("avx2")]] static __m256 in_slab(const job& of) {
        const __m256i columns = _mm256_add_epi32(_mm256_set1_epi32(of.column),
                                                 _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
        return _mm256_castsi256_ps(_mm256_andnot_si256(
            _mm256_cmpgt_epi32(_mm256_set1_epi32(of.particle->left), columns),
            _mm256_cmpgt_epi32(_mm256_set1_epi32(of.particle->right), columns)));
    }

    /// Adds what the particles have in layer z.
    void add_fast(std::uint32_t z, const layer_sums& to) const {
        // Those that were never filled in are computed with as well.
        std::array<job, most_jobs> jobs;
        jobs.fill({records_, nullptr, 0, 0});
        std::size_t count = 0;
        const auto finish_now = [&] {
            finish(jobs.data(), count, to);
            count = 0;
        };
        const float depth = kernel_->shade.grid.voxel.z;
        for (std::uint32_t c = 0; c < classes; ++c) {
            if (most_[c].layers == 0) {
                continue;
            }
            const std::uint32_t bin = c * layers_;
            const std::uint32_t from = bin + z - std::min(z, most_[c].layers - 1);
            for (std::uint32_t i = from == 0 ? 0 : ends_[from - 1]; i < ends_[bin + z]; ++i) {
                const layered_particle& p = records_[i];
                if (p.end <= static_cast<std::int32_t>(z)) {
                    continue;
                }
                if (p.vectors == 0) {
                    plain_program<K>::add_slab(*kernel_, p.element,
                                               z - static_cast<std::uint32_t>(p.first), to,
                                               particles_);
                    continue;
                }
                const float dz = (static_cast<float>(z) + 0.5f - p.z) * depth;
                const stretch across = stretch_of(p, dz * dz);
                const float* const parts = most_[c].rows != 0 ? parts_at(c, i) : nullptr;
                for (std::uint32_t k = 0; k < across.vectors; ++k) {
                    jobs[count++] = {&p, parts, dz * dz,
                                     across.start + 8 * static_cast<std::int32_t>(k)};
                    if (count == most_jobs) {
                        finish_now();
                    }
                }
            }
        }
        finish_now();
    }

    struct stretch {
        std::int32_t start;
        std::uint32_t vectors;
    };
    /// Small ones are taken as wide as they are anywhere: what a narrower row would save is lost
    /// where the number of vectors is foreseen wrong.
    [[nodiscard]] stretch stretch_of(const layered_particle& p, float dz2) const {
        if (p.vectors <= 3) {
            return {p.start, p.vectors};
        }
        // A little more than the chord, because of rounding; beyond it nothing is added.
        const float reach =
            std::sqrt(std::max(p.radius2 * 1.000002f - dz2, 0.0f)) * shades_.inverse_width;
        const std::int32_t left = std::max(static_cast<std::int32_t>(p.x - reach + 0.49f), 0);
        const std::int32_t right = std::min(static_cast<std::int32_t>(p.x + reach + 0.51f), width_);
        const std::uint32_t vectors = static_cast<std::uint32_t>(std::max(right - left + 7, 0)) / 8;
        // Widened by rounding it may be one eight more than anywhere, for which a row has no room.
        if (vectors >= p.vectors) {
            return {p.start, p.vectors};
        }
        return {std::min(left, width_ - 8 * static_cast<std::int32_t>(vectors)), vectors};
    }

    slab_bins<K, particles_span> plain_;
    const K* kernel_;
    particles_span particles_;
    bool fast_;
    shades shades_;
    std::uint32_t layers_ = 0;
    std::int32_t width_ = 0;
    std::int32_t height_ = 0;
    layered_particle* records_ = nullptr;
    float* parts_ = nullptr;
    const std::uint32_t* ends_ = nullptr;
    std::array<extent, classes> most_{};
    std::array<std::uint32_t, classes> first_of_{};
    std::array<std::uint64_t, classes> parts_of_{};
};

template <>
struct program<kernels::particle_impulse> : plain_program<kernels::particle_impulse> {
    using bins = particle_bins<kernels::particle_impulse>;
};
template <>
struct program<kernels::shadow_slab> : plain_program<kernels::shadow_slab> {
    using bins = particle_bins<kernels::shadow_slab>;
};

} // namespace skybark::cpu

#endif
