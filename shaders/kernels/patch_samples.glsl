// Device side of skybark::kernels::patch_samples.
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer owners_buffer { uint owners[]; };
layout(std430, binding = 1) readonly buffer tables_buffer { patch_table tables[]; };
layout(std430, binding = 2) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 3) writeonly buffer samples_buffer { gather_sample samples[]; };

void kernel_map(uint i) {
    bool back = owners[i] % 2u == 1u;
    patch_table table = tables[owners[i] / 2u];
    gather_triangle t = triangles[owners[i] / 2u];
    barycentric middle = patch_middle(table.rows, i - (back ? table.back : table.front));
    precise vec3 ab = t.b - t.a;
    precise vec3 ac = t.c - t.a;
    precise vec3 across = vec3(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z,
                               ab.x * ac.y - ab.y * ac.x);
    precise float size = sqrt((across.x * across.x + across.y * across.y) + across.z * across.z);
    float side = back ? -1.0 : 1.0;
    precise vec3 position = (t.a + middle.u * ab) + middle.v * ac;
    gather_sample made;
    made.position = position;
    made.reserved0 = 0.0;
    made.normal = size > 0.0 ? across * (side / size) : vec3(0.0);
    made.reserved1 = 0.0;
    samples[i] = made;
}
