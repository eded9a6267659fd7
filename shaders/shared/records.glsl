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
