#include "import/readers.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"
#include "scene/transform.h"

namespace glint {

namespace {

// Appends a mesh of glTF, whose triangles all have materials.
void append(const Mesh& mesh, Mesh& into) {
    constexpr glm::uvec3 none(Mesh::kNoIndex);
    const size_t before = into.corners.size(), count = mesh.corners.size();
    // Lists of corners stay parallel to the triangles.
    const auto add = [&](const auto& elements, auto& allElements, const std::vector<glm::uvec3>& corners,
                         std::vector<glm::uvec3>& allCorners) {
        const glm::uvec3 first(static_cast<uint32_t>(allElements.size()));
        allElements.insert(allElements.end(), elements.begin(), elements.end());
        if (corners.empty() && allCorners.empty()) return;
        allCorners.resize(before, none);
        for (size_t i = 0; i < count; i++)
            allCorners.push_back(corners.empty() || corners[i] == none ? none : corners[i] + first);
    };
    add(mesh.positions, into.positions, mesh.corners, into.corners);
    add(mesh.normals, into.normals, mesh.normalCorners, into.normalCorners);
    add(mesh.uvs, into.uvs, mesh.uvCorners, into.uvCorners);
    add(mesh.colors, into.colors, mesh.colorCorners, into.colorCorners);
    into.materials.insert(into.materials.end(), mesh.materials.begin(), mesh.materials.end());
}

// The meshes of a glTF scene as one mesh in world space, with the scene's materials and warnings.
ImportedMesh readGltf(const std::filesystem::path& path, SceneFiles& files) {
    Scene scene = openGltf(path, files, true)->take().scene;
    const std::pair<bool, const char*> ignored[] = {{scene.animation.has_value(), "animations"},
                                                    {!scene.lights.empty(), "lights"},
                                                    {!scene.cameras.empty(), "cameras"}};
    for (const auto& [present, what] : ignored)
        if (present) scene.warnings.push_back(path.string() + ": " + what + " of a mesh are ignored");
    ImportedMesh result;
    for (const Object& object : scene.objects) {
        const Mesh& mesh = *std::get<MeshShape>(object.shape).mesh;
        files.take(mesh.positions.size() * sizeof(glm::dvec3) + mesh.corners.size() * sizeof(glm::uvec3),
                   path.string());
        if (result.mesh.positions.size() + mesh.positions.size() >= Mesh::kNoIndex)
            failFile(path.string(), "more than 2^32 - 2 vertices");
        append(object.transform ? transformed(mesh, *object.transform) : mesh, result.mesh);
    }
    result.materials = std::move(scene.materials);
    result.textures = std::move(scene.textures);
    result.warnings = std::move(scene.warnings);
    return result;
}

using ReadMesh = ImportedMesh (*)(const std::filesystem::path&, SceneFiles&);
constexpr std::pair<std::string_view, ReadMesh> kReaders[] = {
    {".obj", readObj}, {".ply", readPly}, {".stl", readStl}, {".gltf", readGltf}, {".glb", readGltf}};

// Null for files that are no meshes.
ReadMesh readerOf(const std::filesystem::path& path) {
    const auto found =
        std::ranges::find(kReaders, lowerExtension(path), &std::pair<std::string_view, ReadMesh>::first);
    return found == std::end(kReaders) ? nullptr : found->second;
}

}  // namespace

ImportedMesh importMesh(const std::filesystem::path& path) {
    SceneFiles files(path.parent_path());
    return importMesh(path, files);
}

ImportedMesh importMesh(const std::filesystem::path& path, SceneFiles& files) {
    const ReadMesh read = readerOf(path);
    if (!read) failFile(path.string(), kNoMeshFile);
    return read(path, files);
}

bool isMeshFile(const std::filesystem::path& path) {
    return readerOf(path) != nullptr;
}

}  // namespace glint
