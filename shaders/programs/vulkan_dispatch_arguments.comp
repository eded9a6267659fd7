#version 450
// VkDispatchIndirectCommand for as many elements as a count_record says, at most header.y, with
// header.z invocations an element side by side and header.w groups for every 64 of those.
layout(local_size_x = 1) in;
layout(push_constant) uniform skybark_block { uvec4 skybark_header; };
layout(std430, binding = 8) writeonly buffer arguments_buffer { uint arguments[]; };
layout(std430, binding = 10) readonly buffer length_buffer { uint length_in[]; };

void main() {
    uint elements = min(skybark_header.y, length_in[0]);
    uint groups = (elements * skybark_header.z + 63u) / 64u * skybark_header.w;
    uint rows = (groups + 65534u) / 65535u;
    arguments[0] = rows > 0u ? (groups + rows - 1u) / rows : 0u;
    arguments[1] = rows;
    arguments[2] = 1u;
}
