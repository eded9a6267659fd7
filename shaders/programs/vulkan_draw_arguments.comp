#version 450
// VkDrawIndirectCommand or VkDrawIndexedIndirectCommand for the triangles that a count_record says.
// header.x: first, y: base_vertex, z: the most corners that may be drawn, w: 1 where indexed.
layout(local_size_x = 1) in;
layout(push_constant) uniform skybark_block { uvec4 skybark_header; };
layout(std430, binding = 8) writeonly buffer arguments_buffer { uint arguments[]; };
layout(std430, binding = 10) readonly buffer length_buffer { uint length_in[]; };

void main() {
    bool indexed = skybark_header.w != 0u;
    arguments[0] = min(length_in[0], skybark_header.z / 3u) * 3u;
    arguments[1] = 1u;
    arguments[2] = indexed ? skybark_header.x : skybark_header.x + skybark_header.y;
    arguments[3] = indexed ? skybark_header.y : 0u;
    arguments[4] = 0u;
}
