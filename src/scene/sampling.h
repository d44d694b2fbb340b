// Rules of samplers and filters.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint {

// From how many samples on Auto takes LowDiscrepancy. Measured (docs/lab/accuracy.md): up to there the grid
// errs as little or less in most scenes, from there on it errs less in few and up to 2.6 times more in the
// others.
inline constexpr int kLeastLowDiscrepancySamples = 16;

// Resolves Auto. Adaptive sampling makes Auto LowDiscrepancy, since it cannot extend a grid.
Sampler samplerOf(const ImageSettings& image);

// Pixels: box 0.5, tent 1, Gaussian 1.5, Mitchell 2.
double defaultRadius(Filter filter);

// A conflict between settings and its remedy; empty without a conflict.
std::string samplingConflict(const ImageSettings& image);

// Offsets of the samples of a pixel, in [0,1)^2: the centre for 1, a regular grid for a square number, else
// Hammersley's points (Hammersley 1960).
std::vector<glm::dvec2> sampleOffsets(int samplesPerPixel);

}  // namespace glint
