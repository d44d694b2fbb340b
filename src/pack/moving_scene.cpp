#include "pack/moving_scene.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <span>

#include "bvh/flatten.h"
#include "core/parallel.h"
#include "pack/area_vector.h"
#include "pack/extent.h"
#include "pack/pack_geometry.h"
#include "pack/primitives.h"
#include "pack/request_environment.h"
#include "scene/limits.h"

namespace glint {
namespace {

constexpr size_t kMoveChunk = 16384;  // vertices that one thread treats at a time

// Kinds whose rows depend only on the origin and on the objects passed as moved.
bool follows(uint8_t kind) {
    return kind == shared::kKindTriangle || kind == shared::kKindInstance || kind == shared::kKindPlane;
}

std::shared_ptr<const Mesh> meshOf(const Object& object) {
    const auto* shape = std::get_if<MeshShape>(&object.shape);
    return shape != nullptr ? shape->mesh : nullptr;
}

std::span<const glm::dvec3> positionsOf(const Object& object) {
    if (const auto* triangle = std::get_if<TriangleShape>(&object.shape)) return triangle->vertices;
    return std::get<MeshShape>(object.shape).mesh->positions;
}

std::vector<uint8_t> usedVertices(const Object& object) {
    std::vector<uint8_t> used(positionsOf(object).size());
    const auto mesh = meshOf(object);
    if (!mesh) return {1, 1, 1};
    for (const glm::uvec3& corner : mesh->corners) used[corner.x] = used[corner.y] = used[corner.z] = 1;
    return used;
}

PackOptions optionsFor(const Scene& scene, bool split) {
    PackOptions options;
    options.split = split && !anyTransmits(scene);
    return options;
}

}  // namespace

MovingScene::MovingScene(const Scene& placed, bool split, const Context& context) : eye_(placed.camera.eye) {
    const PackOptions options = optionsFor(placed, split);
    const PrimitiveNumbers numbers(placed);
    instances_.emplace(placed, numbers, options, context);
    packed_ = packPlaced(placed, numbers, *instances_, options, context);
    builtCost_ = packed_.statistics.sahCost;
    for (const Object& object : placed.objects) {
        kinds_.push_back(static_cast<uint8_t>(kindOf(object)));
        shared_.push_back(kinds_.back() == shared::kKindInstance ? meshOf(object) : nullptr);
    }
    if (packed_.statistics.droppedZeroArea + packed_.statistics.droppedNotFinite > 0)
        findDropped(placed, numbers);
}

void MovingScene::findDropped(const Scene& scene, const PrimitiveNumbers& numbers) {
    for (uint32_t object = 0; object < scene.objects.size(); ++object) {
        if (kinds_[object] != shared::kKindTriangle) continue;
        const Frame frame{packed_.origin, eye_, nullptr};
        for (uint32_t face = 0; face < numbers.facesOf(object); ++face) {
            if (packerOfTriangle().statusOf(scene.objects[object], face, frame) != PrimitiveStatus::Kept)
                dropped_.push_back({object, face});
        }
    }
}

bool MovingScene::knows(const Scene& scene, const std::vector<bool>& moved) const {
    if (!packed_.objectFrames.empty() || packed_.features.textures || packed_.features.transmission)
        return false;
    if (scene.objects.size() != kinds_.size()) return false;
    const bool seenAnew = scene.camera.eye != eye_;
    for (size_t i = 0; i < kinds_.size(); ++i) {
        const Object& object = scene.objects[i];
        if (kinds_[i] != static_cast<uint8_t>(kindOf(object))) return false;
        if (!follows(kinds_[i]) && (moved[i] || seenAnew)) return false;
        if (kinds_[i] == shared::kKindInstance && meshOf(object) != shared_[i]) return false;
    }
    return true;
}

// Rounds the vertices of an object of triangles, and measures it.
void MovingScene::followVertices(const Object& object, size_t number, const Context& context) {
    const std::span<const glm::dvec3> positions = positionsOf(object);
    Vertices& vertices = vertices_[number];
    if (!vertices.used || vertices.used->size() != positions.size())
        vertices.used = std::make_shared<const std::vector<uint8_t>>(usedVertices(object));
    vertices.rounded.resize(positions.size());
    std::vector<Extent> parts((positions.size() + kMoveChunk - 1) / kMoveChunk);
    parallelFor(context, parts.size(), [&](size_t chunk) {
        Extent extent;
        const size_t end = std::min(positions.size(), (chunk + 1) * kMoveChunk);
        for (size_t i = chunk * kMoveChunk; i < end; ++i) {
            if ((*vertices.used)[i] != 0) extent.include(positions[i]);
            const auto rounded = roundPoint(positions[i] - packed_.origin);
            vertices.rounded[i] = rounded.value_or(glm::vec3(std::numeric_limits<float>::quiet_NaN()));
        }
        parts[chunk] = extent;
    });
    extents_[number] = {};
    for (const Extent& part : parts) extents_[number].include(part);
}

// Objects that do not move keep their extent.
void MovingScene::measure(const Scene& scene, const std::vector<bool>& moved, const Context& context) {
    const bool first = extents_.empty();
    vertices_.resize(scene.objects.size());
    extents_.resize(scene.objects.size());
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        if (!first && !moved[i]) continue;
        if (kinds_[i] == shared::kKindTriangle) {
            followVertices(scene.objects[i], i, context);
            continue;
        }
        extents_[i] = {};
        if (kinds_[i] == shared::kKindInstance) {
            for (const glm::dvec3& corner : instances_->corners(scene, i)) extents_[i].include(corner);
        } else {
            packerOf(static_cast<shared::PrimitiveKind>(kinds_[i]))
                .extend(scene.objects[i], 0, 1, extents_[i]);
        }
    }
}

