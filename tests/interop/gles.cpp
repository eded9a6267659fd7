// OpenGL ES's header before ours.
#include <GLES3/gl32.h>

#include "opengl.hpp"

bool with_gles() {
    return skybark::opengl::gl::triangles == GL_TRIANGLES && opengl_says_what_is_missing();
}
