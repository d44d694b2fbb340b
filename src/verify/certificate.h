// Proves a device's path ray by ray: each hit, each light and each further ray must be what the reference
// makes of the device's own ray, for roundings of this one step (docs/design/verification.md).
#pragma once

#include "reference/tracer.h"
#include "trace/picture.h"
#include "verify/quantities.h"

namespace glint::verify {

// The reference's colour may change by this many times its response to moves of one unit of 2^-24: a step
// takes some ten roundings where a move changes a ray once.
inline constexpr double kResponseGain = 16;
inline constexpr uint64_t kResponseMoves = 16;

// Units of 2^-24 that a ray may move by in one step, relative to the greatest coordinate involved: 10 on each
// of two axes for the triangle test (PBRT 4th ed., 6.8.7), 14 for the origin. The transform of an instance
// adds its condition times as many.
inline constexpr double kStepUnits = 34;

// A path as the device traced it.
struct SeenPath {
    const Trail* trail = nullptr;
    Quantities first{};  // colour and first hit, without the sample's weight
    double weight = 1;   // of the sample, which the trail holds
    // False: traced by the reference through other numbers. Of the starts of rays, throughputs alone are then
    // compared.
    bool fromDevice = true;
};

// Trail of a record that includes its path.
Trail trailOf(const reference::PixelRecord& record);

// A path that takes more steps is undecided.
inline constexpr uint64_t kMostStepsOfPixel = 1 << 16;

struct Certificate {
    enum class Verdict { Holds, Fails, Undecided } verdict = Verdict::Fails;
    // Open decisions: steps that rounding decided; units: the greatest move of a ray for one of them, in
    // units of 2^-24.
    uint32_t openDecisions = 0;
    double units = 0;
    uint32_t decisions = 0;  // of a certificate that holds, as PixelRecord::decisions
    uint64_t steps = 0;      // of the reference
};

// Undecided: after `mostSteps`.
Certificate certify(const reference::Tracer& tracer, const PackedScene& scene,
                    const reference::Ray& cameraRay, const SeenPath& seen, uint64_t mostSteps);

}  // namespace glint::verify
