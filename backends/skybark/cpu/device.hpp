#pragma once
// The CPU backend: the embedded default. Kernels run as plain C++ on threads; a recorder does its
// work at once, so that a submit has nothing left to wait for. Results have the same bits for any
// number of threads.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/cpu/bundle.hpp>
#include <skybark/cpu/jobs.hpp>
#include <skybark/cpu/layers.hpp>
#include <skybark/cpu/memory.hpp>
#include <skybark/cpu/peel.hpp>
#include <skybark/cpu/program.hpp>
#include <skybark/cpu/raster.hpp>
#include <skybark/cpu/sinks.hpp>
#include <skybark/cpu/sort.hpp>

#include <algorithm>
#include <limits>
#include <optional>

namespace skybark::cpu {

class recorder;

/// How a CPU device is made.
struct device_options {
    std::uint32_t threads = 0; ///< 0: as many as the machine runs at once
    parallel_for jobs;         ///< the caller's job system in place of our threads
    /// What the device says that it can do. Smaller values make algorithms cut their work.
    device_limits limits{std::uint64_t{1} << 46,
                         16,
                         std::numeric_limits<std::uint32_t>::max(),
                         32768,
                         std::numeric_limits<std::uint32_t>::max(),
                         4096};
    skybark::hooks hooks = {};
    memory_hooks memory = {}; ///< the heap where there are none
};

class device {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = cpu::buffer;
    using image = cpu::image;
    using volume = cpu::volume;
    using recorder = cpu::recorder;

    device() : device(device_options{}) {}
    explicit device(device_options options)
        : jobs_(std::move(options.jobs)), limits_(options.limits),
          source_(std::make_unique<detail::memory_source>(
              detail::memory_source{options.memory, options.hooks, {}})) {
        if (!jobs_) {
            const std::uint32_t threads = options.threads != 0
                                              ? options.threads
                                              : std::max(1u, std::thread::hardware_concurrency());
            pool_ = std::make_unique<thread_pool>(threads);
        }
        say(log_level::info, [this] { return "The cpu device has " + device_name() + "."; });
    }

    [[nodiscard]] std::string_view name() const noexcept { return "cpu"; }
    [[nodiscard]] std::string device_name() const {
        return pool_ ? std::to_string(pool_->threads()) + " threads" : "the caller's jobs";
    }
    [[nodiscard]] device_limits limits() const noexcept { return limits_; }
    [[nodiscard]] device_traffic traffic() const noexcept { return traffic_; }
    [[nodiscard]] device_usage usage() const noexcept { return source_->usage; }

    template <class = when_used>
    [[nodiscard]] result<buffer> create_buffer(std::uint64_t bytes) {
        detail::memory memory =
            bytes <= limits_.max_buffer_bytes ? allocate("a buffer", bytes) : nullptr;
        if (!memory) {
            return fail(error_code::out_of_memory,
                        "The cpu backend could not allocate a buffer of " + std::to_string(bytes) +
                            " bytes.");
        }
        return buffer(std::move(memory), bytes);
    }

    template <class = when_used>
    [[nodiscard]] result<image> create_image(image_description what) {
        const std::string size = std::to_string(what.width) + " x " + std::to_string(what.height);
        if (what.width == 0 || what.height == 0 ||
            std::max(what.width, what.height) > limits_.max_image_size) {
            return fail(error_code::out_of_memory, "The cpu backend cannot make an image of " +
                                                       size + " pixels; each side must be 1 to " +
                                                       std::to_string(limits_.max_image_size) +
                                                       ".");
        }
        const std::uint64_t bytes =
            std::uint64_t{what.width} * what.height * bytes_per_pixel(what.format);
        detail::memory memory = allocate("an image", bytes);
        if (!memory) {
            return fail(error_code::out_of_memory,
                        "The cpu backend could not allocate an image of " + size + " pixels.");
        }
        return image(std::move(memory), what);
    }

