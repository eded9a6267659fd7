// Device side of skybark::kernels::wind_load.
#define KERNEL_PARAMETERS float half_density; float vogel; float reference;
#include "../skeletons/parameters.glsl"
#include "../shared/wind.glsl"
layout(std430, binding = 0) readonly buffer segments_buffer { wind_segment segments[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };
layout(std430, binding = 3) writeonly buffer loads_buffer { segment_load loads[]; };

void kernel_map(uint i) {
    loads[i] = wind_load_on(segments[i], poses[i].rotation, air[i], half_density, vogel, reference);
}
