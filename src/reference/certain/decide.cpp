#include "reference/certain/decide.h"

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/vectors.h"
#include "reference/numbers.h"
#include "scene/transform.h"

namespace glint::reference::certain {

namespace {

using glm::dvec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- Numbers: in double with a bound, and exact

// A double, and how far it may be off: each operation adds its own rounding (running error analysis: Higham,
// "Accuracy and Stability of Numerical Algorithms", 2002, sec. 3.3). Infinite or NaN: nothing is known.
struct Bounded {
    double value = 0, error = 0;

    Bounded() = default;
    explicit Bounded(double exact) : value(exact) {}
    // Twice the rounding of the value, which covers that of the error; and products that underflow.
    static Bounded rounded(double value, double error) {
        return {value, error + 2 * kUnitRoundoff * std::abs(value) + 1e-290};
    }
    friend Bounded operator+(const Bounded& a, const Bounded& b) {
        return rounded(a.value + b.value, a.error + b.error);
    }
    friend Bounded operator-(const Bounded& a, const Bounded& b) {
        return rounded(a.value - b.value, a.error + b.error);
    }
    friend Bounded operator*(const Bounded& a, const Bounded& b) {
        return rounded(a.value * b.value,
                       std::abs(a.value) * b.error + a.error * (std::abs(b.value) + b.error));
    }
    // b's sign is proven.
    friend Bounded operator/(const Bounded& a, const Bounded& b) {
        const double quotient = a.value / b.value;
        return rounded(quotient, (a.error + std::abs(quotient) * b.error) / (std::abs(b.value) - b.reach()));
    }
    double reach() const { return error * (1 + 0x1p-40); }
    double lower() const { return value - reach(); }
    double upper() const { return value + reach(); }

