// Dielectrics for the reference: lists of media, and what a surface does to a ray. Formulas in
// docs/reference/shading.md.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/model.h"

namespace glint::reference {

// The media that a ray is inside of, oldest first; numbers as in rows::Material::medium.
using Media = std::vector<uint32_t>;

Media mediaAtEye(const rows::Environment& environment);

// The one that counts: of the greatest priority the one entered last. 0, air, of none.
uint32_t rulingMedium(const Model& scene, const Media& media);

double iorOf(const Model& scene, uint32_t medium);
glm::dvec3 attenuationOf(const Model& scene, uint32_t medium);

// Transmittance of a path of `length` through a medium, by Beer's law.
glm::dvec3 transmittance(const Model& scene, uint32_t medium, double length);

struct Crossing {
    Media before, after;
    uint32_t mediumBefore = 0, mediumAfter = 0;
    bool counts = true;    // false: the surface lies inside a medium of greater priority
    bool crowded = false;  // a medium found no room in the list
};

// A ray inside `media` meets a surface of `medium` (0: no dielectric).
Crossing crossingAt(const Model& scene, const Media& media, uint32_t medium, bool entering);

// The two rays that a surface between different media makes of one.
struct Split {
    bool total = false;                     // all light is reflected
    double reflectance = 0;                 // of unpolarised light
    glm::dvec3 reflected{0}, refracted{0};  // unit
};

// d: unit; n: geometric, s: shading normal, unit, against d; ratio: the refractive index on d's side over
// that behind the surface.
Split splitAt(const glm::dvec3& d, const glm::dvec3& n, const glm::dvec3& s, double ratio);

}  // namespace glint::reference
