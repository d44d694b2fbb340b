// The hit of a ray with a primitive, and the surface there. Each kind has a file with
//   bool hitKind(Ray, RayFrame, Kind, uint primitive, inout uint trips, out Hit)
//     the first hit in the ray's interval; trips: loop trips that it takes
//   void surfaceOfKind(Ray, Hit, Kind, Instance, inout Surface)
//     position, error, normals and owner there, and uv of kOwnUvKinds; the instance holds the primitive, if
//     Hit::instance is not kNone
#ifndef GLINT_SURFACE_GLSL
#define GLINT_SURFACE_GLSL

#include "primitives/cuboid.glsl"
#include "primitives/flat.glsl"
#include "primitives/quadric.glsl"
#include "primitives/sphere.glsl"
#include "primitives/triangle.glsl"
#include "shading/texture.glsl"

// The first hit of a primitive of any kind in the ray's interval.
bool hitPrimitive(Ray ray, RayFrame frame, uint kind, uint index, inout uint trips, out Hit hit) {
    uint primitive = (kind << kPrimitiveKindShift) | index;
    bool isHit = false;
    hit = Hit(0.0, 0.0, 0.0, kNone, kNone, 0u);
#define GLINT_HIT(number, Kind, KINDS, kinds, one, many) \
    if (FEATURE_##KINDS && kind == kKind##Kind)          \
        isHit = hit##Kind(ray, frame, load##Kind(index), primitive, trips, hit);
    GLINT_PRIMITIVES(GLINT_HIT, GLINT_NO_KIND)
    return isHit;
}

// True if a ray may hit a primitive of this kind more than once.
bool hasFurtherHits(uint kind) { return (kFurtherHitKinds >> kind & 1u) != 0u; }

// The ray and the surface are in the coordinates of the primitive.
Surface surfaceOfPrimitive(Ray ray, Hit hit, Instance instance) {
    Surface surface = Surface(vec3(0.0), vec3(0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 1.0, 0.0), 0u, 0u, 0u,
                              vec2(0.0), vec3(1.0));
    uint kind = kindOf(hit);
    uint index = hit.primitive & kLeafFirstMask;
#define GLINT_SURFACE(number, Kind, KINDS, kinds, one, many) \
    if (FEATURE_##KINDS && kind == kKind##Kind)              \
        surfaceOf##Kind(ray, hit, load##Kind(index), instance, surface);
    GLINT_PRIMITIVES(GLINT_SURFACE, GLINT_NO_KIND)
    return surface;
}

// The surface at a hit, in the world; without meaning if hit.primitive is kNone. settles: a sliver's hit is
// moved to where the ray passes.
Surface surfaceAt(Ray ray, inout Hit hit, bool settles) {
    Instance instance;
    bool inInstance = FEATURE_INSTANCES && hit.instance != kNone;
    if (FEATURE_INSTANCES) instance = loadInstance(inInstance ? hit.instance : 0u);
    if (inInstance) enterInstance(instance, ray.origin, ray.direction);
    if (FEATURE_SLIVERS && INTERSECTOR == kTriangleWatertight && settles && kindOf(hit) == kKindTriangle)
        settleSliver(ray, inInstance && instance.mirrored != 0u, hit);
    Surface surface = surfaceOfPrimitive(ray, hit, instance);
    if (inInstance) {
        leaveInstance(instance, surface.position, surface.error);
        surface.geometricNormal = normalInWorld(instance, surface.geometricNormal);
        vec3 shading = normalInWorld(instance, surface.shadingNormal);
        surface.shadingNormal = dot(shading, surface.geometricNormal) < 0.0 ? -shading : shading;
        surface.object = instance.object;
        if (instance.material != kNone) surface.material = instance.material;
    }
    if ((FEATURE_TEXTURES || FEATURE_CHECKERS) && (kOwnUvKinds >> kindOf(hit) & 1u) == 0u)
        surface.uv = objectUv(surface.object, surface.position, surface.geometricNormal);
    return surface;
}

// Turns both normals against the ray. Two-sided surfaces: the geometric normal decides.
void faceForward(inout Surface surface, vec3 direction) {
    if (dot(surface.geometricNormal, direction) > 0.0) {
        surface.geometricNormal = -surface.geometricNormal;
        surface.shadingNormal = -surface.shadingNormal;
    }
}

#endif
