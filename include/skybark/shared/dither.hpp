// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 7943835f14866c00673856449749065ab5fe31e591af91382e883b230873bcf9
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Ordered dithering: what is added to a value before it is rounded to whole steps, so that slow
// gradients show no contours.

// For a pixel, above -1/2 and below 1/2 of a step: in each square of 8 x 8 every multiple of 1/64
// plus 1/128, as far apart as they can be (Bayer, "An optimum method for two-level rendition of
// continuous-tone pictures", ICC 1973). A value that is a whole number of steps stays one.
inline float ordered_dither(int x, int y) {
    uint down = uint(y);
    uint across = uint(x) ^ down;
    uint rank = (across & 1u) << 5u | (down & 1u) << 4u | (across & 2u) << 2u |
                (down & 2u) << 1u | (across & 4u) >> 1u | (down & 4u) >> 2u;
    return (float(rank) + 0.5f) * 0.015625f - 0.5f;
}

} // namespace skybark::shared