    /// Fails where the volume is larger than the limits or the machine's memory.
    template <class = when_used>
    [[nodiscard]] result<volume> create_volume(volume_description what) {
        const std::string sides = std::to_string(what.width) + " x " + std::to_string(what.height) +
                                  " x " + std::to_string(what.depth);
        if (what.width == 0 || what.height == 0 || what.depth == 0 ||
            std::max({what.width, what.height, what.depth}) > limits_.max_volume_size) {
            return fail(error_code::out_of_memory, "The cpu backend cannot make a volume of " +
                                                       sides + " voxels; each side must be 1 to " +
                                                       std::to_string(limits_.max_volume_size) +
                                                       ".");
        }
        detail::memory memory = what.size_bytes() <= detail::memory_of_machine()
                                    ? allocate("a volume", what.size_bytes())
                                    : nullptr;
        if (!memory) {
            return fail(error_code::out_of_memory,
                        "The cpu backend could not allocate a volume of " + sides + " voxels, " +
                            std::to_string(what.size_bytes()) + " bytes.");
        }
        return volume(std::move(memory), what);
    }

    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> bytes) {
        const zone here(hooks(), "upload");
        copy_bytes(to.data() + offset, bytes.data(), bytes.size());
        traffic_.up += bytes.size();
        return {};
    }
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> bytes) {
        const zone here(hooks(), "download");
        copy_bytes(bytes.data(), from.data() + offset, bytes.size());
        traffic_.down += bytes.size();
        return {};
    }
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> bytes) {
        const zone here(hooks(), "upload");
        copy_bytes(to.data(), bytes.data(), std::min<std::uint64_t>(bytes.size(), to.size_bytes()));
        traffic_.up += bytes.size();
        return {};
    }
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> bytes) {
        const zone here(hooks(), "download");
        copy_bytes(bytes.data(), from.data(),
                   std::min<std::uint64_t>(bytes.size(), from.size_bytes()));
        traffic_.down += bytes.size();
        return {};
    }

    [[nodiscard]] result<void> upload(const volume& to, std::span<const std::byte> bytes) {
        const zone here(hooks(), "upload");
        copy_bytes(to.data(), bytes.data(), std::min<std::uint64_t>(bytes.size(), to.size_bytes()));
        traffic_.up += bytes.size();
        return {};
    }
    [[nodiscard]] result<void> download(const volume& from, std::span<std::byte> bytes) {
        const zone here(hooks(), "download");
        copy_bytes(bytes.data(), from.data(),
                   std::min<std::uint64_t>(bytes.size(), from.size_bytes()));
        traffic_.down += bytes.size();
        return {};
    }

    [[nodiscard]] result<cpu::recorder> begin();
    [[nodiscard]] result<void> submit(cpu::recorder& recorder);

    [[nodiscard]] const skybark::hooks& hooks() const noexcept { return source_->hooks; }

    /// How many tasks it is worth cutting work into, where each has memory of its own.
    [[nodiscard]] std::uint32_t workers() const {
        return pool_ ? pool_->threads() : std::max(1u, std::thread::hardware_concurrency());
    }

    /// Runs tasks 0 … count − 1 on the device's threads.
    template <class Task>
    void parallel(std::uint32_t count, const Task& task) {
        // By reference: a std::function of more than two words would allocate.
        const std::function<void(std::uint32_t)> by_reference = std::cref(task);
        if (jobs_) {
            jobs_(count, by_reference);
        } else {
            (*pool_)(count, by_reference);
        }
    }

    /// Cuts [0, count) into pieces of at least `grain` (multiples of it, but the last) and runs
    /// `piece(first, count)` for each. The cut does not depend on the number of threads.
    template <class Piece>
    void for_pieces(std::uint64_t count, std::uint64_t grain, Piece&& piece) {
        constexpr std::uint64_t most_pieces = 256;
        const std::uint64_t grains = (count + grain - 1) / grain;
        const std::uint64_t size =
            std::max<std::uint64_t>(1, (grains + most_pieces - 1) / most_pieces) * grain;
        const auto pieces = static_cast<std::uint32_t>((count + size - 1) / size);
        if (pieces == 1) {
            piece(std::uint64_t{0}, count);
            return;
        }
        parallel(pieces, [&](std::uint32_t i) {
            const std::uint64_t first = i * size;
            piece(first, std::min(size, count - first));
        });
    }

  private:
    friend class cpu::recorder;

    static void copy_bytes(void* to, const void* from, std::uint64_t bytes) {
        if (bytes != 0) {
            std::memmove(to, from, bytes);
        }
    }

    template <class Text>
    void say(log_level level, Text&& text) const {
        log(source_->hooks, level, text);
    }

    [[nodiscard]] detail::memory allocate(const char* what, std::uint64_t bytes) const {
        detail::memory made = detail::allocate_zeroed(source_->memory, bytes);
        say(made ? log_level::debug : log_level::warning, [&] {
            return std::string("The cpu device ") + (made ? "has made " : "could not make ") +
                   what + " of " + std::to_string(bytes) + " bytes.";
        });
        if (made) {
            made.get_deleter().usage = &source_->usage;
            made.get_deleter().size = bytes;
            source_->usage.add(bytes);
        }
        return made;
    }

    static constexpr std::uint64_t kept_blocks = 128;
    static constexpr std::uint64_t kept_bytes = 147456; // 1,024 triangles of 48-byte vertices

    /// Room for kept_blocks blocks, made when first asked for; null where there is no memory.
    [[nodiscard]] std::byte* kept_memory() {
        return kept_.room_for<std::byte>(kept_blocks * kept_bytes);
    }

    parallel_for jobs_;
    std::unique_ptr<thread_pool> pool_;
    device_limits limits_;
    device_traffic traffic_;
    std::unique_ptr<detail::memory_source> source_;
    detail::scratch_memory kept_{source_.get()};
    detail::scratch_memory counts_{source_.get()};
    raster_scratch raster_{source_.get()};
    layer_scratch layers_{source_.get()};
    sort_scratch sort_{source_.get()};
    peel_scratch peel_{source_.get()};
    bundle_scratch bundle_{source_.get()};
};

