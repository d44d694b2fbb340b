#include "import/readers.h"
#include "scene/transform.h"

namespace glint {

namespace {

// Appends `corners` of a mesh with `count` triangles so that `into` stays parallel to the triangles. Meshes
// without such corners get kNoIndex.
void appendCorners(const std::vector<glm::uvec3>& corners, size_t count, size_t before, size_t firstElement,
                   std::vector<glm::uvec3>& into) {
    constexpr glm::uvec3 kNone(Mesh::kNoIndex);
    if (corners.empty() && into.empty()) return;
    into.resize(before, kNone);
    for (size_t i = 0; i < count; i++) {
        const glm::uvec3 c = corners.empty() ? kNone : corners[i];
        into.push_back(c == kNone ? c : c + glm::uvec3(static_cast<uint32_t>(firstElement)));
    }
}

template <typename Element>
void appendElements(const std::vector<Element>& elements, std::vector<Element>& into) {
    into.insert(into.end(), elements.begin(), elements.end());
}

void append(const Mesh& mesh, uint32_t material, Mesh& into) {
    const size_t before = into.corners.size(), count = mesh.corners.size();
    appendCorners(mesh.corners, count, before, into.positions.size(), into.corners);
    appendCorners(mesh.normalCorners, count, before, into.normals.size(), into.normalCorners);
    appendCorners(mesh.uvCorners, count, before, into.uvs.size(), into.uvCorners);
    appendCorners(mesh.colorCorners, count, before, into.colors.size(), into.colorCorners);
    appendElements(mesh.positions, into.positions);
    appendElements(mesh.normals, into.normals);
    appendElements(mesh.uvs, into.uvs);
    appendElements(mesh.colors, into.colors);
    if (mesh.materials.empty())
        into.materials.insert(into.materials.end(), count, material);
    else
        appendElements(mesh.materials, into.materials);
}

}  // namespace

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

}  // namespace glint
