#pragma once
// A cloud's particles out of separate positions, radii, optical depths and albedos: on the host
// from spans, on the device from buffers of floats of any layout.
//
//     auto cloud = particles_of(positions, radii, depths, albedos);           // a vector
//     record_particles(recorder, device.limits(), attributes, count, view);   // in a buffer
//
// Values are copied as they are. `fit_light_box` looks at those of the host (`check_particles`);
// nobody looks at those that are on the device alone: see cloud_particle for what they must be.

#include <skybark/core/backend.hpp>
#include <skybark/kernels/pack_particles.hpp>

#include <algorithm>
#include <cassert>
#include <string>
#include <vector>

namespace skybark::clouds {

namespace detail {

[[nodiscard]] inline failure wrong_length(const char* what, std::size_t length, std::size_t count) {
    return fail(error_code::bad_input, std::string("There are ")
                                           .append(std::to_string(length))
                                           .append(" ")
                                           .append(what)
                                           .append(" for ")
                                           .append(std::to_string(count))
                                           .append(" positions; expected as many, or one for all "
                                                   "of them."));
}

[[nodiscard]] inline result<void> check_lengths(std::size_t count, std::size_t radii,
                                                std::size_t depths, std::size_t albedos) {
    const auto wrong = [count](std::size_t length) { return length != count && length != 1; };
    return wrong(radii)     ? wrong_length("radii", radii, count)
           : wrong(depths)  ? wrong_length("optical depths", depths, count)
           : wrong(albedos) ? wrong_length("albedos", albedos, count)
                            : result<void>{};
}

} // namespace detail

/// Writes a particle for each position (m) into `to`, which has as many, with its radius (m),
/// optical depth through the centre, and albedo. A span of one number stands for all particles.
/// Allocates nothing. Errors: bad_input, which names the span of a wrong length; then nothing is
/// written.
[[nodiscard]] inline result<void> particles_of(std::span<const glm::vec3> positions,
                                               std::span<const float> radii,
                                               std::span<const float> optical_depths,
                                               std::span<const float> albedos,
                                               std::span<cloud_particle> to) {
    const std::size_t count = positions.size();
    if (auto done =
            detail::check_lengths(count, radii.size(), optical_depths.size(), albedos.size());
        !done) {
        return done;
    }
    if (to.size() != count) {
        return fail(error_code::bad_input, std::string("There is room for ")
                                               .append(std::to_string(to.size()))
                                               .append(" particles for ")
                                               .append(std::to_string(count))
                                               .append(" positions; expected as much."));
    }
    const auto of = [](std::span<const float> all, std::size_t i) {
        return all[all.size() == 1 ? 0 : i];
    };
    for (std::size_t i = 0; i < count; ++i) {
        to[i] = {positions[i], of(radii, i), of(optical_depths, i), of(albedos, i), {0, 0}};
    }
    return {};
}

/// The same as a new vector.
[[nodiscard]] inline result<std::vector<cloud_particle>>
particles_of(std::span<const glm::vec3> positions, std::span<const float> radii,
             std::span<const float> optical_depths, std::span<const float> albedos) {
    std::vector<cloud_particle> particles(positions.size());
    if (auto done = particles_of(positions, radii, optical_depths, albedos, particles); !done) {
        return failure(done.error());
    }
    return particles;
}

/// One attribute of particles, in a view of floats: that of particle i begins at float
/// `first + stride · i`.
template <class B>
struct particle_attribute {
    buffer_view<B> floats;
    std::uint64_t first = 0;
    std::uint32_t stride = 0; ///< 0: one value for all particles
};

/// Where a cloud's particles are on the device. The views may be one and the same: records of eight
/// floats in which x, y, z, depth, albedo and radius come first are
/// `{{all, 0, 8}, {all, 5, 8}, {all, 3, 8}, {all, 4, 8}}`.
template <class B>
struct particle_attributes {
    particle_attribute<B> positions; ///< x, y, z: m
    particle_attribute<B> radii;     ///< m
    particle_attribute<B> optical_depths;
    particle_attribute<B> albedos;
};

namespace detail {

template <class B>
[[nodiscard]] result<void> check_attribute(const particle_attribute<B>& from, const char* what,
                                           std::uint32_t width, std::uint32_t count) {
    if (from.stride != 0 && from.stride < width) {
        return fail(error_code::bad_input, std::string("The ")
                                               .append(what)
                                               .append(" are ")
                                               .append(std::to_string(from.stride))
                                               .append(" floats apart; expected 0 or at least ")
                                               .append(std::to_string(width))
                                               .append("."));
    }
    const std::uint64_t has = from.floats.size / sizeof(float);
    const bool begins = has >= width && from.first <= has - width;
    if (!begins || (from.stride != 0 && (has - width - from.first) / from.stride < count - 1)) {
        return fail(error_code::bad_input, std::string("The ")
                                               .append(what)
                                               .append(" of ")
                                               .append(std::to_string(count))
                                               .append(" particles, ")
                                               .append(std::to_string(from.stride))
                                               .append(" floats apart from float ")
                                               .append(std::to_string(from.first))
                                               .append(" on, reach beyond a view of ")
                                               .append(std::to_string(has))
                                               .append(" floats."));
    }
    return {};
}

/// What kernels are given of an attribute: a view that begins where views may.
template <class B>
struct attribute_part {
    buffer_view<B> floats;
    std::uint32_t first = 0;
};

/// Of `count` particles from `done` on.
template <class B>
[[nodiscard]] attribute_part<B> part_of(const particle_attribute<B>& from, std::uint32_t width,
                                        std::uint32_t done, std::uint32_t count,
                                        std::uint64_t alignment) {
    const std::uint64_t first = from.first + std::uint64_t{from.stride} * done;
    const std::uint64_t skipped = first * sizeof(float) / alignment * alignment;
    attribute_part<B> part{from.floats,
                           static_cast<std::uint32_t>(first - skipped / sizeof(float))};
    part.floats.offset += skipped;
    part.floats.size =
        (part.first + std::uint64_t{from.stride} * (count - 1) + width) * sizeof(float);
    return part;
}

} // namespace detail

/// How many particles one dispatch of pack_particles takes at most: as many as the views of a
/// device with these limits reach over, and so that each dispatch's views begin where views may.
[[nodiscard]] inline std::uint32_t particles_at_once(const device_limits& limits,
                                                     std::uint32_t longest_stride) {
    const std::uint64_t record =
        std::max<std::uint64_t>(sizeof(cloud_particle), std::uint64_t{longest_stride} * 4);
    const std::uint64_t step =
        std::max<std::uint64_t>(1, limits.view_alignment / sizeof(cloud_particle));
    // The start of a view is up to an alignment early. Floats of a view are counted in 32 bits.
    const std::uint64_t most = std::min(limits.max_buffer_bytes, std::uint64_t{1} << 33);
    const std::uint64_t room = most > limits.view_alignment ? most - limits.view_alignment : 0;
    const std::uint64_t fit = std::min(room / record, limits.max_elements) / step * step;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(fit, step, 1u << 31));
}

