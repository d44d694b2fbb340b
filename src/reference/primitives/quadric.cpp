// Quadrics. The method differs from the shader's: the quadric is a symmetric form of four homogeneous
// coordinates. Its three values on a ray give the equation at the ray's own origin, with enough digits. Each
// root and each cap is tested against the bounds by itself.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/rounding.h"

namespace glint::reference {
namespace {

using glm::dmat3;
using glm::dvec3;

template <class T>
using Vec4 = std::array<Sum<T>, 4>;

// The quadric as v.Sv = 0 of homogeneous local coordinates (y, 1); directions end in 0.
template <class T>
struct HomogeneousForm {
    T s[4][4];

    explicit HomogeneousForm(const rows::Quadric& q) {
        const double upper[4][4] = {{q.squares.x, q.products.z, q.products.y, q.linear.x},
                                    {q.products.z, q.squares.y, q.products.x, q.linear.y},
                                    {q.products.y, q.products.x, q.squares.z, q.linear.z},
                                    {q.linear.x, q.linear.y, q.linear.z, q.constant}};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) s[i][j] = static_cast<T>(upper[i][j]);
    }
    Sum<T> operator()(const Vec4<T>& a, const Vec4<T>& b) const {
        Sum<T> sum;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) sum = sum + a[i] * Sum<T>(s[i][j]) * b[j];
        return sum;
    }
};

// A ray in homogeneous local coordinates.
template <class T>
struct LocalRay {
    Vec4<T> o, d;

    LocalRay(const rows::Quadric& q, const PreparedRay& ray) {
        const Vec<T> origin = toVec<T>(ray.origin) - toVec<T>(q.point);
        const Vec<T> direction = toVec<T>(ray.direction);
        const dmat3 rows = rowsOf(q);
        for (int i = 0; i < 3; ++i) {
            o[i] = sumOfProducts(toVec<T>(rows[i]), origin);
            d[i] = sumOfProducts(toVec<T>(rows[i]), direction);
        }
        o[3] = T{1};
    }
    Vec4<T> at(T t) const {
        Vec4<T> y;
        for (int i = 0; i < 4; ++i) y[i] = o[i].value + t * d[i].value;
        return y;
    }
};

// a t^2 + 2 b t + c = 0 at the ray's origin.
template <class T>
struct Equation {
    Sum<T> a, b, c, disc;  // disc: b^2 - a c

    Equation(const HomogeneousForm<T>& form, const LocalRay<T>& ray)
        : a(form(ray.d, ray.d)), b(form(ray.o, ray.d)), c(form(ray.o, ray.o)), disc(b * b - a * c) {}

    // Each sum has 16 products of three factors, of which two are sums of three products of a difference:
    // its terms pass less than 32 roundings.
    T bound() const { return disc.bound(64); }
};

dmat3 squaresOf(const rows::Quadric& quadric) {
    return symmetric(quadric.squares, quadric.products);
}

// The magnitudes that add up to the left side of the equation. A cone with a tip is summed at y, or from its
// apex if n(y) is at least a sixteenth of n(y + a), n the form of all magnitudes. NaN: at that bound.
double termsAt(const rows::Quadric& quadric, const dmat3& squares, const dvec3& y) {
    const double here = glm::dot(glm::abs(y), glm::abs(squares * y) + 2.0 * glm::abs(quadric.linear)) +
                        std::abs(quadric.constant);
    if (!(quadric.caps & shared::kFromApex)) return here;
    const dmat3 positive(glm::abs(squares[0]), glm::abs(squares[1]), glm::abs(squares[2]));
    const auto form = [&](const dvec3& v) { return glm::dot(glm::abs(v), positive * glm::abs(v)); };
    const dvec3 fromApex = y + glm::inverse(squares) * quadric.linear;
    const double near = 16 * form(y), far = form(fromApex);
    if (std::abs(near - far) <= 0x1p-10 * far) return std::numeric_limits<double>::quiet_NaN();
    return near < far ? here : glm::dot(glm::abs(fromApex), glm::abs(squares * fromApex));
}

// termsAt() on one side of its bound.
double termsNear(const rows::Quadric& quadric, const dmat3& squares, const dvec3& y) {
    const double terms = termsAt(quadric, squares, y);
    return std::isnan(terms) ? termsAt(quadric, squares, y * (1 + 0x1p-8)) : terms;
}

