// Selects the kernels that find hits: one ray per lane, or packets of coherent rays.
#pragma once

#include <cstdint>
#include <string>

#include "core/enum_names.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "trace/methods.h"

namespace glint::render {

// The any-hit packet traversal keeps a node's number in the upper 23 bits of a word (kLevelFirstShift in
// packet/any.glsl). A wide tree has at most as many nodes as the binary one.
inline constexpr size_t kMostPacketNodes = size_t{1} << 23;

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

}  // namespace glint::render
