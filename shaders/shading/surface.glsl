// From a hit to the surface there: position with a bound on its error, normals, material.
#ifndef GLINT_SURFACE_GLSL
#define GLINT_SURFACE_GLSL

#include "traversal/instance.glsl"
#include "primitives/all.glsl"

void surfaceInWorld(Instance instance, inout Surface surface) {
    leaveInstance(instance, surface.position, surface.error);
    surface.geometricNormal = normalInWorld(instance, surface.geometricNormal);
    vec3 shading = normalInWorld(instance, surface.shadingNormal);
    surface.shadingNormal = dot(shading, surface.geometricNormal) < 0.0 ? -shading : shading;
    surface.object = instance.object;
    if (instance.material != kNone) surface.material = instance.material;
}

// The surface of a primitive that is no triangle, loaded already.
#define GLINT_FILL_ALONE(Kind)                                                 \
    void fill##Kind(Ray ray, Hit hit, Kind primitive, inout Surface surface) { \
        surfaceOf##Kind(ray, hit, primitive, surface);                         \
        surface.object = primitive.object;                                     \
        surface.primitive = primitive.primitive;                               \
        surface.material = primitive.material;                                 \
    }
#define GLINT_FILL_TRIANGLES(Kind)
#define GLINT_FILL_PACKETS(Kind) GLINT_FILL_ALONE(Kind)
#define GLINT_FILL_LEAVES(Kind) GLINT_FILL_ALONE(Kind)
#define GLINT_FILL_UNBOUNDED(Kind) GLINT_FILL_ALONE(Kind)
#define GLINT_FILL_INSTANCES(Kind)
#define GLINT_FILL_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                           loops, uv)                                                                      \
    GLINT_FILL_##ROLE(Kind)
GLINT_PRIMITIVES(GLINT_FILL_OF_KIND, 0)

#define GLINT_SURFACE_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, \
                              crossings, loops, uv)                                                \
    GLINT_SURFACE_##ROLE(Kind, FEATURE)
#define GLINT_SURFACE_TRIANGLES(Kind, FEATURE) \
    if (FEATURE_##FEATURE && kind == kKind##Kind) surfaceOfTriangle(hit, instance, surface);
#define GLINT_SURFACE_ALONE(Kind, FEATURE)        \
    if (FEATURE_##FEATURE && kind == kKind##Kind) \
        fill##Kind(ray, hit, load##Kind(hit.primitive& kLeafFirstMask), surface);
#define GLINT_SURFACE_PACKETS(Kind, FEATURE) GLINT_SURFACE_ALONE(Kind, FEATURE)
#define GLINT_SURFACE_LEAVES(Kind, FEATURE) GLINT_SURFACE_ALONE(Kind, FEATURE)
#define GLINT_SURFACE_UNBOUNDED(Kind, FEATURE) \
    if (unbounded) GLINT_SURFACE_ALONE(Kind, FEATURE)
#define GLINT_SURFACE_INSTANCES(Kind, FEATURE)

Surface noSurface() {
    return Surface(vec3(0.0), vec3(0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 1.0, 0.0), 0u, 0u, 0u, vec2(0.0),
                   vec3(1.0));
}

// kind: of hit.primitive. The ray and the surface are in the coordinates of the primitive; `instance` is what
// the hit has of that, if anything. unbounded: a constant, whether it may be a plane.
Surface surfaceOfKind(uint kind, Ray ray, Hit hit, Instance instance, bool unbounded) {
    Surface surface = noSurface();
    GLINT_PRIMITIVES(GLINT_SURFACE_OF_KIND, 0)
    return surface;
}

#define GLINT_OWN_UV(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                     uv)                                                                                    \
    || (uv == 1 && kind == kKind##Kind)
bool hasOwnUv(uint kind) { return false GLINT_PRIMITIVES(GLINT_OWN_UV, 0); }

// Fills in texture coordinates from the object's frame. The surface must be in world coordinates.
void fillObjectUv(uint kind, inout Surface surface) {
    if ((FEATURE_TEXTURES || FEATURE_CHECKERS) && !hasOwnUv(kind))
        surface.uv = objectUv(surface.object, surface.position, surface.geometricNormal);
}

const bool kSettlesSlivers = FEATURE_SLIVERS && INTERSECTOR == kTriangleWatertight;

// hit.primitive must not be kNone. That of a sliver is settled.
Surface surfaceAt(Ray ray, inout Hit hit) {
    Instance instance;
    bool inInstance = FEATURE_INSTANCES && hit.instance != kNone;
    if (FEATURE_INSTANCES) instance = loadInstance(inInstance ? hit.instance : 0u);
    if (inInstance) enterInstance(instance, ray.origin, ray.direction);
    if (kSettlesSlivers && hit.primitive >> kPrimitiveKindShift == kKindTriangle)
        settleSliver(ray, inInstance && instance.mirrored != 0u, hit);
    Surface surface = surfaceOfKind(hit.primitive >> kPrimitiveKindShift, ray, hit, instance, true);
    if (inInstance) surfaceInWorld(instance, surface);
    fillObjectUv(hit.primitive >> kPrimitiveKindShift, surface);
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