// Bound of the device's error in the discriminant, for rays with noise. c is a sum of magnitudes that errs by
// gamma_9, taken at the line's middle within the bounds. b is about 0 there: the square of its error counts
// only if `a` is rounding error as well, whose sign the ray's moves change. The device also takes lines that
// miss within this bound for tangents.
template <class T>
double tangentError(const rows::Quadric& quadric, const PreparedRay& ray, const LocalRay<T>& local,
                    const Equation<T>& e) {
    if (ray.noise.step == 0 || e.a.value == 0) return 0;
    const Vec4<T> middle = local.at(-e.b.value / e.a.value);
    dvec3 y;
    for (int i = 0; i < 3; ++i)
        y[i] = std::clamp(static_cast<double>(middle[i].value), quadric.lo[i], quadric.hi[i]);
    const double error = gammaOf(9) * termsNear(quadric, squaresOf(quadric), y);
    return std::min(1.0, ray.noise.step / kFloatUnit) * error * std::abs(static_cast<double>(e.a.value));
}

// True if double proves that the form is positive on the whole line: its equation has no root, so that a and
// c have one sign, each of them greater than its error. Most misses are proven so, in a small part of the
// time that extended precision takes.
bool lineIsOutside(const rows::Quadric& quadric, const PreparedRay& ray) {
    // Bounds below this prove nothing: products of such terms lose their digits.
    constexpr double kLeastProof = 0x1p-900;
    const HomogeneousForm<double> form(quadric);
    const LocalRay<double> local(quadric, ray);
    const Equation<double> e(form, local);
    return e.bound() > kLeastProof && e.a.value > 0 && e.disc.value < -e.bound() &&
           e.disc.value < -e.bound() - 2 * tangentError(quadric, ray, local, e);
}

// The rule for the side at t, where the local coordinates are `place`.
RoundRule ruleAt(const rows::Quadric& quadric, const PreparedRay& ray, double t,
                 const Vec4<Extended>& place) {
    const dmat3 squares = squaresOf(quadric), rows = rowsOf(quadric);
    dvec3 y;
    for (int i = 0; i < 3; ++i) y[i] = static_cast<double>(place[i].value);
    const dvec3 slope = squares * y + quadric.linear;
    const dvec3 spread =
        glm::abs(slope.x * rows[0]) + glm::abs(slope.y * rows[1]) + glm::abs(slope.z * rows[2]);
    return {ray, rows * slope, spread, quadric.point, t, termsNear(quadric, squares, y) / 2};
}

// Tolerance of the clipping planes, so that a plane through the point does not reject it.
constexpr double kClipSlack = 0x1p-44;

class Search {
  public:
    Search(const rows::Quadric& quadric, const RayTest& test, Root& root)
        : quadric_(quadric),
          test_(test),
          ray_(test.ray),
          form_(quadric),
          local_(quadric, test.ray),
          root_(root) {}

    bool run(bool fromSide) {
        sides(fromSide);
        for (const bool upper : {false, true}) {
            const uint32_t cap = upper ? shared::kPartUpperCap : shared::kPartLowerCap;
            const bool present = quadric_.caps & (upper ? shared::kCapUpper : shared::kCapLower);
            if (present) capAt(upper, cap);
        }
        return found_;
    }

