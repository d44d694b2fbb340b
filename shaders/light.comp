#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef GLINT_PACKET
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// What the lights add to each hit: a shadow ray to each, then Lambert and Blinn-Phong (Blinn 1977; Whitted
// 1980). A dispatch goes through as many lights as its loop trips allow (Dispatch::lightEnd).
#define GLINT_ANY_HIT
#define GLINT_SHADOW_RAYS
#include "path.glsl"
#include "passage.glsl"
#include "scatter.glsl"
#include "shared/shading.h"
#include "tree.glsl"
#ifdef GLINT_PACKET
#include "packet.glsl"
#else
#include "traversal.glsl"
#endif

struct LightSample {
    vec3 toLight;    // shadow ray direction: from the surface to the light, unnormalised for a point light
    vec3 direction;  // unit
    vec3 intensity;  // with falloff
    float tMax;      // of the shadow ray
    bool valid;
};

// The part of a spot light's intensity that goes along `toLight`, a unit vector back to it: a smoothstep of
// the angle's cosine. |axis + toLight|^2 / 2 is 1 - cos, exact to the last digits for a narrow cone too. No
// larger than 2, whatever the rounding, so that a cone of 180 degrees has no hole at its back.
float spotFactor(Light light, vec3 toLight) {
    vec3 sum = light.axis + toLight;
    float away = min(0.5 * dot(sum, sum), 2.0);
    float s = away <= light.inner
                  ? 1.0
                  : quotient(max(light.outer - away, 0.0), max(light.outer - light.inner, 1e-30));
    return s * s * (3.0 - 2.0 * s);
}

LightSample sampleLight(Light light, vec3 position) {
    LightSample s = LightSample(light.position, light.position, light.intensity, kInfinity, true);
    if ((FEATURE_POINT_LIGHTS || FEATURE_SPOT_LIGHTS) && light.kind != kLightDirectional) {
        precise vec3 toLight = light.position - position;
        float distance = length(toLight);
        s.toLight = toLight;
        s.direction = quotient(toLight, distance);
        s.tMax = kShadowEnd;
        s.valid = distance > kNearestLight;
        bool fades = light.kind == kLightPointInverseSquare || light.kind == kLightSpotInverseSquare;
        if (fades) s.intensity = quotient(quotient(light.intensity, distance), distance);
    }
    if (FEATURE_SPOT_LIGHTS && (light.kind == kLightSpot || light.kind == kLightSpotInverseSquare)) {
        float factor = spotFactor(light, s.direction);
        s.intensity *= factor;
        s.valid = s.valid && factor > 0.0;
    }
    return s;
}

const bool kFiltered = FEATURE_COLORED_SHADOWS && !MODE_SHADOWLESS;

// What a path keeps from light to light.
struct Lit {
    uint path;
    bool live;
    bool changed;  // light has been added
    Interaction at;
    vec3 origin;  // of shadow rays
    vec3 radiance;
    uint hits;  // of kRowRadiance
    vec3 throughput;
    vec3 transmittance;  // of the way to the eye's side
    uint shadowBits;
};

Lit litAt(uint path, bool present, uvec4 walkRow) {
    Lit lit;
    lit.path = path;
    lit.at = interactionAt(loadRay(path), loadHit(path, walkRow.y), loadMedia(path));
    lit.live = present && isAlive(lit.at.ray) && lit.at.isHit && counts(lit.at);
    lit.changed = false;
    Surface surface = lit.at.surface;
    lit.origin = offsetOrigin(surface.position, surface.error, surface.geometricNormal);
    uvec4 sum = loadRow(kRowRadiance, path);
    lit.radiance = uintBitsToFloat(sum.xyz);
    lit.hits = sum.w;
    lit.throughput = uintBitsToFloat(loadRow(kRowThroughput, path).xyz);
    if (FEATURE_TRANSMISSION) lit.transmittance = transmittanceOfWay(lit.at);
    lit.shadowBits = 0u;
    return lit;
}

// A light as the path sees it.
struct Sight {
    bool facing;  // it shines on the side that is seen
    vec3 direction;
    vec3 intensity;
};

// Makes the path's shadow ray to a light. begins: it has not been traced in part.
Sight aim(Lit lit, uint index, bool begins, inout Traversal traversal) {
    LightSample light = sampleLight(loadLight(index), lit.at.surface.position);
    Sight sight = Sight(false, light.direction, light.intensity);
    sight.facing = lit.live && light.valid && dot(lit.at.surface.geometricNormal, light.direction) > 0.0 &&
                   dot(lit.at.surface.shadingNormal, light.direction) > 0.0;
    traversal.ray = Ray(lit.origin, light.toLight, 0.0, sight.facing && !MODE_SHADOWLESS ? light.tMax : -1.0,
                        lit.at.hit.primitive, lit.at.hit.instance);
    traversal.hit = Hit(kInfinity, 0.0, 0.0, kNone, kNone, kNone);
    if (kFiltered) {
        bool near = light.tMax < kInfinity;
        traversal.passage =
            startPassage(lit.at.crossing.before, near ? 1.0 : 0.0, near ? length(light.toLight) : 1.0);
        if (MODE_RESUME && !begins)
            traversal.passage.depth = uintBitsToFloat(loadRow(treeRow(kTreeRowShadow), lit.path).xyz);
    }
    if (MODE_TALLY && !MODE_SHADOWLESS && sight.facing && begins) atomicAdd(counters[kCounterShadow], 1u);
    return sight;
}

