#version 450
#include "peel.glsl"
