#include "pack/instances.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "core/parallel.h"
#include "core/vectors.h"
#include "pack/extent.h"
#include "pack/pack_geometry.h"
#include "pack/scene_arrays.h"
#include "scene/transform.h"

namespace glint {
namespace {

// Boxes of a prototype's top that each instance's box encloses after the transform. Measured,
// docs/lab/building.md.
constexpr size_t kTopBoxes = 64;

// The boxes of `most` or fewer nodes that enclose everything between them, the greatest split first.
std::vector<Box> topBoxes(const std::vector<shared::Node>& nodes, size_t most) {
    struct Child {
        Box box;
        uint32_t child;
        bool isNode() const { return (child & shared::kLeafFlag) == 0; }
    };
    std::vector<Child> cut;
    const auto add = [&](const shared::Node& node) {
        cut.push_back({{node.lo0, node.hi0}, node.child0});
        if (node.child1 != shared::kNone) cut.push_back({{node.lo1, node.hi1}, node.child1});
    };
    if (!nodes.empty()) add(nodes[0]);
    while (cut.size() < most) {
        const auto worth = [](const Child& c) { return c.isNode() ? c.box.halfArea() : -1.0; };
        const auto next = std::max_element(
            cut.begin(), cut.end(), [&](const Child& a, const Child& b) { return worth(a) < worth(b); });
        if (next == cut.end() || !next->isNode()) break;
        const shared::Node& node = nodes[next->child];
        cut.erase(next);
        add(node);
    }
    std::vector<Box> boxes;
    for (const Child& c : cut) boxes.push_back(c.box);
    return boxes;
}

// Its mesh, or null for a disc: all of these are the unit disc (scene/placement.h).
const Mesh* prototypeKey(const Object& object) {
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    return mesh != nullptr ? mesh->mesh.get() : nullptr;
}

Prototype packPrototype(const Object& object, const Scene& scene, uint32_t maxLevels,
                        const PackOptions& options, const Context& context) {
    Scene alone;
    alone.objects.push_back({object.name, object.shape, 0, std::nullopt});
    // Each instance may have its own material, so texture coordinates are kept if any material uses them.
    alone.materials.assign(scene.materials.size(), {});
    const auto textured = std::find_if(scene.materials.begin(), scene.materials.end(), hasTexture);
    if (textured != scene.materials.end()) alone.materials.assign(scene.materials.size(), *textured);
    const PrimitiveNumbers numbers(alone);
    checkLimit("primitives of an object that is stored once", numbers.total(), uint64_t{1} << maxLevels);
    const Extent extent = objectExtents(alone, numbers, {}, context).front();
    Prototype prototype;
    PackedScene& packed = prototype.geometry;
    if (extent.empty()) return prototype;
    packed.origin = originOf(extent.center(), extent.halfSize(), 0);
    // Seen from its middle: no form of rounding may depend on where the camera is.
    const Frame frame{packed.origin, extent.center(), nullptr};
    Materials unused(scene.materials.size());
    packGeometry(alone, numbers, frame, maxLevels, options, context, packed, unused);
    prototype.boxes = topBoxes(packed.nodes, kTopBoxes);
    return prototype;
}

// First index of a part's arrays in the whole.
struct Bases {
    std::array<uint32_t, shared::kKindCount> kinds;
    uint32_t nodes, vertexNormals, polygonVertices, vertexAttributes;
};

uint32_t sizeOf(const auto& array) {
    return static_cast<uint32_t>(array.size());
}

Bases basesIn(const PackedScene& packed) {
    Bases bases{};
    visitPrimitiveArrays(packed, [&](shared::PrimitiveKind kind, const auto& array) {
        bases.kinds[static_cast<size_t>(kind)] = sizeOf(array);
    });
    bases.nodes = sizeOf(packed.nodes);
    bases.vertexNormals = sizeOf(packed.vertexNormals);
    bases.vertexAttributes = sizeOf(packed.vertexAttributes);
    bases.polygonVertices = sizeOf(packed.polygonVertices);
    return bases;
}

uint32_t movedChild(uint32_t child, const Bases& bases) {
    if (child == shared::kNone) return child;
    if ((child & shared::kLeafFlag) == 0) return child + bases.nodes;
    return child + bases.kinds[child >> shared::kLeafKindShift & shared::kLeafKindMask];
}

template <class T>
void appendArray(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
    from = {};
}

void appendGeometry(PackedScene& to, PackedScene& part) {
    const Bases bases = basesIn(to);
    for (shared::Node& node : part.nodes) {
        node.child0 = movedChild(node.child0, bases);
        node.child1 = movedChild(node.child1, bases);
        if (node.escape != shared::kNone) node.escape += 2 * bases.nodes;
    }
    for (shared::TriangleSurface& surface : part.triangleSurfaces) {
        if (surface.vertexNormals != shared::kNone) surface.vertexNormals += bases.vertexNormals;
        if (surface.attributes != 0) surface.attributes += bases.vertexAttributes;
    }
    for (shared::Polygon& polygon : part.polygons) polygon.firstVertex += bases.polygonVertices;
    appendArray(to.nodes, part.nodes);
    appendArray(to.triangleSurfaces, part.triangleSurfaces);
    appendArray(to.vertexNormals, part.vertexNormals);
    appendArray(to.vertexAttributes, part.vertexAttributes);
    appendArray(to.polygonVertices, part.polygonVertices);
#define GLINT_APPEND(number, Kind, KINDS, kinds, one, many) appendArray(to.kinds, part.kinds);
    GLINT_PRIMITIVES(GLINT_APPEND, GLINT_APPEND)
#undef GLINT_APPEND
    to.polygonTripsPerLeaf = std::max(to.polygonTripsPerLeaf, part.polygonTripsPerLeaf);
    to.statistics.leaves += part.statistics.leaves;
    to.statistics.splitTriangles += part.statistics.splitTriangles;
    to.statistics.buildSeconds += part.statistics.buildSeconds;
    to.statistics.droppedZeroArea += part.statistics.droppedZeroArea;
    to.statistics.droppedNotFinite += part.statistics.droppedNotFinite;
    to.warnings.insert(to.warnings.end(), part.warnings.begin(), part.warnings.end());
    for (const uint32_t count : basesIn(to).kinds)
        checkLimit("primitives of a kind", count, uint64_t{shared::kLeafFirstMask} + 1);
}

// From the prototype's local coordinates to the world.
Affine fromLocal(const Affine& transform, const glm::dvec3& prototypeOrigin) {
    return then(translation(prototypeOrigin), transform);
}

Box worldBox(const std::vector<Box>& boxes, const glm::dmat3& linear, const glm::dvec3& place) {
    const glm::dmat3 size = magnitudes(linear);
    glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
    for (const Box& box : boxes) {
        const glm::dvec3 half = 0.5 * (glm::dvec3(box.hi) - glm::dvec3(box.lo));
        const glm::dvec3 center = linear * (glm::dvec3(box.lo) + half) + place;
        // A score of roundings in double of the transform's inverse and of these sums.
        const glm::dvec3 margin = 0x1p-47 * (size * (half + glm::abs(glm::dvec3(box.lo))) + glm::abs(place));
        lo = glm::min(lo, center - size * half - margin);
        hi = glm::max(hi, center + size * half + margin);
    }
    Box box;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    if (!(greatestMagnitude(lo) < std::numeric_limits<float>::max() &&
          greatestMagnitude(hi) < std::numeric_limits<float>::max()))
        return box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = std::nextafter(static_cast<float>(lo[i]), -kInf);
        box.hi[i] = std::nextafter(static_cast<float>(hi[i]), kInf);
    }
    return box;
}

}  // namespace

