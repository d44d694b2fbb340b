// The parts of a scene file as readers of its JSON tree; internal to the import module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "import/json_document.h"
#include "import/readers.h"
#include "import/scene_files.h"
#include "scene/keyframes.h"
#include "scene/scene.h"

namespace glint {

// Mesh files that were read, for scenes that are parsed again with other numbers: by file, and by the place
// of its first material in the scene, from which on the mesh indexes materials.
using MeshMemory = std::map<std::pair<std::filesystem::path, uint32_t>, std::shared_ptr<const ImportedMesh>>;

// Parses a scene file, but does not read meshes again that `memory` holds.
Scene parseScene(const JsonValue& document, const std::string& name, const std::filesystem::path& folder,
                 SceneFiles& files, MeshMemory& memory);

// Adds the document's cameras to `scene`, which has none; not yet validated.
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

// Shared by the parsers of a scene file's parts.
struct SceneParsing {
    const std::string& name;              // of the file, for messages
    const std::filesystem::path& folder;  // where relative paths start
    SceneFiles& files;
    MeshMemory& memory;
    SceneErrors& errors;
    Scene& scene;  // the result
};

// "meshes" and "objects". Mesh files are read when an object first uses them. Materials are found by their
// names in the scene.
void parseObjects(const JsonCursor& root, const SceneParsing& in);

// ---- The keys of each object of a scene file. The parser refuses all others; a test compares
// scenes/scene.schema.json with these tables.

struct KeyTable {
    std::string_view what;  // the path of the object in the schema, e.g. "object/sphere"
    std::vector<std::string_view> keys;
};

// The tables of "objects" and of all parts.
std::span<const KeyTable> objectKeys();
const std::vector<KeyTable>& keyTables();

// The values of "type" of an "object", "light" or "camera".
std::vector<std::string_view> typesOf(std::string_view kind);

// Fails at a key that the table of this name lacks.
void expectKeys(const JsonCursor& object, std::string_view what);

// The value of `type` for an "object", "light" or "camera"; fails if it is unknown.
std::string_view readType(const JsonCursor& type, std::string_view kind);

// ---- Numbers of a JSON file itself that change with time: "animation", and the nodes of glTF

// One value of the file over time.
struct AnimationTrack {
    std::vector<std::string> steps;  // of the JSON pointer (RFC 6901) of the value, unescaped
    Keyframes keyframes;
    bool isList = false;  // the value is a list of numbers, else one number
    bool movesCamera() const { return steps.front() == "camera" || steps.front() == "cameras"; }
};

struct Animation {
    double framesPerSecond = 24;
    std::vector<AnimationTrack> tracks;
};

// The animation of the document whose root is given, without any track if it has none. Throws Error(Scene)
// for what cannot be animated or is not there.
Animation parseAnimation(const JsonCursor& root);

// The span of the keyframes of all tracks, one or more.
AnimationSpan spanOf(const std::vector<AnimationTrack>& tracks, double framesPerSecond);

TrackValues valuesAt(const std::vector<AnimationTrack>& tracks, double time);

// Puts the values of an animation's tracks into the document that the animation is of.
void setValues(JsonValue& document, const std::vector<AnimationTrack>& tracks, const TrackValues& values);

}  // namespace glint
