#include "import/parse_objects.h"

#include <algorithm>

#include "core/error.h"
#include "core/near_names.h"
#include "import/parse_quadrics.h"
#include "import/parse_transform.h"
#include "scene/limits.h"
#include "scene/transform.h"
#include "scene/validate.h"

namespace glint {

namespace {

const KeyTable& keysOf(std::string_view type) {
    if (type == "sphere") return keys::kSphere;
    if (type == "plane") return keys::kPlane;
    if (type == "disc") return keys::kDisc;
    if (type == "box") return keys::kBox;
    if (type == "triangle") return keys::kTriangle;
    if (type == "polygon") return keys::kPolygon;
    if (const KeyTable* table = quadricKeys(type)) return *table;
    return keys::kMeshObject;
}

std::string hintIn(const std::string& hint) {
    return hint.empty() ? "" : " (" + hint + ")";
}

// First the object's own transform, then that of what is around it.
std::optional<Affine> composed(const JsonCursor& object, const std::optional<Affine>& around) {
    const auto own = object.find("transform");
    if (!own) return around;
    const Affine affine = parseTransform(*own);
    if (!around) return affine;
    const Affine both = then(affine, *around);
    checkTransform(both, *own, " together with the transforms of the groups around it");
    return both;
}

}  // namespace

std::string_view readType(const JsonCursor& type, const keys::TypeTable& table) {
    const std::string& name = type.string();
    const auto has = [&](std::span<const std::string_view> list) {
        return std::find(list.begin(), list.end(), name) != list.end();
    };
    if (has(table.types)) return name;
    if (has(table.later))
        type.fail("\"" + name + "\" is not supported by this version (supported: " + joinNames(table.types) +
                  ")");
    constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
        {"cube", "box"},          {"cuboid", "box"},  {"quad", "polygon"},
        {"rectangle", "polygon"}, {"circle", "disc"}, {"ball", "sphere"},
        {"obj", "mesh"},          {"model", "mesh"},  {"sun", "directional"}};
    std::string hint = suggestion(name, table.types, "supported");
    for (const auto& [other, known] : kOtherNames)
        if (name == other && std::ranges::find(table.types, known) != table.types.end())
            hint = "did you mean \"" + std::string(known) + "\"?";
    type.fail("unknown " + std::string(table.what) + " type \"" + name + "\"" + hintIn(hint));
}

ObjectParser::ObjectParser(Scene& scene, const std::string& file, const std::filesystem::path& folder,
                           SceneFiles& files, MeshMemory& memory, const JsonCursor* meshes)
    : scene_(scene), file_(file), folder_(folder), files_(files), memory_(memory), meshes_(meshes) {
    for (uint32_t i = 0; i < scene.materials.size(); i++) materials_.emplace(scene.materials[i].name, i);
    for (size_t i = 0; meshes && i < meshes->memberCount(); i++) meshNames_.emplace(meshes->memberName(i), i);
}

void ObjectParser::parseGroup(const JsonCursor& group, const Surrounding& around) {
    group.expectKeys(keys::kGroup);
    if (around.depth == kMaxGroupDepth)
        group.fail("groups must not be nested deeper than " + std::to_string(kMaxGroupDepth));
    Surrounding inside = around;
    ++inside.depth;
    inside.transform = composed(group, around.transform);
    if (const auto material = group.find("material")) inside.material = findMaterial(*material);
    const JsonCursor objects = group.require("objects");
    if (!objects.value().array()) objects.failWanted("must be a list of objects");
    for (size_t i = 0; i < objects.size(); i++) parse(objects.item(i), inside);
}

void ObjectParser::parse(const JsonCursor& object, const Surrounding& around) {
    object.expectObject();
    const std::string_view type = readType(object.require("type"), keys::kObjectTypes);
    if (type == "group") return parseGroup(object, around);
    object.expectKeys(keysOf(type));

    Object result;
    result.name = object.pointer();
    std::optional<uint32_t> material = around.material;
    if (const auto name = object.find("material")) material = findMaterial(*name);
    if (type == "mesh") {
        result.material = material.value_or(Mesh::kNoIndex);
        result.shape = MeshShape{parseMesh(object, result.material)};
    } else {
        result.material = material ? *material : defaultMaterial();
        result.shape = parseShape(object, type);
        // Before the transform, so that the message shows the number in the file; meshes are looked at once,
        // at the end.
        validateShape(result.shape, {file_, result.name}, 0);
    }
    result.transform = composed(object, around.transform);
    scene_.objects.push_back(std::move(result));
}

Shape ObjectParser::parseShape(const JsonCursor& object, std::string_view type) {
    if (type == "sphere") {
        SphereShape sphere;
        sphere.center = object.require("center").vector3();
        sphere.radius = object.require("radius").number();
        return sphere;
    }
    if (type == "plane") {
        PlaneShape plane;
        plane.point = object.require("point").vector3();
        plane.normal = object.require("normal").vector3();
        return plane;
    }
    if (type == "disc") {
        DiscShape disc;
        disc.center = object.require("center").vector3();
        disc.normal = object.require("normal").vector3();
        disc.radius = object.require("radius").number();
        return disc;
    }
    if (type == "box") return BoxShape{object.require("min").vector3(), object.require("max").vector3()};
    if (auto quadric = parseQuadric(object, type)) return std::move(*quadric);
    const JsonCursor vertices = object.require("vertices");
    if (type == "polygon") {
        if (!vertices.value().array() || vertices.size() < 3)
            vertices.failWanted("must be three points or more [[x, y, z], ...]");
        PolygonShape polygon;
        for (size_t i = 0; i < vertices.size(); i++) polygon.vertices.push_back(vertices.item(i).vector3());
        return polygon;
    }
    if (!vertices.value().array() || vertices.size() != 3)
        vertices.failWanted("must be three points [[x, y, z], ...]");
    TriangleShape triangle;
    for (size_t i = 0; i < 3; i++) triangle.vertices[i] = vertices.item(i).vector3();
    return triangle;
}

