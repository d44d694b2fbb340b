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

// Triangles, spheres and boxes from which packet kernels save more time than their compilation costs: 9
// samples of scenes/spheres.json, whose BVH is one leaf of three, take 0.78 s of processor time by lanes and
// 0.96 s by packets; a Cornell box of 36 triangles is 2.6 times as fast by packets (lavapipe, Mesa 22.3.6).
inline constexpr size_t kMinForPackets = 32;

enum class Traversal {
    Auto,   // by the device and the scene
    Lane,   // each lane traverses the binary BVH with its own ray
    Packet  // a subgroup traverses an 8-wide BVH together, for camera rays and their shadow rays
};
constexpr auto entriesOf(Traversal) {
    return std::to_array<EnumEntry<Traversal>>(
        {{Traversal::Auto, "auto"}, {Traversal::Lane, "lane"}, {Traversal::Packet, "packet"}});
}

struct TraversalChoice {
    bool packets = false;  // for camera rays and their shadow rays; other rays have a lane each
    std::string reason;    // one phrase
};

// Primitives in the leaves that packets test. Those that count crossings test triangles alone.
size_t primitivesOfPackets(const PackedScene& scene);

// The chosen traversal's name, never "auto".
std::string_view nameOf(const TraversalChoice& choice);

// True if subgroups have 8 lanes that can shuffle.
bool runsPackets(const gpu::DeviceInfo& device);

// True if all lanes of a subgroup leave the loops of a traversal together (kConvergent in
// shaders/traversal/lanes.glsl), on llvmpipe with the lanes that packets need (docs/lab/nodes.md). Unmeasured
// on other devices.
bool loopsConverge(const gpu::DeviceInfo& device);

// Packets need subgroups of 8 lanes that can shuffle, and a scene of triangles, spheres, boxes and planes.
// They are faster if a load costs the same for one lane as for all (llvmpipe alone), from kMinForPackets
// primitives on. Throws Error(Device) if packets are wanted and the device cannot run them. If packets do not
// support the scene or methods, the choice is Lane.
TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                const Methods& methods = {});

// ---- whole paths ----

enum class WholePaths {
    Auto,  // if faster, see wholePathsPay
    On,    // if the kernel supports the request
    Off    // a kernel for each step of all paths
};
constexpr auto entriesOf(WholePaths) {
    return std::to_array<EnumEntry<WholePaths>>(
        {{WholePaths::Auto, "auto"}, {WholePaths::On, "on"}, {WholePaths::Off, "off"}});
}

// False if the request needs more than the image, or a textbook's intersection tests.
bool wholePathsSupport(const TraceModes& modes);

// Work of a render by whole paths.
struct WholePathsWork {
    bool furtherRays = false;  // reflected or refracted
    uint32_t tripBudget = 0;   // of all rays of a path
    uint64_t rays = 0;         // camera rays and their shadow rays in all images; 0: unknown
};

// True on llvmpipe, where the rows that the other kernels exchange cost as much as tracing a few primitives.
// Packets that trace all rays are faster, but need three more kernels, whose translation only many rays repay
// (docs/lab/speed.md). False if a path has few trips. Unmeasured on other devices.
bool wholePathsPay(const gpu::DeviceInfo& device, const TraversalChoice& choice, const WholePathsWork& work);

// ---- kernels ----

// The kernels of the steps that render a sample of the request. packets: for camera rays.
std::vector<KernelId> kernelsOfSteps(const PackedScene& scene, const Request& request, bool packets);

}  // namespace glint::render