Instances::Instances(const Scene& scene, const PrimitiveNumbers& numbers, const PackOptions& options,
                     const Context& context) {
    placed_.slot.assign(scene.objects.size(), shared::kNone);
    std::map<const Mesh*, uint32_t> known;
    std::vector<const Object*> shown;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        if (kindOf(object) != shared::PrimitiveKind::Instance) continue;
        const auto [entry, fresh] = known.try_emplace(prototypeKey(object), sizeOf(shown));
        if (fresh) shown.push_back(&object);
        placed_.slot[i] = sizeOf(objects_);
        prototype_.push_back(entry->second);
        objects_.push_back(i);
    }
    if (shown.empty()) return;
    const uint32_t needed = static_cast<uint32_t>(std::bit_width(numbers.total())) + 4;
    depthOfPrototypes_ = kDepth - std::max(needed, kDepth / 2);
    const Context part = context.part(0, kPrototypesPart);
    for (size_t i = 0; i < shown.size(); ++i)
        prototypes_.push_back(
            packPrototype(*shown[i], scene, depthOfPrototypes_, options, part.step(i, shown.size())));
}

std::vector<glm::dvec3> Instances::corners(const Scene& scene, uint32_t object) const {
    const Prototype& prototype = prototypeOf(object);
    std::vector<glm::dvec3> corners;
    const Affine world = fromLocal(*scene.objects[object].transform, prototype.geometry.origin);
    Box box;
    for (const Box& part : prototype.boxes) box.include(part);
    for (int i = 0; i < 8 && !box.empty(); ++i) {
        const glm::dvec3 corner(i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                                i & 4 ? box.hi.z : box.lo.z);
        corners.push_back(apply(world, corner));
    }
    return corners;
}

