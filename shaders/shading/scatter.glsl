// Scattering of light at a surface: the materials of light.comp, shade.comp and shading/tree.glsl. The
// reference's version is src/reference/scatter.cpp; the formulas are those of docs/reference/shading.md.
#ifndef GLINT_SCATTER_GLSL
#define GLINT_SCATTER_GLSL

#include "shading/optics.glsl"

float greatestOf(vec3 v) { return max(v.x, max(v.y, v.z)); }

// The end of a ray, at a surface or outside of the scene.
struct Interaction {
    Ray ray;
    Hit hit;
    bool isHit;         // false: the ray has left the scene; of the rest only `crossing` means anything
    bool entering;      // the ray comes from the outer side
    Surface surface;    // its normals are turned against the ray
    Material material;  // times its textures
    Crossing crossing;  // with FEATURE_TRANSMISSION alone
};

// media: those that the ray is in (loadMedia).
Interaction interactionAt(Ray ray, Hit hit, uvec4 media) {
    Interaction at;
    at.ray = ray;
    at.hit = hit;
    at.isHit = hit.primitive != kNone;
    at.surface = surfaceAt(ray, at.hit, true);
    at.entering = !(dot(at.surface.geometricNormal, ray.direction) > 0.0);
    faceForward(at.surface, ray.direction);
    at.material = materialAt(at.surface);
    if (FEATURE_TRANSMISSION)
        at.crossing = crossingAt(media, at.isHit ? at.material.medium : 0u, at.entering);
    return at;
}

// False for a surface inside a medium of greater priority: light passes as if it were not there.
bool counts(Interaction at) { return !FEATURE_TRANSMISSION || at.crossing.counts; }

// Transmittance of the medium along the ray.
vec3 transmittanceOfWay(Interaction at) {
    return transmittance(at.crossing.mediumBefore, at.isHit ? at.hit.t : kInfinity);
}

// ---- Light that the surface sends back along the ray ----

vec3 ambientAt(Interaction at, Environment environment) {
    return counts(at) ? at.material.ambient * environment.ambient : vec3(0.0);
}

// Light that needs no ray to a light: ambient light, or that of the surroundings.
vec3 ownLight(Interaction at, Environment environment) {
    return at.isHit ? ambientAt(at, environment) : surroundings(environment, at.ray.direction);
}

// Samples that hit anything. The throughput of a camera ray is its sample's weight.
uint hitsAfter(uint hits, bool covers, float throughput) {
    if (MODE_SCATTERED) return covers ? floatBitsToUint(uintBitsToFloat(hits) + throughput) : hits;
    return hits + (covers ? 1u : 0u);
}

// The part of the light from `toLight`, a unit vector: Lambert's law, and the highlight of Blinn (J. Blinn,
// "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977).
vec3 evaluate(Interaction at, vec3 toLight) {
    vec3 part = at.material.diffuse * max(dot(at.surface.shadingNormal, toLight), 0.0);
    if (FEATURE_SPECULAR) {
        vec3 sum = toLight + -at.ray.direction;
        float size = length(sum);
        float cosine = quotient(dot(at.surface.shadingNormal, sum), max(size, 1e-30));
        float shininess = at.material.shininess;
        float power = shininess == 0.0 ? 1.0 : powerOf(clamp(cosine, 0.0, 1.0), shininess);
        if (size > 0.0 && cosine > 0.0) part += at.material.specular * power;
    }
    return part;
}

// ---- Further rays (T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980) ----

// Transmission of a surface of this medium.
vec3 transmissionAt(uint medium, Surface surface) {
    Optics optics = opticsOf(medium);
    return FEATURE_TEXTURED_GLASS ? optics.transmission * textureAt(optics.transmissionTexture, surface).xyz
                                  : optics.transmission;
}

// A reflected ray, on the ray's side of the surface, and a refracted one, on the other. Directions are unit
// vectors; what the rays bring counts by their weights.
struct Scattering {
    bool reflects;
    bool refracts;
    vec3 reflected;
    vec3 refracted;
    vec3 reflectedWeight;
    vec3 refractedWeight;
};

// Scattering at a surface that is no dielectric.
Scattering mirrorAt(Interaction at) {
    Scattering s;
    s.reflects = at.isHit && greatestOf(at.material.mirror) > 0.0;
    s.refracts = false;
    s.reflected = mirrored(at.surface, at.ray.direction);
    s.refracted = at.ray.direction;
    s.reflectedWeight = at.material.mirror;
    s.refractedWeight = vec3(0.0);
    return s;
}

Scattering scatteringAt(Interaction at) {
    Scattering s = mirrorAt(at);
    if (FEATURE_TRANSMISSION) {
        bool dielectric = at.material.medium != 0u;
        float eta = quotient(iorOf(at.crossing.mediumBefore), iorOf(at.crossing.mediumAfter));
        bool splits = dielectric && at.crossing.counts && eta != 1.0;
        Split split = splitAt(at.surface, at.ray.direction, splits ? eta : 1.0);
        s.reflects = at.isHit && at.crossing.counts && (splits || s.reflects);
        s.refracts = at.isHit && dielectric && !split.total;
        s.reflected = splits ? split.reflected : s.reflected;
        s.refracted = split.refracted;
        s.reflectedWeight =
            splits ? min(at.material.mirror + split.reflectance, vec3(1.0)) : at.material.mirror;
        s.refractedWeight = at.crossing.counts
                                ? (1.0 - split.reflectance) * transmissionAt(at.material.medium, at.surface)
                                : vec3(1.0);
    }
    return s;
}

#endif
