// From a hit to the surface there: position with a bound on its error, normals, material.
#ifndef GLINT_SURFACE_GLSL
#define GLINT_SURFACE_GLSL

#include "instance.glsl"
#include "intersect.glsl"
#include "quadric.glsl"
#include "texcoord.glsl"
#include "textbook.glsl"

struct Surface {
    vec3 position;
    vec3 error;          // the true point is within position +- error on each axis
    vec3 normal;         // geometric, outward, unit
    vec3 shadingNormal;  // outward, in the hemisphere of `normal`, unit
    uint object;
    uint primitive;
    uint material;
    // Texture coordinates; of triangles without their own, the barycentrics. Every kind of primitive sets
    // them here.
    vec2 uv;
    vec3 color;  // of the vertices, interpolated; white without
};

void triangleAttributes(uint attributes, vec3 weights, inout Surface surface) {
    uint first = attributes & kAttributeFirstMask;
    bool hasUvs = (attributes & kAttributeUvs) != 0u;
    if (FEATURE_UVS) {
        vec2 uv = vec2(weigh(weights, loadVertexAttribute(first).value),
                       weigh(weights, loadVertexAttribute(first + 1u).value));
        if (hasUvs) surface.uv = uv;
    }
    if (FEATURE_VERTEX_COLORS) {
        bool colored = (attributes & kAttributeColors) != 0u;
        uint row = first + (hasUvs ? 2u : 0u);
        precise vec3 color = weights.x * loadVertexAttribute(row).value +
                             weights.y * loadVertexAttribute(row + 1u).value +
                             weights.z * loadVertexAttribute(row + 2u).value;
        if (colored) surface.color = color;
    }
}

// Barycentric interpolation: off by gamma_7 of the sum of magnitudes (Pharr et al., PBRT 4th ed.,
// sec. 6.8.5), far below the error of o + t d. `instance`: of the hit, if it has one.
void triangleSurface(Hit hit, Instance instance, inout Surface surface) {
    uint index = hit.primitive & kPrimitiveIndexMask;
    Triangle triangle = loadTriangle(index);
    TriangleSurface details = loadTriangleSurface(index);
    if (FEATURE_INSTANCES && hit.instance != kNone && instance.mirrored != 0u) {
        float u = hit.u;
        hit.u = hit.v;
        hit.v = u;
    }
    precise float w = 1.0 - hit.u - hit.v;
    precise vec3 p0 = w * triangle.v0;
    precise vec3 p1 = hit.u * triangle.v1;
    precise vec3 p2 = hit.v * triangle.v2;
    precise vec3 position = p0 + p1 + p2;
    surface.position = position;
    surface.error = gammaBound(7.0) * (abs(p0) + abs(p1) + abs(p2));
    surface.normal = details.normal;
    surface.shadingNormal = details.normal;
    if (FEATURE_VERTEX_NORMALS) {
        bool smoothed = details.vertexNormals != kNone;
        VertexNormals corners = loadVertexNormals(smoothed ? details.vertexNormals : 0u);
        vec3 weights = vec3(w, hit.u, hit.v);
        if (FEATURE_INSTANCES && hit.instance != kNone) {
            // Unit vectors in the world are what is interpolated there.
            weights /= vec3(stretchOfNormal(instance, corners.n0), stretchOfNormal(instance, corners.n1),
                            stretchOfNormal(instance, corners.n2));
        }
        vec3 sum = weights.x * corners.n0 + weights.y * corners.n1 + weights.z * corners.n2;
        float size = dot(sum, sum);
        vec3 direction = sum * inversesqrt(max(size, 1e-30));
        if (smoothed && size > 1e-30)
            surface.shadingNormal = dot(direction, details.normal) < 0.0 ? -direction : direction;
    }
    surface.object = details.object;
    surface.primitive = details.primitive;
    surface.material = details.material;
    surface.uv = vec2(hit.u, hit.v);
    if (FEATURE_UVS || FEATURE_VERTEX_COLORS)
        triangleAttributes(details.attributes, vec3(w, hit.u, hit.v), surface);
}

