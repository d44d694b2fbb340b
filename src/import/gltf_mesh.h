// The primitives of a glTF mesh as one Mesh.
#pragma once

#include "import/gltf_file.h"
#include "import/gltf_material.h"
#include "scene/scene.h"

namespace glint {

// Mesh `index`, with a material for each triangle; nothing if it has no triangles. What is not read is warned
// about. Throws Error(Scene).
std::shared_ptr<const Mesh> readGltfMesh(GltfFile& file, GltfMaterials& materials, size_t index);

}  // namespace glint
