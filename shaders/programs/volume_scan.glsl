// A running sum along an axis of a volume, times a scale, into another one: volume_scan of the
// contract. An invocation walks a column. Neighbouring invocations are neighbours along x, or along
// y where x is the axis: with `across` and `deep` the two other sides of the volume (for axis none:
// x and z, and each voxel's sum begins anew), group counts are across / 64, rounded up, and deep.
//
// header.x: axis (0 none, 1 x, 2 y, 3 z), y: 1 where it descends, z: share (0 whole, 1 half, 2
// none), w: the bits of the scale, a float. The source is an image at SKYBARK_SUMS_BINDING, the
// destination, as large, one at SKYBARK_TARGET_BINDING.
//
// Sums of int32 are exact, and become floats once for each voxel: float(before) + 0.5 * float(own)
// for halves, float(before + own) for the whole. Floats are rounded to float16 here.
layout(local_size_x = 64) in;
#include "../skeletons/parameters.glsl"
layout(binding = SKYBARK_SUMS_BINDING, FROM_FORMAT) readonly uniform FROM_IMAGE from_volume;
layout(binding = SKYBARK_TARGET_BINDING, INTO_FORMAT) writeonly uniform INTO_IMAGE into_volume;

#ifdef INTO_FLOAT16
// The nearest finite number that 16 bits hold, the even one of two. llvmpipe's own stores cut off instead.
float rounded(float value) {
    uint bits = floatBitsToUint(value);
    uint size = bits & 0x7fffffffu;
    if (size >= 0x477ff000u) { // 65520: the largest finite one, 65504, unless it is no number
        size = size > 0x7f800000u ? size : 0x477fe000u;
    } else if (size < 0x38800000u) { // 2^-14: subnormal, whole multiples of 2^-24
        size = floatBitsToUint(roundEven(uintBitsToFloat(size) * 16777216.0) / 16777216.0);
    } else {
        size = (size + 0xfffu + ((size >> 13) & 1u)) & ~0x1fffu;
    }
    return uintBitsToFloat(size | (bits & 0x80000000u));
}
#else
float rounded(float value) { return value; }
#endif

#ifdef INTO_WHOLE_NUMBERS
ivec4 shared_out(int before, int own) {
    return ivec4(skybark_header.z == 2u ? before : before + own);
}
#else
vec4 shared_out(NUMBER before, NUMBER own) {
    float sum = skybark_header.z == 0u   ? float(before + own)
                : skybark_header.z == 1u ? float(before) + 0.5 * float(own)
                                         : float(before);
    return vec4(rounded(sum * uintBitsToFloat(skybark_header.w)));
}
#endif

void main() {
    ivec3 size = imageSize(from_volume);
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    uint axis = skybark_header.x;
    ivec3 at = axis == 1u   ? ivec3(0, column)
               : axis == 3u ? ivec3(column, 0)
                            : ivec3(column.x, 0, column.y);
    if (any(greaterThanEqual(at, size))) {
        return;
    }
    ivec3 forward = axis == 1u ? ivec3(1, 0, 0) : axis == 3u ? ivec3(0, 0, 1) : ivec3(0, 1, 0);
    int count = axis == 1u ? size.x : axis == 3u ? size.z : size.y;
    if (skybark_header.y != 0u) {
        at += forward * (count - 1);
        forward = -forward;
    }
    NUMBER before = NUMBER(0);
    for (int n = 0; n < count; ++n) {
        NUMBER own = imageLoad(from_volume, at).x;
        imageStore(into_volume, at, shared_out(before, own));
        before = axis == 0u ? before : before + own;
        at += forward;
    }
}
