// Selects the backend.
#pragma once

#include "core/enum_names.h"

namespace glint {

enum class Backend {
    Gpu,  // the shaders, on a Vulkan device
    Cpu   // the reference in double precision, on the host
};
constexpr auto entriesOf(Backend) {
    return std::to_array<EnumEntry<Backend>>({{Backend::Gpu, "gpu"}, {Backend::Cpu, "cpu"}});
}

// Backend that continues after a device failure.
enum class Fallback { None, Cpu };
constexpr auto entriesOf(Fallback) {
    return std::to_array<EnumEntry<Fallback>>(
        {{Fallback::None, "none", "the device's failure is the command's"},
         {Fallback::Cpu, "cpu", "the reference draws on, with a warning"}});
}

}  // namespace glint
