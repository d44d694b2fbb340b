#include "scene/load.h"

#include "core/error.h"
#include "scene/importers.h"
#include "scene/text_file.h"

namespace glint {

namespace {

Scene loadModel(const std::filesystem::path& path) {
    ImportedMesh imported = importMesh(path);
    Scene scene;
    scene.materials = std::move(imported.materials);
    scene.textures = std::move(imported.textures);
    scene.warnings = std::move(imported.warnings);
    if (scene.materials.empty()) scene.materials.emplace_back().name = "default";
    scene.objects.push_back(
        {"/objects/0", MeshShape{std::make_shared<const Mesh>(std::move(imported.mesh))}, 0});
    frameModel(scene);
    validateScene(scene, path.string());
    return scene;
}

}  // namespace

Scene loadScene(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".json") return parseScene(readWholeFile(path), path.string(), path.parent_path());
    if (extension == ".obj" || extension == ".ply") return loadModel(path);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored) || std::filesystem::is_directory(path, ignored))
        readWholeFile(path);  // says what is wrong
    throw Error(
        ExitCode::Scene,
        path.string() + ": unknown kind of file (a scene is .json, a model .obj or .ply in this version)");
}

}  // namespace glint
