#pragma once
// The device: an OpenGL 4.5 core context as a Skybark backend.
//
// The context is the caller's, or one that headless.hpp made. It must be current in the thread that
// calls, unless its description says how to make it so. Every state of the caller's is as it was
// after each call, but for these:
//  - errors that were pending before a call may be gone afterwards (OpenGL has one flag for all);
//  - the caller's queries count what we draw, and while one of PRIMITIVES_GENERATED or
//    TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN is active, `expand` fails with error_code::unavailable;
//  - conditional rendering must not be active: OpenGL does not tell, and would drop our draws.
//
// Buffers are OpenGL's, images are its 2-D textures, volumes its 3-D ones, and all three can be
// wrapped around the caller's. `expand` always goes through a geometry shader and transform
// feedback, `expand_rings` likewise.

#include <skybark/opengl/recorder.hpp>

namespace skybark::opengl {

class device {
  public:
    using backend_tag = skybark::backend_tag;
    using buffer = opengl::buffer;
    using image = opengl::image;
    using volume = opengl::volume;
    using recorder = opengl::recorder;

    /// Fails with error_code::unavailable where the context cannot do what is needed.
    [[nodiscard]] static result<device> create(description given);

    [[nodiscard]] std::string_view name() const noexcept { return "opengl"; }
    [[nodiscard]] std::string device_name() const { return context_->renderer; }
    [[nodiscard]] device_limits limits() const noexcept { return context_->limits; }
    [[nodiscard]] device_traffic traffic() const noexcept { return context_->traffic; }
    [[nodiscard]] device_usage usage() const noexcept { return context_->usage; }

    [[nodiscard]] result<buffer> create_buffer(std::uint64_t bytes);
    [[nodiscard]] result<image> create_image(const image_description& description);
    [[nodiscard]] result<volume> create_volume(const volume_description& description);

    /// The caller's buffer object of `bytes` bytes. It stays the caller's. To be uploaded to, it
    /// must have been made with GL_DYNAMIC_STORAGE_BIT, or by glBufferData.
    [[nodiscard]] buffer wrap_buffer(gl::handle name, std::uint64_t bytes) const {
        return {nullptr, name, bytes};
    }
    /// The caller's GL_TEXTURE_2D with this level 0. It stays the caller's.
    [[nodiscard]] image wrap_image(gl::handle name, const image_description& description) const {
        return {nullptr, name, description};
    }
    /// The caller's GL_TEXTURE_3D of GL_R32I, GL_R32F or GL_R16F with this level 0. It stays the
    /// caller's.
    [[nodiscard]] volume wrap_volume(gl::handle name, const volume_description& description) const {
        return {nullptr, name, description};
    }

    /// Names that debuggers show, in place of ours, where the description asks for names.
    void set_name(const buffer& what, const char* name) const {
        set_name(gl::object_buffer, what.name(), name);
    }
    void set_name(const image& what, const char* name) const {
        set_name(gl::object_texture, what.name(), name);
    }
    void set_name(const volume& what, const char* name) const {
        set_name(gl::object_texture, what.name(), name);
    }

    [[nodiscard]] result<void> upload(const buffer& to, std::uint64_t offset,
                                      std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const buffer& from, std::uint64_t offset,
                                        std::span<std::byte> bytes);
    [[nodiscard]] result<void> upload(const image& to, std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const image& from, std::span<std::byte> bytes);
    [[nodiscard]] result<void> upload(const volume& to, std::span<const std::byte> bytes);
    [[nodiscard]] result<void> download(const volume& from, std::span<std::byte> bytes);

    [[nodiscard]] result<recorder> begin();
    [[nodiscard]] result<void> submit(recorder& recorded);

  private:
    explicit device(std::unique_ptr<detail::context> context) : context_(std::move(context)) {}

    void set_name(gl::token kind, gl::handle object, const char* name) const {
        if (context_->labels() && context_->enter()) {
            context_->gl.object_label(kind, object, -1, name);
        }
    }

