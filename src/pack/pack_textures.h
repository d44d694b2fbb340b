// Textures, texture coordinates and vertex colours on their way into the packed arrays.
#pragma once

#include "pack/packed_scene.h"

namespace glint {

class Materials;

// Fills textures, texels and object frames for the materials in use and for the environment map, and the
// indices and features that go with them. packed.materials are there already. Throws Error(Scene) naming the
// array, its size and the limit if there are too many texels.
void packTextures(const Scene& scene, const Materials& materials, PackedScene& packed,
                  const Context& context);

// How a set of textures repeats along an axis: the least period of all of them, and the shortest period of
// any. Without a common period both are 0.
struct Repeats {
    double common = 0, shortest = 0;
};

// Origin of the cubes of a scene's solid checkers, in the space of every object: a corner of the first
// checker, so that only differences are rounded. `repeats`: of the cubes along each axis.
struct CubeOrigin {
    glm::dvec3 corner{0};
    Repeats repeats;
};

// From local coordinates, which start at `origin`, to an object's own, and to the texture coordinates of flat
// ones. The object's own are given from cubes.corner on, and in the common period around it of all solid
// checkers that it shows. The (u, v) of flat shapes is as docs/reference/shading.md has it;
// that of others is left 0.
shared::ObjectFrame objectFrame(const Scene& scene, const Object& object, const glm::dvec3& origin,
                                const CubeOrigin& cubes);

}  // namespace glint
