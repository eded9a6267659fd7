#pragma once
// Bundles of rays in one go: what gather/bundle_resolver.hpp composes of maps, a sort and a scan,
// done the way that suits a CPU. Hits have the same bits.
//
// Samples are placed and sorted into bands of rows of a grid across the bundle, a few thousand at a
// time, while every triangle is told which bands it reaches over. Then one task at a time owns a
// band: it sorts the band's samples by cell, visits the band's triangles, and tests each against
// the samples of the cells that it reaches, at the sample's own place; what it works on fits into
// the caches. The nearest hit of equal ones is the lowest triangle's, so that no order matters, nor
// the number of threads.

#include <skybark/core/backend.hpp>
#include <skybark/cpu/bundle_plain.hpp>
#include <skybark/cpu/bundle_sixteen.hpp>

#include <atomic>

namespace skybark::cpu {

/// Memory that bundles use again.
struct bundle_scratch {
    const detail::memory_source* source = nullptr;
    detail::scratch_memory placed{source};
    detail::scratch_memory runs{source};
    detail::scratch_memory ranges{source};
    detail::scratch_memory bands{source};
    bundles::grid grid = {};
};

/// Which instructions a bundle is resolved with; the fastest that the machine has, unless a test
/// asks.
enum class bundle_lanes { one, eight, sixteen };

[[nodiscard]] inline bundle_lanes best_bundle_lanes() {
#if defined(SKYBARK_HAS_SIXTEEN)
    if (__builtin_cpu_supports("avx512f")) {
        return bundle_lanes::sixteen;
    }
#endif
#if defined(SKYBARK_BUNDLES_HAVE_EIGHT)
    if (__builtin_cpu_supports("avx2")) {
        return bundle_lanes::eight;
    }
#endif
    return bundle_lanes::one;
}

namespace bundles {

inline constexpr std::uint32_t most_samples = 1u << 21; ///< in one go
inline constexpr std::uint32_t piece_samples = 4096;
inline constexpr std::uint32_t piece_triangles = 4096;
inline constexpr std::uint32_t spare = 32; ///< whole vectors may reach beyond an end

/// Plain functions by lanes.
template <class Visitor>
struct plain_lanes {
    using band_work = plain::band_work<Visitor>;
    static constexpr auto place_samples = plain::place_samples;
    static constexpr auto band_ranges = plain::band_ranges;
    static constexpr auto pick = plain::pick;
};
#if defined(SKYBARK_HAS_SIXTEEN)
struct sixteen_lanes {
    using band_work = sixteen::band_work;
    static constexpr auto place_samples = sixteen::place_samples;
    static constexpr auto band_ranges = sixteen::band_ranges;
    static constexpr auto pick = sixteen::pick;
};
#endif

[[nodiscard]] constexpr std::uint32_t pieces_of(std::size_t count, std::uint32_t each) {
    return static_cast<std::uint32_t>((count + each - 1) / each);
}

/// One batch of samples.
template <class Lanes, class Device>
class batch {
  public:
    batch(Device& device, bundle_scratch& scratch, const ray_bundle& bundle,
          std::span<const gather_triangle> triangles, std::span<const std::uint32_t> alpha,
          std::span<const gather_sample> samples, gather_hit* hits)
        : device_(&device), scratch_(&scratch), bundle_(bundle), triangles_(triangles),
          alpha_(alpha), samples_(samples), hits_(hits), grid_(&scratch.grid) {}

    /// False where there is no memory.
    [[nodiscard]] bool resolve() {
        *grid_ = make_grid(bundle_, samples_, triangles_.size());
        const std::uint32_t sample_pieces = pieces_of(samples_.size(), piece_samples);
        const std::uint32_t triangle_pieces = pieces_of(triangles_.size(), piece_triangles);
        const std::uint32_t workers = device_->workers();
        placed_ = scratch_->placed.room_for<placed_sample>(samples_.size() + spare);
        runs_ = scratch_->runs.room_for<std::uint32_t>(std::uint64_t{sample_pieces} *
                                                       (grid_->bands + 1));
        ranges_ = scratch_->ranges.room_for<band_range>(triangles_.size() + spare);
        const std::uint64_t spare_bytes =
            (piece_samples + spare) * (sizeof(placed_sample) + sizeof(std::uint32_t));
        auto* const first = scratch_->bands.room_for<std::byte>(workers * spare_bytes);
        if (placed_ == nullptr || runs_ == nullptr || ranges_ == nullptr || first == nullptr) {
            return false;
        }
        in_turns(workers, sample_pieces + triangle_pieces,
                 [&](std::uint32_t worker, std::uint32_t piece) {
                     if (piece < sample_pieces) {
                         place_piece(piece, first + worker * spare_bytes);
                     } else {
                         range_piece(piece - sample_pieces);
                     }
                 });
        return resolve_bands(workers, sample_pieces);
    }