    std::unique_ptr<detail::context> context_;
};

namespace detail {

[[nodiscard]] inline bound_range bound(const buffer_view<device>& view) {
    if (view.buffer == nullptr) {
        return {};
    }
    assert(view.offset + view.size <= view.buffer->size_bytes() && "a view outside its buffer");
    return {view.buffer->name(), static_cast<std::ptrdiff_t>(view.offset),
            static_cast<std::ptrdiff_t>(view.size)};
}

template <std::size_t N>
[[nodiscard]] std::array<bound_range, N> bound(const std::array<buffer_view<device>, N>& views) {
    std::array<bound_range, N> ranges;
    for (std::size_t i = 0; i < N; ++i) {
        ranges[i] = bound(views[i]);
    }
    return ranges;
}

template <std::size_t N>
[[nodiscard]] std::array<gl::handle, N> names_of(const std::array<const volume*, N>& volumes) {
    std::array<gl::handle, N> names{};
    for (std::size_t i = 0; i < N; ++i) {
        assert(volumes[i] != nullptr && "a kernel given too few volumes");
        names[i] = volumes[i]->name();
    }
    return names;
}

/// A kernel's parameters as the bytes of its block: none where it has no members.
template <kernel K>
[[nodiscard]] std::span<const std::byte> bytes_of(const K& k) {
    return std::is_empty_v<K> ? std::span<const std::byte>{} : std::as_bytes(std::span(&k, 1));
}

} // namespace detail

// ---- device -------------------------------------------------------------------------------------

inline result<device> device::create(description given) {
    auto context = detail::context::create(std::move(given));
    if (!context) {
        return failure(context.error());
    }
    return device(std::move(*context));
}

inline result<buffer> device::create_buffer(std::uint64_t bytes) {
    if (auto entered = context_->enter(); !entered) {
        return failure(entered.error());
    }
    auto name = context_->create_buffer(bytes, "buffer");
    if (!name) {
        return failure(name.error());
    }
    context_->usage.add(bytes);
    return buffer(context_.get(), *name, bytes);
}

inline result<image> device::create_image(const image_description& description) {
    const auto [width, height, format] = description;
    const std::string text =
        "an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels";
    const std::uint32_t most = context_->limits.max_image_size;
    if (width == 0 || height == 0 || width > most || height > most) {
        return fail(error_code::out_of_memory, "The opengl backend cannot make " + text +
                                                   "; each side must be 1 to " +
                                                   std::to_string(most) + ".");
    }
    if (auto entered = context_->enter(); !entered) {
        return failure(entered.error());
    }
    context_->forget_errors();
    gl::handle name = 0;
    context_->gl.create_textures(gl::texture_2d, 1, &name);
    context_->label(gl::object_texture, name, "image");
    context_->gl.texture_storage_2d(name, 1, detail::format_of(format).internal,
                                    static_cast<int>(width), static_cast<int>(height));
    image made(context_.get(), name, description);
    context_->usage.add(detail::bytes_of(description));
    if (auto done = context_->check("making " + text); !done) {
        context_->say(log_level::warning, [&] { return done.error().message; });
        return failure(done.error());
    }
    context_->say_made("image", detail::bytes_of(description));
    return made;
}

inline result<volume> device::create_volume(const volume_description& description) {
    const auto [width, height, depth, format] = description;
    const std::string text = "a volume of " + std::to_string(width) + " x " +
                             std::to_string(height) + " x " + std::to_string(depth) +
                             " voxels of " + std::to_string(bytes_per_voxel(format)) + " bytes";
    const std::uint32_t most = context_->limits.max_volume_size;
    if (width == 0 || height == 0 || depth == 0 || width > most || height > most || depth > most) {
        return fail(error_code::out_of_memory, "The opengl backend cannot make " + text +
                                                   "; each side must be 1 to " +
                                                   std::to_string(most) + ".");
    }
    if (auto entered = context_->enter(); !entered) {
        return failure(entered.error());
    }
    context_->forget_errors();
    gl::handle name = 0;
    context_->gl.create_textures(gl::texture_3d, 1, &name);
    context_->label(gl::object_texture, name, "volume");
    context_->gl.texture_storage_3d(name, 1, detail::format_of(format).internal,
                                    static_cast<int>(width), static_cast<int>(height),
                                    static_cast<int>(depth));
    volume made(context_.get(), name, description);
    context_->usage.add(description.size_bytes());
    if (auto done = context_->check("making " + text); !done) {
        context_->say(log_level::warning, [&] { return done.error().message; });
        return failure(done.error());
    }
    context_->say_made("volume", description.size_bytes());
    return made;
}

inline result<void> device::upload(const buffer& to, std::uint64_t offset,
                                   std::span<const std::byte> bytes) {
    const zone here(context_->watchers(), "upload");
    assert(offset + bytes.size() <= to.size_bytes() && "an upload beyond the buffer's end");
    if (auto entered = context_->enter(); !entered || bytes.empty()) {
        return entered;
    }
    context_->forget_errors();
    context_->gl.named_buffer_sub_data(to.name(), static_cast<std::ptrdiff_t>(offset),
                                       static_cast<std::ptrdiff_t>(bytes.size()), bytes.data());
    context_->traffic.up += bytes.size();
    return context_->check("uploading to a buffer");
}

inline result<void> device::download(const buffer& from, std::uint64_t offset,
                                     std::span<std::byte> bytes) {
    const zone here(context_->watchers(), "download");
    assert(offset + bytes.size() <= from.size_bytes() && "a download beyond the buffer's end");
    if (auto entered = context_->enter(); !entered || bytes.empty()) {
        return entered;
    }
    context_->forget_errors();
    context_->gl.get_named_buffer_sub_data(from.name(), static_cast<std::ptrdiff_t>(offset),
                                           static_cast<std::ptrdiff_t>(bytes.size()), bytes.data());
    context_->traffic.down += bytes.size();
    return context_->check("downloading from a buffer");
}

inline result<void> device::upload(const image& to, std::span<const std::byte> bytes) {
    const zone here(context_->watchers(), "upload");
    const image_description what = to.description();
    assert(bytes.size() == detail::bytes_of(what) && "an upload of another size than the image's");
    if (auto entered = context_->enter(); !entered) {
        return entered;
    }
    context_->forget_errors();
    const detail::pixel_format format = detail::format_of(what.format);
    {
        const detail::saved_pixel_store packed(context_->gl, true);
        context_->gl.texture_sub_image_2d(to.name(), 0, 0, 0, static_cast<int>(what.width),
                                          static_cast<int>(what.height), format.format, format.type,
                                          bytes.data());
    }
    context_->traffic.up += bytes.size();
    return context_->check("uploading to an image");
}

inline result<void> device::download(const image& from, std::span<std::byte> bytes) {
    const zone here(context_->watchers(), "download");
    const image_description what = from.description();
    assert(bytes.size() == detail::bytes_of(what) && "a download of another size than the image's");
    if (auto entered = context_->enter(); !entered) {
        return entered;
    }
    context_->forget_errors();
    const detail::pixel_format format = detail::format_of(what.format);
    {
        const detail::saved_pixel_store packed(context_->gl, false);
        // The size in bytes is an int. A larger image has more than the call could copy.
        const auto most = static_cast<int>(std::min<std::size_t>(bytes.size(), 0x7fffffff));
        context_->gl.get_texture_image(from.name(), 0, format.format, format.type, most,
                                       bytes.data());
    }
    context_->traffic.down += bytes.size();
    return context_->check("downloading from an image");
}

inline result<void> device::upload(const volume& to, std::span<const std::byte> bytes) {
    const zone here(context_->watchers(), "upload");
    const volume_description what = to.description();
    assert(bytes.size() == what.size_bytes() && "an upload of another size than the volume's");
    if (auto entered = context_->enter(); !entered) {
        return entered;
    }
    context_->forget_errors();
    const detail::voxel_format format = detail::format_of(what.format);
    {
        const detail::saved_pixel_store packed(context_->gl, true);
        context_->gl.texture_sub_image_3d(
            to.name(), 0, 0, 0, 0, static_cast<int>(what.width), static_cast<int>(what.height),
            static_cast<int>(what.depth), format.format, format.type, bytes.data());
    }
    context_->traffic.up += bytes.size();
    return context_->check("uploading to a volume");
}

inline result<void> device::download(const volume& from, std::span<std::byte> bytes) {
    const zone here(context_->watchers(), "download");
    const volume_description what = from.description();
    assert(bytes.size() == what.size_bytes() && "a download of another size than the volume's");
    if (auto entered = context_->enter(); !entered) {
        return entered;
    }
    context_->forget_errors();
    const detail::voxel_format format = detail::format_of(what.format);
    // The size of what is copied is an int: a large volume comes in several runs of layers.
    const std::uint64_t layer = what.size_bytes() / what.depth;
    const auto run =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>(0x7fffffff / layer, 1, what.depth));
    {
        const detail::saved_pixel_store packed(context_->gl, false);
        for (std::uint32_t z = 0; z < what.depth; z += run) {
            const std::uint32_t layers = std::min(run, what.depth - z);
            context_->gl.get_texture_sub_image(
                from.name(), 0, 0, 0, static_cast<int>(z), static_cast<int>(what.width),
                static_cast<int>(what.height), static_cast<int>(layers), format.format, format.type,
                static_cast<int>(std::min<std::uint64_t>(layer * layers, 0x7fffffff)),
                bytes.data() + z * layer);
        }
    }
    context_->traffic.down += bytes.size();
    return context_->check("downloading from a volume");
}

