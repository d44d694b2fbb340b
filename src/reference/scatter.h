// Light at a surface: light that arrives from media and lights, scattered light, and the rays that leave.
// Formulas in docs/reference/shading.md; written apart from shaders/shading.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "reference/tracer.h"

namespace glint::reference {

// ---- Media

Media mediaAtEye(const rows::Environment& environment);

// The one that counts: of the greatest priority the one entered last. 0, air, of none.
uint32_t rulingMedium(const Model& scene, const Media& media);

glm::dvec3 attenuationOf(const Model& scene, uint32_t medium);

// Transmittance of a path of `length` through a medium, by Beer's law.
glm::dvec3 transmittance(const Model& scene, uint32_t medium, double length);

struct Crossing {
    Media before, after;
    uint32_t mediumBefore = 0, mediumAfter = 0;
    bool counts = true;    // false: the surface lies inside a medium of greater priority
    bool crowded = false;  // a medium found no room in the list
};

// A ray inside `media` hits a surface of `medium` (0: no dielectric).
Crossing crossingAt(const Model& scene, const Media& media, uint32_t medium, bool entering);

// The two rays that a surface between different media makes of one.
struct Split {
    bool total = false;                     // all light is reflected
    double reflectance = 0;                 // of unpolarised light
    glm::dvec3 reflected{0}, refracted{0};  // unit
};

// d: unit; n: geometric, s: shading normal, unit, against d; ratio: the refractive index on d's side over
// that behind the surface. noise: the rounding error of refraction as a part of its bound, times 2^-24;
// turn: the error of the ray's cosine in units of 2^-24.
Split splitAt(const glm::dvec3& d, const glm::dvec3& n, const glm::dvec3& s, double ratio, double noise = 0,
              double turn = 0);

// ---- Lights, without shadows

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

// ---- Surfaces

// A hit for shading: normals turned against the ray.
struct Interaction {
    Source source;
    glm::dvec3 position;
    glm::dvec3 n, s;          // geometric and shading normal, unit
    glm::dvec3 view;          // towards where the ray came from, unit
    double originScale;       // greatest coordinate of the ray's origin
    double scale;             // greatest number that a coordinate of the position is a sum of
    double offset;            // bound on the error of `position` along n
    double clearance;         // how far along n the device's rays begin (rounding.h)
    double normalError;       // see rounding.h
    bool entering;            // the ray comes from the outer side
    rows::Material material;  // times its textures
    glm::dvec3 transmission;  // of a dielectric, times its texture
    Crossing crossing;
};

// Origin of a ray that leaves the surface towards `direction`, on the side that it points to.
glm::dvec3 offsetOrigin(const Interaction& at, const glm::dvec3& direction);

// ---- Light that the surface sends back along the ray

// The part of a light's.
struct Reflection : RoundedColor {
    bool faces = false;      // the light is on the ray's side
    bool highlight = false;  // and Blinn's term is not 0
};
// Lambert's and Blinn's terms for a light from `toLight`, a unit vector good to `turn` units of 2^-24. If
// rounding decides whether a cosine exceeds kLeastCosine, the error includes all that a light at this cosine
// adds.
Reflection evaluate(const Interaction& at, const glm::dvec3& toLight, double turn);

// ---- Rays that go on

// A reflected ray, on the ray's side of the surface, and a refracted one, on the other. Directions are unit
// vectors; what the rays bring counts by their weights.
struct Scattering {
    bool reflects = false, refracts = false;
    glm::dvec3 reflected{0}, refracted{0};
    RoundedColor reflectedWeight, refractedWeight;
};
// noise: rounding error of refraction in units of its bound, times 2^-24 (up to Jitter::ulps of them).
Scattering scatteringAt(const Model& scene, const Interaction& at, double noise);

}  // namespace glint::reference
