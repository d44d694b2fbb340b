#include <algorithm>
#include <cmath>
#include <utility>

#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/rounding.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// a t^2 - 2 b t + c = 0 for w = point - origin, ordinary: b = w.d, c = w.w - r^2; anchored: b = (w - r n).d,
// c = w.w - 2 r n.w.
template <class T>
struct SphereEquation {
    T a, b, c;
    T discriminant;  // b^2 - a c
    T bound;         // of its rounding error

    // Each of w, products and sums rounds: b errs by 5 u of the sum of its terms' magnitudes,
    // c by 6 u, a by 3 u, so b^2 - a c by 16 u of the squares and products of those sums.
    SphereEquation(const rows::Sphere& sphere, const Vec<T>& w, const Vec<T>& d) {
        const T r = static_cast<T>(sphere.radius);
        a = dot(d, d);
        T bTerms = dot(magnitudes(w), magnitudes(d));
        T cTerms = dot(w, w);
        if (isAnchored(sphere)) {
            const Vec<T> n = r * toVec<T>(sphere.anchorNormal);
            b = dot(w, d) - dot(n, d);
            c = cTerms - 2 * dot(n, w);
            bTerms += dot(magnitudes(n), magnitudes(d));
            cTerms += 2 * dot(magnitudes(n), magnitudes(w));
        } else {
            b = dot(w, d);
            c = cTerms - r * r;
            cTerms += r * r;
        }
        discriminant = b * b - a * c;
        bound = static_cast<T>(16 * kRoundoff<T>) * (bTerms * bTerms + a * cTerms);
    }
};

// The gradient of half the equation at t, and what spheres in one place may differ by there.
struct SphereRule {
    dvec3 gradient;
    double error;

    SphereRule(const rows::Sphere& sphere, const PreparedRay& ray, double t) {
        const dvec3 n(sphere.anchorNormal);
        const double r = sphere.radius;
        dvec3 y;
        for (int i = 0; i < 3; ++i) y[i] = ray.origin[i] - sphere.point[i] + t * ray.direction[i];
        gradient = y + r * n;
        const double constant = isAnchored(sphere) ? 2 * r * glm::dot(glm::abs(n), glm::abs(y)) : r * r;
        const double sums = (glm::dot(y, y) + constant) / 2;
        error = errorOfRound(ray, glm::abs(gradient), dvec3(sphere.point), t, sums);
    }
};

}  // namespace

bool acceptSphere(Extended t, const rows::Sphere& sphere, const RayTest& test, Root& root) {
    root.t = static_cast<double>(t);
    root.slip = 0;
    if (test.ray.ties) {
        const SphereRule at(sphere, test.ray, root.t);
        root.slip = slipOfRound(test.ray, at.gradient, glm::abs(at.gradient), at.error);
    }
    return isWithin(test.ray, root.t, root.slip, test.tMax);
}

bool intersect(const rows::Sphere& sphere, const RayTest& test, Root& root) {
    if (test.methods.spheres != SphereMethod::Robust) return textbookSphere(sphere, test, root);
    const PreparedRay& ray = test.ray;
    root.u = root.v = 0;
    root.twice = false;
    const Vec<Extended> d = toVec<Extended>(ray.direction);
    const Vec<Extended> w = toVec<Extended>(sphere.point) - toVec<Extended>(ray.origin);
    const SphereEquation<double> rough(sphere, toVec<double>(sphere.point) - toVec<double>(ray.origin),
                                       toVec<double>(ray.direction));
    const bool startsHere =
        test.fromItself() || (ray.leaves && std::abs(rough.c) <= 2 * SphereRule(sphere, ray, 0).error);
    if (startsHere) {
        const SphereEquation<Extended> onSurface(sphere, w, d);
        return acceptSphere(2 * onSurface.b / onSurface.a, sphere, test, root);
    }
    if (rough.discriminant < -rough.bound) return false;

    // Seen from the point of the line nearest to sphere.point, the distance to the sphere no longer enters
    // the discriminant (Haines, Guenther and Akenine-Moeller, "Precision Improvements for Ray/Sphere
    // Intersection", Ray Tracing Gems, 2019, ch. 7).
    const Extended shift = dot(w, d) / dot(d, d);
    SphereEquation<Extended> e(sphere, w - shift * d, d);
    // The shifted w errs by 10 roundings of |w|, which moves b by 10 u |w| |d|, and c by 20 u |w| (|w'| + r)
    // with |w'| <= 2 r near tangency.
    const Extended reach = std::sqrt(dot(w, w)), r = sphere.radius;
    e.bound += 64 * kRoundoff<Extended> * reach * (e.a * r + std::abs(e.b) * std::sqrt(e.a));
    // 2^20 bounds from tangency the square root no longer magnifies the error above 2^-21 of itself.
    if (std::abs(e.discriminant) <= 0x1p20L * e.bound) {
        const SphereEquation<Quad> exact(sphere, toVec<Quad>(sphere.point) - toVec<Quad>(ray.origin),
                                         toVec<Quad>(ray.direction));
        e.discriminant = static_cast<Extended>(exact.discriminant);
        e.c = (e.b * e.b - e.discriminant) / e.a;
    }
    if (e.discriminant < 0) return false;
    // W. Press et al., Numerical Recipes, 3rd ed., eq. 5.6.4: neither root by a difference of near-equal
    // numbers.
    const Extended q = e.b + std::copysign(std::sqrt(e.discriminant), e.b);
    Extended t0 = shift + (q == 0 ? 0 : e.c / q), t1 = shift + q / e.a;
    if (t0 > t1) std::swap(t0, t1);
    root.twice = static_cast<double>(t0) == static_cast<double>(t1);
    return acceptSphere(t0, sphere, test, root) || acceptSphere(t1, sphere, test, root);
}

// The point is near the sphere: one step brings it onto the sphere, as far as double goes.
void surfaceOf(const rows::Sphere& sphere, const Place& place, Surface& surface) {
    const dvec3 anchor(sphere.point);
    const double radius = sphere.radius;
    if (isAnchored(sphere)) {
        // One Newton step along the gradient 2 (y + r n) of |y|^2 + 2 r n.y; the residue is that of o + t d
        // squared, over r.
        dvec3 y = place.point - anchor;
        const dvec3 n(sphere.anchorNormal);
        const dvec3 half = y + radius * n;
        y -= (glm::dot(y, y) + 2 * radius * glm::dot(n, y)) / (2 * glm::dot(half, half)) * half;
        surface.position = anchor + y;
        surface.geometricNormal = glm::normalize(y + radius * n);
    } else {
        surface.geometricNormal = glm::normalize(place.point - anchor);
        surface.position = anchor + radius * surface.geometricNormal;
    }
    surface.error = errorBox(surface.position - anchor, anchor);
    surface.shadingNormal = surface.geometricNormal;
}

double reachOf(const Model&, const Methods& methods, const rows::Sphere& s) {
    return greatestMagnitude(s.point) +
           (isAnchored(s) && methods.spheres == SphereMethod::Robust ? 0 : s.radius);
}

}  // namespace glint::reference
