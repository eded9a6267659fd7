// Clouds that drift through a square and come in again on the other side.

// How far to move what has its middle at `middle` (all along one axis): by `offset`, less as many
// sides as bring the middle to within half a side of `centre`. `over` is 1 / side.
float drift_shift(float middle, float offset, float centre, float side, float over) {
    precise float from = middle + offset - centre;
    precise float turns = floor(from * over + 0.5f);
    precise float shift = offset - turns * side;
    return shift;
}

// What is left of a cloud whose middle lies (x, z) from the centre: all of it up to a distance,
// nothing beyond another. `outer2` is the square of the latter, `over` 1 / the difference of the
// squares.
float drift_weight(float x, float z, float outer2, float over) {
    precise float distance2 = x * x + z * z;
    precise float part = clamp((outer2 - distance2) * over, 0.0f, 1.0f);
    precise float weight = part * part * (3.0f - 2.0f * part);
    return weight;
}
