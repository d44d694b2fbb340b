#include "reference/certain/decide.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/vectors.h"
#include "reference/numbers.h"
#include "scene/transform.h"

namespace glint::reference::certain {

// ---- Spans, in double

namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kUnit = kUnitRoundoff;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Products below this are rounded by more than a unit of themselves.
constexpr double kLeastDoubt = 1e-290;

dvec3 turned(const dvec3& v, int axis) {
    return axis == 0 ? dvec3(v.y, v.z, v.x) : axis == 1 ? dvec3(v.z, v.x, v.y) : v;
}

double cross(const dvec2& p, const dvec2& q) {
    return p.x * q.y - p.y * q.x;
}

}  // namespace

SpanRay::SpanRay(const WorldRay& ray) : ray_(ray) {
    const dvec3 size = glm::abs(ray.direction);
    axis_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const dvec3 d = turned(ray.direction, axis_);
    shear_ = {d.x / d.z, d.y / d.z, 1 / d.z};
}

std::optional<Span> SpanRay::within(Span span, bool isHit) const {
    const double from = std::max(ray_.tMin, 0.0);
    // Comparisons that are false for NaN keep the span.
    if (span.upper <= from || span.lower > ray_.tMax) return std::nullopt;
    span.isHit = isHit && span.lower > from && span.upper <= ray_.tMax;
    if (!(span.lower >= from)) span.lower = from;
    if (!(span.upper <= ray_.tMax)) span.upper = ray_.tMax;
    span.t = span.t >= span.lower && span.t <= span.upper ? span.t : span.lower;
    return span;
}

std::optional<Span> SpanRay::span(const ExactSurface& surface) const {
    return surface.plane != nullptr ? planeSpan(*surface.plane) : triangleSpan(surface);
}

// A corner's place across the ray errs by e = offset + 24 u depth + 8 u reach: the corner in the world, where
// it is moved there, by `offset`; the difference with the origin by u of itself, at most depth + reach; the
// shear, a quotient of two exact numbers, by u; product and difference by u each. An edge function then errs
// by 4 e reach + 2 e^2 and three units of 2 reach^2 < 2 e reach.
std::optional<Span> SpanRay::triangleSpan(const ExactSurface& triangle) const {
    const Affine* place = triangle.place;
    std::array<dvec2, 3> across;
    dvec3 along;
    double offset = 0, depth = 0, reach = 0;
    for (int i = 0; i < 3; ++i) {
        dvec3 corner = triangle.corners[static_cast<size_t>(i)];
        if (place != nullptr) {
            const dvec3 sizes = magnitudes(place->linear) * glm::abs(corner) + glm::abs(place->offset);
            offset = std::max(offset, 8 * kUnit * greatestMagnitude(sizes));
            corner = place->linear * corner + place->offset;
        }
        const dvec3 seen = turned(corner - ray_.origin, axis_);
        across[i] = dvec2(seen) - dvec2(shear_) * seen.z;
        along[i] = seen.z;
        depth = std::max(depth, std::abs(seen.z));
        reach = std::max({reach, std::abs(across[i].x), std::abs(across[i].y)});
    }
    const double e = 4 * offset + 24 * kUnit * depth + 8 * kUnit * reach;
    const double doubt = e * (6 * reach + 2 * e) + kLeastDoubt;
    const dvec3 edges = {cross(across[2], across[1]), cross(across[0], across[2]),
                         cross(across[1], across[0])};
    const double least = std::min({edges.x, edges.y, edges.z}), most = std::max({edges.x, edges.y, edges.z});
    if (least < -doubt && most > doubt) return std::nullopt;
    const bool isHit = least > doubt || most < -doubt;

    const dvec3 ts = along * shear_.z;
    const double nearest = std::min({ts.x, ts.y, ts.z}), farthest = std::max({ts.x, ts.y, ts.z});
    const double cornerOff = std::abs(shear_.z) * (4 * offset + 24 * kUnit * depth);
    Span span{nearest - cornerOff, farthest + cornerOff};
    span.t = nearest;
    if (isHit) {
        const double inverse = 1 / (edges.x + edges.y + edges.z);
        const dvec3 weights = edges * inverse;
        const double t = glm::dot(weights, ts);
        const double off = 7 * doubt * std::abs(inverse) * (farthest - nearest) + cornerOff +
                           16 * kUnit * std::max(std::abs(nearest), std::abs(farthest));
        span = {t - off, t + off, t, weights.y, weights.z};
    }
    return within(span, isHit && std::isfinite(span.lower) && std::isfinite(span.upper));
}

