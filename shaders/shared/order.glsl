// Sort keys of numbers: whole numbers that grow, or fall, as the numbers do.
#include "records.glsl"

uint growing_key(float value)
{
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

uint falling_key(float value)
{
    return ~growing_key(value);
}
