#version 450
// No triangle has holes.
#include "bundle_look.glsl"

bool is_hole(uint alpha, float u, float v) { return false; }