// A textbook's discriminant is 0 for many rays that pass just outside: t is then that of the closest
// approach, and the rounding of t alone says whether the normal looks at the ray. Seen from outside it does.
// t errs by gamma_8 |w| / |d| in either form, and so n.d by gamma_8 |w| / r.
vec3 towardsRayAtLimb(Ray ray, Sphere sphere, vec3 outward) {
    vec3 w = ray.origin - sphereCenter(sphere);
    float away = dot(outward, ray.direction);
    float square = dot(w, w);
    float size = dot(ray.direction, ray.direction);
    bool isLimb = away > 0.0 && away * away <= gammaBound(8.0) * gammaBound(8.0) * size * square /
                                                   (sphere.radius * sphere.radius);
    return isLimb && square > sphere.radius * sphere.radius ? outward - 2.0 * away / size * ray.direction
                                                            : outward;
}

// The point o + t d is moved back to the sphere: gamma_5 of its offset from the centre (PBRT sec. 6.8.5),
// plus the rounding of adding the centre.
void sphereSurface(Ray ray, Hit hit, inout Surface surface) {
    Sphere sphere = loadSphere(hit.primitive & kPrimitiveIndexMask);
    precise vec3 offset = (ray.origin - sphere.point) + hit.t * ray.direction;
    precise vec3 outward = offset / length(offset);
    precise vec3 scaled = outward * sphere.radius;
    if (FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0)) {
        // One Newton step along the normal on |x|^2 + 2 r n.x = 0, x measured from the anchor.
        precise vec3 away = offset / sphere.radius + sphere.anchorNormal;
        precise vec3 unit = away / length(away);
        precise float height = dot(offset, offset) / (2.0 * sphere.radius) + dot(offset, sphere.anchorNormal);
        precise vec3 corrected = offset - height * unit;
        outward = unit;
        scaled = corrected;
    }
    precise vec3 position = sphere.point + scaled;
    surface.position = position;
    surface.error = gammaBound(7.0) * (abs(scaled) + abs(sphere.point));
    if (SPHERE_FORM != kSphereRobust) outward = towardsRayAtLimb(ray, sphere, outward);
    surface.normal = outward;
    surface.shadingNormal = outward;
    surface.object = sphere.object;
    surface.primitive = sphere.primitive;
    surface.material = sphere.material;
}

void planeSurface(Ray ray, Hit hit, inout Surface surface) {
    Plane plane = loadPlane(hit.primitive & kPrimitiveIndexMask);
    precise vec3 position = ray.origin + hit.t * ray.direction;
    precise vec3 projected = position - dot(plane.normal, position - plane.point) * plane.normal;
    surface.position = projected;
    surface.error = gammaBound(7.0) * (abs(projected) + abs(plane.point));
    surface.normal = plane.normal;
    surface.shadingNormal = plane.normal;
    surface.object = plane.object;
    surface.primitive = plane.primitive;
    surface.material = plane.material;
}

// Of a flat primitive with this point and unit normal. The point is moved back to the plane as an offset from
// `anchor`: the product with the normal errs by gamma_4 of the offset, the subtraction and the anchor's
// addition by a unit each.
void flatSurface(Ray ray, Hit hit, vec3 anchor, vec3 normal, inout Surface surface) {
    precise vec3 offset = (ray.origin - anchor) + hit.t * ray.direction;
    precise vec3 projected = offset - dot(normal, offset) * normal;
    precise vec3 position = anchor + projected;
    surface.position = position;
    surface.error = gammaBound(7.0) * (abs(projected) + abs(anchor));
    surface.normal = normal;
    surface.shadingNormal = normal;
}

void discSurface(Ray ray, Hit hit, inout Surface surface) {
    Disc disc = loadDisc(hit.primitive & kPrimitiveIndexMask);
    flatSurface(ray, hit, disc.center, disc.normal, surface);
    surface.object = disc.object;
    surface.primitive = disc.primitive;
    surface.material = disc.material;
}

