#version 450
#extension GL_GOOGLE_include_directive : require
// The primitive closest to each point. Rows of a point: kRowOrigin holds it; kRowHit the least square of a
// distance so far, the id of its primitive, 0, and the primitive.
//
// A point first descends to a leaf by the nearer children, for a bound, and then traverses the tree without a
// stack (traversal/stackless.glsl), past boxes farther than the bound. Each trip of the one loop tests a box
// or a primitive. A point that runs out of trips is resumed from its slot.
#include "path_rows.glsl"

// The tree at hand: the world's, or that of an instance.
struct Space {
    uint instance;    // kNone in the world
    vec3 point;       // the point in its coordinates
    float shrinkage;  // a distance in the world is at least the square root of this times the one here
};

Space enterSpace(uint instance, vec3 point) {
    Space space = Space(instance, point, 1.0);
    if (FEATURE_INSTANCES && instance != kNone) {
        Instance entered = loadInstance(instance);
        vec3 x = entered.toObjectX, y = entered.toObjectY, z = entered.toObjectZ;
        vec3 direction = vec3(0.0);
        enterInstance(entered, space.point, direction);
        space.shrinkage = quotient(1.0, dot(x, x) + dot(y, y) + dot(z, z));  // Frobenius' norm
    }
    return space;
}

bool isNode(uint child) { return (child & kLeafFlag) == 0u; }
uint kindOf(uint leaf) { return (leaf >> kLeafKindShift) & kLeafKindMask; }

// At most the square of the distance to the box in the world: the terms round by 6 u.
float squareToBox(Space space, vec3 lo, vec3 hi) {
    precise vec3 away = max(max(lo - space.point, space.point - hi), vec3(0.0));
    precise float square = dot(away, away) * space.shrinkage * (1.0 - 16.0 * kUnit);
    return square;
}

