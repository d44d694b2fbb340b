// How far a picture is from the truth, on linear colour before any clamping.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/image.h"

namespace glint::report {

// Over the pixels that count and are finite in both; all 0 if there is none. Differences are picture - truth.
struct ErrorMeasures {
    uint64_t pixels = 0;
    uint64_t notFinite = 0;  // pixels left out because a channel is not finite
    double rmse = 0;         // root mean square over pixels and channels
    // Standard error of rmse, from the scatter of the pixels' squares: sqrt(var / pixels) / (2 rmse). Errors
    // of neighbouring pixels count as independent, which those of random samplers are.
    double rmseError = 0;
    // Mean over pixels and channels of d^2 / (truth^2 + kRelativeFloor), see core/image_diff.h.
    double relMse = 0;
    double max = 0;             // greatest channel of any pixel
    double p99 = 0;             // 99th percentile over pixels of the greatest channel
    double percentVisible = 0;  // of the pixels, greatest channel above 1/255
    double percentSmall = 0;    // the same above 1e-3
    double bias = 0;            // mean over pixels and channels
};

// `truth`: one colour for each pixel of `picture`, row by row; `counts`: which pixels to take, empty for all.
ErrorMeasures measureError(const Image& picture, std::span<const glm::dvec3> truth,
                           std::span<const uint8_t> counts = {});

// Against the double-precision picture of the same samples.
struct ArithmeticError {
    ErrorMeasures all, samePath, otherPath;  // by the path of the pixel's first sample
};
ArithmeticError measureArithmetic(const Image& picture, std::span<const uint32_t> paths,
                                  std::span<const glm::dvec3> truth, std::span<const uint32_t> truthPaths);

}  // namespace glint::report