inline result<recorder> device::begin() {
    if (auto entered = context_->enter(); !entered) {
        return failure(entered.error());
    }
    context_->forget_errors();
    return recorder(*context_);
}

inline result<void> device::submit(recorder& recorded) {
    assert(recorded.context_ == context_.get() && "a recorder of another device");
    if (auto entered = context_->enter(); !entered) {
        return entered;
    }
    const zone here(context_->watchers(), "submit");
    context_->detach();
    {
        const zone waiting(context_->watchers(), "wait");
        context_->gl.finish();
    }
    auto done = context_->check("running what was recorded");
    if (recorded.error_ && (done || done.error().code != error_code::device_lost)) {
        return failure(*recorded.error_);
    }
    return done;
}

// ---- recorder -----------------------------------------------------------------------------------

inline void recorder::upload(const buffer_view<device>& to, std::span<const std::byte> bytes) {
    assert(bytes.size() <= to.size && "an upload beyond the view's end");
    if (bytes.empty()) {
        return;
    }
    attempt("upload", [&]() -> result<void> {
        const detail::bound_range range = detail::bound(to);
        context_->gl.named_buffer_sub_data(range.buffer, range.offset,
                                           static_cast<std::ptrdiff_t>(bytes.size()), bytes.data());
        context_->traffic.up += bytes.size();
        return {};
    });
}

