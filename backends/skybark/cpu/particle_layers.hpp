#pragma once
// particle_impulse and shadow_slab, eight voxels of a row at a time.
//
// What a particle has in common for all its layers is made once, and sorted by height and by the
// first layer that it cuts. A layer then goes from band to band of rows, so that the rows stay in
// the nearest cache, and in each through the particles of its neighbourhood, which lie one after
// another. The operations and their order are the kernels' own, so the bits are the same (a test
// compares them). Without AVX2 the kernels' own functions run.

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
        for (std::uint32_t band = 0; band < bands_; ++band) {
            for (std::uint32_t c = 0; c < classes; ++c) {
                if (most_[c].layers != 0) {
                    const std::uint32_t from = z - std::min(z, most_[c].layers - 1);
                    const std::uint32_t bin = (c * bands_ + band) * layers_;
                    add_particles(c, bin == 0 && from == 0 ? 0 : ends_[bin + from - 1],
                                  ends_[bin + z], static_cast<int>(z), to);
                }
            }
        }
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
            const auto band = static_cast<std::uint32_t>(std::min(c.top, height_ - 1)) / band_rows_;
            c.bin = (of * bands_ + band) * layers_ + static_cast<std::uint32_t>(low);
        }
        return c;
    }
    [[nodiscard]] std::uint32_t class_of(std::uint32_t bin) const {
        return bin / (bands_ * layers_);
    }

    template <class Device>
    [[nodiscard]] bool sort(Device& device, layer_scratch& scratch, range elements,
                            const volume_description& what) {
        layers_ = what.depth;
        width_ = static_cast<std::int32_t>(what.width);
        height_ = static_cast<std::int32_t>(what.height);
        band_rows_ = std::max(16u, (what.height + 31) / 32);
        bands_ = (what.height + band_rows_ - 1) / band_rows_;
        const std::uint32_t bins = classes * bands_ * layers_;
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
            first_of_[c] = counts[std::uint64_t{c} * bands_ * layers_];
            const std::uint32_t next =
                c + 1 < classes ? counts[(std::uint64_t{c} + 1) * bands_ * layers_] : sum;
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
        to.optical_depth = p.optical_depth;
        to.kept = shade.light == 0   ? 1.0f
                  : shade.light == 1 ? 1.0f - p.albedo * shade.forward
                                     : p.albedo * shade.forward;
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
            put_parts(to, at, parts_at(c, place));
        }
    }

    /// What part of the particle lies above the rows from `top` downwards, `bottom` the last.
    [[gnu::target("avx2")]] void put_parts(const layered_particle& p,
                                           const kernels::particle_shade::placed& at,
                                           float* parts) const {
        using namespace eight;
        const f8 steps = _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
        const f8 bottom = splat(static_cast<float>(p.bottom));
        for (std::int32_t row = p.top; row >= p.bottom; row -= 8) {
            const f8 rows = minus(splat(static_cast<float>(row)), steps);
            const f8 u =
                times(over(minus(plus(rows, splat(0.5f)), splat(at.centre.y)), splat(at.radius.y)),
                      splat(kernel_->shade.sigmas));
            const f8 above = _mm256_cmp_ps(rows, bottom, _CMP_GT_OQ);
            _mm256_storeu_ps(parts + (p.top - row), choose(above, gaussian_above(u), splat(1.0f)));
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

    /// −ln G in quanta on lines through eight columns: particle_shade::lateral.
    [[gnu::target("avx2")]] __m256 lateral(const layered_particle& p, float x, float dz2) const {
        using namespace eight;
        const shades& s = shades_;
        const f8 columns = plus(splat(x), _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7));
        const f8 dx = times(minus(plus(columns, splat(0.5f)), splat(p.x)), splat(s.width));
        const f8 d2 = plus(times(dx, dx), splat(dz2));
        const f8 r2 = splat(p.radius2);
        const f8 tau =
            times(splat(p.optical_depth), exp_minus(over(times(splat(s.decay), d2), r2)));
        f8 amount;
        if (s.light == 2) {
            const f8 on = times(splat(p.kept), tau);
            const f8 log = log_of_sum(plus(exp_minus(tau), on), minus(on, one_minus_exp(tau)));
            amount = choose(less(splat(0.0f), on), _mm256_xor_ps(log, splat(-0.0f)), tau);
        } else {
            amount = times(tau, splat(p.kept));
        }
        amount = _mm256_and_ps(amount, _mm256_cmp_ps(d2, r2, _CMP_NGE_UQ));
        amount = s.inverse_quantum != 0.0f ? times(amount, splat(s.inverse_quantum))
                                           : over(amount, splat(s.quantum));
        if constexpr (whole_columns) {
            const f8 inside =
                _mm256_and_ps(_mm256_cmp_ps(columns, splat(static_cast<float>(p.left)), _CMP_GE_OQ),
                              less(columns, splat(static_cast<float>(p.right))));
            amount = _mm256_and_ps(amount, inside);
        }
        return amount;
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

    [[gnu::target("avx2")]] static void add_to(std::int32_t* sums, __m256i amounts) {
        auto* const at = reinterpret_cast<__m256i*>(sums);
        _mm256_storeu_si256(at, _mm256_add_epi32(_mm256_loadu_si256(at), amounts));
    }

    /// Adds 8 · N columns of a particle, from x on.
    template <std::size_t N>
    [[gnu::target("avx2")]] void add_columns(const layered_particle& p, const float* parts,
                                             std::int32_t x, float dz2,
                                             const layer_sums& to) const {
        using namespace eight;
        f8 lines[N];
        for (std::size_t k = 0; k < N; ++k) {
            lines[k] = lateral(p, static_cast<float>(x + 8 * static_cast<std::int32_t>(k)), dz2);
        }
        const std::int32_t highest = std::min(p.top, height_ - 1);
        const std::int32_t lowest = std::max(p.bottom, 0);
        const std::int64_t stride = to.stride;
        std::int32_t* const sums = to.sums + x;
        if (p.top == p.bottom) {
            if (p.top == highest) {
                for (std::size_t k = 0; k < N; ++k) {
                    add_to(sums + p.top * stride + 8 * k, quanta(lines[k]));
                }
            }
        } else if (highest >= lowest) {
            i8 above[N];
            for (std::size_t k = 0; k < N; ++k) {
                above[k] = whole_columns || p.top == highest
                               ? _mm256_setzero_si256()
                               : quanta(times(lines[k], splat(parts[p.top - highest - 1])));
            }
            for (std::int32_t row = highest; row >= lowest; --row) {
                const f8 part = splat(parts[p.top - row]);
                for (std::size_t k = 0; k < N; ++k) {
                    const i8 here = quanta(times(lines[k], part));
                    add_to(sums + row * stride + 8 * k, _mm256_sub_epi32(here, above[k]));
                    above[k] = whole_columns ? above[k] : here;
                }
            }
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

    /// Adds those of the particles [first, last) of a class that cut layer z.
    [[gnu::target("avx2")]] void add_particles(std::uint32_t c, std::uint32_t first,
                                               std::uint32_t last, std::int32_t z,
                                               const layer_sums& to) const {
        const float depth = kernel_->shade.grid.voxel.z;
        for (std::uint32_t i = first; i < last; ++i) {
            const layered_particle& p = records_[i];
            if (p.end <= z) {
                continue;
            }
            const float* const parts = most_[c].rows != 0 ? parts_at(c, i) : nullptr;
            const float dz = (static_cast<float>(z) + 0.5f - p.z) * depth;
            const float dz2 = dz * dz;
            // Small ones are taken as wide as they are anywhere: what a narrower row would save is
            // lost where the number of vectors is foreseen wrong.
            if (p.vectors == 2) {
                add_columns<2>(p, parts, p.start, dz2, to);
            } else if (p.vectors == 1) {
                add_columns<1>(p, parts, p.start, dz2, to);
            } else if (p.vectors == 3) {
                add_columns<3>(p, parts, p.start, dz2, to);
            } else if (p.vectors == 0) {
                plain_program<K>::add_slab(*kernel_, p.element,
                                           static_cast<std::uint32_t>(z - p.first), to, particles_);
            } else {
                add_wide(p, parts, dz2, to);
            }
        }
    }

    /// A wide particle: as wide as its chord is.
    [[gnu::target("avx2")]] void add_wide(const layered_particle& p, const float* parts, float dz2,
                                          const layer_sums& to) const {
        // A little more, because of rounding; beyond it nothing is added.
        const float chord = std::max(p.radius2 * 1.000002f - dz2, 0.0f);
        const float reach = _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(chord))) * shades_.inverse_width;
        const std::int32_t left = std::max(static_cast<std::int32_t>(p.x - reach + 0.49f), 0);
        const std::int32_t right = std::min(static_cast<std::int32_t>(p.x + reach + 0.51f), width_);
        const std::int32_t columns = (right - left + 7) / 8 * 8;
        std::int32_t x = std::min(left, width_ - columns);
        const std::int32_t end = x + columns;
        for (; x + 16 <= end; x += 16) {
            add_columns<2>(p, parts, x, dz2, to);
        }
        if (x < end) {
            add_columns<1>(p, parts, x, dz2, to);
        }
    }

    slab_bins<K, particles_span> plain_;
    const K* kernel_;
    particles_span particles_;
    bool fast_;
    shades shades_;
    std::uint32_t layers_ = 0;
    std::uint32_t band_rows_ = 1;
    std::uint32_t bands_ = 0;
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
