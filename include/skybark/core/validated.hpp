#pragma once
// validated<B>: a backend that wraps another behind the same contract and checks every call.
//
//     auto checked = skybark::validated<my::device>(device, [](std::string_view sentence) { … });
//
// What is misuse on a backend (a view outside its buffer, a recorder submitted twice, a target that
// cannot be drawn into) is told to the handler as a full sentence with the values, and the call is
// not passed on. Without a handler the program aborts; the sentence is then in `last_misuse()`, for
// a debugger to show. Nothing is printed.
//
// It models every pattern that B models, and no more. It costs host time on each call and nothing
// on the device. It cannot see what a kernel reads and writes: an index in a buffer that points
// outside another one stays unseen.
//
// The wrapped device must outlive it and all that it made. A buffer's memory stays where it is when
// its owner moves, as views of it may have been recorded.

#include <skybark/core/backend.hpp>
#include <skybark/core/validated_gather.hpp>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace skybark {

/// Called with a full sentence about a call that was wrong.
using misuse_handler = std::function<void(std::string_view sentence)>;

namespace detail {

/// Where the objects of one validated device tell of misuse.
struct misuse_log {
    misuse_handler handler;
    std::string last;

    void tell(std::string sentence) {
        last = std::move(sentence);
        if (!handler) {
            std::abort();
        }
        handler(last);
    }
};

[[nodiscard]] inline std::string digits(std::uint64_t value) { return std::to_string(value); }

/// Whether bytes [a, a + a_size) and [b, b + b_size) have one in common.
[[nodiscard]] constexpr bool overlap(std::uint64_t a, std::uint64_t a_size, std::uint64_t b,
                                     std::uint64_t b_size) {
    return a_size != 0 && b_size != 0 && a < b + b_size && b < a + a_size;
}

/// A backend's volume, or nothing where it has none.
struct no_volume {};
template <class B>
struct volume_type {
    using type = no_volume;
};
template <class B>
requires requires { typename B::volume; }
struct volume_type<B> {
    using type = typename B::volume;
};

[[nodiscard]] constexpr const char* name_of(volume_format format) {
    switch (format) {
    case volume_format::int32:
        return "int32";
    case volume_format::float32:
        return "float32";
    case volume_format::float16:
        break;
    }
    return "float16";
}

/// An object of the wrapped device, and whose it is.
template <class T>
struct held {
    T object;
    std::shared_ptr<misuse_log> log;
};

} // namespace detail

template <backend B>
class validated {
  public:
    using backend_tag = skybark::backend_tag;

    class buffer {
      public:
        [[nodiscard]] std::uint64_t size_bytes() const noexcept {
            return held_ ? held_->object.size_bytes() : 0;
        }
        /// The wrapped device's own; not after a move.
        [[nodiscard]] const typename B::buffer& inner() const { return held_->object; }

      private:
        friend class validated;
        using held_type = detail::held<typename B::buffer>;
        explicit buffer(std::shared_ptr<const held_type> held) : held_(std::move(held)) {}
        std::shared_ptr<const held_type> held_;
    };

    class image {
      public:
        [[nodiscard]] image_description description() const {
            return held_ ? image_description(held_->object.description()) : image_description{};
        }
        [[nodiscard]] const typename B::image& inner() const { return held_->object; }

      private:
        friend class validated;
        using held_type = detail::held<typename B::image>;
        explicit image(std::shared_ptr<const held_type> held) : held_(std::move(held)) {}
        std::shared_ptr<const held_type> held_;
    };

    /// Only where the wrapped device has volumes is there a way to get one.
    class volume {
      public:
        [[nodiscard]] volume_description description() const {
            return held_ ? volume_description(held_->object.description()) : volume_description{};
        }
        [[nodiscard]] const typename detail::volume_type<B>::type& inner() const {
            return held_->object;
        }

      private:
        friend class validated;
        using held_type = detail::held<typename detail::volume_type<B>::type>;
        explicit volume(std::shared_ptr<const held_type> held) : held_(std::move(held)) {}
        std::shared_ptr<const held_type> held_;
    };

    class recorder;

    explicit validated(B& inner, misuse_handler on_misuse = {})
        : inner_(&inner), log_(std::make_shared<detail::misuse_log>()) {
        log_->handler = std::move(on_misuse);
    }

    [[nodiscard]] B& inner() const noexcept { return *inner_; }
    /// The latest sentence; empty when there was none.
    [[nodiscard]] const std::string& last_misuse() const noexcept { return log_->last; }

    [[nodiscard]] std::string_view name() const { return inner_->name(); }
    [[nodiscard]] std::string device_name() const { return inner_->device_name(); }
    [[nodiscard]] device_limits limits() const { return inner_->limits(); }
    [[nodiscard]] device_traffic traffic() const { return inner_->traffic(); }

