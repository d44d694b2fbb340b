#include "reference/queries.h"

#include <algorithm>
#include <array>
#include <cmath>
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
// Extended: a point far from a small triangle cancels squares of its distance.
using Wide = glm::vec<3, Extended>;

// ---- Closest points

// u and v of the closest point by Voronoi regions (Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5).
template <class T>
std::pair<T, T> weightsOnTriangle(const glm::vec<3, T>& p, const glm::vec<3, T>& a, const glm::vec<3, T>& b,
                                  const glm::vec<3, T>& c) {
    const auto part = [](T of, T whole) { return whole > 0 ? of / whole : T{0}; };
    const glm::vec<3, T> ab = b - a, ac = c - a;
    const T d1 = glm::dot(ab, p - a), d2 = glm::dot(ac, p - a);
    if (d1 <= 0 && d2 <= 0) return {0, 0};
    const T d3 = glm::dot(ab, p - b), d4 = glm::dot(ac, p - b);
    if (d3 >= 0 && d4 <= d3) return {1, 0};
    const T vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {part(d1, d1 - d3), 0};
    const T d5 = glm::dot(ab, p - c), d6 = glm::dot(ac, p - c);
    if (d6 >= 0 && d5 <= d6) return {0, 1};
    const T vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, part(d2, d2 - d6)};
    const T va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        const T w = part(d4 - d3, (d4 - d3) + (d5 - d6));
        return {1 - w, w};
    }
    return {part(vb, va + vb + vc), part(vc, va + vb + vc)};
}

struct Corners {
    dvec3 a, b, c;
};

Corners cornersInWorld(const Model& model, uint32_t index, uint32_t instance) {
    const rows::Triangle& triangle = model.triangles[index];
    if (instance == shared::kNone) return {triangle.v0, triangle.v1, triangle.v2};
    const InstanceFrame frame(model.instances[instance]);
    return {frame.pointInWorld(triangle.v0), frame.pointInWorld(triangle.v1),
            frame.pointInWorld(triangle.v2)};
}

// The closest point of a triangle, with its u and v.
struct TrianglePoint {
    double u, v;
    dvec3 point;
};
TrianglePoint closestOnTriangle(const dvec3& point, const Corners& corners) {
    const Wide a(corners.a), b(corners.b), c(corners.c);
    const auto [u, v] = weightsOnTriangle(Wide(point), a, b, c);
    return {static_cast<double>(u), static_cast<double>(v), dvec3(a + u * (b - a) + v * (c - a))};
}

dvec3 closestOnSphere(const rows::Sphere& sphere, const dvec3& point) {
    const Wide center = Wide(sphere.point) - Extended{sphere.radius} * Wide(sphere.anchorNormal);
    const Wide away = Wide(point) - center;
    const Extended length = glm::length(away);
    const Wide outward = length > 0 ? away / length : Wide(0, 0, 1);
    return dvec3(center + Extended{sphere.radius} * outward);
}

class ClosestSearch {
  public:
    ClosestSearch(const Model& model, const dvec3& point) : model_(model), point_(point) {}

    std::optional<ClosestPoint> run() {
        if (model_.environment.root != shared::kNone)
            search(model_.environment.root, {point_, 1, shared::kNone});
        return best_;
    }

  private:
    struct Space {
        dvec3 point;       // the point in the coordinates of the instance
        double shrinkage;  // a squared distance in the world is at least so many times that here
        uint32_t instance;
    };

    void search(uint32_t root, const Space& space) {
        const auto square = [&](const rows::Node& node, int child) {
            const dvec3 away =
                glm::max(glm::max(loOf(node, child) - space.point, space.point - hiOf(node, child)), 0.0);
            return glm::dot(away, away) * space.shrinkage * (1 - 0x1p-40);
        };
        const auto limit = [&] {
            return best_ ? best_->hit.t * best_->hit.t : std::numeric_limits<double>::max();
        };
        traverse(*model_.nodes, root, square, limit, [&](const Leaf& leaf, double) {
            visitLeaf(leaf, space);
            return false;
        });
    }
    // False if a plane between the point and the triangle is too far, in double: closestPointOn takes several
    // times as long. The plane is normal to the way to the closest point, however that is rounded.
    bool mayBeCloser(uint32_t triangle, uint32_t instance) const {
        const Corners corners = cornersInWorld(model_, triangle, instance);
        const dvec3 a = corners.a - point_, b = corners.b - point_, c = corners.c - point_;
        const auto [u, v] = weightsOnTriangle(dvec3(0), a, b, c);
        const dvec3 way = a + u * (b - a) + v * (c - a);
        const double least = std::min({glm::dot(way, a), glm::dot(way, b), glm::dot(way, c)});
        const double size =
            glm::dot(glm::abs(way), glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c))));
        return !best_ || least - 0x1p-48 * size <= best_->hit.t * glm::length(way);
    }
    void visitLeaf(const Leaf& leaf, const Space& space) {
        for (uint32_t i = leaf.first; i < leaf.end; ++i) {
            if (leaf.kind == shared::PrimitiveKind::Instance) {
                const InstanceFrame frame(model_.instances[i]);
                search(model_.instances[i].root,
                       {frame.pointInObject(point_), 1 / (frame.stretch() * frame.stretch()), i});
                continue;
            }
            if (leaf.kind == shared::PrimitiveKind::Triangle && !mayBeCloser(i, space.instance)) continue;
            const uint32_t primitive = static_cast<uint32_t>(leaf.kind) << shared::kPrimitiveKindShift | i;
            const ClosestPoint found = closestPointOn(model_, primitive, space.instance, point_);
            if (!best_ || std::pair(found.hit.t, found.hit.id) < std::pair(best_->hit.t, best_->hit.id))
                best_ = found;
        }
    }

    const Model& model_;
    const dvec3 point_;
    std::optional<ClosestPoint> best_;
};

