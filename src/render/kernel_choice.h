// Selects the kernels of an image: the traversal that finds hits (one ray per lane, or packets of coherent
// rays), and one kernel for whole paths or a kernel for each step.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/kernels.h"
#include "trace/methods.h"
#include "trace/request.h"

namespace glint::render {

// ---- traversals ----

// Triangles, spheres and boxes below which packet kernels take longer to compile than they save: 9 samples of
// scenes/spheres.json, whose tree is one leaf of three, take 0.78 s of processor time by lanes and 0.96 s by
// packets; a Cornell box of 36 triangles is 2.6 times as fast by packets (lavapipe, Mesa 22.3.6).
inline constexpr size_t kFewestForPackets = 32;

enum class Traversal {
    Auto,   // by the device and the scene
    Lane,   // each lane traverses the binary tree with a ray of its own
    Packet  // the lanes of a subgroup traverse an 8-wide tree together, for camera rays and their shadow rays
};
constexpr auto entriesOf(Traversal) {
    return std::to_array<EnumEntry<Traversal>>(
        {{Traversal::Auto, "auto"}, {Traversal::Lane, "lane"}, {Traversal::Packet, "packet"}});
}

struct TraversalChoice {
    bool packets = false;  // of camera rays and their shadow rays; all other rays go one per lane
    std::string reason;    // one phrase
};

// The name of the traversal that was chosen, never "auto".
std::string_view nameOf(const TraversalChoice& choice);

// True if subgroups have 8 lanes that can shuffle.
bool runsPackets(const gpu::DeviceInfo& device);

// True if all lanes of a subgroup leave the loops of a traversal together (kConvergent in
// shaders/traversal/lanes.glsl). Needs lanes as packets do. It pays on llvmpipe (docs/lab/nodes.md) and is
// unmeasured elsewhere.
bool loopsConverge(const gpu::DeviceInfo& device);

// Packets need subgroups of 8 lanes that can shuffle, and a scene of triangles, spheres, boxes and planes.
// They pay where a load costs the same for one lane as for all, which is so on llvmpipe alone, and from
// kFewestForPackets primitives on. All other rays are traced one per lane. Throws Error(Device) if packets
// are wanted and the device cannot run them; if they are wanted for a scene or methods that they do not
// support, the choice is Lane.
TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                const Methods& methods = {});

// ---- whole paths ----

enum class WholePaths {
    Auto,  // where it pays, see wholePathsPay
    On,    // wherever the kernel knows how
    Off    // a kernel for each step of all paths
};
constexpr auto entriesOf(WholePaths) {
    return std::to_array<EnumEntry<WholePaths>>(
        {{WholePaths::Auto, "auto"}, {WholePaths::On, "on"}, {WholePaths::Off, "off"}});
}

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

// ---- kernels ----

// The kernels of the steps that render a sample of the request, with packets for camera rays or without.
std::vector<KernelId> kernelsOfSteps(const PackedScene& scene, const Request& request, bool packets);

}  // namespace glint::render
