#pragma once

#include <cstdint>
#include <vector>

#include "core/context.h"
#include "core/device_layout.h"

namespace glint {

// The same tree with up to 8 children a node, for shaders/packet/packet.glsl: dynamic programming chooses the
// inner nodes of the binary tree that stay, for the least sum of areas (Ylitie, Karras, Laine, "Efficient
// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, sec. 3.1). Node n is the corners
// 16 n to 16 n + 15: the lower corners of its children, each with the child as in shared::Node but inner ones
// counted in wide nodes, then the upper ones. Inner children come first, and their numbers follow each other.
// An absent child is kNone with an empty box. Empty for an empty tree.
// slots: receives for each child of each node, 8 a node, the slot of the binary tree that has it, 2 * node +
// side, kNone for an absent one; may be null.
std::vector<shared::PacketCorner> packetTree(const std::vector<shared::Node>& nodes,
                                             std::vector<uint32_t>* slots = nullptr,
                                             const Context& context = {});

// Takes over the boxes of the binary tree that packetTree was made of, or of one with the same children.
void refitPacketTree(const std::vector<shared::Node>& nodes, const std::vector<uint32_t>& slots,
                     std::vector<shared::PacketCorner>& corners, const Context& context = {});

}  // namespace glint
