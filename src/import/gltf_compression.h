// Compressed geometry of glTF files, by libraries that not every build has.
#pragma once

#include <string>
#include <vector>

#include "import/gltf_file.h"

namespace glint {

// True if this build reads geometry compressed by Draco (KHR_draco_mesh_compression).
bool readsDraco();

// The bytes of a buffer view with EXT_meshopt_compression (or KHR_, the same), whose object is `extension`,
// from `compressed`. Throws Error(Scene) if they are damaged or the build does not read them.
std::string decodeMeshopt(GltfFile& file, const JsonCursor& extension, std::string_view compressed);

// Decodes the Draco geometry of a primitive, whose extension object is `extension`, for readAccessor: the
// accessors of its attributes and indices have no data of their own. Throws Error(Scene).
void decodeDraco(GltfFile& file, const JsonCursor& primitive, const JsonCursor& extension);

}  // namespace glint
