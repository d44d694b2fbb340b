// The walk of a ray that counts what it crosses, in a tree of triangles alone (kLeavesWait). Nothing on its
// way gets nearer, so the order of nodes does not matter, and leaves can wait: a ray collects them as long as
// there is room, and tests them when all rays of the subgroup do. On lavapipe it would else wait for the
// others before each leaf (docs/lab/library.md).
#ifndef GLINT_CROSSINGS_WALK_GLSL
#define GLINT_CROSSINGS_WALK_GLSL

// Leaves wait behind the stack, those of one node as one word: of a binary node as `first | count <<
// kWaitingShift`, since they follow each other, so that it puts down one word at most, that or a child; of a
// node of four as its number and bits of its children, `node << kBitsOfFour | bits`.
const uint kMostLeaves = 16u;
const uint kWaitingShift = 25u;
const uint kBitsOfFour = 4u;
uint waiting[kOwnWords + kMostLeaves];

// A ray's way through the tree. current: the binary node at hand, kNone for none; of nodes of four, as on the
// stack, those that are to be visited next, `first << kBitsOfFour | bits`, as children of one node follow
// each other. The height of the stack. Leaves that wait, and what is left of those of a node of four
// (`group`); of the leaf at hand the triangles that are left.
struct CrossingsWalk {
    uint current, top;
    uint leaves, group;
    uint index, end;
};

const bool kWalksFour = NODE_FORMAT == kNodesFour;
bool hasBits(uint word) { return (word & ((1u << kBitsOfFour) - 1u)) != 0u; }
// The place of the lowest of four bits: two bits for each of their values, as lavapipe looks for it longer.
uint lowestBit(uint word) { return (0x12131210u >> (2u * (word & 15u))) & 3u; }

bool hasNodes(CrossingsWalk walk) { return kWalksFour ? hasBits(walk.current) : isNode(walk.current); }
bool hasTriangles(CrossingsWalk walk) {
    return walk.index < walk.end || walk.leaves > 0u || (kWalksFour && hasBits(walk.group));
}
bool isOver(CrossingsWalk walk) { return !hasNodes(walk) && !hasTriangles(walk); }
bool hasRoom(CrossingsWalk walk) { return walk.leaves < kMostLeaves; }

// Goes on from a node to one of its children, or else to one that waits. The store is made whatever comes of
// it: a place that is not taken is written over.
void passNode(Traversal traversal, float tEnd, inout CrossingsWalk walk) {
    Node node = loadNode(walk.current);
    float near;
    bool hit0 = intersectBox(traversal.ray, traversal.frame, node.lo0, node.hi0, tEnd, near);
    bool hit1 = intersectBox(traversal.ray, traversal.frame, node.lo1, node.hi1, tEnd, near);
    bool inner0 = hit0 && isNode(node.child0);
    bool inner1 = hit1 && isNode(node.child1);
    uint count0 = hit0 && !isNode(node.child0) ? sizeOfLeaf(node.child0) : 0u;
    uint count1 = hit1 && !isNode(node.child1) ? sizeOfLeaf(node.child1) : 0u;
    uint count = count0 + count1;
    uint leaf = (count0 > 0u ? node.child0 : node.child1) & kLeafFirstMask;
    bool both = inner0 && inner1;
    waiting[both ? walk.top : kOwnWords + walk.leaves] = both ? node.child1 : leaf | count << kWaitingShift;
    walk.leaves += count > 0u ? 1u : 0u;
    walk.top += both ? 1u : 0u;
    bool empty = walk.top == 0u;
    uint popped = waiting[empty ? 0u : walk.top - 1u];
    bool pops = !inner0 && !inner1;
    walk.current = inner0 ? node.child0 : (inner1 ? node.child1 : (empty ? kNone : popped));
    walk.top -= pops && !empty ? 1u : 0u;
}

