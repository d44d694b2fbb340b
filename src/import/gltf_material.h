// Converts glTF's metallic-roughness materials, and the older specular-glossiness ones, to Whitted's model by
// the formulas of docs/reference/file-formats.md.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/image.h"
#include "import/gltf_file.h"
#include "scene/scene.h"

namespace glint {

// Transform of texture coordinates as glTF counts them: u' = u u.x + v v.x + shift.x, and so on.
struct GltfUvTransform {
    glm::dvec2 u{1, 0}, v{0, 1}, shift{0};
    glm::dvec2 operator()(const glm::dvec2& uv) const { return uv.x * u + uv.y * v + shift; }
    bool operator==(const GltfUvTransform&) const = default;
};

class GltfMaterials {
  public:
    // Appends each material and its textures to `scene` at its first use. With `ambientIsEmission` (the file
    // has lights of its own) the ambient light is 1 and shows only what surfaces emit; otherwise
    // scene.ambient lights all surfaces.
    GltfMaterials(GltfFile& file, Scene& scene, bool ambientIsEmission)
        : file_(file), scene_(scene), ambientIsEmission_(ambientIsEmission) {}

    struct Use {
        uint32_t material = 0;                       // into scene.materials
        size_t texCoord = 0;                         // which TEXCOORD_n its textures go by
        bool needsTexCoord = false;                  // it has textures
        std::optional<GltfUvTransform> turned = {};  // texture coordinates, first
    };
    // Material of a primitive; without a reference, glint's default material.
    Use use(const std::optional<JsonCursor>& reference);

    // True if a converted material emits light.
    bool anyEmission() const { return anyEmission_; }

  private:
    struct Surface;
    struct Reference {
        uint32_t texture = Material::kNoTexture;
        size_t texCoord = 0;
        std::optional<GltfUvTransform> turned = {};  // KHR_texture_transform with a rotation
    };
    struct Means {          // of a picture
        double numbers[4];  // as they stand in the file; the last one is alpha
        Color color{0};     // linear
    };
    Use convert(size_t index);
    void readBase(const JsonCursor& material, Surface& surface);
    void readMetallicRoughness(const JsonCursor& pbr, Surface& surface);
    void readSpecularGlossiness(const JsonCursor& pbr, Surface& surface);
    void readBaseTexture(const JsonCursor& pbr, std::string_view key, Surface& surface);
    void readEmission(const JsonCursor& material, Surface& surface);
    void readTransmission(const JsonCursor& material, Surface& surface);
    void applyAlpha(const JsonCursor& material, Surface& surface);
    Material whitted(const Surface& surface);
    void setAmbient(const Surface& surface, Material& material);
    void noteTexCoord(const Reference& reference, Surface& surface);

    Reference texture(const JsonCursor& info);
    Texture sampled(const JsonCursor& texture, std::shared_ptr<const Image> image);
    std::optional<size_t> imageOf(const JsonCursor& info);
    std::shared_ptr<const Image> image(size_t index);
    // Nothing for an image that cannot be read.
    std::optional<Means> means(const JsonCursor& info);
    double mean(const JsonCursor& info, int channel);

    GltfFile& file_;
    Scene& scene_;
    bool ambientIsEmission_;
    bool anyEmission_ = false;
    std::optional<uint32_t> default_;
    std::map<size_t, Use> uses_;
    std::map<size_t, std::shared_ptr<const Image>> images_;
    std::map<std::string, std::shared_ptr<const Image>> byUri_;
    std::map<size_t, Means> means_;
};

// Mesh `index`, with a material for each triangle; nothing if it has no triangles. What is not read is warned
// about. Throws Error(Scene).
std::shared_ptr<const Mesh> readGltfMesh(GltfFile& file, GltfMaterials& materials, size_t index);

}  // namespace glint
