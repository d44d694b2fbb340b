#pragma once

#include <vector>

#include "pack/kind_packer.h"
#include "pack/scene_arrays.h"

namespace glint {

// Fills the arrays of the kinds, and those of their further rows, with primitives[order[0]], ...
void writeInLeafOrder(const Packing& packing, const Primitives& primitives,
                      const std::vector<uint32_t>& order, const Context& context);

}  // namespace glint
