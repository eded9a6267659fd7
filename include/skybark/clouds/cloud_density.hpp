#pragma once
// cloud_density: draws a cloud that is a grid of densities.
//
// The same light as cloud_billboards: the attenuation volume, read at every step of a ray through
// the grid. `record` allocates nothing and sends nothing but the lighting.

#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/kernels/lit_grid.hpp>

namespace skybark::clouds {

template <volume_backend B>
requires draws_volumes<B, kernels::lit_grid>
class cloud_density {
  public:
    [[nodiscard]] static result<cloud_density> create(B& device) {
        auto lighting = device.create_buffer(sizeof(cloud_lighting));
        if (!lighting) {
            return failure(lighting.error());
        }
        cloud_density made;
        made.lighting_.emplace(std::move(*lighting));
        return made;
    }

    /// Appends the drawing of `density`, a volume of floats that lies in the box `where` (which
    /// passes check_density_box), over `color`. Rays end at what `depth` (depth32f, of the same
    /// size) shows. Of the lighting, by_particle, torn and forward_point are of particles alone.
    void record(typename B::recorder& to, const typename B::volume& density,
                const density_box& where, const buffer_view<B>& scene,
                const cloud_light_sources<B>& light, const typename B::image& color,
                const typename B::image& depth) const {
        assert(check_density_box(where) && "a density grid that cannot be drawn");
        to.upload(view<B>(*lighting_), bytes_of_one(light.lighting));
        const volume_description what = density.description();
        const glm::vec3 size = where.high - where.low;
        const glm::vec3 side = size / glm::vec3(what.width, what.height, what.depth);
        kernels::lit_grid rays;
        rays.low = glm::vec4(where.low, where.extinction);
        rays.high = glm::vec4(where.high, where.albedo);
        // Two steps a voxel, if 512 are enough for the longest way through.
        rays.step = std::max(0.5f * std::min({side.x, side.y, side.z}),
                             std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z) / 511);
        volume_bindings<B, kernels::lit_grid> volumes;
        const auto lit_by = detail::light_volumes(light);
        volumes.read = {lit_by[0], lit_by[1], lit_by[2], &density};
        draw_geometry<B> screen;
        screen.count = 3;
        to.draw(rays, {scene, view<B>(*lighting_)},
                {sampled_image<B>{&depth, filter_mode::nearest, wrap_mode::clamp}}, volumes, screen,
                draw_target<B>{&color, nullptr, {}, {}},
                draw_state{false, false, blend_mode::alpha});
    }

  private:
    cloud_density() = default;
    std::optional<typename B::buffer> lighting_; // there after create
};

} // namespace skybark::clouds
