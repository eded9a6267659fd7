// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 fd9744b6856835b1f64eb44e2fc973ea5b66d316a70e7f353ab4e6904ec866ca
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Light that has been scattered more than once, as it spreads from cell to cell of a grid.
//
// The unknown is the diffuse fluence phi = ∫ L dω over the sun's irradiance. Its flux is
// F = -grad(phi) / w + (the first moment of what leaves the sun's beam), w a resistance in 1/m:
// three times the transport extinction where there is matter, and more where light streams instead
// of diffusing. What a cell gets and what it loses, of its own phi:

// gain - loss · phi = 0 in each cell; both a cubic metre.
struct scatter_balance {
    float gain;
    float loss;
};

// With a neighbour of resistance `beyond` and fluence `phi` at a distance of one side.
inline scatter_balance scatter_across(scatter_balance sum, float phi, float here, float beyond,
                               float side) {
    float passes = 2.0f / ((here + beyond) * side * side);
    scatter_balance now = sum;
    now.gain = sum.gain + passes * phi;
    now.loss = sum.loss + passes;
    return now;
}

// The flux that leaves through the border of the grid, of the fluence in the cell there: no light
// comes in (Marshak's condition, F = phi / 2), half a side of empty space away.
inline float scatter_escape(float empty, float side) { return 1.0f / (2.0f + 0.5f * empty * side); }

// One step of a weighted Jacobi relaxation.
inline float scatter_relaxed(scatter_balance sum, float phi, float weight) {
    return (1.0f - weight) * phi + weight * (sum.gain / sum.loss);
}

// The resistance of a cell. `across` is what the fluence loses a metre at right angles to the
// sun's light, in parts of itself: where that is much, light streams away sideways, and its flux
// can't be more than its fluence (Levermore and Pomraning 1981). A layer loses nothing sideways,
// and there the diffusion is right as it is.
inline float scatter_resistance(float transport, float empty, float spreading, float across) {
    return 3.0f * transport + empty + spreading * across;
}

// The first moment of what a beam leaves behind as it goes down through a face: `moment` times
// the scattering extinction there, over the resistance.
inline float scatter_moment(float moment, float beam, float here, float beyond, float w_here,
                     float w_beyond) {
    return moment * beam * (here + beyond) / (w_here + w_beyond);
}

} // namespace skybark::shared
