// Keeps graphics drivers loaded until the process ends: a leak checker can then tell what they hold
// from what is lost, and we need no list of leaks to overlook.
#include <dlfcn.h>

extern "C" int dlclose(void*) noexcept { return 0; }
