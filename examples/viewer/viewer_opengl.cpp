#include "screen_opengl.hpp"
#include "viewer.hpp"

namespace skybark::viewer {

result<void> view_opengl(const options& asked) { return view_meadow<screen_opengl>(asked); }

} // namespace skybark::viewer
