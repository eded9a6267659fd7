#include "screen_vulkan.hpp"
#include "viewer.hpp"

namespace skybark::viewer {

result<void> view_vulkan(const options& asked) { return view_meadow<screen_vulkan>(asked); }

} // namespace skybark::viewer
