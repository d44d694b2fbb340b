// Converts glTF's metallic-roughness materials, and the older specular-glossiness ones, to Whitted's model by
// the formulas of docs/reference/file-formats.md.
#pragma once

#include <memory>
#include <optional>

#include "import/gltf_file.h"
#include "scene/scene.h"

namespace glint {

// Transform of texture coordinates as glTF counts them: u' = u u.x + v v.x + shift.x, and so on.
struct GltfUvTransform {
    glm::dvec2 u{1, 0}, v{0, 1}, shift{0};
    glm::dvec2 operator()(const glm::dvec2& uv) const { return uv.x * u + uv.y * v + shift; }
    bool operator==(const GltfUvTransform&) const = default;
};

// Converts the materials of a file at their first use.
class GltfMaterials {
  public:
    struct Use {
        uint32_t material = 0;                       // into scene.materials
        size_t texCoord = 0;                         // which TEXCOORD_n its textures go by
        bool needsTexCoord = false;                  // it has textures
        std::optional<GltfUvTransform> turned = {};  // texture coordinates, first
    };

    virtual ~GltfMaterials() = default;
    // Material of a primitive; without a reference, glint's default material.
    virtual Use use(const std::optional<JsonCursor>& reference) = 0;
    // True if a converted material emits light.
    virtual bool anyEmission() const = 0;
};

// Materials and their textures are appended to `scene`. With `ambientIsEmission` (the file has lights of its
// own) the ambient light is 1 and shows only what surfaces emit; otherwise scene.ambient lights all surfaces.
std::unique_ptr<GltfMaterials> gltfMaterials(GltfFile& file, Scene& scene, bool ambientIsEmission);

// Mesh `index`, with a material for each triangle; nothing if it has no triangles. What is not read is warned
// about. Throws Error(Scene).
std::shared_ptr<const Mesh> readGltfMesh(GltfFile& file, GltfMaterials& materials, size_t index);

}  // namespace glint
