#include "reference/quadric.h"

#include <array>

namespace glint::reference {
namespace {

using glm::dmat3;
using glm::dvec3;

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
constexpr double kQuadRoundoff = 0x1p-113;
#else
using Quad = long double;
constexpr double kQuadRoundoff = 0x1p-64;
#endif
using Extended = long double;
constexpr double kExtendedRoundoff = static_cast<double>(std::numeric_limits<long double>::epsilon() / 2);

template <class T>
T magnitude(T a) {
    return a < 0 ? -a : a;
}

template <class T>
using Vec4 = std::array<T, 4>;

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
    T operator()(const Vec4<T>& a, const Vec4<T>& b) const {
        T sum = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) sum += a[i] * s[i][j] * b[j];
        return sum;
    }
    // The same sum of magnitudes, for a and b that are magnitudes themselves.
    T terms(const Vec4<T>& a, const Vec4<T>& b) const {
        T sum = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) sum += a[i] * magnitude(s[i][j]) * b[j];
        return sum;
    }
};

// A ray in homogeneous local coordinates, and the magnitudes that their sums are made of.
template <class T>
struct LocalRay {
    Vec4<T> o{0, 0, 0, 1}, d{0, 0, 0, 0};
    Vec4<T> oTerms{0, 0, 0, 1}, dTerms{0, 0, 0, 0};

    LocalRay(const rows::Quadric& q, const PreparedRay& ray) {
        const dvec3 turned[3] = {q.toLocal0, q.toLocal1, q.toLocal2};
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) {
                const T m = static_cast<T>(turned[i][k]);
                const T w = static_cast<T>(ray.origin[k]) - static_cast<T>(q.point[k]);
                const T dk = static_cast<T>(ray.direction[k]);
                o[i] += m * w;
                d[i] += m * dk;
                oTerms[i] += magnitude(m * w);
                dTerms[i] += magnitude(m * dk);
            }
        }
    }
    Vec4<T> at(T t) const {
        Vec4<T> y;
        for (int i = 0; i < 4; ++i) y[i] = o[i] + t * d[i];
        return y;
    }
};

// a t^2 + 2 b t + c = 0 at the ray's origin.
template <class T>
struct Equation {
    T a, b, c;
    T bTerms;
    T disc, bound;  // b^2 - a c and the bound of its error

    // Each sum has 16 products of three factors, one of them a sum of three products of a difference: its
    // error is below 32 u of its terms.
    Equation(const HomogeneousForm<T>& form, const LocalRay<T>& ray, double roundoff) {
        a = form(ray.d, ray.d);
        b = form(ray.o, ray.d);
        c = form(ray.o, ray.o);
        const T aTerms = form.terms(ray.dTerms, ray.dTerms), cTerms = form.terms(ray.oTerms, ray.oTerms);
        bTerms = form.terms(ray.oTerms, ray.dTerms);
        disc = b * b - a * c;
        bound = static_cast<T>(64 * roundoff) *
                (magnitude(b) * bTerms + magnitude(a) * cTerms + magnitude(c) * aTerms);
    }
};

// What the roots of a sound equation may be off, so that a clip plane through the point does not lose it.
constexpr double kClipSlack = 0x1p-44;

class Search {
  public:
    Search(const rows::Quadric& quadric, const PreparedRay& ray, double tMax)
        : quadric_(quadric), ray_(ray), form_(quadric), local_(quadric, ray), tMax_(tMax) {}

    bool run(bool isSource, uint32_t ownPart, Root& root, uint32_t& part) {
        sides(isSource && ownPart == shared::kPartSide);
        for (const bool upper : {false, true}) {
            const uint32_t cap = upper ? shared::kPartUpperCap : shared::kPartLowerCap;
            const bool present = quadric_.caps & (upper ? shared::kCapUpper : shared::kCapLower);
            if (present && !(isSource && ownPart == cap)) capAt(upper, cap);
        }
        root.u = root.v = 0;
        root.t = best_;
        part = part_;
        return found_;
    }

  private:
    void sides(bool fromSide) {
        Equation<Extended> e(form_, local_, kExtendedRoundoff);
        if (fromSide) {
            // Taken as on the surface: c = 0, t = 0 is the one root and -2 b / a the other.
            if (e.a != 0 && magnitude(e.b) > 0x1p-44L * e.bTerms) side(-2 * e.b / e.a);
            return;
        }
        // 2^20 bounds from tangency the square root no longer magnifies the error above 2^-21 of itself.
        if (magnitude(e.disc) <= 0x1p20L * e.bound) {
            const Equation<Quad> exact(HomogeneousForm<Quad>(quadric_), LocalRay<Quad>(quadric_, ray_),
                                       kQuadRoundoff);
            // What quadruple precision cannot tell from a tangent is one.
            e.disc = magnitude(exact.disc) <= exact.bound ? 0 : static_cast<Extended>(exact.disc);
            e.a = static_cast<Extended>(exact.a);
            e.b = static_cast<Extended>(exact.b);
            e.c = static_cast<Extended>(exact.c);
        }
        if (e.disc < 0) return;
        Extended roots[2];
        const int count = solveQuadratic(e.a, e.b, e.c, e.disc, roots);
        for (int i = 0; i < count; ++i) side(roots[i]);
    }

