// How hard a scene is for fp32: one number, from the double-precision tracer alone.
#pragma once

#include <cstddef>
#include <vector>

#include "core/enum_names.h"
#include "reference/tracer.h"
#include "trace/packed_samples.h"

namespace glint::verify {

inline constexpr double kFloatUnit = 0x1p-24;  // the relative error of one rounding to fp32

// The condition number kappa of a picture: the change of a pixel's colour (greatest channel, full scale 1)
// for rays moved by up to one unit of 2^-24 (reference::Jitter with ulps = 1), over 2^-24; the greatest of
// `seeds` moves, the 99th percentile over the pixels. kappa 2^-24 is the error that fp32 arithmetic has a
// right to, and more than a few times that a sign of a method that loses digits.
//
// Of pictures of more than kMaxKappaPixels about as many are asked, one at random in each cell of a grid.
inline constexpr size_t kMaxKappaPixels = 4096;
struct Sensitivity {
    double kappa = 0;
    // An upper limit of it: the order statistic that the true percentile exceeds with a chance of 1e-3.
    double kappaLimit = 0;
    uint64_t tried = 0;  // pixels, with so many moves of one unit each, and one of kWideUnits
    uint64_t moves = 1;
    // Moves for which the reference itself changes a pixel: `changed` of all moves of one unit,
    // `changedWidely` of the moves of kWideUnits. A change is a hit of other primitives, or other decisions
    // with a colour difference above the error of arithmetic.
    uint64_t changed = 0, changedWidely = 0;
    uint64_t open = 0;  // pixels for which isOpen

    double changedByOne() const { return static_cast<double>(changed) / static_cast<double>(moves); }
    // Greatest share of pixels that the device may see otherwise, with kConfidence: all that are open, and
    // kShareOfPrediction times those that a move of one unit changes. Edges are as wide as the move, so that
    // a wide one counts for as many; where more than that change at one unit, paths are chaotic, and they are
    // counted at one unit alone.
    double explainedShare() const;
};
inline constexpr double kWideUnits = 32;
// How many times as many pixels the device may see otherwise as the reference does when each of its rays is
// moved by up to one unit of 2^-24. Measured: 0.6 to 1 times as many (docs/design/verification.md).
inline constexpr double kShareOfPrediction = 2;
// A pixel of cell number `cell` of step x step pixels, at random.
glm::ivec2 placeInCell(size_t cell, int step);

// True if a pixel changes: by another path, or by other decisions and another colour.
bool isOtherwise(const reference::PixelRecord& still, const reference::PixelRecord& moved);
// True if fp32's errors decide on the way which surfaces are in one place (Jitter::slips). still: of `ray`,
// moved by `move`. change: becomes at least as great as the change of colour.
bool isOpen(const reference::Tracer& tracer, const reference::Ray& ray, const reference::PixelRecord& still,
            reference::Jitter move = {}, double* change = nullptr);

// Sensitivity through the pixels' samples in turn.
Sensitivity sensitivityOf(const reference::Tracer& tracer, const shared::Camera& camera, int width,
                          int height, const PackedSamples& samples, int seeds = 3,
                          size_t mostPixels = kMaxKappaPixels);
// Through the pixels' middles.
double conditionNumber(const reference::Tracer& tracer, const shared::Camera& camera, int width, int height,
                       int seeds = 4);
// Error that arithmetic with a rounding unit of `unit`, and storing as fp32, may cause.
double roundingError(const reference::Tracer& tracer, const shared::Camera& camera, int width, int height,
                     double unit);

// Non-stiff below 1e2, stiff up to 1e5, beyond that fp32 cannot hold the second digit of the colour.
enum class StiffnessClass { NonStiff, Stiff, BeyondFp32 };
constexpr auto entriesOf(StiffnessClass) {
    return std::to_array<EnumEntry<StiffnessClass>>({{StiffnessClass::NonStiff, "non-stiff"},
                                                     {StiffnessClass::Stiff, "stiff"},
                                                     {StiffnessClass::BeyondFp32, "beyond fp32"}});
}
StiffnessClass classOf(double kappa);

// The value that `share` of them do not exceed, 0 of nothing; no NaN. And the 99th percentile.
double percentile(std::vector<float> values, double share);
double percentile99(std::vector<float> values);

}  // namespace glint::verify