inline void recorder::copy(const buffer_view<device>& from, const buffer_view<device>& to) {
    assert(from.size <= to.size && "a copy beyond the view's end");
    if (from.size == 0) {
        return;
    }
    attempt("copy", [&]() -> result<void> {
        const detail::bound_range source = detail::bound(from);
        const detail::bound_range target = detail::bound(to);
        context_->gl.copy_named_buffer_sub_data(source.buffer, target.buffer, source.offset,
                                                target.offset, source.size);
        return {};
    });
}

template <map_kernel K>
void recorder::map(const K& kernel, const bindings<device, K>& buffers, range elements) {
    attempt(zone_name<pattern::map, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        return detail::map(*context_, program<K>::map_comp, {detail::bytes_of(kernel), ranges},
                           {elements.first, elements.count, {}});
    });
}

template <map_kernel K>
void recorder::map(const K& kernel, const bindings<device, K>& buffers,
                   std::span<const range> ranges) {
    attempt(zone_name<pattern::map, K>(), [&] {
        const auto bound = detail::bound(buffers);
        return detail::map_levels(*context_, program<K>::map_comp, program<K>::levels_comp,
                                  {detail::bytes_of(kernel), bound}, ranges);
    });
}

template <map_kernel K>
void recorder::map(const K& kernel, const bindings<device, K>& buffers,
                   const counted<device>& elements) {
    attempt(zone_name<pattern::map, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        return detail::map(*context_, program<K>::map_comp, {detail::bytes_of(kernel), ranges},
                           {0, elements.limit, detail::bound(elements.count)});
    });
}

