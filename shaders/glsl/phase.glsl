// Phase functions of clouds, 1/sr, for a shader of your own: isotropic, Henyey and Greenstein's,
// Draine's, and by skybark::clouds::phase_function::mie(diameter).parameters() that of droplets.
#include "../shared/phase.glsl"
