#include <algorithm>
#include <cmath>

#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/numbers.h"
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

    // The terms of b pass 5 roundings, those of c 6, of a 3.
    SphereEquation(const rows::Sphere& sphere, const Vec<T>& w, const Vec<T>& d) {
        const T r = static_cast<T>(sphere.radius);
        const Sum<T> squares = sumOfProducts(d, d);
        Sum<T> half = sumOfProducts(w, d), rest = sumOfProducts(w, w);
        if (isAnchored(sphere)) {
            const Vec<T> n = r * toVec<T>(sphere.anchorNormal);
            half = half - sumOfProducts(n, d);
            rest = rest - sumOfProducts(T{2} * n, w);
        } else {
            rest = rest - Sum<T>(r * r);
        }
        const Sum<T> rounded = half * half - squares * rest;
        a = squares.value;
        b = half.value;
        c = rest.value;
        discriminant = rounded.value;
        bound = rounded.bound(16);
    }
};

RoundRule ruleAt(const rows::Sphere& sphere, const PreparedRay& ray, double t) {
    const dvec3 n = sphere.anchorNormal, y = ray.origin - sphere.point + t * ray.direction;
    const double r = sphere.radius;
    const dvec3 gradient = y + r * n;
    const double constant = isAnchored(sphere) ? 2 * r * glm::dot(glm::abs(n), glm::abs(y)) : r * r;
    return {ray, gradient, glm::abs(gradient), sphere.point, t, (glm::dot(y, y) + constant) / 2};
}

// Error of the device's textbook tests (SphereMethod), whose discriminant takes the difference of the squares
// of radius and distance. With u = 2^-24, w from the ray's origin to the centre and a = d.d, in the geometric
// form r^2 - (w.w - s^2 a) with s = w.d / a: w.w errs by gamma_5 |w|^2, s by gamma_8 |w| / |d|, s^2 a by
// gamma_21 |w|^2, each difference by one more: 29 u |w|^2 + 2 u r^2.
constexpr double kSquareRoundings = 30, kMiddleRoundings = 8;

// The ray's noise in the square of half the chord, times a, and in the t of its middle.
struct TextbookError {
    double square = 0, middle = 0;

    TextbookError(const rows::Sphere& sphere, const RayTest& test) {
        const PreparedRay& ray = test.ray;
        if (!ray.noise.formulas || test.methods.spheres == SphereMethod::Robust) return;
        uint64_t state = ray.noise.seed ^ sphere.id;
        const auto upTo = [&](double roundings) {
            return std::min(ray.noise.step, roundings * kFloatUnit) * uniform(state);
        };
        const dvec3 w = sphere.point - sphere.radius * sphere.anchorNormal - ray.origin;
        const double a = glm::dot(ray.direction, ray.direction), reach = glm::dot(w, w);
        square = upTo(kSquareRoundings) * (reach + sphere.radius * sphere.radius) * a;
        middle = upTo(kMiddleRoundings) * std::sqrt(reach / a);
    }
};

// Fills root.t and root.slip. True if the sphere at t counts for the ray.
bool acceptSphere(Extended t, const rows::Sphere& sphere, const RayTest& test, Root& root) {
    root.t = static_cast<double>(t);
    root.slip = test.ray.ties ? ruleAt(sphere, test.ray, root.t).slip(test.ray) : 0;
    return isWithin(test.ray, root.t, root.slip, test.tMax);
}

}  // namespace

bool intersect(const rows::Sphere& sphere, const RayTest& test, Root& root) {
    const PreparedRay& ray = test.ray;
    const bool robust = test.methods.spheres == SphereMethod::Robust;
    const TextbookError error(sphere, test);
    root.twice = false;
    const Vec<Extended> d = toVec<Extended>(ray.direction);
    const Vec<Extended> w = toVec<Extended>(sphere.point) - toVec<Extended>(ray.origin);
    const SphereEquation<double> rough(sphere, toVec<double>(sphere.point) - toVec<double>(ray.origin),
                                       toVec<double>(ray.direction));
    const bool startsHere =
        test.fromItself() || (robust && ray.leaves && std::abs(rough.c) <= 2 * ruleAt(sphere, ray, 0).error);
    if (startsHere) {
        const SphereEquation<Extended> onSurface(sphere, w, d);
        return acceptSphere(2 * (onSurface.b / onSurface.a + error.middle), sphere, test, root);
    }
    if (rough.discriminant + error.square < -rough.bound) return false;

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
    e.discriminant += error.square;
    e.c -= error.square / e.a;
    if (e.discriminant < 0) return false;
    const QuadraticRoots roots(e.a, -e.b, e.c, e.discriminant);
    const Extended middle = shift + error.middle, t0 = middle + roots.t[0], t1 = middle + roots.t[1];
    root.twice = static_cast<double>(t0) == static_cast<double>(t1);
    return acceptSphere(t0, sphere, test, root) || acceptSphere(t1, sphere, test, root);
}

// The point is near the sphere: one step brings it onto the sphere, as far as double goes.
void surfaceOf(const rows::Sphere& sphere, const Place& place, Surface& surface) {
    const dvec3 anchor = sphere.point;
    const double radius = sphere.radius;
    if (isAnchored(sphere)) {
        // One Newton step along the gradient 2 (y + r n) of |y|^2 + 2 r n.y; the residue is that of o + t d
        // squared, over r.
        dvec3 y = place.point - anchor;
        const dvec3 n = sphere.anchorNormal;
        const dvec3 half = y + radius * n;
        y -= (glm::dot(y, y) + 2 * radius * glm::dot(n, y)) / (2 * glm::dot(half, half)) * half;
        surface.position = anchor + y;
        surface.geometricNormal = glm::normalize(y + radius * n);
    } else {
        // From origins far away the point may be the centre.
        const dvec3 outward = place.point - anchor;
        surface.geometricNormal = glm::normalize(outward == dvec3(0) ? -place.ray.direction : outward);
        surface.position = anchor + radius * surface.geometricNormal;
    }
    surface.error = errorBox(surface.position - anchor, anchor);
    const bool fromAnchor = isAnchored(sphere) && place.methods.spheres == SphereMethod::Robust;
    surface.scale = greatestMagnitude(anchor) + (fromAnchor ? 0 : radius);
}

}  // namespace glint::reference