  private:
    Bounded(double v, double e) : value(v), error(e) {}
};

// Every finite double is a fraction.
using Number = mpq_class;

// 0: not proven, or exactly 0.
int signOf(const Bounded& a) {
    return a.lower() > 0 ? 1 : a.upper() < 0 ? -1 : 0;
}
int signOf(const Number& a) {
    return sgn(a);
}

// ---- Triangles and planes, in either kind of numbers

enum class Result { Miss, Open, Hit };  // Open: the bounds do not decide
template <class T>
struct Intersection {
    Result result = Result::Miss;
    T t{}, u{}, v{};  // of a hit
};

// A sign that is 0 is known to be 0 in exact numbers alone.
template <class T>
constexpr bool kIsExact = std::is_same_v<T, Number>;

template <class T>
Vec<T> times(const glm::dmat3& m, const Vec<T>& v) {
    return v.x * toVec<T>(m[0]) + v.y * toVec<T>(m[1]) + v.z * toVec<T>(m[2]);
}

// The volumes that the ray's direction spans with two corners each, relative to its origin, give the side of
// each edge on which it passes (Segura, Feito, "Algorithms to Test Ray-Triangle Intersection", WSCG 2001);
// they are the corners' weights in the point.
template <class T>
Intersection<T> intersectTriangle(const Vec<T>& origin, const Vec<T>& direction,
                                  const ExactSurface& surface) {
    std::array<Vec<T>, 3> seen;
    for (size_t i = 0; i < 3; ++i) {
        seen[i] = toVec<T>(surface.corners[i]);
        if (surface.place != nullptr)
            seen[i] = times(surface.place->linear, seen[i]) + toVec<T>(surface.place->offset);
        seen[i] = seen[i] - origin;
    }
    std::array<T, 3> edges;
    int positive = 0, negative = 0;
    for (size_t i = 0; i < 3; ++i) {
        edges[i] = dot(direction, cross(seen[(i + 1) % 3], seen[(i + 2) % 3]));
        positive += signOf(edges[i]) > 0;
        negative += signOf(edges[i]) < 0;
    }
    if (positive > 0 && negative > 0) return {};
    if (positive + negative < 3 && !kIsExact<T>) return {.result = Result::Open};
    if (positive + negative == 0) return {};  // in its plane
    const T sum = edges[0] + edges[1] + edges[2];
    if (signOf(sum) == 0) return {.result = Result::Open};
    Intersection<T> hit{.result = Result::Hit};
    hit.u = edges[1] / sum;
    hit.v = edges[2] / sum;
    // From a corner: bounds of weights then count by the triangle's size alone.
    const T way = dot(direction, seen[0]) + hit.u * dot(direction, seen[1] - seen[0]) +
                  hit.v * dot(direction, seen[2] - seen[0]);
    hit.t = way / dot(direction, direction);
    return hit;
}

template <class T>
Intersection<T> intersect(const Vec<T>& origin, const Vec<T>& direction, const ExactSurface& surface) {
    if (surface.plane == nullptr) return intersectTriangle(origin, direction, surface);
    const Vec<T> normal = toVec<T>(surface.plane->normal);
    const T speed = dot(normal, direction);
    if (signOf(speed) == 0) return {.result = kIsExact<T> ? Result::Miss : Result::Open};
    Intersection<T> hit{.result = Result::Hit};
    hit.t = dot(normal, toVec<T>(surface.plane->point) - origin) / speed;
    return hit;
}

// The square root of a number that is at least 0, apart from its error.
Bounded root(const Bounded& a) {
    const double low = std::sqrt(std::max(a.lower(), 0.0)), high = std::sqrt(std::max(a.upper(), 0.0));
    return Bounded::rounded((low + high) / 2, (high - low) / 2 + 2 * kUnitRoundoff * high);
}

// The greatest finite double that is at most x, for x >= 0.
double below(const Number& x) {
    return std::min(x.get_d(), std::numeric_limits<double>::max());  // cut off towards zero
}
double above(const Number& x, double under) {
    return x == under ? under : std::nextafter(under, kInfinity);
}

}  // namespace

// By a power of two, exactly: the square of a direction may overflow or vanish.
SpanRay::SpanRay(const WorldRay& ray) : ray_(ray), exponent_(std::ilogb(greatestMagnitude(ray.direction))) {
    for (int i = 0; i < 3; ++i) direction_[i] = std::scalbn(ray.direction[i], -exponent_);
}

std::optional<Span> SpanRay::within(Span span, bool isHit) const {
    const double from = std::max(ray_.tMin, 0.0);
    for (double* t : {&span.lower, &span.upper, &span.t}) *t = std::scalbn(*t, -exponent_);
    // Comparisons that are false for NaN keep the span.
    if (span.upper <= from || span.lower > ray_.tMax) return std::nullopt;
    span.isHit = isHit && span.lower > from && span.upper <= ray_.tMax;
    if (!(span.lower >= from)) span.lower = from;
    if (!(span.upper <= ray_.tMax)) span.upper = ray_.tMax;
    span.t = span.t >= span.lower && span.t <= span.upper ? span.t : span.lower;
    return span;
}

std::optional<Span> SpanRay::span(const ExactSurface& surface) const {
    const auto hit = intersect(toVec<Bounded>(ray_.origin), toVec<Bounded>(direction_), surface);
    if (hit.result == Result::Miss) return std::nullopt;
    if (hit.result == Result::Open || !std::isfinite(hit.t.error)) return within({0, kInfinity}, false);
    return within({hit.t.lower(), hit.t.upper(), hit.t.value, hit.u.value, hit.v.value}, true);
}

// From the line's point nearest to the centre.
std::array<std::optional<Span>, 2> SpanRay::spans(const SphereShape& sphere) const {
    const Vec<Bounded> direction = toVec<Bounded>(direction_);
    const Vec<Bounded> away = toVec<Bounded>(sphere.center) - toVec<Bounded>(ray_.origin);
    const Bounded square = dot(direction, direction), radius(sphere.radius);
    const Bounded middle = dot(away, direction) / square;
    const Vec<Bounded> beside = away - middle * direction;
    const Bounded rest = radius * radius - dot(beside, beside);
    if (signOf(rest) < 0) return {};
    const Bounded half = root(rest / square), near = middle - half, far = middle + half;
    const bool isHit = signOf(rest) > 0 && std::isfinite(far.error);
    return {within({near.lower(), near.upper(), near.value}, isHit),
            within({far.lower(), far.upper(), far.value}, isHit)};
}

// Only the bounds of the answer are rounded, outwards.
std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces) {
    const Vec<Number> origin = toVec<Number>(ray.origin), direction = toVec<Number>(ray.direction);
    Intersection<Number> best;
    size_t chosen = 0;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        Intersection<Number> hit = intersect(origin, direction, surfaces[i]);
        if (hit.result == Result::Miss || hit.t <= 0 || (ray.tMin > 0 && hit.t <= ray.tMin)) continue;
        if (std::isfinite(ray.tMax) && hit.t > ray.tMax) continue;
        const bool closer = best.result == Result::Miss || hit.t < best.t;
        if (!closer && (hit.t > best.t || surfaces[i].id >= surfaces[chosen].id)) continue;
        best = std::move(hit);
        chosen = i;
    }
    if (best.result == Result::Miss) return std::nullopt;
    const double lower = below(best.t);
    return ExactHit{chosen, lower, above(best.t, lower), below(best.u), below(best.v)};
}

}  // namespace glint::reference::certain
