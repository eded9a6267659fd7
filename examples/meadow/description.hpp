#pragma once
// What a meadow is asked for: what grows there, the weather, and who looks.

#include <cstdint>
#include <glm/vec3.hpp>

namespace skybark::meadow {

/// What is made once.
struct description {
    std::uint32_t width = 1280; ///< of pictures, pixels
    std::uint32_t height = 720;
    std::uint32_t supersampling = 2; ///< samples a pixel in each direction
    std::uint64_t seed = 1;          ///< of everything that is random
    std::uint32_t trees = 24;
    float grass = 1;                  ///< times as much of it as is usual; 0: none
    std::uint32_t cloud_voxels = 128; ///< on a side of the clouds' attenuation volumes
    std::uint32_t bounces = 2;        ///< of light, before it is gathered where it is seen
    std::uint32_t directions = 48;    ///< that each bounce, and the last gather, look along
};

/// What may change from frame to frame.
struct weather {
    double sun_azimuth = 235;  ///< degrees from north, clockwise
    double sun_elevation = 34; ///< degrees
    double turbidity = 2.4;    ///< 2 very clear … 10 haze
    float wind = 6;            ///< m/s, the mean 10 m above the ground
    float wind_from = 250;     ///< degrees from north, clockwise
    float cloud = 0.4f;        ///< part of the sky that is covered; above 0.8 no more of it

    [[nodiscard]] bool operator==(const weather&) const = default;
};

/// From where it is looked at.
struct camera {
    glm::vec3 eye{22, 3.4f, 62}; ///< m; y is above the ground there
    glm::vec3 target{-4, 7, 0};  ///< m
    float field = 0.7f;          ///< rad, vertical
};

} // namespace skybark::meadow
