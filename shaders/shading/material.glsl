// The material of a surface point, times textures and vertex colours; the light of the surroundings;
// dielectrics: the media that a ray is in, what a surface makes of them, Snell's law and Fresnel's
// reflectance (docs/reference/shading.md).
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
            vec3 color = textureAt(number, surface);
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
    if (FEATURE_ENVIRONMENT_MAP && environment.map != 0u) {
        Texture map = loadTexture(environment.map - 1u);
        precise vec2 uv = latitudeLongitude(vec3(direction.xy, -direction.z)) + map.place.xy;
        radiance *= imageAt(map, uv).xyz;
    }
    return radiance;
}

// True where the diffuse texture's alpha is below the material's alphaCutoff.
bool holeAt(Surface surface) {
    Material material = loadMaterial(surface.material);
    uint number = material.alphaCutoff > 0.0 ? material.diffuseTexture : 0u;
    Texture image = loadTexture(max(number, 1u) - 1u);
    bool masks = number != 0u && !(FEATURE_CHECKERS && (image.flags & kTextureChecker) != 0u);
    return masks && imageAt(image, scaledUv(image, surface.uv)).w < material.alphaCutoff;
}

// ---- Dielectrics ----

// Optics of a medium, numbered as in Material::medium. The result for 0, air, is arbitrary.
Optics opticsOf(uint medium) { return loadOptics(medium == 0u ? 0u : medium - 1u); }

float iorOf(uint medium) { return medium == 0u ? 1.0 : opticsOf(medium).ior; }
vec3 attenuationOf(uint medium) { return medium == 0u ? vec3(0.0) : opticsOf(medium).attenuation; }

// ---- Lists of media: oldest first, 0 where they have ended ----

void prefer(uint medium, inout uint best, inout uint bestRank) {
    uint rank = medium == 0u ? 0u : opticsOf(medium).rank;
    bool better = medium != 0u && rank >= bestRank;
    best = better ? medium : best;
    bestRank = better ? rank : bestRank;
}

// The medium that counts among overlapping ones: the greatest priority, then the last entered (C. Schmidt,
// B. Budge, "Simple Nested Dielectrics in Ray Traced Images", Journal of Graphics Tools 7(2), 2002).
uint rulingMedium(uvec4 media) {
    uint best = 0u;
    uint bestRank = 0u;
    prefer(media.x, best, bestRank);
    prefer(media.y, best, bestRank);
    prefer(media.z, best, bestRank);
    prefer(media.w, best, bestRank);
    return best;
}

// Unchanged if the list is full.
uvec4 withMedium(uvec4 media, uint medium) {
    bvec4 full = notEqual(media, uvec4(0u));
    return uvec4(full.x ? media.x : medium, full.y ? media.y : (full.x ? medium : 0u),
                 full.z ? media.z : (full.y ? medium : 0u), full.w ? media.w : (full.z ? medium : 0u));
}

// Without the last entry that is `medium`.
uvec4 withoutMedium(uvec4 media, uint medium) {
    bvec4 same = equal(media, uvec4(medium));
    uint at = same.w ? 3u : (same.z ? 2u : (same.y ? 1u : (same.x ? 0u : 4u)));
    return uvec4(at == 0u ? media.y : media.x, at <= 1u ? media.z : media.y, at <= 2u ? media.w : media.z,
                 at <= 3u ? 0u : media.w);
}

struct Crossing {
    uvec4 before;       // media on the ray's side of the surface
    uvec4 after;        // and behind it
    uint mediumBefore;  // those that rule there
    uint mediumAfter;
    bool counts;   // false: inside a medium of greater priority, which the ray crosses as if not there
    bool crowded;  // the list was full
};

// medium: the surface's, or 0. A ray that leaves a medium that it has not entered was in it from its start.
Crossing crossingAt(uvec4 media, uint medium, bool entering) {
    bool known = any(equal(media, uvec4(medium)));
    bool full = media.w != 0u;
    Crossing c;
    c.before = medium != 0u && !entering && !known ? withMedium(media, medium) : media;
    c.after = medium == 0u ? media : (entering ? withMedium(media, medium) : withoutMedium(c.before, medium));
    c.mediumBefore = rulingMedium(c.before);
    c.mediumAfter = rulingMedium(c.after);
    c.counts = medium == 0u || c.mediumBefore != c.mediumAfter;
    c.crowded = medium != 0u && full && (entering || !known);
    return c;
}

// Transmittance over the length `way` by the law of A. Beer (1852).
vec3 transmittance(uint medium, float way) {
    if (!FEATURE_ATTENUATION) return vec3(1.0);
    vec3 attenuation = attenuationOf(medium);
    // exp(-120) is no normal float.
    vec3 left = exponential(-min(attenuation * min(way, kInfinity), vec3(120.0)));
    return mix(left, vec3(1.0), equal(attenuation, vec3(0.0)));
}

// ---- Reflection and refraction ----

