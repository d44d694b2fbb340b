#include "import/importers.h"

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "core/text_file.h"
#include "import/readers.h"

namespace glint {

ImportedMesh importMesh(const std::filesystem::path& path) {
    SceneFiles files(path.parent_path());
    return importMesh(path, files);
}

ImportedMesh importMesh(const std::filesystem::path& path, SceneFiles& files) {
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return readObj(path, files);
    if (extension == ".ply") return readPly(path, files);
    if (extension == ".stl") return readStl(path, files);
    if (extension == ".gltf" || extension == ".glb") {
        Scene scene = readGltf(path, files).scene;
        if (scene.animation) scene.warnings.push_back(path.string() + ": animations of a mesh are ignored");
        return flattened(std::move(scene));
    }
    throw Error(ErrorKind::Scene, path.string() + ": " + kNoMeshFile);
}

bool isMeshFile(const std::filesystem::path& path) {
    constexpr std::string_view kExtensions[] = {".obj", ".ply", ".stl", ".gltf", ".glb"};
    return std::ranges::find(kExtensions, lowerExtension(path)) != std::end(kExtensions);
}

}  // namespace glint
