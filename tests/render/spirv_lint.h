// What a SPIR-V module leaves to the driver that could change a picture's bits.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>

namespace glint::render::test {

// Of which kinds there is at least one in the module:
//   "unmarked"          arithmetic of floats without the decoration NoContraction: it may be fused or
//   reordered "relaxed"           a result that may be computed in 16 bits "op 136" ...        an instruction
//   that need not be correctly rounded: OpFDiv, OpFRem, OpFMod, products of
//                       matrices, OpDot, OpOuterProduct, OpQuantizeToF16, by their numbers
//   "GLSL.std.450 26"   the same of an extended instruction (here Pow): any but those on whole numbers, and
//                       those that pick or cut, which have nothing to round
// Divisions, roots and built-in functions of doubles do not count: the kernels for `glint report` have them.
std::set<std::string> variedByDrivers(std::span<const uint32_t> module);

}  // namespace glint::render::test