/// Appends the making of `count` cloud_particles in `to`, which starts where a view may and has
/// room for them, from what the device holds. Nothing is allocated, and nothing comes from the host
/// but the kernel's parameters. `to` and what is read must be apart. Errors: bad_input, which names
/// the attribute whose view is too short or whose parts would overlap; then nothing is appended.
template <backend B>
requires maps<B, kernels::pack_particles>
[[nodiscard]] result<void> record_particles(typename B::recorder& recorder,
                                            const device_limits& limits,
                                            const particle_attributes<B>& from, std::uint32_t count,
                                            const buffer_view<B>& to) {
    if (count == 0) {
        return {};
    }
    auto checked = detail::check_attribute(from.positions, "positions", 3, count);
    checked = checked ? detail::check_attribute(from.radii, "radii", 1, count) : checked;
    checked = checked ? detail::check_attribute(from.optical_depths, "optical depths", 1, count)
                      : checked;
    checked = checked ? detail::check_attribute(from.albedos, "albedos", 1, count) : checked;
    if (!checked) {
        return checked;
    }
    if (to.size / sizeof(cloud_particle) < count) {
        return fail(error_code::bad_input,
                    std::string("There is room for ")
                        .append(std::to_string(to.size / sizeof(cloud_particle)))
                        .append(" particles; expected room for ")
                        .append(std::to_string(count))
                        .append("."));
    }
    const std::uint32_t at_once =
        particles_at_once(limits, std::max({from.positions.stride, from.radii.stride,
                                            from.optical_depths.stride, from.albedos.stride}));
    for (std::uint32_t done = 0; done < count;) {
        const std::uint32_t now = std::min(at_once, count - done);
        const auto part = [&](const particle_attribute<B>& of, std::uint32_t width) {
            return detail::part_of(of, width, done, now, limits.view_alignment);
        };
        const auto positions = part(from.positions, 3);
        const auto radii = part(from.radii, 1);
        const auto depths = part(from.optical_depths, 1);
        const auto albedos = part(from.albedos, 1);
        const kernels::pack_particles pack{
            positions.first, from.positions.stride,      radii.first,   from.radii.stride,
            depths.first,    from.optical_depths.stride, albedos.first, from.albedos.stride};
        buffer_view<B> made = to;
        made.offset += std::uint64_t{done} * sizeof(cloud_particle);
        made.size = std::uint64_t{now} * sizeof(cloud_particle);
        recorder.map(pack, {positions.floats, radii.floats, depths.floats, albedos.floats, made},
                     range{0, now});
        done += now;
    }
    return {};
}

} // namespace skybark::clouds
