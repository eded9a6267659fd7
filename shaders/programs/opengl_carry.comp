#version 450
// Between two passes of a drawn accumulation: what the sums of low parts have gathered goes over to
// the high parts, so that both stay small enough for floats to be exact. Of each pixel of `tiles`,
// or, where header.x is 1, of each voxel of `layers`; header.y: how many pixels or voxels are in a
// row.
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform skybark_block { uvec4 skybark_header; };
layout(binding = 5, rg32f) uniform image2D tiles;
layout(binding = 6, rg32f) uniform image3D layers;

vec4 carried(vec4 sum) {
    int low = int(sum.y);
    int carry = (low + 128) >> 8;
    return vec4(sum.x + float(carry), float(low - 256 * carry), 0.0, 0.0);
}

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    if (at.x >= int(skybark_header.y)) {
        return;
    }
    if (skybark_header.x == 1u) {
        imageStore(layers, at, carried(imageLoad(layers, at)));
    } else {
        imageStore(tiles, at.xy, carried(imageLoad(tiles, at.xy)));
    }
}