template <strip_kernel K>
void recorder::expand_elements(const K& kernel, const bindings<device, K>& buffers,
                               const detail::element_range& elements,
                               const triangle_list<device>& out) {
    static_assert(sizeof(typename K::vertex) <= detail::max_feedback_vertex_bytes,
                  "transform feedback takes at most 64 components a vertex");
    attempt(zone_name<pattern::expand, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        detail::expansion expansion;
        expansion.vertex_text = program<K>::expand_vert;
        expansion.geometry_text = program<K>::strips_geom;
        expansion.primitive = gl::triangles;
        expansion.parts = detail::strip_parts(kernel.strips(), kernel.strip_triangles(),
                                              sizeof(typename K::vertex), out.policy);
        expansion.flags = out.policy == padding::degenerate ? 2u : 0u;
        expansion.vertices = detail::bound(out.vertices);
        expansion.count = detail::bound(out.count);
        return detail::expand(*context_, {detail::bytes_of(kernel), ranges}, elements, expansion);
    });
}

template <strip_kernel K>
void recorder::expand(const K& kernel, const bindings<device, K>& buffers, range elements,
                      const triangle_list<device>& out) {
    expand_elements(kernel, buffers, {elements.first, elements.count, {}}, out);
}

template <strip_kernel K>
void recorder::expand(const K& kernel, const bindings<device, K>& buffers,
                      const counted<device>& elements, const triangle_list<device>& out) {
    expand_elements(kernel, buffers, {0, elements.limit, detail::bound(elements.count)}, out);
}

template <ring_kernel K>
void recorder::expand_rings(const K& kernel, const bindings<device, K>& buffers, range elements,
                            const buffer_view<device>& out) {
    static_assert(sizeof(typename K::vertex) <= detail::max_feedback_vertex_bytes,
                  "transform feedback takes at most 64 components a vertex");
    attempt(zone_name<pattern::expand_rings, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        detail::expansion expansion;
        expansion.vertex_text = program<K>::expand_vert;
        expansion.geometry_text = program<K>::rings_geom;
        expansion.primitive = gl::points;
        expansion.parts = detail::ring_parts(kernel.ring_vertices(), sizeof(typename K::vertex));
        expansion.vertices = detail::bound(out);
        const std::uint64_t each = kernel.ring_vertices() * sizeof(typename K::vertex);
        const std::uint64_t room = each == 0 ? 0 : out.size / each;
        const auto count =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(elements.count, room));
        return detail::expand(*context_, {detail::bytes_of(kernel), ranges},
                              {elements.first, count, {}}, expansion);
    });
}

