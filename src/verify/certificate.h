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

// Units of 2^-24 that a ray may be moved by in one step: 10 on each of two axes for the triangle test (PBRT
// 4th ed., 6.8.7) and 14 for the origin, as parts of the greatest coordinate involved. In an instance as many
// times its condition more.
inline constexpr double kStepUnits = 34;

// True if the first hit and the colour lie within the shading bounds of the reference's answer, or within
// kResponseGain times its response to a few moves of one unit.
bool isPredicted(const reference::Tracer& tracer, const reference::Ray& cameraRay,
                 const reference::PixelRecord& still, const PackedScene& scene, const Quantities& device);

// A path as the device traced it.
struct SeenPath {
    const Trail* trail = nullptr;
    Quantities first{};      // colour and first hit, without the sample's weight
    double weight = 1;       // of the sample, which the trail holds
    bool fromDevice = true;  // false: by the reference, of other numbers; then starts of rays are not judged
};

// Trail of a record that includes its path.
Trail trailOf(const reference::PixelRecord& record);

// Beyond so many steps a path is undecided.
inline constexpr uint64_t kMostStepsOfPixel = 1 << 16;

struct Certificate {
    enum class Verdict { Holds, Fails, Undecided } verdict = Verdict::Fails;
    // Steps at which rounding decided, and the greatest move, in units of 2^-24, that one of them took.
    uint32_t openDecisions = 0;
    double units = 0;
    uint32_t decisions = 0;  // of a certificate that holds, as PixelRecord::decisions
    uint64_t steps = 0;      // steps of the reference that this took
};

// Undecided: after `mostSteps`.
Certificate certify(const reference::Tracer& tracer, const PackedScene& scene,
                    const reference::Ray& cameraRay, const SeenPath& seen, uint64_t mostSteps);

}  // namespace glint::verify
