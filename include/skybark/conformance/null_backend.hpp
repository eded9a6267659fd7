#pragma once
// null_device: a backend that runs nothing and counts everything, so that every path of the host's
// code (chunks, growth, lost devices) can be tested without a driver and in no time.
//
// Limits are the test's to set: small ones make algorithms go on in chunks. Expansions write their
// count as if every element had all the triangles that it may have. Kernels never run, so buffers
// hold what was uploaded or copied into them, or zeros.

#include <skybark/core/backend.hpp>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

namespace skybark::conformance {

/// What has been asked of a null_device since it was made.
struct null_counts {
    std::uint64_t buffers_made = 0;
    std::uint64_t images_made = 0;
    std::uint64_t volumes_made = 0;
    std::uint64_t buffers_alive = 0;
    std::uint64_t images_alive = 0;
    std::uint64_t volumes_alive = 0;
    std::uint64_t bytes_alive = 0; ///< of buffers, images and volumes
    std::uint64_t bytes_peak = 0;
    std::uint64_t begins = 0;
    std::uint64_t submits = 0;
    std::uint64_t uploads = 0; ///< at once and in the stream
    std::uint64_t downloads = 0;
    std::uint64_t copies = 0;
    std::uint64_t maps = 0;
    std::uint64_t mapped_elements = 0; ///< the limit where only the device knows
    std::uint64_t ranges = 0;          ///< in maps over consecutive ranges
    std::uint64_t expands = 0;
    std::uint64_t expanded_elements = 0;
    std::uint64_t ring_expands = 0;
    std::uint64_t ring_elements = 0;
    std::uint64_t draws = 0;
    std::uint64_t drawn_vertices = 0; ///< without those that only the device knows
    std::uint64_t accumulates = 0;
    std::uint64_t accumulated_elements = 0; ///< the limit where only the device knows
    std::uint64_t slabs = 0;                ///< that those elements may have
    std::uint64_t voxels_scanned = 0;
    std::uint64_t volume_scans = 0;
    std::uint64_t word_scans = 0;
    std::uint64_t words_scanned = 0;
    std::uint64_t sorts = 0;
    std::uint64_t sorted_pairs = 0; ///< the limit where only the device knows
    std::uint64_t peels = 0;
    std::uint64_t peeled_triangles = 0;
    std::uint64_t peeled_pixels = 0;
    std::uint64_t resolves = 0;
    std::uint64_t resolved_samples = 0;
    std::uint64_t resolved_triangles = 0;
    std::uint64_t voxel_maps = 0;
    std::uint64_t mapped_voxels = 0;
    std::uint64_t largest_view = 0; ///< bytes, of views given to kernels
};

struct null_options {
    device_limits limits{std::uint64_t{1} << 40, 16, 0xffffffff, 16384, 4, 4096};
    std::uint64_t memory_bytes = std::uint64_t{1} << 62; ///< all objects together
    bool keep_contents = true; ///< false: buffers only pretend, and download zeros
};

class null_recorder;

class null_device {
    struct state {
        null_options options;
        null_counts counts;
        device_traffic traffic;
        bool lost = false;
    };
    /// Counts an object for as long as it lives.
    class share {
      public:
        share(std::shared_ptr<state> of, std::uint64_t bytes, std::uint64_t null_counts::*alive)
            : state_(std::move(of)), bytes_(bytes), alive_(alive) {
            null_counts& c = state_->counts;
            ++(c.*alive_);
            c.bytes_alive += bytes_;
            c.bytes_peak = std::max(c.bytes_peak, c.bytes_alive);
        }
        share(share&&) noexcept = default;
        share& operator=(share&& other) noexcept {
            std::swap(state_, other.state_);
            std::swap(bytes_, other.bytes_);
            std::swap(alive_, other.alive_);
            return *this;
        }
        ~share() {
            if (state_) {
                --(state_->counts.*alive_);
                state_->counts.bytes_alive -= bytes_;
            }
        }

      private:
        std::shared_ptr<state> state_;
        std::uint64_t bytes_;
        std::uint64_t null_counts::*alive_;
    };

  public:
    using backend_tag = skybark::backend_tag;
    using recorder = null_recorder;

    class buffer {
      public:
        [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_; }
        /// The contents, or nothing where they are not kept.
        [[nodiscard]] std::span<std::byte> contents() const {
            return {memory_.get(), memory_ ? size_ : 0};
        }

