#include "import/readers.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"
#include "scene/transform.h"

namespace glint {

namespace {

// Appends `mesh`; its triangles get `material` if it names none.
void append(const Mesh& mesh, uint32_t material, Mesh& into) {
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
    if (mesh.materials.empty())
        into.materials.insert(into.materials.end(), count, material);
    else
        into.materials.insert(into.materials.end(), mesh.materials.begin(), mesh.materials.end());
}

// The mesh objects of `scene` as one mesh in world space, with the scene's materials and warnings.
ImportedMesh flattened(Scene scene) {
    ImportedMesh result;
    for (const Object& object : scene.objects) {
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (!shape) continue;
        if (object.transform)
            append(transformed(*shape->mesh, *object.transform), object.material, result.mesh);
        else
            append(*shape->mesh, object.material, result.mesh);
    }
    result.materials = std::move(scene.materials);
    result.textures = std::move(scene.textures);
    result.warnings = std::move(scene.warnings);
    return result;
}

}  // namespace

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
        Scene scene = openGltf(path, files)->take().scene;
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
