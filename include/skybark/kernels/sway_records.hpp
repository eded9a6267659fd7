#pragma once
// The records of swaying branches as they lie in device buffers: shaders/shared/sway.glsl. The
// assertions hold the C++ structs to the layout that GLSL gives them.

#include <skybark/core/records.hpp>
#include <skybark/shared/sway.hpp>

namespace skybark::kernels {

static_assert(record<shared::sway_joint> && sizeof(shared::sway_joint) == 80);
static_assert(offsetof(shared::sway_joint, offset) == 16 &&
              offsetof(shared::sway_joint, base) == 32 &&
              offsetof(shared::sway_joint, mass) == 48 &&
              offsetof(shared::sway_joint, parent) == 64);
static_assert(record<shared::sway_state> && sizeof(shared::sway_state) == 128);
static_assert(offsetof(shared::sway_state, bend) == 16 &&
              offsetof(shared::sway_state, rate) == 32 &&
              offsetof(shared::sway_state, turn) == 48 &&
              offsetof(shared::sway_state, speed) == 64 &&
              offsetof(shared::sway_state, shift) == 80 &&
              offsetof(shared::sway_state, step_turn) == 96 &&
              offsetof(shared::sway_state, step_speed) == 112);
static_assert(record<shared::sway_energy> && sizeof(shared::sway_energy) == 32);
static_assert(record<shared::sway_carry> && sizeof(shared::sway_carry) == 112);
static_assert(record<shared::sway_gain> && sizeof(shared::sway_gain) == 96);
static_assert(record<shared::sway_moment> && sizeof(shared::sway_moment) == 64);

} // namespace skybark::kernels
