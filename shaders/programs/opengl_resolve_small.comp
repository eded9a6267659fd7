#version 450
#include "resolve_small.glsl"
