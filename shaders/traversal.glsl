// Closest hit, or any hit if GLINT_ANY_HIT is defined, through the BVH and over the planes.
//
// lavapipe ends every loop once a subgroup has made 65,535 trips through all its loops together, without a word. So each
// lane counts its trips and gives up at dispatch.tripBudget (the host derives it, src/render/renderer.cpp). A ray that gave up is finished by
// further dispatches of the same kernel with MODE_RESUME: a walk of the nodes in depth-first order that needs no stack, so that its whole
// state is one slot number. The order cannot matter, as the closest hit is the closest in any order.
#ifndef GLINT_TRAVERSAL_GLSL
#define GLINT_TRAVERSAL_GLSL

#include "intersect.glsl"

struct Traversal {
    Ray ray;
    RayFrame frame;
    Hit hit;
    uint trips;
    uint cost;
};

bool isNode(uint child) { return (child & kLeafFlag) == 0u; }

// A hit settles an any-hit ray.
bool settled(Traversal traversal) {
#ifdef GLINT_ANY_HIT
    return traversal.hit.primitive != kNone;
#else
    return false;
#endif
}

// Tests the primitives of a leaf; one loop for each kind, as lavapipe skips work only by not entering a loop.
void testLeaf(inout Traversal traversal, uint leaf) {
    uint kind = (leaf >> kLeafKindShift) & kLeafKindMask;
    uint first = leaf & kLeafFirstMask;
    uint end = first + ((leaf >> kLeafCountShift) & kLeafCountMask) + 1u;
    if (FEATURE_TRIANGLES) {
        uint index = kind == kKindTriangle ? first : end;
        do if (index < end) {
            Triangle triangle = loadTriangle(index);
            uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
            float t, u, v;
            if (intersectTriangle(traversal.ray, traversal.frame, triangle, t, u, v) &&
                primitive != traversal.ray.source) {
                accept(traversal.ray, traversal.hit, t, u, v, primitive, triangle.id);
            }
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        } while (index < end);
    }
    if (FEATURE_SPHERES) {
        uint index = kind == kKindSphere ? first : end;
        do if (index < end) {
            Sphere sphere = loadSphere(index);
            uint primitive = (kKindSphere << kPrimitiveKindShift) | index;
            float t;
            if (intersectSphere(traversal.ray, sphere, primitive, t)) {
                accept(traversal.ray, traversal.hit, t, 0.0, 0.0, primitive, sphere.id);
            }
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        } while (index < end);
    }
    if (FEATURE_DISCS) {
        uint index = kind == kKindDisc ? first : end;
        do if (index < end) {
            Disc disc = loadDisc(index);
            uint primitive = (kKindDisc << kPrimitiveKindShift) | index;
            float t;
            if (intersectDisc(traversal.ray, disc, t) && primitive != traversal.ray.source) {
                accept(traversal.ray, traversal.hit, t, 0.0, 0.0, primitive, disc.id);
            }
            ++index;
            ++traversal.trips;
            if (MODE_COST) ++traversal.cost;
        } while (index < end);
    }
    if (FEATURE_POLYGONS) {
        uint index = kind == kKindPolygon ? first : end;
        do if (index < end) {
            Polygon polygon = loadPolygon(index);
            uint primitive = (kKindPolygon << kPrimitiveKindShift) | index;
            float t;
            if (intersectPolygon(traversal.ray, traversal.frame, polygon, t) && primitive != traversal.ray.source) {
                accept(traversal.ray, traversal.hit, t, 0.0, 0.0, primitive, polygon.id);
            }
            ++index;
            // This loop's, the edges', and the one that ends theirs.
            traversal.trips += polygon.trips + 2u;
            if (MODE_COST) ++traversal.cost;
        } while (index < end);
    }
}

void testPlanes(inout Traversal traversal, uint planeCount) {
    for (uint index = 0u; index < planeCount; ++index) {
        Plane plane = loadPlane(index);
        uint primitive = (kKindPlane << kPrimitiveKindShift) | index;
        float t;
        if (intersectPlane(traversal.ray, plane, t) && primitive != traversal.ray.source) {
            accept(traversal.ray, traversal.hit, t, 0.0, 0.0, primitive, plane.id);
        }
        if (MODE_COST) ++traversal.cost;
    }
}

