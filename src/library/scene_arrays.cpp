// Adds and changes the geometry of scenes.
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "core/vectors.h"
#include "import/load.h"
#include "library/handles.h"
#include "library/status.h"
#include "library/views.h"
#include "scene/limits.h"
#include "scene/transform.h"

namespace glint::library {

namespace {

using glm::dvec3;

uint32_t addObject(glint_scene& scene, Object object) {
    const size_t number = scene.draft.objects.size();
    if (number >= std::numeric_limits<uint32_t>::max()) refuse("a scene has at most 4294967295 geometries");
    object.name = "/objects/" + std::to_string(number);
    scene.added.push_back(object.transform.value_or(Affine{}));
    scene.grown = true;
    scene.draft.objects.push_back(std::move(object));
    return static_cast<uint32_t>(number);
}

void checkMaterial(const glint_scene& scene, uint32_t material) {
    const size_t count = std::max<size_t>(scene.draft.materials.size(), 1);
    if (material >= count)
        refuse("there is no material " + std::to_string(material) + ", the scene has " +
               std::to_string(count));
}

void checkGeometry(const glint_scene* scene, uint32_t geometry) {
    require(scene != nullptr, "scene is NULL");
    if (geometry >= scene->draft.objects.size())
        refuse("there is no geometry " + std::to_string(geometry) + ", the scene has " +
               std::to_string(scene->draft.objects.size()));
}

// Elements are numbered by U32; the last value is GLINT_NONE.
void checkCount(uint64_t count, const char* what) {
    if (count >= GLINT_NONE)
        refuse(std::to_string(count) + " " + what + ", the limit is " + std::to_string(GLINT_NONE - 1));
}

uint64_t bytesOf(const Mesh& mesh) {
    const auto bytes = [](const auto& array) { return array.size() * sizeof(array[0]); };
    return bytes(mesh.positions) + bytes(mesh.normals) + bytes(mesh.corners) + bytes(mesh.normalCorners) +
           bytes(mesh.uvs) + bytes(mesh.uvCorners) + bytes(mesh.colors) + bytes(mesh.colorCorners) +
           bytes(mesh.faces) + bytes(mesh.materials);
}

// An empty mesh, charged with `bytes`.
std::shared_ptr<Mesh> chargedMesh(const Context& context, uint64_t bytes) {
    struct Charged {
        MemoryCharge charge;
        Mesh mesh;
    };
    auto held = std::make_shared<Charged>();
    held->charge = context.charge(bytes);
    return {held, &held->mesh};
}

std::shared_ptr<const Mesh> meshOf(const Context& context, const glint_triangles& given) {
    const NumberView vertices(given.vertices, 3, 0, "vertices");
    const uint64_t triangles =
        given.indices.data == nullptr ? vertices.count() / 3 : uint64_t{given.indices.count};
    checkCount(vertices.count(), "vertices");
    checkCount(triangles, "triangles");
    if (given.indices.data == nullptr && vertices.count() % 3 != 0)
        refuse("without indices the number of vertices must be a multiple of 3");
    auto mesh = chargedMesh(context, vertices.count() * sizeof(dvec3) + triangles * sizeof(glm::uvec3));
    mesh->positions.resize(vertices.count());
    for (uint64_t i = 0; i < vertices.count(); ++i) mesh->positions[i] = vertices.three(i);
    if (given.indices.data == nullptr) {
        for (uint32_t i = 0; i + 2 < vertices.count(); i += 3) mesh->corners.push_back({i, i + 1, i + 2});
        return mesh;
    }
    const CornerView corners(given.indices, "indices");
    mesh->corners.resize(corners.count());
    for (uint64_t i = 0; i < corners.count(); ++i) {
        const glm::uvec3 corner = corners.three(i);
        if (std::max({corner.x, corner.y, corner.z}) >= vertices.count())
            refuse("triangle " + std::to_string(i) + " names a vertex beyond the " +
                   std::to_string(vertices.count()) + " that there are");
        mesh->corners[i] = corner;
    }
    return mesh;
}

// Rows of three numbers and an offset, of any alignment.
Affine readTransform(const double* transform) {
    require(transform != nullptr, "transform is NULL");
    double rows[12];
    std::memcpy(rows, transform, sizeof(rows));
    Affine affine;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) affine.linear[column][row] = rows[4 * row + column];
        affine.offset[row] = rows[4 * row + 3];
    }
    const double determinant = glm::determinant(affine.linear);
    if (!(std::abs(determinant) > 0 && std::isfinite(determinant) && glint::isFinite(affine.offset)))
        refuse("transform: the matrix is singular, or not finite");
    return affine;
}

