// Device side of skybark::kernels::bundle_corner.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; float reach;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };

vec4 kernel_corner(uint index) {
    gather_triangle t = triangles[index / 3u];
    vec3 place = index % 3u == 0u ? t.a : index % 3u == 1u ? t.b : t.c;
    vec3 at = across_bundle(bundle, place);
    return vec4(at.x / bundle.centre.w, at.y / bundle.centre.w, depth_of_layer(at.z, reach), 1.0);
}
