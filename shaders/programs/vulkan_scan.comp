#version 450
#include "scan.glsl"
