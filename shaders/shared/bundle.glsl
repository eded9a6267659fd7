// Bundles of parallel rays, and where one of them meets a triangle (Hachisuka 2005; exact at the
// ray's own place in place of a pixel's).
//
// No multiplication and addition may be fused into one here: what makes neighbours watertight is
// that the edge that they share has exactly opposite numbers in them.
#include "records.glsl"

// From the middle of the scene, m: x and y across the bundle, z along it.
vec3 across_bundle(ray_bundle bundle, vec3 place)
{
    precise float x = place.x - bundle.centre.x;
    precise float y = place.y - bundle.centre.y;
    precise float z = place.z - bundle.centre.z;
    precise float right = (x * bundle.right.x + y * bundle.right.y) + z * bundle.right.z;
    precise float up = (x * bundle.up.x + y * bundle.up.y) + z * bundle.up.z;
    precise float along =
        (x * bundle.direction.x + y * bundle.direction.y) + z * bundle.direction.z;
    return vec3(right, up, along);
}

// Where a sample's ray begins: off its surface by the lift.
vec3 ray_origin(ray_bundle bundle, gather_sample at)
{
    precise float x = at.position.x + bundle.right.w * at.normal.x;
    precise float y = at.position.y + bundle.right.w * at.normal.y;
    precise float z = at.position.z + bundle.right.w * at.normal.z;
    return vec3(x, y, z);
}

