// Every pixel to a given error.
#pragma once

#include "converge/converge.h"

namespace glint::converge {

// As converge(), for Measure::Pixel: each sample of a pixel is an observation between 0 and the scene's
// radiance bound, and its mean has a confidence sequence (bounds.h). Tiles whose pixels have all settled are
// not drawn any more. Sampling is by independent points, one replicate for each sample.
Result convergePixels(const Draw& draw, const Job& job);

}  // namespace glint::converge
