#version 450
#include "resolve_place.glsl"
