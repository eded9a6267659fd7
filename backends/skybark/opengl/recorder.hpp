#pragma once
// The recorder: works at once, in the context that is current, and restores what it touched.
//
// OpenGL runs what it is given in order, so there is nothing to collect: when a call returns, the
// pattern is in the context's stream and every state of the caller's is as it was. The first error
// is kept and what follows it is ignored, until `device::submit` tells.

#include <skybark/opengl/buffer.hpp>
#include <skybark/opengl/image.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/program.hpp>

#include <cassert>

namespace skybark::opengl {

class device;

class recorder {
  public:
    recorder(recorder&&) noexcept = default;
    recorder& operator=(recorder&&) noexcept = default;

    void upload(const buffer_view<device>& to, std::span<const std::byte> bytes);
    void copy(const buffer_view<device>& from, const buffer_view<device>& to);

    /// Each i of [elements.first, elements.first + elements.count) once.
    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, range elements);
    /// The same for one range after the other, each seeing what the ones before it wrote.
    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, std::span<const range> ranges);
    /// Each i below `written` of a count_record, at most `limit`.
    template <map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers, const counted<device>& elements);

    template <strip_kernel K>
    void expand(const K& kernel, const bindings<device, K>& buffers, range elements,
                const triangle_list<device>& out);
    template <strip_kernel K>
    void expand(const K& kernel, const bindings<device, K>& buffers,
                const counted<device>& elements, const triangle_list<device>& out);

    /// Vertices beyond the end of `out` are dropped.
    template <ring_kernel K>
    void expand_rings(const K& kernel, const bindings<device, K>& buffers, range elements,
                      const buffer_view<device>& out);

    template <draw_kernel K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const draw_geometry<device>& geometry,
              const draw_target<device>& target, const draw_state& state);

  private:
    friend class device;
    explicit recorder(detail::context& context) noexcept : context_(&context) {}

    /// Runs `work` unless an error came before, and keeps its error.
    template <class Work>
    void attempt(Work&& work) {
        if (error_) {
            return;
        }
        auto done = context_->enter();
        if (done) {
            done = work();
        }
        if (!done) {
            error_ = done.error();
        }
    }
    template <strip_kernel K>
    void expand_elements(const K& kernel, const bindings<device, K>& buffers,
                         const detail::element_range& elements, const triangle_list<device>& out);

    detail::context* context_;
    std::optional<error> error_;
};

} // namespace skybark::opengl
