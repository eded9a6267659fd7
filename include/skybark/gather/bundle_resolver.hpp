#pragma once
// bundle_resolver: what each sample meets first along a bundle of parallel rays, exact at the
// sample's own place.
//
// Hachisuka 2005 ("High-Quality Global Illumination Rendering Using Rasterization", GPU Gems 2,
// ch. 38) takes one direction for all samples at once and looks each one up in a raster of the
// scene. A raster's pixel is not the sample's place: rays are displaced by up to half a pixel's
// diagonal, and on slopes they meet their own surface. Here the triangles are sorted into cells
// across the direction, and each sample is tested against those around it at its own (x, y), with
// edge functions that are exactly opposite in two triangles that share an edge: no ray slips
// through, and no resolution limits the result. Samples with normal · direction ≥ 0 look along the
// bundle, the others against it, so that one pass serves both.
//
//     map bundle_key      the cell of each triangle, in a hierarchy of grids
//     sort                by cell
//     map bundle_order    the triangles' corners across the bundle, in that order; runs of cells
//     map bundle_count, scan      where each cell begins
//     map bundle_hits     each sample against the triangles of its cell and the eight around it, of
//                         each grid
//
// A triangle lies in one cell only, so that memory is bounded, and nothing is built beforehand:
// triangles may be others for each bundle.
//
// A shader may run 65,535 turns of its loops in all (llvmpipe ends them silently there): a pass
// looks at `turns` triangles a sample, and further passes, which nearly always have no sample, take
// the rest.
//
// Where the backend resolves bundles itself (resolves_bundles), it does; the bits are the same.

#include <skybark/core/backend.hpp>
#include <skybark/gather/bundle.hpp>
#include <skybark/kernels/bundle_count.hpp>
#include <skybark/kernels/bundle_crowds.hpp>
#include <skybark/kernels/bundle_hits.hpp>
#include <skybark/kernels/bundle_key.hpp>
#include <skybark/kernels/bundle_more.hpp>
#include <skybark/kernels/bundle_order.hpp>

#include <cassert>
#include <vector>

namespace skybark::gather {

enum class resolve_route {
    fastest,  ///< the backend's own way, where it has one
    composed, ///< of the patterns, everywhere
};

struct resolver_options {
    std::uint32_t cells = 0; ///< on a side of the finest grid, a power of two up to 2048; 0: chosen
    resolve_route route = resolve_route::fastest;
    std::uint32_t turns = 60000; ///< triangles that a sample looks at in a pass, ≥ 1000
};

template <class B>
concept resolves_composed =
    sorts<B> && scans<B> && maps<B, kernels::bundle_key> && maps<B, kernels::bundle_order> &&
    maps<B, kernels::bundle_count> && maps<B, kernels::bundle_crowds> &&
    maps<B, kernels::bundle_more> && maps<B, kernels::bundle_hits>;

template <resolves_composed B>
class bundle_resolver {
  public:
    /// Bytes of device memory that `create` takes.
    [[nodiscard]] static std::uint64_t required_bytes(std::uint64_t triangles,
                                                      const resolver_options& options = {}) {
        if (fused(options)) {
            return 16;
        }
        const std::uint64_t cells = cells_of(triangles, options);
        return sizes_of(triangles, bundle_cell_count(static_cast<std::uint32_t>(cells)) + 1,
                        options)
            .all();
    }

    /// For up to `most_triangles`. Errors: memory; more than the device's views hold
    /// (limits().max_buffer_bytes / 48).
    [[nodiscard]] static result<bundle_resolver> create(B& device, std::uint64_t most_triangles,
                                                        const resolver_options& options = {}) {
        assert(options.turns >= 1000 && std::has_single_bit(std::max(options.cells, 1u)) &&
               options.cells <= 2048);
        const std::uint64_t most = std::min<std::uint64_t>(
            device.limits().max_buffer_bytes / sizeof(gather_triangle), most_supported);
        if (most_triangles > most) {
            return fail(error_code::out_of_memory,
                        "A bundle of rays through " + std::to_string(most_triangles) +
                            " triangles was asked for; this device takes " + std::to_string(most) +
                            " at most.");
        }
        bundle_resolver made(options, cells_of(most_triangles, options));
        if (fused(options)) {
            return made;
        }
        const sizes bytes = sizes_of(most_triangles, bundle_cell_count(made.cells_) + 1, options);
        for (const auto& [slot, size] :
             {std::pair{&made.keys_, bytes.words}, std::pair{&made.numbers_, bytes.words},
              std::pair{&made.corners_, bytes.corners}, std::pair{&made.runs_, bytes.runs},
              std::pair{&made.no_runs_, bytes.runs}, std::pair{&made.starts_, bytes.starts},
              std::pair{&made.crowds_, bytes.crowds}, std::pair{&made.total_, bytes.word},
              std::pair{&made.more_, bytes.word}, std::pair{&made.no_alpha_, bytes.word}}) {
            auto buffer = device.create_buffer(size);
            if (!buffer) {
                return failure(buffer.error());
            }
            slot->emplace(std::move(*buffer));
        }
        return made;
    }

    /// Cells on a side of the finest grid.
    [[nodiscard]] std::uint32_t cells() const noexcept { return cells_; }

    /// A bundle that this resolver can resolve.
    [[nodiscard]] ray_bundle bundle(const bounds& box, glm::dvec3 axis, float lift) const {
        return make_bundle(box, axis, cells_, lift);
    }

