// Reflection of a light at a surface, and the rays that leave it. Written apart from
// shaders/shading/scatter.glsl, by the formulas of docs/reference/shading.md.
#pragma once

#include <glm/glm.hpp>

#include "core/vectors.h"
#include "reference/optics.h"
#include "reference/tracer.h"

namespace glint::reference {

// A hit as shading sees it: normals turned against the ray.
struct Interaction {
    Source source;
    glm::dvec3 position;
    glm::dvec3 n, s;          // geometric and shading normal, unit
    glm::dvec3 view;          // towards where the ray came from, unit
    double originScale;       // greatest coordinate of the ray's origin
    double scale;             // greatest number that a coordinate of the position is a sum of
    double offset;            // bound on the error of `position` along n
    double clearance;         // how far along n the device's rays begin (error_box.h)
    double normalError;       // see rounding.h
    bool entering;            // the ray comes from the outer side
    rows::Material material;  // times its textures
    glm::dvec3 transmission;  // of a dielectric, times its texture
    Crossing crossing;
};

// Origin of a ray that leaves the surface towards `direction`, on the side that it points to.
glm::dvec3 offsetOrigin(const Interaction& at, const glm::dvec3& direction);

// ---- Light that the surface sends back along the ray

// The part of a light's, and what rounding may make of it, see rounding.h.
struct Reflection {
    glm::dvec3 part{0}, error{0};
    bool faces = false;      // the light is on the side that is seen
    bool highlight = false;  // and Blinn's term is not 0
};
// Lambert's and Blinn's terms for a light from `toLight`, a unit vector good to `turn` units of 2^-24. Where
// the light's cosine is too small for its sign to be known, the error is all that the light could bring.
Reflection evaluate(const Interaction& at, const glm::dvec3& toLight, double turn);

// ---- Rays that go on

// The mirrored direction, unit.
glm::dvec3 mirrored(const Interaction& at);

// A reflected ray, on the ray's side of the surface, and a refracted one, on the other. Directions are unit
// vectors; what the rays bring counts by their weights.
struct Scattering {
    bool reflects = false, refracts = false;
    glm::dvec3 reflected{0}, refracted{0};
    glm::dvec3 reflectedWeight{0}, refractedWeight{0};
    double weightError = 0;  // absolute, beside kProductRoundings of a weight
};
Scattering scatteringAt(const Model& scene, const Interaction& at);

}  // namespace glint::reference