template <draw_kernel K>
void recorder::draw_kernel_call(const K&, const detail::kernel_call& kernel,
                                const image_bindings<device, K>& images,
                                const draw_geometry<device>& geometry,
                                const draw_target<device>& target, const draw_state& state) {
    static_assert(K::images <= max_kernel_images, "a kernel reads at most eight images");
    assert((target.color != nullptr || target.depth != nullptr) && "a draw without a target");
    attempt(zone_name<pattern::draw, K>(), [&] {
        std::array<detail::image_binding, K::images> textures;
        for (std::size_t i = 0; i < textures.size(); ++i) {
            assert(images[i].image != nullptr && "a kernel given too few images");
            textures[i] = {images[i].image->name(), images[i].filter == filter_mode::linear,
                           images[i].wrap == wrap_mode::repeat};
        }
        const image_description size =
            (target.color != nullptr ? target.color : target.depth)->description();
        detail::draw_call call;
        call.vertex_text = program<K>::draw_vert;
        call.fragment_text = program<K>::draw_frag;
        call.images = textures;
        call.indices = detail::bound(geometry.indices);
        call.length = detail::bound(geometry.length);
        call.first = geometry.first;
        call.count = geometry.count;
        call.base_vertex = geometry.base_vertex;
        call.color = target.color != nullptr ? target.color->name() : 0;
        call.depth = target.depth != nullptr ? target.depth->name() : 0;
        call.width = size.width;
        call.height = size.height;
        call.clear_color = target.clear_color;
        call.clear_depth = target.clear_depth;
        call.state = state;
        return detail::draw(*context_, kernel, call);
    });
}

template <draw_kernel K>
void recorder::draw(const K& kernel, const bindings<device, K>& buffers,
                    const image_bindings<device, K>& images, const draw_geometry<device>& geometry,
                    const draw_target<device>& target, const draw_state& state) {
    static_assert(!names_volumes<K>, "a kernel that names volumes is given them");
    const auto ranges = detail::bound(buffers);
    draw_kernel_call(kernel, {detail::bytes_of(kernel), ranges}, images, geometry, target, state);
}

template <draw_kernel K>
void recorder::draw(const K& kernel, const bindings<device, K>& buffers,
                    const image_bindings<device, K>& images,
                    const volume_bindings<device, K>& volumes,
                    const draw_geometry<device>& geometry, const draw_target<device>& target,
                    const draw_state& state) {
    const auto ranges = detail::bound(buffers);
    const auto read = detail::names_of(volumes.read);
    draw_kernel_call(kernel, {detail::bytes_of(kernel), ranges, read, {}}, images, geometry, target,
                     state);
}

template <peel_kernel K>
void recorder::peel(const K& kernel, const bindings<device, K>& buffers, range triangles,
                    const peeled_layer<device>& layer) {
    [[maybe_unused]] const std::uint64_t bytes = std::uint64_t{layer.width} * layer.height * 4;
    assert(layer.depth.size >= bytes && layer.triangle.size >= bytes && "too few words for pixels");
    assert(layer.count.size >= sizeof(count_record) && "no room for the count of a layer");
    attempt(zone_name<pattern::peel, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        return detail::peel(*context_, {detail::bytes_of(kernel), ranges}, triangles,
                            {program<K>::peel_vert,
                             {layer.width, layer.height},
                             detail::bound(layer.depth),
                             detail::bound(layer.triangle),
                             detail::bound(layer.count)});
    });
}

template <class>
void recorder::resolve(const ray_bundle& bundle, const bundle_work<device>& work) {
    assert(work.hits.size / sizeof(gather_hit) >= work.samples.size / sizeof(gather_sample) &&
           "too few hits for samples");
    attempt("resolve", [&] {
        return detail::resolve(*context_,
                               {bundle, detail::bound(work.triangles), detail::bound(work.alpha),
                                detail::bound(work.samples), detail::bound(work.hits)});
    });
}

// ---- words --------------------------------------------------------------------------------------

template <class>
void recorder::scan(const buffer_view<device>& words, const buffer_view<device>& total) {
    assert(total.size >= 4 && "no room for the sum of all words");
    attempt("scan", [&] {
        return detail::scan_words(*context_, detail::bound(words), detail::bound(total));
    });
}

template <class>
void recorder::sort_pairs(const buffer_view<device>& keys, const buffer_view<device>& values,
                          std::uint32_t limit, const buffer_view<device>& length,
                          std::uint32_t key_bits) {
    attempt("sort", [&] {
        const std::uint64_t room = std::min(keys.size, values.size) / 4;
        const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(room, limit));
        return detail::sort_pairs(*context_, detail::bound(keys), detail::bound(values),
                                  {0, count, detail::bound(length)}, key_bits);
    });
}

