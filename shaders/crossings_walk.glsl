// The walk of a ray that counts what it crosses, in a tree of triangles alone (kLeavesWait). Nothing on its
// way gets nearer, so the order of nodes does not matter, and leaves can wait: a ray collects them as long as
// there is room, and tests them when all rays of the subgroup do. On lavapipe it would else wait for the
// others before each leaf (docs/lab/library.md).
#ifndef GLINT_CROSSINGS_WALK_GLSL
#define GLINT_CROSSINGS_WALK_GLSL

// Leaves wait behind the stack, each as `first | count << kWaitingShift`: those of one node, which follow
// each other, as one, so that a node puts down one word at most.
const uint kMostLeaves = 16u;
const uint kWaitingShift = 25u;
uint waiting[kOwnWords + kMostLeaves];

// A ray's way through the tree: the node at hand, kNone for none, and the height of the stack; leaves that
// wait; of the leaf at hand the triangles that are left.
struct CrossingsWalk {
    uint current, top;
    uint leaves;
    uint index, end;
};

bool hasTriangles(CrossingsWalk walk) { return walk.index < walk.end || walk.leaves > 0u; }
bool isOver(CrossingsWalk walk) { return walk.current == kNone && !hasTriangles(walk); }
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

void passTriangle(inout Traversal traversal, inout CrossingsWalk walk) {
    bool pops = walk.index >= walk.end;
    walk.leaves -= pops ? 1u : 0u;
    uint leaf = waiting[kOwnWords + walk.leaves];
    uint first = leaf & kLeafFirstMask;
    walk.index = pops ? first : walk.index;
    walk.end = pops ? first + (leaf >> kWaitingShift) : walk.end;
    lookAtTriangle(traversal, walk.index);
    ++walk.index;
}

// From the root. Returns kNone when finished, else 0, the slot to begin again from.
uint traverseAll(inout Traversal traversal, uint root) {
    uint budget = dispatch.tripBudget;
    CrossingsWalk walk = CrossingsWalk(root, 0u, 0u, 0u, 0u);
    bool rootIsLeaf = root != kNone && !isNode(root);
    waiting[kOwnWords] = (root & kLeafFirstMask) | sizeOfLeaf(root) << kWaitingShift;
    if (rootIsLeaf) {
        walk.current = kNone;
        walk.leaves = 1u;
    }
    precise float tEnd = traversal.ray.tMax * farPad();
    do {
        do {
            if (!isOver(walk) && traversal.trips < budget && traversal.aside < kMostAside) {
                do {
                    if (isNode(walk.current) && hasRoom(walk) && traversal.trips < budget) {
                        passNode(traversal, tEnd, walk);
                        ++traversal.trips;
                    }
                } while (isNode(walk.current) && hasRoom(walk) && traversal.trips < budget);
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
