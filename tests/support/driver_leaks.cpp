// What others lose, in builds with a leak checker. Nothing of ours is allocated under their
// functions, and the validation layer itself says, as an error, when we leave an object behind.
//  - OSMesa: the buffer that a context was made current with, some 280 bytes each time, in a C
//    program of four calls as well.
//  - The Vulkan validation layer: some 5 kB of its own for each device.
//  - Mesa 22.3's lavapipe: the names of descriptor sets, when their pool goes.

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libOSMesa.so\nleak:libVkLayer_khronos_validation.so\n"
           "leak:libvulkan_lvp.so\n";
}
