#include "pack/primitives.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "pack/area_vector.h"
#include "pack/instances.h"
#include "pack/quadrics.h"
#include "pack/unit_vector.h"
#include "scene/limits.h"
#include "scene/polygon_plane.h"

namespace glint {
namespace {

enum class Fate : uint8_t { Absent, Kept, NoArea, NotFinite };

// Dropped primitives of one object.
struct Dropped {
    uint32_t object = 0;
    uint32_t noArea = 0, notFinite = 0;
};

struct ChunkCount {
    std::array<uint32_t, shared::kKindCount> kept{};
    std::vector<Dropped> dropped;
};

constexpr const char* kKindNames[shared::kKindCount] = {"triangles", "spheres",  "planes",   "discs",
                                                        "polygons",  "quadrics", "instances"};

// No area means collinear after rounding, exactly: a needle of any thinness that fp32 can tell from a line
// has a plane and a normal and is kept; a degenerate triangle has none, and watertight intersection tests
// would hit some of them (M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th ed., 6.5.3).
Fate judgeTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin) {
    const auto v = roundTriangle(world, origin);
    if (!v) return Fate::NotFinite;
    return areaVector((*v)[0], (*v)[1], (*v)[2]) == glm::dvec3(0) ? Fate::NoArea : Fate::Kept;
}

Fate judgeInstance(const Instances& instances, uint32_t object) {
    if (!instances.showsAnything(object)) return Fate::Absent;
    return instances.isFinite(object) ? Fate::Kept : Fate::NotFinite;
}

Fate judge(const Object& object, uint32_t face, const glm::dvec3& origin) {
    const TriangleSource source(object);
    if (source.any()) return judgeTriangle(source.vertices(face), origin);
    const auto* polygon = std::get_if<PolygonShape>(&object.shape);
    if (polygon == nullptr) return Fate::Kept;
    const auto vertices = roundPolygon(*polygon, origin);
    if (!vertices) return Fate::NotFinite;
    return polygonPlane(widened(*vertices)) ? Fate::Kept : Fate::NoArea;
}

ChunkCount judgeChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, size_t chunk,
                      std::vector<Fate>& fates) {
    ChunkCount count;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const uint8_t kind = kindOf(scene.objects[object]);
        if (kind == shared::kKindPlane) return;  // infinite: not in the BVH
        Fate* fate = &fates[numbers.firstItem(object)];
        Dropped dropped{object, 0, 0};
        for (uint32_t face = begin; face < end; ++face) {
            fate[face] = kind == shared::kKindInstance ? judgeInstance(*frame.instances, object)
                                                       : judge(scene.objects[object], face, frame.origin);
            count.kept[kind] += fate[face] == Fate::Kept;
            dropped.noArea += fate[face] == Fate::NoArea;
            dropped.notFinite += fate[face] == Fate::NotFinite;
        }
        if (dropped.noArea + dropped.notFinite > 0) count.dropped.push_back(dropped);
    });
    return count;
}

void warn(const Scene& scene, const PrimitiveNumbers& numbers, const Dropped& dropped,
          std::vector<std::string>& warnings) {
    const std::string& name = scene.objects[dropped.object].name;
    const std::string where = name.empty() ? "/objects/" + std::to_string(dropped.object) : name;
    const std::string of = " of " + std::to_string(numbers.facesOf(dropped.object)) + " " +
                           kKindNames[kindOf(scene.objects[dropped.object])] + " dropped: ";
    if (dropped.noArea > 0)
        warnings.push_back(where + ": " + std::to_string(dropped.noArea) + of +
                           "no area after rounding to fp32");
    if (dropped.notFinite > 0)
        warnings.push_back(where + ": " + std::to_string(dropped.notFinite) + of +
                           "a vertex is not finite or beyond the range of fp32");
}

void reportDropped(const Scene& scene, const PrimitiveNumbers& numbers, const std::vector<ChunkCount>& counts,
                   PackStatistics& statistics, std::vector<std::string>& warnings) {
    std::vector<Dropped> perObject;
    for (const ChunkCount& count : counts) {
        for (const Dropped& d : count.dropped) {
            if (perObject.empty() || perObject.back().object != d.object)
                perObject.push_back({d.object, 0, 0});
            perObject.back().noArea += d.noArea;
            perObject.back().notFinite += d.notFinite;
            statistics.droppedZeroArea += d.noArea;
            statistics.droppedNotFinite += d.notFinite;
        }
    }
    for (const Dropped& d : perObject) warn(scene, numbers, d, warnings);
}

Box withEdgeMargin(Box tight) {
    const float margin = edgeMargin(tight);
    tight.lo -= margin;
    tight.hi += margin;
    return tight;
}

