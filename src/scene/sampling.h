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

// Where the samples lie in the end, never Auto. Adaptive sampling, which cannot go on from a grid, makes Auto
// LowDiscrepancy whatever the number.
Sampler samplerOf(const ImageSettings& image);

// Pixels: box 0.5, tent 1, Gaussian 1.5, Mitchell 2.
double defaultRadius(Filter filter);

// What is wrong with settings that are right each by itself, and how to mend it; empty if nothing is.
std::string samplingConflict(const ImageSettings& image);

// Offsets of the samples of a pixel, in [0,1)^2: the centre for 1, a regular grid for a square number, else
// Hammersley's points (Hammersley 1960).
std::vector<glm::dvec2> sampleOffsets(int samplesPerPixel);

}  // namespace glint
