// epoxy before ours. Its functions are macros for pointers that find themselves.
#include <epoxy/gl.h>

#include "opengl.hpp"

bool with_epoxy() {
    return glGenBuffers != nullptr && skybark::opengl::gl::triangles == GL_TRIANGLES &&
           opengl_says_what_is_missing();
}
