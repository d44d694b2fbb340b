#include "reference/closest_point.h"

#include <algorithm>
#include <utility>

#include "reference/instance.h"
#include "reference/intersect.h"
#include "reference/precision.h"
#include "reference/primitives.h"

namespace glint::reference {

namespace {

using glm::dvec3;
// Extended: a point far from a small triangle cancels squares of its distance.
using Wide = glm::vec<3, Extended>;

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

dvec3 closestOnSphere(const rows::Sphere& sphere, const dvec3& point) {
    const Wide center = Wide(sphere.point) - Extended{sphere.radius} * Wide(sphere.anchorNormal);
    const Wide away = Wide(point) - center;
    const Extended length = glm::length(away);
    const Wide outward = length > 0 ? away / length : Wide(0, 0, 1);
    return dvec3(center + Extended{sphere.radius} * outward);
}

// Depth first, the nearer child first.
class Search {
  public:
    Search(const Model& model, const dvec3& point) : model_(model), point_(point) {}

    std::optional<ClosestPoint> run() {
        if (model_.environment.root != shared::kNone)
            visit(model_.environment.root, {point_, 1, shared::kNone});
        return best_;
    }

  private:
    struct Space {
        dvec3 point;       // the point in the coordinates of the instance
        double shrinkage;  // a squared distance in the world is at least so many times that here
        uint32_t instance;
    };

    static double squareTo(const Space& space, const dvec3& lo, const dvec3& hi) {
        const dvec3 away = glm::max(glm::max(lo - space.point, space.point - hi), 0.0);
        return glm::dot(away, away) * space.shrinkage;
    }
    void visit(uint32_t child, const Space& space) {
        if (child & shared::kLeafFlag) return visitLeaf(child, space);
        const rows::Node& node = (*model_.nodes)[child];
        std::pair<double, uint32_t> children[] = {{squareTo(space, node.lo0, node.hi0), node.child0},
                                                  {squareTo(space, node.lo1, node.hi1), node.child1}};
        if (children[1].first < children[0].first) std::swap(children[0], children[1]);
        for (const auto& [square, next] : children)
            if (next != shared::kNone && (!best_ || square * (1 - 0x1p-40) <= best_->hit.t * best_->hit.t))
                visit(next, space);
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
    void visitLeaf(uint32_t leaf, const Space& space) {
        const uint32_t kind = leaf >> shared::kLeafKindShift & shared::kLeafKindMask;
        const uint32_t first = leaf & shared::kLeafFirstMask;
        const uint32_t count = (leaf >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
        for (uint32_t i = first; i < first + count; ++i) {
            if (kind == shared::kKindInstance) {
                const InstanceFrame frame(model_.instances[i]);
                visit(model_.instances[i].root, {frame.enterInstance(Ray{.origin = point_}).origin,
                                                 1 / (frame.stretch() * frame.stretch()), i});
                continue;
            }
            if (kind == shared::kKindTriangle && !mayBeCloser(i, space.instance)) continue;
            const ClosestPoint found =
                closestPointOn(model_, kind << shared::kPrimitiveKindShift | i, space.instance, point_);
            if (!best_ || std::pair(found.hit.t, found.hit.id) < std::pair(best_->hit.t, best_->hit.id))
                best_ = found;
        }
    }

    const Model& model_;
    const dvec3 point_;
    std::optional<ClosestPoint> best_;
};

}  // namespace

dvec3 closestOnTriangle(const dvec3& point, const dvec3& a, const dvec3& b, const dvec3& c) {
    const Wide from(a);
    const auto [u, v] = weightsOnTriangle(Wide(point), from, Wide(b), Wide(c));
    return dvec3(from + u * (Wide(b) - from) + v * (Wide(c) - from));
}

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
        const Corners corners = cornersInWorld(model, index, instance);
        const Wide a(corners.a), b(corners.b), c(corners.c);
        const auto [u, v] = weightsOnTriangle(Wide(point), a, b, c);
        closest.point = dvec3(a + u * (b - a) + v * (c - a));
        closest.hit.u = static_cast<double>(u);
        closest.hit.v = static_cast<double>(v);
        if (isMirrored(model, instance)) std::swap(closest.hit.u, closest.hit.v);
    }
    closest.hit.t = glm::length(closest.point - point);
    return closest;
}

std::optional<ClosestPoint> closestPoint(const Model& model, const dvec3& point) {
    return Search(model, point).run();
}

}  // namespace glint::reference
