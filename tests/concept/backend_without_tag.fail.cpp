// expect: untagged::backend_tag.*skybark::backend_tag
#include <skybark/conformance/null_backend.hpp>

struct untagged : skybark::conformance::null_device {
    struct backend_tag {}; // a coincidence of syntax is no promise
};

static_assert(skybark::backend<untagged>);
