// The material of a surface point, times textures and vertex colours; the light of the surroundings.
#ifndef GLINT_MATERIAL_GLSL
#define GLINT_MATERIAL_GLSL

#include "shading/surface.glsl"

const bool kHasTextures = FEATURE_TEXTURES || FEATURE_CHECKERS;

// Each texture of a material is looked up once. A loop has the code once: four look-ups in a row took
// drivers' compilers seconds. All changes are in an `if`: see the loops of docs/design/traversal.md.
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

// Background radiance against `direction`.
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

#endif
