// Turns quadrics of every name into the one form of the tracers (Quadric in shared/primitives.h).
#include <algorithm>
#include <cmath>

#include "core/vectors.h"
#include "pack/primitives.h"
#include "scene/transform.h"

namespace glint {
namespace {

using glm::dmat3;
using glm::dvec3;

// y.Qy + 2 linear.y + constant = 0 for y = toLocal (x - center), within lo <= y <= hi.
struct Form {
    dvec3 center{0};
    dmat3 toLocal{1};
    dmat3 squares{0};
    dvec3 linear{0};
    double constant = 0;
    dvec3 lo{-1}, hi{1};
    uint32_t caps = 0;
    bool isSingular = false;  // the gradient may vanish on the surface
    bool hasTip = false;      // a cone, measured from its apex

    double value(const dvec3& y) const { return glm::dot(y, squares * y + 2.0 * linear) + constant; }
    dvec3 gradient(const dvec3& y) const { return 2.0 * (squares * y + linear); }
    // Measured from another point of local space.
    void moveTo(const dvec3& y) {
        constant = value(y);
        linear += squares * y;
        lo -= y;
        hi -= y;
        center += glm::inverse(toLocal) * y;
    }
};

// Sides of the clipping box that must not clip stand off from the surface by a quarter of its size: far more
// than rounding moves either.
constexpr double kRoom = 1.25;

// The greatest power of two not above x: dividing by it is exact.
double binade(double x) {
    return std::ldexp(1.0, std::ilogb(x));
}

dmat3 diagonal(const dvec3& d) {
    return {d.x, 0, 0, 0, d.y, 0, 0, 0, d.z};
}

// A body of revolution from base to top: local z runs along the axis from the middle, x and y across it, in
// units of the power of two next to `radius`.
struct Axis {
    double half;  // of the height, in local units
    double unit;
};

Axis placeOnAxis(const dvec3& base, const dvec3& top, double radius, Form& form) {
    const dvec3 w = unitVector(top - base).value();
    // The coordinate axis after the greatest component of w: an axis parallel to a coordinate axis gets a
    // frame of them.
    const int greatest = std::abs(w.x) > std::abs(w.y) ? (std::abs(w.x) > std::abs(w.z) ? 0 : 2)
                                                       : (std::abs(w.y) > std::abs(w.z) ? 1 : 2);
    dvec3 helper(0);
    helper[(greatest + 1) % 3] = 1;
    const dvec3 u = glm::normalize(helper - glm::dot(helper, w) * w), v = glm::cross(w, u);
    const double unit = binade(radius);
    form.center = base + 0.5 * (top - base);
    form.toLocal = glm::transpose(dmat3(u, v, w)) / unit;
    const double half = 0.5 * glm::length(top - base) / unit;
    form.lo = dvec3(-kRoom * radius / unit, -kRoom * radius / unit, -half);
    form.hi = -form.lo;
    return {half, unit};
}

uint32_t bothCaps(bool capped) {
    return capped ? shared::kCapLower | shared::kCapUpper : 0;
}

struct ExactForm {
    Form operator()(const QuadricShape& shape) const {
        const double* c = shape.coefficients;
        Form form;
        const dvec3 half = 0.5 * (shape.hi - shape.lo);
        const double unit = binade(std::max({half.x, half.y, half.z}));
        form.center = shape.lo + half;
        form.toLocal = dmat3(1 / unit);
        form.hi = half / unit;
        form.lo = -form.hi;
        const dmat3 q(c[0], c[3] / 2, c[5] / 2, c[3] / 2, c[1], c[4] / 2, c[5] / 2, c[4] / 2, c[2]);
        const dvec3 g(c[6] / 2, c[7] / 2, c[8] / 2);
        form.squares = unit * unit * q;
        form.linear = unit * (q * form.center + g);
        form.constant = glm::dot(form.center, q * form.center + 2.0 * g) + c[9];
        form.isSingular = true;
        return form;
    }
    Form operator()(const EllipsoidShape& shape) const {
        Form form;
        form.center = shape.center;
        form.toLocal = diagonal(1.0 / shape.radii);
        form.squares = dmat3(1);
        form.constant = -1;
        form.hi = dvec3(kRoom);
        form.lo = -form.hi;
        return form;
    }
    Form operator()(const CylinderShape& shape) const {
        Form form;
        const Axis axis = placeOnAxis(shape.base, shape.top, shape.radius, form);
        const double r = shape.radius / axis.unit;
        form.squares = diagonal({1, 1, 0});
        form.constant = -r * r;
        form.caps = bothCaps(shape.capped);
        return form;
    }
    Form operator()(const ConeShape& shape) const {
        Form form;
        const Axis axis = placeOnAxis(shape.base, shape.apex, std::max(shape.radius, shape.topRadius), form);
        const double r0 = shape.radius / axis.unit, r1 = shape.topRadius / axis.unit;
        const double slope = (r1 - r0) / (2 * axis.half), r = 0.5 * (r0 + r1);
        form.squares = diagonal({1, 1, -slope * slope});
        form.caps = bothCaps(shape.capped);
        // From its apex, where all but the squares vanish: rounded constants would open or fill the tip. A
        // cone whose apex is far away is almost a cylinder, and has no tip.
        const double apex = shape.topRadius == 0 ? axis.half : shape.radius == 0 ? -axis.half : -r / slope;
        if (std::abs(apex) <= 4 * axis.half) {
            form.center = shape.topRadius == 0 ? shape.apex
                          : shape.radius == 0  ? shape.base
                                               : form.center + glm::inverse(form.toLocal) * dvec3(0, 0, apex);
            form.lo.z -= apex;
            form.hi.z -= apex;
            form.isSingular = form.hasTip = std::abs(apex) <= axis.half;  // a cut one has no tip either
        } else {
            form.linear = dvec3(0, 0, -slope * r);
            form.constant = -r * r;
        }
        return form;
    }
    Form operator()(const HyperboloidShape& shape) const {
        Form form;
        const Axis axis = placeOnAxis(shape.base, shape.top, shape.radius, form);
        const double r = shape.radius / axis.unit, w = shape.waist / axis.unit;
        form.squares = diagonal({1, 1, -(r - w) * (r + w) / (axis.half * axis.half)});
        form.constant = -w * w;
        form.caps = bothCaps(shape.capped);
        return form;
    }
    Form operator()(const ParaboloidShape& shape) const {
        Form form;
        const Axis axis = placeOnAxis(shape.vertex, shape.top, shape.radius, form);
        const double r = shape.radius / axis.unit;
        form.center = shape.vertex;
        form.squares = diagonal({1, 1, 0});
        form.linear = dvec3(0, 0, -r * r / (4 * axis.half));
        form.lo.z = -0.5 * axis.half;  // nothing is there: room below the vertex
        form.hi.z = 2 * axis.half;
        form.caps = shape.capped ? shared::kCapUpper : 0;
        return form;
    }
    template <class Other>
    Form operator()(const Other&) const {
        return {};
    }
};

// The greatest n.x of points x of a shape.
struct Support {
    dvec3 n;

