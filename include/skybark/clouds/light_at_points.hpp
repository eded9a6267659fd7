#pragma once
// The light at single places of a cloud, behind it and beside it, on the device.
//
//     sun.relight(recorder, particles, count, *box);
//     diffuse.solve(recorder, sun);                                      // if wanted
//     record_light_at(recorder, device.limits(), sun, &diffuse, places, n, found);
//
// For each place a vec4 is found, without units:
//
//     x  attenuation: what the volume holds, between the place and the sun. The optical depth
//        where it was relit for attenuation_light::extinction.
//     y  the light: fluence ∫ L dω over the irradiance that the sun has on a surface which faces
//        it outside of the cloud. e^{−x} of the beam (1: nothing is in the way), plus z. Times
//        the sun's irradiance in W/m² it is in W/m².
//     z  the part of y that was scattered more than once; 0 without multiple_scattering. Outside
//        of the box an estimate: that of the nearest place on it, by the solid angle under which
//        a ball as large as the box is seen from there.
//     w  0
//
// With a volume of attenuation_light::extinction and `octaves`, the beam's part is the mean of
// Wrenninge's octaves in place of e^{−x}, without their phase function, so that it is 1 outside.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/kernels/light_at_points.hpp>

namespace skybark::clouds {

struct light_at_options {
    /// How many; 1 is e^{−attenuation}, and so is 0: none beside it.
    std::uint32_t octaves = 1;
    float octave_weight = 0.5f;      ///< of each, over that of the one before
    float octave_attenuation = 0.5f; ///< the same of its attenuation
    std::uint32_t stride = 1;        ///< vec4s from a place to the next: 2 for gather_samples
};

namespace detail {

[[nodiscard]] inline failure no_room(const char* what, std::uint64_t has, std::uint64_t needed) {
    return fail(error_code::bad_input, std::string("The view of ")
                                           .append(what)
                                           .append(" has ")
                                           .append(std::to_string(has))
                                           .append(" bytes; expected ")
                                           .append(std::to_string(needed))
                                           .append(" at least."));
}

} // namespace detail

/// Appends the light at `count` places, from what `sun` holds since its latest `relight` and, where
/// there is one, what `scattered` holds since its latest `solve`, for the same box. `places`:
/// vec4s, xyz in m; `found`: `count` vec4s, apart from them. Views may be longer than a kernel can
/// be given of this device: they go through in parts. Nothing is allocated, and nothing comes from
/// the host but the kernel's parameters. Errors: bad_input for a view that is too short; then
/// nothing is appended.
template <volume_backend B>
requires maps_grids<B, kernels::light_at_points>
[[nodiscard]] result<void> record_light_at(
    typename B::recorder& recorder, const device_limits& limits, const attenuation_volume<B>& sun,
    std::type_identity_t<const multiple_scattering<B>*> scattered, const buffer_view<B>& places,
    std::uint32_t count, const buffer_view<B>& found, const light_at_options& options = {}) {
    if (count == 0) {
        return {};
    }
    const std::uint64_t place_bytes = std::uint64_t{options.stride} * sizeof(glm::vec4);
    const std::uint64_t needed = place_bytes * (count - 1) + sizeof(glm::vec4);
    if (places.size < needed) {
        return detail::no_room("places", places.size, needed);
    }
    if (found.size / sizeof(glm::vec4) < count) {
        return detail::no_room("what is found", found.size,
                               std::uint64_t{count} * sizeof(glm::vec4));
    }
    kernels::light_at_points kernel;
    kernel.grid = sun.box().grid;
    kernel.octaves = options.octaves;
    kernel.octave_weight = options.octave_weight;
    kernel.octave_attenuation = options.octave_attenuation;
    kernel.stride = options.stride;
    if (scattered != nullptr) {
        kernel.diffuse = 1.0f / static_cast<float>(1u << scattered->options().halvings);
    }
    volume_bindings<B, kernels::light_at_points> volumes;
    volumes.read = {&sun.volume(), scattered != nullptr ? &scattered->fluence() : &sun.volume()};
    // As many as the longer view has room for, so that each part begins where views may.
    const std::uint64_t record = std::max<std::uint64_t>(place_bytes, sizeof(glm::vec4));
    const std::uint64_t step =
        std::max<std::uint64_t>(1, limits.view_alignment / sizeof(glm::vec4));
    const auto at_once = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
        std::min(limits.max_buffer_bytes / record, limits.max_elements) / step * step, step,
        1u << 31));
    for (std::uint32_t done = 0; done < count;) {
        const std::uint32_t now = std::min(at_once, count - done);
        buffer_view<B> from = places;
        from.offset += place_bytes * done;
        from.size = place_bytes * (now - 1) + sizeof(glm::vec4);
        buffer_view<B> to = found;
        to.offset += std::uint64_t{done} * sizeof(glm::vec4);
        to.size = std::uint64_t{now} * sizeof(glm::vec4);
        recorder.map(kernel, {from, to}, volumes, range{0, now});
        done += now;
    }
    return {};
}

} // namespace skybark::clouds
