// Ours before headers full of macros: ours leaves nothing behind that they trip over.
#include <skybark/vulkan/headless.hpp>

#include "opengl.hpp"
#include "windows.hpp"

bool with_windows_after() {
    const Bool both = True;
    const VkXlibSurfaceCreateInfoKHR surface{};
    return both && surface.window == None && GL_TRIANGLES == skybark::opengl::gl::triangles &&
           opengl_says_what_is_missing() && !skybark::vulkan::device::create({});
}
