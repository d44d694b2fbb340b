// Account of the losses of an image's rays: branches that were not followed, and media that a ray had no room
// for. The device reports its losses for the whole image, so the account compares them with the sum over all
// pixels.
#pragma once

#include "reference/tracer.h"
#include "trace/picture.h"

namespace glint::verify {

class Account {
  public:
    // radianceBound: by which branches are judged (Environment::radianceBound).
    explicit Account(double radianceBound) : radianceBound_(radianceBound) {}

    // A pixel whose rays met the same primitives on device and reference, and so lost the same branches.
    void addAlike(const reference::Losses& lost, double weight);
    // One whose rays met others. At each hit at most two branches, and one medium, are lost.
    void addOther(uint32_t bounces, double weight);
    void add(const Account& other);

    // otherwise: how many pixels of those alike may decide about a hit's branches as the reference does not:
    // where light is just reflected totally, at the edge of a mirroring square of a checker.
    bool agrees(const TreeLosses& device, uint64_t otherwise) const;

  private:
    struct Kind {
        uint64_t count = 0;
        double bound = 0;
    };
    bool agrees(const Kind& kind, const LostBranches& device, uint64_t otherwise) const;

    double radianceBound_;
    Kind cut_, depth_, room_, other_;
    uint64_t crowded_ = 0;
    double greatestWeight_ = 0;
};

}  // namespace glint::verify
