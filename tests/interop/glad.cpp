// glad before ours.
#include "glad.h"

#include "opengl.hpp"

PFNGLGENBUFFERSPROC glad_glGenBuffers = nullptr;
PFNGLGETSTRINGPROC glad_glGetString = nullptr;
PFNGLVIEWPORTPROC glad_glViewport = nullptr;

bool with_glad() {
    return glGenBuffers == nullptr && glViewport == nullptr &&
           skybark::opengl::gl::triangles == GL_TRIANGLES && opengl_says_what_is_missing();
}
