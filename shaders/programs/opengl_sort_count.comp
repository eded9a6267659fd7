#version 450
#include "sort_count.glsl"
