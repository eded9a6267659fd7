// Device side of skybark::kernels::pose_ends.
#include "../skeletons/parameters.glsl"
#include "../shared/pose.glsl"
layout(std430, binding = 0) readonly buffer rest_buffer { branch_end rest[]; };
layout(std430, binding = 1) readonly buffer carriers_buffer { end_carrier carriers[]; };
layout(std430, binding = 2) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 3) writeonly buffer ends_buffer { branch_end ends[]; };

void kernel_map(uint i) {
    end_carrier by = carriers[i];
    ends[i] = posed_end(rest[i], poses[by.moved_by], poses[by.turned_by].rotation,
                        poses[by.and_by].rotation);
}
