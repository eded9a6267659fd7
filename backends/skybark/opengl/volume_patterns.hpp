#pragma once
// The patterns of volumes that are computed: accumulations by atomic additions, running sums along
// an axis, and maps over voxels. Drawn accumulations are in drawn_sums.hpp.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/programs/own_scan_float32_float16.hpp>
#include <skybark/opengl/programs/own_scan_float32_float32.hpp>
#include <skybark/opengl/programs/own_scan_int32_float16.hpp>
#include <skybark/opengl/programs/own_scan_int32_float32.hpp>
#include <skybark/opengl/programs/own_scan_int32_int32.hpp>
#include <skybark/opengl/volume.hpp>

#include <bit>
#include <cassert>

namespace skybark::opengl::detail {

/// The image unit of the volume that is added to, or summed over.
inline constexpr std::uint32_t sums_unit = 4;

struct bound_volume {
    gl::handle texture = 0;
    volume_description size;
};

/// All layers of a volume, for a shader to load from and store to.
inline void bind_volume(context& c, std::uint32_t unit, const bound_volume& volume,
                        gl::token access) {
    c.gl.bind_image_texture(unit, volume.texture, 0, 1, 0, access,
                            format_of(volume.size.format).internal);
}

// ---- accumulate ---------------------------------------------------------------------------------

/// Of an accumulation's header: a slab's memory is read before it is added to.
inline constexpr std::uint32_t fetch_first = 2;

/// An accumulation without types.
struct slab_call {
    std::string_view compute_text;
    std::string_view vertex_text;
    std::string_view geometry_text;
    std::string_view fragment_text;
    std::uint32_t slabs = 0; ///< the most that an element has
    bound_volume into;
    bool clear = false;
    accumulate_route route = accumulate_route::direct;
    padding policy = padding::compact;
};

inline void clear_volume(context& c, const bound_volume& volume) {
    const voxel_format format = format_of(volume.size.format);
    c.gl.clear_tex_image(volume.texture, 0, format.format, format.type, nullptr);
}

/// How an accumulation falls on groups of invocations: see accumulate.comp.
struct slab_plan {
    std::uint32_t lanes = 16;  ///< columns side by side
    std::uint32_t sharing = 1; ///< groups that share a slab
    std::uint32_t each = 0;    ///< slabs a group
    std::uint32_t flags = 0;
};

/// Into as few groups an element as can walk slabs as large as the volume, where loops end after
/// so many rounds.
[[nodiscard]] inline slab_plan plan_slabs(std::uint32_t slabs, const volume_description& size,
                                          bool on_cpu) {
    slab_plan plan;
    plan.lanes = on_cpu ? 4 : 16;
    plan.each = std::min(slabs, 65535u);
    plan.flags = on_cpu ? fetch_first : 0;
    const auto rounds = [&] {
        const std::uint64_t columns = (size.width - 1) / (plan.lanes * plan.sharing) + 1;
        const std::uint64_t turns = (plan.each - 1) / (16 / plan.lanes) + 1;
        return turns * (1 + (columns + 1) * (std::uint64_t{size.height} + 1));
    };
    while (on_cpu && rounds() > max_rounds) {
        plan.each = (plan.each + 1) / 2;
        plan.sharing *= plan.each == 1 ? 2 : 1;
    }
    return plan;
}

/// Every slab of every element adds to its voxels, in no order: int32 sums have none.
[[nodiscard]] inline result<void> accumulate(context& c, const kernel_call& call,
                                             const element_range& elements, const slab_call& out) {
    assert(out.into.size.format == volume_format::int32 && "sums are int32");
    const shader_stage stages[] = {{gl::compute_shader, out.compute_text}};
    const auto program = c.find_program(stages);
    if (!program) {
        return failure(program.error());
    }
    if (out.clear) {
        clear_volume(c, out.into);
    }
    if (elements.count == 0 || out.slabs == 0) {
        return {};
    }
    const slab_plan plan = plan_slabs(out.slabs, out.into.size, c.on_cpu);
    const std::uint32_t parts = ((out.slabs - 1) / plan.each + 1) * plan.sharing;
    const std::uint64_t each = std::uint64_t{64} * parts; // a group of its own, as arguments count
    // The number of an invocation has 32 bits.
    const auto chunk = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
        (std::uint64_t{1} << 31) / each, 1, std::uint64_t{elements.count}));
    const bool counted = elements.length.buffer != 0;
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding) |
                                            mask_of(arguments_binding));
    const saved_binding indirect(c.gl, gl::dispatch_indirect_buffer,
                                 gl::dispatch_indirect_buffer_binding);
    const saved_image_units saved_units(c.gl, sums_unit, 1);
    bind_volume(c, sums_unit, out.into, gl::read_write);
    bind_kernel(c, call);
    bind(c, gl::shader_storage_buffer, length_binding, elements.length);
    c.gl.bind_buffer(gl::dispatch_indirect_buffer, c.objects.arguments);
    for (std::uint32_t done = 0; done < elements.count;) {
        const std::uint32_t now = std::min(chunk, elements.count - done);
        if (counted) {
            indirect_call arguments;
            arguments.skip = done;
            arguments.most = now;
            arguments.each = static_cast<std::uint32_t>(each);
            if (auto written = write_arguments(c, arguments, elements.length); !written) {
                return written;
            }
        }
        bind_parameters(c,
                        {elements.first + done, now, plan.lanes | plan.sharing << 16,
                         plan.each << 16 | plan.flags | (counted ? 1u : 0u)},
                        call.parameters);
        if (counted) {
            dispatch_indirect(c, *program);
        } else {
            dispatch(c, *program, now * parts);
        }
        done += now;
    }
    return {};
}

