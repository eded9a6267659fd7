// Rotation-minimising frames.

float dot3(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

vec3 cross3(vec3 a, vec3 b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// v over its length, or `otherwise` where it has none.
vec3 unit_or(vec3 v, vec3 otherwise) {
    float l2 = dot3(v, v);
    return l2 > 1e-30f ? v * (1.0f / sqrt(l2)) : otherwise;
}

// Moves the reference axis r of the frame at p1 with unit tangent t1 to p2 with unit tangent t2, by
// two reflections (Wang, Juettler, Zheng and Liu 2008, table I). The twist error of a step falls
// with the fourth power of its length.
vec3 double_reflection(vec3 p1, vec3 t1, vec3 r, vec3 p2, vec3 t2) {
    vec3 v1 = p2 - p1;
    float c1 = dot3(v1, v1);
    vec3 r_mirrored = r;
    vec3 t_mirrored = t1;
    if (c1 > 1e-30f) {
        r_mirrored = r - v1 * (2.0f / c1 * dot3(v1, r));
        t_mirrored = t1 - v1 * (2.0f / c1 * dot3(v1, t1));
    }
    vec3 v2 = t2 - t_mirrored;
    float c2 = dot3(v2, v2);
    return c2 > 1e-30f ? r_mirrored - v2 * (2.0f / c2 * dot3(v2, r_mirrored)) : r_mirrored;
}
