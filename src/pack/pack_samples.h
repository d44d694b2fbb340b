// The samples of a picture's pixels from its settings (docs/guide/sampling.md).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "scene/scene.h"
#include "trace/request.h"

namespace glint {

// The samples of valid settings; only this function decides that a camera needs samples that differ from
// pixel to pixel. A regular grid under the box filter of radius 0.5 comes as offsets, without a lens;
// anything else as rows.
PackedSamples packSamples(const ImageSettings& image, const Camera& camera);

// The samples of an image piece by piece, for callers that find the number during the render. Only `next`
// decides how many there are: samplesPerPixel and adaptive of `image` are ignored.
class SampleSequence {
  public:
    // Throws std::invalid_argument for a grid, which has no further samples; Auto is LowDiscrepancy.
    explicit SampleSequence(const ImageSettings& image);
    ~SampleSequence();
    SampleSequence(SampleSequence&&) noexcept;
    SampleSequence& operator=(SampleSequence&&) noexcept;

    // The next `count` samples of each pixel, whose weights sum to count; LowDiscrepancy continues its
    // sequence. count: at least leastSamples(image.filter).
    PackedSamples next(uint32_t count);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// How few samples have weights at all: a filter with negative parts takes some of each.
uint32_t leastSamples(Filter filter);

// A request for the whole image with these settings and their samples; everything else is the default.
Request requestOf(const ImageSettings& image, const Camera& camera);

// ---- Reconstruction filters as tables of inverse cumulative distributions

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

// ---- Points of [0, 1)^4 in units of 2^-32: film x, film y, lens x, lens y

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
