#pragma once
// bundle_peeler: what each sample meets first along a bundle of parallel rays, by depth peeling:
// the paper's way (Hachisuka 2005, GPU Gems 2, ch. 38), as the baseline of bundle_resolver.
//
// The scene is drawn along the bundle into a square picture, one layer of depth after another, from
// the far side to the near one: fragments that are nearer than the last layer, and of those the
// farthest. After each layer every sample looks at the pixel that it falls into, and takes what
// lies before it in place of what it had; the last one taken is the nearest. The paper keeps the
// layer's colour; here it is the triangle, so that its light is looked up once, at the end.
//
// Beyond the paper: one peel serves the samples that look against the bundle as well, which keep
// the first layer that lies before them; and what rises no farther above a sample's own plane than
// that plane rises within half a pixel does not count, or slopes would meet themselves.
//
// A sample's ray is off by up to half a pixel's diagonal: a few per cent of the hits are wrong at
// 1024 x 1024, and it falls like one over the side. Alpha maps are not looked at.

#include <skybark/core/backend.hpp>
#include <skybark/gather/bundle.hpp>
#include <skybark/kernels/bundle_corner.hpp>
#include <skybark/kernels/layer_hits.hpp>

#include <cassert>
#include <vector>

namespace skybark::gather {

struct peeler_options {
    std::uint32_t size = 1024;        ///< pixels on a side of the picture
    std::uint32_t layers = 8;         ///< in one recording
    std::uint32_t most_layers = 4096; ///< after so many `resolve` gives up, with an error
};

template <class B>
concept resolves_peeled = peels<B, kernels::bundle_corner> && maps<B, kernels::layer_hits>;

template <resolves_peeled B>
class bundle_peeler {
  public:
    /// Bytes of device memory that `create` takes.
    [[nodiscard]] static std::uint64_t required_bytes(const peeler_options& options = {}) {
        return 3 * (std::uint64_t{options.size} * options.size * 4) + sizeof(count_record);
    }

    /// Errors: memory; a picture that the device's images or views do not hold.
    [[nodiscard]] static result<bundle_peeler> create(B& device,
                                                      const peeler_options& options = {}) {
        const std::uint64_t bytes = std::uint64_t{options.size} * options.size * 4;
        const device_limits limits = device.limits();
        if (options.size == 0 || options.size > limits.max_image_size ||
            bytes > limits.max_buffer_bytes || options.layers == 0) {
            return fail(error_code::bad_input,
                        "Peeling in pictures of " + std::to_string(options.size) +
                            " pixels on a side, " + std::to_string(options.layers) +
                            " layers at once, was asked for; expected one layer at least, and "
                            "pictures from 1 to " +
                            std::to_string(limits.max_image_size) + " pixels and up to " +
                            std::to_string(limits.max_buffer_bytes) + " bytes.");
        }
        const std::vector<float> farthest(std::size_t{options.size} * options.size, 1.0f);
        auto clear = make_buffer<B, float>(device, farthest);
        auto depth = device.create_buffer(bytes);
        auto triangle = device.create_buffer(bytes);
        auto count = device.create_buffer(sizeof(count_record));
        for (const auto* buffer : {&clear, &depth, &triangle, &count}) {
            if (!*buffer) {
                return failure(buffer->error());
            }
        }
        bundle_peeler made(device, options);
        made.clear_.emplace(std::move(*clear));
        made.depth_.emplace(std::move(*depth));
        made.triangle_.emplace(std::move(*triangle));
        made.count_.emplace(std::move(*count));
        return made;
    }

    /// A bundle for this. It is the resolver's, without its grids.
    [[nodiscard]] static ray_bundle bundle(const bounds& box, glm::dvec3 axis, float lift) {
        return make_bundle(box, axis, 1, lift);
    }

    /// Records the first `options.layers` layers (`fresh`), or as many more; `work.hits` is right
    /// once `remaining` says false. `box` holds the scene.
    void record(typename B::recorder& recorder, const ray_bundle& bundle, const bounds& box,
                const bundle_work<B>& work, bool fresh) {
        const auto triangles =
            static_cast<std::uint32_t>(work.triangles.size / sizeof(gather_triangle));
        const auto samples = static_cast<std::uint32_t>(work.samples.size / sizeof(gather_sample));
        const float reach = std::max(0.5f * box.diagonal(), bundle.centre.w);
        const peeled_layer<B> layer{options_.size, options_.size, view<B>(*depth_),
                                    view<B>(*triangle_), view<B>(*count_)};
        if (fresh) {
            recorder.copy(view<B>(*clear_), layer.depth);
        }
        for (std::uint32_t i = 0; i < options_.layers; ++i) {
            recorder.peel(kernels::bundle_corner{bundle, reach}, {work.triangles},
                          range{0, triangles}, layer);
            recorder.map(
                kernels::layer_hits{bundle, reach, options_.size, fresh && i == 0 ? 1u : 0u},
                {work.samples, layer.depth, layer.triangle, work.triangles, work.hits, work.hits},
                range{0, samples});
        }
    }

    /// Whether the last layer recorded drew anything, so that there may be more.
    [[nodiscard]] result<bool> remaining() {
        count_record count;
        if (auto done = device_->download(*count_, 0, writable_bytes_of_one(count)); !done) {
            return failure(done.error());
        }
        return count.written != 0;
    }

    /// All layers: records, submits and waits until one is empty. Returns how many were drawn, a
    /// multiple of `options.layers`.
    [[nodiscard]] result<std::uint32_t> resolve(const ray_bundle& bundle, const bounds& box,
                                                const bundle_work<B>& work) {
        for (std::uint32_t layers = 0; layers < options_.most_layers; layers += options_.layers) {
            auto done = run(*device_, [&](auto& recorder) {
                record(recorder, bundle, box, work, layers == 0);
            });
            if (!done) {
                return failure(done.error());
            }
            const auto more = remaining();
            if (!more) {
                return failure(more.error());
            }
            if (!*more) {
                return layers + options_.layers;
            }
        }
        return fail(error_code::bad_input, "A scene has more than " +
                                               std::to_string(options_.most_layers) +
                                               " layers of depth in one pixel; expected fewer.");
    }

  private:
    bundle_peeler(B& device, const peeler_options& options) : device_(&device), options_(options) {}

    B* device_;
    peeler_options options_;
    std::optional<typename B::buffer> clear_; ///< ones
    std::optional<typename B::buffer> depth_;
    std::optional<typename B::buffer> triangle_;
    std::optional<typename B::buffer> count_;
};

} // namespace skybark::gather
