#version 450
// See volume_scan.glsl.
#define NUMBER float
#define FROM_FORMAT r32f
#define FROM_IMAGE image3D
#define INTO_FORMAT r16f
#define INTO_IMAGE image3D
#define INTO_FLOAT16
#include "volume_scan.glsl"
