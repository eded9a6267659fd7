#version 450
#include "resolve_large.glsl"
