// Ray against primitive, in double on the fp32 inputs. Hit or miss is decided in double where a forward error
// bound proves the sign, and in quadruple precision elsewhere; t, u and v of an accepted hit are computed in
// long double. Each kind of primitive of shaders/shared/primitives.h overloads the functions below in
// primitives/; the linker names a missing overload.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <span>
#include <utility>

#include "pack/scene_arrays.h"
#include "reference/numbers.h"
#include "reference/tracer.h"
#include "trace/methods.h"

namespace glint::reference {

// A ray with tMin >= 0, and values of it that every test needs, computed once. RayTest::tMax ends it.
struct PreparedRay : Ray {
    glm::dvec3 inverse;  // 1 / direction; an infinity of the same sign for a zero
    int kx, ky, kz = 0;  // kz: the axis along which the direction is greatest
    double shearX, shearY;
    bool valid;           // false: the ray misses everything
    bool leaves = false;  // it starts on a surface
    double slip = 0;      // how far the origin is off along any unit normal, as the rule counts it

    explicit PreparedRay(const Ray& ray);
};

// A hit in the coordinates of the primitive.
struct Root {
    double t = 0, u = 0, v = 0;
    double slip = 0;     // see slipOfFlat
    uint32_t part = 0;   // of a solid with several surfaces, the one that is hit
    bool twice = false;  // tangent: the line enters and leaves a round surface at one t
};

// The rule for rays that hit and leave surfaces (docs/design/numerics.md): t stands for t +- slip. slip is
// the greatest difference in fp32 between the heights of surfaces in one place, over the speed n.d at which
// the ray changes its height. anchor: the point of the plane that heights are measured from; w = anchor - o;
// n: unit. Rounding of coordinates makes the planes differ and is one part of it. The other is the arithmetic
// of the test; PreparedRay::slips scales it.
double slipOfFlat(const PreparedRay& ray, const glm::dvec3& n, const glm::dvec3& anchor, double t);
// Its height, without what an instance adds: u sum |n_i| (2 |a_i| + 6 |a_i - o_i| + 6 |t d_i|).
double heightError(const PreparedRay& ray, const glm::dvec3& n, const glm::dvec3& anchor, double t);
// The rule for a round surface at t. gradient: of half its equation; spread: the magnitudes that the gradient
// sums; sums: those that half of the equation sums.
struct RoundRule {
    glm::dvec3 gradient, spread;
    double error;  // by which halves of the equations of surfaces in one place may differ

    RoundRule(const PreparedRay& ray, const glm::dvec3& gradient, const glm::dvec3& spread,
              const glm::dvec3& anchor, double t, double sums);
    double slip(const PreparedRay& ray) const;
};
// True if a surface at t +- slip is within the ray's interval, which ends at tMax.
inline bool isWithin(const PreparedRay& ray, double t, double slip, double tMax) {
    return t > ray.tMin && t - (ray.ties ? slip : 0) <= tMax && t <= std::numeric_limits<double>::max();
}
// True if a flat surface at t +- slip is, too, in front of a ray that leaves a surface.
inline bool countsAt(const PreparedRay& ray, double t, double slip, double tMax) {
    return (!ray.leaves || t > slip) && isWithin(ray, t, slip, tMax);
}

// One ray that may hit one primitive.
struct RayTest {
    const Model& scene;
    const Methods& methods;
    const PreparedRay& ray;
    uint32_t primitive;  // kind and index
    uint32_t source;     // what the ray starts on, of a solid with its part; kNone
    double tMax;

    bool fromItself() const { return primitive == source; }
};

// A hit point to describe, in the coordinates of the primitive.
struct Place {
    const Model& scene;
    const Methods& methods;
    const Ray& ray;
    const Hit& hit;
    glm::dvec3 point;  // origin + t direction

