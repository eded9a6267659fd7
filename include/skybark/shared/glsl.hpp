#pragma once
// What the formulas in shaders/shared need to be C++: GLSL's types and built-in functions, by GLM.

#include <skybark/core/records.hpp>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace skybark::shared {

using glm::abs;
using glm::atan;
using glm::ceil;
using glm::clamp;
using glm::cos;
using glm::exp;
using glm::floatBitsToInt;
using glm::floatBitsToUint;
using glm::floor;
using glm::intBitsToFloat;
using glm::ivec2;
using glm::ivec3;
using glm::max;
using glm::min;
using glm::mix;
using glm::pow;
using glm::sin;
using glm::sqrt;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;

} // namespace skybark::shared
