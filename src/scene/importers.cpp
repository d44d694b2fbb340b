#include "scene/importers.h"

#include "core/error.h"
#include "scene/readers.h"
#include "scene/text_file.h"

namespace glint {

ImportedMesh importMesh(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return readObj(path);
    if (extension == ".ply") return readPly(path);
    if (extension == ".stl") return readStl(path);
    if (extension == ".gltf" || extension == ".glb") return flattened(readGltf(path).scene);
    throw Error(ExitCode::Scene, path.string() + ": a mesh file must end in .obj, .ply, .stl, .gltf or .glb");
}

}  // namespace glint
