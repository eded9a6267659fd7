#pragma once
// Work for a CPU device that touches every pattern, as bytes to compare.

#include <skybark/cpu/cpu.hpp>
#include <skybark/kernels/branch_cap.hpp>
#include <skybark/kernels/bundle_corner.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/particle_impulse.hpp>
#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>
#include <skybark/kernels/probe_volume.hpp>
#include <skybark/kernels/probe_volume_draw.hpp>
#include <skybark/kernels/probe_voxels.hpp>
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
    static constexpr std::uint32_t voxels = 40; ///< a side of the volumes
    static constexpr std::uint32_t pairs = 40'000;

    explicit cpu_work(cpu::device& device) : device_(&device), random_(7) {
        make_maps();
        make_strips();
        make_branches();
        make_draw();
        make_volumes();
        make_words();
        make_bundle();
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
        for (const cpu::buffer* b :
             {&values_out_, &sizes_out_, &voxel_numbers_, &keys_[1], &order_[1], &words_[1],
              &total_, &hits_, &layer_depth_[1], &layer_triangle_, &layer_count_}) {
            all.emplace_back(b->data(), b->data() + b->size_bytes());
        }
        for (const cpu::image* i : {&color_, &depth_, &volume_picture_}) {
            all.emplace_back(i->data(), i->data() + i->size_bytes());
        }
        for (const cpu::volume* v :
             {&sums_, &floats_[0], &floats_[1], &halves_, &targets_[0], &targets_[1]}) {
            all.emplace_back(v->data(), v->data() + v->size_bytes());
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

    [[nodiscard]] cpu::volume cube(volume_format format) {
        return expect_value(device_->create_volume({voxels, voxels, voxels, format}));
    }

    void make_volumes() {
        std::vector<kernels::probe_box> boxes(elements);
        std::vector<cloud_particle> particles(elements);
        std::vector<kernels::probe_place> places(elements);
        const auto cell = [&] { return static_cast<int>(random_.below(voxels)); };
        for (std::uint32_t i = 0; i < elements; ++i) {
            boxes[i].low = {cell(), cell(), cell(), 5};
            boxes[i].high = boxes[i].low + glm::ivec4(7, 6, 5, 0);
            particles[i] = {{cell(), cell(), cell()}, 2.5f + unit(), 0.5f + 0.5f * unit(), 1, {}};
            places[i] = {0.5f + vector(), {cell(), cell(), cell(), 0}};
        }
        boxes_ = put(boxes);
        particles_ = put(particles);
        places_ = put(places);
        weights_ = put(std::vector<glm::vec4>(voxels, glm::vec4(0.5f)));
        values_out_ = room<glm::vec4>(elements);
        sizes_out_ = room<glm::ivec4>(elements);
        voxel_numbers_ = room<std::uint32_t>(voxels * voxels * voxels);
        sums_ = cube(volume_format::int32);
        halves_ = cube(volume_format::float16);
        for (int i = 0; i < 2; ++i) {
            floats_[i] = cube(volume_format::float32);
            targets_[i] = cube(volume_format::float32);
        }
        volume_picture_ = expect_value(device_->create_image({side, side, image_format::rgba32f}));
    }

    void make_words() {
        std::vector<std::uint32_t> keys(pairs);
        std::vector<std::uint32_t> words(pairs);
        for (std::uint32_t i = 0; i < pairs; ++i) {
            keys[i] = random_.bits();
            words[i] = random_.below(100);
        }
        for (int i = 0; i < 2; ++i) {
            keys_[i] = put(keys);
            order_[i] = put(words);
            words_[i] = put(words);
        }
        total_ = room<std::uint32_t>(1);
    }

    void make_bundle() {
        std::vector<gather_triangle> triangles(elements);
        std::vector<gather_sample> samples(pairs);
        for (gather_triangle& t : triangles) {
            const glm::vec3 middle(unit(), unit(), unit());
            for (glm::vec3* corner : {&t.a, &t.b, &t.c}) {
                *corner = middle + 0.1f * glm::vec3(unit(), unit(), unit());
            }
        }
        for (gather_sample& s : samples) {
            s.position = {unit(), unit(), unit()};
            s.normal = {0, 0, unit() < 0 ? -1 : 1};
        }
        triangles_ = put(triangles);
        samples_ = put(samples);
        hits_ = room<gather_hit>(pairs);
        layer_depth_[0] = put(std::vector<float>(side * side, 1.0f));
        layer_depth_[1] = room<float>(side * side);
        layer_triangle_ = room<std::uint32_t>(side * side);
        layer_count_ = room<count_record>(1);
    }

    void record_bundle(cpu::recorder& r) {
        ray_bundle bundle;
        bundle.centre.w = 1.2f;
        bundle.right.w = 1e-4f;
        bundle.up.w = 64 / 2.4f;
        bundle.direction.w = 64;
        r.resolve(bundle, {all_of(triangles_), {}, all_of(samples_), all_of(hits_)});
        r.copy(all_of(layer_depth_[0]), all_of(layer_depth_[1]));
        const peeled_layer<cpu::device> layer{side, side, all_of(layer_depth_[1]),
                                              all_of(layer_triangle_), all_of(layer_count_)};
        for (int i = 0; i < 2; ++i) {
            r.peel(kernels::bundle_corner{bundle, 1.2f}, {all_of(triangles_)}, range{0, elements},
                   layer);
        }
    }

    void record_volumes(cpu::recorder& r) {
        const range all{0, elements};
        r.accumulate(kernels::probe_slabs{5, 2, 3, 7}, {all_of(boxes_)}, all,
                     {&sums_, true, {}, {}});
        r.scan(sums_, floats_[0],
               {scan_axis::z, scan_direction::ascending, scan_share::half, 0.5f});
        kernels::particle_impulse impulse;
        impulse.shade.slices = 20;
        impulse.shade.profile = 1;
        impulse.shade.grid.voxel.w = 0x1p-20f;
        volume_scan how;
        how.scale = 0x1p-20f;
        r.accumulate_scan(impulse, {all_of(particles_)}, all, sums_, floats_[1], how);
        r.accumulate_scan(impulse, {all_of(particles_)}, all, sums_, halves_, how);
        const range some{0, elements - 7};
        r.map(kernels::probe_volume{}, {all_of(places_), all_of(values_out_), all_of(sizes_out_)},
              {{&floats_[1], &halves_}, {&targets_[0]}}, some);
        kernels::probe_voxels neighbours;
        neighbours.extent_x = voxels;
        neighbours.extent_y = voxels;
        r.map_voxels(neighbours, {all_of(weights_), all_of(voxel_numbers_)},
                     {{&floats_[1], &halves_}, {&targets_[0], &targets_[1]}}, glm::uvec3(voxels));
        draw_geometry<cpu::device> geometry;
        geometry.count = 3000;
        r.draw(kernels::probe_volume_draw{}, {all_of(vertices_)}, {{{&color_}}},
               {{&floats_[1], &halves_}, {}}, geometry,
               {&volume_picture_, nullptr, glm::vec4(0), {}}, draw_state{});
    }

    void record_words(cpu::recorder& r) {
        r.copy(all_of(keys_[0]), all_of(keys_[1]));
        r.copy(all_of(order_[0]), all_of(order_[1]));
        r.sort(all_of(keys_[1]), all_of(order_[1]));
        r.copy(all_of(words_[0]), all_of(words_[1]));
        r.scan(all_of(words_[1]), all_of(total_));
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
        record_volumes(r);
        record_words(r);
        record_bundle(r);
    }

    cpu::device* device_;
    random_source random_;
    kernels::hermite_branch branch_{8, 4, kernels::branch_frame::slerp};
    cpu::buffer numbers_, vectors_, nodes_, numbers_out_, vectors_out_, levels_;
    cpu::buffer counts_, list_[2], count_[2], rings_;
    cpu::buffer ends_, segments_, caps_, polygon_, branches_, caps_out_;
    cpu::buffer vertices_, tints_;
    cpu::image color_, depth_, volume_picture_;
    cpu::buffer boxes_, particles_, places_, weights_, values_out_, sizes_out_, voxel_numbers_;
    cpu::volume sums_, floats_[2], halves_, targets_[2];
    cpu::buffer keys_[2], order_[2], words_[2], total_;
    cpu::buffer triangles_, samples_, hits_, layer_depth_[2], layer_triangle_, layer_count_;
};

} // namespace skybark::support
