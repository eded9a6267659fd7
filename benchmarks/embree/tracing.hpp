#pragma once
// Rays for many points at once by Embree, by each of its calls.

#include <scenes/embree_scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>
#include <xmmintrin.h>

namespace skybark::benchmarks {

enum class embree_call { single, packet8, packet16, stream };
inline constexpr embree_call embree_calls[] = {embree_call::single, embree_call::packet8,
                                               embree_call::packet16, embree_call::stream};
inline constexpr const char* embree_call_names[] = {"single", "packet8", "packet16", "stream"};

/// Rays that wait to be traced together, and whose they are.
struct ray_chunk {
    static constexpr std::size_t room = 1024;

    std::array<glm::vec3, room> origins;
    std::array<glm::vec3, room> directions;
    std::array<std::uint32_t, room> owners;
    std::size_t count = 0;

    [[nodiscard]] bool is_full() const { return count == room; }
    void add(glm::vec3 origin, glm::vec3 direction, std::uint32_t owner) {
        origins[count] = origin;
        directions[count] = direction;
        owners[count] = owner;
        ++count;
    }
};

/// Denormals count as zero while this lives, as Embree's manual wants.
class without_denormals {
  public:
    without_denormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
    ~without_denormals() { _mm_setcsr(before_); }
    without_denormals(const without_denormals&) = delete;
    without_denormals& operator=(const without_denormals&) = delete;

  private:
    unsigned before_;
};

namespace detail {

[[nodiscard]] inline gather_hit hit_of(const RTCRayHit& ray) {
    gather_hit hit;
    if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        const bool back = ray.ray.dir_x * ray.hit.Ng_x + ray.ray.dir_y * ray.hit.Ng_y +
                              ray.ray.dir_z * ray.hit.Ng_z >
                          0;
        hit = {ray.ray.tfar, 2 * ray.hit.primID + (back ? 1u : 0u), ray.hit.u, ray.hit.v};
    }
    return hit;
}

inline void trace_single(RTCScene scene, RTCIntersectContext& context, const ray_chunk& rays,
                         std::span<gather_hit> hits) {
    for (std::size_t i = 0; i < rays.count; ++i) {
        RTCRayHit ray = scenes::ray_of(rays.origins[i], rays.directions[i], 0);
        rtcIntersect1(scene, &context, &ray);
        hits[rays.owners[i]] = hit_of(ray);
    }
}

inline void trace_stream(RTCScene scene, RTCIntersectContext& context, const ray_chunk& rays,
                         std::span<gather_hit> hits) {
    constexpr std::size_t length = 256;
    std::array<RTCRayHit, length> stream;
    for (std::size_t first = 0; first < rays.count; first += length) {
        const std::size_t count = std::min(length, rays.count - first);
        for (std::size_t i = 0; i < count; ++i) {
            stream[i] = scenes::ray_of(rays.origins[first + i], rays.directions[first + i], 0);
        }
        rtcIntersect1M(scene, &context, stream.data(), static_cast<unsigned>(count),
                       sizeof(RTCRayHit));
        for (std::size_t i = 0; i < count; ++i) {
            hits[rays.owners[first + i]] = hit_of(stream[i]);
        }
    }
}

template <std::size_t N, class Packet, class Intersect>
void trace_packets(RTCScene scene, RTCIntersectContext& context, const ray_chunk& rays,
                   std::span<gather_hit> hits, Intersect intersect) {
    alignas(64) Packet packet{};
    alignas(64) std::array<int, N> valid{};
    for (std::size_t first = 0; first < rays.count; first += N) {
        const std::size_t count = std::min(N, rays.count - first);
        for (std::size_t i = 0; i < N; ++i) {
            const std::size_t from = first + std::min(i, count - 1);
            valid[i] = i < count ? -1 : 0;
            packet.ray.org_x[i] = rays.origins[from].x;
            packet.ray.org_y[i] = rays.origins[from].y;
            packet.ray.org_z[i] = rays.origins[from].z;
            packet.ray.tnear[i] = 0;
            packet.ray.dir_x[i] = rays.directions[from].x;
            packet.ray.dir_y[i] = rays.directions[from].y;
            packet.ray.dir_z[i] = rays.directions[from].z;
            packet.ray.tfar[i] = no_distance;
            packet.ray.mask[i] = 0xffffffffu;
            packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(valid.data(), scene, &context, &packet);
        for (std::size_t i = 0; i < count; ++i) {
            gather_hit hit;
            if (packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
                const bool back = packet.ray.dir_x[i] * packet.hit.Ng_x[i] +
                                      packet.ray.dir_y[i] * packet.hit.Ng_y[i] +
                                      packet.ray.dir_z[i] * packet.hit.Ng_z[i] >
                                  0;
                hit = {packet.ray.tfar[i], 2 * packet.hit.primID[i] + (back ? 1u : 0u),
                       packet.hit.u[i], packet.hit.v[i]};
            }
            hits[rays.owners[first + i]] = hit;
        }
    }
}

} // namespace detail

/// Traces the rays of a chunk, writes to their owners' hits, and empties it.
inline void trace(RTCScene scene, embree_call call, RTCIntersectContextFlags coherence,
                  ray_chunk& rays, std::span<gather_hit> hits) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherence;
    if (call == embree_call::single) {
        detail::trace_single(scene, context, rays, hits);
    } else if (call == embree_call::stream) {
        detail::trace_stream(scene, context, rays, hits);
    } else if (call == embree_call::packet8) {
        detail::trace_packets<8, RTCRayHit8>(scene, context, rays, hits, rtcIntersect8);
    } else {
        detail::trace_packets<16, RTCRayHit16>(scene, context, rays, hits, rtcIntersect16);
    }
    rays.count = 0;
}

/// A direction's two partners in a right-handed frame (Duff et al. 2017).
struct tangents {
    glm::vec3 right;
    glm::vec3 up;
};
[[nodiscard]] inline tangents tangents_of(glm::vec3 normal) {
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1 / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    return {{1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
            {b, sign + normal.y * normal.y * a, -normal.y}};
}

/// (x, y, z) in the frame of which the normal is z.
[[nodiscard]] inline glm::vec3 about_normal(glm::vec3 normal, float x, float y, float z) {
    const tangents t = tangents_of(normal);
    return x * t.right + y * t.up + z * normal;
}

/// PCG's permutation (O'Neill 2014): random bits of a number's own.
[[nodiscard]] inline std::uint32_t scrambled(std::uint32_t x) {
    x = x * 747796405u + 2891336453u;
    const std::uint32_t word = ((x >> ((x >> 28) + 4)) ^ x) * 277803737u;
    return (word >> 22) ^ word;
}

/// Cosine-distributed directions about a normal: picked at random from 65,536 that are evenly
/// spread.
class cosine_directions {
  public:
    cosine_directions() : table_(65536) {
        constexpr float golden_angle = 2.39996323f;
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const float across = (static_cast<float>(i) + 0.5f) / 65536;
            const float angle = golden_angle * static_cast<float>(i);
            const float r = std::sqrt(across);
            table_[i] = {r * std::cos(angle), r * std::sin(angle), std::sqrt(1 - across)};
        }
    }

    /// For point i in the given turn.
    [[nodiscard]] glm::vec3 about(glm::vec3 normal, std::uint32_t i, std::uint32_t turn) const {
        const glm::vec3 d = table_[scrambled(i + scrambled(turn)) >> 16];
        return about_normal(normal, d.x, d.y, d.z);
    }

  private:
    std::vector<glm::vec3> table_;
};

} // namespace skybark::benchmarks
