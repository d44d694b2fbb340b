// Calls of the Vulkan loader, which holds a lock while a driver answers. A driver in C++ that runs out of the
// processor's memory (lavapipe, in LLVM) throws its std::bad_alloc through the loader, and the lock stays
// held: whoever calls next, be it vkDestroyInstance, waits for ever. So after such an exception the process
// makes no more of these calls; what is open then stays open until it ends.
#pragma once

#include <volk.h>

#include <exception>

namespace glint::gpu {

bool loaderLost();
// Throws Error(Device) if the loader is lost.
void requireLoader(const char* call);
// The loader is lost from now on; throws Error(Device).
[[noreturn]] void loseLoader(const char* call);

template <typename Function, typename... Arguments>
VkResult loaderCall(const char* name, Function function, Arguments... arguments) {
    requireLoader(name);
    try {
        return function(arguments...);
    } catch (const std::exception&) {
        loseLoader(name);
    }
}

}  // namespace glint::gpu
