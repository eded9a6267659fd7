#include <meadow/make_meadow.hpp>
#include <skybark/opengl/opengl.hpp>

template class skybark::meadow::meadow<skybark::opengl::device>;
