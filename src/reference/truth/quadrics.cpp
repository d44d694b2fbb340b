// Quadrics in the rows of the layout (GLINT_QUADRIC_ROWS), in double. y is in units of the surface's own
// size; docs/reference/scene-format.md defines each shape.
#include <cmath>
#include <stdexcept>

#include "reference/numbers.h"
#include "reference/truth/part.h"

namespace glint::reference::truth {
namespace {

using glm::dmat3;
using glm::dvec3;

// Half extent of a side that does not clip.
constexpr double kBeyond = 1.25;

// The row under construction, in the coordinates of the shape: y = toLocal (x - point).
struct Surface : rows::Quadric {
    dmat3 toLocal{1};
    bool hasTip = false;  // a cone, measured from its apex

    Surface() {
        lo = dvec3(-kBeyond);
        hi = dvec3(kBeyond);
    }
};

// Local z from base to top, in units of `size`, from the middle. The length from there to either end.
double alongAxis(const dvec3& base, const dvec3& top, double size, bool capped, Surface& s) {
    const dvec3 w = unit(top - base);
    // Any axis across will do; that of the least component is farthest from w.
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(w[i]) < std::abs(w[least])) least = i;
    dvec3 aside(0);
    aside[least] = 1;
    const dvec3 u = unit(glm::cross(w, aside)), v = glm::cross(w, u);
    s.point = (base + top) / 2.0;
    for (int i = 0; i < 3; ++i) s.toLocal[i] = dvec3(u[i], v[i], w[i]) / size;
    const double half = glm::length(top - base) / (2 * size);
    s.lo.z = -half;
    s.hi.z = half;
    if (capped) s.caps = shared::kCapLower | shared::kCapUpper;
    return half;
}

// Measured from the place `z` on the axis instead: what of the equation depends on z is the caller's.
void moveAlongAxis(double z, Surface& s) {
    // A local length is 1 / size of one along the axis; row 2 of toLocal is w / size.
    const dvec3 row(s.toLocal[0].z, s.toLocal[1].z, s.toLocal[2].z);
    s.point += z / glm::dot(row, row) * row;
    s.lo.z -= z;
    s.hi.z -= z;
}

struct SurfaceOf {
    dvec3 eye;  // in the coordinates of the shape