// The leaf that the nearer children lead to, through an instance if need be.
uint nearestLeaf(inout Space space, vec3 point) {
    uint child = 0u;
    while (isNode(child) || (FEATURE_INSTANCES && kindOf(child) == kKindInstance)) {
        if (!isNode(child)) {
            space = enterSpace(child & kLeafFirstMask, point);
            child = loadInstance(child & kLeafFirstMask).root;
        }
        Node node = loadNode(child);
        bool second = node.child1 != kNone &&
                      squareToBox(space, node.lo1, node.hi1) < squareToBox(space, node.lo0, node.hi0);
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

// a, b, c: the corners as seen from the point; normal: unit, along (b - a) x (c - a). The plane counts if the
// point lies within the three planes through the edges, else the nearest edge.
float squareToTriangle(vec3 a, vec3 b, vec3 c, vec3 normal) {
    precise float ab = dot(cross(normal, b - a), a);
    precise float bc = dot(cross(normal, c - b), b);
    precise float ca = dot(cross(normal, a - c), c);
    precise float height = dot(normal, a);
    bool isInside = ab <= 0.0 && bc <= 0.0 && ca <= 0.0;
    precise float square = height * height;
    return isInside ? square : min(squareToEdge(a, b), min(squareToEdge(b, c), squareToEdge(c, a)));
}

vec3 toWorld(Instance instance, vec3 v) {
    return timesRows(instance.toWorldX, instance.toWorldY, instance.toWorldZ, v);
}

float squareToTriangle(Space space, vec3 point, uint index, out uint id) {
    Triangle triangle = loadTriangle(index);
    vec3 normal = loadTriangleSurface(index).normal;
    id = triangle.id;
    if (!FEATURE_INSTANCES || space.instance == kNone)
        return squareToTriangle(triangle.v0 - point, triangle.v1 - point, triangle.v2 - point, normal);
    Instance instance = loadInstance(space.instance);
    vec3 shift = instance.place - point;
    float sense = instance.mirrored != 0u ? -1.0 : 1.0;  // of the corners, not of the normal
    id += instance.idBase;
    return squareToTriangle(toWorld(instance, triangle.v0) + shift, toWorld(instance, triangle.v1) + shift,
                            toWorld(instance, triangle.v2) + shift, sense * normalInWorld(instance, normal));
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

float squareTo(Space space, vec3 point, uint kind, uint index, out uint id) {
    if (FEATURE_TRIANGLES && kind == kKindTriangle) return squareToTriangle(space, point, index, id);
    id = 0u;
    if (FEATURE_SPHERES && kind == kKindSphere) {
        Sphere sphere = loadSphere(index);
        id = sphere.id;
        return squareToSphere(point, sphere);
    }
    return kInfinity;
}

// Position of a point's search in the tree.
struct Walk {
    Space space;
    uint slot;       // next to be tested, kNone at the end of the tree
    uint worldSlot;  // after the instance
    uint kind;       // of the leaf at hand
    uint next, end;  // primitives of the leaf that are left
};

void enterLeaf(inout Walk walk, uint leaf) {
    walk.kind = kindOf(leaf);
    walk.next = leaf & kLeafFirstMask;
    walk.end = walk.next + ((leaf >> kLeafCountShift) & kLeafCountMask) + 1u;
}

// Tests the box of a slot and moves on: past the box, or into its node, instance or leaf.
void visitSlot(inout Walk walk, vec3 point, float best) {
    Node node = loadNode(walk.slot >> 1);
    bool second = (walk.slot & 1u) != 0u;
    uint child = second ? node.child1 : node.child0;
    float square = squareToBox(walk.space, second ? node.lo1 : node.lo0, second ? node.hi1 : node.hi0);
    bool enters = child != kNone && square <= best;
    walk.slot = second ? node.escape : walk.slot + 1u;
    if (enters && isNode(child)) {
        walk.slot = child << 1;
    } else if (enters && FEATURE_INSTANCES && kindOf(child) == kKindInstance) {
        walk.worldSlot = walk.slot;
        walk.space = enterSpace(child & kLeafFirstMask, point);
        walk.slot = loadInstance(child & kLeafFirstMask).root << 1;
    } else if (enters) {
        enterLeaf(walk, child);
    }
}

void returnToWorld(inout Walk walk, vec3 point) {
    walk.space = enterSpace(kNone, point);
    walk.slot = walk.worldSlot;
}

void main() {
    uint path = pathIndex();
    Ray ray = loadRay(path);
    vec3 point = ray.origin;
    uvec4 hitRow = loadRow(kRowHit, path);
    uvec4 instanceRow = loadInstanceRow(path);
    uint slot = loadWalkRow(path).x;
    bool live = isAlive(ray) && loadEnvironment(0u).root != kNone && (!MODE_RESUME || slot != kNone);

    Space space = enterSpace(MODE_RESUME && live ? instanceRow.z : kNone, point);
    Walk walk = Walk(space, slot, instanceRow.w, kKindTriangle, 0u, 0u);
    if (live && !MODE_RESUME) {
        enterLeaf(walk, nearestLeaf(walk.space, point));
        walk.slot = walk.space.instance == kNone ? 0u : kNone;
        walk.worldSlot = 0u;
    }
    float best = uintBitsToFloat(hitRow.x);
    uint trips = kMaxBvhDepth;  // of the way to the first leaf
    while (live && (walk.next < walk.end ||
                    ((walk.slot != kNone || walk.space.instance != kNone) && trips < dispatch.tripBudget))) {
        ++trips;
        if (walk.next < walk.end) {
            uint id;
            float square = squareTo(walk.space, point, walk.kind, walk.next, id);
            if (square < best || (square == best && id < hitRow.y) || hitRow.w == kNone) {
                best = square;
                hitRow.yw = uvec2(id, walk.kind << kPrimitiveKindShift | walk.next);
                instanceRow.x = walk.space.instance;
            }
            ++walk.next;
        } else if (walk.slot == kNone) {
            returnToWorld(walk, point);
        } else {
            visitSlot(walk, point, best);
        }
    }
    if (!live) return;
    if (walk.slot == kNone && walk.space.instance != kNone) returnToWorld(walk, point);
    bool unfinished = walk.slot != kNone;
    storeRow(kRowHit, path, uvec4(floatBitsToUint(best), hitRow.yzw));
    storeInstanceRow(path, uvec4(instanceRow.xy, walk.space.instance, walk.worldSlot));
    if (MODE_RESUME || unfinished) storeRow(kRowWalk, path, uvec4(walk.slot, 0u, 0u, 0u));
    if (unfinished) atomicAdd(counters[kCounterUnfinished], 1u);
}