  private:
    /// Gives each worker one piece after another.
    template <class Piece>
    void in_turns(std::uint32_t workers, std::uint32_t pieces, const Piece& piece) {
        std::atomic<std::uint32_t> next{0};
        device_->parallel(std::min(workers, pieces), [&](std::uint32_t worker) {
            for (std::uint32_t i = next++; i < pieces; i = next++) {
                piece(worker, i);
            }
        });
    }

    /// Places some samples and sorts them by bands, in place of each other.
    void place_piece(std::uint32_t piece, std::byte* memory) {
        auto* const placed = reinterpret_cast<placed_sample*>(memory);
        auto* const bands = reinterpret_cast<std::uint32_t*>(placed + piece_samples + spare);
        const std::uint32_t first = piece * piece_samples;
        const auto count = static_cast<std::uint32_t>(
            std::min<std::size_t>(piece_samples, samples_.size() - first));
        Lanes::place_samples(bundle_, *grid_, samples_.data(), first, count, placed, bands);
        std::uint32_t* const run = runs_ + std::size_t{piece} * (grid_->bands + 1);
        std::array<std::uint32_t, most_bands> at{};
        for (std::uint32_t i = 0; i < count; ++i) {
            ++at[bands[i]];
        }
        std::uint32_t sum = first;
        for (std::uint32_t band = 0; band < grid_->bands; ++band) {
            run[band] = sum;
            sum += at[band];
            at[band] = run[band];
        }
        run[grid_->bands] = sum;
        for (std::uint32_t i = 0; i < count; ++i) {
            placed_[at[bands[i]]++] = placed[i];
        }
    }

    void range_piece(std::uint32_t piece) {
        const std::uint32_t first = piece * piece_triangles;
        const auto count = static_cast<std::uint32_t>(
            std::min<std::size_t>(piece_triangles, triangles_.size() - first));
        Lanes::band_ranges(bundle_, *grid_, triangles_.data(), first, count, ranges_);
    }

    [[nodiscard]] bool resolve_bands(std::uint32_t workers, std::uint32_t sample_pieces) {
        std::uint64_t most_samples_of = 0;
        std::uint64_t most_cells = 0;
        for (std::uint32_t band = 0; band < grid_->bands; ++band) {
            std::uint64_t count = 0;
            for (std::uint32_t piece = 0; piece < sample_pieces; ++piece) {
                count += run_of(piece, band).size();
            }
            most_samples_of = std::max(most_samples_of, count);
            most_cells = std::max(most_cells, std::uint64_t{grid_->rows_of(band)} * grid_->columns);
        }
        // In words; multiples of a line of the cache.
        const std::uint64_t some = (most_samples_of + 2 * spare) / spare * spare;
        const std::uint64_t cells = (most_cells + 2 * spare) / spare * spare;
        const std::uint64_t words = 7 * some + cells;
        auto* const first = scratch_->bands.template room_for<std::uint32_t>(workers * words);
        if (first == nullptr) {
            return false;
        }
        in_turns(workers, grid_->bands, [&](std::uint32_t worker, std::uint32_t band) {
            std::uint32_t* const own = first + worker * words;
            band_memory memory;
            memory.cells = own;
            memory.numbers = own + some;
            memory.nearest = own + 2 * some;
            memory.places = reinterpret_cast<float*>(own + 3 * some);
            memory.depths = reinterpret_cast<float*>(own + 5 * some);
            memory.starts = own + 7 * some;
            resolve_band(band, sample_pieces, memory);
        });
        return true;
    }

    [[nodiscard]] std::span<const placed_sample> run_of(std::uint32_t piece,
                                                        std::uint32_t band) const {
        const std::uint32_t* const run = runs_ + std::size_t{piece} * (grid_->bands + 1) + band;
        return {placed_ + run[0], placed_ + run[1]};
    }

