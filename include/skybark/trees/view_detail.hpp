#pragma once
// From where a scene is looked at, and how exact it has to be: what every level of detail goes by.

#include <skybark/core/result.hpp>
#include <skybark/core/when_used.hpp>

#include <cmath>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace skybark::trees {

/// What is `r` metres wide and `d` metres from the camera is r · pixels_per_radian / d pixels wide:
/// at the middle of a perspective picture; towards its corners that's up to 1/cos² more. It goes by
/// distance alone, so that nothing changes when the camera only turns.
///
/// Numbers that are no view (a camera that is not finite, pixels_per_radian that is not a positive
/// number, a negative or NaN bound) mean full detail.
struct view_detail {
    glm::vec3 camera{0};         ///< m
    float pixels_per_radian = 0; ///< 0: everything in full detail
    float error = 0.25f;         ///< pixels a surface may be off by; 0: all sides and rings
    float thin = 0.0625f;        ///< pixels: thinner radii are thinned out; 0: none are
};

/// Whether a view means anything but full detail.
[[nodiscard]] inline bool is_view(const view_detail& view) {
    return std::isfinite(view.camera.x) && std::isfinite(view.camera.y) &&
           std::isfinite(view.camera.z) && std::isfinite(view.pixels_per_radian) &&
           view.pixels_per_radian > 0 && view.error >= 0 && std::isfinite(view.error) &&
           view.thin >= 0 && std::isfinite(view.thin);
}

/// The camera as the kernels take it: w is pixels_per_radian, 0 where it is no view.
[[nodiscard]] inline glm::vec4 camera_of(const view_detail& view) {
    return is_view(view) ? glm::vec4(view.camera, view.pixels_per_radian) : glm::vec4(0);
}

/// The view of a perspective camera: the picture's height in pixels and its vertical field of view
/// in radians. Errors: bad_input where the height is not a positive number, the field is not within
/// (0, π), or the camera is not finite.
template <class = when_used>
[[nodiscard]] result<view_detail> view_from(glm::vec3 camera, float image_height,
                                            float vertical_field) {
    view_detail view;
    view.camera = camera;
    view.pixels_per_radian = image_height / (2 * std::tan(vertical_field / 2));
    if (!(image_height > 0) || !(vertical_field > 0) || !(vertical_field < 3.1415926f)) {
        return fail(
            error_code::bad_input,
            "A view needs a picture of some height and a field of view between 0 and 180 degrees.");
    }
    if (!is_view(view)) {
        return fail(error_code::bad_input,
                    "A view needs a camera at a finite place and a finite picture.");
    }
    return view;
}

} // namespace skybark::trees
