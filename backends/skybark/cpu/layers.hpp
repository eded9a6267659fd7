#pragma once
// Accumulation on the CPU: layer by layer.
//
// The slabs of many elements are put into bins, a bin a layer of constant z, by a counting sort;
// then each layer is one task, so that no two threads add to one voxel and a layer stays in a
// core's cache. Sums are whole numbers: their bits do not depend on the order.

#include <skybark/cpu/memory.hpp>
#include <skybark/cpu/program.hpp>
#include <skybark/cpu/volume_scan.hpp>

#include <atomic>

namespace skybark::cpu {

/// Memory that accumulations use again.
struct layer_scratch {
    const detail::memory_source* source = nullptr;
    detail::scratch_memory counts{
        source}; ///< slabs of a piece of the elements in a layer, later offsets
    detail::scratch_memory slabs{source};  ///< by layer
    detail::scratch_memory parts{source};  ///< what slabs have in common
    detail::scratch_memory planes{source}; ///< a layer for each thread
};

/// The slabs of a batch of elements, by layer.
template <slab_kernel K, class... Spans>
class slab_bins {
  public:
    slab_bins(const K& kernel, Spans... spans) : kernel_(&kernel), spans_(spans...) {}

    /// The longest batch whose slabs are sure to take no more than 32 MiB.
    [[nodiscard]] std::uint32_t batch() const {
        constexpr std::uint32_t most_slabs = 1u << 22;
        return std::max(1u, most_slabs / std::max(1u, kernel_->slabs()));
    }

    /// False where there is no memory.
    template <class Device>
    [[nodiscard]] bool fill(Device& device, layer_scratch& scratch, range elements,
                            const volume_description& what) {
        const std::uint32_t layers = what.depth;
        layers_ = layers;
        const std::uint32_t pieces =
            std::clamp(elements.count / least_of_piece, std::uint32_t{1}, most_pieces);
        offsets_ = scratch.counts.room_for<std::uint32_t>(std::uint64_t{pieces} * layers);
        if (offsets_ == nullptr) {
            return false;
        }
        std::fill_n(offsets_, std::uint64_t{pieces} * layers, 0u);
        const auto piece_of = [&](std::uint32_t piece) {
            const auto start = [&](std::uint32_t p) {
                return static_cast<std::uint32_t>(std::uint64_t{elements.count} * p / pieces);
            };
            return range{elements.first + start(piece), start(piece + 1) - start(piece)};
        };
        device.parallel(pieces, [&](std::uint32_t piece) {
            for_slabs(piece_of(piece), [&](std::uint32_t layer, const program_slab&) {
                ++offsets_[std::uint64_t{piece} * layers + layer];
            });
        });
        std::uint32_t sum = 0;
        for (std::uint32_t layer = 0; layer < layers; ++layer) {
            for (std::uint32_t piece = 0; piece < pieces; ++piece) {
                std::uint32_t& place = offsets_[std::uint64_t{piece} * layers + layer];
                const std::uint32_t count = place;
                place = sum;
                sum += count;
            }
        }
        slabs_ = scratch.slabs.room_for<program_slab>(sum);
        if (slabs_ == nullptr) {
            return false;
        }
        device.parallel(pieces, [&](std::uint32_t piece) {
            for_slabs(piece_of(piece), [&](std::uint32_t layer, const program_slab& slab) {
                slabs_[offsets_[std::uint64_t{piece} * layers + layer]++] = slab;
            });
        });
        // The last piece's offsets have moved on to where the bins end.
        ends_ = offsets_ + std::uint64_t{pieces - 1} * layers;
        return true;
    }

    /// Adds what the batch has in layer z to it.
    void add(std::uint32_t z, const layer_sums& to) const {
        const std::uint32_t first = z == 0 ? 0 : ends_[z - 1];
        const std::uint32_t last = ends_[z];
        std::apply(
            [&](auto... spans) {
                for (std::uint32_t i = first; i < last; ++i) {
                    program<K>::add_slab(*kernel_, slabs_[i].element, slabs_[i].slab, to, spans...);
                }
            },
            spans_);
    }

  private:
    static constexpr std::uint32_t most_pieces = 16;
    static constexpr std::uint32_t least_of_piece = 256;

