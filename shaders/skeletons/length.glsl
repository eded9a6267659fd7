// The number of elements: known to the host, or only to the device.
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
uint skybark_elements() {
    return (skybark_header.w & 1u) != 0u ? min(skybark_header.y, skybark_length[0])
                                         : skybark_header.y;
}
