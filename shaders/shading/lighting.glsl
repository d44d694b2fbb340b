// Light of the scene's lights at a hit: a shadow ray to each, then Lambert and Blinn-Phong (Blinn 1977;
// Whitted 1980). Needs Traversal, of traversal/stack.glsl or packet/packet.glsl with GLINT_SHADOW_RAYS.
#ifndef GLINT_LIGHTING_GLSL
#define GLINT_LIGHTING_GLSL

#include "shading/scatter.glsl"

const bool kHasNearLights = FEATURE_POINT_LIGHTS || FEATURE_SPOT_LIGHTS;  // at a finite distance
const bool kHasLights = kHasNearLights || FEATURE_DIRECTIONAL_LIGHTS;

struct LightSample {
    vec3 toLight;    // shadow ray direction: from the surface to the light, unnormalised for a point light
    vec3 direction;  // unit
    vec3 intensity;  // with falloff
    float tMax;      // of the shadow ray
    bool valid;
};

// The part of a spot light's intensity opposite to the unit vector `toLight`: a smoothstep of the cosine.
// |axis + toLight|^2 / 2 is 1 - cos without cancellation, at most 2, so that a cone of 180 degrees has no
// hole at its back.
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
    uint kind = light.kind & kLightKindMask;
    if (kHasNearLights && kind != kLightDirectional) {
        precise vec3 toLight = light.position - position;
        float distance = length(toLight);
        s.toLight = toLight;
        s.direction = quotient(toLight, distance);
        s.tMax = kShadowEnd;
        s.valid = distance > kNearestLight;
        if ((light.kind & kLightFades) != 0u)
            s.intensity = quotient(quotient(light.intensity, distance), distance);
    }
    if (FEATURE_SPOT_LIGHTS && kind == kLightSpot) {
        float factor = spotFactor(light, s.direction);
        s.intensity *= factor;
        s.valid = s.valid && factor > 0.0;
    }
    return s;
}

const bool kFiltered = FEATURE_COLORED_SHADOWS && !MODE_SHADOWLESS;

// State that a path keeps from one light to the next.
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
    vec3 around;         // attenuationAround, the same for all lights
    uint shadowBits;
};

// sum: the path's row kRowRadiance.
Lit litAt(uint path, bool live, Interaction at, uvec4 sum, vec3 throughput) {
    Lit lit;
    lit.path = path;
    lit.at = at;
    lit.live = live && at.isHit && counts(at);
    lit.changed = false;
    Surface surface = lit.at.surface;
    lit.origin = offsetOrigin(surface.position, surface.error, surface.geometricNormal);
    lit.radiance = uintBitsToFloat(sum.xyz);
    lit.hits = sum.w;
    lit.throughput = throughput;
    if (FEATURE_TRANSMISSION) lit.transmittance = transmittanceOfWay(lit.at);
    if (kFiltered) lit.around = attenuationAround(lit.at.crossing.before);
    lit.shadowBits = 0u;
    return lit;
}

// A light from a point of the path.
struct Sight {
    bool facing;    // the light shines on the seen side, and its shadow ray is needed
    vec3 radiance;  // that the light adds if nothing hides it, before the path's throughput
};
const Sight kNoSight = Sight(false, vec3(0.0));

// A ray whose light would add nothing is not traced, as on pure mirrors and dielectrics. Images with AOVs
// need hidden lights, and counts of rays include these.
const bool kTracesAllShadows = MODE_AOVS || MODE_COST || MODE_TALLY;

// Makes the path's shadow ray to a light. begins: it has not been traced in part.
Sight aim(Lit lit, uint index, bool begins, inout Traversal traversal) {
    LightSample light = sampleLight(loadLight(index), lit.at.surface.position);
    vec3 radiance = evaluate(lit.at, light.direction) * light.intensity;
    if (FEATURE_TRANSMISSION) radiance *= lit.transmittance;
    bool adds = kTracesAllShadows || any(notEqual(lit.throughput * radiance, vec3(0.0)));
    Sight sight = Sight(false, radiance);
    sight.facing = lit.live && light.valid && adds &&
                   dot(lit.at.surface.geometricNormal, light.direction) > kLeastCosine &&
                   dot(lit.at.surface.shadingNormal, light.direction) > kLeastCosine;
    traversal.ray = Ray(lit.origin, light.toLight, 0.0, sight.facing && !MODE_SHADOWLESS ? light.tMax : -1.0,
                        sourceOf(lit.at, false), lit.at.hit.instance);
    traversal.hit = Hit(kInfinity, 0.0, 0.0, kNone, kNone, kNone);
    if (kFiltered) {
        float reach = light.tMax < kInfinity ? length(light.toLight) : 0.0;
        traversal.passage = Passage(vec3(0.0), lit.around, greatestComponent(lit.around), reach);
        if (MODE_RESUME && !begins) {
            uvec4 row = loadRow(treeRow(kTreeRowShadow), lit.path);
            vec3 around = uintBitsToFloat(loadRow(treeRow(kTreeRowAround), lit.path).xyz);
            traversal.passage = Passage(uintBitsToFloat(row.xyz), around, uintBitsToFloat(row.w), reach);
        }
    }
    if (MODE_TALLY && !MODE_SHADOWLESS && sight.facing && begins) atomicAdd(counters[kCounterShadow], 1u);
    return sight;
}

// Takes what the light adds, once its shadow ray is finished.
void take(inout Lit lit, uint index, Sight sight, Traversal traversal, bool finished) {
    bool occluded = traversal.hit.primitive != kNone;
    vec3 radiance = sight.radiance;
    if (kFiltered) radiance *= lightThrough(traversal.passage);
    bool added = sight.facing && finished && !occluded;
    if (added) lit.radiance += lit.throughput * radiance;
    lit.changed = lit.changed || added;
    if (sight.facing && occluded && dispatch.bounce == 0u && index < kShadowBits)
        lit.shadowBits |= 1u << index;
}

#endif
