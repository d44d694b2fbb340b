#include "oracle.h"

#include <algorithm>
#include <array>
#include <optional>

#include "dyadic.h"

namespace glint::oracle {

namespace {

struct Vec {
    Dyadic x, y, z;
    Vec(Dyadic a, Dyadic b, Dyadic c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
    explicit Vec(const glm::dvec3& v) : x(v.x), y(v.y), z(v.z) {}
    Vec operator-(const Vec& b) const { return {x - b.x, y - b.y, z - b.z}; }
    Vec operator+(const Vec& b) const { return {x + b.x, y + b.y, z + b.z}; }
    Vec operator*(const Dyadic& s) const { return {x * s, y * s, z * s}; }
    bool isZero() const { return x.sign() == 0 && y.sign() == 0 && z.sign() == 0; }
};

Dyadic dot(const Vec& a, const Vec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double size(const Dyadic& a) {
    return a.abs().approximate();
}
// Sum of the magnitudes of the terms of a dot product.
double termsOfDot(const Vec& a, const Vec& b) {
    return size(a.x * b.x) + size(a.y * b.y) + size(a.z * b.z);
}
// The same of the six terms of d.(a x b).
double termsOfTriple(const Vec& d, const Vec& a, const Vec& b) {
    return size(d.x * a.y * b.z) + size(d.x * a.z * b.y) + size(d.y * a.z * b.x) + size(d.y * a.x * b.z) +
           size(d.z * a.x * b.y) + size(d.z * a.y * b.x);
}
double ratio(double part, double whole) {
    return whole > 0 ? part / whole : 0;
}
double quotient(const Dyadic& a, const Dyadic& b) {
    Real q(0, kRealBits);
    q = a.real() / b.real();
    return q.get_d();
}

glm::dvec3 unit(const Real& x, const Real& y, const Real& z) {
    Real length(0, kRealBits);
    length = x * x + y * y + z * z;
    length = sqrt(length);
    if (sgn(length) == 0) return glm::dvec3(0);
    return {Real(x / length).get_d(), Real(y / length).get_d(), Real(z / length).get_d()};
}
glm::dvec3 unit(const Vec& v) {
    return unit(v.x.real(), v.y.real(), v.z.real());
}

// a t^2 + 2 b t + c, a >= 0.
struct Quadratic {
    Dyadic a, b, c;
    Dyadic discriminant() const { return b * b - a * c; }
    Real root(int side) const {
        Real r(0, kRealBits);
        r = sqrt(discriminant().real());
        if (side < 0) r = -r;
        r = (r - b.real()) / a.real();
        return r;
    }
    // The side of the first root > 0, by signs alone.
    std::optional<int> firstPositive() const {
        if (discriminant().sign() < 0) return std::nullopt;
        if (c.sign() < 0) return 1;              // roots of both signs
        if (b.sign() >= 0) return std::nullopt;  // none above 0
        return c.sign() == 0 ? 1 : -1;           // c = 0: one of them is 0
    }
};

Truth quadraticTruth(const Quadratic& q, const Vec& fromCenter, const Vec& direction, double margin) {
    Truth truth;
    truth.margin = margin;
    const auto side = q.firstPositive();
    if (!side) return truth;
    truth.hit = true;
    Real t(0, kRealBits);
    t = q.root(*side);
    truth.t = t.get_d();
    truth.normal = unit(Real(fromCenter.x.real() + t * direction.x.real()),
                        Real(fromCenter.y.real() + t * direction.y.real()),
                        Real(fromCenter.z.real() + t * direction.z.real()));
    return truth;
}

// Three signed volumes of the ray with the edges (Plucker coordinates), of one sign, or zero, but not all
// zero, where the ray meets the triangle.
struct Crossing {
    Vec d, a, b, c;  // the direction; corners from the origin
    std::array<Dyadic, 3> e;
    Dyadic whole;   // d.n, n twice the area vector
    Dyadic height;  // n.(v0 - o) = a.(b x c): t is this over d.n
    Crossing(const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2, const Ray& ray)
        : d(ray.direction),
          a(Vec(v0) - Vec(ray.origin)),
          b(Vec(v1) - Vec(ray.origin)),
          c(Vec(v2) - Vec(ray.origin)) {
        const Vec bc = cross(b, c);
        e = {dot(d, bc), dot(d, cross(c, a)), dot(d, cross(a, b))};
        whole = e[0] + e[1] + e[2];
        height = dot(a, bc);
    }
    bool isHit() const {
        const int side = whole.sign();
        for (const Dyadic& edge : e)
            if (edge.sign() == -side) return false;
        return side != 0 && height.sign() == side;
    }
};

// The sign of d.(a x b) where double arithmetic proves it, or 0. Of what a, b (differences of doubles,
// rounded once) and d are, each of the six terms is off by seven roundings at most, and so is the sum of
// their sizes: 16 units cover both. What underflows loses less than 2^-1074 times a coordinate.
int provenSign(const glm::dvec3& d, const glm::dvec3& a, const glm::dvec3& b) {
    constexpr double kMost = 0x1p100, kLeast = 0x1p-900;
    const double value = glm::dot(d, glm::cross(a, b));
    const glm::dvec3 p = glm::abs(d), q = glm::abs(a), r = glm::abs(b);
    const double terms =
        p.x * (q.y * r.z + q.z * r.y) + p.y * (q.z * r.x + q.x * r.z) + p.z * (q.x * r.y + q.y * r.x);
    const bool told =
        p.x < kMost && p.y < kMost && p.z < kMost && terms > kLeast && std::abs(value) > 16 * 0x1p-53 * terms;
    return told ? (value > 0 ? 1 : -1) : 0;
}

}  // namespace

bool hitsTriangle(const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2, const Ray& ray) {
    const glm::dvec3 near[3] = {v0 - ray.origin, v1 - ray.origin, v2 - ray.origin};
    int proven[3];
    for (int i = 0; i < 3; ++i) proven[i] = provenSign(ray.direction, near[(i + 1) % 3], near[(i + 2) % 3]);
    const auto [least, most] = std::minmax({proven[0], proven[1], proven[2]});
    if (least < 0 && most > 0) return false;
    if (least == most && least != 0) {
        const int height = provenSign(near[0], near[1], near[2]);
        if (height != 0) return height == least;
    }
    return Crossing(v0, v1, v2, ray).isHit();
}

Truth triangle(const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2, const Ray& ray) {
    const Crossing found(v0, v1, v2, ray);
    const auto& [d, a, b, c, e, whole, height] = found;
    Truth truth;
    if (whole.sign() == 0) return truth;
    truth.margin =
        std::min({ratio(size(e[0]), termsOfTriple(d, b, c)), ratio(size(e[1]), termsOfTriple(d, c, a)),
                  ratio(size(e[2]), termsOfTriple(d, a, b)), ratio(size(height), termsOfTriple(a, b, c))});
    truth.hit = found.isHit();
    if (!truth.hit) return truth;
    truth.t = quotient(height, whole);
    truth.u = quotient(e[1], whole);
    truth.v = quotient(e[2], whole);
    truth.normal = unit(cross(b - a, c - a));
    return truth;
}

Truth sphere(const glm::dvec3& center, double radius, const Ray& ray) {
    const Vec o = Vec(ray.origin) - Vec(center), d(ray.direction);
    const Dyadic r2 = Dyadic(radius) * radius;
    const Quadratic q = {dot(d, d), dot(o, d), dot(o, o) - r2};
    if (q.a.sign() == 0) return {};
    const double limb = ratio(size(q.discriminant()), size(q.a * r2));
    const double start = ratio(size(q.c), size(dot(o, o) + r2));
    return quadraticTruth(q, o, d, std::min(limb, start));
}

Truth anchoredSphere(const glm::dvec3& point, const glm::dvec3& normal, double radius, const Ray& ray) {
    const Vec o = Vec(ray.origin) - Vec(point), n(normal), d(ray.direction);
    const Vec arm = n * Dyadic(radius);
    const Vec fromCenter = o + arm;
    const Dyadic twice = dot(o, arm) + dot(o, arm);
    const Quadratic q = {dot(d, d), dot(fromCenter, d), dot(o, o) + twice};
    if (q.a.sign() == 0) return {};
    const double limb = ratio(size(q.discriminant()), size(q.a * dot(arm, arm)));
    const double start = ratio(size(q.c), size(dot(o, o)) + size(twice));
    return quadraticTruth(q, fromCenter, d, std::min(limb, start));
}

Truth plane(const glm::dvec3& point, const glm::dvec3& normal, const Ray& ray) {
    const Vec n(normal), d(ray.direction), toPoint = Vec(point) - Vec(ray.origin);
    const Dyadic speed = dot(n, d), height = dot(n, toPoint);
    Truth truth;
    truth.margin =
        std::min(ratio(size(speed), termsOfDot(n, d)), ratio(size(height), termsOfDot(n, toPoint)));
    if (speed.sign() == 0 || height.sign() != speed.sign()) return truth;
    truth.hit = true;
    truth.t = quotient(height, speed);
    truth.normal = unit(n);
    return truth;
}

// |(o - c) + (h / s) d| <= r, multiplied by |s|.
Truth disc(const glm::dvec3& center, const glm::dvec3& normal, double radius, const Ray& ray) {
    Truth truth = plane(center, normal, ray);
    const Vec n(normal), d(ray.direction), toCenter = Vec(center) - Vec(ray.origin);
    const Dyadic speed = dot(n, d), height = dot(n, toCenter);
    if (speed.sign() == 0) return truth;
    const Vec offset = d * height - toCenter * speed;
    const Dyadic limit = Dyadic(radius) * radius * speed * speed, square = dot(offset, offset);
    truth.margin = std::min(truth.margin, ratio(size(limit - square), size(limit)));
    if (limit < square) truth.hit = false;
    return truth;
}

namespace {

struct Point2 {
    Dyadic x, y;
};

// The vertex seen along the ray, off by the factor d.z: (x, y) d.z - z (d.x, d.y) for the axis z along which
// d is not 0. Exact; a linear map of the picture, so that inside stays inside.
Point2 seen(const Vec& v, const Vec& d) {
    if (d.z.sign() != 0) return {v.x * d.z - v.z * d.x, v.y * d.z - v.z * d.y};
    if (d.y.sign() != 0) return {v.z * d.y - v.y * d.z, v.x * d.y - v.y * d.x};
    return {v.y * d.x - v.x * d.y, v.z * d.x - v.x * d.z};
}

// From the origin to the segment.
double distanceTo(const Point2& a, const Point2& b) {
    const glm::dvec2 p(a.x.approximate(), a.y.approximate()), q(b.x.approximate(), b.y.approximate());
    const double length = glm::dot(q - p, q - p);
    const double along = length > 0 ? std::clamp(-glm::dot(p, q - p) / length, 0.0, 1.0) : 0.0;
    return glm::length(p + along * (q - p));
}

}  // namespace

Truth polygon(const std::vector<glm::dvec3>& outline, const glm::dvec3& point, const glm::dvec3& normal,
              const Ray& ray) {
    Truth truth = plane(point, normal, ray);
    const Vec o(ray.origin), d(ray.direction);
    if (d.isZero()) return {};
    std::vector<Point2> corners;
    corners.reserve(outline.size());
    double reach = 0;
    for (const glm::dvec3& v : outline) {
        corners.push_back(seen(Vec(v) - o, d));
        reach = std::max({reach, size(corners.back().x), size(corners.back().y)});
    }
    bool inside = false;
    double nearest = reach;
    for (size_t i = 0; i < corners.size(); ++i) {
        const Point2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
        nearest = std::min(nearest, distanceTo(a, b));
        if ((a.y.sign() > 0) == (b.y.sign() > 0)) continue;
        // x of the edge at y = 0 is (a.x b.y - b.x a.y) / (b.y - a.y).
        if ((a.x * b.y - b.x * a.y).sign() * (b.y - a.y).sign() > 0) inside = !inside;
    }
    truth.margin = std::min(truth.margin, ratio(nearest, reach));
    truth.hit = truth.hit && inside;
    return truth;
}

Roots quadric(const double (&k)[10], const Ray& ray) {
    const Vec o(ray.origin), d(ray.direction);
    const auto form = [&](const Vec& p, const Vec& q) {  // twice the symmetric bilinear form of A..F
        const Dyadic two(2);
        return two * (Dyadic(k[0]) * p.x * q.x + Dyadic(k[1]) * p.y * q.y + Dyadic(k[2]) * p.z * q.z) +
               Dyadic(k[3]) * (p.x * q.y + p.y * q.x) + Dyadic(k[4]) * (p.y * q.z + p.z * q.y) +
               Dyadic(k[5]) * (p.x * q.z + p.z * q.x);
    };
    const Vec g(k[6], k[7], k[8]);
    // F(o + t d) doubled: a t^2 + 2 b t + c.
    Quadratic q = {form(d, d), form(o, d) + dot(g, d), form(o, o) + Dyadic(2) * (dot(g, o) + Dyadic(k[9]))};
    if (q.a.sign() < 0) q = {-q.a, -q.b, -q.c};
    Roots roots;
    if (q.a.sign() == 0) {
        roots.discriminantSign = q.b.sign() != 0;
        if (q.b.sign() == 0) return roots;
        roots.count = 1;
        roots.t[0] = -quotient(q.c, q.b + q.b);
        return roots;
    }
    roots.discriminantSign = q.discriminant().sign();
    if (roots.discriminantSign < 0) return roots;
    roots.count = roots.discriminantSign == 0 ? 1 : 2;
    roots.t[0] = q.root(-1).get_d();
    roots.t[1] = q.root(1).get_d();
    return roots;
}

// The greatest near plane against the least far plane, both as fractions with positive denominators.
bool box(const glm::dvec3& lo, const glm::dvec3& hi, const Ray& ray) {
    if (ray.direction == glm::dvec3(0)) return false;
    Dyadic nearTop(0), nearBottom(1), farTop, farBottom;
    bool bounded = false;
    for (int i = 0; i < 3; ++i) {
        if (lo[i] > hi[i]) return false;
        const Dyadic d(ray.direction[i]), below = Dyadic(lo[i]) - Dyadic(ray.origin[i]),
                                          above = Dyadic(hi[i]) - Dyadic(ray.origin[i]);
        if (d.sign() == 0) {
            if (below.sign() > 0 || above.sign() < 0) return false;
            continue;
        }
        const Dyadic speed = d.abs(), enter = d.sign() > 0 ? below : -above,
                     leave = d.sign() > 0 ? above : -below;
        if (nearTop * speed < enter * nearBottom) {
            nearTop = enter;
            nearBottom = speed;
        }
        if (!bounded || leave * farBottom < farTop * speed) {
            farTop = leave;
            farBottom = speed;
        }
        bounded = true;
    }
    return !(farTop * nearBottom < nearTop * farBottom);
}

}  // namespace glint::oracle