// 1: the sample looks along the bundle; −1: against it.
float side_of_bundle(ray_bundle bundle, vec3 normal)
{
    precise float along = (normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
                          normal.z * bundle.direction.z;
    return along >= 0.0f ? 1.0f : -1.0f;
}

struct bundle_meeting {
    float facing; // 0: the ray misses; > 0: the front looks along the bundle; < 0: against it
    float depth;  // z where they meet
    float u;      // barycentric weight of b
    float v;      // … and of c
};

// How far beyond a triangle's box a line may be to meet it, m: as far as rounding goes.
float meeting_slack(ray_bundle bundle)
{
    precise float slack = 1e-6f * bundle.centre.w;
    return slack;
}

// Whether `at` lies between the least and the greatest of three numbers, or `slack` beyond.
bool is_between(float a, float b, float c, float at, float slack)
{
    precise float low = min(a, min(b, c)) - slack;
    precise float high = max(a, max(b, c)) + slack;
    return at >= low && at <= high;
}

// The line at (x, y) and the triangle of these corners, all across the bundle (x, y and z). Lines
// on an edge meet both of its triangles, those on a corner all of them. Triangles seen edge-on, and
// those with a corner that is no number, meet nothing; nor does a line far from a triangle so small
// that its edges are rounding alone.
bundle_meeting meet_triangle(vec3 a, vec3 b, vec3 c, float x, float y, float slack)
{
    precise float ax = a.x - x;
    precise float ay = a.y - y;
    precise float bx = b.x - x;
    precise float by = b.y - y;
    precise float cx = c.x - x;
    precise float cy = c.y - y;
    precise float e0 = bx * cy - by * cx;
    precise float e1 = cx * ay - cy * ax;
    precise float e2 = ax * by - ay * bx;
    precise float area = (e0 + e1) + e2;
    bool inside = (e0 >= 0.0f && e1 >= 0.0f && e2 >= 0.0f) ||
                  (e0 <= 0.0f && e1 <= 0.0f && e2 <= 0.0f);
    inside = inside && is_between(a.x, b.x, c.x, x, slack) && is_between(a.y, b.y, c.y, y, slack);
    bundle_meeting found;
    found.facing = 0.0f;
    found.depth = 0.0f;
    found.u = 0.0f;
    found.v = 0.0f;
    if (inside && area != 0.0f) {
        precise float depth = ((e0 * a.z + e1 * b.z) + e2 * c.z) / area;
        precise float u = e1 / area;
        precise float v = e2 / area;
        found.facing = area;
        found.depth = depth;
        found.u = u;
        found.v = v;
    }
    return found;
}

// Twice the area of a triangle across the bundle: > 0 where its front looks along the bundle.
float facing_of_triangle(vec3 a, vec3 b, vec3 c)
{
    precise float facing = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return facing;
}

// How far a ray that begins at `z` and looks to `side` goes to what it meets; negative where that
// does not count. Fronts count from half a lift behind the origin on, so that a sample in a corner
// doesn't see through the wall that it touches; backs from half a lift before it on, so that the
// wall doesn't hide what lies before it. A sample's own surface is a lift or more behind.
float distance_along(bundle_meeting met, float side, float z, float lift)
{
    precise float distance = side * (met.depth - z);
    bool front = side * met.facing < 0.0f;
    float least = front ? -0.5f * lift : 0.5f * lift;
    bool counts = met.facing != 0.0f && distance > least;
    return counts ? max(distance, 0.0f) : -1.0f;
}

// ---- Layers of depth: z from −reach to reach becomes a depth within 0 and 1

float depth_of_layer(float z, float reach)
{
    precise float depth = 0.5f + 0.49f * (z / reach);
    return depth;
}

float place_of_layer(float depth, float reach)
{
    precise float z = (depth - 0.5f) * (reach / 0.49f);
    return z;
}

// How far, along the bundle, a plane of this normal rises over `apart` to each side.
float rise_in_pixel(ray_bundle bundle, vec3 normal, float apart)
{
    float right = abs((normal.x * bundle.right.x + normal.y * bundle.right.y) +
                      normal.z * bundle.right.z);
    float up = abs((normal.x * bundle.up.x + normal.y * bundle.up.y) + normal.z * bundle.up.z);
    float along = abs((normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
                      normal.z * bundle.direction.z);
    return apart * (right + up) / max(along, 0.001f);
}

// ---- The grids: the finest has `cells` on a side, each next one half of it, the last has one cell.
// A triangle is in the cell of its middle, in the finest grid of which two cells are as wide as it
// is. So a ray meets only triangles of its own cell and of the eight around it, of each grid.

// How many levels there are.
uint bundle_levels(uint cells)
{
    uint levels = 1u;
    for (uint n = cells; n > 1u; n = n / 2u) {
        levels = levels + 1u;
    }
    return levels;
}

// The number of the first cell of a level; of level bundle_levels(cells): how many there are.
uint first_cell(uint cells, uint level)
{
    uint first = 0u;
    for (uint l = 0u; l < level; ++l) {
        first = first + (cells >> l) * (cells >> l);
    }
    return first;
}

// From metres across to cells of the finest grid.
float bundle_cells(ray_bundle bundle, float across)
{
    precise float cells = (across + bundle.centre.w) * bundle.up.w;
    return cells;
}

// The cell on a side of `count` that `place` lies in; places beyond the grid are in its last ones.
int cell_within(float place, int count)
{
    return place >= 1.0f ? int(min(place, float(count) - 0.5f)) : 0;
}

// The finest level at which two cells are as wide as `extent` cells of the finest grid, and a
// little, so that rounding loses no triangle.
uint bundle_level(float extent, uint levels)
{
    uint level = 0u;
    float widest = 1.99f;
    while (level + 1u < levels && !(extent <= widest)) {
        level = level + 1u;
        widest = widest * 2.0f;
    }
    return level;
}

// The number of the cell of a triangle with these corners across.
uint bundle_cell(ray_bundle bundle, vec3 a, vec3 b, vec3 c)
{
    uint cells = uint(bundle.direction.w);
    float low_x = min(a.x, min(b.x, c.x));
    float low_y = min(a.y, min(b.y, c.y));
    float high_x = max(a.x, max(b.x, c.x));
    float high_y = max(a.y, max(b.y, c.y));
    float extent = max(high_x - low_x, high_y - low_y) * bundle.up.w;
    uint level = bundle_level(extent, bundle_levels(cells));
    int count = int(cells >> level);
    float share = float(count) / float(cells);
    int x = cell_within(bundle_cells(bundle, 0.5f * (low_x + high_x)) * share, count);
    int y = cell_within(bundle_cells(bundle, 0.5f * (low_y + high_y)) * share, count);
    return first_cell(cells, level) + uint(y * count + x);
}

// ---- Patches: `rows`² equal triangles of a triangle

// Which of them barycentric weights u of b and v of c fall into. Row j counts from the edge ab.
uint patch_at(uint rows, float u, float v)
{
    int n = int(rows);
    float x = u * float(n);
    float y = v * float(n);
    int j = cell_within(y, n);
    int i = cell_within(x, n - j);
    bool upper = i + j + 1 < n && (x - float(i)) + (y - float(j)) > 1.0f;
    return uint(j * (2 * n - j) + 2 * i + (upper ? 1 : 0));
}

struct barycentric {
    float u;
    float v;
};

// The middle of the patch that patch_at finds there.
barycentric patch_middle(uint rows, uint number)
{
    int n = int(rows);
    int m = int(number);
    // m = n² − (n − j)² + 2 i + upper, so that n − j is the root, rounded up, of what is left.
    int left = n * n - m;
    int k = int(ceil(sqrt(float(left))));
    k = (k - 1) * (k - 1) >= left ? k - 1 : k;
    k = k * k < left ? k + 1 : k;
    int j = n - k;
    int within = m - j * (2 * n - j);
    float third = within % 2 == 1 ? 2.0f / 3.0f : 1.0f / 3.0f;
    barycentric middle;
    middle.u = (float(within / 2) + third) / float(n);
    middle.v = (float(j) + third) / float(n);
    return middle;
}
