// Rays that leave a surface look again at the triangle that they are found to meet: a sliver may lie behind
// them (liesBehind, in primitives/triangle.glsl).
#ifndef GLINT_BEHIND_GLSL
#define GLINT_BEHIND_GLSL

// The ray as it was given, but for the end of its interval.
Ray worldRay(Traversal traversal) {
    if (FEATURE_INSTANCES) return traversal.world;
    return traversal.ray;
}

// Whether the hit of a ray in the world that leaves a surface is a triangle behind it (liesBehind).
bool meetsBehind(Ray ray, Hit hit) {
    bool looks = hit.primitive >> kPrimitiveKindShift == kKindTriangle && hit.primitive != kNone &&
                 ray.source != kNone;
    Triangle triangle = loadTriangle(looks ? hit.primitive & kPrimitiveIndexMask : 0u);
    vec3 origin = ray.origin;
    vec3 direction = ray.direction;
    bool exchanged = false;
    if (FEATURE_INSTANCES) {
        bool inInstance = hit.instance != kNone;
        Instance instance = loadInstance(inInstance ? hit.instance : 0u);
        if (inInstance) enterInstance(instance, origin, direction);
        exchanged = inInstance && instance.mirrored != 0u;
    }
    return looks &&
           liesBehind(origin, direction, triangle, exchanged ? hit.v : hit.u, exchanged ? hit.u : hit.v);
}

// What a further walk of a ray makes of trips that no lane counts, as the first one's stand in the budget:
// the planes' loop and one trip of each loop that it enters.
uint tripsOfAnotherWalk(Environment environment) { return environment.planeCount + tripsOfPass(); }

// trace() for a nearest hit. A triangle that proves to lie behind is passed by: the ray is traced from its t
// on.
uint traceNearest(inout Traversal traversal, Environment environment, uint slot, uvec2 place) {
    Ray ray = traversal.ray;
    Hit before = traversal.hit;
    uint left = kNone;
    bool going = true;
#ifdef GLINT_SETTLES
    traversal.after = -1.0;
#endif
    do {
        if (kConvergent || going) {
            if (kConvergent && !going) removeRay(traversal);
            uint end = trace(traversal, environment, slot, place);
            left = going ? end : left;
            going = going && looksLast(false) && kBounces && meetsBehind(ray, traversal.hit);
            if (going) {
                ray.tMin = traversal.hit.t;
                traversal.ray = ray;
                traversal.hit = before;
                traversal.trips += tripsOfAnotherWalk(environment);
                going = left == kNone;
            }
        }
    } while (looksLast(false) && anyGoesOn(going));
    return left;
}

#endif
