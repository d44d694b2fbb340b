// The container of glTF 2.0 (Khronos, The glTF 2.0 Specification, 2021): JSON, buffers, references.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import/json_document.h"
#include "import/scene_files.h"
#include "import/text_scanner.h"
#include "scene/scene.h"

namespace glint {

// Numbers of an accessor.
struct GltfNumbers {
    size_t components = 1;  // of each element
    std::vector<double> values;

    size_t count() const { return values.size() / components; }  // elements
};

// Its cursors must not outlive it. All functions throw Error(Scene) "FILE: /POINTER: what".
class GltfFile {
  public:
    // Reads .gltf or .glb, by the first bytes, and checks the version and the required extensions.
    GltfFile(const std::filesystem::path& path, SceneFiles& files);
    GltfFile(const GltfFile&) = delete;
    GltfFile& operator=(const GltfFile&) = delete;

    const std::string& name() const { return name_; }
    JsonCursor root() const { return {document_, name_}; }
    JsonValue& document() { return document_; }
    // The lists of the document ("nodes"), and "lights" of KHR_lights_punctual, whose items others refer to
    // by index. `index` must be below count.
    size_t count(std::string_view list) const;
    JsonCursor item(std::string_view list, size_t index) const;
    // The index at `reference`, or its item; both fail if the list has no such item.
    size_t index(std::string_view list, const JsonCursor& reference) const;
    JsonCursor at(std::string_view list, const JsonCursor& reference) const {
        return item(list, index(list, reference));
    }

    // Bytes of item `view` of bufferViews. External files are read, and compressed views decoded, on first
    // use.
    std::string_view bufferView(size_t view);
    // Accessors whose numbers were compressed on their own; null for all others.
    const GltfNumbers* decoded(size_t accessor) const;
    void setDecoded(size_t accessor, GltfNumbers numbers) { decoded_[accessor] = std::move(numbers); }
    // Contents of a "uri": decoded base64 of a data: URI, or the bytes of the named file. An image may also
    // be the file of that name beside the model.
    std::string readUri(const JsonCursor& uri, bool picture = false);

    // For SceneFiles::take.
    SceneFiles& files() { return files_; }

    template <typename... Parts>
    void warn(const Parts&... what) {
        warnings_.add(what...);
    }
    // The same for an error that only needs a warning: "what; `consequence`".
    void warnOf(const std::exception& error, const std::string& consequence);
    std::vector<std::string> takeWarnings() { return std::move(lines_); }

  private:
    void openBinary();
    const std::optional<JsonCursor>& find(std::string_view list) const;
    void checkHeader();
    std::string_view buffer(size_t index);
    std::string_view range(const JsonCursor& object);  // bytes of a buffer, as a view or extension gives them

    SceneFiles& files_;
    std::filesystem::path folder_;
    std::string name_;
    std::string bytes_;
    std::string_view text_;                   // the JSON, within bytes_
    std::optional<std::string_view> binary_;  // the BIN chunk of a .glb, within bytes_
    JsonValue document_;
    std::vector<std::shared_ptr<const std::string>> buffers_;
    std::map<std::string, std::shared_ptr<const std::string>> byUri_;  // several buffers may share one
    std::map<size_t, std::string> views_;                              // those that were compressed
    // Lists by name, as a file may have many keys unknown to glint.
    mutable std::map<std::string, std::optional<JsonCursor>> lists_;
    std::map<size_t, GltfNumbers> decoded_;
    std::vector<std::string> lines_;  // of warnings_
    FileWarnings warnings_;
};

// A byte count or offset: a whole number from 0 to 2^53.
uint64_t gltfSize(const JsonCursor& object, std::string_view key, uint64_t missing);

// The object of this extension, if `object` has it.
std::optional<JsonCursor> extensionOf(const JsonCursor& object, std::string_view name);

// ---- Numbers behind accessors (specification, section 3.6.2)

// Accessor `index`: of any component type, interleaved or not, normalised integers as fractions, with its
// sparse substitutions. `types` are the element types that the caller accepts ("VEC3"). Throws Error(Scene)
// for other types and for an accessor that does not fit its buffer view.
GltfNumbers readAccessor(GltfFile& file, size_t index, std::initializer_list<std::string_view> types);

// The same for vertex indices: SCALAR, of an unsigned type.
std::vector<uint32_t> readIndexAccessor(GltfFile& file, size_t index);

// ---- Compressed geometry, by libraries that not every build has (gltf_compression.cpp)

// True if this build reads geometry compressed by Draco (KHR_draco_mesh_compression).
bool readsDraco();

// The bytes of a buffer view with EXT_meshopt_compression (or KHR_, the same), whose object is `extension`,
// from `compressed`. Throws Error(Scene) if they are damaged or the build does not read them.
std::string decodeMeshopt(GltfFile& file, const JsonCursor& extension, std::string_view compressed);

// Decodes the Draco geometry of a primitive, whose extension object is `extension`, for readAccessor: the
// accessors of its attributes and indices have no data of their own. Throws Error(Scene).
void decodeDraco(GltfFile& file, const JsonCursor& primitive, const JsonCursor& extension);

// ---- Materials, from metallic-roughness and the older specular-glossiness to Whitted's model by the
// formulas of docs/reference/file-formats.md (gltf_material.cpp), and meshes (gltf_mesh.cpp)

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
