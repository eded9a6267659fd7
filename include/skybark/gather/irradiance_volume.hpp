#pragma once
// irradiance_volume: light from all around, kept at the points of a grid, for surfaces that move or
// are too many to gather at each.
//
//     auto volume = irradiance_volume<B>::create(device, scene, box, {40, 10, 40}, options);
//     run(device, [&](auto& recorder) { volume->record(recorder, 48); });
//     … draw with volume->volume() and volume->grid(): shared::irradiance_texel, irradiance_of …
//
// Greger, Shirley, Hubbard, Greenberg 1998, "The Irradiance Volume" (IEEE CG&A 18, 2), with the
// light of a point kept as real spherical harmonics up to l = 1 (Ramamoorthi and Hanrahan 2001):
// twelve numbers. Each point gathers at two samples, which look up and down. However few the axes
// are, an even sky of radiance L is π L for every normal, and a half sphere of it, above or below,
// π L (1 + cos a) / 2 at the angle a from it, as the series has it.
//
// A distant source's own beam is not in it, as it is not in final_gather::record_directional: it
// would be a blur of what pictures add sharply by a shadow map. What surfaces pass on of it is.
//
// Points inside of solid bodies see what is black, and would stain what is beside them.
// `gathered_at` says where else to look: for points under rolling ground, right above it.

#include <skybark/gather/final_gather.hpp>
#include <skybark/kernels/irradiance_voxels.hpp>

#include <utility>

namespace skybark::gather {

struct irradiance_volume_options {
    std::uint64_t seed = 1; ///< of the axes
    sky_radiance sky;
    /// Where the light of the point at a place is gathered, m. Empty: there.
    std::function<glm::vec3(glm::vec3)> gathered_at;
    resolver_options resolver;
    std::uint64_t most_bytes = std::uint64_t{16} << 30; ///< of device memory, counted beforehand
};

template <class B>
concept gathers_volumes = gathers<B> && maps_voxels<B, kernels::irradiance_voxels>;

template <gathers_volumes B>
class irradiance_volume {
  public:
    /// Of `points` along each axis, 2 or more, the outer ones on the faces of `box`. The device and
    /// the scene must outlive what is made. Errors: bad_input for fewer points, an empty box, or
    /// more voxels on a side (12 a point along y) than the device's volumes have; out_of_memory.
    [[nodiscard]] static result<irradiance_volume>
    create(B& device, const gather_scene<B>& scene, const bounds& box, glm::uvec3 points,
           const irradiance_volume_options& options = {}) {
        if (auto done = check(device, box, points); !done) {
            return failure(done.error());
        }
        final_gather_options gathered;
        gathered.seed = options.seed;
        gathered.directional = true;
        gathered.sky = options.sky;
        gathered.resolver = options.resolver;
        gathered.most_bytes = options.most_bytes;
        const std::vector<gather_sample> samples = samples_of(box, points, options);
        auto gather = final_gather<B>::create(device, scene, samples, gathered);
        if (!gather) {
            return failure(gather.error());
        }
        auto found = device.create_buffer(samples.size() * sizeof(directional_irradiance));
        if (!found) {
            return failure(found.error());
        }
        auto volume = device.create_volume(
            {points.x, coefficients * points.y, points.z, volume_format::float32});
        if (!volume) {
            return failure(volume.error());
        }
        return irradiance_volume(box, points, std::move(*gather), std::move(*found),
                                 std::move(*volume));
    }

    /// The light of the scene as it is, along so many axes, in place of what there was: the first
    /// ones of the seed, so that nothing depends on earlier calls.
    void record(typename B::recorder& recorder, std::uint64_t axes) {
        gather_.record_restart(recorder, gather_.options().seed);
        gather_.record(recorder, axes);
        gather_.record_directional(recorder, view<B>(found_));
        const auto nx = static_cast<std::int32_t>(points_.x);
        const auto ny = static_cast<std::int32_t>(points_.y);
        const auto nz = static_cast<std::int32_t>(points_.z);
        volume_bindings<B, kernels::irradiance_voxels> volumes;
        volumes.write = {&volume_};
        recorder.map_voxels(kernels::irradiance_voxels{tilt(axes), nx, ny}, {view<B>(found_)},
                            volumes,
                            glm::uvec3(nx, static_cast<std::int32_t>(coefficients) * ny, nz));
    }

