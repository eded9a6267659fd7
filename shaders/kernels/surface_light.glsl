// Device side of skybark::kernels::surface_light.
#include "../skeletons/parameters.glsl"
#include "../shared/gathered_light.glsl"
layout(std430, binding = 0) readonly buffer owners_buffer { uint owners[]; };
layout(std430, binding = 1) readonly buffer tables_buffer { patch_table tables[]; };
layout(std430, binding = 2) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 3) readonly buffer materials_buffer { gather_material materials[]; };
layout(std430, binding = 4) readonly buffer irradiance_buffer { vec4 irradiance[]; };
layout(std430, binding = 5) writeonly buffer radiance_buffer { vec4 radiance[]; };

void kernel_map(uint i) {
    bool back = owners[i] % 2u == 1u;
    patch_table table = tables[owners[i] / 2u];
    uint other = back ? table.front + (i - table.back) : table.back + (i - table.front);
    vec4 behind = vec4(0.0);
    if (table.back != 0xffffffffu) {
        behind = irradiance[other];
    }
    radiance[i] =
        leaving_radiance(materials[triangles[owners[i] / 2u].material], irradiance[i], behind);
}
