#version 450
// After an expansion: the count_record {written, required}. header.x: the triangles that fit;
// y: the number of elements, or its upper limit; z: triangles an element where padding is
// degenerate; w: flags as everywhere (bit 0: the length is on the device, bit 1: degenerate).
layout(local_size_x = 1) in;
layout(push_constant) uniform skybark_block { uvec4 skybark_header; };
layout(std430, binding = 8) writeonly buffer record_buffer { uint record[]; };
layout(std430, binding = 9) readonly buffer total_buffer { uint total[]; };
layout(std430, binding = 10) readonly buffer length_buffer { uint length_in[]; };

void main() {
    bool counted = (skybark_header.w & 1u) != 0u;
    uint elements = counted ? min(skybark_header.y, length_in[0]) : skybark_header.y;
    uint required = 0u;
    if ((skybark_header.w & 2u) != 0u) {
        uint high;
        umulExtended(elements, skybark_header.z, high, required);
        required = high != 0u ? 0xffffffffu : required;
    } else {
        required = total[0];
    }
    record[0] = min(required, skybark_header.x);
    record[1] = required;
    record[2] = 0u;
    record[3] = 0u;
}
