// Sets of boxes to build trees over, and what must hold of every tree.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bvh/bvh.h"

namespace glint::test {

struct BoxSet {
    std::string name;
    std::vector<Box> boxes;
};

bool inside(const Box& inner, const Box& outer);
Box boxAround(const glm::vec3& center, float halfEdge);
// Small boxes with centres and sizes drawn uniformly; the same for the same seed.
std::vector<Box> randomBoxes(size_t count, unsigned seed);
// Random, identical, exponentially spaced, sorted, duplicated, nested, flat, huge and the smallest sets.
std::vector<BoxSet> hardSets();

// Levels that halving `count` boxes takes until no part exceeds `leaf`.
uint32_t halvings(size_t count, uint32_t leaf);

// Reports a failure unless: `order` is a permutation; each box is in exactly one leaf, and inside its leaf's
// box; each child's box is inside its parent's; leaves are at most options.maxLeafSize, of one group,
// ascending by index; no node is deeper than options.maxLevels, and Bvh::depth is the depth of the deepest.
void expectValid(const Bvh& bvh, const std::vector<Box>& boxes, const BvhOptions& options);

}  // namespace glint::test
