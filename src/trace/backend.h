// Who traces.
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

}  // namespace glint
