// The readers of models and of scenes of other programs, by the format of the file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

// ---- Mesh files: one mesh each, polygons split into triangles, numbers in double

struct ImportedMesh {
    Mesh mesh;                        // mesh.materials index `materials` below (empty if the file names none)
    std::vector<Material> materials;  // from the file, in order of first definition
    std::vector<Texture> textures;    // that the materials index
    std::vector<std::string> warnings;
};

// True if importMesh reads files with this extension.
bool isMeshFile(const std::filesystem::path& path);
// Message for files that importMesh does not read.
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

// The readers of importMesh. `files` limits the files and the memory.
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

// ---- glTF: a scene that is read once and shown at many times, as its animation moves nodes

using TrackValues = std::vector<std::vector<double>>;  // of each track of an animation, at one time

class GltfScene {
  public:
    virtual ~GltfScene() = default;

    // Returns the scene that was read, as its nodes stand; call it once.
    virtual ImportedScene take() = 0;

    // Values of the animated parts of nodes at a time in seconds.
    virtual TrackValues valuesAt(double time) const = 0;
    // Puts objects, and lights and cameras if the file has any, into `scene` as these values place them; all
    // else stays. Not yet validated.
    virtual void show(const TrackValues& values, Scene& scene) = 0;
    // False if the animation moves only cameras.
    virtual bool movesObjects() const = 0;
};

// docs/reference/file-formats.md describes the mapping and the warnings. asMesh: materials are those of a
// file without lights. `files` must outlive the object. Throws Error(Scene) "FILE: /JSON/POINTER: ...".
std::unique_ptr<GltfScene> openGltf(const std::filesystem::path& path, SceneFiles& files,
                                    bool asMesh = false);

// ---- Materials of OBJ and PLY

// Appends the materials of an MTL file with this text, the textures that they index and warnings to `result`
// (docs/reference/file-formats.md). Throws Error(Scene) for text in the place of a number.
void readMtl(const std::string& text, const std::filesystem::path& path, SceneFiles& files,
             ImportedMesh& result);

// Appends a white material with this image as its diffuse texture, as a PLY file names it; only a warning if
// the image cannot be read.
void addTexturedMaterial(const std::string& image, const std::filesystem::path& path, SceneFiles& files,
                         ImportedMesh& result);

}  // namespace glint