struct Split {
    vec3 reflected;     // unit
    vec3 refracted;     // unit; meaningless if total
    float reflectance;  // of unpolarised light; 1 if total
    bool total;         // total internal reflection
};

// About the unit normal m, m.d < 0, with eta the refractive index on d's side over that on the other (Born &
// Wolf, Principles of Optics, sec. 1.5.2; Pharr, Jakob, Humphreys, PBRT 4th ed., sec. 9.3). sin^2 from (1 -
// c)(1 + c): 1 - c^2 has nothing left of a small angle's.
Split splitAbout(vec3 m, vec3 d, float eta) {
    precise float c = min(-dot(d, m), 1.0);
    precise float sinSquare = (1.0 - c) * (1.0 + c);
    precise float sinSquareAfter = (eta * eta) * sinSquare;
    precise float cAfter = squareRoot(max(1.0 - sinSquareAfter, 0.0));
    precise float along = quotient(c - eta * cAfter, c + eta * cAfter);
    precise float across = quotient(eta * c - cAfter, eta * c + cAfter);
    precise vec3 reflected = d + (2.0 * c) * m;
    precise vec3 refracted = eta * d + (eta * c - cAfter) * m;
    bool total = sinSquareAfter >= 1.0;
    float reflectance = total ? 1.0 : 0.5 * (along * along + across * across);
    return Split(quotient(reflected, length(reflected)), quotient(refracted, length(refracted)), reflectance,
                 total);
}

// Normals turned against d. About the geometric normal if the shading normal sent a branch to the wrong side.
Split splitAt(Surface surface, vec3 d, float eta) {
    Split s = splitAbout(surface.shadingNormal, d, eta);
    if (kHasShadingNormals) {
        bool sound = dot(d, surface.shadingNormal) < 0.0 && dot(s.reflected, surface.geometricNormal) > 0.0 &&
                     (s.total || dot(s.refracted, surface.geometricNormal) < 0.0);
        Split flatSplit = splitAbout(surface.geometricNormal, d, eta);
        if (!sound) s = flatSplit;
    }
    if (eta == 1.0) s = Split(s.reflected, d, 0.0, false);
    return s;
}

// The mirrored direction; about the geometric normal if the shading normal sent it through the surface.
vec3 mirrored(Surface surface, vec3 direction) {
    precise vec3 r = direction - 2.0 * dot(direction, surface.shadingNormal) * surface.shadingNormal;
    precise vec3 aboutNormal =
        direction - 2.0 * dot(direction, surface.geometricNormal) * surface.geometricNormal;
    vec3 chosen = dot(r, surface.geometricNormal) > 0.0 ? r : aboutNormal;
    return quotient(chosen, length(chosen));
}

// ---- Shadow rays ----

// Light that a shadow ray keeps on its straight way through dielectrics. The optical depth is a sum over the
// surfaces that the ray crosses, in any order, so the traversal may be resumed anywhere. The way inside a
// medium is the sum of t over the surfaces where the ray leaves it less that over those where it enters, and
// all the way to a light inside. 1 - t would lose ways that are short beside that.
struct Passage {
    vec3 depth;   // optical depth so far, without the media around the light
    vec3 around;  // attenuation by the media that the ray is in at the light, as far as they are known
    float terms;  // sum of the magnitudes in `around`
    float reach;  // length of the way to the light, 0 if it is infinitely far away
};

// Attenuation by the media that a ray starts in, per unit of its length.
vec3 attenuationAround(uvec4 media) {
    if (!FEATURE_ATTENUATION) return vec3(0.0);
    return attenuationOf(media.x) + attenuationOf(media.y) + attenuationOf(media.z) + attenuationOf(media.w);
}

// False if the surface is opaque. leaving: the ray comes from the inner side. counts: not another triangle of
// the edge that it hits.
bool passes(inout Passage passage, Surface surface, bool leaving, bool counts, float t) {
    uint medium = loadMaterial(surface.material).medium;
    Optics optics = opticsOf(medium);
    vec3 depth = optics.density;
    if (FEATURE_TEXTURED_GLASS && optics.transmissionTexture != 0u)
        depth -= logarithm(textureAt(optics.transmissionTexture, surface));
    bool crossed = medium != 0u && counts;
    if (FEATURE_ATTENUATION && crossed) {
        vec3 entered = leaving ? -optics.attenuation : optics.attenuation;
        depth -= entered * (passage.reach > 0.0 ? t * passage.reach : t);
        passage.around += entered;
        passage.terms += greatestComponent(optics.attenuation);
    }
    if (crossed) passage.depth += depth;
    return medium != 0u;
}

vec3 lightThrough(Passage passage) {
    // Up to 16 sums that cancel leave less than 2^-20 of their terms.
    bvec3 real = greaterThan(abs(passage.around), vec3(9.5367431640625e-7 * passage.terms));
    vec3 depth = passage.depth + passage.reach * mix(vec3(0.0), passage.around, real);
    return mix(exponential(-max(depth, vec3(0.0))), vec3(1.0), equal(depth, vec3(0.0)));
}

#endif