    uint32_t part() const { return hit.primitive >> shared::kPartShift & shared::kPartMask; }
};

// intersect: the closest hit within (ray.tMin, tMax], without the point of its source where the ray starts.
// surfaceOf: position, moved onto the surface, geometric normal, scale (the greatest magnitude among the
// coordinates that the position is computed from), and uv if the primitive defines them.
#define GLINT_PRIMITIVE(number, Kind, KINDS, kinds, one, many)                    \
    bool intersect(const rows::Kind& primitive, const RayTest& test, Root& root); \
    void surfaceOf(const rows::Kind& primitive, const Place& place, Surface& surface);
GLINT_PRIMITIVES(GLINT_PRIMITIVE, GLINT_NO_KIND)
#undef GLINT_PRIMITIVE

// ---- Triangles: the filter is inline because it takes most of the time.

// The rest of the test, for the few triangles that the filter does not reject. lineHits: the filter has
// proved that the line through the ray crosses the inside.
bool solveTriangle(const rows::Triangle& triangle, const RayTest& test, bool lineHits, Root& root);

// True if the ray crosses this triangle of those that share the edge or corner that it hits. Around a point
// of a closed surface as many triangles count as a ray just beside it crosses.
bool crossesTriangle(const rows::Triangle& triangle, const PreparedRay& ray);

// True if the ray starts on the triangle with this id. A split triangle stands in the BVH more than once.
inline bool isOwnTriangle(const RayTest& test, uint32_t id) {
    return test.source != shared::kNone && kindOfPrimitive(test.source) == shared::PrimitiveKind::Triangle &&
           test.scene.triangles[test.source & shared::kPrimitiveIndexMask].id == id;
}

// Watertight by the argument of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
// 2013, section 3: an edge function is a function of its edge and the ray alone, its sign is right or it is
// zero, and zero counts as inside.
//
// Error bound. Let X = A_x - S_x A_z with A = v - o, |S_x| <= 1, u = 2^-53, Z >= |A_z|, S >= |X|, |Y|. As
// |A_x| <= |X| + Z, rounding of A, S_x, the product and the difference move X by at most u (|X| + Z) + 3 u Z
// + u |X| <= u (2 S + 4 Z). An edge function B_x C_y - B_y C_x then errs by at most 4 S u (2 S + 4 Z) + 4 u
// S^2 <= 16 u S (S + Z), to first order; 20 covers the rest.
inline bool intersect(const rows::Triangle& triangle, const RayTest& test, Root& root) {
    if (isOwnTriangle(test, triangle.id)) return false;
    const PreparedRay& ray = test.ray;
    const double* o = glm::value_ptr(ray.origin);
    const double* v0 = glm::value_ptr(triangle.v0);
    const double* v1 = glm::value_ptr(triangle.v1);
    const double* v2 = glm::value_ptr(triangle.v2);
    const double ox = o[ray.kx], oy = o[ray.ky], oz = o[ray.kz];
    const double az = v0[ray.kz] - oz, bz = v1[ray.kz] - oz, cz = v2[ray.kz] - oz;
    const double ax = (v0[ray.kx] - ox) - ray.shearX * az, ay = (v0[ray.ky] - oy) - ray.shearY * az;
    const double bx = (v1[ray.kx] - ox) - ray.shearX * bz, by = (v1[ray.ky] - oy) - ray.shearY * bz;
    const double cx = (v2[ray.kx] - ox) - ray.shearX * cz, cy = (v2[ray.ky] - oy) - ray.shearY * cz;
    const double e0 = cx * by - cy * bx;
    const double e1 = ax * cy - ay * cx;
    const double e2 = bx * ay - by * ax;
    const double depth = std::max(std::max(std::abs(az), std::abs(bz)), std::abs(cz));
    const double spread =
        std::max(std::max(std::max(std::abs(ax), std::abs(ay)), std::max(std::abs(bx), std::abs(by))),
                 std::max(std::abs(cx), std::abs(cy)));
    const double bound = 20 * kUnitRoundoff * spread * (spread + depth);
    const double least = std::min(std::min(e0, e1), e2);
    const double greatest = std::max(std::max(e0, e1), e2);
    if (least < -bound && greatest > bound) return false;
    return solveTriangle(triangle, test, least > bound || greatest < -bound, root);
}

// ---- Shared by the sources in primitives/

// Roots of a t^2 + 2 b t + c = 0 for a discriminant that is not negative, smaller first. A double root counts
// as two, an equation without unknown has none. Neither root is a difference of near-equal numbers: W. Press
// et al., Numerical Recipes, 3rd ed., eq. 5.6.4.
struct QuadraticRoots {
    int count = 0;
    Extended t[2] = {0, 0};

    QuadraticRoots(Extended a, Extended b, Extended c, Extended discriminant) {
        if (a == 0) {
            if (b == 0) return;
            count = 1;
            t[0] = -c / (2 * b);
            return;
        }
        const Extended q = b + std::copysign(std::sqrt(discriminant), b);
        count = 2;
        t[0] = q == 0 ? 0 : -c / q;
        t[1] = -q / a;
        if (t[0] > t[1]) std::swap(t[0], t[1]);
    }
};

// The vertices of a polygon, closed: the last one is the first again.
inline std::span<const rows::PolygonVertex> outlineOf(const Model& scene, const rows::Polygon& polygon) {
    return {&scene.polygonVertices[polygon.firstVertex],
            size_t{polygon.trips} * shared::kPolygonEdgesPerTrip + 1};
}

// True for the sphere whose surface is |x - point|^2 + 2 radius n.(x - point) = 0, see shared/primitives.h.
inline bool isAnchored(const rows::Sphere& sphere) {
    return sphere.anchorNormal != glm::dvec3(0);
}

// `from`, and how far the solid's clipping box reaches from its point along each axis.
template <class Solid>
glm::dvec3 reachFrom(const glm::dvec3& from, const Solid& solid) {
    const glm::dmat3 back = glm::inverse(toLocal(solid));
    const glm::dvec3 size = glm::max(glm::abs(solid.lo), glm::abs(solid.hi));
    return from + glm::abs(back[0]) * size.x + glm::abs(back[1]) * size.y + glm::abs(back[2]) * size.z;
}

// slipOfFlat for the planes that clip a solid along an axis. speed: of the ray along the axis. The last term
// is for the last roundings of t. Instances hold no solids, so PreparedRay::slip is 0.
template <class Solid>
double slipOfFace(const Solid& solid, int axis, double plane, Extended speed, Extended t,
                  const PreparedRay& ray) {
    if (!ray.leaves && !ray.ties) return 0;
    const double height =
        heightError(ray, rowsOf(solid)[axis], solid.point, 0) + kFloatUnit * 2 * std::abs(plane);
    return height / std::abs(static_cast<double>(speed)) +
           ray.slips * 8 * kFloatUnit * std::abs(static_cast<double>(t));
}

}  // namespace glint::reference
