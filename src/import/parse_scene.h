// The parts of a scene file as readers of its JSON tree; internal to the import module.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "import/json_cursor.h"
#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

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

// Same as the function of import/load.h, but does not read meshes again that `memory` holds.
Scene parseScene(const JsonValue& document, const std::string& name, const std::filesystem::path& folder,
                 SceneFiles& files, MeshMemory& memory);

// The document's cameras into `scene`, not yet validated.
void parseCameras(const JsonCursor& root, Scene& scene);

// Collects the errors of a scene file with their places in the text, so that it reports up to ten at once.
class SceneErrors {
  public:
    SceneErrors(const JsonValue& document, const std::string& name) : document_(document), name_(name) {}
    // Calls `read` and keeps the Error(Scene) that it throws.
    void attempt(const std::function<void()>& read);
    // Throws the errors so far as one, if there are any.
    void finish() const;

  private:
    std::string located(const std::string& message) const;

    const JsonValue& document_;
    const std::string& name_;
    std::vector<std::string> lines_;
};

// "meshes" and "objects". Mesh files are relative to `folder` and are read when an object first uses them.
// Materials are found by their names in `scene`.
void parseObjects(const JsonCursor& root, const std::string& name, const std::filesystem::path& folder,
                  SceneFiles& files, MeshMemory& memory, Scene& scene, SceneErrors& errors);

// The value of `type` for an "object", "light" or "camera"; fails if it is unknown.
std::string_view readType(const JsonCursor& type, std::string_view kind);

// The "transform" of an object: a list of steps, applied first to last, or 16 numbers by rows. The result is
// finite and has a condition number of at most kMaxCondition, else Error(Scene).
Affine parseTransform(const JsonCursor& transform);
// Throws the same error for a transform computed elsewhere. `context` ends the message and begins with a
// blank.
void checkTransform(const Affine& result, const JsonCursor& transform, const std::string& context);

// Colours that may be textures, and the environment map.
class TextureParser {
  public:
    // Textures are added to `scene`; image files are relative to `folder`.
    TextureParser(Scene& scene, const std::filesystem::path& folder, SceneFiles& files)
        : scene_(scene), folder_(folder), files_(files) {}

    // Reads the optional key as a colour, or as a texture and the colour it is multiplied with.
    void readColor(const JsonCursor& object, std::string_view key, Color& color, uint32_t& texture);
    // "background": a colour or an environment map.
    void readBackground(const JsonCursor& root);

  private:
    Texture parseImage(const JsonCursor& source);
    Texture parseChecker(const JsonCursor& source);
    std::shared_ptr<const Image> load(const JsonCursor& file);

    Scene& scene_;
    const std::filesystem::path& folder_;
    SceneFiles& files_;
};

}  // namespace glint