/// Appends patterns; on this backend each is done when its call returns. One that has no memory to
/// work in is an error at submit.
class recorder {
  public:
    using device = cpu::device;

    explicit recorder(device& on) : device_(&on) {}

    void upload(const buffer_view<device>& to, std::span<const std::byte> bytes) {
        const zone here(device_->hooks(), "upload");
        device::copy_bytes(to.buffer->data() + to.offset, bytes.data(),
                           std::min<std::uint64_t>(bytes.size(), to.size));
        device_->traffic_.up += bytes.size();
    }

    void copy(const buffer_view<device>& from, const buffer_view<device>& to) {
        const zone here(device_->hooks(), "copy");
        device::copy_bytes(to.buffer->data() + to.offset, from.buffer->data() + from.offset,
                           std::min(from.size, to.size));
    }

    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, range elements) {
        const zone here(device_->hooks(), zone_name<pattern::map, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            device_->for_pieces(
                elements.count, 1024, [&](std::uint64_t first, std::uint64_t count) {
                    program<K>::map(kernel,
                                    range{static_cast<std::uint32_t>(elements.first + first),
                                          static_cast<std::uint32_t>(count)},
                                    spans...);
                });
        });
    }

    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, std::span<const range> ranges) {
        for (const range elements : ranges) {
            map(kernel, buffers, elements);
        }
    }

    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, const counted<device>& elements) {
        map(kernel, buffers, range{0, length_of(elements)});
    }

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<device, K>& buffers, range elements,
                const triangle_list<device>& out) {
        const zone here(device_->hooks(), zone_name<pattern::expand, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            if (out.policy == padding::degenerate) {
                expand_degenerate(kernel, elements, out, spans...);
            } else {
                expand_compact(kernel, elements, out, spans...);
            }
        });
    }

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<device, K>& buffers,
                const counted<device>& elements, const triangle_list<device>& out) {
        expand(kernel, buffers, range{0, length_of(elements)}, out);
    }

    template <ring_kernel K>
    void expand_rings(const K& kernel, const bindings<device, K>& buffers, range elements,
                      const buffer_view<device>& vertices) {
        const zone here(device_->hooks(), zone_name<pattern::expand_rings, K>());
        const std::uint64_t stride =
            std::uint64_t{kernel.ring_vertices()} * sizeof(typename K::vertex);
        const std::uint64_t room = stride == 0 ? 0 : vertices.size / stride;
        const std::uint64_t count = std::min<std::uint64_t>(elements.count, room);
        std::byte* to = vertices.buffer->data() + vertices.offset;
        with_spans<K>(buffers, [&](auto... spans) {
            device_->for_pieces(count, 64, [&](std::uint64_t first, std::uint64_t n) {
                const range piece{static_cast<std::uint32_t>(elements.first + first),
                                  static_cast<std::uint32_t>(n)};
                program<K>::rings(kernel, piece, to + first * stride, spans...);
                finish_streaming();
            });
        });
    }

    template <draw_kernel K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const draw_geometry<device>& geometry,
              const draw_target<device>& target, draw_state state) {
        const zone here(device_->hooks(), zone_name<pattern::draw, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            if (going() && !rasterise(*device_, device_->raster_, kernel, images, grids{}, geometry,
                                      target, state, spans...)) {
                out_of_memory("draw");
            }
        });
    }

    template <draw_kernel K>
    requires names_volumes<K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const volume_bindings<device, K>& volumes,
              const draw_geometry<device>& geometry, const draw_target<device>& target,
              draw_state state) {
        const zone here(device_->hooks(), zone_name<pattern::draw, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            if (going() &&
                !rasterise(*device_, device_->raster_, kernel, images,
                           grids::of<device, K>(volumes), geometry, target, state, spans...)) {
                out_of_memory("draw");
            }
        });
    }

    template <peel_kernel K>
    void peel(const K& kernel, const bindings<device, K>& buffers, range triangles,
              const peeled_layer<device>& layer) {
        const zone here(device_->hooks(), zone_name<pattern::peel, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            if (going() &&
                !peel_layer(*device_, device_->peel_, kernel, triangles, layer, spans...)) {
                out_of_memory("peel");
            }
        });
    }

    template <class = when_used>
    void resolve(const ray_bundle& bundle, const bundle_work<device>& work) {
        const zone here(device_->hooks(), "resolve");
        if (going() && !resolve_bundle(*device_, device_->bundle_, bundle, work)) {
            out_of_memory("resolve");
        }
    }

    template <grid_map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers,
             const volume_bindings<device, K>& volumes, range elements) {
        const zone here(device_->hooks(), zone_name<pattern::map, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            const grids bound = grids::of<device, K>(volumes);
            device_->for_pieces(elements.count, 256, [&](std::uint64_t first, std::uint64_t count) {
                program<K>::map(kernel,
                                range{static_cast<std::uint32_t>(elements.first + first),
                                      static_cast<std::uint32_t>(count)},
                                bound, spans...);
            });
        });
    }

    template <voxel_kernel K>
    void map_voxels(const K& kernel, const bindings<device, K>& buffers,
                    const volume_bindings<device, K>& volumes, glm::uvec3 extent) {
        const zone here(device_->hooks(), zone_name<pattern::map_voxels, K>());
        if (extent.x == 0 || extent.y == 0) {
            return;
        }
        with_spans<K>(buffers, [&](auto... spans) {
            const grids bound = grids::of<device, K>(volumes);
            const std::uint64_t rows = std::uint64_t{extent.y} * extent.z;
            const std::uint64_t grain = 1 + 1023 / extent.x;
            device_->for_pieces(rows, grain, [&](std::uint64_t first, std::uint64_t count) {
                for (std::uint64_t row = first; row < first + count; ++row) {
                    program<K>::voxels(
                        kernel,
                        {0, static_cast<int>(row % extent.y), static_cast<int>(row / extent.y)},
                        extent.x, bound, spans...);
                }
            });
        });
    }

    /// All routes are the direct one here.
    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers, range elements,
                    const accumulation<device>& how) {
        const zone here(device_->hooks(), zone_name<pattern::accumulate, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            typename bins_of<K, decltype(spans)...>::type bins(kernel, spans...);
            if (going() && !accumulate_layers(*device_, device_->layers_, bins, elements, *how.into,
                                              how.clear)) {
                out_of_memory("accumulate");
            }
        });
    }

    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers,
                    const counted<device>& elements, const accumulation<device>& how) {
        accumulate(kernel, buffers, range{0, length_of(elements)}, how);
    }

    template <slab_kernel K>
    void accumulate_scan(const K& kernel, const bindings<device, K>& buffers, range elements,
                         const volume& scratch, const volume& to, const volume_scan& how) {
        const zone here(device_->hooks(), zone_name<pattern::accumulate_scan, K>());
        with_spans<K>(buffers, [&](auto... spans) {
            typename bins_of<K, decltype(spans)...>::type bins(kernel, spans...);
            if (how.axis != scan_axis::y || elements.count > bins.batch()) {
                accumulate(kernel, buffers, elements, accumulation<device>{&scratch, true, {}, {}});
                scan(scratch, to, how);
            } else if (going() && !accumulate_and_scan_layers(*device_, device_->layers_, bins,
                                                              elements, to, how)) {
                out_of_memory("accumulate_scan");
            }
        });
    }

    template <class = when_used>
    void scan(const volume& from, const volume& to, const volume_scan& how) {
        const zone here(device_->hooks(), "scan volume");
        if (going()) {
            scan_volume(*device_, from, to, how);
        }
    }

    template <class = when_used>
    void scan(const buffer_view<device>& words, const buffer_view<device>& total) {
        const zone here(device_->hooks(), "scan");
        std::uint32_t sum = 0;
        if (going() && !scan_words(*device_, device_->sort_, words_of(words), sum)) {
            out_of_memory("scan");
        }
        std::memcpy(total.buffer->data() + total.offset, &sum, sizeof sum);
    }

    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              std::uint32_t key_bits = 32) {
        sort_first(keys, values, std::numeric_limits<std::uint32_t>::max(), key_bits);
    }

    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              const counted<device>& pairs, std::uint32_t key_bits = 32) {
        sort_first(keys, values, length_of(pairs), key_bits);
    }

  private:
    friend class cpu::device;

    /// Whether nothing has gone wrong yet.
    [[nodiscard]] bool going() const { return !error_; }
    void out_of_memory(const char* pattern) {
        error_ = error{error_code::out_of_memory,
                       std::string("The cpu backend has no memory to ") + pattern + " in."};
    }

    [[nodiscard]] static std::span<std::uint32_t> words_of(const buffer_view<device>& view) {
        return records_of<device, std::span<std::uint32_t>>(view);
    }

    template <class = when_used>
    void sort_first(const buffer_view<device>& keys, const buffer_view<device>& values,
                    std::uint64_t most, std::uint32_t key_bits) {
        const zone here(device_->hooks(), "sort");
        const auto k = words_of(keys);
        const auto v = words_of(values);
        const std::size_t count = std::min<std::uint64_t>({k.size(), v.size(), most});
        if (going() &&
            !sort_pairs(*device_, device_->sort_, k.first(count), v.first(count), key_bits)) {
            out_of_memory("sort");
        }
    }

    /// Calls `work` with a span for each view.
    template <class K, class Work>
    static void with_spans(const bindings<device, K>& buffers, Work&& work) {
        with_spans<typename K::buffers::spans>(buffers, work,
                                               std::make_index_sequence<K::buffers::size>{});
    }
    template <class Spans, class Bindings, class Work, std::size_t... Index>
    static void with_spans(const Bindings& buffers, Work&& work, std::index_sequence<Index...>) {
        (void)buffers;
        work(records_of<device, std::tuple_element_t<Index, Spans>>(buffers[Index])...);
    }

    [[nodiscard]] static std::uint32_t length_of(const counted<device>& elements) {
        count_record record;
        std::memcpy(&record, elements.count.buffer->data() + elements.count.offset, sizeof record);
        return std::min(record.written, elements.limit);
    }

    template <class K>
    [[nodiscard]] static std::uint64_t room_for_triangles(const triangle_list<device>& out) {
        return out.vertices.size / (3 * sizeof(typename K::vertex));
    }

    static void write_count(const triangle_list<device>& out, std::uint64_t required,
                            std::uint64_t room) {
        constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
        count_record record;
        record.written = static_cast<std::uint32_t>(std::min({required, room, most}));
        record.required = static_cast<std::uint32_t>(std::min(required, most));
        std::memcpy(out.count.buffer->data() + out.count.offset, &record, sizeof record);
    }

    template <class K, class... Spans>
    void expand_degenerate(const K& kernel, range elements, const triangle_list<device>& out,
                           Spans... spans) {
        using vertex = typename K::vertex;
        const std::uint64_t each = max_triangles(kernel);
        const std::uint64_t room = room_for_triangles<K>(out);
        std::byte* to = out.vertices.buffer->data() + out.vertices.offset;
        device_->for_pieces(elements.count, 64, [&](std::uint64_t first, std::uint64_t count) {
            const std::uint64_t begin = first * each;
            if (begin >= room) {
                return;
            }
            triangle_sink<vertex> sink(to + begin * 3 * sizeof(vertex), room - begin);
            for (std::uint64_t i = first; i < first + count; ++i) {
                const auto element = static_cast<std::uint32_t>(elements.first + i);
                for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
                    const std::uint32_t n =
                        plain_program<K>::strip(kernel, element, s, sink, spans...);
                    sink.degenerate(kernel.strip_triangles() - n);
                }
            }
            finish_streaming();
        });
        write_count(out, each * elements.count, room);
    }

    template <class K, class... Spans>
    void expand_compact(const K& kernel, range elements, const triangle_list<device>& out,
                        Spans... spans) {
        using vertex = typename K::vertex;
        const std::uint64_t room = room_for_triangles<K>(out);
        std::byte* to = out.vertices.buffer->data() + out.vertices.offset;
        // Offsets of blocks, not of elements: 1/64 of the memory, and the count is cheap.
        constexpr std::uint32_t block = keeps<K> ? 16 : 64;
        const std::uint64_t blocks = (std::uint64_t{elements.count} + block - 1) / block;
        auto* const offsets = device_->counts_.room_for<std::uint64_t>(blocks + 1);
        if (offsets == nullptr) {
            return out_of_memory("expand");
        }
        offsets[0] = 0;
        std::byte* const kept = keeps<K> && room != 0 ? device_->kept_memory() : nullptr;
        const std::uint64_t wave =
            kept != nullptr ? kept_blocks : std::max<std::uint64_t>(1, blocks);
        const auto elements_of = [&](std::uint64_t b) {
            const auto first = static_cast<std::uint32_t>(elements.first + b * block);
            return range{first, std::min(block, elements.first + elements.count - first)};
        };
        for (std::uint64_t begin = 0; begin < blocks; begin += wave) {
            const std::uint64_t now = std::min(wave, blocks - begin);
            device_->for_pieces(now, keeps<K> ? 1 : 16, [&](std::uint64_t first, std::uint64_t n) {
                for (std::uint64_t b = first; b < first + n; ++b) {
                    offsets[begin + b + 1] =
                        count_block(kernel, elements_of(begin + b),
                                    kept != nullptr ? kept + b * kept_bytes : nullptr, spans...);
                }
            });
            for (std::uint64_t b = begin; b < begin + now; ++b) {
                offsets[b + 1] += offsets[b];
            }
            device_->for_pieces(now, 1, [&](std::uint64_t first, std::uint64_t n) {
                const std::uint64_t place = offsets[begin + first];
                if (place >= room) {
                    return;
                }
                triangle_sink<vertex> sink(to + place * 3 * sizeof(vertex), room - place);
                for (std::uint64_t b = first; b < first + n; ++b) {
                    const std::uint64_t count = offsets[begin + b + 1] - offsets[begin + b];
                    if (kept != nullptr && count < kept_bytes / (3 * sizeof(vertex))) {
                        write_kept(kept + b * kept_bytes, count, sink);
                    } else {
                        program<K>::triangles(kernel, elements_of(begin + b), sink, spans...);
                    }
                }
                finish_streaming();
            });
        }
        write_count(out, offsets[blocks], room);
    }

    /// Programs whose count costs as much as the triangles keep these from the one to the other,
    /// block by block as far as there is room, in memory that the caches hold.
    template <class K>
    static constexpr bool keeps = requires {
        requires program<K>::keeps_what_it_counts;
    };
    static constexpr std::uint64_t kept_blocks = device::kept_blocks;
    static constexpr std::uint64_t kept_bytes = device::kept_bytes;

    template <class K, class... Spans>
    [[nodiscard]] static std::uint64_t count_block(const K& kernel, range elements, std::byte* kept,
                                                   Spans... spans) {
        if constexpr (keeps<K>) {
            constexpr std::uint64_t most = kept_bytes / (3 * sizeof(typename K::vertex));
            if (kept != nullptr) {
                const std::optional<std::uint64_t> count =
                    program<K>::keep(kernel, elements, kept, most, spans...);
                if (count) {
                    return *count;
                }
            }
        }
        return program<K>::count(kernel, elements, spans...);
    }

    template <class Vertex>
    static void write_kept(const std::byte* kept, std::uint64_t count,
                           triangle_sink<Vertex>& sink) {
        const std::uint64_t fits = std::min(count, sink.room());
        stream_bytes(sink.place(), kept, fits * 3 * sizeof(Vertex));
        sink.skip(fits);
    }

    device* device_;
    std::optional<error> error_;
};

inline result<recorder> device::begin() { return recorder(*this); }
inline result<void> device::submit(recorder& done) {
    const zone here(hooks(), "submit");
    if (done.error_) {
        return failure(*done.error_);
    }
    return {};
}

} // namespace skybark::cpu
