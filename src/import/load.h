// From files to a Scene.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import/scene_files.h"
#include "scene/frame_model.h"
#include "scene/scene.h"

namespace glint {

// Loads a glint scene (.json), a scene of another program (.gltf, .glb, .nff) or a model alone (.obj, .ply,
// .stl), chosen by extension, any case. Relative paths inside a file are relative to that file. A model alone
// gets a camera that frames it and a light (frameModel); a scene of another program gets those that it lacks.
// Throws Error(Scene) "file: where: what" (docs/reference/scene-format.md), and Error(Argument) if the file
// has no camera of the name options.camera. Without options.allowOutside, all files must lie in the scene's
// folder or below.
Scene loadScene(const std::filesystem::path& path, const LoadOptions& options = {});

// Parses scene text; `name` stands for the file in messages, `folder` is where relative paths start.
Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                 const LoadOptions& options = {});

// A scene file that is read once and shown at many times of its animation.
class SceneReader {
  public:
    // Reads the file as loadScene does, at `time` in seconds, or without `time` by the numbers in the file.
    // Keeps meshes and images for later times. The path "-" is a scene in JSON, which options.source must
    // have.
    SceneReader(const std::filesystem::path& path, const LoadOptions& options,
                std::optional<double> time = {});
    ~SceneReader();
    SceneReader(SceneReader&&) noexcept;

    const Scene& scene() const;
    Scene take();  // moves the scene out; for a single moment

    // Parts of the scene that a later moment changes. Camera: only Scene::camera and cameras.
    enum class Change { Nothing, Camera, Scene };
    // Throws Error(Scene) if the scene is invalid at that time, and keeps the scene as it was.
    Change moveTo(double time);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// ---- Mesh files: one mesh each, polygons split into triangles, numbers in double

struct ImportedMesh {
    Mesh mesh;                        // mesh.materials index `materials` below (empty if the file names none)
    std::vector<Material> materials;  // from the file, in order of first definition
    std::vector<Texture> textures;    // that the materials index
    std::vector<std::string> warnings;
};

// True if loadScene reads files with this extension.
bool isSceneFile(const std::filesystem::path& path);

// True if importMesh reads files with this extension; its message for all others.
bool isMeshFile(const std::filesystem::path& path);
inline constexpr const char* kNoMeshFile = "a mesh file must end in .obj, .ply, .stl, .gltf or .glb";

// Reads .obj (with its .mtl), .ply (ascii, binary little and big endian), .stl (ascii, binary) or the meshes
// of .gltf and .glb, by extension. docs/reference/file-formats.md describes each format.
//
// glTF: all meshes of the default scene as one, where their nodes place them, without cameras and lights.
//
// The reader names each unknown part of a file in one warning. A number that cannot be parsed is an error.
// Vertices that are not finite are kept (see validateScene). Throws Error(Scene), e.g.
// "bunny.obj:88: face uses vertex 9, the file has 8". The first form reads only files in the model's folder.
ImportedMesh importMesh(const std::filesystem::path& path);
ImportedMesh importMesh(const std::filesystem::path& path, SceneFiles& files);

}  // namespace glint
