// The primitives of a leaf, and the planes, which lie in none.
#ifndef GLINT_LEAF_GLSL
#define GLINT_LEAF_GLSL

#ifdef GLINT_CROSSINGS
// Counts it, and writes it down where a list is wanted: behind the rows of the paths, two rows a hit.
void cross(inout Traversal traversal, uint kind, float t, float u, float v, uint primitive) {
#ifdef GLINT_LIST
    if (traversal.crossed < traversal.list.y) {
        bool exchanged = FEATURE_INSTANCES && traversal.mirrored && kind == kKindTriangle;
        uint place = (kPathRows + (FEATURE_INSTANCES ? 1u : 0u)) * dispatch.capacity +
                     2u * (traversal.list.x + traversal.crossed);
        storePathRow(place, uvec4(floatBitsToUint(t), floatBitsToUint(exchanged ? v : u),
                                  floatBitsToUint(exchanged ? u : v), primitive));
        storePathRow(place + 1u, uvec4(FEATURE_INSTANCES ? traversal.instance : kNone, 0u, 0u, 0u));
    }
#endif
    ++traversal.crossed;
}
#endif

bool isShadowRay(Traversal traversal) {
#ifdef GLINT_BOTH_HITS
    return traversal.any;
#elif defined(GLINT_SHADOW_RAYS)
    return true;
#else
    return false;
#endif
}

// A ray may go through a hole of the surface, and as a shadow ray through dielectrics.
#ifdef GLINT_SHADOW_RAYS
const bool kMayGoThrough = FEATURE_ALPHA_MASK || FEATURE_COLORED_SHADOWS;
#else
const bool kMayGoThrough = FEATURE_ALPHA_MASK;
#endif

// Whether the ray goes on through what it meets at t: a hole of the surface, or as a shadow ray a dielectric,
// which then takes of the light.
bool goesThrough(inout Traversal traversal, uint kind, Met met, float t) {
    bool through = FEATURE_ALPHA_MASK && holeAt(met.surface);
#ifdef GLINT_SHADOW_RAYS
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal) && !through)
        through = passes(traversal.passage, met, kind, t);
#endif
    return through;
}

// Planes, which stand in no leaf, are asked by code of their own, where there are any to ask.
bool mayBeOpen(uint kind) { return FEATURE_OPEN_PLANES || kind != kKindPlane; }

// Takes the hit if it is one, does not let the ray through, and beats the best.
void offer(inout Traversal traversal, uint kind, bool isHit, float t, float u, float v, uint primitive,
           uint id) {
    bool counts = isHit;
    if (kMayGoThrough && mayBeOpen(kind) && counts) {
        Hit hit = Hit(t, u, v, primitive, FEATURE_INSTANCES ? traversal.instance : kNone, id);
        counts = !goesThrough(traversal, kind, metAt(traversal.ray, kind, hit), t);
    }
#ifdef GLINT_CROSSINGS
    if (counts) cross(traversal, kind, t, u, v, primitive);
#else
    if (counts) accept(traversal, t, u, v, primitive, id);
#endif
}

#ifdef GLINT_CROSSINGS
// Counts it if that is certain, and puts it aside if it is not. Without room the host counts the ray anew.
void lookAtTriangle(inout Traversal traversal, uint index) {
    Look look = lookAt(traversal.ray, traversal.frame, loadTriangle(index));
    traversal.crossed += look.crosses && look.certain ? 1u : 0u;
    if (look.crosses && !look.certain) {
        traversal.doubtful |= traversal.aside >= kMostAside ? 1u : 0u;
        traversal.aside1 = uvec4(traversal.aside0.w, traversal.aside1.xyz);
        traversal.aside0 = uvec4(index, traversal.aside0.xyz);
        traversal.aside = min(traversal.aside + 1u, kMostAside);
    }
}
const bool kPutsAsideHere = kPutsAside;
#else
const bool kPutsAsideHere = false;
#endif