// The same of a node of four.
void passFour(Traversal traversal, float tEnd, inout CrossingsWalk walk) {
    uint node = (walk.current >> kBitsOfFour) + lowestBit(walk.current);
    uint rest = walk.current & (walk.current - 1u);
    FourMet met = meetFour(traversal.ray, traversal.frame, node, tEnd);
    uint entered = enteredOfFour(met);
    uint inner = entered & (met.links >> kFourInnerShift);
    uint leaves = entered ^ inner;
    uint within = (met.links & 0xffffffu) << kBitsOfFour | inner;
    waiting[walk.top] = rest;
    waiting[kOwnWords + walk.leaves] = node << kBitsOfFour | leaves;
    walk.leaves += leaves != 0u ? 1u : 0u;
    bool empty = walk.top == 0u;
    uint popped = waiting[empty ? 0u : walk.top - 1u];
    bool enters = inner != 0u;
    bool stays = hasBits(rest);
    walk.current = enters ? within : (stays ? rest : (empty ? 0u : popped));
    walk.top += enters && stays ? 1u : 0u;
    walk.top -= !enters && !stays && !empty ? 1u : 0u;
}

void passTriangle(inout Traversal traversal, inout CrossingsWalk walk) {
    bool pops = walk.index >= walk.end;
    if (kWalksFour) {
        bool takes = pops && !hasBits(walk.group);
        walk.leaves -= takes ? 1u : 0u;
        uint group = waiting[kOwnWords + walk.leaves];
        group = takes ? group : walk.group;
        uint leaf = childOfFour((group >> kBitsOfFour) << 8 | lowestBit(group));
        uint first = leaf & kLeafFirstMask;
        walk.group = pops ? group & (group - 1u) : group;
        walk.index = pops ? first : walk.index;
        walk.end = pops ? first + sizeOfLeaf(leaf) : walk.end;
    } else {
        walk.leaves -= pops ? 1u : 0u;
        uint leaf = waiting[kOwnWords + walk.leaves];
        uint first = leaf & kLeafFirstMask;
        walk.index = pops ? first : walk.index;
        walk.end = pops ? first + (leaf >> kWaitingShift) : walk.end;
    }
    lookAtTriangle(traversal, walk.index);
    ++walk.index;
}

// From the root. Returns kNone when finished, else 0, the slot to begin again from.
uint traverseAll(inout Traversal traversal, uint root) {
    uint budget = dispatch.tripBudget;
    bool rootIsLeaf = root != kNone && !isNode(root);
    bool rootIsNode = root != kNone && isNode(root);
    uint first = root & kLeafFirstMask;
    CrossingsWalk walk;
    walk.current = kWalksFour ? (rootIsNode ? root << kBitsOfFour | 1u : 0u) : (rootIsNode ? root : kNone);
    walk.top = walk.leaves = walk.group = 0u;
    walk.index = rootIsLeaf ? first : 0u;
    walk.end = rootIsLeaf ? first + sizeOfLeaf(root) : 0u;
    precise float tEnd = traversal.ray.tMax * farPad();
    do {
        do {
            if (!isOver(walk) && traversal.trips < budget && traversal.aside < kMostAside) {
                do {
                    if (hasNodes(walk) && hasRoom(walk) && traversal.trips < budget) {
                        if (kWalksFour) {
                            passFour(traversal, tEnd, walk);
                        } else {
                            passNode(traversal, tEnd, walk);
                        }
                        ++traversal.trips;
                    }
                } while (hasNodes(walk) && hasRoom(walk) && traversal.trips < budget);
                do {
                    if (hasTriangles(walk) && traversal.aside < kMostAside && traversal.trips < budget) {
                        passTriangle(traversal, walk);
                        ++traversal.trips;
                    }
                } while (hasTriangles(walk) && traversal.aside < kMostAside && traversal.trips < budget);
            }
        } while (!isOver(walk) && traversal.trips < budget && traversal.aside < kMostAside);
        settleAside(traversal);
    } while (!isOver(walk) && traversal.trips < budget);
    return isOver(walk) ? kNone : 0u;
}

#endif
