// Nodes of four children and compressed ones of eight (src/bvh/wide_tree.h), and the stack of a ray that
// walks by itself.
#ifndef GLINT_WIDE_NODES_GLSL
#define GLINT_WIDE_NODES_GLSL

#include "intersect.glsl"

// Words of a stack. In a lane's own memory there is room for one of each level of the binary tree. In the
// workgroup's, for 12 entries of two words (as many as in Ylitie, Karras, Laine, "Efficient Incoherent Ray
// Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, sec. 4), 6 KiB in all: more would leave room for
// fewer workgroups, and Vulkan promises 16 KiB. A ray that needs more is started again by the walk that needs
// none.
const uint kOwnWords = kMaxBvhDepth + 1u;
const uint kGroupWords = 24u;
uint ownStack[kOwnWords];
shared uint groupStack[kGroupWords * kWorkgroupSize];

uint stackWords() { return STACK_PLACE == kStackShared ? kGroupWords : kOwnWords; }

// Word by word across the lanes, so that lanes at the same height use different banks of memory.
void stackPut(uint place, uint word) {
    if (STACK_PLACE == kStackShared) {
        groupStack[place * kWorkgroupSize + gl_LocalInvocationID.x] = word;
    } else {
        ownStack[place] = word;
    }
}

uint stackAt(uint place) {
    if (STACK_PLACE == kStackShared) return groupStack[place * kWorkgroupSize + gl_LocalInvocationID.x];
    return ownStack[place];
}

// Four slabs of one axis at a time, by the operations of intersectBox. Comparisons instead of min and max, as
// there.
struct FourSlabs {
    vec4 near;
    vec4 far;
};

void meetAt(inout FourSlabs slabs, vec4 t0, vec4 t1) {
    for (int i = 0; i < 4; ++i) {
        slabs.near[i] = t0[i] > slabs.near[i] ? t0[i] : slabs.near[i];
        slabs.far[i] = t1[i] < slabs.far[i] ? t1[i] : slabs.far[i];
    }
}

bvec4 entersSlabs(FourSlabs slabs, float tEnd, float pad) {
    precise vec4 padded = slabs.far * pad;
    vec4 far = mix(vec4(tEnd), padded, lessThan(padded, vec4(tEnd)));
    return lessThanEqual(slabs.near, far);
}

// Beyond all that is hit.
FourSlabs allSlabs(float tMin) { return FourSlabs(vec4(tMin), vec4(uintBitsToFloat(0x7f800000u))); }

// Where planes of a node of four are known to a unit more of their distance than those of intersectBox
// (meetAxisOfFour), so 1 + 40 u.
float farPadOfFour() { return SLAB_PAD == kSlabGamma7 ? 1.00000238418579 : farPad(); }

// 256 + byte steps, exactly: a float of the exponent of 256 steps and the byte behind it.
vec4 stepsOf(uint bytes, uint exponent) {
    return uintBitsToFloat((uvec4(bytes << 15, bytes << 7, bytes >> 1, bytes >> 9) & 0x7f8000u) | exponent);
}

// planes: lower ones of the four children, upper ones. Along the axis they are off by a rounding each of what
// lies between the grid and the ray's origins, and of the sum. Of the first no more than 2^-15 of a step is
// not a unit of the plane's distance; by so much the host has moved the planes outwards (wide_tree.cpp).
void meetAxisOfFour(inout FourSlabs slabs, uvec2 planes, uint exponent, float origin, bool negative,
                    float nearOrigin, float farOrigin, float inverse) {
    exponent = (exponent & 0xffu) << 23;
    precise float nearAway = origin - nearOrigin;
    precise float farAway = origin - farOrigin;
    precise vec4 t0 = (stepsOf(negative ? planes.y : planes.x, exponent) + nearAway) * inverse;
    precise vec4 t1 = (stepsOf(negative ? planes.x : planes.y, exponent) + farAway) * inverse;
    meetAt(slabs, t0, t1);
}

// Children of a node of four that are still to be visited, as one word: node << 8 | number << 6, and two bits
// for each, which say where it stands in the node, the next one in the lowest.
uint childOfFour(uint word) {
    uvec4 four = LOAD4(wideRowsArray, kFourRows * (word >> 8) + 3u);
    uint low = (word & 1u) != 0u ? four.y : four.x;
    uint high = (word & 1u) != 0u ? four.w : four.z;
    return (word & 2u) != 0u ? high : low;
}

bool isLastOfFour(uint word) { return (word & 0xc0u) == 1u << 6; }

// (Of no child less than one the number is of no use, but the node is still one.)
uint withoutFirst(uint word) {
    return (word & 0xffffff00u) | ((word - (1u << 6)) & 0xc0u) | ((word >> 2) & 0xfu);
}

