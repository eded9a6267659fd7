// The cells that a triangle is put into; see resolve.glsl.
struct cell_box {
    ivec2 low; // of the finest grid
    ivec2 high;
    uint level;
};

// Those that its box touches, so far as a sample beyond the box may meet the triangle.
cell_box cells_of(vec3 a, vec3 b, vec3 c) {
    precise float slack = meeting_slack(bundle);
    precise vec2 low = min(a.xy, min(b.xy, c.xy)) - slack;
    precise vec2 high = max(a.xy, max(b.xy, c.xy)) + slack;
    cell_box box;
    box.low = ivec2(grid_cell(low.x), grid_cell(low.y));
    box.high = ivec2(grid_cell(high.x), grid_cell(high.y));
    box.level = 0u;
    while (any(greaterThan((box.high >> box.level) - (box.low >> box.level), ivec2(2)))) {
        box.level += 1u;
    }
    return box;
}
