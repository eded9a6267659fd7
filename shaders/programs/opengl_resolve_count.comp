#version 450
#include "resolve_count.glsl"
