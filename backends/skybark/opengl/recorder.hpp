#pragma once
// The recorder: works at once, in the context that is current, and restores what it touched.
//
// OpenGL runs what it is given in order, so there is nothing to collect: when a call returns, the
// pattern is in the context's stream and every state of the caller's is as it was. The first error
// is kept and what follows it is ignored, until `device::submit` tells.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/buffer.hpp>
#include <skybark/opengl/drawn_sums.hpp>
#include <skybark/opengl/image.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/peel.hpp>
#include <skybark/opengl/program.hpp>
#include <skybark/opengl/resolve.hpp>
#include <skybark/opengl/volume.hpp>
#include <skybark/opengl/volume_patterns.hpp>
#include <skybark/opengl/word_patterns.hpp>

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

    /// The next layer of depths. Of fragments of the same depth the lowest triangle's stays. Layers
    /// larger than limits().max_image_size on a side are an error.
    template <peel_kernel K>
    void peel(const K& kernel, const bindings<device, K>& buffers, range triangles,
              const peeled_layer<device>& layer);

    /// What each sample meets first along a bundle of rays, or against it. See resolve.hpp.
    template <class = when_used>
    void resolve(const ray_bundle& bundle, const bundle_work<device>& work);

    /// Running sums of words in place, the sum of all to the first word of `total`.
    template <class = when_used>
    void scan(const buffer_view<device>& words, const buffer_view<device>& total);
    /// As many pairs as both views have, or `written` of a count_record, at most `pairs.limit`.
    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values);
    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              const counted<device>& pairs);
    /// The same for keys below 2^key_bits, in a pass for every four bits (an even number of them).
    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              std::uint32_t key_bits);
    template <class = when_used>
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              const counted<device>& pairs, std::uint32_t key_bits);

    /// A running sum along an axis of a volume, into another one of the same size.
    template <class = when_used>
    void scan(const volume& from, const volume& into, const volume_scan& how);

    /// Adds every element's slabs to an int32 volume. The drawn routes are exact for any number of
    /// elements; see drawn_sums.hpp.
    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers, range elements,
                    const accumulation<device>& out);
    template <slab_kernel K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers,
                    const counted<device>& elements, const accumulation<device>& out);

    template <grid_map_kernel K>
    void map(const K& kernel, const bindings<device, K>& buffers,
             const volume_bindings<device, K>& volumes, range elements);
    template <voxel_kernel K>
    void map_voxels(const K& kernel, const bindings<device, K>& buffers,
                    const volume_bindings<device, K>& volumes, const glm::uvec3& extent);
    template <draw_kernel K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const volume_bindings<device, K>& volumes,
              const draw_geometry<device>& geometry, const draw_target<device>& target,
              const draw_state& state);

  private:
    friend class device;
    explicit recorder(detail::context& context) noexcept : context_(&context) {}

    /// Runs the pattern `name` unless an error came before, and keeps its error.
    template <class Work>
    void attempt(const char* name, Work&& work) {
        if (error_) {
            return;
        }
        auto done = context_->enter();
        if (done) {
            const detail::pattern_scope here(*context_, name);
            done = work();
        }
        if (!done) {
            error_ = done.error();
        }
    }
    template <strip_kernel K>
    void expand_elements(const K& kernel, const bindings<device, K>& buffers,
                         const detail::element_range& elements, const triangle_list<device>& out);
    template <slab_kernel K>
    void accumulate_elements(const K& kernel, const bindings<device, K>& buffers,
                             const detail::element_range& elements,
                             const accumulation<device>& out);
    template <draw_kernel K>
    void draw_kernel_call(const K& kernel, const detail::kernel_call& call,
                          const image_bindings<device, K>& images,
                          const draw_geometry<device>& geometry, const draw_target<device>& target,
                          const draw_state& state);
    template <class = when_used>
    void sort_pairs(const buffer_view<device>& keys, const buffer_view<device>& values,
                    std::uint32_t limit, const buffer_view<device>& length, std::uint32_t key_bits);

    detail::context* context_;
    std::optional<error> error_;
};

} // namespace skybark::opengl
