// The random points of a pixel's samples (docs/guide/sampling.md).
#ifndef GLINT_SAMPLING_GLSL
#define GLINT_SAMPLING_GLSL

#include "storage.glsl"

// M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020, listing of pcg4d.
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Owen's scrambling (1995) by a hash in which only the bits above a bit decide whether it flips: B. Burley,
// "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, after Laine and Karras 2011, with N. Vegdahl's
// constants.
uvec2 owenScrambled(uvec2 x, uvec2 seed) {
    x = bitfieldReverse(x);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return bitfieldReverse(x);
}

// The sample's point on the film (kPairFilm) or the lens (kPairLens) for this pixel, in units of 2^-32. `s`
// has both before they are scattered.
uvec2 samplePair(Sample s, uvec2 pixel, uint pair) {
    bool lens = pair == kPairLens;
    uvec2 place = lens ? uvec2(s.lensX, s.lensY) : uvec2(s.x, s.y);
    if (s.scatter == kScatterJitter) {
        uvec4 hashed = pcg4d(uvec4(pixel, s.key, s.seed));
        uvec2 random = lens ? hashed.zw : hashed.xy;
        uvec2 within, fraction;
        uvec2 width = lens ? uvec2(s.widthLensX, s.widthLensY) : uvec2(s.widthX, s.widthY);
        umulExtended(random, width, within, fraction);
        place += within;
        if (lens) place += pcg4d(uvec4(pixel, kLensKey, s.seed)).zw;
    }
    if (s.scatter == kScatterOwen) {
        uvec4 seeds = pcg4d(uvec4(pixel, s.key, s.seed));
        // Their lowest bits decide most, and pcg4d's results are random in their highest: without the shift,
        // places in neighbouring pixels correlate (docs/lab/accuracy.md).
        seeds ^= seeds >> 16u;
        place = owenScrambled(place, lens ? seeds.zw : seeds.xy);
    }
    return place;
}

#endif
