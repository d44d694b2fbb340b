// Reconstruction filters as tables of inverse cumulative distributions (docs/guide/sampling.md).
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace glint {

// A filter along one axis, not normalised; `x` pixels from the centre, 0 beyond `radius`. Tent: 1 - |x| / r.
// Gaussian: exp(-x^2 / 2 s^2) - exp(-r^2 / 2 s^2) with s = r / 3 (PBRT 7.8.1). Mitchell: D. P. Mitchell, A.
// N. Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988, eq. 8 with B = C = 1/3, its
// radius of 2 stretched to r.
double filterValue(Filter filter, double x, double radius);

// One of the two parts of a filter along an axis: where it is positive, or where it is negative.
struct FilterPart {
    double mass = 0;  // integral of |filter| over the part, as a share of the integral of the filter
    std::vector<uint32_t> cells;  // as in the samples' array; as many as two tables hold if mass is 0 too
};
struct FilterParts {
    FilterPart positive, negative;
};
// positive.mass - negative.mass = 1.
FilterParts filterParts(Filter filter, double radius);

}  // namespace glint
