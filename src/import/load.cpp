#include "import/load.h"

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "core/text_file.h"
#include "import/readers.h"
#include "scene/cameras.h"
#include "scene/frame_model.h"
#include "scene/transform.h"
#include "scene/validate.h"

namespace glint {

namespace {

// Appends `corners` of a mesh with `count` triangles so that `into` stays parallel to the triangles. Meshes
// without such corners get kNoIndex.
void appendCorners(const std::vector<glm::uvec3>& corners, size_t count, size_t before, size_t firstElement,
                   std::vector<glm::uvec3>& into) {
    constexpr glm::uvec3 none(Mesh::kNoIndex);
    if (corners.empty() && into.empty()) return;
    into.resize(before, none);
    for (size_t i = 0; i < count; i++) {
        const glm::uvec3 c = corners.empty() ? none : corners[i];
        into.push_back(c == none ? c : c + glm::uvec3(static_cast<uint32_t>(firstElement)));
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

namespace {

Scene loadModel(const std::filesystem::path& path, SceneFiles& files) {
    ImportedMesh imported = importMesh(path, files);
    Scene scene;
    scene.materials = std::move(imported.materials);
    scene.textures = std::move(imported.textures);
    scene.warnings = std::move(imported.warnings);
    if (scene.materials.empty()) scene.materials.emplace_back().name = "default";
    scene.objects.push_back(
        {"/objects/0", MeshShape{std::make_shared<const Mesh>(std::move(imported.mesh))}, 0});
    frameModel(scene, files.up().value_or(UpAxis::Y));
    validateFramedScene(scene, path.string());
    return scene;
}

// An invalid camera beside the first one must not make the file useless.
void dropFaultyCameras(Scene& scene, const std::filesystem::path& path) {
    std::erase_if(scene.cameras, [&](const NamedCamera& named) {
        try {
            validateCamera(named.camera, {path.string(), "camera \"" + named.name + '"'});
            return false;
        } catch (const Error& error) {
            scene.warnings.push_back(error.what() + std::string("; this camera is left out"));
            return true;
        }
    });
}

}  // namespace

void checkUpIsOpen(const SceneFiles& files, const std::string& name) {
    if (files.up())
        throw Error(ErrorKind::Argument, name + ": has a camera of its own, which decides what is up (--up)");
}

Scene completed(ImportedScene imported, const std::filesystem::path& path, const SceneFiles& files) {
    Scene scene = std::move(imported.scene);
    if (!imported.hasCamera) frameCamera(scene, files.up().value_or(UpAxis::Y));
    if (imported.hasCamera) {
        checkUpIsOpen(files, path.string());
        validateCamera(scene.camera, {path.string(), "camera"});
    }
    dropFaultyCameras(scene, path);
    if (scene.lights.empty()) lightModel(scene);
    imported.hasCamera ? validateScene(scene, path.string()) : validateFramedScene(scene, path.string());
    return scene;
}

void settleCamera(Scene& scene, const std::filesystem::path& path, const std::string& camera) {
    if (!camera.empty()) return chooseCamera(scene, camera, path.string());
    if (lowerExtension(path) == ".json" || scene.cameras.size() < 2) return;
    const std::string first = scene.cameras.front().name;  // whoever wrote several must hear that
    scene.warnings.push_back(path.string() + ": has " + std::to_string(scene.cameras.size()) +
                             " cameras; the first is used, \"" + printable(first) + "\"");
}

namespace {

Scene loadFrom(const std::filesystem::path& path, SceneFiles& files) {
    const std::string extension = lowerExtension(path);
    if (extension == ".json") return parseScene(files.read(path), path.string(), path.parent_path(), files);
    if (extension == ".obj" || extension == ".ply" || extension == ".stl") return loadModel(path, files);
    if (extension == ".gltf" || extension == ".glb") return completed(readGltf(path, files), path, files);
    if (extension == ".nff") return completed(readNff(path, files), path, files);
    if (!files.isFile(path)) files.read(path);  // says what is wrong
    throw Error(ErrorKind::Scene,
                path.string() +
                    ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model "
                    ".obj, .ply or .stl)");
}

}  // namespace

Scene loadScene(const std::filesystem::path& path, const LoadOptions& options) {
    SceneFiles files(path.parent_path(), options);
    Scene scene = loadFrom(path, files);
    scene.sources = files.sources();
    settleCamera(scene, path, options.camera);
    return scene;
}

}  // namespace glint
