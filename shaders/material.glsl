// The material of a surface point: what the scene says, times textures and vertex colours; and the light of
// the surroundings.
#ifndef GLINT_MATERIAL_GLSL
#define GLINT_MATERIAL_GLSL

#include "texture.glsl"

const bool kHasTextures = FEATURE_TEXTURES || FEATURE_CHECKERS;

Material materialAt(Surface surface) {
    Material material = loadMaterial(surface.material);
    if (kHasTextures) {
        material.ambient *= textureAt(material.ambientTexture, surface).xyz;
        material.diffuse *= textureAt(material.diffuseTexture, surface).xyz;
        if (FEATURE_SPECULAR) material.specular *= textureAt(material.specularTexture, surface).xyz;
        if (FEATURE_MIRRORS) material.mirror *= textureAt(material.mirrorTexture, surface).xyz;
    }
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
        while (number != 0u) {
            Texture map = loadTexture(number - 1u);
            precise vec2 uv = latitudeLongitude(vec3(direction.xy, -direction.z)) + map.place.xy;
            radiance *= imageAt(map, uv).xyz;
            number = 0u;
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

// `ray` is in the coordinates of the primitive. True if the hit is one, and not where the surface has a hole.
// A loop of one trip, see objectUv.
bool isThere(Ray ray, bool isHit, float t, float u, float v, uint primitive, uint instanceIndex) {
    bool hole = false;
    bool asking = isHit;
    while (asking) {
        Instance instance;
        bool inInstance = FEATURE_INSTANCES && instanceIndex != kNone;
        if (FEATURE_INSTANCES) instance = loadInstance(inInstance ? instanceIndex : 0u);
        uint kind = primitive >> kPrimitiveKindShift;
        // What the traversal has is not exchanged yet, see surfaceOfTriangle: so as of no instance.
        Surface surface = surfaceOfKind(kind, ray, Hit(t, u, v, primitive, kNone, 0u), instance);
        if (inInstance && instance.material != kNone) surface.material = instance.material;
        if (inInstance) surface.object = instance.object;
        if (inInstance) leaveInstance(instance, surface.position, surface.error);
        if (inInstance) surface.geometricNormal = normalInWorld(instance, surface.geometricNormal);
        fillObjectUv(kind, surface);
        hole = holeAt(surface);
        asking = false;
    }
    return isHit && !hole;
}

#endif
