#include "import/importers.h"

#include "core/error.h"
#include "core/text_file.h"
#include "import/readers.h"

namespace glint {

ImportedMesh importMesh(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return readObj(path);
    if (extension == ".ply") return readPly(path);
    if (extension == ".stl") return readStl(path);
    if (extension == ".gltf" || extension == ".glb") return flattened(readGltf(path).scene);
    throw Error(ErrorKind::Scene,
                path.string() + ": a mesh file must end in .obj, .ply, .stl, .gltf or .glb");
}

}  // namespace glint
