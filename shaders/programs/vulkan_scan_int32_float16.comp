#version 450
// See volume_scan.glsl.
#define NUMBER int
#define FROM_FORMAT r32i
#define FROM_IMAGE iimage3D
#define INTO_FORMAT r16f
#define INTO_IMAGE image3D
#define INTO_FLOAT16
#include "volume_scan.glsl"
