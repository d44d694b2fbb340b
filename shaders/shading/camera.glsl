// Camera rays (Shirley & Marschner, Fundamentals of Computer Graphics, ch. 4) of a pixel's samples
// (docs/guide/sampling.md). The host computes the steps of every kind of camera (shared/layout.h).
#ifndef GLINT_CAMERA_GLSL
#define GLINT_CAMERA_GLSL

#include "traversal/ray.glsl"

// ---- Samples ----

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

// Pixels from the left (upper) edge, exact: all numbers here have fewer than 24 bits.
float filmOffset(uint place, uint table) {
    uint cell = place >> kFilterCellShift;
    uvec4 row = samplesArrayRow(table * kFilterRows + (cell >> 1));
    ivec2 ends = ivec2((cell & 1u) == 0u ? row.xy : row.zw);
    int fraction = int((place >> (kFilterCellShift - 12u)) & 4095u);
    int distance = ends.x + (((ends.y - ends.x) * fraction) >> 12);
    return 0.5 + float(distance) * (1.0 / float(1u << kFilterBits));
}

// The concentric map of the square onto the unit disc (P. Shirley, K. Chiu, "A Low Distortion Map Between
// Disk and Square", JGT 2(3), 1997). For angles up to pi/4, Taylor's polynomials err by at most 1.8e-9 and
// 2.5e-8; Vulkan's sin and cos by 2^-11.
vec2 concentricDisc(uvec2 place) {
    vec2 p = vec2(ivec2(place >> 8) - (1 << 23)) * (1.0 / float(1 << 23));
    bool wide = abs(p.x) > abs(p.y);
    float radius = wide ? p.x : p.y;
    precise float angle = radius == 0.0 ? 0.0 : 0.78539816339 * quotient(wide ? p.y : p.x, radius);
    precise float q = angle * angle;
    precise float sine =
        angle * (1.0 + q * (-1.0 / 6.0 + q * (1.0 / 120.0 + q * (-1.0 / 5040.0 + q * (1.0 / 362880.0)))));
    precise float cosine = 1.0 + q * (-0.5 + q * (1.0 / 24.0 + q * (-1.0 / 720.0 + q * (1.0 / 40320.0))));
    return radius * (wide ? vec2(cosine, sine) : vec2(sine, cosine));
}

// ---- Rays ----

// The ray of the current sample through a pixel, and its weight.
Ray cameraRay(uvec2 pixel, out vec3 weight) {
    Camera camera = loadCamera(0u);
    vec2 offset = dispatch.sampleOffset.xy;
    weight = vec3(1.0);
    vec2 lens = vec2(0.0);
    if (MODE_SCATTERED) {
        Sample s = loadSample(kFirstSample + dispatch.sampleIndex);
        uvec2 film = samplePair(s, pixel, kPairFilm);
        offset = vec2(filmOffset(film.x, s.tableX), filmOffset(film.y, s.tableY));
        weight = s.weight;
        if (FEATURE_THIN_LENS) lens = concentricDisc(samplePair(s, pixel, kPairLens));
    }
    // Measured from the picture's centre: the offsets are small where a telephoto lens needs them exact.
    precise float x = (float(pixel.x) - camera.halfWidth) + offset.x;
    precise float y = (float(pixel.y) - camera.halfHeight) + offset.y;
    precise vec3 direction = camera.center + (x * camera.stepX + y * camera.stepY);
    precise vec3 origin = camera.eye;
    if (FEATURE_PARALLEL_CAMERA) origin += x * camera.originStepX + y * camera.originStepY;
    if (FEATURE_THIN_LENS) {
        precise vec3 aside = lens.x * camera.lensX + lens.y * camera.lensY;
        origin += aside;
        direction -= camera.inverseFocus * aside;
    }
    return Ray(origin, quotient(direction, length(direction)), camera.nearT, camera.farT, kNone, kNone);
}

#endif
