#pragma once
// What the classes that draw particles as billboards share: the particles' numbers, back to front,
// and the lighting, on the device.

#include <skybark/core/backend.hpp>
#include <skybark/kernels/billboard_depth.hpp>
#include <skybark/kernels/particle_fingerprint.hpp>

#include <algorithm>
#include <cassert>
#include <optional>
#include <string>
#include <utility>

namespace skybark::clouds::detail {

template <class B>
concept sorts_puffs =
    maps<B, kernels::particle_fingerprint> && maps<B, kernels::billboard_depth> && sorts<B>;

template <sorts_puffs B>
class sorted_puffs {
  public:
    /// Room for `most_particles`, of which the caller binds up to `bytes_each` each. Fails with
    /// bad_input where the device cannot bind as many.
    [[nodiscard]] static result<sorted_puffs> create(B& device, std::uint32_t most_particles,
                                                     std::uint64_t bytes_each) {
        const device_limits limits = device.limits();
        const std::uint64_t most =
            std::min({limits.max_buffer_bytes / bytes_each, limits.max_elements,
                      std::uint64_t{0xffffffffu} / corners});
        if (most_particles > most) {
            return fail(error_code::bad_input,
                        std::string("Billboards for ")
                            .append(std::to_string(most_particles))
                            .append(" particles were asked for; this device draws up to ")
                            .append(std::to_string(most))
                            .append(" at once."));
        }
        sorted_puffs made;
        made.capacity_ = most_particles;
        const std::uint64_t bytes = std::uint64_t{most_particles} * 4;
        for (auto& [buffer, size] :
             {std::pair{&made.keys_, bytes}, std::pair{&made.order_, bytes},
              std::pair{&made.lighting_, std::uint64_t{sizeof(shared::cloud_lighting)}}}) {
            auto one = device.create_buffer(size);
            if (!one) {
                return failure(one.error());
            }
            buffer->emplace(std::move(*one));
        }
        return made;
    }

    /// Appends sending of the lighting and sorting of `count` particles, 1 or more. Twice: where
    /// two are equally far from the eye, what they are decides which is drawn first, so that the
    /// picture is the same in whatever order they are listed.
    void record(typename B::recorder& to, const buffer_view<B>& particles, std::uint32_t count,
                glm::vec3 eye, const shared::cloud_lighting& how) const {
        assert(count <= capacity_);
        to.upload(lighting(), bytes_of_one(how));
        const auto keys = view<B, std::uint32_t>(*keys_, 0, count);
        to.map(kernels::particle_fingerprint{}, {particles, keys, order(count)}, range{0, count});
        to.sort(keys, order(count));
        to.map(kernels::billboard_depth{glm::vec4(eye, 0)}, {particles, order(count), keys},
               range{0, count});
        to.sort(keys, order(count));
    }

    [[nodiscard]] std::uint32_t capacity() const noexcept { return capacity_; }
    /// The particles' numbers, back to front, after a `record` of `count`.
    [[nodiscard]] buffer_view<B> order(std::uint32_t count) const {
        return view<B, std::uint32_t>(*order_, 0, count);
    }
    [[nodiscard]] buffer_view<B> lighting() const { return view<B>(*lighting_); }
    /// Two triangles for each of `count` particles.
    [[nodiscard]] static draw_geometry<B> squares(std::uint32_t count) {
        draw_geometry<B> all;
        all.count = count * corners;
        return all;
    }

  private:
    sorted_puffs() = default;

    static constexpr std::uint32_t corners = 6;

    std::uint32_t capacity_ = 0;
    std::optional<typename B::buffer> keys_; // all are there after create
    std::optional<typename B::buffer> order_;
    std::optional<typename B::buffer> lighting_;
};

} // namespace skybark::clouds::detail
