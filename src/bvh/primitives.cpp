#include "bvh/primitives.h"

#include <cmath>
#include <limits>

#include "bvh/area_vector.h"
#include "core/error.h"
#include "core/parallel.h"

namespace glint {
namespace {

enum class Fate : uint8_t { Absent, Triangle, Sphere, NoArea, NotFinite };

// Dropped triangles of one object.
struct Dropped {
    uint32_t object = 0;
    uint32_t noArea = 0, notFinite = 0;
};

struct ChunkCount {
    uint32_t triangles = 0, spheres = 0;
    std::vector<Dropped> dropped;
};

// No area means collinear after rounding, exactly: a needle of any thinness that fp32 can tell from a line
// has a plane and a normal and is kept; a degenerate triangle has none, and watertight intersection tests
// would hit some of them (M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th ed., 6.5.3).
Fate judgeTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin) {
    const auto v = roundTriangle(world, origin);
    if (!v) return Fate::NotFinite;
    return areaVector((*v)[0], (*v)[1], (*v)[2]) == glm::dvec3(0) ? Fate::NoArea : Fate::Triangle;
}

ChunkCount judgeChunk(const Scene& scene, const PrimitiveNumbers& numbers, const glm::dvec3& origin,
                      size_t chunk, std::vector<Fate>& fates) {
    ChunkCount count;
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        Fate* fate = &fates[numbers.firstId(object)];
        const TriangleSource source(scene.objects[object]);
        if (!source.any()) {
            if (!std::holds_alternative<SphereShape>(scene.objects[object].shape)) return;
            fate[0] = Fate::Sphere;
            ++count.spheres;
            return;
        }
        Dropped dropped{object, 0, 0};
        for (uint32_t face = begin; face < end; ++face) {
            fate[face] = judgeTriangle(source.vertices(face), origin);
            count.triangles += fate[face] == Fate::Triangle;
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
    const std::string of = " of " + std::to_string(numbers.facesOf(dropped.object)) + " triangles dropped: ";
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

// Writes the chunk's primitives from position `next` on.
void collectChunk(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame, size_t chunk,
                  const std::vector<Fate>& fates, size_t next, Primitives& out) {
    numbers.visitChunk(chunk, [&](uint32_t object, uint32_t begin, uint32_t end) {
        const Fate* fate = &fates[numbers.firstId(object)];
        const TriangleSource source(scene.objects[object]);
        for (uint32_t face = begin; face < end; ++face) {
            if (fate[face] == Fate::Triangle) {
                const Corners corners = roundTriangle(source.vertices(face), frame.origin).value();
                for (const glm::vec3& p : corners) out.boxes[next].include(p);
                out.kinds[next] = shared::kKindTriangle;
            } else if (fate[face] == Fate::Sphere) {
                const auto& sphere = std::get<SphereShape>(scene.objects[object].shape);
                out.boxes[next] = sphereBox(roundSphere(sphere, frame));
                out.kinds[next] = shared::kKindSphere;
            } else {
                continue;
            }
            out.sources[next++] = {object, face};
        }
    });
}

}  // namespace

PrimitiveNumbers::PrimitiveNumbers(const Scene& scene) {
    uint64_t next = 0;
    first_.reserve(scene.objects.size() + 1);
    for (const Object& object : scene.objects) {
        first_.push_back(static_cast<uint32_t>(next));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        next += mesh != nullptr ? mesh->mesh->corners.size() : 1;
        checkLimit("primitives", next, shared::kNone - 1);
    }
    first_.push_back(static_cast<uint32_t>(next));
}

void checkLimit(const char* what, uint64_t count, uint64_t limit) {
    if (count <= limit) return;
    throw Error(ExitCode::Scene, std::string(what) + ": the scene has " + std::to_string(count) +
                                     ", the limit is " + std::to_string(limit) + "; leave some out");
}

std::optional<Corners> roundTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    Corners corners{};
    for (size_t i = 0; i < 3; ++i) {
        const glm::dvec3 p = world[i] - origin;
        // NaN compares false.
        if (!(std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest))
            return std::nullopt;
        corners[i] = glm::vec3(p);
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
        constexpr float kInf = std::numeric_limits<float>::infinity();
        box.lo[axis] = std::nextafter(static_cast<float>(center[axis] - radius - margin), -kInf);
        box.hi[axis] = std::nextafter(static_cast<float>(center[axis] + radius + margin), kInf);
    }
    return box;
}

Primitives collectPrimitives(const Scene& scene, const PrimitiveNumbers& numbers, const Frame& frame,
                             unsigned threads, PackStatistics& statistics,
                             std::vector<std::string>& warnings) {
    std::vector<Fate> fates(numbers.total(), Fate::Absent);
    std::vector<ChunkCount> counts(numbers.chunks());
    const auto judge = [&](size_t i) { counts[i] = judgeChunk(scene, numbers, frame.origin, i, fates); };
    parallelFor(counts.size(), judge, threads);
    reportDropped(scene, numbers, counts, statistics, warnings);

    uint64_t triangles = 0, spheres = 0;
    std::vector<size_t> first;
    for (const ChunkCount& count : counts) {
        first.push_back(triangles + spheres);
        triangles += count.triangles;
        spheres += count.spheres;
    }
    constexpr uint64_t kLimit = uint64_t{shared::kLeafFirstMask} + 1;
    checkLimit("triangles", triangles, kLimit);
    checkLimit("spheres", spheres, kLimit);

    Primitives out;
    out.triangles = static_cast<uint32_t>(triangles);
    out.spheres = static_cast<uint32_t>(spheres);
    out.boxes.resize(triangles + spheres);
    out.kinds.resize(out.boxes.size());
    out.sources.resize(out.boxes.size());
    const auto collect = [&](size_t i) { collectChunk(scene, numbers, frame, i, fates, first[i], out); };
    parallelFor(counts.size(), collect, threads);
    return out;
}

}  // namespace glint
