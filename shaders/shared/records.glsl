// The GLSL twins of skybark/core/records.hpp.
struct surface_vertex {
    vec3 position;
    float u;
    vec3 normal;
    float v;
    vec4 tangent;
};
struct branch_end {
    vec3 position;
    float radius;
    vec4 orientation;
    float path;
    float slope;
    float reserved0;
    float reserved1;
};
struct branch_segment {
    uint start;
    uint end;
    uint caps;
    uint reserved;
};
struct segment_pose {
    vec4 rotation;
    vec3 base;
    float reserved0;
    vec3 shift;
    float reserved1;
};
struct end_carrier {
    uint moved_by;
    uint turned_by;
    uint and_by;
    uint reserved;
};
struct leaf {
    vec3 position;
    float width;
    vec4 orientation;
    float length;
    uint carrier;
    uint seed;
    float fold;
};
struct segment_load {
    vec3 force;
    float drag;
};
struct cloud_particle {
    vec3 position;
    float radius;
    float optical_depth;
    float albedo;
    float reserved0;
    float reserved1;
};
struct light_grid {
    vec4 anchor;
    vec4 row_x;
    vec4 row_y;
    vec4 row_z;
    vec4 voxel;
};