// From the root with a stack, nearer child first. Returns kNone when finished, else the slot to resume from: 0, the beginning;
// what is known by then keeps the second pass short.
uint traverse(inout Traversal traversal, uint root) {
    // One entry for each level at most: the far child of a node on the current path.
    uint stack[kMaxBvhDepth + 1u];
    uint top = 0u;
    uint current = root;
    do if (current != kNone && traversal.trips < dispatch.tripBudget) {
        do if (isNode(current) && traversal.trips < dispatch.tripBudget) {
            Node node = loadNode(current);
            precise float tEnd = traversal.ray.tMax * kFarPad;
            float near0, near1;
            bool hit0 = intersectBox(traversal.ray, traversal.frame, node.lo0, node.hi0, tEnd, near0);
            bool hit1 = intersectBox(traversal.ray, traversal.frame, node.lo1, node.hi1, tEnd, near1);
            bool swapped = near1 < near0;
            uint nearChild = swapped ? node.child1 : node.child0;
            uint farChild = swapped ? node.child0 : node.child1;
            bool both = hit0 && hit1;
            if (both) stack[top] = farChild;
            top += both ? 1u : 0u;
            bool pop = !hit0 && !hit1;
            bool empty = top == 0u;
            uint popped = stack[empty ? 0u : top - 1u];
            top -= pop && !empty ? 1u : 0u;
            current = both ? nearChild : (hit0 ? node.child0 : (hit1 ? node.child1 : (empty ? kNone : popped)));
            ++traversal.trips;
            if (MODE_COST) traversal.cost += 2u;
        } while (isNode(current) && traversal.trips < dispatch.tripBudget);
        if (current != kNone && !isNode(current)) {
            testLeaf(traversal, current);
            bool done = top == 0u || settled(traversal);
            current = done ? kNone : stack[top == 0u ? 0u : top - 1u];
            top -= done ? 0u : 1u;
        }
        ++traversal.trips;
    } while (current != kNone && traversal.trips < dispatch.tripBudget);
    return current == kNone ? kNone : 0u;
}

// The same set of leaves in depth-first order from `slot` on, without a stack. Returns where it stopped, kNone at the end.
uint walk(inout Traversal traversal, uint slot) {
    do if (slot != kNone && traversal.trips < dispatch.tripBudget) {
        Node node = loadNode(slot >> 1);
        bool second = (slot & 1u) != 0u;
        uint child = second ? node.child1 : node.child0;
        precise float tEnd = traversal.ray.tMax * kFarPad;
        float near;
        bool entered = intersectBox(traversal.ray, traversal.frame, second ? node.lo1 : node.lo0,
                                    second ? node.hi1 : node.hi0, tEnd, near);
        uint next = second ? node.escape : slot + 1u;
        if (entered && isNode(child)) next = child << 1;
        bool leaf = entered && child != kNone && !isNode(child);
        if (leaf) testLeaf(traversal, child);
        slot = settled(traversal) ? kNone : next;
        ++traversal.trips;
        if (MODE_COST) ++traversal.cost;
    } while (slot != kNone && traversal.trips < dispatch.tripBudget);
    return slot;
}

// Makes the ray ready. False for one with nothing to find: an empty interval, or not finite, or without direction.
bool prepare(inout Traversal traversal) {
    vec3 size = abs(traversal.ray.direction);
    bool valid = isFinite(traversal.ray.origin) && isFinite(traversal.ray.direction) &&
                 max(size.x, max(size.y, size.z)) > 0.0;
    if (!valid) traversal.ray.tMax = -1.0;
    traversal.frame = makeFrame(traversal.ray.direction);
    return traversal.ray.tMax > traversal.ray.tMin;
}

// Runs the ray, or goes on with it from `slot` in MODE_RESUME. A ray that is not finite or has no direction misses.
// Returns kNone when finished, else the slot to resume from.
uint trace(inout Traversal traversal, Environment environment, uint slot) {
    bool sound = prepare(traversal);
    if (MODE_RESUME) return walk(traversal, sound ? slot : kNone);
    if (FEATURE_PLANES) testPlanes(traversal, sound ? environment.planeCount : 0u);
    bool inTree = (FEATURE_TRIANGLES || FEATURE_SPHERES || FEATURE_DISCS || FEATURE_POLYGONS) && sound && !settled(traversal);
    return traverse(traversal, inTree ? environment.root : kNone);
}

#endif
