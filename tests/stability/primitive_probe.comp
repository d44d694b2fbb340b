#version 450
#extension GL_GOOGLE_include_directive : require
// Path i against primitive i of one kind, without a tree: hitX of primitives/ alone, and
// intersectBox. The kind comes as dispatch.lightIndex: kKind..., kProbeBox, for the first boxes of the
// nodes, or of triangles kProbeAhead, for rays that leave a surface, kProbeSettled, for hits as settleSliver
// leaves them, with kProbeExchanged as of a mirrored instance, or of quadrics kProbeNormal, for the normal of
// a hit. In: the path's rows kRowOrigin (and source), kRowDirection (and tMin), kRowHit (tMax). Out: kRowHit
// = t, u, v, 1 for a hit; or the normal.
#include "primitives/robust.glsl"
#include "shading/surface.glsl"

const uint kProbeBox = 100u;
const uint kProbeAhead = 101u;
const uint kProbeSettled = 102u;
const uint kProbeExchanged = 103u;
const uint kProbeNormal = 105u;

void main() {
    uint path = gl_GlobalInvocationID.x;
    if (path >= dispatch.capacity) return;
    uvec4 origin = loadRow(kRowOrigin, path);
    uvec4 direction = loadRow(kRowDirection, path);
    Ray ray = Ray(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), uintBitsToFloat(direction.w),
                  uintBitsToFloat(loadRow(kRowHit, path).x), origin.w, kNone);
    RayFrame frame = makeFrame(ray.origin, ray.direction, 0.0);
    uint kind = dispatch.lightIndex;
    if (kind == kProbeAhead) ray.source = kElsewhere;
    float t = 0.0;
    float u = 0.0;
    float v = 0.0;
    bool hit = false;
    bool settles = kind == kProbeSettled || kind == kProbeExchanged;
    if (kind == kKindTriangle || kind == kProbeAhead || settles)
        hit = intersectTriangle(ray, frame, loadTriangle(path), loadTriangleSurface(path).normal, t, u, v);
    if (settles && hit) {
        bool exchanged = kind == kProbeExchanged;
        Hit settled = Hit(t, exchanged ? v : u, exchanged ? u : v, path, kNone, 0u);
        settleSliver(ray, exchanged, settled);
        t = settled.t;
        u = exchanged ? settled.v : settled.u;
        v = exchanged ? settled.u : settled.v;
    }
    bool isQuadric = kind == kKindQuadric || kind == kProbeNormal;
    uint primitive = isQuadric ? kKindQuadric << kPrimitiveKindShift | path : path;
    uint trips = 0u;
    Hit found = Hit(t, u, v, primitive, kNone, 0u);
    if (kind == kKindSphere) hit = hitSphere(ray, frame, loadSphere(path), primitive, trips, found);
    if (kind == kKindPlane) hit = hitPlane(ray, frame, loadPlane(path), primitive, trips, found);
    if (kind == kKindDisc) hit = hitDisc(ray, frame, loadDisc(path), primitive, trips, found);
    if (kind == kKindPolygon) hit = hitPolygon(ray, frame, loadPolygon(path), primitive, trips, found);
    if (isQuadric) hit = hitQuadric(ray, frame, loadQuadric(path), primitive, trips, found);
    t = found.t;
    if (kind == kProbeNormal) {
        Instance none;
        Surface surface = surfaceOfPrimitive(ray, found, none);
        t = surface.geometricNormal.x;
        u = surface.geometricNormal.y;
        v = surface.geometricNormal.z;
    }
    if (kind == kProbeBox) {
        Node node = loadNode(path);
        precise float tEnd = ray.tMax * kFarPad;
        hit = intersectBox(ray, frame, node.lo0, node.hi0, tEnd, t);
    }
    storeRow(kRowHit, path, uvec4(floatBitsToUint(t), floatBitsToUint(u), floatBitsToUint(v), hit ? 1u : 0u));
}
