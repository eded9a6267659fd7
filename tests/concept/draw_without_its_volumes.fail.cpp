// expect: draws[\s\S]*names_volumes
#include <skybark/conformance/null_backend.hpp>
#include <skybark/kernels/probe_volume_draw.hpp>

// A draw of a kernel with volumes has to be given them: that is another concept.
template <class B>
requires skybark::draws<B, skybark::kernels::probe_volume_draw>
void show(B&) {}

void use(skybark::conformance::null_device& device) { show(device); }