// Moves everything to a new origin of coordinates; false if something cannot follow.
bool MovingScene::followOrigin(const Scene& scene, const PrimitiveNumbers& numbers, std::vector<bool>& moved,
                               const Context& context) {
    packed_.geometry = geometryOf(scene, extents_);
    if (const glm::dvec3 origin = originOf(packed_.geometry, scene.camera.eye); origin != packed_.origin) {
        if (!std::all_of(kinds_.begin(), kinds_.end(), follows)) return false;
        packed_.origin = origin;
        moved.assign(moved.size(), true);
        measure(scene, moved, context);
    }
    packPlanes(scene, numbers, packed_);
    return true;
}

bool MovingScene::droppedStaySo(const Scene& scene, const std::vector<bool>& moved) const {
    const Frame frame{packed_.origin, eye_, nullptr};
    return std::none_of(dropped_.begin(), dropped_.end(), [&](const Face& gone) {
        return moved[gone.object] && packerOfTriangle().statusOf(scene.objects[gone.object], gone.face,
                                                                 frame) == PrimitiveStatus::Kept;
    });
}

// False if it is no longer one that is packed.
bool MovingScene::moveTriangle(const Scene& scene, const PrimitiveNumbers& numbers, uint32_t index) {
    shared::Triangle& triangle = packed_.triangles[index];
    shared::TriangleSurface& surface = packed_.triangleSurfaces[index];
    const Object& object = scene.objects[surface.object];
    const uint32_t face = (triangle.id & ~shared::kDielectricRank) - numbers.firstId(surface.object);
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    const glm::uvec3 corners = mesh != nullptr ? mesh->mesh->corners[face] : glm::uvec3(0, 1, 2);
    const glm::vec3* const rounded = vertices_[surface.object].rounded.data();
    triangle.v0 = rounded[corners.x];
    triangle.v1 = rounded[corners.y];
    triangle.v2 = rounded[corners.z];
    if (!triangleNormal(triangle.v0, triangle.v1, triangle.v2, surface.normal)) return false;
    if (surface.vertexNormals == shared::kNone) return true;
    return vertexNormals(mesh->mesh.get(), face, packed_.vertexNormals[surface.vertexNormals]);
}

// Triangles and boxes in one go: both lie in the order of leaves.
bool MovingScene::moveLeaves(const Scene& scene, const PrimitiveNumbers& numbers,
                             const std::vector<bool>& moved, const Context& context) {
    if (packed_.nodes.empty()) return true;
    std::atomic<bool> allKept = true;
    const auto leafBox = [&](uint32_t leaf) -> std::optional<Box> {
        const uint32_t kind = leaf >> shared::kLeafKindShift & shared::kLeafKindMask;
        const uint32_t first = leaf & shared::kLeafFirstMask;
        if (kind == shared::kKindInstance) {
            const uint32_t object = packed_.instances[first].object;
            return moved[object] ? std::optional(instances_->placed().of(object).box) : std::nullopt;
        }
        if (kind != shared::kKindTriangle) return std::nullopt;
        const uint32_t end = first + (leaf >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
        bool anyMoved = false;
        Box box;
        for (uint32_t i = first; i < end; ++i) {
            if (moved[packed_.triangleSurfaces[i].object]) {
                anyMoved = true;
                if (!moveTriangle(scene, numbers, i)) allKept = false;
            }
            const shared::Triangle& triangle = packed_.triangles[i];
            Box tight;
            for (const glm::vec3& corner : {triangle.v0, triangle.v1, triangle.v2}) tight.include(corner);
            box.include(withEdgeMargin(tight));
        }
        return anyMoved ? std::optional(box) : std::nullopt;
    };
    const std::span nodes = std::span(packed_.nodes).first(instances_->firstNode(packed_));
    const RefitResult result = refitNodes(nodes, BvhOptions{}.traversalCost, leafBox, context);
    packed_.boundsLo = result.box.lo;
    packed_.boundsHi = result.box.hi;
    packed_.statistics.sahCost = result.cost;
    const glm::vec3 size = result.box.hi - result.box.lo;
    const bool isTiny = std::max({size.x, size.y, size.z}) < kMinSceneSize;  // packing refuses it
    return allKept && !isTiny && !(result.cost > kMostGrowth * builtCost_);
}

bool MovingScene::update(const Scene& scene, std::vector<bool> moved, const Context& context) {
    if (!knows(scene, moved)) return false;
    measure(scene, moved, context);
    const PrimitiveNumbers numbers(scene);
    if (!followOrigin(scene, numbers, moved, context)) return false;
    eye_ = scene.camera.eye;
    instances_->place(scene, numbers, packed_.origin, context);
    if (!instances_->move(packed_) || !droppedStaySo(scene, moved)) return false;
    if (!moveLeaves(scene, numbers, moved, context)) return false;
    packed_.lights = packLights(scene.lights, packed_.origin);
    if (packed_.lights.size() != packed_.environment.lightCount) return false;
    if (!packed_.features.slivers && haveSlivers(packed_.triangles, context)) return false;
    if (packed_.features.mirrors)
        packed_.environment.radianceBound = radianceBound(packed_, packed_.environment, packed_.lights);
    return true;
}

}  // namespace glint
