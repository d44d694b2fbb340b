// Only the bounds of the answer are rounded, outwards.
#include <gmpxx.h>

#include <cmath>
#include <limits>
#include <utility>

#include "reference/certain/decide.h"
#include "reference/numbers.h"

namespace glint::reference::certain {

namespace {

// Every finite double is a fraction.
using Number = mpq_class;
using Vector = Vec<Number>;

Vector times(const glm::dmat3& m, const Vector& v) {
    return Number(v.x) * toVec<Number>(m[0]) + Number(v.y) * toVec<Number>(m[1]) +
           Number(v.z) * toVec<Number>(m[2]);
}

// The greatest finite double that is at most x, for x >= 0.
double below(const Number& x) {
    return std::min(x.get_d(), std::numeric_limits<double>::max());  // cut off towards zero
}
double above(const Number& x, double under) {
    return x == under ? under : std::nextafter(under, std::numeric_limits<double>::infinity());
}

struct Meeting {
    Number t;
    Number edges[3];  // those of a triangle, opposite to its corners; their sum is not 0
};

// The volumes that the ray's direction spans with two corners each, seen from its origin: on which side of
// each edge it passes (Segura, Feito, "Algorithms to Test Ray-Triangle Intersection", WSCG 2001).
std::optional<Meeting> meetTriangle(const Vector& origin, const Vector& direction,
                                    const ExactSurface& surface) {
    std::array<Vector, 3> seen;
    for (size_t i = 0; i < 3; ++i) {
        Vector corner = toVec<Number>(surface.corners[i]);
        if (surface.place != nullptr)
            corner = times(surface.place->linear, corner) + toVec<Number>(surface.place->offset);
        seen[i] = corner - origin;
    }
    Meeting m;
    bool positive = false, negative = false;
    for (size_t i = 0; i < 3; ++i) {
        m.edges[i] = dot(direction, cross(seen[(i + 1) % 3], seen[(i + 2) % 3]));
        positive = positive || m.edges[i] > 0;
        negative = negative || m.edges[i] < 0;
    }
    if (positive == negative) return std::nullopt;  // beside it, or in its plane
    const Vector normal = cross(seen[1] - seen[0], seen[2] - seen[0]);
    m.t = dot(normal, seen[0]) / dot(normal, direction);
    return m;
}

std::optional<Meeting> meetPlane(const Vector& origin, const Vector& direction, const PlaneShape& plane) {
    const Vector normal = toVec<Number>(plane.normal);
    const Number speed = dot(normal, direction);
    if (speed == 0) return std::nullopt;
    Meeting m;
    m.t = dot(normal, toVec<Number>(plane.point) - origin) / speed;
    return m;
}

}  // namespace

std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces) {
    const Vector origin = toVec<Number>(ray.origin), direction = toVec<Number>(ray.direction);
    std::optional<Meeting> best;
    size_t chosen = 0;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        const ExactSurface& surface = surfaces[i];
        std::optional<Meeting> m = surface.plane != nullptr ? meetPlane(origin, direction, *surface.plane)
                                                            : meetTriangle(origin, direction, surface);
        if (!m || m->t <= 0 || (ray.tMin > 0 && m->t <= ray.tMin)) continue;
        if (std::isfinite(ray.tMax) && m->t > ray.tMax) continue;
        const bool closer = !best || m->t < best->t;
        if (!closer && (m->t > best->t || surface.id >= surfaces[chosen].id)) continue;
        best = std::move(m);
        chosen = i;
    }
    if (!best) return std::nullopt;
    ExactHit hit;
    hit.surface = chosen;
    hit.lower = below(best->t);
    hit.upper = above(best->t, hit.lower);
    if (surfaces[chosen].plane == nullptr) {
        const Number whole = best->edges[0] + best->edges[1] + best->edges[2];
        hit.u = below(best->edges[1] / whole);
        hit.v = below(best->edges[2] / whole);
    }
    return hit;
}

}  // namespace glint::reference::certain
