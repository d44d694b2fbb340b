#include "scene/checks.h"

namespace glint {

namespace {

void checkLength(const Place& place, std::string_view key, double length) {
    if (!(length > 0)) place.fail(key, "must be > 0" + got(length));
    if (length < kMinRadius || length > kMaxRadius)
        place.fail(key, "must be from " + describe(kMinRadius) + " to " + describe(kMaxRadius) + got(length));
}

// The ends of a body of revolution, and its greatest radius.
void checkAxis(const Place& place, std::string_view fromKey, const glm::dvec3& from, std::string_view toKey,
               const glm::dvec3& to, double radius) {
    checkPoint(place, fromKey, from);
    checkPoint(place, toKey, to);
    const double height = glm::length(to - from);
    if (!(height >= kMinRadius)) place.fail(toKey, "must differ from " + std::string(fromKey) + got(to));
    if (!(height <= kMaxAspect * radius && radius <= kMaxAspect * height))
        place.fail({}, "height and radius must not differ by more than a factor of " + describe(kMaxAspect) +
                           " (got " + describe(height) + " and " + describe(radius) + ")");
}

}  // namespace

void checkQuadric(const QuadricShape& shape, const Place& place) {
    checkPoint(place, "bounds/0", shape.lo);
    checkPoint(place, "bounds/1", shape.hi);
    for (int axis = 0; axis < 3; axis++)
        if (!(shape.lo[axis] < shape.hi[axis]))
            place.fail("bounds",
                       std::string("the first corner must be less than the second in x, y and z (got ") +
                           text(shape.lo) + " and " + text(shape.hi) + ")");
    if (greatestMagnitude(shape.hi - shape.lo) < kMinRadius)
        place.fail("bounds", "must be " + describe(kMinRadius) + " wide or more" + got(shape.hi - shape.lo));
    bool any = false;
    for (int i = 0; i < 10; i++) {
        const double c = shape.coefficients[i];
        if (!(std::abs(c) <= kMaxCoefficient))
            place.fail("coefficients/" + std::to_string(i), "must be from -" + describe(kMaxCoefficient) +
                                                                " to " + describe(kMaxCoefficient) + got(c));
        any = any || (i < 9 && c != 0);
    }
    if (!any)
        place.fail("coefficients",
                   "one of A to I must not be 0: J = 0 alone is no surface, but nothing or everything");
}

void checkQuadric(const EllipsoidShape& shape, const Place& place) {
    checkPoint(place, "center", shape.center);
    for (int axis = 0; axis < 3; axis++)
        checkLength(place, "radii/" + std::to_string(axis), shape.radii[axis]);
}

void checkQuadric(const CylinderShape& shape, const Place& place) {
    checkLength(place, "radius", shape.radius);
    checkAxis(place, "base", shape.base, "top", shape.top, shape.radius);
}

void checkQuadric(const ConeShape& shape, const Place& place) {
    if (shape.radius != 0 || !(shape.topRadius > 0)) checkLength(place, "radius", shape.radius);
    if (shape.topRadius != 0) checkLength(place, "topRadius", shape.topRadius);
    if (shape.radius == shape.topRadius)
        place.fail("topRadius", "must not be the radius, or the cone is a cylinder" + got(shape.topRadius));
    checkAxis(place, "base", shape.base, "apex", shape.apex, std::max(shape.radius, shape.topRadius));
}

void checkQuadric(const HyperboloidShape& shape, const Place& place) {
    checkLength(place, "radius", shape.radius);
    checkLength(place, "waist", shape.waist);
    if (!(shape.waist < shape.radius))
        place.fail("waist", "must be less than the radius, " + describe(shape.radius) + got(shape.waist));
    checkAxis(place, "base", shape.base, "top", shape.top, shape.radius);
}

void checkQuadric(const ParaboloidShape& shape, const Place& place) {
    checkLength(place, "radius", shape.radius);
    checkAxis(place, "vertex", shape.vertex, "top", shape.top, shape.radius);
}

}  // namespace glint
