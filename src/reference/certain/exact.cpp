#include "reference/certain/exact.h"

#include <gmpxx.h>

#include <cmath>
#include <limits>
#include <utility>

namespace glint::reference::certain {

namespace {

// m 2^e: every finite double is one, and sums, differences and products of such numbers.
struct Number {
    mpz_class m;
    long e = 0;

    Number() = default;
    Number(double x) {  // NOLINT: reads like the formula
        int exponent = 0;
        m = std::ldexp(std::frexp(x, &exponent), std::numeric_limits<double>::digits);
        e = exponent - std::numeric_limits<double>::digits;
    }
    Number(mpz_class mantissa, long exponent) : m(std::move(mantissa)), e(exponent) {}
    int sign() const { return sgn(m); }
};

Number operator*(const Number& a, const Number& b) {
    return {a.m * b.m, a.e + b.e};
}
Number added(const Number& a, const Number& b, bool minus) {
    if (b.sign() == 0) return a;
    const long e = a.sign() == 0 ? b.e : std::min(a.e, b.e);
    mpz_class x = a.sign() == 0 ? mpz_class(0) : mpz_class(a.m << static_cast<mp_bitcnt_t>(a.e - e));
    const mpz_class y = b.m << static_cast<mp_bitcnt_t>(b.e - e);
    if (minus) {
        x -= y;
    } else {
        x += y;
    }
    return {std::move(x), e};
}
Number operator+(const Number& a, const Number& b) {
    return added(a, b, false);
}
Number operator-(const Number& a, const Number& b) {
    return added(a, b, true);
}
int compare(const Number& a, const Number& b) {
    return (a - b).sign();
}

struct Vector {
    Number x, y, z;
};
Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vector exactly(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Number dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector times(const glm::dmat3& m, const Vector& v) {
    const auto row = [&](int i) {
        return Number(m[0][i]) * v.x + Number(m[1][i]) * v.y + Number(m[2][i]) * v.z;
    };
    return {row(0), row(1), row(2)};
}

// over / under, under > 0.
struct Quotient {
    Number over, under;
};
Quotient quotient(Number over, Number under) {
    if (under.sign() < 0) {
        over.m = -over.m;
        under.m = -under.m;
    }
    return {std::move(over), std::move(under)};
}
int compare(const Quotient& a, const Quotient& b) {
    return compare(a.over * b.under, b.over * a.under);
}
int compare(const Quotient& a, double b) {
    return compare(a.over, Number(b) * a.under);
}

// The greatest double that is not above it, of what lies in the range of doubles.
double below(const Quotient& q) {
    // 64 digits and more of the quotient, cut off towards minus infinity.
    const long digits = static_cast<long>(mpz_sizeinbase(q.under.m.get_mpz_t(), 2)) -
                        static_cast<long>(mpz_sizeinbase(q.over.m.get_mpz_t(), 2)) + 66;
    mpz_class over = q.over.m, under = q.under.m, cut;
    if (digits > 0) {
        over <<= static_cast<mp_bitcnt_t>(digits);
    } else {
        under <<= static_cast<mp_bitcnt_t>(-digits);
    }
    mpz_fdiv_q(cut.get_mpz_t(), over.get_mpz_t(), under.get_mpz_t());
    long exponent = 0;
    const double mantissa = mpz_get_d_2exp(&exponent, cut.get_mpz_t());  // cut off towards zero
    const long e = exponent - digits + q.over.e - q.under.e;
    double x = std::scalbn(mantissa, static_cast<int>(std::clamp(e, -3000L, 3000L)));
    if (!std::isfinite(x)) x = std::copysign(std::numeric_limits<double>::max(), x);
    while (compare(q, x) < 0) x = std::nextafter(x, -std::numeric_limits<double>::infinity());
    return x;
}
double above(const Quotient& q, double under) {
    return compare(q, under) == 0 ? under : std::nextafter(under, std::numeric_limits<double>::infinity());
}

struct Meeting {
    Quotient t;
    Number edges[3];  // those of a triangle, opposite to its corners; their sum is not 0
};

// The volumes that the ray's direction spans with two corners each, seen from its origin: on which side of
// each edge it passes (Segura, Feito, "Algorithms to Test Ray-Triangle Intersection", WSCG 2001).
std::optional<Meeting> meet(const Vector& origin, const Vector& direction, const ExactSurface& surface) {
    std::array<Vector, 3> seen;
    for (int i = 0; i < 3; ++i) {
        Vector corner = exactly(surface.corners[i]);
        if (surface.place != nullptr)
            corner = times(surface.place->linear, corner) + exactly(surface.place->offset);
        seen[i] = corner - origin;
    }
    Meeting m;
    bool positive = false, negative = false;
    for (int i = 0; i < 3; ++i) {
        m.edges[i] = dot(direction, cross(seen[(i + 1) % 3], seen[(i + 2) % 3]));
        positive = positive || m.edges[i].sign() > 0;
        negative = negative || m.edges[i].sign() < 0;
    }
    if (positive == negative) return std::nullopt;  // beside it, or in its plane
    const Vector normal = cross(seen[1] - seen[0], seen[2] - seen[0]);
    m.t = quotient(dot(normal, seen[0]), dot(normal, direction));
    return m;
}

std::optional<Meeting> meetPlane(const Vector& origin, const Vector& direction, const PlaneShape& plane) {
    const Vector normal = exactly(plane.normal);
    const Number speed = dot(normal, direction);
    if (speed.sign() == 0) return std::nullopt;
    Meeting m;
    m.t = quotient(dot(normal, exactly(plane.point) - origin), speed);
    return m;
}

double ratio(const Number& part, const Number& whole) {
    return below(quotient(part, whole));
}

}  // namespace

std::optional<ExactHit> nearestExactly(const WorldRay& ray, std::span<const ExactSurface> surfaces) {
    const Vector origin = exactly(ray.origin), direction = exactly(ray.direction);
    std::optional<Meeting> best;
    size_t chosen = 0;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        const ExactSurface& surface = surfaces[i];
        std::optional<Meeting> m = surface.plane != nullptr ? meetPlane(origin, direction, *surface.plane)
                                                            : meet(origin, direction, surface);
        if (!m || m->t.over.sign() <= 0) continue;
        if (ray.tMin > 0 && compare(m->t, ray.tMin) <= 0) continue;
        if (std::isfinite(ray.tMax) && compare(m->t, ray.tMax) > 0) continue;
        const int order = best ? compare(m->t, best->t) : -1;
        if (order > 0 || (order == 0 && surface.id >= surfaces[chosen].id)) continue;
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
        hit.u = ratio(best->edges[1], whole);
        hit.v = ratio(best->edges[2], whole);
    }
    return hit;
}

}  // namespace glint::reference::certain