// Takes what the light adds, once its shadow ray is finished.
void take(inout Lit lit, uint index, Sight sight, Traversal traversal, bool finished) {
    bool occluded = traversal.hit.primitive != kNone;
    vec3 radiance = evaluate(lit.at, sight.direction) * sight.intensity;
    if (FEATURE_TRANSMISSION) radiance *= lit.transmittance;
    if (kFiltered) radiance *= lightThrough(traversal.passage);
    vec3 sum = lit.radiance + lit.throughput * radiance;
    bool added = sight.facing && finished && !occluded;
    if (added) lit.radiance = sum;
    lit.changed = lit.changed || added;
    if (sight.facing && occluded && dispatch.bounce == 0u && index < kShadowBits)
        lit.shadowBits |= 1u << index;
}

// Where a path goes on that has run out of trips, kNone in `slot` if it has not.
struct Rest {
    uint slot;
    uint light;
};

void store(Lit lit, Traversal traversal, Rest rest) {
    bool unfinished = lit.live && rest.slot != kNone;
    if (lit.changed) storeRow(kRowRadiance, lit.path, packRow(lit.radiance, lit.hits));
    // Not stored where nobody reads what would change (packet_intersect.comp says what a store costs).
    if (lit.live && (MODE_AOVS || MODE_COST || MODE_RESUME || unfinished)) {
        uvec4 walkRow = loadWalkRow(lit.path);
        storeRow(kRowWalk, lit.path,
                 uvec4(rest.slot, walkRow.y, walkRow.z + traversal.cost, walkRow.w | lit.shadowBits));
    }
    if (unfinished) {
        storeRow(kRowLight, lit.path, uvec4(rest.light, 0u, 0u, 0u));
        if (kFiltered) storeRow(treeRow(kTreeRowShadow), lit.path, packRow(traversal.passage.depth, 0u));
        storeInstanceRow(lit.path,
                         uvec4(loadInstanceRow(lit.path).xy, traversal.instance, traversal.worldSlot));
        atomicAdd(counters[kCounterUnfinished], 1u);
    }
}

#ifdef GLINT_PACKET
// A path that hit nothing, or ended before, has nothing to light.
bool mayHaveRay(uint path) { return loadRow(kRowHit, path).w != kNone; }

void onePacket(uint turn) {
    Lit lit[GLINT_PACKET_RAYS];
    GLINT_EACH_RAY {
        bool present;
        uint path = packetPath(turn, r, present);
        lit[r] = litAt(path, present, loadWalkRow(path));
        packet[r].cost = 0u;
    }
    Environment environment = loadEnvironment(0u);
    packetTrips = 0u;
    uint index = dispatch.lightIndex;
    uint end = dispatch.lightEnd;
    bool complete = true;
    Sight sights[GLINT_PACKET_RAYS];
    do {
        if (index < end) {
            GLINT_EACH_RAY sights[r] = aim(lit[r], index, true, packet[r]);
            complete = tracePacket(environment);
            GLINT_EACH_RAY take(lit[r], index, sights[r], packet[r], complete);
            ++index;
        }
    } while (complete && index < end);
    // Of a packet that was given up, rays that are not settled are to be started again.
    GLINT_EACH_RAY {
        bool again = sights[r].facing && !settled(packet[r]);
        uint further = index < end ? kSlotFresh : kNone;
        Rest rest = Rest(complete ? kNone : (again ? 0u : further), again ? index - 1u : index);
        store(lit[r], packet[r], rest);
    }
}

void main() {
    uint turn = 0u;
    do {
        onePacket(nextPacket(turn));
    } while (turn < kPacketTurns);
}
#else
void main() {
    bool present;
    uint path = listedPath(present);
    uvec4 walkRow = loadWalkRow(path);
    Lit lit = litAt(path, present && (!MODE_RESUME || walkRow.x != kNone), walkRow);
    Environment environment = loadEnvironment(0u);
    uvec2 place = loadInstanceRow(path).zw;
    Rest rest = Rest(kSlotFresh, dispatch.lightIndex);
    if (MODE_RESUME) rest = Rest(walkRow.x, loadRow(kRowLight, path).x);
    uint end = dispatch.lightEnd;
    uint budget = dispatch.tripBudget;
    Traversal traversal;
    traversal.trips = 0u;
    traversal.cost = 0u;
    bool going = lit.live && rest.light < end;
    do {
        if (going) {
            Sight sight = aim(lit, rest.light, rest.slot == kSlotFresh, traversal);
            uint left = trace(traversal, environment, rest.slot, place);
            bool finished = left == kNone || settled(traversal) || !sight.facing;
            take(lit, rest.light, sight, traversal, finished);
            rest.slot = finished ? kSlotFresh : left;
            rest.light += finished ? 1u : 0u;
            going = finished && rest.light < end && traversal.trips < budget;
        }
    } while (going);
    if (rest.light >= end) rest.slot = kNone;
    store(lit, traversal, rest);
}
#endif
