#version 450
#extension GL_GOOGLE_include_directive : require
// After a sample: adds it to the pixel's film; after the last one of a round: does the pixel need another
// round? (docs/guide/sampling.md)
#include "storage.glsl"

// True if the mean of `count` samples is uncertain. spread: sum of the squared differences of the samples
// from the mean.
bool needsMore(vec3 mean, vec3 spread, uint count) {
    vec3 bound = dispatch.threshold * max(mean, vec3(kDarkestMean));
    vec3 errorSquared = quotient(spread, float(count) * float(max(count, 2u) - 1u));
    return any(greaterThan(errorSquared, bound * bound));
}

void main() {
    uint path = pathIndex();
    uvec2 pixel;
    bool first = dispatch.sampleIndex == 0u;
    bool takes = pixelOf(path, pixel);
    uvec4 film = uvec4(0u), mean = uvec4(0u), spread = uvec4(0u, 0u, 0u, takes ? 1u : 0u);
    if (!first) {
        film = loadRow(kRowFilm, path);
        mean = loadRow(kRowMean, path);
        spread = loadRow(kRowSpread, path);
        takes = spread.w == 1u;
    }
    uvec4 taken = loadRow(kRowRadiance, path);
    vec3 radiance =
        quotient(uintBitsToFloat(taken.xyz), loadSample(kFirstSample + dispatch.sampleIndex).weight);
    // B. P. Welford, Technometrics 4(3), 1962.
    uint count = mean.w + 1u;
    vec3 difference = radiance - uintBitsToFloat(mean.xyz);
    vec3 newMean = uintBitsToFloat(mean.xyz) + quotient(difference, float(count));
    vec3 newSpread = uintBitsToFloat(spread.xyz) + difference * (radiance - newMean);
    bool goesOn = dispatch.lastOfRound == 0u || needsMore(newMean, newSpread, count);
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
