#version 450
#include "scan_add.glsl"