// `material` is kNoIndex if the object names none; then it becomes the file's first one, or the default.
std::shared_ptr<const Mesh> ObjectParser::parseMesh(const JsonCursor& object, uint32_t& material) {
    LoadedMesh& loaded = load(object.require("mesh"));
    if (material == Mesh::kNoIndex) {
        material = loaded.own->materials.empty() ? defaultMaterial() : loaded.material;
        return loaded.own;
    }
    if (loaded.own->materials.empty()) return loaded.own;
    if (!loaded.plain) {
        files_.take(loaded.own->corners.size() * 2 * sizeof(glm::uvec3), file_);
        auto plain = std::make_shared<Mesh>(*loaded.own);
        plain->materials.clear();
        loaded.plain = std::move(plain);
    }
    return loaded.plain;
}

ObjectParser::LoadedMesh& ObjectParser::load(const JsonCursor& nameCursor) {
    const std::string& name = nameCursor.string();
    const auto known = loaded_.find(name);
    if (known != loaded_.end()) return *known->second;

    const auto found = meshNames_.find(name);
    if (found == meshNames_.end()) {
        std::vector<std::string_view> names;
        if (meshes_)
            for (size_t i = 0; i < meshes_->memberCount(); i++) names.push_back(meshes_->memberName(i));
        const std::string hint = suggestion(name, names, "defined");
        nameCursor.fail("no mesh \"" + name + "\"" +
                        (hint.empty() ? " (the scene defines none)" : hintIn(hint)));
    }
    const JsonCursor entry = meshes_->member(found->second), file = entry.require("file");
    std::filesystem::path path;
    try {
        path = files_.resolve(folder_, file.string());
    } catch (const Error& error) {
        file.fail(error.what());
    }
    if (!files_.exists(path)) file.fail("no such file: " + path.string());
    if (!isMeshFile(path)) file.fail(path.string() + ": " + kNoMeshFile);
    std::shared_ptr<LoadedMesh>& shared = byFile_[files_.real(path)];
    if (!shared) shared = std::make_shared<LoadedMesh>(readMesh(path));
    return *loaded_.emplace(name, shared).first->second;
}

// A mesh that was read for an earlier moment of an animation has its materials at the same place as then.
const MeshMemory::Read& ObjectParser::remembered(const std::filesystem::path& path) {
    const auto firstMaterial = static_cast<uint32_t>(scene_.materials.size());
    MeshMemory::Read& read = memory_.files[path];
    if (read.mesh && (read.firstMaterial == firstMaterial || read.mesh->materials.empty())) return read;
    ImportedMesh imported = importMesh(path, files_);
    validateVertices(imported.mesh, path.string());
    for (uint32_t& material : imported.mesh.materials) material += firstMaterial;
    read = {std::move(imported.materials), std::move(imported.textures), std::move(imported.warnings),
            std::make_shared<const Mesh>(std::move(imported.mesh)), firstMaterial};
    return read;
}

ObjectParser::LoadedMesh ObjectParser::readMesh(const std::filesystem::path& path) {
    const MeshMemory::Read& read = remembered(path);
    scene_.warnings.insert(scene_.warnings.end(), read.warnings.begin(), read.warnings.end());
    LoadedMesh mesh;
    mesh.material = static_cast<uint32_t>(scene_.materials.size());
    const auto firstTexture = static_cast<uint32_t>(scene_.textures.size());
    scene_.textures.insert(scene_.textures.end(), read.textures.begin(), read.textures.end());
    for (Material material : read.materials) {
        for (uint32_t* texture :
             {&material.ambientTexture, &material.diffuseTexture, &material.specularTexture,
              &material.mirrorTexture, &material.transmissionTexture})
            if (*texture != Material::kNoTexture) *texture += firstTexture;
        scene_.materials.push_back(std::move(material));
    }
    mesh.own = read.mesh;
    return mesh;
}

void ObjectParser::warnOfUnusedMeshes() {
    if (!meshes_) return;
    for (size_t i = 0; i < meshes_->memberCount(); i++)
        if (!loaded_.contains(meshes_->memberName(i)))
            scene_.warnings.push_back(file_ + ": " + meshes_->member(i).pointer() +
                                      ": no object uses this mesh");
}

uint32_t ObjectParser::findMaterial(const JsonCursor& nameCursor) const {
    if (nameCursor.value().object())
        nameCursor.fail("must be a name: put the material into \"materials\": {\"NAME\": {...}}");
    const std::string& name = nameCursor.string();
    const auto found = materials_.find(name);
    if (found != materials_.end()) return found->second;
    std::vector<std::string_view> names;
    for (const auto& [known, index] : materials_) names.push_back(known);
    const std::string hint = suggestion(name, names, "defined");
    nameCursor.fail("no material \"" + name + "\"" +
                    (hint.empty() ? " (the scene defines none)" : hintIn(hint)));
}

uint32_t ObjectParser::defaultMaterial() {
    if (default_ == Mesh::kNoIndex) {
        default_ = static_cast<uint32_t>(scene_.materials.size());
        scene_.materials.emplace_back().name = "default";
    }
    return default_;
}

}  // namespace glint
