// How clouds are lit where the eye sees them: along a ray through a particle, or a step of a ray
// through a grid.
#include "records.glsl"
#include "attenuation.glsl"
#include "cloud_shadow.glsl"
#include "phase.glsl"

// What a draw of clouds is told about light. Grids: of the three volumes that it reads.
struct cloud_lighting {
    light_grid sun_grid;     // attenuation of the sun
    light_grid sky_grid;     // attenuation straight up
    light_grid diffuse_grid; // light of the sun that has been scattered more than once
    vec4 phase;              // of one scattering, as in phase.glsl
    vec4 octaves;            // x: light, y: attenuation, z: g of each octave over the one before;
                             // w: how many, 1 for single scattering
    float forward;           // f of the continuum's light, 0 for others: the part of the energy
                             // that goes on forward and is not taken out, towards the eye neither
    float sigmas;            // of a Gaussian in a particle's radius
    float air;               // 1/m, extinction of the air between the cloud and the eye
    float sky;               // of the light from above and below, what is let in: 0 or 1
    float sky_thickness;     // two-stream thickness of one attenuation in the sky's volume
    float diffuse;           // what multiplies the third volume: 0 for none
    uint paper_form;         // 1: S = a tau P I; 0: a (1 - exp -tau) P I
    uint by_particle;        // 1: one light value a particle, from a buffer
    uint forward_point;      // 1: lit where what is seen was scattered; 0: in the billboard's plane
    float torn;              // how deep noise eats into a particle's outline, below 1; 0: not at all
    float grain;             // 1/m: 1 / the size of that noise's largest grains
    uint reserved0;
};

// What scatters, where a part f of what is scattered goes on as if nothing had happened: optical
// depths shrink to `depth` of themselves. Light that is scattered once has its whole phase function,
// times `single` (Nakajima and Tanaka 1988, the TMS correction); of light that was scattered before
// `diffuse` is scattered again (Joseph, Wiscombe and Weinman 1976).
struct scaled_scattering {
    float depth;
    float single;
    float diffuse;
};
scaled_scattering scattering_without(float albedo, float forward) {
    float depth = 1.0f - albedo * forward;
    scaled_scattering scaled;
    scaled.depth = depth;
    scaled.single = albedo / depth;
    scaled.diffuse = albedo * (1.0f - forward) / depth;
    return scaled;
}

// A sort key that puts the farther one first, from a squared distance (0 or more).
uint farther_first(float distance2) {
    return 4294967295u - uint(floatBitsToInt(distance2));
}

// Optical depth of a particle along a ray that passes its centre at the squared distance rho2 and
// is nearest to it at `ahead` metres before the eye: all of it, unless the eye is inside.
float puff_depth(float tau, float rho2, float ahead, float radius, float sigmas) {
    if (rho2 >= radius * radius) {
        return 0.0f;
    }
    float over = sigmas / radius;
    float whole = tau * exp_minus(0.5f * over * over * rho2);
    return ahead * over > 5.0f ? whole : whole * gaussian_above(-ahead * over);
}

// How far before the middle of a Gaussian of this depth, in sigmas, the light that leaves it towards
// the eye was scattered: the mean of 1/tau - 1/(exp tau - 1) of the way in, within 0.1 sigma for
// tau < 20, 0.3 for any.
float puff_front(float tau) {
    float t = min(tau, 40.0f);
    return 0.22f * t / (1.0f + 0.075f * t);
}

// The sum over octaves of the light that reaches a place and is scattered to the eye, 1/sr:
// a^i exp(-b^i A) P(c^i g) (Wrenninge, Kulla and Lundqvist, "Oz: The Great and Volumetric", SIGGRAPH
// Talks 2013). One octave is single scattering.
float octaves_scattered(vec4 octaves, vec4 phase, float attenuation, float cosine) {
    float sum = 0.0f;
    float light = 1.0f;
    float depth = attenuation;
    float c = 1.0f;
    int count = int(octaves.w);
    for (int i = 0; i < count; i = i + 1) {
        sum = sum + light * cloud_light(depth) * phase_value(phase_widened(phase, c), cosine);
        light = light * octaves.x;
        depth = depth * octaves.y;
        c = c * octaves.z;
    }
    return sum;
}

// The mean radiance inside a cloud without absorption that light from above and from below falls
// on: Schuster's two streams in the column of the place. `above` and `whole` are 3/4 (1 - g) tau of
// the column above the place and of all of it. In an endless layer of that depth,
// F_down - F_up = T F_0 everywhere and T = 1 / (1 + whole).
vec3 sky_inside(float above, float whole, vec3 from_above, vec3 from_below) {
    float all = max(whole, above);
    float scale = 0.5f / (1.0f + all);
    float down = (1.0f + 2.0f * (all - above)) * scale;
    float up = (1.0f + 2.0f * above) * scale;
    return vec3(from_above.x * down + from_below.x * up, from_above.y * down + from_below.y * up,
                from_above.z * down + from_below.z * up);
}

// What of a far thing's light the air takes out.
float air_between(float air, float distance) { return one_minus_exp(air * distance); }

// Premultiplied colour of a puff behind air: its own light, dimmed, and the air's before it.
vec4 behind_air(vec3 own, float alpha, float hidden, vec3 air) {
    float seen = 1.0f - hidden;
    float before = hidden * alpha;
    return vec4(own.x * seen + air.x * before, own.y * seen + air.y * before,
                own.z * seen + air.z * before, alpha);
}

// Where a ray from `eye` along the unit `direction` is inside a box: from x to y metres before the
// eye; nowhere if y <= x.
vec2 ray_in_box(vec3 eye, vec3 direction, vec3 low, vec3 high) {
    float first = 0.0f;
    float last = 1e30f;
    for (int i = 0; i < 3; i = i + 1) {
        float d = direction[i];
        if (abs(d) < 1e-12f) {
            if (eye[i] < low[i] || eye[i] > high[i]) {
                return vec2(0.0f, 0.0f);
            }
        } else {
            float a = (low[i] - eye[i]) / d;
            float b = (high[i] - eye[i]) / d;
            first = max(first, min(a, b));
            last = min(last, max(a, b));
        }
    }
    return vec2(first, last);
}
