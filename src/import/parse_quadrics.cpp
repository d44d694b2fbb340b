#include "import/parse_quadrics.h"

namespace glint {

namespace {

bool isCapped(const JsonCursor& object) {
    const auto capped = object.find("capped");
    return capped && capped->boolean();
}

QuadricShape parseGeneral(const JsonCursor& object) {
    QuadricShape shape;
    const JsonCursor coefficients = object.require("coefficients");
    if (!coefficients.value().array() || coefficients.size() != 10)
        coefficients.failWanted("must be ten numbers [A, B, C, D, E, F, G, H, I, J]");
    for (size_t i = 0; i < 10; i++) shape.coefficients[i] = coefficients.item(i).number();
    const JsonCursor bounds = object.require("bounds");
    if (!bounds.value().array() || bounds.size() != 2)
        bounds.failWanted("must be two points [[x, y, z], [x, y, z]]");
    shape.lo = bounds.item(0).vector3();
    shape.hi = bounds.item(1).vector3();
    return shape;
}

ConeShape parseCone(const JsonCursor& object) {
    ConeShape cone{object.require("base").vector3(), object.require("apex").vector3(),
                   object.require("radius").number()};
    if (const auto top = object.find("topRadius")) cone.topRadius = top->number();
    cone.capped = isCapped(object);
    return cone;
}

}  // namespace

const KeyTable* quadricKeys(std::string_view type) {
    if (type == "quadric") return &keys::kQuadric;
    if (type == "ellipsoid") return &keys::kEllipsoid;
    if (type == "cylinder") return &keys::kCylinder;
    if (type == "cone") return &keys::kCone;
    if (type == "hyperboloid") return &keys::kHyperboloid;
    if (type == "paraboloid") return &keys::kParaboloid;
    return nullptr;
}

std::optional<Shape> parseQuadric(const JsonCursor& object, std::string_view type) {
    if (type == "quadric") return parseGeneral(object);
    if (type == "ellipsoid")
        return EllipsoidShape{object.require("center").vector3(), object.require("radii").vector3()};
    if (type == "cylinder")
        return CylinderShape{object.require("base").vector3(), object.require("top").vector3(),
                             object.require("radius").number(), isCapped(object)};
    if (type == "cone") return parseCone(object);
    if (type == "hyperboloid")
        return HyperboloidShape{object.require("base").vector3(), object.require("top").vector3(),
                                object.require("radius").number(), object.require("waist").number(),
                                isCapped(object)};
    if (type == "paraboloid")
        return ParaboloidShape{object.require("vertex").vector3(), object.require("top").vector3(),
                               object.require("radius").number(), isCapped(object)};
    return std::nullopt;
}

}  // namespace glint
