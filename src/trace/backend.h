// Who traces.
#pragma once

namespace glint {

enum class Backend {
    Gpu,  // the shaders, on a Vulkan device
    Cpu   // the reference in double precision, on the host
};

}  // namespace glint
