#version 450
// See volume_scan.glsl.
#define NUMBER int
#define FROM_FORMAT r32i
#define FROM_IMAGE iimage3D
#define INTO_FORMAT r32i
#define INTO_IMAGE iimage3D
#define INTO_WHOLE_NUMBERS
#include "volume_scan.glsl"
