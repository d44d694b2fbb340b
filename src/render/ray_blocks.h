// Blocks of a batch's rays on their way to the device (ray_queries.cpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <span>
#include <type_traits>

#include "render/rays.h"

namespace glint::render {

constexpr size_t kBlock = kRayBlock;
// llvmpipe gives each of its threads an equal run of the workgroups: blocks are dealt out among so many runs.
constexpr size_t kRuns = 16;

// A block of elements that nobody sets to anything first, which would cost as much as to fill it.
template <class Element>
class Unset {
  public:
    std::span<Element, kBlock> all() {
        return std::span<Element, kBlock>(std::launder(reinterpret_cast<Element*>(bytes_)), kBlock);
    }

  private:
    static_assert(std::is_trivially_destructible_v<Element> && std::is_aggregate_v<Element>);
    alignas(Element) std::byte bytes_[kBlock * sizeof(Element)];
};

// Positions of a piece's blocks.
struct Placement {
    size_t blocks, runs, perRun;
    Placement(size_t count, bool dealt)
        : blocks((count + kBlock - 1) / kBlock),
          runs(dealt ? std::min(kRuns, blocks) : 1),
          perRun((blocks + runs - 1) / runs) {}
    size_t places() const { return runs * perRun; }
    // The block at a place; `blocks` or more if there is none.
    size_t at(size_t place) const { return place % perRun * runs + place / perRun; }
};

}  // namespace glint::render
