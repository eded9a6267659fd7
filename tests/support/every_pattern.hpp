#pragma once
// Every pattern of a device once, with the kernels that test backends, and what came of them.

#include <skybark/core/backend.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_peel.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>
#include <skybark/kernels/probe_voxels.hpp>

#include <array>
#include <gtest/gtest.h>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace skybark::support {

/// The zones that recording them all has.
[[nodiscard]] inline std::set<std::string> every_patterns_name() {
    return {"upload",
            "copy",
            "map probe_map",
            "expand probe_strips",
            "expand_rings probe_rings",
            "accumulate probe_slabs",
            "map_voxels probe_voxels",
            "draw probe_surface",
            "peel probe_peel",
            "resolve",
            "scan",
            "scan volume",
            "sort"};
}

template <class B>
class every_pattern {
  public:
    explicit every_pattern(B& device) : device_(&device) {
        std::vector<std::uint32_t> numbers(count);
        std::vector<glm::vec4> vectors(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            numbers[i] = i * 2654435761u >> 29; // 0 … 7
            vectors[i] = glm::vec4(static_cast<float>(i % 5) * 0.25f, 0.5f, 1, 1);
        }
        buffers_[numbers_in] = made<std::uint32_t>(numbers);
        buffers_[vectors_in] = made<glm::vec4>(vectors);
        buffers_[boxes_in] = made<kernels::probe_box>({{{0, 1, 0, 3}, {5, 4, 3, 1}}});
        buffers_[corners_in] = made<kernels::probe_vertex>({{{-1, -1, 0.5f, 1}, {1, 0, 0, 1}},
                                                            {{3, -1, 0.5f, 1}, {0, 1, 0, 1}},
                                                            {{-1, 3, 0.5f, 1}, {}}});
        buffers_[peel_in] =
            made<glm::vec4>({{-1, -1, 0.25f, 0}, {1, -1, 0.25f, 0}, {1, 1, 0.25f, 0}});
        gather_triangle triangle;
        triangle.a = {-0.5f, -0.5f, 0};
        triangle.b = {0.5f, -0.5f, 0};
        triangle.c = {0, 0.5f, 0};
        buffers_[triangles_in] = made<gather_triangle>({triangle});
        gather_sample sample;
        sample.position = {0, 0, -0.5f};
        sample.normal = {0, 0, 1};
        buffers_[samples_in] = made<gather_sample>({sample});
        buffers_[length_in] = made<count_record>({{50, 50, {0, 0}}});
        for (std::size_t i = first_out; i < slots; ++i) {
            buffers_[i] = must(device.create_buffer(out_bytes));
        }
        buffers_[far_out] = made<float>(std::vector<float>(out_bytes / 4, 1.0f));
        const volume_format formats[] = {volume_format::int32, volume_format::float32,
                                         volume_format::float32, volume_format::float32};
        for (const volume_format format : formats) {
            volumes_.push_back(must(device.create_volume({6, 5, 4, format})));
        }
        images_.push_back(must(device.create_image({8, 8, image_format::rgba8})));
        images_.push_back(must(device.create_image({8, 8, image_format::depth32f})));
    }

