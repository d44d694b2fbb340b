#include "view/tone.h"

#include <algorithm>
#include <cmath>

#include "core/quantize.h"

namespace glint::view {

glm::dvec3 toneMapped(const glm::dvec3& color, ToneMap toneMap) {
    if (toneMap == ToneMap::Reinhard) return color / (1 + std::max(luminance(color), 0.0));
    if (toneMap == ToneMap::Aces) {
        const glm::dvec3 x = glm::max(color, glm::dvec3(0));
        return glm::clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    }
    return color;
}

double falseColorOf(double luminance) {
    if (!(luminance > 0)) return 0;
    return std::clamp(0.5 + 0.5 * std::log2(luminance) / kFalseStops, 0.0, 1.0);
}

glm::dvec3 heatOf(double x) {
    const double at = 4 * std::clamp(x, 0.0, 1.0);
    const auto ramp = [](double v) { return std::clamp(v, 0.0, 1.0); };
    return {ramp(at - 2), at < 2 ? ramp(at) : ramp(4 - at), ramp(2 - at)};
}

glm::dvec3 heatLinear(double x) {
    const glm::dvec3 heat = heatOf(x);
    return {linearFromSrgb(heat.x), linearFromSrgb(heat.y), linearFromSrgb(heat.z)};
}

}  // namespace glint::view