    /// Records both of the below. `work.hits` has a gather_hit for each gather_sample of
    /// `work.samples`.
    void record(typename B::recorder& recorder, const ray_bundle& bundle,
                const bundle_work<B>& work) {
        record_triangles(recorder, bundle, work.triangles);
        record_samples(recorder, bundle, work);
    }

    /// Sorts the triangles for a bundle …
    void record_triangles(typename B::recorder& recorder, const ray_bundle& bundle,
                          const buffer_view<B>& triangles) {
        if (fused(options_)) {
            return;
        }
        const auto count = static_cast<std::uint32_t>(triangles.size / sizeof(gather_triangle));
        const auto cells = static_cast<std::uint32_t>(bundle_cell_count(cells_));
        assert(bundle.direction.w == static_cast<float>(cells_));
        const auto runs = view<B>(*runs_);
        const auto starts = view<B, std::uint32_t>(*starts_, 0, cells + 1);
        recorder.copy(view<B>(*no_runs_), runs);
        if (count != 0) {
            const auto keys = view<B, std::uint32_t>(*keys_, 0, count);
            const auto numbers = view<B, std::uint32_t>(*numbers_, 0, count);
            recorder.map(kernels::bundle_key{bundle}, {triangles, keys, numbers}, range{0, count});
            recorder.sort(keys, numbers, key_bits_of(cells));
            recorder.map(kernels::bundle_order{bundle, count},
                         {triangles, keys, numbers, view<B>(*corners_), runs}, range{0, count});
        }
        recorder.map(kernels::bundle_count{}, {runs, starts}, range{0, cells + 1});
        recorder.scan(starts, view<B>(*total_));
    }

    /// … and looks each sample up in them: as often as there are samples, in parts or in all.
    void record_samples(typename B::recorder& recorder, const ray_bundle& bundle,
                        const bundle_work<B>& work) {
        if constexpr (resolves_bundles<B>) {
            if (options_.route == resolve_route::fastest) {
                recorder.resolve(bundle, work);
                return;
            }
        }
        const auto count =
            static_cast<std::uint32_t>(work.triangles.size / sizeof(gather_triangle));
        const auto samples = static_cast<std::uint32_t>(work.samples.size / sizeof(gather_sample));
        const auto alpha = work.alpha ? work.alpha : view<B>(*no_alpha_);
        const bindings<B, kernels::bundle_hits> buffers{
            work.samples, view<B>(*corners_), view<B>(*starts_), alpha, work.hits, work.hits};
        kernels::bundle_hits pass{bundle, 0, options_.turns};
        recorder.map(pass, buffers, range{0, samples});
        const std::uint32_t stride = stride_of(options_);
        if (count <= options_.turns) {
            return;
        }
        recorder.map(kernels::bundle_crowds{stride},
                     {view<B, std::uint32_t>(*keys_, 0, count), view<B>(*crowds_)},
                     range{0, count / stride});
        recorder.scan(view<B, std::uint32_t>(*crowds_, 0, count / stride), view<B>(*total_));
        recorder.map(kernels::bundle_more{samples}, {view<B>(*total_), view<B>(*more_)},
                     range{0, 1});
        while (count - pass.first > options_.turns) {
            pass.first += options_.turns;
            recorder.map(pass, buffers, counted<B>{view<B>(*more_), samples});
        }
    }

  private:
    /// Surfaces are numbered by 2 · triangle + side in 32 bits, all of them but one.
    static constexpr std::uint64_t most_supported = 0x7fffffff;
    /// Nine cells of each of up to twelve grids surround a sample. Where each has less than twice
    /// as many triangles as this, one pass sees them all.
    [[nodiscard]] static constexpr std::uint32_t stride_of(const resolver_options& options) {
        return std::max(options.turns / (2 * 9 * 12), 2u);
    }

    [[nodiscard]] static constexpr std::uint32_t key_bits_of(std::uint32_t cells) {
        return std::max(static_cast<std::uint32_t>(std::bit_width(cells - 1)), 1u);
    }

    [[nodiscard]] static constexpr bool fused(const resolver_options& options) {
        return resolves_bundles<B> && options.route == resolve_route::fastest;
    }

    [[nodiscard]] static std::uint32_t cells_of(std::uint64_t triangles,
                                                const resolver_options& options) {
        return options.cells != 0 ? options.cells : default_cells(triangles);
    }

    struct sizes {
        std::uint64_t words, corners, runs, starts, crowds, word;
        [[nodiscard]] std::uint64_t all() const {
            return 2 * words + corners + 2 * runs + starts + crowds + 3 * word;
        }
    };
    [[nodiscard]] static sizes sizes_of(std::uint64_t triangles, std::uint64_t cells,
                                        const resolver_options& options) {
        const std::uint64_t some = std::max<std::uint64_t>(triangles, 1);
        return {some * 4, some * 48, cells * 8, cells * 4, (some / stride_of(options) + 1) * 4, 16};
    }

    bundle_resolver(const resolver_options& options, std::uint32_t cells)
        : options_(options), cells_(cells) {}

    resolver_options options_;
    std::uint32_t cells_;
    std::optional<typename B::buffer> keys_;
    std::optional<typename B::buffer> numbers_;
    std::optional<typename B::buffer> corners_;
    std::optional<typename B::buffer> runs_;
    std::optional<typename B::buffer> no_runs_; ///< zeros
    std::optional<typename B::buffer> starts_;
    std::optional<typename B::buffer> crowds_;
    std::optional<typename B::buffer> total_;
    std::optional<typename B::buffer> more_;
    std::optional<typename B::buffer> no_alpha_;
};

} // namespace skybark::gather
