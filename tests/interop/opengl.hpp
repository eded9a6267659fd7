#pragma once
// The OpenGL backend, all but its programs.

#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/peel.hpp>
#include <skybark/opengl/volume_patterns.hpp>
#include <skybark/opengl/word_patterns.hpp>

/// A context without functions is refused.
[[nodiscard]] inline bool opengl_says_what_is_missing() {
    const auto made = skybark::opengl::device::create({});
    return !made && !made.error().message.empty();
}