    double across(const dvec3& axis) const { return glm::length(glm::cross(n, unitVector(axis).value())); }
    double operator()(const QuadricShape& s) const {
        const dvec3 a = n * s.lo, b = n * s.hi;
        return std::max(a.x, b.x) + std::max(a.y, b.y) + std::max(a.z, b.z);
    }
    double operator()(const EllipsoidShape& s) const {
        return glm::dot(n, s.center) + glm::length(n * s.radii);
    }
    double operator()(const CylinderShape& s) const {
        return std::max(glm::dot(n, s.base), glm::dot(n, s.top)) + s.radius * across(s.top - s.base);
    }
    double operator()(const ConeShape& s) const {
        const double side = across(s.apex - s.base);
        return std::max(glm::dot(n, s.base) + s.radius * side, glm::dot(n, s.apex) + s.topRadius * side);
    }
    double operator()(const HyperboloidShape& s) const {
        return std::max(glm::dot(n, s.base), glm::dot(n, s.top)) + s.radius * across(s.top - s.base);
    }
    // At the height share z^2 the circle has the radius share z: n.vertex + a z^2 + b z, z in [0, 1].
    double operator()(const ParaboloidShape& s) const {
        const double a = glm::dot(n, s.top - s.vertex), b = s.radius * across(s.top - s.vertex);
        const double z = a < 0 && b < -2 * a ? -b / (2 * a) : 1;
        return glm::dot(n, s.vertex) + std::max(0.0, (a * z + b) * z);
    }
    template <class Other>
    double operator()(const Other&) const {
        return 0;
    }
};

Form formOf(const Object& object) {
    Form form = std::visit(ExactForm{}, object.shape);
    if (object.transform) {
        form.center = object.transform->linear * form.center + object.transform->offset;
        form.toLocal = form.toLocal * glm::inverse(object.transform->linear);
    }
    return form;
}

// The point of the side nearest the eye, by Newton's steps along the gradient. Nothing if they do not get
// there.
std::optional<dvec3> nearestOnSide(const Form& form, const dvec3& eye) {
    dvec3 y = eye;
    for (int step = 0; step < 8; ++step) {
        y = glm::clamp(y, form.lo, form.hi);
        const dvec3 gradient = form.gradient(y);
        const double square = glm::dot(gradient, gradient);
        if (!(square > 0)) return std::nullopt;
        y -= form.value(y) / square * gradient;
    }
    const bool inBox = glm::clamp(y, form.lo, form.hi) == y;
    const double step = std::abs(form.value(y)) / glm::length(form.gradient(y));
    return inBox && step < 0x1p-40 ? std::optional(y) : std::nullopt;
}

// The point of the surface nearest the eye, if it is near compared with the radius or with the distance to
// the point that the form is measured from. Measured from there, the constant drops out of the equation, and
// with it the radius of curvature, as for an anchored sphere; the plane of a cap is at exactly 0. Measured
// from elsewhere, hits would err by 2^-24 of the distance, which from a long cone's apex is many times the
// radius.
// If the gradient vanishes, rounded constants would open or fill the surface. Such a form moves only if the
// eye is so near that hits would otherwise lose six digits. A cone with a tip is measured from its apex, too.
std::optional<dvec3> anchorOf(const Form& form, const dvec3& eye) {
    double nearest = form.isSingular && !form.hasTip ? 1.0 / 64 : std::max(0.5, 0.25 * glm::length(eye));
    std::optional<dvec3> anchor;
    const auto offer = [&](const dvec3& y) {
        if (!(glm::distance(y, eye) < nearest)) return;
        nearest = glm::distance(y, eye);
        anchor = y;
    };
    if (const auto side = nearestOnSide(form, eye)) offer(*side);
    for (const bool upper : {false, true}) {
        const dvec3 y(eye.x, eye.y, upper ? form.hi.z : form.lo.z);
        const bool isCapped = form.caps & (upper ? shared::kCapUpper : shared::kCapLower);
        if (isCapped && glm::clamp(y, form.lo, form.hi) == y && form.value(y) <= 0) offer(y);
    }
    return anchor;
}

// Coefficients near 1, by a power of two.
void scaleEquation(Form& form) {
    const double greatest = std::max({greatestMagnitude(form.squares[0]), greatestMagnitude(form.squares[1]),
                                      greatestMagnitude(form.squares[2]), greatestMagnitude(form.linear),
                                      std::abs(form.constant)});
    const double unit = binade(greatest);
    form.squares /= unit;
    form.linear /= unit;
    form.constant /= unit;
}

// A cone whose equation is y'.Qy' = 0 with y' = y + fromApex: as the rounded numbers have it, the tip where
// the box ends.
void measureFromApexToo(const dvec3& fromApex, const Form& form, shared::Quadric& out) {
    const bool tipIsUpper = std::abs(form.hi.z + fromApex.z) < std::abs(form.lo.z + fromApex.z);
    out.linear = glm::vec3(fromApex);
    const dvec3 a(out.linear);
    out.constant = static_cast<float>(glm::dot(a, dvec3(out.squares) * a));
    out.caps |= shared::kFromApex;
    (tipIsUpper ? out.hi : out.lo).z = -out.linear.z;
}

}  // namespace

Extent quadricExtent(const Object& object) {
    const Affine placed = object.transform.value_or(Affine{});
    const dmat3 rows = glm::transpose(placed.linear);
    Extent extent;
    for (int axis = 0; axis < 3; ++axis) {
        extent.lo[axis] = placed.offset[axis] - std::visit(Support{-rows[axis]}, object.shape);
        extent.hi[axis] = placed.offset[axis] + std::visit(Support{rows[axis]}, object.shape);
    }
    return extent;
}

shared::Quadric roundQuadric(const Object& object, const Frame& frame) {
    Form form = formOf(object);
    const dvec3 apex = form.center, eye = form.toLocal * (frame.eye - form.center);
    const auto anchor = anchorOf(form, eye);
    if (anchor) {
        form.moveTo(*anchor);
    } else if (std::holds_alternative<CylinderShape>(object.shape) && form.hi.z > 4) {
        // A pipe is measured from its place nearest the eye: its equation is the same all along the axis.
        form.moveTo({0, 0, std::clamp(eye.z, form.lo.z, form.hi.z)});
    }
    shared::Quadric out;
    out.point = glm::vec3(form.center - frame.origin);
    // The equation of what the rounded point is the origin of.
    form.moveTo(form.toLocal * (dvec3(out.point) + frame.origin - form.center));
    scaleEquation(form);
    const dmat3 rows = glm::transpose(form.toLocal);
    out.toLocal0 = glm::vec3(rows[0]);
    out.toLocal1 = glm::vec3(rows[1]);
    out.toLocal2 = glm::vec3(rows[2]);
    out.squares = glm::vec3(form.squares[0][0], form.squares[1][1], form.squares[2][2]);
    out.products = glm::vec3(form.squares[1][2], form.squares[0][2], form.squares[0][1]);
    out.linear = glm::vec3(form.linear);
    out.constant = static_cast<float>(form.constant);
    out.lo = glm::vec3(form.lo);
    out.hi = glm::vec3(form.hi);
    out.caps = form.caps;
    if (form.hasTip && anchor) measureFromApexToo(form.toLocal * (form.center - apex), form, out);
    return out;
}

// Rounding moves y by 2^-24 of |T| |x - point|, four times for good measure, and the surface by 2^-20 of the
// clipping box's size; both come back to the world through |T^-1|.
Box quadricBox(const Object& object, const Frame& frame, const shared::Quadric& rounded) {
    const Extent extent = quadricExtent(object);
    const dmat3 local = toLocal(rounded), back = glm::inverse(local);
    const dvec3 point = dvec3(rounded.point) + frame.origin;
    const dvec3 reach = glm::max(glm::abs(extent.lo - point), glm::abs(extent.hi - point));
    const dvec3 size = glm::min(dvec3(rounded.hi - rounded.lo), dvec3(2 * kRoom));
    const dvec3 margin = magnitudes(back) * (0x1p-22 * (magnitudes(local) * reach) + 0x1p-20 * size);
    Box box;
    for (int axis = 0; axis < 3; ++axis)
        setRounded(box, axis, extent.lo[axis] - frame.origin[axis] - margin[axis],
                   extent.hi[axis] - frame.origin[axis] + margin[axis]);
    return box;
}

namespace {

class QuadricPacker final : public RowPacker<shared::Quadric, &PackedScene::quadrics> {
  public:
    bool packs(const Shape& shape) const override {
        return std::holds_alternative<QuadricShape>(shape) || std::holds_alternative<EllipsoidShape>(shape) ||
               std::holds_alternative<CylinderShape>(shape) || std::holds_alternative<ConeShape>(shape) ||
               std::holds_alternative<HyperboloidShape>(shape) ||
               std::holds_alternative<ParaboloidShape>(shape);
    }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        const Extent own = quadricExtent(object);
        extent.include(own.lo);
        extent.include(own.hi);
    }
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        return quadricBox(object, frame, rounded(object, frame));
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Quadric& q = scene.quadrics[index];
        visitCorners(q, glm::inverse(toLocal(q)), visit);
    }
    // A point is inside if it is inside the surface and the box that clips it, as if the quadric were capped.
    double windings(const PackedScene& scene, uint32_t index, const glm::dvec3& point) const override {
        const shared::Quadric& q = scene.quadrics[index];
        const bool fromApex = (q.caps & shared::kFromApex) != 0;
        const glm::dvec3 local = toLocal(q) * (point - glm::dvec3(q.point)), s(q.squares), p(q.products);
        const glm::dvec3 y = fromApex ? local + glm::dvec3(q.linear) : local;
        const glm::dvec3 qy(s.x * y.x + p.z * y.y + p.y * y.z, p.z * y.x + s.y * y.y + p.x * y.z,
                            p.y * y.x + p.x * y.y + s.z * y.z);
        const double rest = 2 * glm::dot(glm::dvec3(q.linear), y) + static_cast<double>(q.constant);
        const double side = glm::dot(y, qy) + (fromApex ? 0 : rest);
        const bool inBox = glm::all(glm::greaterThanEqual(local, glm::dvec3(q.lo))) &&
                           glm::all(glm::lessThanEqual(local, glm::dvec3(q.hi)));
        return side < 0 && inBox ? 1 : 0;
    }

  private:
    shared::Quadric rounded(const Object& object, const Frame& frame) const override {
        return roundQuadric(object, frame);
    }
};

}  // namespace

const KindPacker& packerOfQuadric() {
    static const QuadricPacker packer;
    return packer;
}

}  // namespace glint
