#pragma once
// Where the OpenGL backend finds a kernel's GLSL.

#include <string_view>

namespace skybark::opengl {

/// Specialised for each kernel, with a member for each skeleton that it goes with: `map_comp`,
/// `levels_comp`, `strips_geom`, `rings_geom`, `draw_vert`, `draw_frag`, `peel_vert`.
/// shaders/embed.py makes it.
template <class Kernel>
struct program;

} // namespace skybark::opengl
