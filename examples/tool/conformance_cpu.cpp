#include "conformance_backends.hpp"
#include "open_cpu.hpp"

#include <skybark/conformance/suite.hpp>

namespace skybark::tool {

result<void> register_cpu(const common_options& options) {
    if (auto device = open_cpu(options); !device) {
        return failure(device.error());
    }
    conformance::register_suite<cpu::device>("cpu", []() -> result<std::unique_ptr<cpu::device>> {
        return std::make_unique<cpu::device>();
    });
    return {};
}

} // namespace skybark::tool
