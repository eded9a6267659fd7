// Each of the other files sees other people's headers and ours; what they say is said here.
#include <cstdio>

bool with_glad();
bool with_glad_after();
bool with_volk();
#if defined(HAVE_WINDOWS)
bool with_windows();
bool with_windows_after();
#endif
#if defined(HAVE_EPOXY)
bool with_epoxy();
#endif
#if defined(HAVE_GLES)
bool with_gles();
#endif

int main() {
    int failed = 0;
    const auto report = [&](const char* name, bool passed) {
        std::printf("%s: %s\n", name, passed ? "both work" : "one of them does not work");
        failed += passed ? 0 : 1;
    };
    report("glad before", with_glad());
    report("glad after", with_glad_after());
    report("volk, VK_NO_PROTOTYPES", with_volk());
#if defined(HAVE_WINDOWS)
    report("macros of window systems, GL/gl.h, GL/glext.h, vulkan.h with platforms, before",
           with_windows());
    report("the same, after", with_windows_after());
#endif
#if defined(HAVE_EPOXY)
    report("epoxy", with_epoxy());
#endif
#if defined(HAVE_GLES)
    report("GLES3/gl32.h", with_gles());
#endif
    return failed == 0 ? 0 : 1;
}
