#version 450
#include "resolve_hits.glsl"
