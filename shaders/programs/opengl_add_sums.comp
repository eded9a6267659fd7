#version 450
// After a drawn accumulation: 256 * high + low of each voxel is added to a volume of int32, or,
// where header.x is 1, replaces what is there. header.y: the volume's first layer, z: its width.
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform skybark_block { uvec4 skybark_header; };
layout(binding = 4, r32i) uniform iimage3D volume;
layout(binding = 6, rg32f) readonly uniform image3D layers;

void main() {
    ivec3 from = ivec3(gl_GlobalInvocationID);
    if (from.x >= int(skybark_header.z)) {
        return;
    }
    ivec3 into = from + ivec3(0, 0, skybark_header.y);
    ivec2 sum = ivec2(imageLoad(layers, from).xy);
    int total = 256 * sum.x + sum.y;
    if (skybark_header.x == 0u) {
        total += imageLoad(volume, into).x;
    }
    imageStore(volume, into, ivec4(total));
}
