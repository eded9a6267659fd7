// expect: too many initializers|excess elements|no matching
#include <skybark/conformance/null_backend.hpp>
#include <skybark/kernels/probe_level.hpp>

using skybark::conformance::null_device;

void record(null_device::recorder& r, const skybark::buffer_view<null_device>& v) {
    const skybark::bindings<null_device, skybark::kernels::probe_level> four{v, v, v, v};
    r.map(skybark::kernels::probe_level{}, four, skybark::range{0, 1});
}
