// The "objects" of a scene file and what they refer to.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "import/importers.h"
#include "import/json_cursor.h"
#include "import/scene_files.h"
#include "import/scene_keys.h"
#include "scene/scene.h"

namespace glint {

// The "type" of a light, camera or object; fails for one that is unknown or not yet supported.
std::string_view readType(const JsonCursor& type, const keys::TypeTable& table);

// Mesh files that were read, for scenes that are parsed again with other numbers.
struct MeshMemory {
    struct Read {
        std::vector<Material> materials;
        std::vector<Texture> textures;  // that the materials index, from 0
        std::vector<std::string> warnings;
        // Indexes the materials from `firstMaterial` on.
        std::shared_ptr<const Mesh> mesh;
        uint32_t firstMaterial = 0;
    };
    std::map<std::filesystem::path, Read> files;
};

class ObjectParser {
  public:
    // `meshes` is the scene's object of that name, if any; files are loaded when an object first uses them,
    // relative to `folder`. Materials are found by their names in `scene`, from index 0.
    ObjectParser(Scene& scene, const std::string& file, const std::filesystem::path& folder,
                 SceneFiles& files, MeshMemory& memory, const JsonCursor* meshes);

    // Appends the object, or those of a group, to the scene.
    void parse(const JsonCursor& object) { parse(object, {}); }
    void warnOfUnusedMeshes();

  private:
    struct LoadedMesh {
        std::shared_ptr<const Mesh> own;    // with the file's materials, if it names some
        std::shared_ptr<const Mesh> plain;  // without
        uint32_t material = 0;              // the first of the file's materials in the scene
    };

    // Settings that an object inherits from the groups around it.
    struct Surrounding {
        std::optional<Affine> transform;
        std::optional<uint32_t> material;  // of objects that name none
        size_t depth = 0;
    };

    void parse(const JsonCursor& object, const Surrounding& around);
    void parseGroup(const JsonCursor& group, const Surrounding& around);
    Shape parseShape(const JsonCursor& object, std::string_view type);
    std::shared_ptr<const Mesh> parseMesh(const JsonCursor& object, uint32_t& material);
    LoadedMesh& load(const JsonCursor& name);
    LoadedMesh readMesh(const std::filesystem::path& path);
    const MeshMemory::Read& remembered(const std::filesystem::path& path);
    uint32_t findMaterial(const JsonCursor& name) const;
    uint32_t defaultMaterial();

    Scene& scene_;
    const std::string& file_;
    const std::filesystem::path& folder_;
    SceneFiles& files_;
    MeshMemory& memory_;
    const JsonCursor* meshes_;
    std::map<std::string_view, size_t> meshNames_;  // and which members of that they are
    std::map<std::string, uint32_t, std::less<>> materials_;
    std::map<std::string, std::shared_ptr<LoadedMesh>, std::less<>> loaded_;  // by name
    std::map<std::filesystem::path, std::shared_ptr<LoadedMesh>> byFile_;     // several names may share one
    uint32_t default_ = Mesh::kNoIndex;
};

}  // namespace glint