    /// Twelve coefficients a point, W/m², as kernels::irradiance_voxels places them. Sampled where
    /// shared::irradiance_texel says.
    [[nodiscard]] const typename B::volume& volume() const noexcept { return volume_; }
    [[nodiscard]] const shared::irradiance_grid& grid() const noexcept { return grid_; }
    [[nodiscard]] glm::uvec3 points() const noexcept { return points_; }

  private:
    static constexpr std::uint32_t coefficients = 12;

    irradiance_volume(const bounds& box, glm::uvec3 points, final_gather<B>&& gather,
                      typename B::buffer&& found, typename B::volume&& volume)
        : points_(points), gather_(std::move(gather)), found_(std::move(found)),
          volume_(std::move(volume)) {
        const glm::vec3 steps = glm::vec3(points) - 1.0f;
        grid_.low = glm::vec4(box.low, 0);
        grid_.per_step = glm::vec4(steps / (box.high - box.low), 0);
        grid_.points = glm::vec4(glm::vec3(points), 0);
    }

    [[nodiscard]] static result<void> check(const B& device, const bounds& box, glm::uvec3 points) {
        const std::uint32_t most = device.limits().max_volume_size;
        const glm::vec3 size = box.high - box.low;
        const bool fits = points.x <= most && points.y <= most / coefficients && points.z <= most;
        const bool some = points.x >= 2 && points.y >= 2 && points.z >= 2;
        const bool open = size.x > 0 && size.y > 0 && size.z > 0;
        if (fits && some && open && std::isfinite(glm::dot(size, size))) {
            return {};
        }
        return fail(error_code::bad_input,
                    std::string("Light at ")
                        .append(std::to_string(points.x) + " x " + std::to_string(points.y))
                        .append(" x " + std::to_string(points.z) + " points in a box of ")
                        .append(std::to_string(size.x) + " x " + std::to_string(size.y))
                        .append(" x " + std::to_string(size.z) + " m was asked for; expected 2 to ")
                        .append(std::to_string(most) + " points along each axis, up to ")
                        .append(std::to_string(most / coefficients))
                        .append(" of them along y, and a box with finite sides above 0."));
    }

    /// By how much more than evenly the axes lean, as kernels::irradiance_voxels takes it.
    [[nodiscard]] glm::vec4 tilt(std::uint64_t axes) const {
        const bundle_axes directions(gather_.options().seed);
        glm::dvec3 sum(0);
        for (std::uint64_t i = 0; i < axes; ++i) {
            const glm::dvec3 axis = directions[i];
            sum += axis.y >= 0 ? axis : -axis;
        }
        const glm::dvec3 mean = sum / static_cast<double>(std::max<std::uint64_t>(axes, 1));
        const double root = 1.7320508075688772;
        return glm::vec4(0, root * (mean.y - 0.5), root * mean.z, root * mean.x);
    }

    /// Of each point, x first, one that looks up and one that looks down.
    [[nodiscard]] static std::vector<gather_sample>
    samples_of(const bounds& box, glm::uvec3 points, const irradiance_volume_options& options) {
        const glm::vec3 step = (box.high - box.low) / (glm::vec3(points) - 1.0f);
        std::vector<gather_sample> made;
        made.reserve(2 * std::size_t{points.x} * points.y * points.z);
        for (std::uint32_t z = 0; z < points.z; ++z) {
            for (std::uint32_t y = 0; y < points.y; ++y) {
                for (std::uint32_t x = 0; x < points.x; ++x) {
                    const glm::vec3 place = box.low + step * glm::vec3(x, y, z);
                    gather_sample at;
                    at.position = options.gathered_at ? options.gathered_at(place) : place;
                    at.normal = {0, 1, 0};
                    made.push_back(at);
                    at.normal = {0, -1, 0};
                    made.push_back(at);
                }
            }
        }
        return made;
    }

    glm::uvec3 points_;
    shared::irradiance_grid grid_;
    final_gather<B> gather_;
    typename B::buffer found_;
    typename B::volume volume_;
};

} // namespace skybark::gather
