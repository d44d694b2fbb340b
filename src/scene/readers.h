// The mesh file readers behind importMesh.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/importers.h"

namespace glint {

ImportedMesh readObj(const std::filesystem::path& path);
ImportedMesh readPly(const std::filesystem::path& path);

// Appends the materials of an MTL file, and the textures that they index. What is read and what is only
// warned about: importers.h. Throws Error(Scene) if it cannot be read or a value is out of range.
void readMtl(const std::filesystem::path& path, std::vector<Material>& materials,
             std::vector<Texture>& textures, std::vector<std::string>& warnings);

}  // namespace glint
