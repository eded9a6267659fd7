// Device side of skybark::kernels::grid_wind.
#define KERNEL_PARAMETERS vec4 origin; vec4 per_spacing; uint nx; uint ny; uint nz;
#include "../skeletons/parameters.glsl"
#include "../shared/wind.glsl"
layout(std430, binding = 0) readonly buffer places_buffer { vec4 places[]; };
layout(std430, binding = 1) readonly buffer nodes_buffer { vec4 nodes[]; };
layout(std430, binding = 2) writeonly buffer air_buffer { vec4 air[]; };

vec4 row(wind_cell x, uint y, uint z) {
    uint first = (z * ny + y) * nx;
    return wind_between(nodes[first + x.low], nodes[first + x.high], x.t);
}

void kernel_map(uint i) {
    vec4 place = places[i];
    wind_cell x = wind_cell_of(place.x, origin.x, per_spacing.x, nx);
    wind_cell y = wind_cell_of(place.y, origin.y, per_spacing.y, ny);
    wind_cell z = wind_cell_of(place.z, origin.z, per_spacing.z, nz);
    vec4 low = wind_between(row(x, y.low, z.low), row(x, y.high, z.low), y.t);
    vec4 high = wind_between(row(x, y.low, z.high), row(x, y.high, z.high), y.t);
    vec4 u = wind_between(low, high, z.t);
    air[i] = wind_velocity(u.x, u.y, u.z);
}
