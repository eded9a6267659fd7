#pragma once
// harris_light: the method that the attenuation volume replaces, as a baseline.
//
// Harris and Lastra 2001, "Real-Time Cloud Rendering"; Shimada et al. 2008, section 2.1. Particles
// are sorted from the sun outwards. One after another: the light buffer is read at the particle's
// centre and the value brought to the host (I_k), then the particle is drawn over the buffer, what
// comes through plus what it scatters forward of I_k. Light is one value a particle.
//
// Sorting, reading and drawing run on the device; the read-back between any two particles is the
// method's own, and what makes it slow on a GPU.

#include <skybark/clouds/light_box.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/kernels/harris_order.hpp>
#include <skybark/kernels/harris_read.hpp>
#include <skybark/kernels/harris_splat.hpp>

#include <cassert>
#include <optional>
#include <span>
#include <vector>

namespace skybark::clouds {

struct harris_options {
    float sigmas = 3;  ///< standard deviations of the Gaussian in a particle's radius, up to 9
    float forward = 0; ///< the phase function straight on, 1 over the sphere: 0…1e6
};

template <backend B>
requires sorts<B> && maps<B, kernels::harris_order> && maps<B, kernels::harris_read> &&
    maps<B, kernels::harris_splat>
class harris_light {
  public:
    /// A light buffer of columns × rows pixels, for up to `most_particles`. Errors: bad_input for
    /// numbers that make no sense and for more than the device can bind in one buffer; the
    /// device's.
    [[nodiscard]] static result<harris_light> create(B& device, std::uint32_t columns,
                                                     std::uint32_t rows,
                                                     std::uint32_t most_particles,
                                                     const harris_options& options = {}) {
        if (columns == 0 || rows == 0 || columns > 16384 || rows > 16384 || most_particles == 0) {
            return fail(error_code::bad_input,
                        "A light buffer of " + std::to_string(columns) + " x " +
                            std::to_string(rows) + " pixels for " + std::to_string(most_particles) +
                            " particles was asked for; expected sides from 1 to 16384 and one "
                            "particle at least.");
        }
        if (!(options.sigmas > 0 && options.sigmas <= 9 && options.forward >= 0 &&
              options.forward <= 1e6f)) {
            return fail(error_code::bad_input,
                        std::string("Harris's light was asked for with ")
                            .append(detail::number_text(options.sigmas))
                            .append(" standard deviations in a radius and ")
                            .append(detail::number_text(options.forward))
                            .append(" straight on; expected above 0 to 9, and 0 to 1e6."));
        }
        const device_limits limits = device.limits();
        const std::uint64_t most =
            std::min(limits.max_buffer_bytes / sizeof(cloud_particle), limits.max_elements);
        if (most_particles > most) {
            return fail(error_code::bad_input,
                        std::string("Harris's light of ")
                            .append(std::to_string(most_particles))
                            .append(" particles was asked for; this device lights up to ")
                            .append(std::to_string(most))
                            .append("."));
        }
        const std::uint64_t pixels = std::uint64_t{columns} * rows;
        const std::uint64_t most_pixels =
            std::min(limits.max_buffer_bytes / sizeof(float), limits.max_elements);
        if (pixels > most_pixels) {
            return fail(error_code::bad_input,
                        std::string("A light buffer of ")
                            .append(std::to_string(columns))
                            .append(" x ")
                            .append(std::to_string(rows))
                            .append(" pixels was asked for; this device binds up to ")
                            .append(std::to_string(most_pixels))
                            .append(" pixels."));
        }
        harris_light made(device, columns, rows, most_particles, options);
        const std::vector<float> sunlit(pixels, 1.0f);
        auto sun = make_buffer<B, float>(device, sunlit);
        auto light = device.create_buffer(pixels * sizeof(float));
        auto keys = device.create_buffer(std::uint64_t{most_particles} * 4);
        auto order = device.create_buffer(std::uint64_t{most_particles} * 4);
        auto value = device.create_buffer(16);
        for (const auto* buffer : {&sun, &light, &keys, &order, &value}) {
            if (!*buffer) {
                return failure(buffer->error());
            }
        }
        made.sun_.emplace(std::move(*sun));
        made.light_.emplace(std::move(*light));
        made.keys_.emplace(std::move(*keys));
        made.order_.emplace(std::move(*order));
        made.value_.emplace(std::move(*value));
        return made;
    }

