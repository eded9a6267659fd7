#version 450
#include "resolve_fill.glsl"
