// Appearance of a surface point: texture coordinates, textures and environment, in double.
#pragma once

#include <glm/glm.hpp>

#include "reference/tracer.h"

namespace glint::reference {

// Texture coordinates and vertex colour of the hit that the rest of `surface` describes: of a triangle, and
// of all else by the object's frame, unless the primitive has brought its own.
void triangleAttributes(const Model& scene, const Hit& hit, Surface& surface);
void fillObjectUv(const Model& scene, const Ray& ray, const Hit& hit, Surface& surface);

// Keeps the coordinates of round bodies within 0 and the last float before 1: rounding must not begin the
// next repetition of an image at a cap, pole or seam. A longitude beyond the seam goes on at its other side.
void keepWithinImage(const Model& scene, Surface& surface);

// The surface's material, its colours times those of textures and vertices.
rows::Material materialAt(const Model& scene, const Surface& surface);

// Transmission of a surface of this medium (rows::Material::medium, not 0).
glm::dvec3 transmissionAt(const Model& scene, uint32_t medium, const Surface& surface);

// The greatest number, in local units, that a coordinate of a solid checker is a sum of: of the position, or
// of the way from the checker's corner to the object's origin.
double solidReach(const Model& scene, const Surface& surface);

// Hashes the cells of checkers and the texels of images without filtering. resolvedAlone: omits texels that
// rounding replaces by more than their neighbours.
uint32_t cellsAt(const Model& scene, const Surface& surface, bool resolvedAlone);

// True where the diffuse texture's alpha is below the material's alphaCutoff. noise: moves the alpha within
// the rounding of fp32's lookup, times its step.
bool holeAt(const Model& scene, const Surface& surface, const RayNoise& noise);

// Background radiance against `direction`. shift: added to the environment map's coordinates. `environment`:
// the tracer's.
glm::dvec3 surroundings(const Model& scene, const rows::Environment& environment, const glm::dvec3& direction,
                        const glm::dvec2& shift);

// Colour and alpha of a texture on a surface; white for number 0, no texture.
glm::dvec4 textureAt(const Model& scene, uint32_t number, const Surface& surface);

glm::dvec4 textureAt(const Model& scene, const rows::Texture& texture, const Surface& surface);

}  // namespace glint::reference
