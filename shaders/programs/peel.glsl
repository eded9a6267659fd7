// peel: fragments that are nearer than their pixel's layer before; the depth test (greater, from 0)
// keeps the farthest of them. Goes with skeletons/peel.vert; peeled.glsl takes the pixels.
//
// What goes out, and is compared with by the next layer, are the bits of the depth that is compared
// here and not what the depth test has kept: layers come strictly nearer, however it rounds.
layout(location = 0) flat in uvec2 skybark_triangle; // its number, pixels in a row
layout(location = 0) out uvec2 skybark_fragment;     // the triangle's number, bits of the depth
layout(std430, binding = 8) readonly buffer depths_buffer { float depths[]; };

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    float depth = gl_FragCoord.z;
    if (!(depth > 0.0 && depth < depths[pixel.y * skybark_triangle.y + pixel.x])) {
        discard;
    }
    skybark_fragment = uvec2(skybark_triangle.x, floatBitsToUint(depth));
}
