#include "view/pace.h"

#include <algorithm>
#include <cmath>

namespace glint::view {

namespace {
// Weight of the newest frame: three frames follow a change to 94 %, one slow frame is forgotten as soon.
constexpr double kNewest = 0.6;
// Before the first measurement: a quarter of the pixels.
constexpr double kFirstScale = 0.5;
// Sizes in steps of 1/16, so that the picture does not swim with every frame.
constexpr double kSteps = 16;
// Without anything else in the way, rendering still gets this part of a frame.
constexpr double kLeastShare = 0.3;
}  // namespace

void Pace::measured(double pixels, double renderSeconds, double otherSeconds) {
    const double fresh = renderSeconds / std::max(pixels, 1.0);
    const double weight = secondsPerPixel_ > 0 ? kNewest : 1.0;
    secondsPerPixel_ += weight * (fresh - secondsPerPixel_);
    other_ += weight * (otherSeconds - other_);
}

double Pace::scale(double fullPixels) const {
    if (secondsPerPixel_ <= 0) return kFirstScale;
    const double budget = std::max(target_ - other_, kLeastShare * target_);
    const double wanted = std::sqrt(budget / (secondsPerPixel_ * std::max(fullPixels, 1.0)));
    return std::clamp(std::floor(wanted * kSteps) / kSteps, kLeast, 1.0);
}

int Pace::depth(int maxDepth, double fullPixels) const {
    const double s = scale(fullPixels);
    const int bound = s >= 0.75 ? maxDepth : s >= 0.4 ? 2 : 1;
    return std::min(maxDepth, bound);
}

}  // namespace glint::view
