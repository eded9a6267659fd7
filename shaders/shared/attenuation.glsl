// Attenuation of light by particles of a cloud, and where they lie in the light's grid.
//
// Exponentials are made of + and × alone, so that a quantum that rounds up on one backend rounds up
// on all of them.
#include "records.glsl"

// e^−x for 0 <= x < 87, to 2e-7 of itself; 0 beyond, and for what is no number. Cody and Waite's reduction, then a series.
float exp_minus(float x)
{
    float within = x < 87.0f ? x : 87.0f;
    float halvings = floor(within * 1.44269504f + 0.5f);
    float r = halvings * 0.693145752f - within;
    r = r + halvings * 1.42860677e-6f;
    float p = 1.0f + r * (1.0f / 7.0f);
    p = 1.0f + r * (1.0f / 6.0f) * p;
    p = 1.0f + r * (1.0f / 5.0f) * p;
    p = 1.0f + r * (1.0f / 4.0f) * p;
    p = 1.0f + r * (1.0f / 3.0f) * p;
    p = 1.0f + r * (1.0f / 2.0f) * p;
    p = 1.0f + r * p;
    int exponent = 127 - int(halvings);
    return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}

// 1 − e^−x for x >= 0: exact where x is small, too.
float one_minus_exp(float x)
{
    float p = 1.0f - x * (1.0f / 9.0f);
    p = 1.0f - x * (1.0f / 8.0f) * p;
    p = 1.0f - x * (1.0f / 7.0f) * p;
    p = 1.0f - x * (1.0f / 6.0f) * p;
    p = 1.0f - x * (1.0f / 5.0f) * p;
    p = 1.0f - x * (1.0f / 4.0f) * p;
    p = 1.0f - x * (1.0f / 3.0f) * p;
    p = 1.0f - x * (1.0f / 2.0f) * p;
    return x < 0.5f ? x * p : 1.0f - exp_minus(x);
}

// ln of a sum that is given twice: as it is, exact where it is small, and less 1, exact where it is
// near 1. The area tangent's series on (√½, √2), powers of two aside.
float log_of_sum(float sum, float less_one)
{
    float twos = 0.0f;
    float less = less_one;
    if (less_one < -0.25f || less_one > 0.4f) {
        int bits = floatBitsToInt(max(sum, 1.2e-38f));
        int power = (bits - 0x3f3504f3) >> 23;
        less = intBitsToFloat(bits - power * 8388608) - 1.0f;
        twos = float(power);
    }
    float s = less / (2.0f + less);
    float s2 = s * s;
    float p = s2 * (1.0f / 11.0f) + 1.0f / 9.0f;
    p = s2 * p + 1.0f / 7.0f;
    p = s2 * p + 1.0f / 5.0f;
    p = s2 * p + 1.0f / 3.0f;
    p = s2 * p + 1.0f;
    return 2.0f * s * p + twos * 0.693147181f;
}

// ½ erfc(u / √2): what of a Gaussian of unit width lies above u. To 3e-7, 1e-7 of it the formula's
// (Abramowitz and Stegun, Handbook of Mathematical Functions, 7.1.26), the rest rounding.
float gaussian_above(float u)
{
    float x = abs(u) * 0.707106781f;
    float t = 1.0f / (1.0f + 0.3275911f * x);
    float p = 1.061405429f * t - 1.453152027f;
    p = p * t + 1.421413741f;
    p = p * t - 0.284496736f;
    p = p * t + 0.254829592f;
    float tail = 0.5f * (p * t * exp_minus(x * x));
    return u < 0.0f ? 1.0f - tail : tail;
}

// Where a place lies in the grid, in voxels.
vec3 cells_of(light_grid grid, vec3 place)
{
    float px = place.x - grid.anchor.x;
    float py = place.y - grid.anchor.y;
    float pz = place.z - grid.anchor.z;
    return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
                grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
                grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}

// And back: the place of voxel coordinates.
vec3 place_of(light_grid grid, vec3 cells)
{
    float x = (cells.x - grid.row_x.w) * grid.voxel.x * grid.voxel.x;
    float y = (cells.y - grid.row_y.w) * grid.voxel.y * grid.voxel.y;
    float z = (cells.z - grid.row_z.w) * grid.voxel.z * grid.voxel.z;
    return vec3(
        grid.anchor.x + grid.row_x.x * x + grid.row_y.x * y + grid.row_z.x * z,
        grid.anchor.y + grid.row_x.y * x + grid.row_y.y * y + grid.row_z.y * z,
        grid.anchor.z + grid.row_x.z * x + grid.row_y.z * y + grid.row_z.z * z);
}

// A coordinate or a radius in voxels as an int can hold it, of particles that nobody has checked:
// what is no number, or beyond any grid, lies a million voxels below it, where it adds nothing.
float holdable(float cells)
{
    return abs(cells) < 1.0e6f ? cells : -1.0e6f;
}
vec3 holdable_cells_of(light_grid grid, vec3 place)
{
    vec3 cells = cells_of(grid, place);
    return vec3(holdable(cells.x), holdable(cells.y), holdable(cells.z));
}

// A number of a particle that nobody has checked: 0 for what is below it or no number.
float bounded(float x, float largest)
{
    return x > 0.0f ? min(x, largest) : 0.0f;
}

// What light a particle takes out along a line that passes its centre at the squared distance d2
// (m²): −ln G. `light` is 0 for extinction alone, 1 for the continuum limit, 2 for the paper's
// product (eq. 7); `forward` is the part of the energy that goes on forward, or P(0).
float particle_attenuation(cloud_particle p, float d2, float sigmas, uint light, float forward)
{
    float r2 = p.radius * p.radius;
    if (d2 >= r2) {
        return 0.0f;
    }
    float tau = bounded(p.optical_depth, 1e6f) * exp_minus(0.5f * sigmas * sigmas * d2 / r2);
    float albedo = bounded(p.albedo, 1.0f);
    float on = albedo * forward * tau;
    if (light == 2u && on > 0.0f) {
        return -log_of_sum(exp_minus(tau) + on, on - one_minus_exp(tau));
    }
    return light == 1u ? tau * (1.0f - albedo * forward) : tau;
}

// Quanta on a line that an int32 holds. Of a particle too deep for the quantum so many are left that
// it is dark behind it, and that 31 of them can be added up.
float summable(float amount)
{
    return amount < 2147483520.0f ? amount : (amount > 0.0f ? 67108864.0f : 0.0f);
}

// The highest row of voxels whose centres lie below a particle's top, and the highest whose
// centres lie at or below its bottom; `y` and `radius` in voxels.
int top_row(float y, float radius)
{
    return int(ceil(y + radius - 0.5f)) - 1;
}
int bottom_row(float y, float radius)
{
    return int(floor(y - radius - 0.5f));
}

// What part of a particle lies above the middle of a row. Profile 0 is the paper's step: all of
// it from the top row down; 1 integrates through the body.
float part_above(uint profile, int row, float y, float radius, float sigmas)
{
    if (row > top_row(y, radius)) {
        return 0.0f;
    }
    if (profile == 0u || row <= bottom_row(y, radius)) {
        return 1.0f;
    }
    return gaussian_above((float(row) + 0.5f - y) / radius * sigmas);
}

// A contribution as a whole number of quanta: what is `summable`, or a part of it.
int quanta(float amount)
{
    return int(floor(amount + 0.5f));
}
