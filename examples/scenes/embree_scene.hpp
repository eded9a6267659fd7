#pragma once
// A scene as Embree 3 has it, to compare with. Only where libembree-dev is installed.

#include <skybark/core/records.hpp>

#include <cstring>
#include <embree3/rtcore.h>
#include <span>
#include <utility>

namespace skybark::scenes {

enum class embree_build {
    exact, ///< watertight, and rays may carry filters
    fast,  ///< its best hierarchy, and nothing that costs rays time
};

/// Owns the device and the scene. primID is the number of the triangle; material and alpha are left
/// out.
class embree_scene {
  public:
    embree_scene(std::span<const gather_triangle> triangles, embree_build build)
        : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        if (build == embree_build::exact) {
            rtcSetSceneFlags(scene_,
                             static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                        RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
        }
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* corners = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    3 * sizeof(float), 3 * triangles.size()));
        auto* indices = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), triangles.size()));
        std::uint32_t next = 0;
        for (const gather_triangle& t : triangles) {
            for (const glm::vec3 corner : {t.a, t.b, t.c}) {
                std::memcpy(corners + 3 * std::size_t{next}, &corner, sizeof(corner));
                indices[next] = next;
                ++next;
            }
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~embree_scene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    embree_scene(const embree_scene&) = delete;
    embree_scene& operator=(const embree_scene&) = delete;

    [[nodiscard]] RTCScene get() const { return scene_; }

  private:
    RTCDevice device_;
    RTCScene scene_;
};

/// A ray that has met nothing yet.
[[nodiscard]] inline RTCRayHit ray_of(glm::vec3 origin, glm::vec3 direction, float nearest) {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.tnear = nearest;
    ray.ray.dir_x = direction.x;
    ray.ray.dir_y = direction.y;
    ray.ray.dir_z = direction.z;
    ray.ray.tfar = no_distance;
    ray.ray.mask = 0xffffffffu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

} // namespace skybark::scenes