// A device ray errs in the object's coordinates: by gamma_4 |W| |o - T| at its origin (one difference, then
// products and sums of three), by gamma_3 |W| |d| t at a distance t. Back in the world that is up to K (7 u
// |o - T| + 3 u r) on any axis, with K the greatest row sum of |W^-1| |W|, and r the reach of the box from T,
// since t |d| <= |o - T| + r. So a hit may lie that far outside of the box, and the ray's boxes are widened
// by 10 u K (|o| + B), B bounding |T| + r, which also covers the rounding of the sum.
PlacedInstance Instances::placedAt(const Scene& scene, uint32_t object, uint32_t id,
                                   const glm::dvec3& origin) const {
    const Prototype& prototype = prototypeOf(object);
    const Affine world = fromLocal(*scene.objects[object].transform, prototype.geometry.origin);
    const glm::dmat3 rows = glm::transpose(inverse(world).linear);
    PlacedInstance placed;
    shared::Instance& row = placed.row;
    row.place = glm::vec3(world.offset - origin);
    row.toObjectX = glm::vec3(rows[0]);
    row.toObjectY = glm::vec3(rows[1]);
    row.toObjectZ = glm::vec3(rows[2]);
    // The rounded matrix defines the surface, so the way back is its inverse.
    const glm::dmat3 toObject = glm::transpose(
        glm::dmat3(glm::dvec3(row.toObjectX), glm::dvec3(row.toObjectY), glm::dvec3(row.toObjectZ)));
    const glm::dmat3 back = inverse({toObject, glm::dvec3(0)}).linear;
    const glm::dmat3 backRows = glm::transpose(back);
    row.toWorldX = glm::vec3(backRows[0]);
    row.toWorldY = glm::vec3(backRows[1]);
    row.toWorldZ = glm::vec3(backRows[2]);
    row.root = prototype_[placed_.slot[object]];
    row.idBase = id;
    row.mirrored = glm::dot(backRows[0], glm::cross(backRows[1], backRows[2])) < 0 ? 1 : 0;
    row.object = object;
    const Object& shown = scene.objects[object];
    const auto* mesh = std::get_if<MeshShape>(&shown.shape);
    row.material = mesh != nullptr && !mesh->mesh->materials.empty() ? shared::kNone : shown.material;
    if (prototype.boxes.empty()) return placed;
    placed.box = worldBox(prototype.boxes, back, glm::dvec3(row.place));
    placed.status = placed.box.empty() ? PrimitiveStatus::NotFinite : PrimitiveStatus::Kept;
    if (placed.box.empty()) return placed;
    placed.gain = greatestMagnitude(magnitudes(back) * (magnitudes(toObject) * glm::dvec3(1)));
    const glm::dvec3 far = glm::max(glm::abs(glm::dvec3(placed.box.lo)), glm::abs(glm::dvec3(placed.box.hi)));
    placed.reach = 2 * greatestMagnitude(row.place) + greatestMagnitude(far);
    return placed;
}

void Instances::place(const Scene& scene, const PrimitiveNumbers& numbers, const glm::dvec3& origin,
                      const Context& context) {
    placed_.instances.resize(objects_.size());
    const auto place = [&](size_t i) {
        placed_.instances[i] = placedAt(scene, objects_[i], numbers.firstId(objects_[i]), origin);
    };
    parallelFor(context, objects_.size(), place);
}

void Instances::append(PackedScene& packed) {
    std::vector<uint32_t> roots, triangles;
    uint32_t depth = 0;
    ownNodes_ = packed.nodes.size();
    for (Prototype& prototype : prototypes_) {
        roots.push_back(sizeOf(packed.nodes));
        triangles.push_back(sizeOf(prototype.geometry.triangles) -
                            prototype.geometry.statistics.splitTriangles);
        packed.statistics.prototypeTriangles += triangles.back();
        depth = std::max(depth, prototype.geometry.statistics.depth);
        appendGeometry(packed, prototype.geometry);
    }
    packed.statistics.depth += depth;
    packed.statistics.prototypes = sizeOf(prototypes_);
    for (shared::Instance& row : packed.instances) {
        packed.statistics.instancedTriangles += triangles[row.root];
        row.root = roots[row.root];
    }
    setPads(packed);
}

bool Instances::move(PackedScene& packed) const {
    size_t shown = 0;
    for (const PlacedInstance& placed : placed_.instances) shown += placed.status == PrimitiveStatus::Kept;
    if (shown != packed.instances.size()) return false;
    for (shared::Instance& instance : packed.instances) {
        const PlacedInstance& placed = placed_.of(instance.object);
        if (placed.status != PrimitiveStatus::Kept) return false;
        const uint32_t root = instance.root;
        instance = placed.row;
        instance.root = root;
    }
    setPads(packed);
    return true;
}

void Instances::setPads(PackedScene& packed) const {
    double gain = 0, reach = 0;
    for (const PlacedInstance& placed : placed_.instances) {
        gain = std::max(gain, placed.gain);
        reach = std::max(reach, placed.reach);
    }
    constexpr double kRoundings = 10 * 0x1p-24;
    packed.environment.instancePad = static_cast<float>(kRoundings * gain);
    packed.environment.instancePadAtOrigin = static_cast<float>(std::min(kRoundings * gain * reach, 1e30));
    packed.instanceGain = gain;
}

}  // namespace glint