// Checked here, because spheres cannot be removed from the scene.
void checkSphere(uint64_t i, const dvec3& center, double radius) {
    const std::string number = std::to_string(i);
    if (!(radius > 0)) refuse("radius " + number + " is not greater than 0");
    if (!(radius >= kMinRadius && radius <= kMaxRadius))
        refuse("radius " + number + " is not from 1e-14 to 1e18");
    if (!glm::all(glm::lessThan(glm::abs(center), dvec3(kMaxCoordinate))))
        refuse("center " + number + " is not finite, or not within 1e18 of 0");
}

// Adds objects, materials, textures and lights; everything else of `text` replaces the scene's.
void merge(glint_scene& scene, Scene text) {
    Scene& draft = scene.draft;
    const auto materials = static_cast<uint32_t>(draft.materials.size());
    const auto textures = static_cast<uint32_t>(draft.textures.size());
    for (Material& material : text.materials) {
        for (const auto& [key, texture] : kMaterialTextures)
            if (material.*texture != Material::kNoTexture) material.*texture += textures;
    }
    std::vector<Object> objects = std::move(text.objects);
    const auto append = [](auto& to, auto& from) {
        to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    append(draft.materials, text.materials);
    append(draft.textures, text.textures);
    append(draft.lights, text.lights);
    append(draft.warnings, text.warnings);
    text.materials = std::move(draft.materials);
    text.textures = std::move(draft.textures);
    text.lights = std::move(draft.lights);
    text.warnings = std::move(draft.warnings);
    text.objects = std::move(draft.objects);
    draft = std::move(text);
    for (Object& object : objects) {
        object.material += materials;
        if (auto* shape = std::get_if<MeshShape>(&object.shape); shape && !shape->mesh->materials.empty()) {
            auto mesh = std::make_shared<Mesh>(*shape->mesh);
            for (uint32_t& material : mesh->materials) material += materials;
            shape->mesh = std::move(mesh);
        }
        addObject(scene, std::move(object));
    }
    scene.framed = false;
    scene.grown = true;
}

}  // namespace

uint64_t meshBytes(const Scene& scene) {
    std::set<const Mesh*> seen;
    uint64_t bytes = 0;
    for (const Object& object : scene.objects) {
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (shape != nullptr && seen.insert(shape->mesh.get()).second) bytes += bytesOf(*shape->mesh);
    }
    return bytes;
}

}  // namespace glint::library

using namespace glint::library;

glint_status glint_scene_add_triangles(glint_scene* scene, const glint_triangles* triangles,
                                       uint32_t* geometry) {
    return guarded("glint_scene_add_triangles", [&] {
        require(scene != nullptr, "scene is NULL");
        const glint_triangles given = readStruct(triangles, "triangles");
        checkMaterial(*scene, given.material);
        glint::Object object;
        object.shape = glint::MeshShape{meshOf(scene->device->context, given)};
        object.material = given.material;
        const uint32_t number = addObject(*scene, std::move(object));
        if (geometry != nullptr) *geometry = number;
    });
}