void polygonSurface(Ray ray, Hit hit, inout Surface surface) {
    Polygon polygon = loadPolygon(hit.primitive & kPrimitiveIndexMask);
    flatSurface(ray, hit, polygon.point, polygon.normal, surface);
    surface.object = polygon.object;
    surface.primitive = polygon.primitive;
    surface.material = polygon.material;
}

void quadricSurface(Ray ray, Hit hit, inout Surface surface) {
    Quadric quadric = loadQuadric(hit.primitive & kLeafFirstMask);
    QuadricPoint found = quadricPoint(ray, hit, quadric);
    surface.position = found.position;
    surface.error = found.error;
    surface.normal = found.normal;
    surface.shadingNormal = found.normal;
    surface.object = quadric.object;
    surface.primitive = quadric.primitive;
    surface.material = quadric.material;
}

void surfaceInWorld(Instance instance, inout Surface surface) {
    leaveInstance(instance, surface.position, surface.error);
    surface.normal = normalInWorld(instance, surface.normal);
    vec3 shading = normalInWorld(instance, surface.shadingNormal);
    surface.shadingNormal = dot(shading, surface.normal) < 0.0 ? -shading : shading;
    surface.object = instance.object;
    if (instance.material != kNone) surface.material = instance.material;
}

// kind: of hit.primitive. The ray and the surface are in the coordinates of the primitive; `instance` is what
// the hit has of that, if anything.
Surface surfaceOfKind(uint kind, Ray ray, Hit hit, Instance instance) {
    Surface surface;
    surface.position = vec3(0.0);
    surface.error = vec3(0.0);
    surface.normal = vec3(0.0, 1.0, 0.0);
    surface.shadingNormal = surface.normal;
    surface.object = 0u;
    surface.primitive = 0u;
    surface.material = 0u;
    surface.uv = vec2(0.0);
    surface.color = vec3(1.0);
    if (FEATURE_TRIANGLES && kind == kKindTriangle) triangleSurface(hit, instance, surface);
    if (FEATURE_SPHERES && kind == kKindSphere) sphereSurface(ray, hit, surface);
    if (FEATURE_PLANES && kind == kKindPlane) planeSurface(ray, hit, surface);
    if (FEATURE_DISCS && kind == kKindDisc) discSurface(ray, hit, surface);
    if (FEATURE_POLYGONS && kind == kKindPolygon) polygonSurface(ray, hit, surface);
    if (FEATURE_QUADRICS && kind == kKindQuadric) quadricSurface(ray, hit, surface);
    return surface;
}

// Where the surface is in the world.
void fillObjectUv(uint kind, inout Surface surface) {
    if ((FEATURE_TEXTURES || FEATURE_CHECKERS) && kind != kKindTriangle)
        surface.uv = objectUv(surface.object, surface.position, surface.normal);
}

// hit.primitive must not be kNone.
Surface surfaceAt(Ray ray, Hit hit) {
    Instance instance;
    bool inInstance = FEATURE_INSTANCES && hit.instance != kNone;
    if (FEATURE_INSTANCES) instance = loadInstance(inInstance ? hit.instance : 0u);
    if (inInstance) enterInstance(instance, ray.origin, ray.direction);
    Surface surface = surfaceOfKind(hit.primitive >> kPrimitiveKindShift, ray, hit, instance);
    if (inInstance) surfaceInWorld(instance, surface);
    fillObjectUv(hit.primitive >> kPrimitiveKindShift, surface);
    return surface;
}

// Turns both normals against the ray. Two-sided surfaces: the geometric normal decides.
void faceForward(inout Surface surface, vec3 direction) {
    if (dot(surface.normal, direction) > 0.0) {
        surface.normal = -surface.normal;
        surface.shadingNormal = -surface.shadingNormal;
    }
}

#endif