  private:
    void sides(bool fromSide) {
        const Equation<Extended> e(form_, local_);
        Extended a = e.a.value, b = e.b.value, c = e.c.value, disc = e.disc.value;
        const bool startsHere =
            fromSide || (ray_.leaves &&
                         static_cast<double>(magnitude(c)) <= 2 * ruleAt(quadric_, ray_, 0, local_.o).error);
        if (startsHere) {
            // Taken as on the surface: c = 0, t = 0 is the one root and -2 b / a the other.
            if (a != 0 && magnitude(b) > 0x1p-44L * e.b.terms) side(-2 * b / a);
            return;
        }
        // 2^20 bounds from tangency the square root no longer magnifies the error above 2^-21 of itself.
        if (magnitude(disc) <= 0x1p20L * e.bound()) {
            const Equation<Quad> exact(HomogeneousForm<Quad>(quadric_), LocalRay<Quad>(quadric_, ray_));
            // A ray that quadruple precision cannot separate from a tangent is one.
            disc = magnitude(exact.disc.value) <= exact.bound() ? 0 : static_cast<Extended>(exact.disc.value);
            a = static_cast<Extended>(exact.a.value);
            b = static_cast<Extended>(exact.b.value);
            c = static_cast<Extended>(exact.c.value);
        }
        if (disc < 0) {
            const double error = tangentError(quadric_, ray_, local_, e);
            uint64_t state = ray_.noise.seed ^ quadric_.id;
            const Extended swayed = disc + error * uniform(state);
            if (error == 0 || swayed < -error) return;
            c -= (std::max<Extended>(swayed, 0) - disc) / a;
            disc = std::max<Extended>(swayed, 0);
        }
        const auto [count, t] = QuadraticRoots(a, b, c, disc);
        const bool twice = count == 2 && static_cast<double>(t[0]) == static_cast<double>(t[1]);
        for (int i = 0; i < count; ++i) side(t[i], twice);
    }

    void side(Extended t, bool twice = false) {
        const Vec4<Extended> y = local_.at(t);
        const bool rounds = ray_.ties || ray_.noise.step > 0;
        const double slip = rounds ? ruleAt(quadric_, ray_, static_cast<double>(t), y).slip(ray_) : 0;
        if (!isWithin(ray_, static_cast<double>(t), slip, test_.tMax) || !isFirst(t)) return;
        for (int i = 0; i < 3; ++i) {
            const Extended slack = slackAt(y, i) + swayAt(t, slip, i);
            if (!(y[i].value >= quadric_.lo[i] - slack && y[i].value <= quadric_.hi[i] + slack)) return;
        }
        take(t, slip, shared::kPartSide, twice);
    }

    void capAt(bool upper, uint32_t cap) {
        const Extended plane = upper ? quadric_.hi.z : quadric_.lo.z;
        if (local_.d[2].value == 0) return;
        const Extended t = (plane - local_.o[2].value) / local_.d[2].value;
        const double slip = slipOfFace(quadric_, 2, farPlane(2), local_.d[2].value, t, ray_);
        if (!countsAt(ray_, static_cast<double>(t), slip, test_.tMax) || !isFirst(t)) return;
        Vec4<Extended> y = local_.at(t);
        y[2] = plane;
        const Sum<Extended> value = form_(y, y);
        if (value.value <= kClipSlack * value.terms) take(t, slip, cap, false);
    }

    double farPlane(int i) const { return std::max(std::abs(quadric_.lo[i]), std::abs(quadric_.hi[i])); }

    Extended slackAt(const Vec4<Extended>& y, int i) const {
        return kClipSlack * (y[i].terms + magnitude<Extended>(quadric_.hi[i] - quadric_.lo[i]));
    }

    // The ray's noise in the bounds of an open rim: fp32 compares the t of the side and of the plane, which
    // err by at most their slips. A plane with a cap stays: the device's cap begins where the side ends.
    Extended swayAt(Extended t, double slip, int i) const {
        const bool hasCaps = quadric_.caps & (shared::kCapLower | shared::kCapUpper);
        const Extended speed = magnitude(local_.d[i].value);
        if (ray_.noise.step == 0 || speed == 0 || (i == 2 && hasCaps)) return 0;
        uint64_t state = ray_.noise.seed ^ (uint64_t{quadric_.id} << 2 | static_cast<uint64_t>(i + 1));
        const double most = slip + slipOfFace(quadric_, i, farPlane(i), speed, t, ray_);
        return std::min(1.0, ray_.noise.step / kFloatUnit) * uniform(state) * most * speed;
    }

    bool isFirst(Extended t) const { return !found_ || static_cast<double>(t) < root_.t; }

    void take(Extended t, double slip, uint32_t part, bool twice) {
        root_ = {.t = static_cast<double>(t), .slip = slip, .part = part, .twice = twice};
        found_ = true;
    }

    const rows::Quadric& quadric_;
    const RayTest& test_;
    const PreparedRay& ray_;
    HomogeneousForm<Extended> form_;
    LocalRay<Extended> local_;
    Root& root_;
    bool found_ = false;
};

}  // namespace

