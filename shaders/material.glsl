// The material of a surface point: what the scene says, times textures and vertex colours; and the light of
// the surroundings.
#ifndef GLINT_MATERIAL_GLSL
#define GLINT_MATERIAL_GLSL

#include "texture.glsl"

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

// What comes from infinitely far away against this unit direction: the background, or the environment map,
// whose middle column is seen along -z.
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

// `ray` is in the coordinates of the primitive, which is of this kind (a constant, so that the code for
// others is left out). True if the hit is one, and not where the surface has a hole.
bool isThere(Ray ray, bool isHit, uint kind, float t, float u, float v, uint primitive, uint instanceIndex) {
    bool hole = false;
    if (isHit) {
        Instance instance;
        bool inInstance = FEATURE_INSTANCES && instanceIndex != kNone;
        if (FEATURE_INSTANCES) instance = loadInstance(inInstance ? instanceIndex : 0u);
        // What the traversal has is not exchanged yet, see surfaceOfTriangle: so as of no instance.
        Surface surface = surfaceOfKind(kind, ray, Hit(t, u, v, primitive, kNone, 0u), instance);
        if (inInstance && instance.material != kNone) surface.material = instance.material;
        if (inInstance) surface.object = instance.object;
        if (inInstance) leaveInstance(instance, surface.position, surface.error);
        if (inInstance) surface.geometricNormal = normalInWorld(instance, surface.geometricNormal);
        fillObjectUv(kind, surface);
        hole = holeAt(surface);
    }
    return isHit && !hole;
}

#endif
