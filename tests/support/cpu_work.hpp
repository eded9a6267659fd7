#pragma once
// Work for a CPU device that touches every pattern, as bytes to compare.

#include <skybark/cpu/cpu.hpp>
#include <skybark/kernels/branch_cap.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>
#include <skybark/kernels/unit_polygon.hpp>

#include "support/random.hpp"

#include <stdexcept>

namespace skybark::support {

using bytes = std::vector<std::byte>;

template <class T>
[[nodiscard]] T expect_value(result<T> from) {
    if (!from) {
        throw std::runtime_error(from.error().message);
    }
    return *std::move(from);
}

/// Every pattern of a CPU device once, on random input that is the same each time.
class cpu_work {
  public:
    static constexpr std::uint32_t elements = 5000;
    static constexpr std::uint32_t strips = 3;
    static constexpr std::uint32_t most = 4;
    static constexpr std::uint32_t corners = 90'000; ///< more triangles than the guard of a batch
    static constexpr std::uint32_t side = 150;

    explicit cpu_work(cpu::device& device) : device_(&device), random_(7) {
        make_maps();
        make_strips();
        make_branches();
        make_draw();
    }

    /// Records everything and returns without reading back.
    void run() {
        auto r = expect_value(device_->begin());
        record(r);
        if (auto done = device_->submit(r); !done) {
            throw std::runtime_error(done.error().message);
        }
    }

    /// What all patterns wrote.
    [[nodiscard]] std::vector<bytes> output() const {
        std::vector<bytes> all;
        for (const cpu::buffer* b : {&numbers_out_, &vectors_out_, &levels_, &list_[0], &list_[1],
                                     &count_[0], &count_[1], &rings_, &branches_, &caps_out_}) {
            all.emplace_back(b->data(), b->data() + b->size_bytes());
        }
        for (const cpu::image* i : {&color_, &depth_}) {
            all.emplace_back(i->data(), i->data() + i->size_bytes());
        }
        return all;
    }

  private:
    template <class T>
    [[nodiscard]] cpu::buffer put(const std::vector<T>& records) {
        return expect_value(make_buffer<cpu::device, T>(*device_, records));
    }
    template <class T>
    [[nodiscard]] cpu::buffer room(std::size_t count) {
        return expect_value(device_->create_buffer(count * sizeof(T)));
    }
    [[nodiscard]] float unit() { return static_cast<float>(random_.between(-1, 1)); }
    [[nodiscard]] glm::vec4 vector() { return {unit(), unit(), unit(), unit()}; }
    [[nodiscard]] static buffer_view<cpu::device> all_of(const cpu::buffer& b) {
        return view<cpu::device>(b);
    }

    void make_maps() {
        std::vector<std::uint32_t> numbers(elements);
        std::vector<glm::vec4> vectors(elements);
        std::vector<kernels::probe_node> nodes(elements);
        for (std::uint32_t i = 0; i < elements; ++i) {
            numbers[i] = random_.bits();
            vectors[i] = vector();
            nodes[i] = {i < 100 ? i : random_.below(i < 2000 ? 100 : 2000), random_.below(10)};
        }
        numbers_ = put(numbers);
        vectors_ = put(vectors);
        nodes_ = put(nodes);
        numbers_out_ = room<std::uint32_t>(elements);
        vectors_out_ = room<glm::vec4>(elements);
        levels_ = room<std::uint32_t>(elements);
    }

    void make_strips() {
        std::vector<std::uint32_t> counts(elements * strips);
        for (std::uint32_t& count : counts) {
            count = random_.below(most + 1);
        }
        counts_ = put(counts);
        for (int i = 0; i < 2; ++i) {
            list_[i] = room<kernels::probe_strip_vertex>(std::size_t{3} * elements * strips * most);
            count_[i] = room<count_record>(1);
        }
        rings_ = room<kernels::probe_ring_vertex>(elements * 5);
    }

