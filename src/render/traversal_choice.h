// Which kernels find hits: one lane a ray, or packets of coherent rays; and which tree they walk.
#pragma once

#include <cstdint>
#include <string>

#include "bvh/wide_tree.h"
#include "core/enum_names.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "trace/methods.h"

namespace glint::render {

// Rays of a lane in packet_intersect.comp (GLINT_PACKET_RAYS there).
inline constexpr uint32_t kPacketRays = 4;
// Packets that a subgroup traces one after the other, of shadow and other any-hit rays (packet.glsl).
inline constexpr uint32_t kPacketTurns = 8;

// The walk of any-hit packets keeps a node's number in the upper 23 bits of a word (kLevelFirstShift in
// packet_any.glsl). Wide nodes are no more than the binary ones: room for 16 million triangles at least.
inline constexpr size_t kMostPacketNodes = size_t{1} << 23;

// Below, the packets' kernels take longer to compile than they save: 9 samples of scenes/spheres.json, whose
// tree is one leaf of three, take 0.78 s of processor time by lanes and 0.96 s by packets, a Cornell box of
// 36 triangles traces 2.6 times as fast.
inline constexpr size_t kFewestForPackets = 32;

// A word of the stack keeps a node's number in its upper 24 bits (shaders/wide_nodes.glsl); wide nodes are no
// more than the binary ones.
inline constexpr size_t kMostFourNodes = size_t{1} << 24;

// From where on rays that walk by themselves on llvmpipe take nodes of four children. With fewer nodes than
// that they gain nothing; with fewer rays, of the scene or for each of its primitives, making the tree and
// translating longer kernels takes what they gain (docs/lab/nodes.md). Of a picture rays are told from the
// eye and from there to lights, and others follow; its kernels are made once, where those of the library's
// rays come on top of others that are there (docs/lab/library.md).
inline constexpr size_t kFewestForFour = 2000;
inline constexpr uint64_t kFewestOfPictureForFour = 650'000;
inline constexpr uint64_t kPictureRaysOfPrimitiveForFour = 64;
inline constexpr uint64_t kFewestRaysForFour = 4'000'000;
inline constexpr uint64_t kRaysOfPrimitiveForFour = 4;
// A ray that counts crossings gains as much by them as so many others (docs/lab/library.md).
inline constexpr uint64_t kWorthOfCountForFour = 4;

// Whether on llvmpipe a tree of four children a node, which takes some 80 ns a primitive to make, pays for
// the library's rays that walk by themselves: as many in all as its kernels, and as the tree, will serve.
bool fourPays(const PackedScene& scene, uint64_t raysOfKernels, uint64_t raysOfTree);

// Whether rays that count let leaves wait, as kLeavesWait in shaders/crossings.glsl has it.
bool leavesWait(const SceneFeatures& features);

enum class Traversal {
    Auto,    // by the device and the scene
    Lane,    // each lane walks the binary tree with a ray of its own
    Packet,  // the lanes of a subgroup walk an 8-wide tree together, for camera rays and their shadow rays
    Bvh4,    // each lane walks a tree of four children a node
    Cwbvh    // or one of compressed nodes of eight
};
constexpr auto entriesOf(Traversal) {
    return std::to_array<EnumEntry<Traversal>>({{Traversal::Auto, "auto"},
                                                {Traversal::Lane, "lane"},
                                                {Traversal::Packet, "packet"},
                                                {Traversal::Bvh4, "bvh4"},
                                                {Traversal::Cwbvh, "cwbvh"}});
}

// Where the stack of a ray that walks by itself is: in memory of the lane's own, or in that which its
// workgroup shares. The values are kStack... of shared/dispatch.h.
enum class StackPlace : uint32_t { Private, Shared };
constexpr auto entriesOf(StackPlace) {
    return std::to_array<EnumEntry<StackPlace>>(
        {{StackPlace::Private, "private"}, {StackPlace::Shared, "shared"}});
}
static_assert(static_cast<uint32_t>(StackPlace::Shared) == shared::kStackShared);

struct TraversalChoice {
    bool packets = false;
    std::string reason;  // one phrase
    NodeFormat nodes =
        NodeFormat::Two;  // of rays that walk by themselves, further bounces beside packets too
};

// What was chosen, never Auto: its name.
std::string_view nameOf(const TraversalChoice& choice);

// Subgroups of 8 lanes that can shuffle.
bool runsPackets(const gpu::DeviceInfo& device);

// Whether rays that walk by themselves leave the loops of their walk together (kConvergent in
// shaders/lanes.glsl). They need lanes as packets do, and in a stack room for what a lane that is through
// stores above it; on llvmpipe it pays (docs/lab/nodes.md), elsewhere it is unmeasured. The walk of
// compressed nodes has no such loops.
bool walksConverge(const gpu::DeviceInfo& device, NodeFormat nodes, StackPlace stack);

// What `wanted` comes to. Packets need subgroups of 8 lanes that can shuffle, and a scene of triangles,
// spheres and planes; they pay where loads cost a fixed price for all lanes, which is so on llvmpipe alone,
// and from kFewestForPackets triangles and spheres on. On a GPU (discrete, integrated or virtual) rays walk
// compressed nodes where the scene has kFewestForWide primitives in its tree: by counts, not by measurement
// (docs/lab/nodes.md). Wide nodes know every scene with a tree, but not SlabPad, whose
// leaks boxes that are rounded outwards would stop. Anything else is traced by lanes in the binary tree, or,
// on llvmpipe for many rays, in one of four children a node. `rays`: all that the pictures to come will send
// from their cameras and from there to lights, 0 if that is not known. Throws Error(Device) if packets are
// asked for where the device cannot run them; a scene that the traversal
// asked for cannot take, or methods that it does not know, are traced by lanes.
TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                const Methods& methods = {}, uint64_t rays = 0);

// With so few primitives the binary tree has a handful of nodes, all in the cache.
inline constexpr size_t kFewestForWide = 32;

}  // namespace glint::render
