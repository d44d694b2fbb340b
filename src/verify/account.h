// Account of the losses of an image's rays: branches that were not followed, and media that a ray had no room
// for. The device reports its losses for the whole image, so the account compares them with the sum over all
// pixels.
#pragma once

#include "trace/picture.h"

namespace glint::verify {

class Account {
  public:
    // radianceBound: by which branches are judged (Environment::radianceBound).
    explicit Account(double radianceBound) : radianceBound_(radianceBound) {}

    // Adds a pixel whose rays hit the same primitives on device and reference: it loses the same branches.
    void addAlike(const TreeLosses& lost, double weight);
    // Adds a pixel whose rays hit others. Each hit loses at most two branches, and one medium.
    void addOther(uint32_t bounces, double weight);
    void add(const Account& rows);

    // otherwise: how many pixels of those alike may decide about a hit's branches as the reference does not:
    // where light is just reflected totally, at the edge of a mirroring square of a checker.
    bool agrees(const TreeLosses& device, uint64_t otherwise) const;

  private:
    bool agrees(const LostBranches& alike, const LostBranches& device, uint64_t otherwise) const;

    double radianceBound_;
    TreeLosses alike_;
    LostBranches other_;  // at most, of any kind
    double greatestWeight_ = 0;
};

}  // namespace glint::verify
