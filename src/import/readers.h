// The file readers behind importMesh and loadScene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "import/load.h"
#include "import/scene_files.h"

namespace glint {

// Each reads through `files`, which limits the files and the memory.
ImportedMesh readObj(const std::filesystem::path& path, SceneFiles& files);
ImportedMesh readPly(const std::filesystem::path& path, SceneFiles& files);
ImportedMesh readStl(const std::filesystem::path& path, SceneFiles& files);

// A scene that another program wrote, not yet validated. scene.camera is valid only if hasCamera.
struct ImportedScene {
    Scene scene;
    bool hasCamera = false;
};

// docs/reference/file-formats.md describes the mapping and the warnings. Throws Error(Scene) "FILE:LINE:
// ...".
ImportedScene readNff(const std::filesystem::path& path, SceneFiles& files);

// Appends the materials of an MTL file with this text, and the textures that they index
// (docs/reference/file-formats.md). Throws Error(Scene) for text in the place of a number.
void readMtl(const std::string& text, const std::filesystem::path& path, SceneFiles& files,
             std::vector<Material>& materials, std::vector<Texture>& textures,
             std::vector<std::string>& warnings);

// A white material with this image as its diffuse texture, as a PLY file names it; nothing, with a warning,
// if the image cannot be read.
std::optional<Material> texturedMaterial(const std::string& image, const std::filesystem::path& path,
                                         SceneFiles& files, std::vector<Texture>& textures,
                                         std::vector<std::string>& warnings);

}  // namespace glint
