// What the maps that are laid over wood and leaves make of a surface: the light that it scatters,
// and where it looks.
#include "records.glsl"
#include "leaf.glsl"

struct bark_surface {
    vec3 albedo;
    vec3 normal; // unit
};

float surfaces_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Bark, by a texel of its normal map, whose alpha is the height between the albedos `low` and
// `high`. `geometric` is the surface's unit normal and `tangent` a vertex's, as it comes out of
// interpolation; `strength` scales the map's slopes. Where a vertex has no texture direction
// (tangent.w is 0) the surface is plain.
bark_surface bark_surface_of(vec4 texel, vec3 geometric, vec4 tangent, vec3 low, vec3 high,
                             float strength) {
    bark_surface s;
    s.albedo = mix(low, high, texel.w);
    // Across the normal: interpolated tangents lean, and may vanish.
    vec3 along = vec3(tangent.x, tangent.y, tangent.z);
    vec3 across = along - geometric * surfaces_dot(geometric, along);
    vec3 t = across * (1.0f / sqrt(max(surfaces_dot(across, across), 1e-12f)));
    vec3 b = vec3(geometric.y * t.z - geometric.z * t.y, geometric.z * t.x - geometric.x * t.z,
                  geometric.x * t.y - geometric.y * t.x) * tangent.w;
    float slope = strength * min(abs(tangent.w), 1.0f);
    vec3 n = geometric * (texel.z * 2.0f - 1.0f) + t * ((texel.x * 2.0f - 1.0f) * slope) +
             b * ((texel.y * 2.0f - 1.0f) * slope);
    s.normal = n * (1.0f / sqrt(surfaces_dot(n, n)));
    return s;
}

struct leaf_surface {
    vec3 reflected; // of the light on the side that is seen
    vec3 through;   // of the light on the other
};

// A leaf, by a texel of its picture (sRGB). What comes through is yellower: `through` times as much
// as is scattered back in the green.
leaf_surface leaf_surface_of(vec4 texel, float through) {
    leaf_surface s;
    s.reflected = vec3(leaf_linear(texel.x), leaf_linear(texel.y), leaf_linear(texel.z));
    s.through = s.reflected * vec3(1.1f, 1.0f, 0.3f) * through;
    return s;
}

// Light that leaves a leaf on the side that looks at the eye, as leaf_lit has it for one colour.
vec3 leaf_surface_lit(leaf_surface s, vec3 sunlight, float facing, vec3 here, vec3 behind) {
    return vec3(leaf_lit(s.reflected.x, s.through.x, sunlight.x, facing, here.x, behind.x),
                leaf_lit(s.reflected.y, s.through.y, sunlight.y, facing, here.y, behind.y),
                leaf_lit(s.reflected.z, s.through.z, sunlight.z, facing, here.z, behind.z));
}
