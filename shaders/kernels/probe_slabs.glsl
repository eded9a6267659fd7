// Device side of skybark::kernels::probe_slabs.
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
#include "../skeletons/parameters.glsl"
struct probe_box {
    ivec4 low;
    ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };

uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
    probe_box box = boxes[i];
    int by = int(s);
    return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
                      box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
    return float(boxes[i].low.w + per_x * x + per_z * z);
}
float kernel_row(uint i, int y) { return float(boxes[i].high.w * (y + 1)); }
int kernel_amount(float lateral, float row, float above) {
    return int(lateral + 2.0 * row - above) * factor;
}
