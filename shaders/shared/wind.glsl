// Wind: the air's velocity as a sum of waves or from a grid, and what it does to a segment. Only
// + - * / sqrt and floor, so that every backend gets the same bits.
#include "records.glsl"
#include "pose.glsl"

// Four waves side by side: wave vectors in cycles per metre, amplitudes in m/s.
struct wind_waves {
    vec4 kx;
    vec4 ky;
    vec4 kz;
    vec4 ax;
    vec4 ay;
    vec4 az;
};

// Four sums of a velocity side by side, m/s.
struct wind_sums {
    vec4 x;
    vec4 y;
    vec4 z;
};

// What the wind sees of a segment, as drag areas (drag coefficient times area), m^2. axis: xyz at
// rest, unit; w: of the wood, from length times mean diameter. leaves.x: of the leaves it carries.
struct wind_segment {
    vec4 axis;
    vec4 leaves;
};

// cos(2 pi p), error below 1e-6: 1 - 2 sin^2(pi r) with r in -1/2 ... 1/2, and a polynomial for the
// sine that interpolates it at Chebyshev's points (error 7e-9).
vec4 wave_cosine(vec4 p) {
    vec4 r = p - floor(p + 0.5f);
    vec4 s = r * r;
    vec4 h = r * (3.1415926400772f + s * (-5.16771007666832f + s * (2.55007738652892f +
                 s * (-0.598290411283619f + s * 0.0776559122767420f))));
    return 1.0f - 2.0f * (h * h);
}

wind_sums wind_add(wind_sums sum, wind_waves w, vec4 phase, vec4 place) {
    vec4 c = wave_cosine(phase - (w.kx * place.x + w.ky * place.y + w.kz * place.z));
    sum.x = sum.x + w.ax * c;
    sum.y = sum.y + w.ay * c;
    sum.z = sum.z + w.az * c;
    return sum;
}

// xyz: velocity, m/s; w: speed.
vec4 wind_velocity(float x, float y, float z) {
    return vec4(x, y, z, sqrt(x * x + y * y + z * z));
}

// The mean, scaled for the place's height, and all waves.
vec4 wind_total(wind_sums sum, vec4 mean, float height_factor) {
    float x = (sum.x.x + sum.x.y) + (sum.x.z + sum.x.w);
    float y = (sum.y.x + sum.y.y) + (sum.y.z + sum.y.w);
    float z = (sum.z.x + sum.z.y) + (sum.z.z + sum.z.w);
    return wind_velocity(mean.x * height_factor + x, mean.y * height_factor + y,
                         mean.z * height_factor + z);
}

// Where a coordinate lies in a row of `count` nodes: the nodes about it, and how far it is from the
// first to the second, 0 ... 1. Outside the row it is the nearest node.
struct wind_cell {
    uint low;
    uint high;
    float t;
};
wind_cell wind_cell_of(float x, float origin, float per_spacing, uint count) {
    float last = float(count - 1u);
    float g = min(max((x - origin) * per_spacing, 0.0f), last);
    float low = floor(g);
    wind_cell cell;
    cell.low = uint(low);
    cell.high = uint(min(low + 1.0f, last));
    cell.t = g - low;
    return cell;
}

vec4 wind_between(vec4 a, vec4 b, float t) { return a * (1.0f - t) + b * t; }

// r^v for r >= 1 and -1 <= v <= 0, relative error below 4e-6 up to r = 50: the logarithm of the
// eighth root by its series in (s - 1) / (s + 1), then the exponential's, then three squarings.
float power_above_one(float r, float v) {
    float s = sqrt(sqrt(sqrt(r)));
    float z = (s - 1.0f) / (s + 1.0f);
    float y = z * z;
    float l = 2.0f * z * (1.0f + y * (0.333333333f + y * (0.2f + y * (0.142857143f +
                             y * (0.111111111f + y * 0.0909090909f)))));
    float e = l * v;
    float x = 1.0f + e * (1.0f + e * (0.5f + e * (0.166666667f + e * (0.0416666667f +
                             e * (0.00833333333f + e * (0.00138888889f + e * 0.000198412698f))))));
    float x2 = x * x;
    float x4 = x2 * x2;
    return x4 * x4;
}

// Force and damping on a segment whose rotation from rest is given. Wood is a cylinder, dragged by
// the part of the air's velocity across it; leaves are dragged with the air, and above the reference
// speed as its power 2 + vogel. The damping is the derivative of each force along itself, the
// largest. half_density: of the air, kg/m^3.
segment_load wind_load_on(wind_segment segment, vec4 rotation, vec4 air, float half_density,
                          float vogel, float reference) {
    vec3 u = vec3(air.x, air.y, air.z);
    vec3 axis = quaternion_rotate(rotation, vec3(segment.axis.x, segment.axis.y, segment.axis.z));
    vec3 across = u - axis * (axis.x * u.x + axis.y * u.y + axis.z * u.z);
    float speed_across =
        sqrt(across.x * across.x + across.y * across.y + across.z * across.z);
    float wood_drag = half_density * segment.axis.w * speed_across;
    bool yields = air.w > reference;
    float folded = yields ? power_above_one(air.w / reference, vogel) : 1.0f;
    float leaf_drag = half_density * segment.leaves.x * air.w * folded;
    segment_load load;
    load.force = across * wood_drag + u * leaf_drag;
    load.drag = 2.0f * wood_drag + (yields ? 2.0f + vogel : 2.0f) * leaf_drag;
    return load;
}
