#include "reference/crossings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vectors.h"
#include "reference/closest_point.h"

namespace glint::reference {

namespace {

using glm::dvec3;

constexpr double kFloatRoundoff = 0x1p-24;

// A point in the coordinates of a tree, and how near is too near: `units` times u of the coordinates, and the
// error of getting there.
struct Probe {
    dvec3 point;
    double units;
    double slack;
};

class Proximity {
  public:
    explicit Proximity(const Model& scene) : scene_(scene) {}

    bool search(uint32_t root, const Probe& probe) const {
        if (root == shared::kNone || scene_.nodes->empty()) return false;
        std::vector<uint32_t> waiting{root};
        while (!waiting.empty()) {
            const rows::Node& node = (*scene_.nodes)[waiting.back()];
            waiting.pop_back();
            if (enter(node.child0, dvec3(node.lo0), dvec3(node.hi0), probe, waiting)) return true;
            if (enter(node.child1, dvec3(node.lo1), dvec3(node.hi1), probe, waiting)) return true;
        }
        return false;
    }

  private:
    bool enter(uint32_t child, const dvec3& lo, const dvec3& hi, const Probe& probe,
               std::vector<uint32_t>& waiting) const {
        if (child == shared::kNone) return false;
        const double reach = reachOf(probe, std::max(greatestMagnitude(lo), greatestMagnitude(hi)));
        for (int axis = 0; axis < 3; ++axis)
            if (probe.point[axis] < lo[axis] - reach || probe.point[axis] > hi[axis] + reach) return false;
        if ((child & shared::kLeafFlag) == 0) {
            waiting.push_back(child);
            return false;
        }
        return leaf(child, probe);
    }

    static double reachOf(const Probe& probe, double size) {
        return probe.units * kFloatRoundoff * (greatestMagnitude(probe.point) + size) + probe.slack;
    }

    bool leaf(uint32_t leaf, const Probe& probe) const {
        const uint32_t kind = leaf >> shared::kLeafKindShift & shared::kLeafKindMask;
        const uint32_t first = leaf & shared::kLeafFirstMask;
        const uint32_t end = first + (leaf >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
        for (uint32_t i = first; i < end; ++i) {
            if (kind == shared::kKindTriangle && triangle(scene_.triangles[i], probe)) return true;
            if (kind == shared::kKindInstance && instance(scene_.instances[i], probe)) return true;
        }
        return false;
    }

    static bool triangle(const rows::Triangle& t, const Probe& probe) {
        const dvec3 a(t.v0), b(t.v1), c(t.v2);
        const double reach =
            reachOf(probe, std::max({greatestMagnitude(a), greatestMagnitude(b), greatestMagnitude(c)}));
        return glm::distance(probe.point, closestOnTriangle(probe.point, a, b, c)) <= reach;
    }

    bool instance(const rows::Instance& instance, const Probe& probe) const {
        const dvec3 offset = probe.point - dvec3(instance.place);
        const std::array rows = {dvec3(instance.toObjectX), dvec3(instance.toObjectY),
                                 dvec3(instance.toObjectZ)};
        Probe inside{{}, 16, 0};
        for (int axis = 0; axis < 3; ++axis) {
            inside.point[axis] = glm::dot(rows[axis], offset);
            const dvec3 sizes =
                glm::abs(rows[axis]) * (glm::abs(probe.point) + glm::abs(dvec3(instance.place)));
            inside.slack = std::max(inside.slack, 16 * kFloatRoundoff * (sizes.x + sizes.y + sizes.z));
        }
        return search(instance.root, inside);
    }

    const Model& scene_;
};

bool hasOtherSurfaces(const Model& scene) {
    return !scene.spheres.empty() || !scene.planes.empty() || !scene.discs.empty() ||
           !scene.polygons.empty() || !scene.quadrics.empty() || !scene.cuboids.empty();
}

}  // namespace

std::vector<Hit> crossings(const Tracer& tracer, const Ray& ray) {
    std::vector<Hit> hits = tracer.allHits(ray);
    std::erase_if(hits, [&](const Hit& hit) { return !tracer.crosses(ray, hit); });
    return hits;
}

bool touches(const Tracer& tracer, const dvec3& point) {
    const Model& scene = tracer.model();
    if (Proximity(scene).search(scene.environment.root, {point, 4, 0})) return true;
    if (!hasOtherSurfaces(scene)) return false;
    const double reach = 4 * kFloatRoundoff *
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