// Looks closely at the triangles that were put aside.
void settleAside(inout Traversal traversal) {
#ifdef GLINT_CROSSINGS
    if (kPutsAside) {
        do {
            if (traversal.aside > 0u) {
                Triangle triangle = loadTriangle(traversal.aside0.x);
                traversal.aside0 = uvec4(traversal.aside0.yzw, traversal.aside1.x);
                traversal.aside1 = uvec4(traversal.aside1.yzw, kNone);
                --traversal.aside;
                float t, u, v;
                bool doubtful;
                bool isHit = crossTriangle(traversal.ray, traversal.frame, triangle, traversal.trips, t, u, v,
                                           doubtful);
                traversal.doubtful |= doubtful ? 1u : 0u;
                traversal.crossed += isHit ? 1u : 0u;
            }
        } while (traversal.aside > 0u);
    }
#endif
}

// The triangle's hit between the ray's ends; Hit.primitive is `primitive`.
bool hitTriangleAt(inout Traversal traversal, Ray ray, uint index, uint primitive, out Hit hit) {
    Triangle triangle = loadTriangle(index);
    float t, u, v;
#ifdef GLINT_CROSSINGS
    bool doubtful;
    bool isHit = crossTriangle(ray, traversal.frame, triangle, traversal.trips, t, u, v, doubtful);
    traversal.doubtful |= doubtful ? 1u : 0u;
#else
    bool isHit = meetTriangle(ray, traversal.frame, triangle, loadTriangleSurface(index).normal, t, u, v);
#endif
#ifdef GLINT_SHADOW_RAYS
    if (FEATURE_COLORED_SHADOWS && isShadowRay(traversal))
        traversal.passage.counts = crossesOnce(ray, traversal.frame, triangle);
#endif
    hit = Hit(t, u, v, primitive, kNone, triangle.id);
    return isHit;
}

void testTriangle(inout Traversal traversal, uint index) {
#ifdef GLINT_CROSSINGS
    if (kPutsAside) {
        lookAtTriangle(traversal, index);
        return;
    }
#endif
    uint primitive = (kKindTriangle << kPrimitiveKindShift) | index;
    Hit hit;
    bool isHit = hitTriangleAt(traversal, traversal.ray, index, primitive, hit);
    offer(traversal, kKindTriangle, isHit, hit.t, hit.u, hit.v, hit.primitive, hit.id);
}