void sortTwo(inout uint a, inout uint b) {
    uint less = min(a, b);
    b = max(a, b);
    a = less;
}

// What a ray makes of a node of four. absent: bit 31 of each child that there is none of; links as in
// src/bvh/wide_tree.h.
struct FourMet {
    FourSlabs slabs;
    bvec4 entered;
    ivec4 absent;
    uint links;
};

FourMet meetFour(Ray ray, RayFrame frame, uint node, float tEnd) {
    uint row = kFourRows * node;
    FourMet met;
    met.slabs = allSlabs(ray.tMin);
    uvec4 head = LOAD4(wideRowsArray, row);
    uvec4 xy = LOAD4(wideRowsArray, row + 1u);
    uvec4 z = LOAD4(wideRowsArray, row + 2u);
    vec3 origin = uintBitsToFloat(head.xyz);
    meetAxisOfFour(met.slabs, xy.xy, head.w, origin.x, frame.negative.x, frame.nearOrigin.x,
                   frame.farOrigin.x, frame.inverse.x);
    meetAxisOfFour(met.slabs, xy.zw, head.w >> 8, origin.y, frame.negative.y, frame.nearOrigin.y,
                   frame.farOrigin.y, frame.inverse.y);
    meetAxisOfFour(met.slabs, z.xy, head.w >> 16, origin.z, frame.negative.z, frame.nearOrigin.z,
                   frame.farOrigin.z, frame.inverse.z);
    met.entered = entersSlabs(met.slabs, tEnd, farPadOfFour());
    met.absent = ivec4(0, head.w, z.zw);
    met.links = z.w;
    return met;
}

// What it enters, where children are visited in order: words of the first child and of the others.
struct FourEntered {
    uint first;
    uint others;
    bool none;
    bool more;
};

// Where a ray enters children are floats above zero, in the order of their bits, or turned in the contrary
// order; the lowest two bits make room for the child's place. Without the sign, which -0 and an interval that
// begins below zero have, no key is kNone. Five minima and maxima of words sort four.
FourEntered enterFour(Ray ray, RayFrame frame, uint node, float tEnd, bool farthestFirst) {
    FourMet met = meetFour(ray, frame, node, tEnd);
    uvec4 keys = ((floatBitsToUint(met.slabs.near) ^ (farthestFirst ? 0x7fffffffu : 0u)) & 0x7ffffffcu) |
                 uvec4(0u, 1u, 2u, 3u);
    keys = mix(uvec4(kNone), keys, met.entered);
    keys.yzw |= uvec3(met.absent.yzw >> 31);
    sortTwo(keys.x, keys.y);
    sortTwo(keys.z, keys.w);
    sortTwo(keys.x, keys.z);
    sortTwo(keys.y, keys.w);
    sortTwo(keys.y, keys.z);
    uint number = keys.z == kNone ? 1u << 6 : (keys.w == kNone ? 2u << 6 : 3u << 6);
    uint places = (keys.y & 3u) | (keys.z & 3u) << 2 | (keys.w & 3u) << 4;
    return FourEntered(node << 8 | (keys.x & 3u), node << 8 | number | places, keys.x == kNone,
                       keys.y != kNone);
}

uint bitsOf(bvec4 b) { return (b.x ? 1u : 0u) | (b.y ? 2u : 0u) | (b.z ? 4u : 0u) | (b.w ? 8u : 0u); }

// The same in any order, a bit for each child.
uint enteredOfFour(FourMet met) {
    return bitsOf(bvec4(met.entered.x, met.entered.y && met.absent.y >= 0, met.entered.z && met.absent.z >= 0,
                        met.entered.w && met.absent.w >= 0));
}

// Children that are still to be visited, of one kind: of `first` and those that follow it one for each of
// bits 8 to 15 of `bits`, which say in which of the node's eight slots they are. Bits 0 to 7: which of them;
// bit i is slot i ^ octant, so that those nearer to where the ray comes from have lower bits (Ylitie, Karras,
// Laine 2017, sec. 2.3 and 3.2). On the stack, of leaves: kLeafFlag too.
struct ChildGroup {
    uint first;
    uint bits;
};

bool isEmpty(ChildGroup group) { return (group.bits & 0xffu) == 0u; }

// Bits 0 to 2: whether the ray runs downwards along x, y, z.
uint octantOf(RayFrame frame) {
    return (frame.negative.x ? 1u : 0u) | (frame.negative.y ? 2u : 0u) | (frame.negative.z ? 4u : 0u);
}