    // The Hessian's halves, and the gradient's at the middle of the box.
    Surface operator()(const QuadricShape& q) const {
        const double* c = q.coefficients;
        Surface s;
        const dvec3 half = (q.hi - q.lo) / 2.0;
        const double size = std::max({half.x, half.y, half.z});
        s.point = q.lo + half;
        s.toLocal = dmat3(1 / size);
        s.hi = half / size;
        s.lo = -s.hi;
        const dvec3 p = s.point;
        const dvec3 squares(c[0], c[1], c[2]), products(c[4] / 2, c[5] / 2, c[3] / 2);
        const dvec3 image = symmetric(squares, products) * p;
        const dvec3 slope(c[6] / 2, c[7] / 2, c[8] / 2);
        s.squares = size * size * squares;
        s.products = size * size * products;
        s.linear = size * (image + slope);
        s.constant = glm::dot(p, image + 2.0 * slope) + c[9];
        return s;
    }
    Surface operator()(const EllipsoidShape& e) const {
        Surface s;
        s.point = e.center;
        s.toLocal = dmat3(1 / e.radii.x, 0, 0, 0, 1 / e.radii.y, 0, 0, 0, 1 / e.radii.z);
        s.squares = dvec3(1);
        s.constant = -1;
        return s;
    }
    // x^2 + y^2 = 1; a long one is measured from where the eye is.
    Surface operator()(const CylinderShape& c) const {
        Surface s;
        const double half = alongAxis(c.base, c.top, c.radius, c.capped, s);
        s.squares = {1, 1, 0};
        s.constant = -1;
        if (half > 64) moveAlongAxis(std::clamp((s.toLocal * (eye - s.point)).z, -half, half), s);
        return s;
    }
    // x^2 + y^2 = (g z)^2 from the apex, where that is within two lengths of the middle, else x^2 + y^2 = (m
    // + g z)^2.
    Surface operator()(const ConeShape& c) const {
        Surface s;
        const double size = std::max(c.radius, c.topRadius);
        const double half = alongAxis(c.base, c.apex, size, c.capped, s);
        const double lower = c.radius / size, upper = c.topRadius / size;
        const double growth = (upper - lower) / (2 * half), middle = (lower + upper) / 2;
        s.squares = {1, 1, -growth * growth};
        const double apex = upper == 0 ? half : lower == 0 ? -half : -middle / growth;
        if (std::abs(apex) <= 4 * half) {
            moveAlongAxis(apex, s);
            s.hasTip = std::abs(apex) <= half;
        } else {
            s.linear.z = -middle * growth;
            s.constant = -middle * middle;
        }
        return s;
    }
    // x^2 + y^2 = waist^2 + k z^2, 1 at either end.
    Surface operator()(const HyperboloidShape& h) const {
        Surface s;
        const double half = alongAxis(h.base, h.top, h.radius, h.capped, s);
        const double waist = h.waist / h.radius;
        s.squares = {1, 1, (waist - 1) * (waist + 1) / (half * half)};
        s.constant = -waist * waist;
        return s;
    }
    // x^2 + y^2 = z / height, from the vertex on.
    Surface operator()(const ParaboloidShape& p) const {
        Surface s;
        const double half = alongAxis(p.vertex, p.top, p.radius, p.capped, s);
        s.point = p.vertex;
        s.squares = {1, 1, 0};
        s.linear.z = -1 / (4 * half);
        s.lo.z = -half / 2;
        s.hi.z = 2 * half;
        s.caps = p.capped ? shared::kCapUpper : 0;
        return s;
    }
    template <class Other>
    Surface operator()(const Other&) const {
        throw std::logic_error("a shape that truth::add has no rows for");
    }
};

double valueAt(const Surface& s, const dvec3& y, dvec3& slope) {
    const dvec3 image = symmetric(s.squares, s.products) * y;
    slope = 2.0 * (image + s.linear);
    return glm::dot(y, image + 2.0 * s.linear) + s.constant;
}

// Measures the surface from its local point y.
void measureFrom(const dvec3& y, Surface& s) {
    dvec3 slope;
    s.constant = valueAt(s, y, slope);
    s.linear = slope / 2.0;
    s.lo -= y;
    s.hi -= y;
    s.point += glm::inverse(s.toLocal) * y;
    if (s.hasTip) s.caps |= shared::kFromApex;
}

// If the eye is nearer to the surface than 1/128 of its size, measure the surface from its point nearest the
// eye, where the constant vanishes. Packing does so from 1/64 of a power of two at most the size.
void measureFromNear(const dvec3& eye, Surface& s) {
    const dvec3 from = s.toLocal * (eye - s.point);
    dvec3 y = from, slope;
    for (int step = 0; step < 12; ++step) {
        y = glm::clamp(y, s.lo, s.hi);
        const double value = valueAt(s, y, slope);
        if (slope == dvec3(0)) return;
        y -= value / glm::dot(slope, slope) * slope;
    }
    if (y != glm::clamp(y, s.lo, s.hi) || 128 * glm::distance(y, from) >= 1) return;
    if (std::abs(valueAt(s, y, slope)) <= 0x1p-40 * glm::length(slope)) measureFrom(y, s);
}

}  // namespace

void Part::addQuadric(const Shape& shape, const Setting& at) {
    const Place& place = at.place;
    const dvec3 seenFrom = place.inverse * (at.eye - place.offset);
    Surface s = std::visit(SurfaceOf{seenFrom}, shape);
    measureFromNear(seenFrom, s);
    if (at.anchor) {
        const dvec3 eye = s.toLocal * (seenFrom - s.point);
        const dvec3 y = s.toLocal * (place.inverse * (*at.anchor + at.origin - place.offset) - s.point);
        if (glm::distance(y, eye) <= kAnchorRoom * glm::length(eye)) measureFrom(y, s);
    }
    s.point = place(s.point) - at.origin;
    const dmat3 turned = glm::transpose(s.toLocal * place.inverse);
    s.toLocal0 = turned[0];
    s.toLocal1 = turned[1];
    s.toLocal2 = turned[2];
    const double greatest = std::max({greatestMagnitude(s.squares), greatestMagnitude(s.products),
                                      greatestMagnitude(s.linear), std::abs(s.constant)});
    s.squares /= greatest;
    s.products /= greatest;
    s.linear /= greatest;
    s.constant /= greatest;
    put<rows::Quadric>(shared::PrimitiveKind::Quadric, model.quadrics, s, at, boxOf(s), 16 * place.gain);
}

}  // namespace glint::reference::truth
