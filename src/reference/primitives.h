// Functions that each kind of primitive of shaders/shared/primitives.h overloads in its own file (the first
// kinds in primitives.cpp). The linker names a missing overload.
#pragma once

#include "pack/scene_arrays.h"
#include "reference/intersect.h"
#include "reference/textbook.h"

namespace glint::reference {

// One ray that may meet one primitive.
struct Meeting {
    const Model& scene;
    const Methods& methods;
    const PreparedRay& ray;
    uint32_t primitive;  // kind and index
    uint32_t source;     // what the ray starts on, of a solid with its part; kNone
    double tMax;

    bool fromItself() const { return primitive == source; }
};

// A hit in the coordinates of the primitive.
struct Place {
    const Model& scene;
    const Ray& ray;
    const Hit& hit;
    glm::dvec3 point;  // origin + t direction

    uint32_t index() const { return hit.primitive & shared::kLeafFirstMask; }
    uint32_t part() const { return hit.primitive >> shared::kPartShift & shared::kPartMask; }
};

// The nearest hit within (ray.tMin, tMax], never one with what the ray starts on again. part: of a solid with
// several surfaces, the one that is met.
#define GLINT_MEETS(number, Kind, kinds, one, many)                                              \
    bool meets(const rows::Kind& primitive, const Meeting& meeting, Root& root, uint32_t& part); \
    /* Position, moved onto the surface, normals, and uv where they are the primitive's own. */  \
    void surfaceOf(const rows::Kind& primitive, const Place& place, Surface& surface);           \
    /* The greatest magnitude among the coordinates that a hit point on it is computed from. */  \
    double reachOf(const Model& scene, const Methods& methods, const rows::Kind& primitive);
GLINT_PRIMITIVES(GLINT_MEETS, GLINT_NO_KIND)
#undef GLINT_MEETS

// True if the ray starts on the triangle with this id. A split triangle stands in the BVH more than once.
inline bool isOwnTriangle(const Meeting& m, uint32_t id) {
    return m.source != shared::kNone && kindOfPrimitive(m.source) == shared::PrimitiveKind::Triangle &&
           m.scene.triangles[m.source & shared::kPrimitiveIndexMask].id == id;
}

// Here, to be inlined: most of the time goes by in it.
inline bool meets(const rows::Triangle& triangle, const Meeting& m, Root& root, uint32_t&) {
    if (isOwnTriangle(m, triangle.id)) return false;
    if (m.methods.triangles != TriangleMethod::Watertight)
        return textbookTriangle(m.methods.triangles, triangle, m.ray, m.tMax, root);
    return intersectTriangle(triangle, m.ray, m.tMax, root);
}

// True of the kinds whose hits bring texture coordinates of their own.
constexpr bool hasOwnUv(shared::PrimitiveKind kind) {
    return kind == shared::PrimitiveKind::Triangle || kind == shared::PrimitiveKind::Cuboid;
}

// True if both are hits of the same part of two primitives of one kind with equal numbers, in one instance,
// so that equal arithmetic gives equal t. False for outlines, which have their own arrays.
bool isSameSurface(const Model& scene, const Hit& a, const Hit& b);

// Calls visit with primitive `index` of a kind that can be hit.
template <class Visit>
auto visitHit(const Model& scene, uint32_t primitive, const Visit& visit) {
    using Result = decltype(visit(scene.planes[0]));
    return visitPrimitive(scene, kindOfPrimitive(primitive), primitive & shared::kLeafFirstMask,
                          [&](const auto& one) -> Result {
                              if constexpr (requires { one.toWorldX; })
                                  throw std::logic_error("an instance by itself cannot be hit");
                              else
                                  return visit(one);
                          });
}

}  // namespace glint::reference
