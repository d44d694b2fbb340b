// Light that a shadow ray keeps on its way through dielectrics: straight on, without refraction. The optical
// depth is a sum over the surfaces that the ray crosses. Their order does not matter, so the traversal of the
// BVH may be cut and resumed anywhere.
#ifndef GLINT_PASSAGE_GLSL
#define GLINT_PASSAGE_GLSL

#include "shading/material.glsl"
#include "shading/optics.glsl"

struct Passage {
    vec3 depth;   // optical depth so far
    float reach;  // t of the light, 0 for one infinitely far away
    float scale;  // length of a unit of t
    bool counts;  // of the triangle at hand: crossesOnce
};

// Attenuation by the media that a ray starts in, per unit of its length.
vec3 attenuationAround(uvec4 media) {
    if (!FEATURE_ATTENUATION) return vec3(0.0);
    return attenuationOf(media.x) + attenuationOf(media.y) + attenuationOf(media.z) + attenuationOf(media.w);
}

// The way inside a medium is the sum of t over the surfaces where the ray leaves it less that over those
// where it enters; a light that is itself inside is a last one where it leaves, so every t is counted from
// the light. around: of the media that the ray starts in.
Passage startPassage(vec3 around, float reach, float scale) {
    Passage passage = Passage(vec3(0.0), reach, scale, true);
    if (FEATURE_ATTENUATION) passage.depth = around * (reach * scale);
    return passage;
}

// False if the surface is opaque. kind, t: of the hit.
bool passes(inout Passage passage, Met met, uint kind, float t) {
    uint medium = loadMaterial(met.surface.material).medium;
    Optics optics = opticsOf(medium);
    vec3 depth = optics.density;
    if (FEATURE_TEXTURED_GLASS && optics.transmissionTexture != 0u)
        depth -= logarithm(max(textureAt(optics.transmissionTexture, met.surface).xyz, vec3(1e-30)));
    if (FEATURE_ATTENUATION) {
        float way = (passage.reach - t) * passage.scale;
        depth += optics.attenuation * (met.leaving ? -way : way);
    }
    if (medium != 0u && (kind != kKindTriangle || passage.counts)) passage.depth += depth;
    return medium != 0u;
}

vec3 lightThrough(Passage passage) {
    return mix(exponential(-max(passage.depth, vec3(0.0))), vec3(1.0), equal(passage.depth, vec3(0.0)));
}

#endif