std::optional<Span> SpanRay::planeSpan(const PlaneShape& plane) const {
    const dvec3 away = plane.point - ray_.origin, n = plane.normal, d = ray_.direction;
    const double height = glm::dot(n, away), speed = glm::dot(n, d);
    const double heightOff = 8 * kUnit * glm::dot(glm::abs(n), glm::abs(away)) + kLeastDoubt;
    const double speedOff = 8 * kUnit * glm::dot(glm::abs(n), glm::abs(d)) + kLeastDoubt;
    const bool isHit = std::abs(speed) > 2 * speedOff;
    Span span{0, kInfinity};
    if (isHit) {
        const double t = height / speed;
        const double off =
            (heightOff + std::abs(t) * speedOff) / (std::abs(speed) - speedOff) + 4 * kUnit * std::abs(t);
        span = {t - off, t + off, t, 0, 0};
    }
    return within(span, isHit);
}

// With c the centre, a = d.d and b = (c - o).d the roots are (b -+ sqrt(a D)) / a with D = r^2 - |p|^2, p the
// way from the centre to the line's nearest point. p errs by 16 u |c - o| in each coordinate, so D by less
// than 128 u (|c - o|^2 + r^2), the root of D by that over the root, b / a by 8 u |c - o| / |d|.
std::array<std::optional<Span>, 2> SpanRay::spans(const SphereShape& sphere) const {
    // By a power of two, exactly: the square of a direction may overflow or vanish.
    const int exponent = std::ilogb(greatestMagnitude(ray_.direction));
    const dvec3 scaled = {std::scalbn(ray_.direction.x, -exponent), std::scalbn(ray_.direction.y, -exponent),
                          std::scalbn(ray_.direction.z, -exponent)};
    const double scaledLength = std::sqrt(glm::dot(scaled, scaled));
    const double length = std::scalbn(scaledLength, exponent);
    const dvec3 away = sphere.center - ray_.origin, unit = scaled / scaledLength;
    const double b = glm::dot(away, unit), size = glm::length(away);
    const dvec3 beside = away - b * unit;
    const double radius = sphere.radius;
    const double rest = radius * radius - glm::dot(beside, beside);
    const double restOff = 128 * kUnit * (size * size + radius * radius) + kLeastDoubt;
    if (rest < -restOff) return {};
    const double least = std::sqrt(std::max(rest - restOff, 0.0)), most = std::sqrt(rest + restOff);
    const double middleOff = 16 * kUnit * (size + radius);
    const bool isHit = rest > restOff && std::isfinite(length) && std::isfinite(most);
    const auto at = [&](double near, double far) {
        Span span{(near - middleOff) / length, (far + middleOff) / length, 0.5 * (near + far) / length, 0, 0};
        span.lower -= 4 * kUnit * std::abs(span.lower);
        span.upper += 4 * kUnit * std::abs(span.upper);
        return within(span, isHit);
    };
    return {at(b - most, b - least), at(b + least, b + most)};
}

// ---- Exact hits; only the bounds of the answer are rounded, outwards

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
    return x == under ? under : std::nextafter(under, kInfinity);
}

struct Intersection {
    Number t;
    Number edges[3];  // those of a triangle, opposite to its corners; their sum is not 0
};

// The volumes that the ray's direction spans with two corners each, relative to its origin, give the side of
// each edge on which it passes (Segura, Feito, "Algorithms to Test Ray-Triangle Intersection", WSCG 2001).
std::optional<Intersection> intersectTriangle(const Vector& origin, const Vector& direction,
                                              const ExactSurface& surface) {
    std::array<Vector, 3> seen;
    for (size_t i = 0; i < 3; ++i) {
        Vector corner = toVec<Number>(surface.corners[i]);
        if (surface.place != nullptr)
            corner = times(surface.place->linear, corner) + toVec<Number>(surface.place->offset);
        seen[i] = corner - origin;
    }
    Intersection m;
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

std::optional<Intersection> intersectPlane(const Vector& origin, const Vector& direction,
                                           const PlaneShape& plane) {
    const Vector normal = toVec<Number>(plane.normal);
    const Number speed = dot(normal, direction);
    if (speed == 0) return std::nullopt;
    Intersection m;
    m.t = dot(normal, toVec<Number>(plane.point) - origin) / speed;
    return m;
}

}  // namespace

std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces) {
    const Vector origin = toVec<Number>(ray.origin), direction = toVec<Number>(ray.direction);
    std::optional<Intersection> best;
    size_t chosen = 0;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        const ExactSurface& surface = surfaces[i];
        std::optional<Intersection> m = surface.plane != nullptr
                                            ? intersectPlane(origin, direction, *surface.plane)
                                            : intersectTriangle(origin, direction, surface);
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