    void make_branches() {
        std::vector<branch_end> ends(elements + 1);
        std::vector<branch_segment> segments(elements);
        std::vector<std::uint32_t> caps(elements);
        for (std::uint32_t i = 0; i <= elements; ++i) {
            ends[i].position = {unit(), unit(), unit()};
            ends[i].radius = 0.1f;
            ends[i].orientation = glm::vec4(random_.rotation(3));
            ends[i].slope = 0.1f * unit();
        }
        for (std::uint32_t i = 0; i < elements; ++i) {
            segments[i] = {i, i + 1, i % 4, 0};
            caps[i] = i;
        }
        ends_ = put(ends);
        segments_ = put(segments);
        caps_ = put(caps);
        polygon_ = put(kernels::unit_polygon(8));
        branches_ = room<surface_vertex>(elements * std::size_t{branch_.ring_vertices()});
        caps_out_ = room<surface_vertex>(elements * std::size_t{8});
    }

    void make_draw() {
        std::vector<kernels::probe_vertex> vertices(corners);
        for (std::uint32_t i = 0; i < corners; i += 3) {
            const glm::vec4 centre(1.2f * unit(), 1.2f * unit(), 0.5f + 0.6f * unit(), 1);
            for (std::uint32_t k = 0; k < 3; ++k) {
                vertices[i + k] = {centre + 0.1f * glm::vec4(unit(), unit(), unit(), 0),
                                   glm::vec4(0.5f) + 0.4f * vector()};
            }
        }
        vertices_ = put(vertices);
        tints_ = put(std::vector<glm::vec4>{{1, 1, 1, 1}});
        color_ = expect_value(device_->create_image({side, side, image_format::rgba32f}));
        depth_ = expect_value(device_->create_image({side, side, image_format::depth32f}));
    }

    void record(cpu::recorder& r) {
        const range all{0, elements};
        r.map(kernels::probe_map{3, 5, 2, 1},
              {all_of(numbers_), all_of(vectors_), all_of(numbers_out_), all_of(vectors_out_)},
              all);
        const range levels[] = {{0, 100}, {100, 1900}, {2000, elements - 2000}};
        r.map(kernels::probe_level{}, {all_of(nodes_), all_of(levels_), all_of(levels_)},
              std::span<const range>(levels));
        const padding policies[] = {padding::compact, padding::degenerate};
        for (int i = 0; i < 2; ++i) {
            r.expand(kernels::probe_strips{strips, most}, {all_of(counts_), all_of(vectors_)}, all,
                     {all_of(list_[i]), all_of(count_[i]), policies[i]});
        }
        r.expand_rings(kernels::probe_rings{5}, {all_of(vectors_)}, all, all_of(rings_));
        r.expand_rings(branch_, {all_of(segments_), all_of(ends_), all_of(polygon_)}, all,
                       all_of(branches_));
        r.expand_rings(kernels::branch_cap{8}, {all_of(caps_), all_of(ends_), all_of(polygon_)},
                       all, all_of(caps_out_));
        draw_geometry<cpu::device> geometry;
        geometry.count = corners;
        const draw_target<cpu::device> target{&color_, &depth_, glm::vec4(0), 1.0f};
        draw_state state;
        state.blend = blend_mode::alpha; // so that the order of triangles shows
        r.draw(kernels::probe_surface{}, {all_of(vertices_), all_of(tints_)}, {}, geometry, target,
               state);
    }

    cpu::device* device_;
    random_source random_;
    kernels::hermite_branch branch_{8, 4, kernels::branch_frame::slerp};
    cpu::buffer numbers_, vectors_, nodes_, numbers_out_, vectors_out_, levels_;
    cpu::buffer counts_, list_[2], count_[2], rings_;
    cpu::buffer ends_, segments_, caps_, polygon_, branches_, caps_out_;
    cpu::buffer vertices_, tints_;
    cpu::image color_, depth_;
};

} // namespace skybark::support
