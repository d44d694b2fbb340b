// Sensitivity of a scene to fp32, from the double-precision tracer alone: the condition number of an image,
// and the number of pixels that rounding may decide.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/context.h"
#include "reference/rounding.h"
#include "reference/tracer.h"
#include "trace/request.h"

namespace glint::reference {

// ---- limits from counts ----

inline constexpr double kConfidence = 0.999;  // of each limit

// The greatest mean of a Poisson variable that gives `count` or less with a chance of 1 - kConfidence: an
// upper limit on the mean that was counted (F. Garwood, "Fiducial Limits for the Poisson Distribution",
// Biometrika 28, 1936). A binomial count scatters less.
double greatestMean(uint64_t count);
// The least number that a Poisson variable of this mean exceeds with a chance of at most 1 - kConfidence.
uint64_t greatestCount(double mean);
// 0 for an empty vector; values must not be NaN.
double percentile99(std::vector<float> values);

// ---- sensitivity ----

inline constexpr double kWideUnits = 32;
// The device may differ in this many times as many pixels as the reference changes when each of its rays
// moves by up to one unit of 2^-24.
inline constexpr double kShareOfPrediction = 2;
// Approximate maximum of pixels to examine, one at random in each cell of a grid.
inline constexpr size_t kMaxKappaPixels = 4096;

struct Sensitivity {
    // The condition number: the change of a pixel's colour (greatest channel, full scale 1) for rays moved by
    // up to one unit of 2^-24 (Jitter with ulps = 1), over 2^-24; the greatest of all moves, the
    // 99th percentile over the pixels. kappa 2^-24 is the error that fp32 arithmetic may make; several times
    // that is a sign of a method that loses digits.
    double kappa = 0;
    uint64_t tried = 0;  // pixels, each with `moves` moves of one unit and one of kWideUnits
    uint64_t moves = 1;
    // Moves for which the reference itself changes a pixel: `changed` of all moves of one unit,
    // `changedWidely` of the moves of kWideUnits. A change is a hit of other primitives, or other decisions
    // with a colour difference above the error of arithmetic or other hidden lights at the first hit.
    uint64_t changed = 0, changedWidely = 0;
    uint64_t open = 0;  // pixels for which isOpen

    double changedByOne() const { return static_cast<double>(changed) / static_cast<double>(moves); }
    // Greatest share of pixels in which the device may differ, with kConfidence: all open ones, and
    // kShareOfPrediction times those that a move of one unit changes. The width of edges grows with the move,
    // so the share at one unit is at least a 32nd of that of wide moves. If more pixels change at one unit,
    // paths are chaotic, and only moves of one unit count.
    double explainedShare() const;
};

// Through the pixels' samples in turn. Throws Cancelled.
Sensitivity sensitivityOf(const Tracer& tracer, const shared::Camera& camera, int width, int height,
                          const PackedSamples& samples, const Context& context, int seeds = 3,
                          size_t mostPixels = kMaxKappaPixels);
// Sensitivity::kappa of the whole image, through the pixels' middles.
double conditionNumber(const PackedScene& scene, const Request& request, int seeds = 4);
// Error that arithmetic with a rounding unit of `unit`, and storing as fp32, may cause in the whole image.
double roundingError(const PackedScene& scene, const Request& request, double unit);

// A random pixel of cell number `cell` of step x step pixels. Pixels that rounding decides often lie along
// one row or column, which a regular grid hits always or never.
glm::ivec2 placeInCell(size_t cell, int step);

// True if fp32's errors decide anywhere on the path which surfaces are in one place (Jitter::slips). still:
// the record of `ray`, moved by `move`. change: becomes at least the change of colour.
bool isOpen(const Tracer& tracer, const Ray& ray, const PixelRecord& still, Jitter move = {},
            double* change = nullptr);

// Non-stiff below 1e2, stiff up to 1e5, beyond that fp32 cannot hold the second digit of the colour.
constexpr const char* stiffnessOf(double kappa) {
    return kappa < 1e2 ? "non-stiff" : kappa <= 1e5 ? "stiff" : "beyond fp32";
}

}  // namespace glint::reference