    /// Lights `count` particles on the device; afterwards `lights()[i]` is what reaches particle i,
    /// of the sun's light. `box` was fitted to them, columns × any × rows voxels. It submits and
    /// waits once for every particle.
    [[nodiscard]] result<void> relight(const buffer_view<B>& particles, std::uint32_t count,
                                       const light_box& box) {
        assert(box.voxels.x == columns_ && box.voxels.z == rows_ && count <= lights_.size());
        lit_ = 0;
        if (auto done = sort(particles, count, box); !done) {
            return done;
        }
        kernels::harris_splat splat = splat_for(box);
        kernels::harris_read read{box.grid, 0, columns_, rows_, 0};
        for (std::uint32_t k = 0; k < count; ++k) {
            read.k = k;
            auto done = run(*device_, [&](auto& recorder) {
                if (k != 0) {
                    recorder.map(splat,
                                 {particles, view<B>(*order_), view<B>(*light_), view<B>(*light_)},
                                 range{0, splat.side * splat.side});
                }
                recorder.map(read,
                             {particles, view<B>(*order_), view<B>(*light_), view<B>(*value_)},
                             range{0, 1});
            });
            if (done) {
                done = read_back<B, float>(*device_, *value_, std::span(&splat.incoming, 1));
            }
            if (!done) {
                return done;
            }
            splat.k = k;
            lights_[numbers_[k]] = splat.incoming;
        }
        lit_ = count;
        return {};
    }

    /// Light at each particle's centre over the sun's, in the order of the particles: as many as
    /// the latest `relight` was given, none where it failed.
    [[nodiscard]] std::span<const float> lights() const noexcept {
        return std::span(lights_).first(lit_);
    }

  private:
    harris_light(B& device, std::uint32_t columns, std::uint32_t rows, std::uint32_t most,
                 const harris_options& options)
        : device_(&device), columns_(columns), rows_(rows), options_(options), lights_(most),
          numbers_(most) {}

    [[nodiscard]] result<void> sort(const buffer_view<B>& particles, std::uint32_t count,
                                    const light_box& box) {
        const auto keys = view<B, std::uint32_t>(*keys_, 0, count);
        const auto order = view<B, std::uint32_t>(*order_, 0, count);
        auto done = run(*device_, [&](auto& recorder) {
            recorder.map(kernels::harris_order{box.grid}, {particles, keys, order},
                         range{0, count});
            recorder.sort(keys, order);
            recorder.copy(view<B>(*sun_), view<B>(*light_));
        });
        if (done) {
            done = read_back<B, std::uint32_t>(*device_, *order_, std::span(numbers_).first(count));
        }
        return done;
    }

    [[nodiscard]] kernels::harris_splat splat_for(const light_box& box) const {
        kernels::harris_splat splat;
        splat.grid = box.grid;
        splat.sigmas = options_.sigmas;
        splat.forward = options_.forward;
        splat.columns = columns_;
        splat.rows = rows_;
        const float finest = std::min(box.grid.voxel.x, box.grid.voxel.z);
        splat.side = static_cast<std::uint32_t>(2 * box.largest_radius / finest) + 2;
        return splat;
    }

    B* device_;
    std::uint32_t columns_;
    std::uint32_t rows_;
    harris_options options_;
    std::vector<float> lights_; ///< room for the most particles
    std::uint32_t lit_ = 0;     ///< of them by the latest relight
    std::vector<std::uint32_t> numbers_;
    std::optional<typename B::buffer> sun_;
    std::optional<typename B::buffer> light_;
    std::optional<typename B::buffer> keys_;
    std::optional<typename B::buffer> order_;
    std::optional<typename B::buffer> value_;
};

} // namespace skybark::clouds