    void record(typename B::recorder& r) const {
        using namespace kernels;
        const std::array<std::uint32_t, 4> words{4, 3, 2, 1};
        r.upload(part(keys_out, 16), std::as_bytes(std::span(words)));
        r.copy(part(numbers_in), part(values_out));
        r.map(probe_map{3, 1, 2, 0.5f},
              {part(numbers_in), part(vectors_in), part(keys_out), part(vectors_out)},
              range{0, count});
        const std::array<range, 2> ranges{range{0, 7}, range{7, 20}};
        r.map(probe_map{3, 1, 2, 0.5f},
              {part(numbers_in), part(vectors_in), part(keys_out), part(vectors_out)}, ranges);
        r.map(probe_map{5, 1, 2, 0.5f},
              {part(numbers_in), part(vectors_in), part(keys_out), part(vectors_out)},
              counted<B>{part(length_in), count});
        for (const padding policy : {padding::compact, padding::degenerate}) {
            r.expand(
                probe_strips{1, 7}, {part(numbers_in), part(vectors_in)}, range{0, count},
                {part(policy == padding::compact ? list_out : spare_out), part(count_out), policy});
        }
        r.expand_rings(probe_rings{5}, {part(vectors_in)}, range{0, count}, part(rings_out));
        r.accumulate(probe_slabs{3, 1, 2, 3}, {part(boxes_in)}, range{0, 1},
                     accumulation<B>{&volumes_[0], true});
        r.scan(volumes_[0], volumes_[1],
               volume_scan{scan_axis::y, scan_direction::descending, scan_share::whole, 1});
        r.scan(volumes_[0], volumes_[2], volume_scan{});
        r.map_voxels(probe_voxels{6, 5, 0.25f}, {part(vectors_in), part(voxels_out)},
                     {{&volumes_[1], &volumes_[1]}, {&volumes_[2], &volumes_[3]}}, {6, 5, 4});
        r.draw(probe_surface{}, {part(corners_in), part(vectors_in)}, {},
               draw_geometry<B>{{}, 0, 3, 0, {}},
               draw_target<B>{&images_[0], &images_[1], glm::vec4(0), 1.0f}, draw_state{});
        r.peel(probe_peel{}, {part(peel_in)}, range{0, 1},
               peeled_layer<B>{8, 8, part(far_out, 256), part(number_out, 256),
                               part(peel_count_out, 16)});
        ray_bundle bundle;
        bundle.centre = {0, 0, 0, 1};
        bundle.right = {1, 0, 0, 0};
        bundle.up = {0, 1, 0, 64};
        bundle.direction = {0, 0, 1, 128};
        r.resolve(bundle, {part(triangles_in), {}, part(samples_in), part(hits_out, 16)});
        r.scan(part(values_out), part(total_out, 4));
        r.sort(part(keys_out, count * 4), part(sorted_out, count * 4));
    }

    /// All bytes that were written.
    [[nodiscard]] std::vector<std::byte> results() const {
        std::vector<std::byte> all;
        const auto add = [&](const auto& from, std::uint64_t bytes, auto&& get) {
            std::vector<std::byte> some(bytes);
            const auto done = get(from, std::span<std::byte>(some));
            EXPECT_TRUE(done) << done.error().message;
            all.insert(all.end(), some.begin(), some.end());
        };
        for (std::size_t i = first_out; i < slots; ++i) {
            add(*buffers_[i], out_bytes, [&](const auto& from, std::span<std::byte> to) {
                return device_->download(from, 0, to);
            });
        }
        for (const auto& one : volumes_) {
            add(one, one.description().size_bytes(),
                [&](const auto& from, std::span<std::byte> to) {
                    return device_->download(from, to);
                });
        }
        for (const auto& one : images_) {
            add(one, 8 * 8 * 4, [&](const auto& from, std::span<std::byte> to) {
                return device_->download(from, to);
            });
        }
        return all;
    }

  private:
    static constexpr std::uint32_t count = 64;
    static constexpr std::uint64_t out_bytes = 64 * 7 * 3 * 32;
    enum slot : std::size_t {
        numbers_in,
        vectors_in,
        boxes_in,
        corners_in,
        peel_in,
        triangles_in,
        samples_in,
        length_in,
        keys_out,
        values_out,
        vectors_out,
        list_out,
        spare_out,
        count_out,
        rings_out,
        voxels_out,
        far_out,
        number_out,
        peel_count_out,
        hits_out,
        total_out,
        sorted_out,
        slots,
        first_out = keys_out,
    };

    template <class T>
    [[nodiscard]] static T must(result<T> made) {
        EXPECT_TRUE(made) << made.error().message;
        return std::move(*made);
    }
    template <class T>
    [[nodiscard]] std::optional<typename B::buffer> made(const std::vector<T>& records) const {
        return must(make_buffer<B, T>(*device_, std::span<const T>(records)));
    }
    [[nodiscard]] buffer_view<B> part(slot which, std::uint64_t bytes = 0) const {
        const auto& whole = *buffers_[which];
        return {&whole, 0, bytes != 0 ? bytes : whole.size_bytes()};
    }

    B* device_;
    std::array<std::optional<typename B::buffer>, slots> buffers_;
    std::vector<typename B::volume> volumes_;
    std::vector<typename B::image> images_;
};

/// Makes all, records it twice, and returns what came of it.
template <class B>
[[nodiscard]] std::vector<std::byte> run_every_pattern(B& device) {
    const every_pattern<B> all(device);
    for (int twice = 0; twice < 2; ++twice) {
        const auto done = run(device, [&](auto& r) { all.record(r); });
        EXPECT_TRUE(done) << done.error().message;
    }
    return all.results();
}

} // namespace skybark::support
