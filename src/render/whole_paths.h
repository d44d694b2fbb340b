// Pictures that one kernel draws, whole.comp: each path from its camera ray to its end.
#pragma once

#include <cstdint>

#include "core/enum_names.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/pipelines.h"
#include "render/traversal_choice.h"

namespace glint::render {

enum class WholePaths {
    Auto,  // where it pays, see wholePathsPay
    On,    // wherever the kernel knows how
    Off    // a kernel for each step of all paths
};
constexpr auto entriesOf(WholePaths) {
    return std::to_array<EnumEntry<WholePaths>>(
        {{WholePaths::Auto, "auto"}, {WholePaths::On, "on"}, {WholePaths::Off, "off"}});
}

// Tiles of the first slice, whose one submission traces all rays of its paths.
uint32_t firstWholeTiles(uint64_t mostRays);

// False if the request needs more than the image, or a textbook's intersection tests.
bool wholePathsKnow(const TraceModes& modes);

// Work of a render by whole paths.
struct WholePathsWork {
    bool furtherRays = false;  // there are mirrored or refracted ones
    uint32_t tripBudget = 0;   // of each ray of a path
    uint64_t rays = 0;         // from the eye and from there to lights, in all pictures; 0: unknown
};

// On llvmpipe, where the rows that the other kernels hand each other cost as much as tracing a few
// primitives. Where packets trace all the rays there are they win, but by three kernels more, whose
// translation only many rays pay (docs/lab/speed.md has the figures). Not where so many rays may
// come that few trips are left for each. Not measured on other devices.
bool wholePathsPay(const gpu::DeviceInfo& device, const TraversalChoice& choice, const WholePathsWork& work);

}  // namespace glint::render
