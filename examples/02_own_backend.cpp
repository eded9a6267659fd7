// Proves a backend of one's own: registers the conformance suite for it and runs all cases.

#include "02_own_backend.hpp"

#include <skybark/conformance/suite.hpp>

int main() {
    skybark::conformance::register_suite<own::device>(
        "own", [] { return skybark::result<std::unique_ptr<own::device>>(new own::device); });
    return skybark::conformance::run({.filter = "", .json = "", .backends = {}, .quiet = true});
}
