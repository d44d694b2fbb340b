#include "scene/importers.h"

#include "core/error.h"
#include "scene/readers.h"
#include "scene/text_file.h"

namespace glint {

ImportedMesh importMesh(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return readObj(path);
    if (extension == ".ply") return readPly(path);
    throw Error(ExitCode::Scene, path.string() + ": a mesh file must end in .obj or .ply");
}

}  // namespace glint
