// The scene file as a tree of JSON, for readers that change numbers in it.
#pragma once

#include <filesystem>
#include <string>

#include "import/json_cursor.h"
#include "import/parse_objects.h"
#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

// Same as the function of import/load.h, but does not read meshes again that `memory` holds.
Scene parseScene(const JsonValue& document, const std::string& name, const std::filesystem::path& folder,
                 SceneFiles& files, MeshMemory& memory);

// The document's cameras into `scene`, not yet validated.
void parseCameras(const JsonCursor& root, Scene& scene);

}  // namespace glint
