// expect: is_trivially_copyable_v<(T|std::basic_string<char>)
#include <skybark/core/backend.hpp>

#include <skybark/conformance/null_backend.hpp>

#include <string>

void call(skybark::conformance::null_device& device, std::span<const std::string> names) {
    (void)skybark::make_buffer(device, names);
}
