// The cells that a triangle is put into; see resolve.glsl.
struct cell_box {
    ivec2 low; // of the finest grid
    ivec2 high;
    uint level;
    bool beyond; // reaches out of the grids, whose outer cells hold what is there as well
};

// Those that its box touches, so far as a sample beyond the box may meet the triangle.
cell_box cells_of(vec2 a, vec2 b, vec2 c) {
    precise float slack = meeting_slack(bundle);
    precise vec2 low = min(a, min(b, c)) - slack;
    precise vec2 high = max(a, max(b, c)) + slack;
    cell_box box;
    box.low = ivec2(grid_cell(low.x), grid_cell(low.y));
    box.high = ivec2(grid_cell(high.x), grid_cell(high.y));
    box.beyond = !(min(low.x, low.y) > -bundle.centre.w && max(high.x, high.y) < bundle.centre.w);
    box.level = 0u;
    while (any(greaterThan((box.high >> box.level) - (box.low >> box.level), ivec2(4)))) {
        box.level += 1u;
    }
    return box;
}

// Whether a sample in the cell (x, y) of the box's grid may have edge functions of one sign, as
// meet_triangle computes them: nowhere in the cell are they zero or above, nor zero or below, all
// three. Rounding makes edge functions wrong by few 2^-24 of the products in them, which are as large
// as the triangle and a cell; cells begin and end within few 2^-24 of the grid.
bool may_meet(cell_box box, ivec2 cell, vec2 a, vec2 b, vec2 c) {
    float width = float(1u << box.level) / scale;
    vec2 middle = (vec2(cell) + 0.5) * width - bundle.centre.w;
    float half_width = 0.5 * width + 2.0 * meeting_slack(bundle);
    vec2 p = a - middle;
    vec2 q = b - middle;
    vec2 r = c - middle;
    vec2 far = max(abs(p), max(abs(q), abs(r))) + half_width;
    float wrong = 2e-6 * (far.x * far.y);
    vec3 edges = vec3(q.x * r.y - q.y * r.x, r.x * p.y - r.y * p.x, p.x * q.y - p.y * q.x);
    vec2 pq = abs(q - p);
    vec2 qr = abs(r - q);
    vec2 rp = abs(p - r);
    vec3 rises = half_width * vec3(qr.x + qr.y, rp.x + rp.y, pq.x + pq.y) + wrong;
    return box.beyond || all(greaterThanEqual(edges + rises, vec3(0.0))) ||
           all(lessThanEqual(edges - rises, vec3(0.0)));
}
