// The material of a surface point: what the scene says, times textures and vertex colours; and the light of
// the surroundings.
#ifndef GLINT_MATERIAL_GLSL
#define GLINT_MATERIAL_GLSL

#include "shading/surface.glsl"

const bool kHasTextures = FEATURE_TEXTURES || FEATURE_CHECKERS;

// Each texture of a material is looked up once, whatever it is for: mostly there is a single one, and a loop
// has its code once where four look-ups in a row took the drivers' compilers seconds. All that changes stands
// in an `if`: see the loops of docs/design/traversal.md.
void applyTextures(Surface surface, inout Material material) {
    uvec4 left = uvec4(material.ambientTexture, material.diffuseTexture,
                       FEATURE_SPECULAR ? material.specularTexture : 0u,
                       FEATURE_MIRRORS ? material.mirrorTexture : 0u);
    bool looking = any(notEqual(left, uvec4(0u)));
    do {
        if (looking) {
            uint number = max(max(left.x, left.y), max(left.z, left.w));
            vec3 color = textureAt(number, surface).xyz;
            bvec4 here = equal(left, uvec4(number));
            if (here.x) material.ambient *= color;
            if (here.y) material.diffuse *= color;
            if (here.z) material.specular *= color;
            if (here.w) material.mirror *= color;
            left = mix(left, uvec4(0u), here);
            looking = any(notEqual(left, uvec4(0u)));
        }
    } while (looking);
}

Material materialAt(Surface surface) {
    Material material = loadMaterial(surface.material);
    if (kHasTextures) applyTextures(surface, material);
    if (FEATURE_VERTEX_COLORS) {
        material.ambient *= surface.color;
        material.diffuse *= surface.color;
    }
    return material;
}

// Background radiance against `direction`. shift: added to the environment map's coordinates. `environment`:
// the tracer's.
vec3 surroundings(Environment environment, vec3 direction) {
    vec3 radiance = environment.background;
    if (FEATURE_ENVIRONMENT_MAP) {
        uint number = environment.map;
        if (number != 0u) {
            Texture map = loadTexture(number - 1u);
            precise vec2 uv = latitudeLongitude(vec3(direction.xy, -direction.z)) + map.place.xy;
            radiance *= imageAt(map, uv).xyz;
        }
    }
    return radiance;
}

// True where the diffuse texture's alpha is below the material's alphaCutoff.
bool holeAt(Surface surface) {
    Material material = loadMaterial(surface.material);
    uint number = material.alphaCutoff > 0.0 ? material.diffuseTexture : 0u;
    return textureAt(number, surface).w < material.alphaCutoff;
}

// A surface that a traversal hits and may pass through.
struct Met {
    Surface surface;  // with its material and, with textures, where it is in the world
    bool leaving;     // the ray comes from the inner side
};

// True if a ray that hits a surface of this kind comes from the inner side. Where sides count (kTellsSides),
// round primitives return the side themselves, and need no normal.
const bool kSpheresTell = kTellsSides && SPHERE_FORM == kSphereRobust;
bool leavesThrough(uint kind, Hit hit, Surface surface, vec3 direction) {
    bool told = (kSpheresTell && kind == kKindSphere) || (kTellsSides && kind == kKindQuadric);
    return told ? hit.u == kLeaves : dot(surface.geometricNormal, direction) > 0.0;
}

// The surface of what is met, in the coordinates of the primitive, as a walk looks at it. What the walk has
// of the hit is not exchanged yet, see surfaceOfTriangle: so it is looked at as of no instance.
Hit asOfNoInstance(Hit hit) { return Hit(hit.t, hit.u, hit.v, hit.primitive, kNone, 0u); }

// Takes what is met out of the coordinates of the primitive.
void finishMet(uint kind, Hit hit, inout Met met) {
    if (FEATURE_INSTANCES) {
        bool inInstance = hit.instance != kNone;
        Instance instance = loadInstance(inInstance ? hit.instance : 0u);
        if (inInstance) {
            if (instance.material != kNone) met.surface.material = instance.material;
            met.surface.object = instance.object;
            leaveInstance(instance, met.surface.position, met.surface.error);
            met.surface.geometricNormal = normalInWorld(instance, met.surface.geometricNormal);
        }
    }
    fillObjectUv(kind, met.surface);
}

Met metAt(Ray ray, uint kind, Hit hit) {
    Met met;
    Instance none;
    met.surface = surfaceOfKind(kind, ray, asOfNoInstance(hit), none, FEATURE_OPEN_PLANES);
    met.leaving = leavesThrough(kind, hit, met.surface, ray.direction);
    finishMet(kind, hit, met);
    return met;
}

#endif
