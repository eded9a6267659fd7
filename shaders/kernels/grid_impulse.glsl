// Device side of skybark::kernels::grid_impulse.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; vec4 low; vec4 inverse_size;
#define KERNEL_VOLUMES 1
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "../shared/attenuation.glsl"

void kernel_voxel(ivec3 at) {
    int samples = int(inverse_size.w);
    float sum = 0.0;
    for (int k = 0; k < samples * samples * samples; ++k) {
        vec3 part = vec3(float(k % samples), float(k / samples % samples),
                         float(k / (samples * samples)));
        vec3 cells = vec3(at) + (part + vec3(0.5)) / float(samples);
        vec3 place = (place_of(grid, cells) - low.xyz) * inverse_size.xyz;
        bool inside = all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)));
        sum += inside ? textureLod(kernel_volumes[0], place, 0.0).x : 0.0;
    }
    imageStore(kernel_targets[0], at,
               vec4(sum * low.w * grid.voxel.y / float(samples * samples * samples)));
}
