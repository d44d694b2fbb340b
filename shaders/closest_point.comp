#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// The primitive closest to each point. Rows of a point: kRowOrigin holds it; kRowHit the least square of a
// distance so far, the id of its primitive, 0, and the primitive.
//
// A point first descends to a leaf by the nearer children, for a bound, and then traverses the tree as a ray
// does, past boxes farther than the bound. Traversal::hit.t is the square of the distance.
#include "path_rows.glsl"
#include "traversal/state.glsl"
#include "traversal/stackless.glsl"

bool isAnyHit(Traversal traversal) { return false; }
void testPlanes(inout Traversal traversal, uint planeCount) {}

// At most the square of the distance to the box: it and its product with a stretch round by 12 u.
float squareToBox(Traversal traversal, vec3 lo, vec3 hi) {
    vec3 point = traversal.ray.origin;
    precise vec3 away = max(max(lo - point, point - hi), vec3(0.0));
    precise float square = dot(away, away) * (1.0 - 16.0 * kUnit);
    return square;
}

// A distance in an instance is at most the Frobenius norm of its matrix times the distance in the world.
bool entersBox(Traversal traversal, vec3 lo, vec3 hi) {
    float stretch = 1.0;  // squared
    if (FEATURE_INSTANCES && traversal.instance != kNone) {
        Instance instance = loadInstance(traversal.instance);
        vec3 x = instance.toObjectX, y = instance.toObjectY, z = instance.toObjectZ;
        stretch = dot(x, x) + dot(y, y) + dot(z, z);
    }
    float square = squareToBox(traversal, lo, hi);
    return square < kInfinity && square <= traversal.hit.t * stretch;
}

// The leaf that the nearer children lead to, through an instance if need be.
uint nearestLeaf(inout Traversal traversal) {
    uint child = 0u;
    while (isNode(child) || isInstance(child)) {
        if (isInstance(child)) child = enterSpace(traversal, child & kLeafFirstMask, true);
        Node node = loadNode(child);
        bool second = node.child1 != kNone &&
                      squareToBox(traversal, node.lo1, node.hi1) < squareToBox(traversal, node.lo0, node.hi0);
        child = second ? node.child1 : node.child0;
    }
    return child;
}

// Square of the distance from 0 to the edge from a to b.
float squareToEdge(vec3 a, vec3 b) {
    precise vec3 edge = b - a;
    precise float size = dot(edge, edge);
    float part = size > 0.0 ? clamp(quotient(-dot(a, edge), size), 0.0, 1.0) : 0.0;
    precise vec3 closest = a + part * edge;
    precise float square = dot(closest, closest);
    return square;
}

vec3 toWorld(Instance instance, vec3 v) {
    return timesRows(instance.toWorldX, instance.toWorldY, instance.toWorldZ, v);
}

// The plane counts if the point lies within the three planes through the edges, else the nearest edge.
float squareToTriangle(Traversal traversal, Triangle triangle, vec3 normal) {
    vec3 shift = FEATURE_INSTANCES ? -traversal.world.origin : -traversal.ray.origin;
    if (FEATURE_INSTANCES && traversal.instance != kNone) {
        Instance instance = loadInstance(traversal.instance);
        triangle.v0 = toWorld(instance, triangle.v0);
        triangle.v1 = toWorld(instance, triangle.v1);
        triangle.v2 = toWorld(instance, triangle.v2);
        // The sense of the corners, which a mirrored instance changes, not of the normal.
        normal = (traversal.mirrored ? -1.0 : 1.0) * normalInWorld(instance, normal);
        shift += instance.place;
    }
    precise vec3 a = triangle.v0 + shift, b = triangle.v1 + shift, c = triangle.v2 + shift;
    precise float ab = dot(cross(normal, b - a), a);
    precise float bc = dot(cross(normal, c - b), b);
    precise float ca = dot(cross(normal, a - c), c);
    precise float height = dot(normal, a);
    bool isInside = ab <= 0.0 && bc <= 0.0 && ca <= 0.0;
    return isInside ? height * height : min(squareToEdge(a, b), min(squareToEdge(b, c), squareToEdge(c, a)));
}

// sqrt(r^2 + f) - r without cancellation, f = |p - center|^2 - r^2.
float squareToSphere(vec3 point, Sphere sphere) {
    float r = sphere.radius;
    precise vec3 away = point - sphere.point;
    bool isAnchored = sphere.anchorNormal != vec3(0.0);
    precise float f = dot(away, away) + (isAnchored ? 2.0 * r * dot(sphere.anchorNormal, away) : -r * r);
    precise float gap = quotient(f, squareRoot(max(r * r + f, 0.0)) + r);
    return gap * gap;
}

// Keeps the primitive if it is closer, or as close with a lower id.
void test(inout Traversal traversal, uint kind, uint index) {
    Hit hit = Hit(kInfinity, 0.0, 0.0, kind << kPrimitiveKindShift | index, traversal.instance, 0u);
    if (FEATURE_TRIANGLES && kind == kKindTriangle) {
        Triangle triangle = loadTriangle(index);
        hit.t = squareToTriangle(traversal, triangle, loadTriangleSurface(index).normal);
        hit.id = triangle.id + traversal.idBase;
    }
    if (FEATURE_SPHERES && kind == kKindSphere) {
        hit.t = squareToSphere(traversal.ray.origin, loadSphere(index));
        hit.id = loadSphere(index).id;
    }
    Hit best = traversal.hit;
    if (hit.t < best.t || (hit.t == best.t && hit.id < best.id) || best.primitive == kNone)
        traversal.hit = hit;
}

void testLeaf(inout Traversal traversal, uint leaf) {
    uint index = leaf & kLeafFirstMask;
    uint end = index + sizeOfLeaf(leaf);
    do {
        test(traversal, kindOfLeaf(leaf), index);
        ++index;
        ++traversal.trips;
    } while (index < end);
}

void main() {
    uint path = pathIndex();
    uint slot = loadWalkRow(path).x;
    uvec4 hitRow = loadRow(kRowHit, path);
    uvec4 instanceRow = loadInstanceRow(path);
    Environment environment = loadEnvironment(0u);
    Traversal traversal;
    traversal.ray = loadRay(path);
    traversal.hit = Hit(uintBitsToFloat(hitRow.x), 0.0, 0.0, hitRow.w, instanceRow.x, hitRow.y);
    traversal.trips = MODE_RESUME ? 0u : kMaxBvhDepth;  // of the way to the first leaf
    traversal.cost = 0u;
    if (!isAlive(traversal.ray) || environment.root == kNone || (MODE_RESUME && slot == kNone)) return;
    if (!MODE_RESUME) {
        slot = kSlotFresh;
        prepare(traversal, environment);
        testLeaf(traversal, nearestLeaf(traversal));
        enterSpace(traversal, kNone, traversal.instance != kNone);
    }
    slot = resume(traversal, environment, slot, instanceRow.zw);
    storeRow(kRowHit, path,
             uvec4(floatBitsToUint(traversal.hit.t), traversal.hit.id, 0u, traversal.hit.primitive));
    storeInstanceRow(path,
                     uvec4(traversal.hit.instance, instanceRow.y, traversal.instance, traversal.worldSlot));
    if (MODE_RESUME || slot != kNone) storeRow(kRowWalk, path, uvec4(slot, 0u, 0u, 0u));
    if (slot != kNone) atomicAdd(counters[kCounterUnfinished], 1u);
}
