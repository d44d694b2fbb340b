#include "reference/queries.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/vectors.h"
#include "pack/scene_arrays.h"
#include "reference/instance.h"
#include "reference/intersect.h"
#include "reference/rounding.h"
#include "reference/traverse.h"

namespace glint::reference {

namespace {

using glm::dvec3;

// ---- Closest points

// In extended precision: a point far from a small triangle cancels squares of its distance.
using Wide = glm::vec<3, Extended>;

// The closest point of a triangle, with its u and v alone: the nearest of the closest points of its edges, or
// the foot of the perpendicular where that lies inside (barycentric coordinates: Heidrich, "Computing the
// Barycentric Coordinates of a Projected Point", JGT 10(3), 2005). Of a needle rounding decides where it
// lies, but the edges' points stay close.
ClosestPoint closestOnTriangle(const dvec3& point, const dvec3& a, const dvec3& b, const dvec3& c) {
    const Wide ab = Wide(b) - Wide(a), ac = Wide(c) - Wide(a), bc = Wide(c) - Wide(b);
    const Wide fromA = Wide(point) - Wide(a), fromB = Wide(point) - Wide(b), normal = glm::cross(ab, ac);
    const auto along = [](const Wide& from, const Wide& edge) {
        const Extended square = glm::dot(edge, edge);
        return square > 0 ? glm::clamp(glm::dot(from, edge) / square, Extended{0}, Extended{1}) : Extended{0};
    };
    Extended u = 0, v = 0, least = std::numeric_limits<Extended>::infinity();
    const auto offer = [&](Extended atU, Extended atV) {
        const Wide away = fromA - atU * ab - atV * ac;
        if (!(glm::dot(away, away) < least)) return;
        least = glm::dot(away, away);
        u = atU;
        v = atV;
    };
    offer(along(fromA, ab), 0);
    offer(0, along(fromA, ac));
    const Extended w = along(fromB, bc);
    offer(1 - w, w);
    const Extended square = glm::dot(normal, normal);
    const Extended footU = glm::dot(glm::cross(fromA, ac), normal),
                   footV = glm::dot(glm::cross(ab, fromA), normal);
    if (footU > 0 && footV > 0 && footU + footV < square) offer(footU / square, footV / square);
    return {{.u = static_cast<double>(u), .v = static_cast<double>(v)}, dvec3(Wide(a) + u * ab + v * ac)};
}

// A triangle of the world, or of an instance with its corners and id in the world.
rows::Triangle triangleInWorld(const Model& model, uint32_t primitive, uint32_t instance) {
    rows::Triangle triangle = model.triangles[primitive & shared::kPrimitiveIndexMask];
    if (instance == shared::kNone) return triangle;
    const InstanceFrame frame(model.instances[instance]);
    for (dvec3* v : {&triangle.v0, &triangle.v1, &triangle.v2}) *v = frame.pointInWorld(*v);
    triangle.id += model.instances[instance].idBase;
    return triangle;
}

// Visits the primitives of the tree below `root`, of the world or an instance, and of instances in it: those
// in boxes that are at most limit() away from the point. Ends, with true, when visit(primitive, instance)
// returns true.
template <class Limit, class Visit>
bool visitNear(const Model& model, uint32_t root, uint32_t instance, const dvec3& point, const Limit& limit,
               const Visit& visit) {
    dvec3 inside = point;
    double stretch = 1;
    if (instance != shared::kNone) {
        const InstanceFrame frame(model.instances[instance]);
        inside = frame.pointInObject(point);
        stretch = frame.stretch();
    }
    // At most the distance to a child's box in the world.
    const auto distance = [&](const rows::Node& node, int child) {
        const dvec3 away = glm::max(glm::max(loOf(node, child) - inside, inside - hiOf(node, child)), 0.0);
        return glm::length(away) / stretch * (1 - 0x1p-40);
    };
    const auto visitOne = [&](shared::PrimitiveKind kind, uint32_t i) {
        if (kind == shared::PrimitiveKind::Instance)
            return visitNear(model, model.instances[i].root, i, point, limit, visit);
        return visit(static_cast<uint32_t>(kind) << shared::kPrimitiveKindShift | i, instance);
    };
    const auto visitLeaf = [&](const Leaf& leaf, double) {
        for (uint32_t i = leaf.first; i < leaf.end; ++i)
            if (visitOne(leaf.kind, i)) return true;
        return false;
    };
    return root != shared::kNone && traverse(*model.nodes, root, distance, limit, visitLeaf);
}

// ---- Points near surfaces

double sizeOf(const Model& scene) {
    return std::max(greatestMagnitude(scene.boundsLo), greatestMagnitude(scene.boundsHi));
}

bool isNearTriangle(const Model& scene, const dvec3& point) {
    const double own = greatestMagnitude(point);
    const auto reach = [&](double size, bool placed) {
        const double pad = scene.environment.instancePad * own + scene.environment.instancePadAtOrigin;
        return 4 * kFloatUnit * (own + size) + (placed ? pad : 0);
    };
    const double most = reach(sizeOf(scene), true);
    const auto visit = [&](uint32_t primitive, uint32_t instance) {
        if (kindOfPrimitive(primitive) != shared::PrimitiveKind::Triangle) return false;
        const auto t = triangleInWorld(scene, primitive, instance);
        const double size =
            std::max({greatestMagnitude(t.v0), greatestMagnitude(t.v1), greatestMagnitude(t.v2)});
        return glm::distance(point, closestOnTriangle(point, t.v0, t.v1, t.v2).point) <=
               reach(size, instance != shared::kNone);
    };
    return visitNear(
        scene, scene.environment.root, shared::kNone, point, [&] { return most; }, visit);
}

bool hasOtherSurfaces(const Model& scene) {
    bool has = false;
    visitPrimitiveArrays(scene, [&](shared::PrimitiveKind kind, const auto& array) {
        has |= !array.empty() && kind != shared::PrimitiveKind::Triangle &&
               kind != shared::PrimitiveKind::Instance;
    });
    return has;
}

}  // namespace

ClosestPoint closestPointOn(const Model& model, uint32_t primitive, uint32_t instance, const dvec3& point) {
    ClosestPoint closest;
    if (kindOfPrimitive(primitive) == shared::PrimitiveKind::Sphere) {
        const rows::Sphere& sphere = model.spheres[primitive & shared::kPrimitiveIndexMask];
        const Wide center = Wide(sphere.point) - Extended{sphere.radius} * Wide(sphere.anchorNormal);
        const Wide away = Wide(point) - center;
        const Extended length = glm::length(away);
        closest.point =
            dvec3(center + Extended{sphere.radius} * (length > 0 ? away / length : Wide(0, 0, 1)));
        closest.hit.id = sphere.id;
    } else {
        const rows::Triangle triangle = triangleInWorld(model, primitive, instance);
        closest = closestOnTriangle(point, triangle.v0, triangle.v1, triangle.v2);
        closest.hit.id = triangle.id;
        if (isMirrored(model, instance)) std::swap(closest.hit.u, closest.hit.v);
    }
    closest.hit.primitive = primitive;
    closest.hit.instance = instance;
    closest.hit.t = glm::length(closest.point - point);
    return closest;
}

ClosestPoint closestPoint(const Model& model, const dvec3& point) {
    ClosestPoint best;
    best.hit.t = std::numeric_limits<double>::max();
    visitNear(
        model, model.environment.root, shared::kNone, point, [&] { return best.hit.t; },
        [&](uint32_t primitive, uint32_t instance) {
            const ClosestPoint found = closestPointOn(model, primitive, instance, point);
            if (std::pair(found.hit.t, found.hit.id) < std::pair(best.hit.t, best.hit.id)) best = found;
            return false;
        });
    return best;
}

std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray) {
    std::vector<Hit> hits = tracer.allHits(ray);
    std::erase_if(hits, [&](const Hit& hit) { return !tracer.crosses(ray, hit); });
    return hits;
}

bool touches(const Tracer& tracer, const dvec3& point) {
    const Model& scene = tracer.model();
    if (isNearTriangle(scene, point)) return true;
    if (!hasOtherSurfaces(scene)) return false;
    const double reach = 4 * kFloatUnit * (greatestMagnitude(point) + sizeOf(scene));
    for (int axis = 0; axis < 3; ++axis) {
        Ray ray;
        ray.origin = point;
        ray.origin[axis] -= reach;
        ray.direction = dvec3(0);
        ray.direction[axis] = 1;
        ray.tMax = 2 * reach;
        if (tracer.occluded(ray)) return true;
    }
    return false;
}

}  // namespace glint::reference
