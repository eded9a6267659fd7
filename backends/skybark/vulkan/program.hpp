#pragma once
// Where the Vulkan backend finds a kernel's SPIR-V.

#include <cstdint>

namespace skybark::vulkan {

/// Specialised for each kernel, with a member for each skeleton that it goes with: `map_comp`,
/// `levels_comp`, `strip_counts_comp`, `strips_comp`, `rings_comp`, `voxels_comp`,
/// `accumulate_comp`, `draw_vert`, `draw_frag`. shaders/embed.py makes it.
template <class Kernel>
struct program;

} // namespace skybark::vulkan
