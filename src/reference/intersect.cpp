#include "reference/intersect.h"

#include <utility>

#include "reference/precision.h"

namespace glint::reference {
namespace {

// glm refuses __float128 (no std::numeric_limits in strict mode).
template <class T>
struct Vec {
    T x, y, z;
};

template <class T>
Vec<T> toVec(const glm::dvec3& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}
template <class T>
Vec<T> toVec(const double (&v)[3]) {
    return {static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2])};
}
template <class T>
Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec<T> operator*(T s, const Vec<T>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class T>
T dot(const Vec<T>& a, const Vec<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
Vec<T> magnitudes(const Vec<T>& a) {
    return {magnitude(a.x), magnitude(a.y), magnitude(a.z)};
}

bool accept(Extended t, double slip, const PreparedRay& ray, double tMax, Root& root) {
    root.t = static_cast<double>(t);
    root.slip = slip;
    return countsAt(ray, root.t, slip, tMax);
}

glm::dvec3 unitOf(const Vec<Extended>& n) {
    return glm::normalize(
        glm::dvec3(static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)));
}

// Intersects the line with a plane of unit normal; false if they are parallel.
bool solvePlane(const PreparedRay& ray, const glm::dvec3& normal, const glm::dvec3& point, Extended& t) {
    const Vec<Extended> n = toVec<Extended>(normal);
    const Extended nd = dot(n, toVec<Extended>(ray.direction));
    if (nd == 0) return false;
    t = dot(n, toVec<Extended>(point) - toVec<Extended>(ray.origin)) / nd;
    return true;
}

bool acceptFlat(Extended t, const glm::dvec3& normal, const glm::dvec3& point, const PreparedRay& ray,
                double tMax, Root& root) {
    root.u = root.v = 0;
    return accept(t, slipOfFlat(ray, normal, point, static_cast<double>(t)), ray, tMax, root);
}

// The sign of d.(b x c): on which side of the edge the line passes (Pluecker). Six terms of three factors,
// each of them a difference or a product rounded, err by at most 8 roundings each; 2^5 covers them, and what
// they cannot tell from zero is zero. roundoff: of T.
template <class T>
int edgeSide(const Vec<T>& d, const Vec<T>& b, const Vec<T>& c, double roundoff) {
    const T side = dot(d, cross(b, c));
    const Vec<T> p = magnitudes(b), q = magnitudes(c);
    const Vec<T> sum{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
    const T bound = static_cast<T>(32 * roundoff) * dot(magnitudes(d), sum);
    return side > bound ? 1 : side < -bound ? -1 : 0;
}
int edgeSide(const Vec<Quad>& d, const Vec<Quad>& b, const Vec<Quad>& c) {
    return edgeSide<Quad>(d, b, c, kQuadRoundoff);
}

// False too for a line in the triangle's plane, where all three sides are zero.
bool lineHitsTriangle(const rows::Triangle& triangle, const PreparedRay& ray) {
    const Vec<Quad> o = toVec<Quad>(ray.origin), d = toVec<Quad>(ray.direction);
    const Vec<Quad> a = toVec<Quad>(triangle.v0) - o, b = toVec<Quad>(triangle.v1) - o,
                    c = toVec<Quad>(triangle.v2) - o;
    const int e0 = edgeSide(d, b, c), e1 = edgeSide(d, c, a), e2 = edgeSide(d, a, b);
    const bool positive = e0 > 0 || e1 > 0 || e2 > 0;
    const bool negative = e0 < 0 || e1 < 0 || e2 < 0;
    return positive != negative;
}

// edgeSide, and of a line that passes the edge exactly the side of one whose origin is moved by (e, e^2, e^3)
// for a tiny e: d.((b - m) x (c - m)) = d.(b x c) - m.(d x (b - c)). Edelsbrunner, Muecke, "Simulation of
// Simplicity", ACM Transactions on Graphics 9(1), 1990.
int edgeSideMoved(const Vec<Quad>& d, const Vec<Quad>& b, const Vec<Quad>& c) {
    if (const int side = edgeSide(d, b, c); side != 0) return side;
    const Vec<Quad> change = cross(d, b - c);
    for (const Quad component : {change.x, change.y, change.z})
        if (component != 0) return component < 0 ? 1 : -1;
    return 0;
}

// a t^2 - 2 b t + c = 0 for w = point - origin, ordinary: b = w.d, c = w.w - r^2; anchored: b = (w - r n).d,
// c = w.w - 2 r n.w.
template <class T>
struct SphereEquation {
    T a, b, c;
    T discriminant;  // b^2 - a c
    T bound;         // of its rounding error

    // roundoff: of T. Each of w, products and sums rounds: b errs by 5 u of the sum of its terms' magnitudes,
    // c by 6 u, a by 3 u, so b^2 - a c by 16 u of the squares and products of those sums.
    SphereEquation(const rows::Sphere& sphere, const Vec<T>& w, const Vec<T>& d, double roundoff) {
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
        bound = static_cast<T>(16 * roundoff) * (bTerms * bTerms + a * cTerms);
    }
};

}  // namespace

// Squares of coordinates stay finite. Of a scene in the range of fp32 a ray from so far tells nothing apart.
constexpr double kFarthestOrigin = 1e150;

PreparedRay::PreparedRay(const Ray& ray) : ties(ray.ties), slips(ray.slips), noise(ray.noise) {
    double greatest = 0;
    bool finite = true;
    kz = 0;
    for (int i = 0; i < 3; ++i) {
        origin[i] = ray.origin[i];
        direction[i] = ray.direction[i];
        finite = finite && std::abs(origin[i]) < kFarthestOrigin && std::isfinite(direction[i]);
        inverse[i] = 1 / direction[i];
        const bool negative = std::signbit(direction[i]);
        nearPlane[i] = i + (negative ? 4 : 0);
        farPlane[i] = i + (negative ? 0 : 4);
        if (std::abs(direction[i]) > greatest) {
            greatest = std::abs(direction[i]);
            kz = i;
        }
    }
    // Below 1e-290 the reciprocal of the direction would overflow; no t that a double holds leads anywhere
    // from there.
    valid = finite && greatest > 1e-290 && !std::isnan(ray.tMin) && !std::isnan(ray.tMax);
    tMin = std::max(ray.tMin, 0.0);
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    shearX = direction[kx] / direction[kz];
    shearY = direction[ky] / direction[kz];
}

double slipOfFlat(const PreparedRay& ray, const glm::dvec3& n, const glm::dvec3& anchor, double t) {
    if (!ray.leaves && !ray.ties) return 0;
    double height = ray.slips * ray.slip, speed = 0;
    for (int i = 0; i < 3; ++i) {
        const double reach = std::abs(anchor[i] - ray.origin[i]) + std::abs(t * ray.direction[i]);
        height += 0x1p-24 * std::abs(n[i]) * (2 * std::abs(anchor[i]) + ray.slips * 6 * reach);
        speed += n[i] * ray.direction[i];
    }
    return height / std::abs(speed);
}

bool crossesTriangle(const rows::Triangle& triangle, const PreparedRay& ray) {
    {  // Double proves nearly all sides, in a sixteenth of the time; a side that it proves needs no moving.
        const Vec<double> o = toVec<double>(ray.origin), d = toVec<double>(ray.direction);
        const Vec<double> a = toVec<double>(triangle.v0) - o, b = toVec<double>(triangle.v1) - o,
                          c = toVec<double>(triangle.v2) - o;
        const int e0 = edgeSide(d, b, c, kUnitRoundoff), e1 = edgeSide(d, c, a, kUnitRoundoff),
                  e2 = edgeSide(d, a, b, kUnitRoundoff);
        if (e0 != 0 && e1 != 0 && e2 != 0) return e0 == e1 && e1 == e2;
    }
    const Vec<Quad> o = toVec<Quad>(ray.origin), d = toVec<Quad>(ray.direction);
    const Vec<Quad> a = toVec<Quad>(triangle.v0) - o, b = toVec<Quad>(triangle.v1) - o,
                    c = toVec<Quad>(triangle.v2) - o;
    const int side = edgeSideMoved(d, b, c);
    return side == edgeSideMoved(d, c, a) && side == edgeSideMoved(d, a, b);
}

bool solveTriangle(const rows::Triangle& triangle, const PreparedRay& ray, bool lineHits, double tMax,
                   Root& root) {
    if (!lineHits && !lineHitsTriangle(triangle, ray)) return false;
    const Vec<Extended> v0 = toVec<Extended>(triangle.v0), d = toVec<Extended>(ray.direction);
    const Vec<Extended> e1 = toVec<Extended>(triangle.v1) - v0, e2 = toVec<Extended>(triangle.v2) - v0;
    const Vec<Extended> n = cross(e1, e2);
    // Also the end of triangles without area: their n vanishes.
    const Extended nd = dot(n, d);
    if (nd == 0) return false;
    // From the plane, not from the edge functions, whose relative error grows without bound as the triangle
    // thins.
    const Vec<Extended> s = v0 - toVec<Extended>(ray.origin);
    const Extended t = dot(n, s) / nd;
    const double slip = slipOfFlat(ray, unitOf(n), glm::dvec3(triangle.v0), static_cast<double>(t));
    if (!accept(t, slip, ray, tMax, root)) return false;
    // Moeller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, eq. 6, written with n.d
    // for the determinant.
    const Vec<Extended> q = cross(d, s);
    const Extended u = std::clamp<Extended>(-dot(e2, q) / nd, 0, 1);
    const Extended v = std::clamp<Extended>(dot(e1, q) / nd, 0, 1);
    const Extended sum = std::max<Extended>(u + v, 1);
    root.u = static_cast<double>(u / sum);
    root.v = static_cast<double>(v / sum);
    return true;
}

bool intersectSphere(const rows::Sphere& sphere, const PreparedRay& ray, bool fromSurface, double tMax,
                     Root& root) {
    root.u = root.v = 0;
    root.twice = false;
    const Vec<Extended> d = toVec<Extended>(ray.direction);
    const Vec<Extended> w = toVec<Extended>(sphere.point) - toVec<Extended>(ray.origin);
    if (fromSurface) {
        const SphereEquation<Extended> onSurface(sphere, w, d, kExtendedRoundoff);
        const Extended t = 2 * onSurface.b / onSurface.a;
        return accept(t, slipOfRound(ray, static_cast<double>(t)), ray, tMax, root);
    }
    const SphereEquation<double> rough(sphere, toVec<double>(sphere.point) - toVec<double>(ray.origin),
                                       toVec<double>(ray.direction), kUnitRoundoff);
    if (rough.discriminant < -rough.bound) return false;

    // Seen from the point of the line nearest to sphere.point, the distance to the sphere no longer enters
    // the discriminant (Haines, Guenther and Akenine-Moeller, "Precision Improvements for Ray/Sphere
    // Intersection", Ray Tracing Gems, 2019, ch. 7).
    const Extended shift = dot(w, d) / dot(d, d);
    SphereEquation<Extended> e(sphere, w - shift * d, d, kExtendedRoundoff);
    // The shifted w errs by 10 roundings of |w|, which moves b by 10 u |w| |d|, and c by 20 u |w| (|w'| + r)
    // with |w'| <= 2 r near tangency.
    const Extended reach = std::sqrt(dot(w, w)), r = sphere.radius;
    e.bound += 64 * kExtendedRoundoff * reach * (e.a * r + std::abs(e.b) * std::sqrt(e.a));
    // 2^20 bounds from tangency the square root no longer magnifies the error above 2^-21 of itself.
    if (std::abs(e.discriminant) <= 0x1p20L * e.bound) {
        const SphereEquation<Quad> exact(sphere, toVec<Quad>(sphere.point) - toVec<Quad>(ray.origin),
                                         toVec<Quad>(ray.direction), kQuadRoundoff);
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
    return accept(t0, slipOfRound(ray, static_cast<double>(t0)), ray, tMax, root) ||
           accept(t1, slipOfRound(ray, static_cast<double>(t1)), ray, tMax, root);
}

// With w = centre - o, the point of the line in the plane is (n.w / n.d) d - w away from the centre. Squared
// and multiplied by (n.d)^2: in the disc if |(n.w) d - (n.d) w|^2 <= r^2 (n.d)^2, decided without a division.
template <class T>
int discSide(const rows::Disc& disc, const PreparedRay& ray, double roundoff) {
    const Vec<T> n = toVec<T>(disc.normal), d = toVec<T>(ray.direction);
    const Vec<T> w = toVec<T>(disc.center) - toVec<T>(ray.origin);
    const T nd = dot(n, d), nw = dot(n, w);
    const Vec<T> q = nw * d - nd * w;
    const T reach = static_cast<T>(disc.radius) * nd;
    const T side = reach * reach - dot(q, q);
    // n.w and n.d err by 4 u of their terms' magnitudes (w by one more), so each component of q by 8 u of its
    // own two terms with these magnitudes in them; the squares double that.
    const Vec<T> an = magnitudes(n), ad = magnitudes(d), aw = magnitudes(w);
    const T ndTerms = dot(an, ad), nwTerms = dot(an, aw);
    const Vec<T> terms = nwTerms * ad - (-ndTerms) * aw;
    const T reachTerms = static_cast<T>(disc.radius) * ndTerms;
    const T bound =
        static_cast<T>(32 * roundoff) * (dot(magnitudes(q), terms) + magnitude(reach) * reachTerms) +
        static_cast<T>(256 * roundoff * roundoff) * (dot(terms, terms) + reachTerms * reachTerms);
    return side > bound ? 1 : side < -bound ? -1 : 0;
}

namespace {

// The sign of component ky of the vertex, measured from the ray: moved along the ray to where component kz is
// 0, v_y - (d_y / d_z) v_z, here times d_z. Each of the two products errs by 3 roundings.
template <class T>
int heightSign(const Vec<T>& vertex, const PreparedRay& ray, double roundoff) {
    const T v[3] = {vertex.x, vertex.y, vertex.z};
    const T dy = static_cast<T>(ray.direction[ray.ky]), dz = static_cast<T>(ray.direction[ray.kz]);
    const T p = v[ray.ky] * dz, q = v[ray.kz] * dy;
    const T bound = static_cast<T>(4 * roundoff) * (magnitude(p) + magnitude(q));
    const int side = p - q > bound ? 1 : p - q < -bound ? -1 : 0;
    return dz < 0 ? -side : side;
}

bool isAbove(const glm::dvec3& vertex, const PreparedRay& ray) {
    const int side = heightSign(toVec<double>(vertex) - toVec<double>(ray.origin), ray, kUnitRoundoff);
    if (side != 0) return side > 0;
    return heightSign(toVec<Quad>(vertex) - toVec<Quad>(ray.origin), ray, kQuadRoundoff) > 0;
}

// The side of the line on which the edge from a to b passes, seen against axis kz.
int sideOf(const glm::dvec3& a, const glm::dvec3& b, const PreparedRay& ray) {
    const Vec<double> o = toVec<double>(ray.origin), d = toVec<double>(ray.direction);
    int side = edgeSide(d, toVec<double>(a) - o, toVec<double>(b) - o, kUnitRoundoff);
    if (side == 0) {
        const Vec<Quad> origin = toVec<Quad>(ray.origin);
        side = edgeSide(toVec<Quad>(ray.direction), toVec<Quad>(a) - origin, toVec<Quad>(b) - origin);
    }
    return ray.direction[ray.kz] < 0 ? -side : side;
}

}  // namespace

// Even-odd rule (docs/reference/shading.md): the edges that cross the half line which leaves the ray's line
// along axis kx. An edge goes over it from below to above with the line on its left, or down with the line on
// its right.
bool intersectPolygon(const rows::Polygon& polygon, std::span<const rows::PolygonVertex> vertices,
                      const PreparedRay& ray, double tMax, Root& root) {
    Extended t;
    if (!solvePlane(ray, polygon.normal, polygon.point, t)) return false;
    bool odd = false, above = isAbove(vertices[0].position, ray);
    Extended least = std::numeric_limits<Extended>::infinity(), greatest = -least;
    for (size_t i = 1; i < vertices.size(); ++i) {
        const glm::dvec3 &a = vertices[i - 1].position, &b = vertices[i].position;
        const bool wasAbove = std::exchange(above, isAbove(b, ray));
        const Extended corner =
            (static_cast<Extended>(b[ray.kz]) - ray.origin[ray.kz]) / ray.direction[ray.kz];
        least = std::min(least, corner);
        greatest = std::max(greatest, corner);
        if (above != wasAbove && sideOf(a, b, ray) == (above ? 1 : -1)) odd = !odd;
    }
    if (!odd) return false;
    return acceptFlat(std::clamp(t, least, greatest), polygon.normal, polygon.point, ray, tMax, root);
}

bool intersectDisc(const rows::Disc& disc, const PreparedRay& ray, double tMax, Root& root) {
    Extended t;
    if (!solvePlane(ray, disc.normal, disc.center, t)) return false;
    const int side = discSide<double>(disc, ray, kUnitRoundoff);
    // A point that quadruple precision cannot separate from the rim lies on it.
    if (side < 0 || (side == 0 && discSide<Quad>(disc, ray, kQuadRoundoff) < 0)) return false;
    return acceptFlat(t, disc.normal, disc.center, ray, tMax, root);
}

bool intersectPlane(const rows::Plane& plane, const PreparedRay& ray, double tMax, Root& root) {
    Extended t;
    return solvePlane(ray, plane.normal, plane.point, t) &&
           acceptFlat(t, plane.normal, plane.point, ray, tMax, root);
}

}  // namespace glint::reference
