// Linked into the program and all tests of sanitizer builds (cmake/GlintModule.cmake).
// The Vulkan loader unloads the driver and the validation layer with the instance. Memory that their globals
// point to then looks leaked (Mesa 22.3.6: 128 bytes), and its library can no longer be identified. So they
// stay loaded. The layer, 1.3.239, does leak its records of submitted work. Vulkan objects that glint itself
// leaks are still found, by the layer when the device is destroyed.

// Visible to the loader and the sanitizers, though all else is hidden for libglint's sake.
#pragma GCC visibility push(default)
extern "C" {

int dlclose(void* /*handle*/) noexcept {
    return 0;
}

const char* __lsan_default_suppressions() {
    return "leak:libVkLayer_khronos_validation.so\n";
}

// ThreadSanitizer (GLINT_SANITIZE=thread) observes the data that these libraries exchange between their
// threads, but not their atomics, as they are not compiled for it: Mesa's lavapipe, and LLVM, whose code it
// runs. Their calls of memcpy and the like are ignored, in glint's mapped buffers too. LLVM registers that
// code with libgcc, which is not compiled for it either.
const char* __tsan_default_suppressions() {
    return "called_from_lib:libvulkan_lvp.so\n"
           "called_from_lib:libLLVM-\n"
           "race:libvulkan_lvp.so\n"
           "race:libLLVM-\n"
           "mutex:libvulkan_lvp.so\n"
           "thread:libvulkan_lvp.so\n"
           "mutex:__register_frame_info\n"
           "mutex:__deregister_frame_info\n";
}

}  // extern "C"
#pragma GCC visibility pop