#ifdef GLINT_CROSSINGS
// A ray that counts passes through: further hits count too, each looked for from the one before on.
#define GLINT_FURTHER(Kind, crossings)                                                           \
    Ray rest = traversal.ray;                                                                    \
    if (crossings == 2) {                                                                        \
        rest.tMin = isHit ? hit.t : rest.tMin;                                                   \
        isHit = isHit && hit##Kind(rest, traversal.frame, one, primitive, traversal.trips, hit); \
        offer(traversal, kKind##Kind, isHit, hit.t, hit.u, hit.v, hit.primitive, hit.id);        \
    }                                                                                            \
    if (crossings > 2) {                                                                         \
        for (uint further = 1u; isHit && further < uint(crossings); ++further) {                 \
            rest.tMin = hit.t;                                                                   \
            isHit = hit##Kind(rest, traversal.frame, one, primitive, traversal.trips, hit);      \
            offer(traversal, kKind##Kind, isHit, hit.t, hit.u, hit.v, hit.primitive, hit.id);    \
            ++traversal.trips;                                                                   \
        }                                                                                        \
    }
#else
#define GLINT_FURTHER(Kind, crossings)
#endif

#define GLINT_TEST_ALONE(Kind, crossings)                                                             \
    void test##Kind(inout Traversal traversal, uint index) {                                          \
        Kind one = load##Kind(index);                                                                 \
        uint primitive = (kKind##Kind << kPrimitiveKindShift) | index;                                \
        Hit hit;                                                                                      \
        bool isHit = hit##Kind(traversal.ray, traversal.frame, one, primitive, traversal.trips, hit); \
        offer(traversal, kKind##Kind, isHit, hit.t, hit.u, hit.v, hit.primitive, hit.id);             \
        GLINT_FURTHER(Kind, crossings)                                                                \
    }
#define GLINT_TEST_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                           loops, uv)                                                                      \
    GLINT_TEST_##ROLE(Kind, crossings)
#define GLINT_TEST_TRIANGLES(Kind, crossings)
#define GLINT_TEST_PACKETS(Kind, crossings) GLINT_TEST_ALONE(Kind, crossings)
#define GLINT_TEST_LEAVES(Kind, crossings) GLINT_TEST_ALONE(Kind, crossings)
#define GLINT_TEST_UNBOUNDED(Kind, crossings)
#define GLINT_TEST_INSTANCES(Kind, crossings)
GLINT_PRIMITIVES(GLINT_TEST_OF_KIND, 0)

// One loop for each kind, as lavapipe skips work only by not entering a loop; a `while` that is not entered
// would run its body once. Each primitive takes a trip of the budget.
#define GLINT_LOOP(Kind, FEATURE)                       \
    if (FEATURE_##FEATURE) {                            \
        uint index = kind == kKind##Kind ? first : end; \
        do {                                            \
            if (index < end) {                          \
                test##Kind(traversal, index);           \
                ++index;                                \
                ++traversal.trips;                      \
                if (MODE_COST) ++traversal.cost;        \
            }                                           \
        } while (index < end);                          \
    }
#define GLINT_LOOP_TRIANGLES(Kind, FEATURE) GLINT_LOOP(Kind, FEATURE)
#define GLINT_LOOP_PACKETS(Kind, FEATURE) GLINT_LOOP(Kind, FEATURE)
#define GLINT_LOOP_LEAVES(Kind, FEATURE) GLINT_LOOP(Kind, FEATURE)
#define GLINT_LOOP_UNBOUNDED(Kind, FEATURE)
#define GLINT_LOOP_INSTANCES(Kind, FEATURE)
#define GLINT_LOOP_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                           loops, uv)                                                                      \
    GLINT_LOOP_##ROLE(Kind, FEATURE)

#ifndef GLINT_CROSSINGS

bool hitPlaneAt(Traversal traversal, Ray ray, uint index, uint primitive, out Hit hit) {
    Plane plane = loadPlane(index);
    float t;
    bool isHit = intersectPlane(ray, traversal.frame, plane, t);
    hit = Hit(t, 0.0, 0.0, primitive, kNone, plane.id);
    return isHit;
}

// Where the ray may go through what it hits, what decides about that is much code, in which the drivers'
// compilers spend seconds if each kind has it for itself. So one loop tests all kinds: a trip asks for the
// next hit of the primitive at hand, or else takes the next primitive.
#define GLINT_MEET_OF_KIND(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                           loops, uv)                                                                      \
    GLINT_MEET_##ROLE(Kind, FEATURE)
#define GLINT_MEET_ALONE(Kind, FEATURE)                                                 \
    if (FEATURE_##FEATURE && kind == kKind##Kind) {                                     \
        Kind one = load##Kind(index);                                                   \
        isHit = hit##Kind(rest, traversal.frame, one, primitive, traversal.trips, hit); \
        if (kLooksWhileMeeting) {                                                       \
            fill##Kind(traversal.ray, hit, one, met.surface);                           \
            met.leaving = leavesThrough(kKind##Kind, hit, met.surface, rest.direction); \
        }                                                                               \
    }
#define GLINT_MEET_TRIANGLES(Kind, FEATURE)                                             \
    if (FEATURE_##FEATURE && kind == kKind##Kind) {                                     \
        isHit = hitTriangleAt(traversal, rest, index, primitive, hit);                  \
        if (kLooksWhileMeeting) {                                                       \
            Instance none;                                                              \
            surfaceOfTriangle(hit, none, met.surface);                                  \
            met.leaving = leavesThrough(kKind##Kind, hit, met.surface, rest.direction); \
        }                                                                               \
    }
#define GLINT_MEET_PACKETS(Kind, FEATURE) GLINT_MEET_ALONE(Kind, FEATURE)
#define GLINT_MEET_LEAVES(Kind, FEATURE) GLINT_MEET_ALONE(Kind, FEATURE)
#define GLINT_MEET_UNBOUNDED(Kind, FEATURE)                        \
    if (FEATURE_##FEATURE && kPlanesInWalk && kind == kKind##Kind) \
        isHit = hit##Kind##At(traversal, rest, index, primitive, hit);
#define GLINT_MEET_INSTANCES(Kind, FEATURE)

#define GLINT_MEET_AGAIN(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                         loops, uv)                                                                      \
    || (crossings > 1 && kind == kKind##Kind)

// Where hits do not wait, what is met is looked at with the primitive at hand: loads are most of the code.
const bool kLooksWhileMeeting = kMayGoThrough && !kAsks;

// The hit of primitive `index` of a kind after `after`. met: with kLooksWhileMeeting, in the coordinates of
// the primitive.
bool meetThrough(inout Traversal traversal, uint kind, uint index, float after, out Hit hit, out Met met) {
    Ray rest = traversal.ray;
    rest.tMin = after;
    uint primitive = (kind << kPrimitiveKindShift) | index;
    hit = Hit(0.0, 0.0, 0.0, kNone, kNone, 0u);
    met = Met(noSurface(), false);
    bool isHit = false;
    GLINT_PRIMITIVES(GLINT_MEET_OF_KIND, 0)
    return isHit;
}

// Whether the same primitive may be met again behind its hit.
bool mayMeetAgain(uint kind, float t, float after) {
    return t > after && (false GLINT_PRIMITIVES(GLINT_MEET_AGAIN, 0));
}

void testLeafThrough(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first;
    float after = traversal.ray.tMin;
    do {
        if (index < end) {
            Hit hit;
            Met met;
            bool isHit = meetThrough(traversal, kind, index, after, hit, met);
            if (FEATURE_INSTANCES) hit.instance = traversal.instance;
            finishMet(kind, hit, met);
            if (isHit && !goesThrough(traversal, kind, met, hit.t))
                accept(traversal, hit.t, hit.u, hit.v, hit.primitive, hit.id);
            bool further = isHit && mayMeetAgain(kind, hit.t, after);
            after = further ? hit.t : traversal.ray.tMin;
            index += further ? 0u : 1u;
            // One trip of this loop, and that of a polygon's edges which is entered in each.
            traversal.trips += 2u;
            if (MODE_COST && !further) ++traversal.cost;
        }
    } while (index < end);
}

// The same until a hit is found: it waits in `asked` until the rays of the subgroup wait or are through
// (answer), so that what decides about hits is not paid for with each primitive that is tested.
void testLeafAsking(inout Traversal traversal, uint kind, uint first, uint end) {
    uint index = first + leafTested;
    do {
        if (index < end && !asking) {
            Hit hit;
            Met met;
            asking = meetThrough(traversal, kind, index, leafAfter, hit, met);
            if (asking) asked = hit;
            if (!asking) {
                leafAfter = traversal.ray.tMin;
                ++index;
                if (MODE_COST) ++traversal.cost;
            }
            traversal.trips += 2u;
        }
    } while (index < end && !asking);
    leafTested = index - first;
}

// Decides about the hit that waits.
void answer(inout Traversal traversal) {
    if (asking) {
        Hit hit = asked;
        uint kind = hit.primitive >> kPrimitiveKindShift;
        offer(traversal, kind, true, hit.t, hit.u, hit.v, hit.primitive, hit.id);
        bool further = mayMeetAgain(kind, hit.t, leafAfter);
        leafAfter = further ? hit.t : traversal.ray.tMin;
        leafTested += further ? 0u : 1u;
        if (MODE_COST && !further) ++traversal.cost;
        asking = false;
    }
}
#else
void answer(inout Traversal traversal) {}
#endif

#ifdef GLINT_CERTIFY
// What a span says about the nearest hit.
void judge(inout Traversal traversal, Span span, uint kind, uint index, uint ownId) {
    uint id = FEATURE_INSTANCES ? traversal.idBase + ownId : ownId;
    if (weigh(traversal.certainty, traversal.hit, traversal.ray.tMax, span, id)) {
        traversal.ray.tMax = span.upper;
        bool exchanged = FEATURE_INSTANCES && traversal.mirrored && kind == kKindTriangle;
        traversal.hit =
            Hit(span.t, exchanged ? span.v : span.u, exchanged ? span.u : span.v,
                (kind << kPrimitiveKindShift) | index, FEATURE_INSTANCES ? traversal.instance : kNone, id);
    }
}

// Of an anchored sphere, and of one that is placed with others, no more is said than that it may be hit.
void judgeSphere(inout Traversal traversal, Sphere sphere, uint index) {
    bool anchored = FEATURE_ANCHORED_SPHERES && sphere.anchorNormal != vec3(0.0);
    if (anchored || (FEATURE_INSTANCES && traversal.instance != kNone)) doubtAll(traversal.certainty);
    SphereSpans spans = spansOf(traversal.certainty, traversal.ray, sphere);
    judge(traversal, spans.near, kKindSphere, index, sphere.id);
    judge(traversal, spans.far, kKindSphere, index, sphere.id);
}

// Nor of other kinds. (Of a packet's rays some have nothing to find.)
void judgeCuboid(inout Traversal traversal, Cuboid cuboid, uint index) {
    if (traversal.ray.tMax > traversal.ray.tMin) doubtAll(traversal.certainty);
}
void judgeLeaf(inout Traversal traversal, uint kind, uint first, uint end) {
    bool triangles = kind == kKindTriangle;
    bool spheres = FEATURE_SPHERES && kind == kKindSphere;
    if (!triangles && !spheres) doubtAll(traversal.certainty);
    uint index = triangles ? first : end;
    do {
        if (index < end) {
            Triangle triangle = loadTriangle(index);
            Span span = spanOf(traversal.certainty, traversal.ray, traversal.frame, triangle);
            judge(traversal, span, kKindTriangle, index, triangle.id);
            ++index;
            ++traversal.trips;
        }
    } while (index < end);
    if (FEATURE_SPHERES) {
        index = spheres ? first : end;
        do {
            if (index < end) {
                judgeSphere(traversal, loadSphere(index), index);
                ++index;
                ++traversal.trips;
            }
        } while (index < end);
    }
}

void judgePlanes(inout Traversal traversal, uint planeCount) {
    uint index = 0u;
    do {
        if (index < planeCount) {
            Plane plane = loadPlane(index);
            judge(traversal, spanOf(traversal.certainty, traversal.ray, plane), kKindPlane, index, plane.id);
            ++index;
        }
    } while (index < planeCount);
}
#endif

uint sizeOfLeaf(uint leaf) {
    if (kPlanesInWalk && leaf == kLeafOfPlanes) return planesInLeaf;
    return ((leaf >> kLeafCountShift) & kLeafCountMask) + 1u;
}

// Tests the primitives of a leaf.
void testLeaf(inout Traversal traversal, uint leaf) {
    uint kind = (leaf >> kLeafKindShift) & kLeafKindMask;
    uint first = leaf & kLeafFirstMask;
    uint end = first + sizeOfLeaf(leaf);
#if defined(GLINT_CERTIFY)
    judgeLeaf(traversal, kind, first, end);
#elif !defined(GLINT_CROSSINGS)
    if (kAsks) {
        testLeafAsking(traversal, kind, first, end);
    } else if (FEATURE_ALPHA_MASK || (kMayGoThrough && isShadowRay(traversal))) {
        testLeafThrough(traversal, kind, first, end);
    } else {
        GLINT_PRIMITIVES(GLINT_LOOP_OF_KIND, 0)
    }
#else
    GLINT_PRIMITIVES(GLINT_LOOP_OF_KIND, 0)
#endif
}

void testPlanes(inout Traversal traversal, uint planeCount) {
    uint index = 0u;
    do {
        if (index < planeCount) {
            Plane plane = loadPlane(index);
            uint primitive = (kKindPlane << kPrimitiveKindShift) | index;
            float t;
            bool isHit = intersectPlane(traversal.ray, traversal.frame, plane, t);
            offer(traversal, kKindPlane, isHit, t, 0.0, 0.0, primitive, plane.id);
            ++index;
            if (MODE_COST) ++traversal.cost;
        }
    } while (index < planeCount);
}

#endif