// Of the rounded primitive, and what the device may take for it.
Box boxOf(const Object& object, uint32_t face, const Frame& frame) {
    if (const auto* sphere = std::get_if<SphereShape>(&object.shape))
        return sphereBox(roundSphere(*sphere, frame));
    if (const auto* disc = std::get_if<DiscShape>(&object.shape)) return discBox(roundDisc(*disc, frame));
    if (const auto* polygon = std::get_if<PolygonShape>(&object.shape)) {
        const auto vertices = roundPolygon(*polygon, frame.origin).value();
        const PolygonPlane plane = polygonPlane(widened(vertices)).value();
        return withEdgeMargin(polygonBox(vertices, glm::vec3(plane.point), glm::vec3(plane.normal)));
    }
    if (isQuadric(object.shape)) return quadricBox(object, frame, roundQuadric(object, frame));
    Box box;
    const Corners corners = roundTriangle(TriangleSource(object).vertices(face), frame.origin).value();
    for (const glm::vec3& p : corners) box.include(p);
    return withEdgeMargin(box);
}

// Writes the chunk's primitives from position `next` on.
void collectChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, size_t chunk,
                  const std::vector<Fate>& fates, size_t next, Primitives& out) {
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const Fate* fate = &fates[numbers.firstItem(object)];
        const uint8_t kind = kindOf(scene.objects[object]);
        for (uint32_t face = begin; face < end; ++face) {
            if (fate[face] != Fate::Kept) continue;
            out.boxes[next] = kind == shared::kKindInstance ? frame.instances->box(object)
                                                            : boxOf(scene.objects[object], face, frame);
            out.kinds[next] = kind;
            out.sources[next++] = {object, face};
        }
    });
}

std::optional<glm::vec3> roundPoint(const glm::dvec3& p) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    // NaN compares false.
    if (!(std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest))
        return std::nullopt;
    return glm::vec3(p);
}

// Outwards by the margin and one float.
void setRounded(Box& box, int axis, double center, double extent, double margin) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    box.lo[axis] = std::nextafter(static_cast<float>(center - extent - margin), -kInf);
    box.hi[axis] = std::nextafter(static_cast<float>(center + extent + margin), kInf);
}

}  // namespace

PrimitiveNumbers::PrimitiveNumbers(const Scene& scene) {
    uint64_t id = 0, item = 0;
    first_.reserve(scene.objects.size() + 1);
    ids_.reserve(scene.objects.size());
    for (const Object& object : scene.objects) {
        first_.push_back(static_cast<uint32_t>(item));
        ids_.push_back(static_cast<uint32_t>(id));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        const size_t faces = mesh != nullptr ? mesh->mesh->corners.size() : 1;
        id += faces;
        item += object.transform ? 1 : faces;
        checkLimit("primitives", id, shared::kNone - 1);
    }
    first_.push_back(static_cast<uint32_t>(item));
}

void checkLimit(const char* what, uint64_t count, uint64_t limit) {
    if (count <= limit) return;
    throw Error(ErrorKind::Scene, std::string(what) + ": the scene has " + std::to_string(count) +
                                      ", the limit is " + std::to_string(limit) + "; leave some out");
}

float edgeMargin(const Box& tight) {
    const glm::dvec3 extent = glm::dvec3(tight.hi) - glm::dvec3(tight.lo);
    return static_cast<float>(16 * 0x1p-24 * std::max({extent.x, extent.y, extent.z}));
}

std::optional<Corners> roundTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin) {
    Corners corners{};
    for (size_t i = 0; i < 3; ++i) {
        const auto p = roundPoint(world[i] - origin);
        if (!p) return std::nullopt;
        corners[i] = *p;
    }
    return corners;
}

shared::Sphere roundSphere(const SphereShape& sphere, const Frame& frame) {
    shared::Sphere out;
    out.radius = static_cast<float>(sphere.radius);
    const glm::dvec3 toEye = frame.eye - sphere.center;
    const double distance = glm::length(toEye);
    glm::dvec3 point = sphere.center;
    if (std::abs(distance - sphere.radius) < sphere.radius / 64) {
        const glm::dvec3 normal = toEye / distance;  // not 0: more than 63/64 of the radius
        point += sphere.radius * normal;
        out.anchorNormal = glm::vec3(normal);
    }
    out.point = glm::vec3(point - frame.origin);
    return out;
}

Box sphereBox(const shared::Sphere& sphere) {
    // The anchored form is the sphere about point - r n of radius r |n|: |n| is 1 but for its rounding.
    glm::dvec3 center(sphere.point);
    double radius = sphere.radius;
    const glm::dvec3 normal(sphere.anchorNormal);
    if (normal != glm::dvec3(0)) {
        center -= radius * normal;
        radius *= glm::length(normal);
    }
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        // Six roundings in double, each of at most 2^-53 times a quantity below |centre| + 3 radius.
        const double margin = 0x1p-50 * (std::abs(center[axis]) + 3 * radius);
        setRounded(box, axis, center[axis], radius, margin);
    }
    return box;
}

shared::Disc roundDisc(const DiscShape& disc, const Frame& frame) {
    shared::Disc out;
    out.center = glm::vec3(disc.center - frame.origin);
    out.normal = glm::vec3(unitVector(disc.normal).value());
    out.radius = static_cast<float>(disc.radius);
    return out;
}