    [[nodiscard]] result<buffer> create_buffer(std::uint64_t bytes) {
        return hold<buffer>(inner_->create_buffer(bytes));
    }
    [[nodiscard]] result<image> create_image(image_description what) {
        if (what.width == 0 || what.height == 0) {
            return refuse("create_image: an image of " + sides(what) + " pixels has no pixels.");
        }
        return hold<image>(inner_->create_image(what));
    }
    [[nodiscard]] result<volume> create_volume(volume_description what) requires volume_backend<B> {
        if (what.width == 0 || what.height == 0 || what.depth == 0) {
            return refuse("create_volume: a volume of " + sides(what) + " voxels has no voxels.");
        }
        return hold<volume>(inner_->create_volume(what));
    }

    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> bytes) {
        if (auto wrong = check_bytes("upload", to, offset, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->upload(to.inner(), offset, bytes);
    }
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> bytes) {
        if (auto wrong = check_bytes("download", from, offset, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->download(from.inner(), offset, bytes);
    }
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> bytes) {
        if (auto wrong = check_pixels("upload", to, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->upload(to.inner(), bytes);
    }
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> bytes) {
        if (auto wrong = check_pixels("download", from, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->download(from.inner(), bytes);
    }

    [[nodiscard]] result<void> upload(const volume& to,
                                      std::span<const std::byte> bytes) requires volume_backend<B> {
        if (auto wrong = check_voxels("upload", to, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->upload(to.inner(), bytes);
    }
    [[nodiscard]] result<void> download(const volume& from,
                                        std::span<std::byte> bytes) requires volume_backend<B> {
        if (auto wrong = check_voxels("download", from, bytes.size()); !wrong.empty()) {
            return refuse(std::move(wrong));
        }
        return inner_->download(from.inner(), bytes);
    }

    [[nodiscard]] result<recorder> begin() {
        auto begun = inner_->begin();
        if (!begun) {
            return failure(begun.error());
        }
        return recorder(std::move(*begun), log_, limits());
    }
    [[nodiscard]] result<void> submit(recorder& done) {
        if (done.log_ != log_) {
            return refuse("submit: the recorder was begun on another device or moved from.");
        }
        if (done.submitted_) {
            return refuse("submit: the recorder has been submitted before.");
        }
        done.submitted_ = true;
        for (const std::weak_ptr<const void>& used : done.used_) {
            if (used.expired()) {
                return refuse("submit: a buffer, an image or a volume that the recorder uses is "
                              "gone; it must outlive the submission.");
            }
        }
        return inner_->submit(done.inner_);
    }

  private:
    template <class Object, class Made>
    [[nodiscard]] result<Object> hold(result<Made> made) {
        if (!made) {
            return failure(made.error());
        }
        using held_type = typename Object::held_type;
        return Object(std::make_shared<const held_type>(held_type{std::move(*made), log_}));
    }
    /// Misuse has no error value; a handler that returns gets this one back.
    [[nodiscard]] failure refuse(std::string sentence) {
        log_->tell(sentence);
        return fail(error_code::bad_input, std::move(sentence));
    }

    [[nodiscard]] static std::string sides(image_description what) {
        return detail::digits(what.width) + " x " + detail::digits(what.height);
    }
    [[nodiscard]] static std::string sides(volume_description what) {
        return detail::digits(what.width) + " x " + detail::digits(what.height) + " x " +
               detail::digits(what.depth);
    }
    template <class Object>
    [[nodiscard]] static std::string check_owner(const std::string& where, const Object& object,
                                                 const std::shared_ptr<detail::misuse_log>& log) {
        if (!object.held_) {
            return where + " has been moved from.";
        }
        return object.held_->log == log ? "" : where + " belongs to another device.";
    }
    [[nodiscard]] std::string check_bytes(const std::string& call, const buffer& at,
                                          std::uint64_t offset, std::uint64_t size) const {
        if (auto wrong = check_owner(call + ": the buffer", at, log_); !wrong.empty()) {
            return wrong;
        }
        if (offset > at.size_bytes() || size > at.size_bytes() - offset) {
            return call + ": " + detail::digits(size) + " bytes at offset " +
                   detail::digits(offset) + " lie outside a buffer of " +
                   detail::digits(at.size_bytes()) + " bytes.";
        }
        return "";
    }
    [[nodiscard]] std::string check_pixels(const std::string& call, const image& at,
                                           std::uint64_t size) const {
        if (auto wrong = check_owner(call + ": the image", at, log_); !wrong.empty()) {
            return wrong;
        }
        const image_description what = at.description();
        const std::uint64_t needed =
            std::uint64_t{what.width} * what.height * bytes_per_pixel(what.format);
        return size == needed
                   ? ""
                   : call + ": an image of " + sides(what) + " pixels has " +
                         detail::digits(needed) + " bytes, not " + detail::digits(size) + ".";
    }
    [[nodiscard]] std::string check_voxels(const std::string& call, const volume& at,
                                           std::uint64_t size) const {
        if (auto wrong = check_owner(call + ": the volume", at, log_); !wrong.empty()) {
            return wrong;
        }
        const volume_description what = at.description();
        return size == what.size_bytes() ? ""
                                         : call + ": a volume of " + sides(what) + " voxels of " +
                                               detail::name_of(what.format) + " has " +
                                               detail::digits(what.size_bytes()) + " bytes, not " +
                                               detail::digits(size) + ".";
    }

    B* inner_;
    std::shared_ptr<detail::misuse_log> log_;
};

/// Checks each pattern and passes it on when nothing is wrong with it.
template <backend B>
class validated<B>::recorder {
  public:
    using view = buffer_view<validated>;

    void upload(const view& to, std::span<const std::byte> bytes) {
        check c(*this, "upload");
        c.view(to, "the view");
        c.that(bytes.size() <= to.size, detail::digits(bytes.size()) +
                                            " bytes do not fit into a view of " +
                                            detail::digits(to.size) + ".");
        if (c.passed()) {
            inner_.upload(convert(to), bytes);
        }
    }
    void copy(const view& from, const view& to) {
        check c(*this, "copy");
        c.view(from, "the source");
        c.view(to, "the destination");
        c.that(from.size == to.size, "the source has " + detail::digits(from.size) +
                                         " bytes and the destination " + detail::digits(to.size) +
                                         ".");
        c.apart(from, "the source", to, "the destination");
        if (c.passed()) {
            inner_.copy(convert(from), convert(to));
        }
    }

    template <map_kernel K>
    requires maps<B, K>
    void map(const K& kernel, const bindings<validated, K>& buffers, range elements) {
        check c(*this, "map");
        c.template buffers<K>(buffers, true);
        c.elements(elements);
        if (c.passed()) {
            inner_.map(kernel, convert(buffers), elements);
        }
    }
    template <map_kernel K>
    requires maps<B, K>
    void map(const K& kernel, const bindings<validated, K>& buffers,
             std::span<const range> ranges) {
        check c(*this, "map over ranges");
        c.template buffers<K>(buffers, true);
        c.levels(ranges);
        if (c.passed()) {
            inner_.map(kernel, convert(buffers), ranges);
        }
    }
    template <map_kernel K>
    requires maps<B, K>
    void map(const K& kernel, const bindings<validated, K>& buffers,
             const counted<validated>& elements) {
        check c(*this, "map over a count");
        c.template buffers<K>(buffers, true);
        c.length(elements);
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            if (K::buffers::writes[i]) {
                c.apart(buffers[i], slot_name(i), elements.count, "the count");
            }
        }
        if (c.passed()) {
            inner_.map(kernel, convert(buffers), convert(elements));
        }
    }

    template <strip_kernel K>
    requires expands<B, K>
    void expand(const K& kernel, const bindings<validated, K>& buffers, range elements,
                const triangle_list<validated>& out) {
        check c(*this, "expand");
        c.elements(elements);
        check_list(c, kernel, buffers, elements.count, out);
        if (c.passed()) {
            inner_.expand(kernel, convert(buffers), elements, convert(out));
        }
    }
    template <strip_kernel K>
    requires expands<B, K>
    void expand(const K& kernel, const bindings<validated, K>& buffers,
                const counted<validated>& elements, const triangle_list<validated>& out) {
        check c(*this, "expand over a count");
        c.length(elements);
        check_list(c, kernel, buffers, elements.limit, out);
        c.apart(out.vertices, "the vertices", elements.count, "the count that is read");
        if (c.passed()) {
            inner_.expand(kernel, convert(buffers), convert(elements), convert(out));
        }
    }

    template <ring_kernel K>
    requires expands_rings<B, K>
    void expand_rings(const K& kernel, const bindings<validated, K>& buffers, range elements,
                      const view& vertices) {
        check c(*this, "expand_rings");
        c.template buffers<K>(buffers, false);
        c.elements(elements);
        c.view(vertices, "the view of the vertices");
        check_rings(c, kernel);
        const std::uint64_t needed =
            std::uint64_t{elements.count} * kernel.ring_vertices() * sizeof(typename K::vertex);
        c.that(needed <= vertices.size, detail::digits(elements.count) + " elements of " +
                                            detail::digits(kernel.ring_vertices()) +
                                            " vertices need " + detail::digits(needed) +
                                            " bytes, and the view has " +
                                            detail::digits(vertices.size) + ".");
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            c.apart(buffers[i], slot_name(i), vertices, "the vertices");
        }
        if (c.passed()) {
            inner_.expand_rings(kernel, convert(buffers), elements, convert(vertices));
        }
    }

    template <draw_kernel K>
    requires draws<B, K>
    void draw(const K& kernel, const bindings<validated, K>& buffers,
              const image_bindings<validated, K>& images, const draw_geometry<validated>& geometry,
              const draw_target<validated>& target, draw_state state) {
        check c(*this, "draw");
        check_draw<K>(c, buffers, images, geometry, target);
        if (c.passed()) {
            inner_.draw(kernel, convert(buffers), convert<K>(images), convert(geometry),
                        convert(target), state);
        }
    }
    template <draw_kernel K>
    requires draws_volumes<B, K>
    void draw(const K& kernel, const bindings<validated, K>& buffers,
              const image_bindings<validated, K>& images,
              const volume_bindings<validated, K>& volumes,
              const draw_geometry<validated>& geometry, const draw_target<validated>& target,
              draw_state state) {
        check c(*this, "draw with volumes");
        check_draw<K>(c, buffers, images, geometry, target);
        check_volumes<K>(c, volumes);
        if (c.passed()) {
            inner_.draw(kernel, convert(buffers), convert<K>(images), convert<K>(volumes),
                        convert(geometry), convert(target), state);
        }
    }

    template <grid_map_kernel K>
    requires maps_grids<B, K>
    void map(const K& kernel, const bindings<validated, K>& buffers,
             const volume_bindings<validated, K>& volumes, range elements) {
        check c(*this, "map with volumes");
        c.template buffers<K>(buffers, true);
        check_volumes<K>(c, volumes);
        c.elements(elements);
        if (c.passed()) {
            inner_.map(kernel, convert(buffers), convert<K>(volumes), elements);
        }
    }
    template <voxel_kernel K>
    requires maps_voxels<B, K>
    void map_voxels(const K& kernel, const bindings<validated, K>& buffers,
                    const volume_bindings<validated, K>& volumes, glm::uvec3 extent) {
        check c(*this, "map_voxels");
        c.template buffers<K>(buffers, true);
        check_volumes<K>(c, volumes);
        const std::uint32_t longest = std::max({extent.x, extent.y, extent.z});
        c.that(longest <= limits_.max_volume_size,
               "the extent of " + sides(volume_description{extent.x, extent.y, extent.z, {}}) +
                   " voxels is longer than a volume may be, " +
                   detail::digits(limits_.max_volume_size) + ".");
        if (c.passed()) {
            inner_.map_voxels(kernel, convert(buffers), convert<K>(volumes), extent);
        }
    }

    template <slab_kernel K>
    requires accumulates<B, K>
    void accumulate(const K& kernel, const bindings<validated, K>& buffers, range elements,
                    const accumulation<validated>& how) {
        check c(*this, "accumulate");
        c.elements(elements);
        check_accumulation(c, kernel, buffers, how.into, "the volume to add to");
        if (c.passed()) {
            inner_.accumulate(kernel, convert(buffers), elements, convert(how));
        }
    }
    template <slab_kernel K>
    requires accumulates<B, K>
    void accumulate(const K& kernel, const bindings<validated, K>& buffers,
                    const counted<validated>& elements, const accumulation<validated>& how) {
        check c(*this, "accumulate over a count");
        c.length(elements);
        check_accumulation(c, kernel, buffers, how.into, "the volume to add to");
        if (c.passed()) {
            inner_.accumulate(kernel, convert(buffers), convert(elements), convert(how));
        }
    }
    template <slab_kernel K>
    requires fuses_accumulate_scan<B, K>
    void accumulate_scan(const K& kernel, const bindings<validated, K>& buffers, range elements,
                         const volume& scratch, const volume& to, const volume_scan& how) {
        check c(*this, "accumulate_scan");
        c.elements(elements);
        check_accumulation(c, kernel, buffers, &scratch, "the scratch volume");
        check_scan(c, scratch, to, how);
        if (c.passed()) {
            inner_.accumulate_scan(kernel, convert(buffers), elements, scratch.inner(), to.inner(),
                                   how);
        }
    }

    void scan(const volume& from, const volume& to,
              const volume_scan& how) requires volume_backend<B> {
        check c(*this, "scan");
        check_scan(c, from, to, how);
        if (c.passed()) {
            inner_.scan(from.inner(), to.inner(), how);
        }
    }
    void scan(const view& words, const view& total) requires scans<B> {
        check c(*this, "scan of words");
        c.view(words, "the view of the words");
        c.view(total, "the view of the total");
        c.that(total.size >= 4, "the view of the total is empty.");
        c.apart(words, "the words", total, "the total");
        c.elements(words_in(words));
        if (c.passed()) {
            inner_.scan(convert(words), convert(total));
        }
    }

    void sort(const view& keys, const view& values, std::uint32_t key_bits = 32) requires sorts<B> {
        check c(*this, "sort");
        check_pairs(c, keys, values, key_bits);
        if (c.passed()) {
            inner_.sort(convert(keys), convert(values), key_bits);
        }
    }
    void sort(const view& keys, const view& values, const counted<validated>& pairs,
              std::uint32_t key_bits = 32) requires sorts<B> {
        check c(*this, "sort of a count");
        check_pairs(c, keys, values, key_bits);
        c.length(pairs);
        c.that(pairs.limit <= keys.size / 4, "the count may reach " + detail::digits(pairs.limit) +
                                                 ", and there are " +
                                                 detail::digits(keys.size / 4) + " pairs.");
        c.apart(keys, "the keys", pairs.count, "the count");
        c.apart(values, "the values", pairs.count, "the count");
        if (c.passed()) {
            inner_.sort(convert(keys), convert(values), convert(pairs), key_bits);
        }
    }

    template <peel_kernel K>
    requires peels<B, K>
    void peel(const K& kernel, const bindings<validated, K>& buffers, range triangles,
              const peeled_layer<validated>& layer) {
        check c(*this, "peel");
        c.template buffers<K>(buffers, false);
        c.elements(triangles);
        c.that(3 * (std::uint64_t{triangles.first} + triangles.count) <= std::uint64_t{1} << 32,
               "triangles from " + detail::digits(triangles.first) + " on, " +
                   detail::digits(triangles.count) + " of them, have corners beyond 32 bits.");
        detail::check_layer(c, layer, buffers, limits_);
        if (c.passed()) {
            inner_.peel(kernel, convert(buffers), triangles, convert(layer));
        }
    }
    void resolve(const ray_bundle& bundle,
                 const bundle_work<validated>& work) requires resolves_bundles<B> {
        check c(*this, "resolve");
        detail::check_bundle(c, bundle);
        detail::check_bundle_work(c, work, limits_);
        if (c.passed()) {
            inner_.resolve(bundle, bundle_work<B>{convert(work.triangles), convert(work.alpha),
                                                  convert(work.samples), convert(work.hits)});
        }
    }

  private:
    friend class validated;

    recorder(typename B::recorder inner, std::shared_ptr<detail::misuse_log> log,
             device_limits limits)
        : inner_(std::move(inner)), log_(std::move(log)), limits_(limits) {}

    [[nodiscard]] static std::string slot_name(std::size_t i) {
        return "buffer " + detail::digits(i);
    }

    /// The checks of one call. Only the first thing that is wrong is told.
    class check {
      public:
        check(recorder& on, const char* call) : on_(on), call_(call) {
            that(on.log_ != nullptr, "the recorder has been moved from.");
            that(!on.submitted_, "the recorder has been submitted already.");
        }

        [[nodiscard]] bool passed() const { return passed_; }

        void that(bool right, const std::string& sentence) {
            if (passed_ && !right) {
                passed_ = false;
                if (on_.log_) {
                    on_.log_->tell(std::string(call_) + ": " + sentence);
                }
            }
        }
        void view(const buffer_view<validated>& v, const std::string& what) {
            that(v.buffer != nullptr, what + " names no buffer.");
            owned(v.buffer, what);
            if (!passed_) {
                return;
            }
            const std::uint64_t size = v.buffer->size_bytes();
            that(v.offset <= size && v.size <= size - v.offset,
                 what + " has " + detail::digits(v.size) + " bytes at offset " +
                     detail::digits(v.offset) + ", outside its buffer of " + detail::digits(size) +
                     " bytes.");
            const std::uint64_t align = std::max<std::uint64_t>(1, on_.limits_.view_alignment);
            that(v.offset % align == 0, what + " starts at byte " + detail::digits(v.offset) +
                                            ", which is no multiple of the device's alignment of " +
                                            detail::digits(align) + ".");
            that(v.size <= on_.limits_.max_buffer_bytes,
                 what + " has " + detail::digits(v.size) + " bytes; a kernel can be given " +
                     detail::digits(on_.limits_.max_buffer_bytes) + " at most.");
            that(v.size % 4 == 0, what + " has " + detail::digits(v.size) +
                                      " bytes, which are not whole 32-bit words.");
        }
        void image(const validated::image* image, const std::string& what) {
            that(image != nullptr, what + " is not given.");
            owned(image, what);
        }
        void volume(const validated::volume* volume, const std::string& what) {
            that(volume != nullptr, what + " is not given.");
            owned(volume, what);
        }
        void format(const validated::volume* volume, const std::string& what,
                    std::initializer_list<volume_format> right) {
            if (passed_) {
                const volume_format has = volume->description().format;
                that(std::find(right.begin(), right.end(), has) != right.end(),
                     what + " has the format " + detail::name_of(has) + ", which cannot be.");
            }
        }
        void apart(const buffer_view<validated>& a, const std::string& what_a,
                   const buffer_view<validated>& b, const std::string& what_b) {
            that(a.buffer != b.buffer || !detail::overlap(a.offset, a.size, b.offset, b.size),
                 what_a + " and " + what_b + " overlap in one buffer, at bytes " +
                     detail::digits(a.offset) + " and " + detail::digits(b.offset) + ".");
        }
        /// `both_ways`: whether what is read may overlap what is written.
        template <class K>
        void buffers(const bindings<validated, K>& views, bool both_ways) {
            for (std::size_t i = 0; i < views.size(); ++i) {
                view(views[i], slot_name(i));
                that(!K::buffers::writes[i] || both_ways,
                     slot_name(i) + " is declared writeonly, but only map writes buffers.");
            }
            for (std::size_t i = 0; i < views.size(); ++i) {
                for (std::size_t j = i + 1; j < views.size(); ++j) {
                    if (K::buffers::writes[i] && K::buffers::writes[j]) {
                        apart(views[i], slot_name(i), views[j], slot_name(j));
                    }
                }
            }
        }
        void elements(range r) {
            that(r.count <= on_.limits_.max_elements,
                 detail::digits(r.count) + " elements are more than the " +
                     detail::digits(on_.limits_.max_elements) + " that one call takes.");
            that(std::uint64_t{r.first} + r.count <= std::uint64_t{1} << 32,
                 "elements from " + detail::digits(r.first) + " on, " + detail::digits(r.count) +
                     " of them, end beyond 32 bits.");
        }
        void length(const counted<validated>& c) {
            view(c.count, "the count");
            that(c.count.size >= sizeof(count_record), "the count's view has " +
                                                           detail::digits(c.count.size) +
                                                           " bytes; a count_record has 16.");
            elements({0, c.limit});
        }
        /// Ranges run upwards, or downwards, and share no element.
        void levels(std::span<const range> ranges) {
            bool up = true;
            bool down = true;
            for (std::size_t i = 0; i < ranges.size(); ++i) {
                elements(ranges[i]);
                if (i != 0) {
                    const range a = ranges[i - 1];
                    const range b = ranges[i];
                    up = up && std::uint64_t{a.first} + a.count <= b.first;
                    down = down && std::uint64_t{b.first} + b.count <= a.first;
                    that(up || down, "range " + detail::digits(i) + ", from " +
                                         detail::digits(b.first) +
                                         " on, overlaps the one before "
                                         "it or turns back: ranges run up or down, in order.");
                }
            }
        }

      private:
        template <class Object>
        void owned(const Object* object, const std::string& what) {
            if (passed_) {
                const std::string wrong = check_owner(what, *object, on_.log_);
                that(wrong.empty(), wrong);
            }
            if (passed_) {
                on_.used_.push_back(object->held_);
            }
        }

        recorder& on_;
        const char* call_;
        bool passed_ = true;
    };

    template <class K>
    static void check_list(check& c, const K& kernel, const bindings<validated, K>& buffers,
                           std::uint64_t elements, const triangle_list<validated>& out) {
        c.template buffers<K>(buffers, false);
        c.view(out.vertices, "the view of the vertices");
        c.view(out.count, "the view of the count");
        c.that(out.count.size >= sizeof(count_record), "the count's view has " +
                                                           detail::digits(out.count.size) +
                                                           " bytes; a count_record has 16.");
        c.apart(out.vertices, "the vertices", out.count, "the count");
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            c.apart(buffers[i], slot_name(i), out.vertices, "the vertices");
            c.apart(buffers[i], slot_name(i), out.count, "the count");
        }
        const std::uint64_t each = max_triangles(kernel);
        c.that(each != 0 && each < std::uint64_t{1} << 31,
               "the kernel's parameters make up to " + detail::digits(kernel.strips()) +
                   " strips of " + detail::digits(kernel.strip_triangles()) +
                   " triangles an element, which cannot be meant.");
        c.that(!c.passed() || each * elements < std::uint64_t{1} << 32,
               detail::digits(elements) + " elements of up to " + detail::digits(each) +
                   " triangles are more than a 32-bit count holds: go on in chunks.");
    }
    template <class K>
    static void check_rings(check& c, const K& kernel) {
        const std::uint32_t vertices = kernel.ring_vertices();
        const std::uint32_t triangles = kernel.ring_triangles();
        c.that(vertices != 0 && triangles != 0 && vertices < 1u << 31 && triangles < 1u << 30,
               "the kernel's parameters make " + detail::digits(vertices) + " vertices and " +
                   detail::digits(triangles) + " triangles an element, which cannot be meant.");
        const std::uint32_t looked_at = c.passed() ? std::min(3 * triangles, 3000u) : 0;
        for (std::uint32_t k = 0; k < looked_at && c.passed(); ++k) {
            c.that(kernel.ring_index(k) < vertices,
                   "the kernel's index " + detail::digits(k) + " is " +
                       detail::digits(kernel.ring_index(k)) + ", and an element has " +
                       detail::digits(vertices) + " vertices.");
        }
    }
    template <class K>
    static void check_draw(check& c, const bindings<validated, K>& buffers,
                           const image_bindings<validated, K>& images,
                           const draw_geometry<validated>& geometry,
                           const draw_target<validated>& target) {
        c.template buffers<K>(buffers, false);
        check_target(c, target);
        for (std::size_t i = 0; i < images.size(); ++i) {
            const std::string which = "image " + detail::digits(i);
            c.image(images[i].image, which);
            c.that(images[i].image == nullptr ||
                       (images[i].image != target.color && images[i].image != target.depth),
                   which + " is also drawn into.");
        }
        check_geometry(c, geometry);
    }
    template <class K>
    static void check_volumes(check& c, const volume_bindings<validated, K>& volumes) {
        const auto name = [](const char* kind, std::size_t i) {
            return std::string(kind) + detail::digits(i);
        };
        for (std::size_t i = 0; i < volumes.read.size(); ++i) {
            c.volume(volumes.read[i], name("volume ", i));
            c.format(volumes.read[i], name("volume ", i),
                     {volume_format::float32, volume_format::float16});
        }
        for (std::size_t i = 0; i < volumes.write.size(); ++i) {
            c.volume(volumes.write[i], name("target volume ", i));
            c.format(volumes.write[i], name("target volume ", i), {volume_format::float32});
            for (std::size_t j = 0; j < volumes.read.size(); ++j) {
                c.that(volumes.write[i] != volumes.read[j], name("target volume ", i) +
                                                                " is also " + name("volume ", j) +
                                                                ", which is read.");
            }
            for (std::size_t j = 0; j < i; ++j) {
                c.that(volumes.write[i] != volumes.write[j], name("target volume ", j) + " and " +
                                                                 name("target volume ", i) +
                                                                 " are one volume.");
            }
        }
    }
    template <class K>
    static void check_accumulation(check& c, const K& kernel, const bindings<validated, K>& buffers,
                                   const volume* into, const std::string& what) {
        c.template buffers<K>(buffers, false);
        c.volume(into, what);
        c.format(into, what, {volume_format::int32});
        c.that(kernel.slabs() < 1u << 31, "the kernel's parameters make up to " +
                                              detail::digits(kernel.slabs()) +
                                              " slabs an element, which cannot be meant.");
    }
    static void check_scan(check& c, const volume& from, const volume& to, const volume_scan& how) {
        c.volume(&from, "the source");
        c.volume(&to, "the destination");
        c.that(&from != &to, "the source is also the destination.");
        if (!c.passed()) {
            return;
        }
        const volume_description a = from.description();
        const volume_description b = to.description();
        c.that(a.width == b.width && a.height == b.height && a.depth == b.depth,
               "the source has " + sides(a) + " voxels and the destination " + sides(b) + ".");
        c.format(&from, "the source", {volume_format::int32, volume_format::float32});
        c.that(a.format == volume_format::int32 || b.format != volume_format::int32,
               "the source is of float32 and the destination of int32: floats stay floats.");
        c.that(b.format != volume_format::int32 ||
                   (how.share != scan_share::half && how.scale == 1.0f),
               "whole numbers are asked for, with a scale of " + std::to_string(how.scale) +
                   (how.share == scan_share::half ? " and halves of voxels." : "."));
    }
    [[nodiscard]] static range words_in(const view& v) {
        return {0, static_cast<std::uint32_t>(std::min<std::uint64_t>(v.size / 4, 0xffffffff))};
    }
    static void check_pairs(check& c, const view& keys, const view& values,
                            std::uint32_t key_bits) {
        c.view(keys, "the view of the keys");
        c.view(values, "the view of the values");
        c.that(keys.size == values.size, "there are " + detail::digits(keys.size / 4) +
                                             " keys and " + detail::digits(values.size / 4) +
                                             " values.");
        c.apart(keys, "the keys", values, "the values");
        c.elements(words_in(keys));
        c.that(key_bits <= 32,
               "keys of " + detail::digits(key_bits) + " bits are given; a key has 32.");
    }
    static void check_target(check& c, const draw_target<validated>& target) {
        c.that(target.color != nullptr || target.depth != nullptr,
               "there is nothing to draw into.");
        if (target.color != nullptr) {
            c.image(target.color, "the colour target");
            c.that(target.color->description().format != image_format::depth32f,
                   "the colour target has the format depth32f.");
        }
        if (target.depth != nullptr) {
            c.image(target.depth, "the depth target");
            c.that(target.depth->description().format == image_format::depth32f,
                   "the depth target has a format other than depth32f.");
        }
        if (target.color != nullptr && target.depth != nullptr) {
            const image_description a = target.color->description();
            const image_description b = target.depth->description();
            c.that(a.width == b.width && a.height == b.height, "the colour target has " + sides(a) +
                                                                   " pixels and the depth target " +
                                                                   sides(b) + ".");
        }
        c.that(!target.clear_color || target.color != nullptr,
               "a colour to clear with is given, and no colour target.");
        c.that(!target.clear_depth || target.depth != nullptr,
               "a depth to clear with is given, and no depth target.");
        c.that(!target.clear_depth || (*target.clear_depth >= 0 && *target.clear_depth <= 1),
               "the depth to clear with is " + std::to_string(target.clear_depth.value_or(0)) +
                   "; depths run from 0 to 1.");
    }
    static void check_geometry(check& c, const draw_geometry<validated>& g) {
        if (g.length) {
            c.view(g.length, "the length");
            c.that(g.length.size >= sizeof(count_record), "the length's view has " +
                                                              detail::digits(g.length.size) +
                                                              " bytes; a count_record has 16.");
        } else {
            c.that(g.count % 3 == 0,
                   detail::digits(g.count) + " vertices or indices are not whole triangles.");
        }
        const std::uint64_t last = std::uint64_t{g.first} + (g.length ? 0 : g.count);
        if (g.indices) {
            c.view(g.indices, "the indices");
            c.that(last * 4 <= g.indices.size, "indices up to " + detail::digits(last) +
                                                   " are drawn, and the view holds " +
                                                   detail::digits(g.indices.size / 4) + ".");
        } else {
            c.that(last + g.base_vertex <= std::uint64_t{1} << 32,
                   "vertices up to " + detail::digits(last + g.base_vertex) +
                       " are drawn, beyond 32 bits.");
        }
    }

    [[nodiscard]] static buffer_view<B> convert(const view& v) {
        return v ? buffer_view<B>{&v.buffer->inner(), v.offset, v.size} : buffer_view<B>{};
    }
    template <std::size_t N>
    [[nodiscard]] static std::array<buffer_view<B>, N> convert(const std::array<view, N>& views) {
        std::array<buffer_view<B>, N> converted{};
        for (std::size_t i = 0; i < N; ++i) {
            converted[i] = convert(views[i]);
        }
        return converted;
    }
    [[nodiscard]] static counted<B> convert(const counted<validated>& c) {
        return {convert(c.count), c.limit};
    }
    [[nodiscard]] static triangle_list<B> convert(const triangle_list<validated>& out) {
        return {convert(out.vertices), convert(out.count), out.policy};
    }
    [[nodiscard]] static peeled_layer<B> convert(const peeled_layer<validated>& layer) {
        return {layer.width, layer.height, convert(layer.depth), convert(layer.triangle),
                convert(layer.count)};
    }
    [[nodiscard]] static draw_geometry<B> convert(const draw_geometry<validated>& what) {
        return {convert(what.indices), what.first, what.count, what.base_vertex,
                convert(what.length)};
    }
    [[nodiscard]] static draw_target<B> convert(const draw_target<validated>& to) {
        return {to.color ? &to.color->inner() : nullptr, to.depth ? &to.depth->inner() : nullptr,
                to.clear_color, to.clear_depth};
    }
    template <class K>
    [[nodiscard]] static image_bindings<B, K> convert(const image_bindings<validated, K>& images) {
        image_bindings<B, K> bound{};
        for (std::size_t i = 0; i < images.size(); ++i) {
            bound[i] = {&images[i].image->inner(), images[i].filter, images[i].wrap};
        }
        return bound;
    }
    template <class K>
    [[nodiscard]] static volume_bindings<B, K>
    convert(const volume_bindings<validated, K>& volumes) {
        volume_bindings<B, K> bound{};
        for (std::size_t i = 0; i < volumes.read.size(); ++i) {
            bound.read[i] = &volumes.read[i]->inner();
        }
        for (std::size_t i = 0; i < volumes.write.size(); ++i) {
            bound.write[i] = &volumes.write[i]->inner();
        }
        return bound;
    }
    // A template because a backend without volumes has no accumulation<B>.
    template <class Accumulation>
    [[nodiscard]] static auto
    convert(const Accumulation& how) requires std::same_as<Accumulation, accumulation<validated>> {
        return accumulation<B>{&how.into->inner(), how.clear, how.route, how.policy};
    }

    typename B::recorder inner_;
    std::shared_ptr<detail::misuse_log> log_;
    device_limits limits_;
    std::vector<std::weak_ptr<const void>> used_;
    bool submitted_ = false;
};

} // namespace skybark
