// The suite on our three backends.

#include "backends.hpp"

namespace {

using namespace skybark;

[[maybe_unused]] const bool registered = [] {
    conformance::register_suite<cpu::device>("cpu", [] { return conformance::make_cpu({}); });
    conformance::register_suite<opengl::device>("opengl", [] {
        return conformance::make_headless<opengl::headless>(opengl::headless_options{});
    });
    conformance::register_suite<vulkan::device>("vulkan", [] {
        return conformance::make_headless<vulkan::headless>(vulkan::headless_options{});
    });
    return true;
}();

} // namespace
