#version 450
#include "peeled.glsl"
