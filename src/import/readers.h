// The file readers behind importMesh and loadScene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/importers.h"
#include "import/scene_files.h"

namespace glint {

// All of them read through `files`, which knows what may be read and how much.
ImportedMesh readObj(const std::filesystem::path& path, SceneFiles& files);
ImportedMesh readPly(const std::filesystem::path& path, SceneFiles& files);
ImportedMesh readStl(const std::filesystem::path& path, SceneFiles& files);

// A scene that another program wrote. Without a camera of its own scene.camera means nothing; without lights
// scene.lights is empty. Not yet validated.
struct ImportedScene {
    Scene scene;
    bool hasCamera = false;
};

// docs/reference/file-formats.md lists what is read, how it is mapped and what only causes a warning. Both
// functions throw Error(Scene) "FILE:LINE: ..." (NFF), "FILE: /JSON/POINTER: ..." (glTF).
ImportedScene readNff(const std::filesystem::path& path, SceneFiles& files);
ImportedScene readGltf(const std::filesystem::path& path, SceneFiles& files);

// Adds a camera and lights if an imported scene lacks them, and validates the scene.
Scene completed(ImportedScene imported, const std::filesystem::path& path, const SceneFiles& files);

// Throws Error(Argument) if the options name an axis that points up, for a file with a camera.
void checkUpIsOpen(const SceneFiles& files, const std::string& name);

// Chooses the camera of that name; without a name, warns if a scene of another program has several.
void settleCamera(Scene& scene, const std::filesystem::path& path, const std::string& camera);

// The mesh objects of `scene` as one mesh in world space, with the scene's materials and warnings.
ImportedMesh flattened(Scene scene);

// Appends the materials of an MTL file with this text, and the textures that they index. What is read and
// what is only warned about: docs/reference/file-formats.md. Throws Error(Scene) for text that is not a
// number.
void readMtl(const std::string& text, const std::filesystem::path& path, SceneFiles& files,
             std::vector<Material>& materials, std::vector<Texture>& textures,
             std::vector<std::string>& warnings);

}  // namespace glint