      private:
        friend class null_device;
        buffer(share counted, std::uint64_t size, bool keep)
            : share_(std::move(counted)), size_(size),
              memory_(keep && size != 0 ? new std::byte[size]() : nullptr) {}
        share share_;
        std::uint64_t size_;
        std::unique_ptr<std::byte[]> memory_;
    };

    class image {
      public:
        [[nodiscard]] image_description description() const noexcept { return what_; }

      private:
        friend class null_device;
        image(share counted, image_description what) : share_(std::move(counted)), what_(what) {}
        share share_;
        image_description what_;
    };

    class volume {
      public:
        [[nodiscard]] volume_description description() const noexcept { return what_; }

      private:
        friend class null_device;
        volume(share counted, volume_description what) : share_(std::move(counted)), what_(what) {}
        share share_;
        volume_description what_;
    };

    null_device() : null_device(null_options{}) {}
    explicit null_device(null_options options) : state_(std::make_shared<state>()) {
        state_->options = options;
    }

    [[nodiscard]] null_counts counts() const { return state_->counts; }
    /// From now on every call says that the device is lost.
    void lose() { state_->lost = true; }

    [[nodiscard]] std::string_view name() const noexcept { return "null"; }
    [[nodiscard]] std::string device_name() const { return "nothing that counts"; }
    [[nodiscard]] device_limits limits() const { return state_->options.limits; }
    [[nodiscard]] device_traffic traffic() const { return state_->traffic; }

    [[nodiscard]] result<buffer> create_buffer(std::uint64_t bytes) {
        if (auto ready = room_for(bytes); !ready) {
            return failure(ready.error());
        }
        ++state_->counts.buffers_made;
        return buffer(share(state_, bytes, &null_counts::buffers_alive), bytes,
                      state_->options.keep_contents);
    }
    [[nodiscard]] result<image> create_image(image_description what) {
        const std::uint64_t bytes =
            std::uint64_t{what.width} * what.height * bytes_per_pixel(what.format);
        if (std::max(what.width, what.height) > limits().max_image_size) {
            return fail(error_code::out_of_memory, "The null device takes images of up to " +
                                                       std::to_string(limits().max_image_size) +
                                                       " pixels a side.");
        }
        if (auto ready = room_for(bytes); !ready) {
            return failure(ready.error());
        }
        ++state_->counts.images_made;
        return image(share(state_, bytes, &null_counts::images_alive), what);
    }
    /// The largest buffer is no limit to a volume.
    [[nodiscard]] result<volume> create_volume(volume_description what) {
        if (std::max({what.width, what.height, what.depth}) > limits().max_volume_size) {
            return fail(error_code::out_of_memory, "The null device takes volumes of up to " +
                                                       std::to_string(limits().max_volume_size) +
                                                       " voxels a side.");
        }
        if (auto ready = memory_for(what.size_bytes()); !ready) {
            return failure(ready.error());
        }
        ++state_->counts.volumes_made;
        return volume(share(state_, what.size_bytes(), &null_counts::volumes_alive), what);
    }

    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> bytes) {
        if (auto going = alive(); !going) {
            return going;
        }
        note_upload(bytes.size());
        put(to, offset, bytes);
        return {};
    }
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> bytes) {
        if (auto going = alive(); !going) {
            return going;
        }
        note_download(bytes.size());
        std::fill(bytes.begin(), bytes.end(), std::byte{0});
        if (!from.contents().empty() && !bytes.empty()) {
            std::memcpy(bytes.data(), from.contents().data() + offset, bytes.size());
        }
        return {};
    }
    [[nodiscard]] result<void> upload(const image&, std::span<const std::byte> bytes) {
        note_upload(bytes.size());
        return alive();
    }
    [[nodiscard]] result<void> download(const image&, std::span<std::byte> bytes) {
        note_download(bytes.size());
        std::fill(bytes.begin(), bytes.end(), std::byte{0});
        return alive();
    }

    [[nodiscard]] result<void> upload(const volume&, std::span<const std::byte> bytes) {
        note_upload(bytes.size());
        return alive();
    }
    [[nodiscard]] result<void> download(const volume&, std::span<std::byte> bytes) {
        note_download(bytes.size());
        std::fill(bytes.begin(), bytes.end(), std::byte{0});
        return alive();
    }

    [[nodiscard]] result<null_recorder> begin();
    [[nodiscard]] result<void> submit(null_recorder& done);

  private:
    friend class null_recorder;

    static void put(const buffer& to, std::uint64_t offset, std::span<const std::byte> bytes) {
        if (!to.contents().empty() && !bytes.empty()) {
            std::memmove(to.contents().data() + offset, bytes.data(), bytes.size());
        }
    }
    void note_upload(std::uint64_t bytes) {
        ++state_->counts.uploads;
        state_->traffic.up += bytes;
    }
    void note_download(std::uint64_t bytes) {
        ++state_->counts.downloads;
        state_->traffic.down += bytes;
    }
    [[nodiscard]] result<void> alive() const {
        if (state_->lost) {
            return fail(error_code::device_lost, "The null device has been told to be lost.");
        }
        return {};
    }
    [[nodiscard]] result<void> room_for(std::uint64_t bytes) const {
        return memory_for(bytes > limits().max_buffer_bytes ? ~std::uint64_t{0} : bytes);
    }
    [[nodiscard]] result<void> memory_for(std::uint64_t bytes) const {
        if (auto going = alive(); !going) {
            return going;
        }
        const std::uint64_t used = state_->counts.bytes_alive;
        if (bytes > state_->options.memory_bytes - used) {
            return fail(error_code::out_of_memory,
                        "The null device has no room for " + std::to_string(bytes) +
                            " bytes: " + std::to_string(used) + " are in use.");
        }
        return {};
    }

    std::shared_ptr<state> state_;
};

