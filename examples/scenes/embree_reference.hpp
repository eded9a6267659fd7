#pragma once
// What samples meet along a bundle, by Embree's own watertight tests, and how much others differ.

#include <scenes/embree_scene.hpp>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace skybark::scenes {

class embree_reference {
  public:
    explicit embree_reference(std::span<const gather_triangle> triangles)
        : scene_(triangles, embree_build::exact) {}

    /// The ray begins off its surface by the bundle's lift. Fronts count from half a lift behind
    /// that on, backs from half a lift before it on.
    [[nodiscard]] gather_hit first_hit(const ray_bundle& bundle, const gather_sample& at) const {
        const float lift = bundle.right.w;
        const glm::vec3 axis(bundle.direction);
        const glm::vec3 direction = glm::dot(at.normal, axis) >= 0 ? axis : -axis;
        const glm::vec3 origin = at.position + lift * at.normal - 0.5f * lift * direction;
        lifted_context context;
        rtcInitIntersectContext(&context.base);
        context.base.filter = leave_out_near_backs;
        context.nearest_back = lift;
        RTCRayHit ray = ray_of(origin, direction, 0);
        rtcIntersect1(scene_.get(), &context.base, &ray);
        gather_hit hit;
        if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            hit.distance = std::max(ray.ray.tfar - 0.5f * lift, 0.0f);
            hit.surface = 2 * ray.hit.primID + (sees_back(ray.ray, ray.hit) ? 1u : 0u);
            hit.u = ray.hit.u;
            hit.v = ray.hit.v;
        }
        return hit;
    }

  private:
    struct lifted_context {
        RTCIntersectContext base;
        float nearest_back;
    };

    [[nodiscard]] static bool sees_back(const RTCRay& ray, const RTCHit& hit) {
        return ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z > 0;
    }

    static void leave_out_near_backs(const RTCFilterFunctionNArguments* found) {
        const auto* context = reinterpret_cast<const lifted_context*>(found->context);
        const auto& ray = *reinterpret_cast<const RTCRay*>(found->ray);
        const auto& hit = *reinterpret_cast<const RTCHit*>(found->hit);
        if (sees_back(ray, hit) && ray.tfar < context->nearest_back) {
            found->valid[0] = 0;
        }
    }

    embree_scene scene_;
};

/// Counts of rays whose hits differ from Embree's.
struct hit_differences {
    std::uint64_t rays = 0;
    std::uint64_t met = 0; ///< rays that meet something, in both
    std::uint64_t other_hits = 0;
    std::uint64_t other_distances = 0;

    /// `tolerance` of distances, m.
    void add(const gather_hit& hit, const gather_hit& expected, double tolerance) {
        ++rays;
        const bool is_met = hit.surface != no_surface;
        if (is_met != (expected.surface != no_surface)) {
            ++other_hits;
        } else if (is_met) {
            ++met;
            const double apart =
                static_cast<double>(hit.distance) - static_cast<double>(expected.distance);
            other_distances += std::abs(apart) <= tolerance ? 0u : 1u;
        }
    }

    /// Of all rays.
    [[nodiscard]] double share(std::uint64_t count) const {
        return rays == 0 ? 0 : static_cast<double>(count) / static_cast<double>(rays);
    }
};

} // namespace skybark::scenes