    void resolve_band(std::uint32_t band, std::uint32_t sample_pieces, const band_memory& memory) {
        typename Lanes::band_work work(bundle_, *grid_, band, triangles_, alpha_, memory);
        for (std::uint32_t piece = 0; piece < sample_pieces; ++piece) {
            work.add_cells(run_of(piece, band));
        }
        if (work.samples() == 0) {
            return;
        }
        sort_by_cells(band, sample_pieces, work.samples(), memory);
        constexpr std::uint32_t at_once = 512;
        constexpr std::uint32_t most = 1024;
        std::uint32_t numbers[most + spare];
        std::uint32_t waiting = 0;
        for (std::uint32_t t = 0; t < triangles_.size(); t += at_once) {
            const auto count =
                static_cast<std::uint32_t>(std::min<std::size_t>(at_once, triangles_.size() - t));
            const std::uint32_t found = Lanes::pick(ranges_, t, count, band, numbers + waiting);
            for (std::uint32_t i = waiting; i < waiting + found; ++i) {
                // A band's triangles may lie far apart, and on two lines of a cache each.
                detail::fetch(&triangles_[numbers[i]].a);
                detail::fetch(&triangles_[numbers[i]].reserved);
            }
            waiting += found;
            if (waiting > most - at_once) {
                work.meet(numbers, waiting);
                waiting = 0;
            }
        }
        work.meet(numbers, waiting);
        work.finish(hits_);
    }

    /// Sorts a band's samples by their cells.
    void sort_by_cells(std::uint32_t band, std::uint32_t sample_pieces, std::uint32_t samples,
                       const band_memory& memory) {
        const std::uint32_t cells = grid_->rows_of(band) * grid_->columns;
        // Counted two places on: while samples are placed, the starts move one place back.
        std::uint32_t* const counts = memory.starts;
        std::fill_n(counts, cells + 2, 0u);
        for (std::uint32_t i = 0; i < samples; ++i) {
            ++counts[memory.cells[i] + 2];
        }
        std::uint32_t sum = 0;
        for (std::uint32_t c = 0; c < cells + 2; ++c) {
            sum += counts[c];
            counts[c] = sum;
        }
        const std::uint32_t* cell = memory.cells;
        for (std::uint32_t piece = 0; piece < sample_pieces; ++piece) {
            for (const placed_sample& at : run_of(piece, band)) {
                const std::size_t k = counts[*cell++ + 1]++;
                memory.places[2 * k] = at.x;
                memory.places[2 * k + 1] = at.y;
                memory.depths[2 * k] = at.z;
                memory.depths[2 * k + 1] = (at.number & against) != 0 ? -no_distance : no_distance;
                memory.numbers[k] = at.number & ~against;
            }
        }
        std::fill_n(memory.nearest, samples, no_surface);
    }

    Device* device_;
    bundle_scratch* scratch_;
    ray_bundle bundle_;
    std::span<const gather_triangle> triangles_;
    std::span<const std::uint32_t> alpha_;
    std::span<const gather_sample> samples_;
    gather_hit* hits_;
    grid* grid_;
    placed_sample* placed_ = nullptr;
    std::uint32_t* runs_ = nullptr;
    band_range* ranges_ = nullptr;
};

} // namespace bundles

/// What each sample meets first along the bundle: see bundle_work in skybark/core/backend.hpp.
/// False where there is no memory.
template <class Device>
[[nodiscard]] bool resolve_bundle(Device& device, bundle_scratch& scratch, const ray_bundle& bundle,
                                  const bundle_work<Device>& work,
                                  bundle_lanes lanes = best_bundle_lanes()) {
    const auto triangles = records_of<Device, std::span<const gather_triangle>>(work.triangles);
    const auto alpha = records_of<Device, std::span<const std::uint32_t>>(work.alpha);
    const auto samples = records_of<Device, std::span<const gather_sample>>(work.samples);
    const auto hits = records_of<Device, std::span<gather_hit>>(work.hits);
    const std::size_t count = std::min(samples.size(), hits.size());
    bool done = true;
    for (std::size_t first = 0; first < count && done; first += bundles::most_samples) {
        const auto some =
            samples.subspan(first, std::min<std::size_t>(bundles::most_samples, count - first));
        const auto resolve = [&]<class Lanes>(Lanes) {
            return bundles::batch<Lanes, Device>(device, scratch, bundle, triangles, alpha, some,
                                                 hits.data() + first)
                .resolve();
        };
#if defined(SKYBARK_HAS_SIXTEEN)
        if (lanes == bundle_lanes::sixteen) {
            done = resolve(bundles::sixteen_lanes{});
            continue;
        }
#endif
#if defined(SKYBARK_BUNDLES_HAVE_EIGHT)
        if (lanes != bundle_lanes::one) {
            done = resolve(bundles::plain_lanes<bundles::plain::eight_at_a_time>{});
            continue;
        }
#endif
        done = resolve(bundles::plain_lanes<bundles::plain::one_at_a_time>{});
    }
    return done;
}

} // namespace skybark::cpu