/// Takes every pattern, counts it, and does nothing.
class null_recorder {
  public:
    using view = buffer_view<null_device>;

    explicit null_recorder(null_device on) : device_(std::move(on)) {}

    void upload(const view& to, std::span<const std::byte> bytes) {
        device_.note_upload(bytes.size());
        null_device::put(*to.buffer, to.offset, bytes);
    }
    void copy(const view& from, const view& to) {
        ++counts().copies;
        if (const auto contents = from.buffer->contents(); !contents.empty()) {
            null_device::put(*to.buffer, to.offset, contents.subspan(from.offset, from.size));
        }
    }

    template <map_kernel K>
    void map(const K&, const bindings<null_device, K>& buffers, range elements) {
        note_map(buffers, elements.count);
    }
    template <map_kernel K>
    void map(const K&, const bindings<null_device, K>& buffers, std::span<const range> ranges) {
        std::uint64_t elements = 0;
        for (const range r : ranges) {
            elements += r.count;
        }
        counts().ranges += ranges.size();
        note_map(buffers, elements);
    }
    template <map_kernel K>
    void map(const K&, const bindings<null_device, K>& buffers,
             const counted<null_device>& elements) {
        note_map(buffers, elements.limit);
    }

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<null_device, K>& buffers, range elements,
                const triangle_list<null_device>& out) {
        note_expand(kernel, buffers, elements.count, out);
    }
    template <strip_kernel K>
    void expand(const K& kernel, const bindings<null_device, K>& buffers,
                const counted<null_device>& elements, const triangle_list<null_device>& out) {
        note_expand(kernel, buffers, elements.limit, out);
    }

    template <ring_kernel K>
    void expand_rings(const K&, const bindings<null_device, K>& buffers, range elements,
                      const view& vertices) {
        ++counts().ring_expands;
        counts().ring_elements += elements.count;
        note_views(buffers);
        note_view(vertices);
    }

    template <draw_kernel K>
    void draw(const K&, const bindings<null_device, K>& buffers,
              const image_bindings<null_device, K>&, const draw_geometry<null_device>& geometry,
              const draw_target<null_device>&, draw_state) {
        note_draw(buffers, geometry);
    }
    template <draw_kernel K>
    requires names_volumes<K>
    void draw(const K&, const bindings<null_device, K>& buffers,
              const image_bindings<null_device, K>&, const volume_bindings<null_device, K>&,
              const draw_geometry<null_device>& geometry, const draw_target<null_device>&,
              draw_state) {
        note_draw(buffers, geometry);
    }

    template <grid_map_kernel K>
    void map(const K&, const bindings<null_device, K>& buffers,
             const volume_bindings<null_device, K>&, range elements) {
        note_map(buffers, elements.count);
    }
    template <voxel_kernel K>
    void map_voxels(const K&, const bindings<null_device, K>& buffers,
                    const volume_bindings<null_device, K>&, glm::uvec3 extent) {
        ++counts().voxel_maps;
        counts().mapped_voxels += std::uint64_t{extent.x} * extent.y * extent.z;
        note_views(buffers);
    }

    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<null_device, K>& buffers, range elements,
                    const accumulation<null_device>&) {
        note_accumulate(buffers, elements.count, kernel.slabs());
    }
    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<null_device, K>& buffers,
                    const counted<null_device>& elements, const accumulation<null_device>&) {
        note_accumulate(buffers, elements.limit, kernel.slabs());
    }
    void scan(const null_device::volume& from, const null_device::volume&, const volume_scan&) {
        const volume_description what = from.description();
        ++counts().volume_scans;
        counts().voxels_scanned += std::uint64_t{what.width} * what.height * what.depth;
    }
    void scan(const view& words, const view& total) {
        ++counts().word_scans;
        counts().words_scanned += words.size / 4;
        note_view(words);
        note_view(total);
    }

    void sort(const view& keys, const view& values, std::uint32_t = 32) {
        note_sort(keys, values, std::min(keys.size, values.size) / 4);
    }
    void sort(const view& keys, const view& values, const counted<null_device>& pairs,
              std::uint32_t = 32) {
        note_sort(keys, values, pairs.limit);
    }

    template <peel_kernel K>
    void peel(const K&, const bindings<null_device, K>& buffers, range triangles,
              const peeled_layer<null_device>& layer) {
        ++counts().peels;
        counts().peeled_triangles += triangles.count;
        counts().peeled_pixels += std::uint64_t{layer.width} * layer.height;
        note_views(buffers);
        note_views(std::array{layer.depth, layer.triangle, layer.count});
    }
    void resolve(const ray_bundle&, const bundle_work<null_device>& work) {
        ++counts().resolves;
        counts().resolved_samples += work.samples.size / sizeof(gather_sample);
        counts().resolved_triangles += work.triangles.size / sizeof(gather_triangle);
        note_views(std::array{work.triangles, work.alpha, work.samples, work.hits});
    }

  private:
    [[nodiscard]] null_counts& counts() const { return device_.state_->counts; }

    void note_view(const view& v) {
        counts().largest_view = std::max(counts().largest_view, v.size);
    }
    template <std::size_t N>
    void note_views(const std::array<view, N>& views) {
        for (const view& v : views) {
            note_view(v);
        }
    }
    template <std::size_t N>
    void note_draw(const std::array<view, N>& views, const draw_geometry<null_device>& geometry) {
        ++counts().draws;
        counts().drawn_vertices += geometry.length ? 0 : geometry.count;
        note_views(views);
        note_view(geometry.indices);
    }
    template <std::size_t N>
    void note_accumulate(const std::array<view, N>& views, std::uint64_t elements,
                         std::uint64_t slabs) {
        ++counts().accumulates;
        counts().accumulated_elements += elements;
        counts().slabs += elements * slabs;
        note_views(views);
    }
    void note_sort(const view& keys, const view& values, std::uint64_t pairs) {
        ++counts().sorts;
        counts().sorted_pairs += pairs;
        note_view(keys);
        note_view(values);
    }
    template <std::size_t N>
    void note_map(const std::array<view, N>& views, std::uint64_t elements) {
        ++counts().maps;
        counts().mapped_elements += elements;
        note_views(views);
    }
    template <class K>
    void note_expand(const K& kernel, const bindings<null_device, K>& buffers,
                     std::uint64_t elements, const triangle_list<null_device>& out) {
        ++counts().expands;
        counts().expanded_elements += elements;
        note_views(buffers);
        note_view(out.vertices);
        const std::uint64_t required = elements * max_triangles(kernel);
        const std::uint64_t room = out.vertices.size / (3 * sizeof(typename K::vertex));
        constexpr std::uint64_t most = 0xffffffff;
        const count_record count{static_cast<std::uint32_t>(std::min({required, room, most})),
                                 static_cast<std::uint32_t>(std::min(required, most)),
                                 {0, 0}};
        null_device::put(*out.count.buffer, out.count.offset, std::as_bytes(std::span(&count, 1)));
    }

    null_device device_; // shares its state
};

inline result<null_recorder> null_device::begin() {
    if (auto going = alive(); !going) {
        return failure(going.error());
    }
    ++state_->counts.begins;
    return null_recorder(*this);
}
inline result<void> null_device::submit(null_recorder&) {
    ++state_->counts.submits;
    return alive();
}

static_assert(backend<null_device>);
static_assert(volume_backend<null_device> && scans<null_device> && sorts<null_device>);
static_assert(resolves_bundles<null_device>);

} // namespace skybark::conformance
