#version 450
#include "sort_scatter.glsl"
