// Where in an alpha map a place is.
#include "records.glsl"

// The texel, of `count` along one side, that the place lies in: 0…1 from edge to edge, repeated.
uint alpha_texel(float place, uint count)
{
    float within = place - floor(place);
    float texel = within * float(count);
    return texel > 0.0f ? min(uint(min(texel, 65535.0f)), count - 1u) : 0u;
}

// Between the places of three corners, by the weights of the second and third.
float alpha_place(float a, float b, float c, float u, float v)
{
    precise float place = (a + u * (b - a)) + v * (c - a);
    return place;
}
