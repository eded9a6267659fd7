#pragma once
// layer_hits: a layer that was peeled off, and what each sample makes of it.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>

namespace skybark::kernels {

/// Buffers: samples; the layer's depths and triangles, one word a pixel; triangles; hits, before
/// and after: the same buffer. Maps over samples. Layers come from the far side to the near one
/// (Hachisuka 2005, step 5): a sample that looks along the bundle takes each layer that lies before
/// it, so that the last one taken is the nearest; one that looks against it takes the first.
///
/// A sample looks the layer up at the pixel that it falls into, so that its ray is off by up to
/// half a pixel. What is nearer than its own plane rises over that distance does not count.
struct layer_hits {
    using buffers =
        buffer_list<readonly<gather_sample>, readonly<float>, readonly<std::uint32_t>,
                    readonly<gather_triangle>, readonly<gather_hit>, writeonly<gather_hit>>;

    ray_bundle bundle;
    float reach = 1;         ///< as for bundle_corner, m
    std::uint32_t size = 0;  ///< pixels on a side
    std::uint32_t fresh = 0; ///< 1: the first layer: hits begin anew

    void map(std::uint32_t i, std::span<const gather_sample> samples, std::span<const float> depths,
             std::span<const std::uint32_t> numbers, std::span<const gather_triangle> triangles,
             std::span<const gather_hit> before, std::span<gather_hit> hits) const {
        gather_hit best;
        if (fresh == 0) {
            best = before[i];
        }
        const gather_sample at = samples[i];
        const glm::vec3 origin = shared::across_bundle(bundle, shared::ray_origin(bundle, at));
        const float side = shared::side_of_bundle(bundle, at.normal);
        const float pixel = 2.0f * bundle.centre.w / static_cast<float>(size);
        const auto n = static_cast<int>(size);
        const int column = shared::cell_within((origin.x + bundle.centre.w) / pixel, n);
        const int row = shared::cell_within((origin.y + bundle.centre.w) / pixel, n);
        const auto where = static_cast<std::size_t>(row) * size + static_cast<std::size_t>(column);
        const float distance =
            depths[where] > 0.0f ? side * (shared::place_of_layer(depths[where], reach) - origin.z)
                                 : -1.0f;
        const bool taken = side > 0.0f || best.surface == no_surface;
        if (taken && distance > shared::rise_in_pixel(bundle, at.normal, 0.5f * pixel)) {
            best = hit_at(triangles[numbers[where]], numbers[where], distance, side,
                          (static_cast<float>(column) + 0.5f) * pixel - bundle.centre.w,
                          (static_cast<float>(row) + 0.5f) * pixel - bundle.centre.w);
        }
        hits[i] = best;
    }

  private:
    [[nodiscard]] gather_hit hit_at(const gather_triangle& t, std::uint32_t number, float distance,
                                    float side, float x, float y) const {
        const glm::vec3 a = shared::across_bundle(bundle, t.a);
        const glm::vec3 b = shared::across_bundle(bundle, t.b);
        const glm::vec3 c = shared::across_bundle(bundle, t.c);
        const shared::bundle_meeting met =
            shared::meet_triangle(a, b, c, x, y, shared::meeting_slack(bundle));
        gather_hit found;
        found.distance = distance;
        found.surface = 2 * number + (side * shared::facing_of_triangle(a, b, c) < 0.0f ? 0u : 1u);
        found.u = met.facing != 0.0f ? met.u : 1.0f / 3.0f;
        found.v = met.facing != 0.0f ? met.v : 1.0f / 3.0f;
        return found;
    }
};
static_assert(sizeof(layer_hits) == 76);

} // namespace skybark::kernels
