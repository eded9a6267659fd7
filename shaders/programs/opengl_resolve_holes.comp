#version 450
#define RESOLVE_HOLES
#include "resolve_hits.glsl"
