#include "reference/light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/shading.h"

namespace glint::reference {

using glm::dvec3;

LightSample sampleLight(const rows::Light& light, const dvec3& position) {
    const bool directional = light.kind == shared::kLightDirectional;
    LightSample s;
    s.toLight = directional ? dvec3(light.position) : dvec3(light.position) - position;
    const double length = glm::length(s.toLight);
    s.direction = s.toLight / length;
    s.distance = directional ? std::numeric_limits<double>::infinity() : length;
    s.valid = directional || length >= static_cast<double>(shared::kNearestLight);
    return s;
}

bool isSpot(const rows::Light& light) {
    return light.kind == shared::kLightSpot || light.kind == shared::kLightSpotInverseSquare;
}

// smoothstep(cos(angle + penumbra), cos(angle), c), c the cosine at the light between its axis and the way to
// the surface; without a penumbra a step.
double spotFactor(const rows::Light& light, const dvec3& toLight) {
    if (!isSpot(light)) return 1;
    const double c = -glm::dot(glm::normalize(dvec3(light.axis)), glm::normalize(toLight));
    const double full = 1 - static_cast<double>(light.inner), none = 1 - static_cast<double>(light.outer);
    if (c >= full || full <= -1) return 1;  // a cone of 180 degrees is everything
    if (c <= none) return 0;
    const double x = (c - none) / (full - none);
    return (3 - 2 * x) * x * x;
}

dvec3 intensityAt(const rows::Light& light, double distance, double part) {
    const bool fades =
        light.kind == shared::kLightPointInverseSquare || light.kind == shared::kLightSpotInverseSquare;
    return part / (fades ? distance * distance : 1) * dvec3(light.intensity);
}

// 1 - cos of an angle a errs by a times what the directions are off, the smoothstep by 3/2 of that over the
// width of the penumbra.
double spotError(const rows::Light& light, const dvec3& toLight, double part, double turn) {
    if (part >= 1) return 0;
    const double cone = 1 + glm::dot(glm::normalize(dvec3(light.axis)), toLight);
    const double width = std::max(static_cast<double>(light.outer - light.inner), 1e-30);
    const double blur = 1.5 * (std::sqrt(2 * cone) * (turn + 4) + 4 * cone) / width;
    return std::min(blur, 0x1p24) / part;
}

}  // namespace glint::reference
