// Points of [0, 1)^4 in units of 2^-32: film x, film y, lens x, lens y (docs/guide/sampling.md).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace glint {

using FixedPoint = std::array<uint32_t, 4>;

// A point's cell begins at `low` and is `width` wide along each axis.
struct FixedCell {
    FixedPoint low{}, width{};
};

// Point `index` of Sobol's sequence in four dimensions (S. Joe, F. Y. Kuo, "Constructing Sobol Sequences with
// Better Two-Dimensional Projections", SIAM J. Sci. Comput. 30, 2008: new-joe-kuo-6.21201). Every 2^k points
// from a multiple of 2^k on hold one in each elementary interval of a dimension.
FixedPoint sobolPoint(uint32_t index);

// `count` cells that fill the film's square without overlap, all of area 1 / count, in about as many rows as
// columns; each with another one on the lens, paired at random for a `seed`.
std::vector<FixedCell> stratifiedCells(uint32_t count, uint32_t seed);

// The fixed-point pattern of scene/sampling.h's sampleOffsets on the film, paired with its own points in
// another order on the lens, at random for a `seed`; the first one is paired with the lens's centre if count
// is 1.
std::vector<FixedPoint> gridPoints(uint32_t count, uint32_t seed);

}  // namespace glint
