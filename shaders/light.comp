#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef GLINT_PACKET
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
// What one light adds to each hit: a shadow ray, then Lambert and Blinn-Phong (Blinn 1977; Whitted 1980). One
// dispatch for each light, so that the loop trips of a dispatch are those of one ray.
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

// What is left to do for a path once its shadow ray is traced.
struct LightWork {
    uint path;
    bool live;
    bool facing;    // the light shines on the side that is seen
    vec3 radiance;  // what it adds if nothing is in between
};

// Starts the path's shadow ray; returns the slot it goes on from, and in `place` where that is (trace).
uint begin(uint path, bool present, out LightWork work, out Traversal traversal, out uvec2 place) {
    uvec4 walkRow = loadWalkRow(path);
    Ray ray = loadRay(path);
    Interaction at = interactionAt(ray, loadHit(path, walkRow.y), loadMedia(path));
    LightSample light = sampleLight(loadLight(dispatch.lightIndex), at.surface.position);
    work.path = path;
    work.live = present && isAlive(ray) && at.isHit && counts(at) && (!MODE_RESUME || walkRow.x != kNone);
    work.facing = work.live && light.valid && dot(at.surface.geometricNormal, light.direction) > 0.0 &&
                  dot(at.surface.shadingNormal, light.direction) > 0.0;
    work.radiance = evaluate(at, light.direction) * light.intensity;
    if (FEATURE_TRANSMISSION) work.radiance *= transmittanceOfWay(at);

    traversal.ray =
        Ray(offsetOrigin(at.surface.position, at.surface.error, at.surface.geometricNormal), light.toLight,
            0.0, work.facing && !MODE_SHADOWLESS ? light.tMax : -1.0, at.hit.primitive, at.hit.instance);
    traversal.hit = Hit(kInfinity, 0.0, 0.0, kNone, kNone, kNone);
    traversal.trips = 0u;
    traversal.cost = 0u;
    if (kFiltered) {
        bool near = light.tMax < kInfinity;
        traversal.passage =
            startPassage(at.crossing.before, near ? 1.0 : 0.0, near ? length(light.toLight) : 1.0);
        if (MODE_RESUME)
            traversal.passage.depth = uintBitsToFloat(loadRow(treeRow(kTreeRowShadow), path).xyz);
    }
    place = loadInstanceRow(path).zw;
    return walkRow.x;
}

void end(LightWork work, Traversal traversal, uint slot) {
    bool occluded = traversal.hit.primitive != kNone;
    if (MODE_TALLY && !MODE_RESUME && !MODE_SHADOWLESS && work.facing)
        atomicAdd(counters[kCounterShadow], 1u);
    if (occluded || !work.facing) slot = kNone;
    vec3 radiance = work.radiance;
    if (kFiltered) {
        radiance *= lightThrough(traversal.passage);
        if (work.live && slot != kNone)
            storeRow(treeRow(kTreeRowShadow), work.path, packRow(traversal.passage.depth, 0u));
    }
    uvec4 throughput = loadRow(kRowThroughput, work.path);
    uvec4 sum = loadRow(kRowRadiance, work.path);
    if (work.facing && slot == kNone && !occluded) {
        storeRow(kRowRadiance, work.path,
                 packRow(uintBitsToFloat(sum.xyz) + uintBitsToFloat(throughput.xyz) * radiance, sum.w));
    }
    // Not stored where nobody reads what would change (packet_intersect.comp says what a store costs).
    if (work.live && (MODE_AOVS || MODE_COST || MODE_RESUME || slot != kNone)) {
        uvec4 walkRow = loadWalkRow(work.path);
        uint shadowBit = occluded && dispatch.bounce == 0u && dispatch.lightIndex < kShadowBits
                             ? 1u << dispatch.lightIndex
                             : 0u;
        storeRow(kRowWalk, work.path,
                 uvec4(slot, walkRow.y, walkRow.z + traversal.cost, walkRow.w | shadowBit));
        if (FEATURE_INSTANCES)
            storeInstanceRow(work.path,
                             uvec4(loadInstanceRow(work.path).xy, traversal.instance, traversal.worldSlot));
    }
    if (work.live && slot != kNone) atomicAdd(counters[kCounterUnfinished], 1u);
}

#ifdef GLINT_PACKET
// A path that hit nothing, or ended before, has nothing to light.
bool mayHaveRay(uint path) { return loadRow(kRowHit, path).w != kNone; }

void onePacket(uint turn) {
    LightWork works[GLINT_PACKET_RAYS];
    GLINT_EACH_RAY {
        bool present;
        uint path = packetPath(turn, r, present);
        uvec2 place;
        begin(path, present, works[r], packet[r], place);
    }
    bool complete = tracePacket(loadEnvironment(0u));
    GLINT_EACH_RAY end(works[r], packet[r], complete ? kNone : 0u);
}

void main() {
    uint turn = 0u;
    do {
        onePacket(nextPacket(turn));
    } while (turn < kPacketTurns);
}
#else
void main() {
    LightWork work;
    Traversal traversal;
    uvec2 place;
    bool present;
    uint path = listedPath(present);
    uint slot = begin(path, present, work, traversal, place);
    slot = trace(traversal, loadEnvironment(0u), slot, place);
    end(work, traversal, slot);
}
#endif
