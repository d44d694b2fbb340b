// Light from a source at a point, without shadows.
#pragma once

#include <glm/glm.hpp>

#include "reference/model.h"

namespace glint::reference {

struct LightSample {
    glm::dvec3 toLight{0};    // to the light's place, or the unit direction to one infinitely far away
    glm::dvec3 direction{0};  // unit
    double distance = 0;      // infinity for one infinitely far away
    bool valid = true;        // false: the light lies on the surface
};
LightSample sampleLight(const rows::Light& light, const glm::dvec3& position);

bool isSpot(const rows::Light& light);
// The part of its intensity that a light sends back along `toLight`, by the cone of a spot light.
double spotFactor(const rows::Light& light, const glm::dvec3& toLight);

// Radiance at this distance for a spotFactor of `part`.
glm::dvec3 intensityAt(const rows::Light& light, double distance, double part);

// Relative error of a spotFactor `part`, in units of 2^-24, for an error of `turn` units in the direction to
// the light; 0 outside a penumbra.
double spotError(const rows::Light& light, const glm::dvec3& toLight, double part, double turn);

}  // namespace glint::reference
