// Trees with more than two children a node, for rays that walk by themselves (shaders/wide_nodes.glsl).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/dispatch.h"

namespace glint {

// What rays that walk by themselves walk; the values are kNodes... of shared/dispatch.h. Two: the binary
// tree, 64 bytes a node. Four: as many. Compressed: up to eight children in 80 bytes (H. Ylitie, T. Karras,
// S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, sec. 3).
enum class NodeFormat : uint32_t { Two, Four, Compressed };
static_assert(static_cast<uint32_t>(NodeFormat::Four) == shared::kNodesFour &&
              static_cast<uint32_t>(NodeFormat::Compressed) == shared::kNodesCompressed);

// Nodes are kFourRows or kCompressedRows rows each, from row 0 on.
//
// Four: what is known of a node lies in one line of the cache. A plane is 256 steps and a byte's number of
// steps from the origin of the node's grid, and 2^-15 of a step or more outside of the child's box. For
// coordinates up to 2^125: scenes' go up to 1e18 (scene/limits.h).
//   origin of the grid; 256 steps along x, y, z, as the exponents of floats in bytes 0 to 2; bit 31: there is
//     only one child
//   bytes by children: lower planes along x, upper ones; along y
//   along z; ~0 if there is no third child; the first inner child, bits from kFourInnerShift on: which are
//     inner, bit 31: there is no fourth
//   the children, as in shared::Node, but inner ones counted in wide nodes, which come first and follow each
//     other; kNone for absent ones, which come last
//
// Compressed: children are in eight slots, each near the corner of the node that its number's bits say (1: x
// above, 2: y, 4: z), so that slot ^ octant puts them in about the order that a ray meets them.
//   origin of the grid; bits 0 to 23: its steps along x, y, z, as the exponents of floats; 24 to 31: the
//     slots with inner nodes
//   first inner node, the others follow; place of the first leaf's word, in words, the others follow; the
//     slots with leaves; 0
//   for each axis a row of bytes, by slots: lower planes, upper ones, in steps from the origin
// Leaves' words, as in shared::Node, stand in rows after all nodes. A plane as the shader decodes it, origin
// + step * byte, rounded to nearest, is never inside of the child's box.
struct WideTree {
    std::vector<shared::WideRow> rows;
    std::vector<uint32_t> roots;  // for each of the instances, the wide node that its tree starts at
};

// The tree from nodes[0] and those from the instances' roots, leaves and their boxes as they are. Of all
// choices of inner nodes it is the one that a random ray is expected to visit fewest of (bvh/collapse.h).
// Without nodes, and for NodeFormat::Two, empty.
WideTree wideTree(const std::vector<shared::Node>& nodes, NodeFormat format,
                  std::span<const shared::Instance> instances = {});

}  // namespace glint
