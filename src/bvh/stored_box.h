// The boxes that nodes hold.
#pragma once

#include "bvh/bvh.h"
#include "bvh/lanes.h"

namespace glint {

// A box in two registers. Words that are stored one by one and then copied two at a time make the processor
// wait, which a box that is read right after it was written would do at every node.
struct RegisterBox {
    Lanes lo, hi;

    static RegisterBox of(const Box& box) {
        return {Lanes::of(box.lo.x, box.lo.y, box.lo.z), Lanes::of(box.hi.x, box.hi.y, box.hi.z)};
    }
    Box box() const { return {toVec3(lo), toVec3(hi)}; }
};

inline RegisterBox unionOf(const RegisterBox& a, const RegisterBox& b) {
    return {min(a.lo, b.lo), max(a.hi, b.hi)};
}

// How far a stored box reaches beyond its contents: one ulp, and enough that a ray that runs in one of its
// sides (a direction of 0, whose inverse the shaders take for 2^125) is seen well inside.
inline Lanes storedMargin(Lanes x) {
    const Lanes magnitude = max(x, Lanes::all(0) - x);
    return max(magnitude * Lanes::all(0x1p-23f), Lanes::all(0x1p-100f));
}

// The box that a node stores for a child with this tight one, which is not empty: so much wider that no ray
// is lost by rounding.
inline RegisterBox storedBox(const RegisterBox& tight) {
    return {tight.lo - storedMargin(tight.lo), tight.hi + storedMargin(tight.hi)};
}

}  // namespace glint
