#version 450
// accumulate, drawn: a pixel is a voxel. What blending sums in floats are whole numbers below 2^24,
// which floats hold exactly: an amount n is 256 * high + low with -128 <= low < 128.
#include KERNEL
#include "slab_raster.glsl"
layout(location = 0) flat in ivec2 skybark_cell;
layout(location = 0) out vec2 skybark_amount; // high, low

void main() {
    int slice = skybark_cell.y;
    ivec2 at = ivec2(gl_FragCoord.xy) - skybark_origin(slice - skybark_layers.z);
    uint i = uint(skybark_cell.x);
    int amount = kernel_amount(kernel_lateral(i, at.x, slice), kernel_row(i, at.y),
                               kernel_row(i, at.y + 1));
    int low = amount & 255;
    int carry = low >> 7;
    skybark_amount = vec2(float((amount >> 8) + carry), float(low - 256 * carry));
}
