// The primitives and the tree of a scene, or of a prototype of its instances; internal to the packing.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "pack/primitives.h"

namespace glint {

class Instances;

// Fills the arrays of nodes and primitives, the bounds, the statistics and the warnings.
void packGeometry(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, uint32_t maxLevels,
                  const PackOptions& options, const Context& context, PackedScene& packed,
                  Materials& materials);

// Packs the planes again, near packed.geometry and the camera.
void packPlanes(const Scene& scene, const PrimitiveNumbers& numbers, PackedScene& packed);

// packScene for a placed scene. `instances`: its instances, still to be placed.
PackedScene packPlaced(const Scene& scene, const PrimitiveNumbers& numbers, Instances& instances,
                       const PackOptions& options, const Context& context);

// True if light passes through some material.
bool anyTransmits(const Scene& scene);

// Features of the arrays and of the materials in use. packTextures has added its own; packScene adds those of
// the camera and of shadows.
SceneFeatures featuresOf(const PackedScene& packed, const Materials& materials, const Context& context);

// True if a triangle is so narrow that rounding may report a hit behind a ray's origin.
bool haveSlivers(const std::vector<shared::Triangle>& triangles, const Context& context);

}  // namespace glint
