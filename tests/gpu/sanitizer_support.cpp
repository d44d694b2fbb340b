// Linked into the gpu tests of sanitizer builds (cmake/GlintModule.cmake).
//
// Mesa 22.3.6 leaves some 128 bytes behind for each instance. LeakSanitizer can leave out leaks by the
// library they come from, but the Vulkan loader unloads the driver with the instance, so at exit nobody knows
// which library that was: keep it.
#include <cstddef>

extern "C" {

int dlclose(void* /*handle*/) noexcept {
    return 0;
}

const char* __lsan_default_suppressions() {
    return "leak:libvulkan_lvp.so\nleak:libLLVM\n";
}

}  // extern "C"
