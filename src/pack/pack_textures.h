// Textures, texture coordinates and vertex colours on their way into the packed arrays.
#pragma once

#include <cstdint>
#include <functional>

#include "pack/packed_scene.h"

namespace glint {

// The rows that a triangle of this material has in PackedScene::vertexAttributes, as shared::kAttribute...
// flags; 0: none. Coordinates are kept only where the material has a texture.
uint32_t attributeFlags(const Scene& scene, const Mesh* mesh, uint32_t face, uint32_t material);
bool hasTexture(const Material& material);
uint32_t attributeRows(uint32_t flags);
void writeAttributes(const Mesh& mesh, uint32_t face, uint32_t flags, shared::VertexAttribute* rows);

// Fills textures, texels and object frames for the materials that `used` holds true and for the environment
// map, and the indices and features that go with them. packed.materials are there already. Throws
// Error(Scene) naming the array, its size and the limit if there are too many texels.
void packTextures(const Scene& scene, const std::function<bool(size_t)>& used, PackedScene& packed,
                  const Context& context);

}  // namespace glint