    void side(Extended t) {
        const Vec4<Extended> y = local_.at(t);
        for (int i = 0; i < 3; ++i) {
            const Extended slack = slackAt(y, i);
            if (!(y[i] >= quadric_.lo[i] - slack && y[i] <= quadric_.hi[i] + slack)) return;
        }
        take(t, shared::kPartSide);
    }

    void capAt(bool upper, uint32_t cap) {
        const Extended plane = upper ? quadric_.hi.z : quadric_.lo.z;
        if (local_.d[2] == 0) return;
        const Extended t = (plane - local_.o[2]) / local_.d[2];
        Vec4<Extended> y = local_.at(t);
        y[2] = plane;
        Vec4<Extended> terms;
        for (int i = 0; i < 4; ++i) terms[i] = magnitude(y[i]);
        if (form_(y, y) <= kClipSlack * form_.terms(terms, terms)) take(t, cap);
    }

    Extended slackAt(const Vec4<Extended>& y, int i) const {
        return kClipSlack * (magnitude(y[i]) + magnitude<Extended>(quadric_.hi[i] - quadric_.lo[i]));
    }

    void take(Extended exact, uint32_t part) {
        const auto t = static_cast<double>(exact);
        if (!(t > ray_.tMin && t <= tMax_ && t <= std::numeric_limits<double>::max())) return;
        if (found_ && best_ <= t) return;
        best_ = t;
        part_ = part;
        found_ = true;
    }

    const rows::Quadric& quadric_;
    const PreparedRay& ray_;
    HomogeneousForm<Extended> form_;
    LocalRay<Extended> local_;
    double tMax_;
    double best_ = 0;
    uint32_t part_ = 0;
    bool found_ = false;
};

dmat3 toLocal(const rows::Quadric& q) {
    return glm::transpose(dmat3(dvec3(q.toLocal0), dvec3(q.toLocal1), dvec3(q.toLocal2)));
}

}  // namespace

bool intersectQuadric(const rows::Quadric& quadric, const PreparedRay& ray, uint32_t primitive,
                      uint32_t source, double tMax, Root& root, uint32_t& part) {
    const uint32_t ownPart = source >> shared::kPartShift & shared::kPartMask;
    const bool isSource = (primitive | ownPart << shared::kPartShift) == source;
    return Search(quadric, ray, tMax).run(isSource, ownPart, root, part);
}

QuadricPoint quadricPoint(const rows::Quadric& quadric, uint32_t part, const dvec3& point,
                          const dvec3& direction) {
    const dmat3 local = toLocal(quadric), transposed = glm::transpose(local);
    const dvec3 origin(quadric.point);
    QuadricPoint site{point, -glm::normalize(direction)};
    if (part != shared::kPartSide) {
        const bool upper = part == shared::kPartUpperCap;
        const dvec3 row = transposed[2];
        const double height =
            glm::dot(row, point - origin) - static_cast<double>(upper ? quadric.hi.z : quadric.lo.z);
        site.position = point - height / glm::dot(row, row) * row;
        site.normal = glm::normalize(upper ? row : -row);
        return site;
    }
    const dmat3 squares(quadric.squares.x, quadric.products.z, quadric.products.y, quadric.products.z,
                        quadric.squares.y, quadric.products.x, quadric.products.y, quadric.products.x,
                        quadric.squares.z);
    const dvec3 linear(quadric.linear);
    const dvec3 y = local * (point - origin);
    const dvec3 slope = 2.0 * (squares * y + linear);
    const dvec3 gradient = transposed * slope;
    const double square = glm::dot(gradient, gradient);
    if (!(square > 0)) return site;
    const double value = glm::dot(y, squares * y + 2.0 * linear) + static_cast<double>(quadric.constant);
    // A step longer than the root of the error of `value` is the sign of a point without a normal.
    const double limit = 0x1p-20 * glm::length(slope) / std::sqrt(square);
    site.normal = gradient / std::sqrt(square);
    const dmat3 turning = transposed * squares * local;
    site.bend =
        2 * (glm::length(turning[0]) + glm::length(turning[1]) + glm::length(turning[2])) / std::sqrt(square);
    site.position = point - std::clamp(value / std::sqrt(square), -limit, limit) * site.normal;
    return site;
}

double quadricReach(const rows::Quadric& quadric) {
    const dmat3 back = glm::inverse(toLocal(quadric));
    const dvec3 size = glm::max(glm::abs(dvec3(quadric.lo)), glm::abs(dvec3(quadric.hi)));
    const dvec3 reach = glm::abs(back[0]) * size.x + glm::abs(back[1]) * size.y + glm::abs(back[2]) * size.z;
    return std::max({reach.x, reach.y, reach.z});
}

}  // namespace glint::reference
