#include "scene/placement.h"

#include <map>
#include <unordered_set>

#include "core/vectors.h"
#include "scene/transform.h"

namespace glint {
namespace {

// On the device, at the least: a triangle, its surface, and its third of a node; an instance and a node.
constexpr double kTriangleBytes = 48 + 32 + 64.0 / 3;
constexpr double kInstanceBytes = 112 + 64;

const glm::dvec3 kUnitNormal(0, 0, 1);  // of the unit disc

// A box is one with other corners where each axis keeps its direction and sense.
std::optional<Shape> bakedShape(const BoxShape& box, const Affine& transform) {
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (row == column ? !(transform.linear[column][row] > 0) : transform.linear[column][row] != 0)
                return std::nullopt;
    return BoxShape{apply(transform, box.min), apply(transform, box.max)};
}

template <class S>
std::optional<Shape> bakedShape(const S& shape, const Affine& transform) {
    if constexpr (requires { transformed(shape, transform); }) {
        return transformed(shape, transform);
    } else {
        return std::nullopt;
    }
}
std::optional<Shape> bakedShape(const MeshShape& shape, const Affine& transform) {
    return MeshShape{std::make_shared<const Mesh>(transformed(*shape.mesh, transform))};
}

glm::dvec3 halfSizeOfMesh(const Mesh& mesh) {
    BoundingBox box;
    for (const glm::dvec3& p : mesh.positions)
        if (isFinite(p)) box.include(p);
    return box.empty() ? glm::dvec3(0) : 0.5 * box.hi - 0.5 * box.lo;
}

// The same object with the unit disc, so that discs of any size share one prototype.
void makeUnit(Object& object) {
    if (const auto* disc = std::get_if<DiscShape>(&object.shape)) {
        const glm::dvec3 size = glm::abs(disc->normal);
        const glm::dvec3 n = glm::normalize(disc->normal / greatestMagnitude(size));
        const glm::dvec3 u = tangentOf(n);
        if (disc->center != glm::dvec3(0) || disc->normal != kUnitNormal || disc->radius != 1) {
            const Affine own{disc->radius * glm::dmat3(u, glm::cross(n, u), n), disc->center};
            object.transform = then(own, *object.transform);
            object.applied = then(object.applied, inverse(own));
        }
        object.shape = DiscShape{glm::dvec3(0), kUnitNormal, 1};
    }
}

struct MeshUse {
    glm::dvec3 halfSize{0};
    size_t instances = 0;  // objects that may be
    bool shared = false;   // they are
};
using MeshUses = std::map<const Mesh*, MeshUse>;

bool mayBeInstance(const Object& object, const MeshUse& use) {
    return !object.transform || transformLoss(object.transform->linear, use.halfSize) <= kMaxMeshLoss;
}

MeshUses countUses(const Scene& scene) {
    MeshUses uses;
    std::map<const Mesh*, size_t> objects;
    for (const Object& object : scene.objects)
        if (const auto* mesh = std::get_if<MeshShape>(&object.shape)) ++objects[mesh->mesh.get()];
    for (const Object& object : scene.objects) {
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        if (mesh == nullptr || objects[mesh->mesh.get()] < 2) continue;
        const auto [use, fresh] = uses.try_emplace(mesh->mesh.get());
        if (fresh) use->second.halfSize = halfSizeOfMesh(*mesh->mesh);
        use->second.instances += mayBeInstance(object, use->second);
    }
    for (auto& [mesh, use] : uses) {
        const double n = static_cast<double>(use.instances);
        const double saved =
            (n - 1) * kTriangleBytes * static_cast<double>(mesh->corners.size()) - n * kInstanceBytes;
        use.shared = use.instances > 1 && saved >= kLeastSaving;
    }
    return uses;
}

// True if the object is an instance of its mesh.
bool placeMesh(Object& object, const MeshUses& uses) {
    const auto use = uses.find(std::get<MeshShape>(object.shape).mesh.get());
    if (use == uses.end() || !use->second.shared || !mayBeInstance(object, use->second)) return false;
    if (!object.transform) object.transform = Affine{};
    return true;
}

}  // namespace

std::optional<Shape> baked(const Shape& shape, const Affine& transform) {
    return std::visit([&](const auto& s) { return bakedShape(s, transform); }, shape);
}

bool takesTransform(const Shape& shape) {
    return std::holds_alternative<BoxShape>(shape) || std::holds_alternative<QuadricShape>(shape) ||
           std::holds_alternative<EllipsoidShape>(shape) || std::holds_alternative<CylinderShape>(shape) ||
           std::holds_alternative<ConeShape>(shape) || std::holds_alternative<HyperboloidShape>(shape) ||
           std::holds_alternative<ParaboloidShape>(shape);
}

double transformLoss(const glm::dmat3& linear, const glm::dvec3& halfSize) {
    const glm::dmat3 a = magnitudes(linear), w = magnitudes(inverse({linear, glm::dvec3(0)}).linear);
    const glm::dvec3 size = a * halfSize;
    return greatestMagnitude(size) > 0 ? greatestMagnitude(a * (w * size)) / greatestMagnitude(size) : 0;
}

glm::dvec3 halfSizeOf(const Shape& shape) {
    if (const auto* box = std::get_if<BoxShape>(&shape)) return 0.5 * box->max - 0.5 * box->min;
    const auto* mesh = std::get_if<MeshShape>(&shape);
    return mesh != nullptr ? halfSizeOfMesh(*mesh->mesh) : glm::dvec3(1);
}

void placeObjects(Scene& scene) {
    const MeshUses uses = countUses(scene);
    for (Object& object : scene.objects) {
        if (std::holds_alternative<MeshShape>(object.shape) && placeMesh(object, uses)) continue;
        if (!object.transform) continue;
        if (*object.transform == Affine{}) {
            object.transform.reset();
        } else if (auto shape = baked(object.shape, *object.transform)) {
            object.shape = std::move(*shape);
            object.applied = then(object.applied, *object.transform);
            object.transform.reset();
        } else if (const auto* sphere = std::get_if<SphereShape>(&object.shape)) {
            object.shape = EllipsoidShape{sphere->center, glm::dvec3(sphere->radius)};
        } else {
            makeUnit(object);
        }
    }
}

bool isPlaced(const Scene& scene) {
    std::unordered_set<const Mesh*> meshes;
    for (const Object& object : scene.objects) {
        if (object.transform && (!takesTransform(object.shape) || baked(object.shape, *object.transform)))
            return false;
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        if (mesh != nullptr && !meshes.insert(mesh->mesh.get()).second) return false;
    }
    return true;
}

const Scene& placedScene(const Scene& scene, Scene& copy) {
    if (isPlaced(scene)) return scene;
    copy = scene;
    placeObjects(copy);
    return copy;
}

}  // namespace glint