// ---- scan ---------------------------------------------------------------------------------------

[[nodiscard]] constexpr std::string_view scan_text(volume_format from, volume_format into) {
    if (from == volume_format::int32) {
        return into == volume_format::int32     ? scan_int32_int32_comp
               : into == volume_format::float32 ? scan_int32_float32_comp
                                                : scan_int32_float16_comp;
    }
    return into == volume_format::float32 ? scan_float32_float32_comp : scan_float32_float16_comp;
}

template <class = when_used>
[[nodiscard]] result<void> scan_volume(context& c, const bound_volume& from,
                                       const bound_volume& into, const volume_scan& how) {
    assert(from.texture != into.texture && "a scan within one volume");
    assert(from.size.width == into.size.width && from.size.height == into.size.height &&
           from.size.depth == into.size.depth && "a scan into a volume of another size");
    assert(
        (from.size.format == volume_format::int32 || (from.size.format == volume_format::float32 &&
                                                      into.size.format != volume_format::int32)) &&
        "a scan between these formats does not exist");
    const shader_stage stages[] = {
        {gl::compute_shader, scan_text(from.size.format, into.size.format)}};
    const auto program = c.find_program(stages);
    if (!program) {
        return failure(program.error());
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, 0);
    const saved_image_units saved_source(c.gl, sums_unit, 1);
    const saved_image_units saved_target(c.gl, target_unit, 1);
    bind_volume(c, sums_unit, from, gl::read_only);
    bind_volume(c, target_unit, into, gl::write_only);
    bind_parameters(c,
                    {static_cast<std::uint32_t>(how.axis),
                     how.direction == scan_direction::descending ? 1u : 0u,
                     static_cast<std::uint32_t>(how.share),
                     std::bit_cast<std::uint32_t>(how.scale)},
                    {});
    const volume_description& size = from.size;
    const std::uint32_t across = how.axis == scan_axis::x ? size.height : size.width;
    const std::uint32_t deep = how.axis == scan_axis::z ? size.height : size.depth;
    c.gl.use_program(*program);
    c.gl.dispatch_compute((across + 63) / 64, deep, 1);
    c.gl.memory_barrier(gl::all_barrier_bits);
    return {};
}

// ---- map_voxels ---------------------------------------------------------------------------------

template <class = when_used>
[[nodiscard]] result<void> map_voxels(context& c, std::string_view text, const kernel_call& call,
                                      const glm::uvec3& extent) {
    assert(extent.z <= 65535 && "more layers than can be dispatched");
    const shader_stage stages[] = {{gl::compute_shader, text}};
    const auto program = c.find_program(stages);
    if (!program || extent.x == 0 || extent.y == 0 || extent.z == 0) {
        return program ? result<void>{} : failure(program.error());
    }
    const saved_program saved(c.gl);
    const saved_volumes saved_units(c.gl, call);
    const saved_buffers saved_too(c.gl, kernel_mask(call));
    bind_volumes(c, call);
    bind_kernel(c, call);
    bind_parameters(c, {extent.x, extent.y, extent.z, 0}, call.parameters);
    c.gl.use_program(*program);
    c.gl.dispatch_compute((extent.x + 7) / 8, (extent.y + 7) / 8, extent.z);
    c.gl.memory_barrier(gl::all_barrier_bits);
    return {};
}

} // namespace skybark::opengl::detail
