// Ours before glad.
#include "opengl.hpp"

#include "glad.h"

bool with_glad_after() {
    return glGetString == nullptr && skybark::opengl::gl::always == GL_ALWAYS &&
           opengl_says_what_is_missing();
}
