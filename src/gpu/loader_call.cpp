#include "gpu/loader_call.h"

#include <atomic>
#include <string>

#include "core/error.h"

namespace glint::gpu {
namespace {

std::atomic<bool> theLoaderIsLost{false};

}  // namespace

bool loaderLost() {
    return theLoaderIsLost;
}

void requireLoader(const char* call) {
    if (!loaderLost()) return;
    throw Error(ErrorKind::Device, std::string(call) +
                                       " cannot be called: a driver ran out of the processor's memory, "
                                       "which the Vulkan loader does not survive; start a new process");
}

void loseLoader(const char* call) {
    theLoaderIsLost = true;
    throw Error(ErrorKind::Device,
                std::string(call) + " failed: the driver ran out of the processor's memory; try again");
}

}  // namespace glint::gpu