glint_status glint_scene_add_spheres(glint_scene* scene, const glint_spheres* spheres, uint32_t* first) {
    return guarded("glint_scene_add_spheres", [&] {
        require(scene != nullptr, "scene is NULL");
        const glint_spheres given = readStruct(spheres, "spheres");
        checkMaterial(*scene, given.material);
        const NumberView centers(given.centers, 3, 0, "centers");
        checkCount(scene->draft.objects.size() + centers.count(), "geometries");
        const NumberView radii(given.radii, 1, centers.count(), "radii");
        for (uint64_t i = 0; i < centers.count(); ++i) checkSphere(i, centers.three(i), radii.one(i));
        const auto before = static_cast<uint32_t>(scene->draft.objects.size());
        for (uint64_t i = 0; i < centers.count(); ++i) {
            glint::Object object;
            object.shape = glint::SphereShape{centers.three(i), radii.one(i)};
            object.material = given.material;
            addObject(*scene, std::move(object));
        }
        if (first != nullptr) *first = before;
    });
}

glint_status glint_scene_add_json(glint_scene* scene, const char* text, const char* folder, uint32_t* first,
                                  uint32_t* count) {
    return guarded("glint_scene_add_json", [&] {
        require(scene != nullptr, "scene is NULL");
        require(text != nullptr, "text is NULL");
        glint::Scene parsed =
            glint::parseScene(text, "text", folder == nullptr ? std::filesystem::path() : folder);
        scene->loaded.push_back(scene->device->context.charge(meshBytes(parsed)));
        const auto before = static_cast<uint32_t>(scene->draft.objects.size());
        merge(*scene, std::move(parsed));
        if (first != nullptr) *first = before;
        if (count != nullptr) *count = static_cast<uint32_t>(scene->draft.objects.size()) - before;
    });
}

glint_status glint_scene_add_instance(glint_scene* scene, uint32_t geometry, const double transform[12],
                                      uint32_t* instance) {
    return guarded("glint_scene_add_instance", [&] {
        checkGeometry(scene, geometry);
        const glint::Affine moved = readTransform(transform);
        const glint::Affine base = scene->added[geometry];
        glint::Object object = scene->draft.objects[geometry];
        object.transform = base;
        const uint32_t number = addObject(*scene, std::move(object));
        scene->draft.objects[number].transform = then(base, moved);
        if (instance != nullptr) *instance = number;
    });
}

glint_status glint_scene_set_transform(glint_scene* scene, uint32_t geometry, const double transform[12]) {
    return guarded("glint_scene_set_transform", [&] {
        checkGeometry(scene, geometry);
        const glint::Affine moved = readTransform(transform);
        scene->draft.objects[geometry].transform = then(scene->added[geometry], moved);
    });
}

glint_status glint_scene_set_vertices(glint_scene* scene, uint32_t geometry, const glint_view* vertices) {
    return guarded("glint_scene_set_vertices", [&] {
        checkGeometry(scene, geometry);
        require(vertices != nullptr, "vertices is NULL");
        const auto* shape = std::get_if<glint::MeshShape>(&scene->draft.objects[geometry].shape);
        require(shape != nullptr, "the geometry is no mesh");
        const std::shared_ptr<const glint::Mesh> before = shape->mesh;
        const NumberView given(*vertices, 3, 0, "vertices");
        if (given.count() != before->positions.size())
            refuse("the mesh has " + std::to_string(before->positions.size()) + " vertices, but " +
                   std::to_string(given.count()) + " were given");
        const std::shared_ptr<glint::Mesh> mesh = chargedMesh(scene->device->context, bytesOf(*before));
        *mesh = *before;
        for (uint64_t i = 0; i < given.count(); ++i) {
            const glm::dvec3 position = given.three(i);
            if (!glint::isFinite(position)) refuse("vertex " + std::to_string(i) + " is not finite");
            mesh->positions[i] = position;
        }
        for (glint::Object& object : scene->draft.objects) {
            auto* other = std::get_if<glint::MeshShape>(&object.shape);
            if (other != nullptr && other->mesh == before) other->mesh = mesh;
        }
    });
}
