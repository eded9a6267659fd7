#pragma once
// The suite for each backend, for `skybark conformance`.

#include "options.hpp"

namespace skybark::tool {

// Registers a backend's cases, once the device has been opened to see that it is there. One a
// backend, each in its own file: they are the largest of all to compile.
[[nodiscard]] result<void> register_cpu(const common_options& options);
[[nodiscard]] result<void> register_opengl(const common_options& options);
[[nodiscard]] result<void> register_vulkan(const common_options& options);

} // namespace skybark::tool