// Takes the first of a group that is not empty out of it.
uint takeFirst(inout ChildGroup group, uint octant) {
    uint slot = uint(findLSB(group.bits & 0xffu)) ^ octant;
    group.bits &= group.bits - 1u;
    return group.first + uint(bitCount((group.bits >> 8) & ((1u << (slot & 7u)) - 1u)));
}

// Bit i to i ^ octant, in both halves.
uint turnBits(uint bits, uint octant) {
    bits = (octant & 1u) != 0u ? ((bits & 0x00550055u) << 1) | ((bits >> 1) & 0x00550055u) : bits;
    bits = (octant & 2u) != 0u ? ((bits & 0x00330033u) << 2) | ((bits >> 2) & 0x00330033u) : bits;
    return (octant & 4u) != 0u ? ((bits & 0x000f000fu) << 4) | ((bits >> 4) & 0x000f000fu) : bits;
}

// The product is exact, so this has one rounding however it is done, the host's own (wide_tree.cpp), and the
// planes are those that it has made sure enclose the child's box.
vec4 planesOf(uint bytes, float scale, float origin) {
    vec4 steps = vec4(uvec4(bytes, bytes >> 8, bytes >> 16, bytes >> 24) & 0xffu);
    precise vec4 planes = steps * scale + origin;
    return planes;
}

void meetSlabs(inout FourSlabs slabs, vec4 nearPlane, vec4 farPlane, float nearOrigin, float farOrigin,
               float inverse) {
    precise vec4 t0 = (nearPlane - nearOrigin) * inverse;
    precise vec4 t1 = (farPlane - farOrigin) * inverse;
    meetAt(slabs, t0, t1);
}

// planes: lower ones of the children in slots 0..3 and 4..7, upper ones.
void meetAxisOfEight(inout FourSlabs slabs0, inout FourSlabs slabs1, uvec4 planes, uint exponent,
                     float origin, bool negative, float nearOrigin, float farOrigin, float inverse) {
    float scale = uintBitsToFloat((exponent & 0xffu) << 23);
    uvec2 nearPlanes = negative ? planes.zw : planes.xy;
    uvec2 farPlanes = negative ? planes.xy : planes.zw;
    meetSlabs(slabs0, planesOf(nearPlanes.x, scale, origin), planesOf(farPlanes.x, scale, origin), nearOrigin,
              farOrigin, inverse);
    meetSlabs(slabs1, planesOf(nearPlanes.y, scale, origin), planesOf(farPlanes.y, scale, origin), nearOrigin,
              farOrigin, inverse);
}

// What the ray enters of a compressed node.
void enterEight(Ray ray, RayFrame frame, uint node, float tEnd, uint octant, out ChildGroup nodes,
                out ChildGroup leaves) {
    uint row = kCompressedRows * node;
    uvec4 head = LOAD4(wideRowsArray, row);
    uvec4 links = LOAD4(wideRowsArray, row + 1u);
    vec3 origin = uintBitsToFloat(head.xyz);
    FourSlabs slabs0 = allSlabs(ray.tMin);
    FourSlabs slabs1 = slabs0;
    meetAxisOfEight(slabs0, slabs1, LOAD4(wideRowsArray, row + 2u), head.w, origin.x, frame.negative.x,
                    frame.nearOrigin.x, frame.farOrigin.x, frame.inverse.x);
    meetAxisOfEight(slabs0, slabs1, LOAD4(wideRowsArray, row + 3u), head.w >> 8, origin.y, frame.negative.y,
                    frame.nearOrigin.y, frame.farOrigin.y, frame.inverse.y);
    meetAxisOfEight(slabs0, slabs1, LOAD4(wideRowsArray, row + 4u), head.w >> 16, origin.z, frame.negative.z,
                    frame.nearOrigin.z, frame.farOrigin.z, frame.inverse.z);
    uint entered = bitsOf(entersSlabs(slabs0, tEnd, farPad())) | bitsOf(entersSlabs(slabs1, tEnd, farPad()))
                                                                     << 4;
    uint nodeSlots = head.w >> 24;
    uint leafSlots = links.z;
    uint both = turnBits((entered & nodeSlots) | (entered & leafSlots) << 16, octant);
    nodes = ChildGroup(links.x, (both & 0xffu) | nodeSlots << 8);
    leaves = ChildGroup(links.y, both >> 16 | leafSlots << 8);
}

// The word of a leaf, as in shared::Node.
uint loadLeaf(uint place) {
    uvec4 four = LOAD4(wideRowsArray, place >> 2);
    return (place & 2u) == 0u ? ((place & 1u) == 0u ? four.x : four.y)
                              : ((place & 1u) == 0u ? four.z : four.w);
}

#endif