    struct program_slab {
        std::uint32_t element;
        std::uint32_t slab;
    };

    template <class Work>
    void for_slabs(range elements, Work&& work) const {
        std::apply(
            [&](auto... spans) {
                for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
                    const std::uint32_t count =
                        std::min(kernel_->slab_count(i, spans...), kernel_->slabs());
                    for (std::uint32_t s = 0; s < count; ++s) {
                        const std::int32_t z = kernel_->slab(i, s, spans...).slice;
                        if (z >= 0 && static_cast<std::uint32_t>(z) < layers_) {
                            work(static_cast<std::uint32_t>(z), program_slab{i, s});
                        }
                    }
                }
            },
            spans_);
    }

    const K* kernel_;
    std::tuple<Spans...> spans_;
    std::uint32_t layers_ = 0;
    std::uint32_t* offsets_ = nullptr;
    const std::uint32_t* ends_ = nullptr;
    program_slab* slabs_ = nullptr;
};

template <slab_kernel K, class... Spans>
struct bins_of {
    using type = slab_bins<K, Spans...>;
};
template <slab_kernel K, class... Spans>
requires requires { typename program<K>::bins; }
struct bins_of<K, Spans...> {
    using type = typename program<K>::bins;
};

/// Adds the elements to a volume of int32; from zero, if so asked. False where there is no memory.
template <class Device, class Bins>
[[nodiscard]] bool accumulate_layers(Device& device, layer_scratch& scratch, Bins& bins,
                                     range elements, const volume& into, bool clear) {
    const volume_description what = into.description();
    const std::uint64_t layer = std::uint64_t{what.width} * what.height;
    auto* const sums = reinterpret_cast<std::int32_t*>(into.data());
    std::uint32_t done = 0;
    do {
        const range batch{elements.first + done, std::min(bins.batch(), elements.count - done)};
        if (!bins.fill(device, scratch, batch, what)) {
            return false;
        }
        device.for_pieces(what.depth, 1, [&](std::uint64_t first, std::uint64_t count) {
            for (std::uint64_t z = first; z < first + count; ++z) {
                const layer_sums to{sums + z * layer, what.width, what.height, what.width};
                if (clear && done == 0) {
                    std::fill_n(to.sums, layer, 0);
                }
                bins.add(static_cast<std::uint32_t>(z), to);
            }
        });
        done += batch.count;
    } while (done < elements.count);
    return true;
}

/// The same from zero, and its scan along y, a layer at a time in a core's cache. The elements are
/// one batch. False where there is no memory.
template <class Device, class Bins>
[[nodiscard]] bool accumulate_and_scan_layers(Device& device, layer_scratch& scratch, Bins& bins,
                                              range elements, const volume& to,
                                              const volume_scan& how) {
    const volume_description what = to.description();
    const std::uint64_t layer = std::uint64_t{what.width} * what.height;
    // Whole lines of the cache, which threads do not share, and no power of two from row to row,
    // which would put a column into few of the cache's sets.
    const std::uint32_t stride = (what.width + 15) / 16 * 16 + 16;
    const std::uint64_t plane = std::uint64_t{stride} * what.height;
    const std::uint32_t workers = std::min(device.workers(), what.depth);
    auto* const planes = scratch.planes.room_for<std::int32_t>(plane * workers);
    if (planes == nullptr || !bins.fill(device, scratch, elements, what)) {
        return false;
    }
    const sums::summer sum = sums::summer_of_int32<true>(what.format, how.share);
    if (sum.down == nullptr) {
        return true;
    }
    const std::uint64_t layer_bytes = layer * bytes_per_voxel(what.format);
    std::atomic<std::uint32_t> next{0};
    device.parallel(workers, [&](std::uint32_t worker) {
        const layer_sums own{planes + worker * plane, what.width, what.height, stride};
        std::fill_n(own.sums, plane, 0);
        for (std::uint32_t z = next++; z < what.depth; z = next++) {
            bins.add(z, own);
            sum.down({reinterpret_cast<std::byte*>(own.sums), to.data() + z * layer_bytes, stride,
                      what.width, what.height, what.width},
                     how);
        }
    });
    return true;
}

} // namespace skybark::cpu
