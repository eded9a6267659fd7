// Unit quaternions as (x, y, z, w), and their interpolation with + - * / and sqrt alone, so that
// every backend gets the same bits.

// The rotated x, y and z axes.
vec3 quaternion_x(vec4 q) {
    return vec3(1.0f - 2.0f * (q.y * q.y + q.z * q.z), 2.0f * (q.x * q.y + q.w * q.z),
                2.0f * (q.x * q.z - q.w * q.y));
}
vec3 quaternion_y(vec4 q) {
    return vec3(2.0f * (q.x * q.y - q.w * q.z), 1.0f - 2.0f * (q.x * q.x + q.z * q.z),
                2.0f * (q.y * q.z + q.w * q.x));
}
vec3 quaternion_z(vec4 q) {
    return vec3(2.0f * (q.x * q.z + q.w * q.y), 2.0f * (q.y * q.z - q.w * q.x),
                1.0f - 2.0f * (q.x * q.x + q.y * q.y));
}

// arctan x for 0 <= x <= 1, error below 2e-8 (Abramowitz and Stegun, 4.4.49).
float arctan_unit(float x) {
    float s = x * x;
    return x * (1.0f + s * (-0.3333314528f + s * (0.1999355085f + s * (-0.1420889944f +
               s * (0.1065626393f + s * (-0.0752896400f + s * (0.0429096138f +
               s * (-0.0161657367f + s * 0.0028662257f))))))));
}

// sin x for 0 <= x <= pi/2, relative error below 2e-9 (Abramowitz and Stegun, 4.3.97).
float sin_quarter(float x) {
    float s = x * x;
    return x * (1.0f + s * (-0.1666666664f + s * (0.0083333315f + s * (-0.0001984090f +
               s * (0.0000027526f + s * -0.0000000239f)))));
}

// Both ends on the same hemisphere of the 3-sphere, and the angle between them. Half the angle has
// the tangent |a - b| / |a + b|, exact to the last bits where acos(a . b) has lost them (Kahan).
struct slerp_arc {
    vec4 a;
    vec4 b;
    float angle;       // 0 ... pi/2
    float inverse_sin; // 1 / sin(angle), 0 where the ends agree and a lerp is meant
};

slerp_arc slerp_begin(vec4 a, vec4 b) {
    slerp_arc arc;
    float cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    float side = cosine < 0.0f ? -1.0f : 1.0f;
    arc.a = a;
    arc.b = b * side;
    vec4 d = a - arc.b;
    vec4 s = a + arc.b;
    float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
    float s2 = s.x * s.x + s.y * s.y + s.z * s.z + s.w * s.w;
    arc.angle = s2 > 0.0f ? 2.0f * arctan_unit(sqrt(d2 / s2)) : 0.0f;
    // Below 1e-3 rad the chord is the arc to 1e-7.
    arc.inverse_sin = arc.angle > 0.001f ? 1.0f / sin_quarter(arc.angle) : 0.0f;
    return arc;
}

// Q(t) = [sin((1-t) theta) Q1 + sin(t theta) Q2] / sin theta (Akagi and Kitajima, eq. 2, mended).
// t = 0 and t = 1 give the ends' own bits, up to the sign that turns the long way into the short.
vec4 slerp_at(slerp_arc arc, float t) {
    float wa = 1.0f - t;
    float wb = t;
    if (arc.inverse_sin > 0.0f) {
        wa = t < 1.0f ? sin_quarter(wa * arc.angle) * arc.inverse_sin : 0.0f;
        wb = t > 0.0f ? sin_quarter(wb * arc.angle) * arc.inverse_sin : 0.0f;
        wa = t > 0.0f ? wa : 1.0f;
        wb = t < 1.0f ? wb : 1.0f;
    }
    return arc.a * wa + arc.b * wb;
}

vec4 slerp(vec4 a, vec4 b, float t) {
    vec4 q = slerp_at(slerp_begin(a, b), t);
    return q * (1.0f / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w));
}
