#pragma once
// Final gathering as ray tracers do it: a hemisphere of rays from each point, by Embree.

#include "../devices.hpp"
#include "../gather_work.hpp"
#include "irradiance_cache.hpp"
#include "tracing.hpp"

#include <chrono>

namespace skybark::benchmarks {

/// What leaves surfaces and comes from the sky.
struct gather_light_sources {
    std::vector<glm::vec3> radiance; ///< by gather_hit::surface, W/(m² sr)
    glm::vec3 sky{0};
};

[[nodiscard]] inline glm::vec3 light_seen(const gather_light_sources& light,
                                          const gather_hit& hit) {
    return hit.surface == no_surface ? light.sky : light.radiance[hit.surface];
}

/// A scene in Embree with its light, and points in it.
struct hemisphere_scene {
    RTCScene scene;
    const gather_light_sources* light;
    std::span<const gather_sample> samples;
    float lift; ///< m
};

/// Adds what each point sees along `direction_of(sample, i)` to its sum.
template <class DirectionOf>
void add_rays(cpu::device& device, const hemisphere_scene& in, embree_call call,
              std::span<glm::vec3> sums, DirectionOf&& direction_of) {
    device.for_pieces(sums.size(), 4096, [&](std::uint64_t first, std::uint64_t count) {
        const without_denormals guard;
        ray_chunk rays;
        std::array<gather_hit, ray_chunk::room> hits;
        for (std::uint64_t begin = first; begin < first + count; begin += ray_chunk::room) {
            const std::uint64_t end = std::min(begin + ray_chunk::room, first + count);
            for (std::uint64_t i = begin; i < end; ++i) {
                const gather_sample& at = in.samples[i];
                rays.add(at.position + in.lift * at.normal,
                         direction_of(at, static_cast<std::uint32_t>(i)),
                         static_cast<std::uint32_t>(i - begin));
            }
            trace(in.scene, call, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT, rays, hits);
            for (std::uint64_t i = begin; i < end; ++i) {
                sums[i] += light_seen(*in.light, hits[i - begin]);
            }
        }
    });
}

/// A direction of a set that falls evenly on one point's hemisphere: number k of n of a Fibonacci
/// lattice, shifted at random, another way for each point.
[[nodiscard]] inline glm::vec3 lattice_direction(const gather_sample& at, std::uint32_t i,
                                                 std::uint32_t k, std::uint32_t n,
                                                 std::uint32_t seed) {
    const double shift_u = scrambled(2 * i + scrambled(seed)) * 0x1p-32;
    const double shift_v = scrambled(2 * i + 1 + scrambled(seed)) * 0x1p-32;
    const double across = std::fmod((k + 0.5) / n + shift_u, 1.0);
    const double angle = 6.283185307179586 * std::fmod(k * 0.6180339887498949 + shift_v, 1.0);
    const double r = std::sqrt(across);
    return about_normal(at.normal, static_cast<float>(r * std::cos(angle)),
                        static_cast<float>(r * std::sin(angle)),
                        static_cast<float>(std::sqrt(1 - across)));
}

/// How irradiance is cached.
struct cache_options {
    float accuracy = 0.2f;
    std::uint32_t rays = 256; ///< of each record
};

/// One record: stratified rays, their mean and the harmonic mean of their lengths.
[[nodiscard]] inline cached_irradiance gather_record(const hemisphere_scene& in, std::uint32_t i,
                                                     const cache_options& options,
                                                     glm::vec2 spacings) {
    const gather_sample& at = in.samples[i];
    glm::vec3 sum(0);
    float nearness = 0;
    ray_chunk rays;
    std::array<gather_hit, ray_chunk::room> hits;
    for (std::uint32_t k = 0; k < options.rays; ++k) {
        rays.add(at.position + in.lift * at.normal, lattice_direction(at, i, k, options.rays, 1),
                 static_cast<std::uint32_t>(rays.count));
        if (rays.is_full() || k + 1 == options.rays) {
            const std::size_t traced = rays.count;
            trace(in.scene, embree_call::packet8, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT, rays,
                  hits);
            for (std::size_t j = 0; j < traced; ++j) {
                sum += light_seen(*in.light, hits[j]);
                nearness += 1 / std::max(hits[j].distance, in.lift);
            }
        }
    }
    const auto n = static_cast<float>(options.rays);
    cached_irradiance record{at.position, at.normal, 3.14159265f / n * sum, n / nearness};
    record.spacing = std::clamp(record.spacing, spacings.x, spacings.y);
    return record;
}

/// What interpolation came to.
struct cached_gather {
    std::vector<glm::vec3> irradiance; ///< one a point
    std::size_t records = 0;
};

/// A cache for each half of the points, so that both threads have one: first filled in their
/// order, then every point interpolates. `box` holds the scene.
[[nodiscard]] inline cached_gather gather_cached(cpu::device& device, const hemisphere_scene& in,
                                                 const gather::bounds& box,
                                                 const cache_options& options) {
    cached_gather out;
    out.irradiance.resize(in.samples.size());
    std::atomic<std::size_t> records = 0;
    const glm::vec3 size = box.high - box.low;
    const glm::vec2 spacings(0.001f * box.diagonal(), 0.064f * box.diagonal());
    device.for_pieces(
        in.samples.size(), (in.samples.size() + 1) / 2,
        [&](std::uint64_t first, std::uint64_t count) {
            const without_denormals guard;
            irradiance_cache cache(box.low, std::max({size.x, size.y, size.z}), options.accuracy);
            for (std::uint64_t i = first; i < first + count; ++i) {
                const gather_sample& at = in.samples[i];
                if (!cache.lookup(at.position, at.normal)) {
                    cache.insert(
                        gather_record(in, static_cast<std::uint32_t>(i), options, spacings));
                }
            }
            for (std::uint64_t i = first; i < first + count; ++i) {
                const gather_sample& at = in.samples[i];
                out.irradiance[i] = cache.lookup(at.position, at.normal).value_or(glm::vec3(0));
            }
            records += cache.size();
        });
    out.records = records;
    return out;
}

} // namespace skybark::benchmarks