template <class>
void recorder::sort(const buffer_view<device>& keys, const buffer_view<device>& values) {
    sort_pairs(keys, values, 0xffffffffu, {}, detail::word_bits);
}

template <class>
void recorder::sort(const buffer_view<device>& keys, const buffer_view<device>& values,
                    const counted<device>& pairs) {
    sort_pairs(keys, values, pairs.limit, pairs.count, detail::word_bits);
}

template <class>
void recorder::sort(const buffer_view<device>& keys, const buffer_view<device>& values,
                    std::uint32_t key_bits) {
    sort_pairs(keys, values, 0xffffffffu, {}, key_bits);
}

template <class>
void recorder::sort(const buffer_view<device>& keys, const buffer_view<device>& values,
                    const counted<device>& pairs, std::uint32_t key_bits) {
    sort_pairs(keys, values, pairs.limit, pairs.count, key_bits);
}

// ---- volumes ------------------------------------------------------------------------------------

template <class>
void recorder::scan(const volume& from, const volume& into, const volume_scan& how) {
    attempt("scan volume", [&] {
        return detail::scan_volume(*context_, {from.name(), from.description()},
                                   {into.name(), into.description()}, how);
    });
}

template <slab_kernel K>
void recorder::accumulate_elements(const K& kernel, const bindings<device, K>& buffers,
                                   const detail::element_range& elements,
                                   const accumulation<device>& out) {
    assert(out.into != nullptr && "an accumulation without a volume");
    attempt(zone_name<pattern::accumulate, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        detail::slab_call call;
        call.compute_text = program<K>::accumulate_comp;
        call.vertex_text = program<K>::slabs_vert;
        call.geometry_text = program<K>::slabs_geom;
        call.fragment_text = program<K>::slabs_frag;
        call.slabs = kernel.slabs();
        call.into = {out.into->name(), out.into->description()};
        call.clear = out.clear;
        call.route = out.route;
        call.policy = out.policy;
        const detail::kernel_call given{detail::bytes_of(kernel), ranges};
        return out.route == accumulate_route::direct
                   ? detail::accumulate(*context_, given, elements, call)
                   : detail::draw_sums(*context_, given, elements, call);
    });
}

template <slab_kernel K>
void recorder::accumulate(const K& kernel, const bindings<device, K>& buffers, range elements,
                          const accumulation<device>& out) {
    accumulate_elements(kernel, buffers, {elements.first, elements.count, {}}, out);
}

template <slab_kernel K>
void recorder::accumulate(const K& kernel, const bindings<device, K>& buffers,
                          const counted<device>& elements, const accumulation<device>& out) {
    accumulate_elements(kernel, buffers, {0, elements.limit, detail::bound(elements.count)}, out);
}

template <grid_map_kernel K>
void recorder::map(const K& kernel, const bindings<device, K>& buffers,
                   const volume_bindings<device, K>& volumes, range elements) {
    attempt(zone_name<pattern::map, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        const auto read = detail::names_of(volumes.read);
        const auto write = detail::names_of(volumes.write);
        return detail::map(*context_, program<K>::map_comp,
                           {detail::bytes_of(kernel), ranges, read, write},
                           {elements.first, elements.count, {}});
    });
}

template <voxel_kernel K>
void recorder::map_voxels(const K& kernel, const bindings<device, K>& buffers,
                          const volume_bindings<device, K>& volumes, const glm::uvec3& extent) {
    attempt(zone_name<pattern::map_voxels, K>(), [&] {
        const auto ranges = detail::bound(buffers);
        const auto read = detail::names_of(volumes.read);
        const auto write = detail::names_of(volumes.write);
        return detail::map_voxels(*context_, program<K>::voxels_comp,
                                  {detail::bytes_of(kernel), ranges, read, write}, extent);
    });
}

} // namespace skybark::opengl