// ---- Points near surfaces

// A point in the coordinates of a tree, and how near is too near: `units` times u of the coordinates, and the
// error of getting there.
struct Probe {
    dvec3 point;
    double units;
    double slack;

    // For a surface with coordinates up to `size`.
    double reach(double size) const { return units * kFloatUnit * (greatestMagnitude(point) + size) + slack; }
};

Probe enterInstance(const rows::Instance& instance, const Probe& probe) {
    Probe inside{InstanceFrame(instance).pointInObject(probe.point), 16, 0};
    for (const dvec3& row : {instance.toObjectX, instance.toObjectY, instance.toObjectZ}) {
        const dvec3 sizes = glm::abs(row) * (glm::abs(probe.point) + glm::abs(instance.place));
        inside.slack = std::max(inside.slack, 16 * kFloatUnit * (sizes.x + sizes.y + sizes.z));
    }
    return inside;
}

bool isNearTriangle(const rows::Triangle& t, const Probe& probe) {
    const double size = std::max({greatestMagnitude(t.v0), greatestMagnitude(t.v1), greatestMagnitude(t.v2)});
    return glm::distance(probe.point, closestOnTriangle(probe.point, {t.v0, t.v1, t.v2}).point) <=
           probe.reach(size);
}

bool isNear(const Model& scene, uint32_t root, const Probe& probe) {
    if (root == shared::kNone || scene.nodes->empty()) return false;
    const auto enter = [&](const rows::Node& node, int child) {
        const dvec3 &lo = loOf(node, child), &hi = hiOf(node, child);
        const double reach = probe.reach(std::max(greatestMagnitude(lo), greatestMagnitude(hi)));
        for (int axis = 0; axis < 3; ++axis)
            if (probe.point[axis] < lo[axis] - reach || probe.point[axis] > hi[axis] + reach)
                return kNotEntered;
        return 0.0;
    };
    const auto visit = [&](const Leaf& leaf, double) {
        for (uint32_t i = leaf.first; i < leaf.end; ++i) {
            if (leaf.kind == shared::PrimitiveKind::Triangle && isNearTriangle(scene.triangles[i], probe))
                return true;
            if (leaf.kind == shared::PrimitiveKind::Instance &&
                isNear(scene, scene.instances[i].root, enterInstance(scene.instances[i], probe)))
                return true;
        }
        return false;
    };
    return traverse(
        *scene.nodes, root, enter, [] { return 0.0; }, visit);
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

bool hasClosestPoint(shared::PrimitiveKind kind) {
    return kind == shared::PrimitiveKind::Triangle || kind == shared::PrimitiveKind::Sphere;
}

ClosestPoint closestPointOn(const Model& model, uint32_t primitive, uint32_t instance, const dvec3& point) {
    ClosestPoint closest;
    closest.hit.primitive = primitive;
    closest.hit.instance = instance;
    const uint32_t index = primitive & shared::kPrimitiveIndexMask;
    if (kindOfPrimitive(primitive) == shared::PrimitiveKind::Sphere) {
        closest.hit.id = model.spheres[index].id;
        closest.point = closestOnSphere(model.spheres[index], point);
    } else {
        closest.hit.id = model.triangles[index].id;
        if (instance != shared::kNone) closest.hit.id += model.instances[instance].idBase;
        const TrianglePoint found = closestOnTriangle(point, cornersInWorld(model, index, instance));
        closest.point = found.point;
        closest.hit.u = found.u;
        closest.hit.v = found.v;
        if (isMirrored(model, instance)) std::swap(closest.hit.u, closest.hit.v);
    }
    closest.hit.t = glm::length(closest.point - point);
    return closest;
}

std::optional<ClosestPoint> closestPoint(const Model& model, const dvec3& point) {
    return ClosestSearch(model, point).run();
}

std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray) {
    std::vector<Hit> hits = tracer.allHits(ray);
    std::erase_if(hits, [&](const Hit& hit) { return !tracer.crosses(ray, hit); });
    return hits;
}

bool touches(const Tracer& tracer, const dvec3& point) {
    const Model& scene = tracer.model();
    if (isNear(scene, scene.environment.root, {point, 4, 0})) return true;
    if (!hasOtherSurfaces(scene)) return false;
    const double reach = 4 * kFloatUnit *
                         (greatestMagnitude(point) + std::max(greatestMagnitude(dvec3(scene.boundsLo)),
                                                              greatestMagnitude(dvec3(scene.boundsHi))));
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
