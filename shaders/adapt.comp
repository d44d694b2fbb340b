#version 450
#extension GL_GOOGLE_include_directive : require
// After a sample: adds it to the pixel's film; after the last one of a round: does the pixel need another
// round? (docs/guide/sampling.md)
#include "path.glsl"

// A mean darker than this is judged as if it were this bright.
const float kDarkest = 0.125;

void main() {
    uint path = pathIndex();
    uvec2 pixel;
    bool first = dispatch.sampleIndex == 0u;
    bool takes = pixelOf(pixel);
    uvec4 film = uvec4(0u), mean = uvec4(0u), spread = uvec4(0u, 0u, 0u, takes ? 1u : 0u);
    if (!first) {
        film = loadRow(kRowFilm, path);
        mean = loadRow(kRowMean, path);
        spread = loadRow(kRowSpread, path);
        takes = spread.w == 1u;
    }
    uvec4 taken = loadRow(kRowRadiance, path);
    vec3 radiance = uintBitsToFloat(taken.xyz) / loadSample(kFirstSample + dispatch.sampleIndex).weight;
    // B. P. Welford, Technometrics 4(3), 1962.
    uint count = mean.w + 1u;
    vec3 difference = radiance - uintBitsToFloat(mean.xyz);
    vec3 newMean = uintBitsToFloat(mean.xyz) + difference / float(count);
    vec3 newSpread = uintBitsToFloat(spread.xyz) + difference * (radiance - newMean);
    vec3 bound = dispatch.threshold * max(newMean, vec3(kDarkest));
    vec3 errorSquared = newSpread / (float(count) * float(max(count, 2u) - 1u));
    bool goesOn = dispatch.lastOfRound == 0u || any(greaterThan(errorSquared, bound * bound));
    if (takes) {
        storeRow(kRowFilm, path,
                 packRow(uintBitsToFloat(film.xyz) + uintBitsToFloat(taken.xyz),
                         floatBitsToUint(uintBitsToFloat(film.w) + uintBitsToFloat(taken.w))));
        storeRow(kRowMean, path, packRow(newMean, count));
        storeRow(kRowSpread, path, packRow(newSpread, goesOn ? 1u : 0u));
        if (goesOn) atomicAdd(counters[kCounterFlagged], 1u);
    } else if (first) {
        storeRow(kRowMean, path, uvec4(0u));
        storeRow(kRowSpread, path, uvec4(0u));
    }
}