glm::dvec3 discExtent(const glm::dvec3& normal, double radius) {
    // The greatest e.x of unit vectors x perpendicular to n is the length of e's part in the plane, the sine
    // of the angle to n: as a length of the other two components, since 1 - n_i^2 would cancel.
    const glm::dvec3 n = unitVector(normal).value();
    return radius * glm::dvec3(std::hypot(n.y, n.z), std::hypot(n.z, n.x), std::hypot(n.x, n.y));
}

Box discBox(const shared::Disc& disc) {
    const glm::dvec3 center(disc.center);
    const glm::dvec3 extent = discExtent(glm::dvec3(disc.normal), disc.radius);
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        if (extent[axis] == 0) {
            box.lo[axis] = box.hi[axis] = disc.center[axis];
        } else {
            // Eight roundings in double of quantities below |centre| + radius.
            setRounded(box, axis, center[axis], extent[axis],
                       0x1p-50 * (std::abs(center[axis]) + disc.radius));
        }
    }
    return box;
}

std::optional<std::vector<glm::vec3>> roundPolygon(const PolygonShape& polygon, const glm::dvec3& origin) {
    std::vector<glm::vec3> rounded;
    rounded.reserve(polygon.vertices.size());
    for (const glm::dvec3& vertex : polygon.vertices) {
        const auto p = roundPoint(vertex - origin);
        if (!p) return std::nullopt;
        rounded.push_back(*p);
    }
    return rounded;
}

std::vector<glm::dvec3> widened(const std::vector<glm::vec3>& vertices) {
    return {vertices.begin(), vertices.end()};
}

Box polygonBox(const std::vector<glm::vec3>& vertices, const glm::vec3& point, const glm::vec3& normal) {
    Box box;
    const glm::dvec3 n(normal);
    for (const glm::vec3& vertex : vertices) {
        box.include(vertex);
        const glm::dvec3 v(vertex);
        const glm::dvec3 onPlane = v - glm::dot(n, v - glm::dvec3(point)) / glm::dot(n, n) * n;
        if (onPlane == v) continue;
        for (int axis = 0; axis < 3; ++axis) {
            Box reach = box;
            // Four roundings in double of coordinates and of the way between them.
            setRounded(reach, axis, onPlane[axis], 0, 0x1p-50 * std::abs(onPlane[axis]));
            if (onPlane[axis] < box.lo[axis]) box.lo[axis] = reach.lo[axis];
            if (onPlane[axis] > box.hi[axis]) box.hi[axis] = reach.hi[axis];
        }
    }
    return box;
}

uint32_t polygonTrips(size_t vertices) {
    static_assert(kMaxPolygonVertices == shared::kMaxPolygonTrips * shared::kPolygonEdgesPerTrip);
    constexpr uint32_t kEdges = shared::kPolygonEdgesPerTrip;
    return (static_cast<uint32_t>(vertices) + kEdges - 1) / kEdges;
}

uint8_t kindOf(const Object& object) {
    const uint8_t kind = kindOf(object.shape);
    return object.transform && kind != shared::kKindQuadric ? uint8_t{shared::kKindInstance} : kind;
}

uint8_t kindOf(const Shape& shape) {
    struct Kind {
        uint32_t operator()(const SphereShape&) const { return shared::kKindSphere; }
        uint32_t operator()(const PlaneShape&) const { return shared::kKindPlane; }
        uint32_t operator()(const DiscShape&) const { return shared::kKindDisc; }
        uint32_t operator()(const TriangleShape&) const { return shared::kKindTriangle; }
        uint32_t operator()(const PolygonShape&) const { return shared::kKindPolygon; }
        uint32_t operator()(const QuadricShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const EllipsoidShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const CylinderShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const ConeShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const HyperboloidShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const ParaboloidShape&) const { return shared::kKindQuadric; }
        uint32_t operator()(const MeshShape&) const { return shared::kKindTriangle; }
    };
    return static_cast<uint8_t>(std::visit(Kind{}, shape));
}

Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             unsigned threads, PackStatistics& statistics,
                             std::vector<std::string>& warnings) {
    std::vector<Fate> fates(numbers.total(), Fate::Absent);
    std::vector<ChunkCount> counts(numbers.chunks());
    const auto judge = [&](size_t i) { counts[i] = judgeChunk(scene, numbers, frame, i, fates); };
    parallelFor(counts.size(), judge, threads);
    reportDropped(scene, numbers, counts, statistics, warnings);

    Primitives out;
    uint64_t total = 0;
    std::vector<size_t> first;
    for (const ChunkCount& count : counts) {
        first.push_back(total);
        for (uint32_t kind = 0; kind < shared::kKindCount; ++kind) {
            out.counts[kind] += count.kept[kind];
            total += count.kept[kind];
        }
    }
    for (uint32_t kind = 0; kind < shared::kKindCount; ++kind)
        checkLimit(kKindNames[kind], out.counts[kind], uint64_t{shared::kLeafFirstMask} + 1);

    out.boxes.resize(total);
    out.kinds.resize(out.boxes.size());
    out.sources.resize(out.boxes.size());
    const auto collect = [&](size_t i) { collectChunk(scene, numbers, frame, i, fates, first[i], out); };
    parallelFor(counts.size(), collect, threads);
    return out;
}

}  // namespace glint
