#version 450
#define SKYBARK_FRAGMENT_STAGE
#include KERNEL

void main() {
    // gl_FragCoord counts rows from the top: OpenGL is set to an upper-left origin by clip control
    // for positions, and its row y of the image is stored as row y.
    if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
        discard;
    }
}
