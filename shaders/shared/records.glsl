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
struct gather_triangle {
    vec3 a;
    uint material;
    vec3 b;
    uint alpha;
    vec3 c;
    uint reserved;
};
struct gather_material {
    vec3 diffuse;
    uint two_sided;
    vec3 emission;
    float reserved0;
    vec3 transmission;
    float reserved1;
};
struct gather_sample {
    vec3 position;
    float reserved0;
    vec3 normal;
    float reserved1;
};
struct gather_hit {
    float distance;
    uint surface;
    float u;
    float v;
};
struct ray_bundle {
    vec4 centre;
    vec4 right;
    vec4 up;
    vec4 direction;
};
struct patch_table {
    uint front;
    uint back;
    uint rows;
    uint reserved;
};
