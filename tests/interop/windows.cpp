// Headers full of macros before ours: all of ours, so that none has such a name.
#include "windows.hpp"

#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/skybark.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

bool with_windows() {
    skybark::cpu::device device;
    return None == 0 && Success == 0 && GL_TRIANGLES == skybark::opengl::gl::triangles &&
           device.create_buffer(16) && !skybark::opengl::device::create({}) &&
           !skybark::vulkan::device::create({});
}