bool intersect(const rows::Quadric& quadric, const RayTest& test, Root& root) {
    const bool fromSide = test.source == (test.primitive | shared::kPartSide << shared::kPartShift);
    if (!fromSide && lineIsOutside(quadric, test.ray)) return false;
    return Search(quadric, test, root).run(fromSide);
}

namespace {

// The error of the equation's left side, as a distance along the gradient: gamma_12 of `terms`, the sum of
// the magnitudes that it adds, and gamma_5 of those that the local coordinates add.
double errorAlong(double terms, const dvec3& slope, const dmat3& rows, const dvec3& offset,
                  double steepness) {
    const dvec3 away = glm::abs(offset);
    double moved = 0;
    for (int i = 0; i < 3; ++i) moved += std::abs(slope[i]) * glm::dot(glm::abs(rows[i]), away);
    return (gammaOf(12) * terms + gammaOf(5) * moved) / steepness;
}

// Fill in position, normal and bend of the surface next to a hit point. They return the fp32 error of the
// equation's value there, along the normal (rounding.h).
double pointOnCap(const rows::Quadric& quadric, bool upper, const dvec3& point, Surface& surface) {
    const dmat3 rows = rowsOf(quadric);
    const double plane = upper ? quadric.hi.z : quadric.lo.z;
    const double height = glm::dot(rows[2], point - quadric.point) - plane;
    surface.position = point - height / glm::dot(rows[2], rows[2]) * rows[2];
    surface.geometricNormal = glm::normalize(upper ? rows[2] : -rows[2]);
    return errorAlong(std::abs(plane), {0, 0, 1}, rows, surface.position - quadric.point,
                      glm::length(rows[2]));
}

// direction: of the ray, against which the surface faces where it has no normal (the apex of a cone, a double
// plane).
double pointOnSide(const rows::Quadric& quadric, const dvec3& point, const dvec3& direction,
                   Surface& surface) {
    const dmat3 local = toLocal(quadric), rows = rowsOf(quadric);
    const dmat3 squares = squaresOf(quadric);
    const dvec3 y = local * (point - quadric.point);
    const dvec3 slope = 2.0 * (squares * y + quadric.linear);
    const dvec3 gradient = rows * slope;
    const double steepness = glm::length(gradient);
    surface.position = point;
    surface.geometricNormal = -glm::normalize(direction);
    if (!(steepness > 0)) return 0;
    const double value = glm::dot(y, squares * y + 2.0 * quadric.linear) + quadric.constant;
    const double terms = termsAt(quadric, squares, y);
    // Near an apex the surface is no farther than the root of the error of the equation.
    const double perRoot = glm::length(slope) / steepness;
    const double most = std::sqrt(gammaOf(12) * terms) * perRoot;
    // A ray that starts off the side, as the device's do, also ends off it. Below double's error the value is
    // noise, which the gradient near an apex would magnify.
    const double limit = std::abs(value) > 0x1p-40 * terms ? most : 0x1p-20 * perRoot;
    const dmat3 turning = rows * squares * local;
    surface.bend =
        2 * (glm::length(turning[0]) + glm::length(turning[1]) + glm::length(turning[2])) / steepness;
    surface.geometricNormal = gradient / steepness;
    surface.position -= std::clamp(value / steepness, -limit, limit) * surface.geometricNormal;
    const double error = errorAlong(terms, slope, rows, surface.position - quadric.point, steepness);
    return std::min(std::sqrt(error * steepness) * perRoot, error);
}

}  // namespace

void surfaceOf(const rows::Quadric& quadric, const Place& place, Surface& surface) {
    const double error =
        place.part() == shared::kPartSide
            ? pointOnSide(quadric, place.point, place.ray.direction, surface)
            : pointOnCap(quadric, place.part() == shared::kPartUpperCap, place.point, surface);
    surface.error =
        errorBox(surface.position - quadric.point, quadric.point) + error * glm::abs(surface.geometricNormal);
    surface.scale = greatestMagnitude(quadric.point) + greatestMagnitude(reachFrom(dvec3(0), quadric));
}

}  // namespace glint::reference
