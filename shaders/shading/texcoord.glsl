// Texture coordinates (u, v) of surface points and directions (docs/reference/shading.md, texture
// coordinates).
#ifndef GLINT_TEXCOORD_GLSL
#define GLINT_TEXCOORD_GLSL

#include "shared/shading.h"
#include "storage.glsl"

// The angle of (x, y) from the x axis in turns, in [-0.5, 0.5]; 0 for (0, 0). Not by atan(), which Vulkan
// lets be off by 4096 ulp: Hastings' polynomial (Abramowitz & Stegun, Handbook of Mathematical Functions,
// 1964, 4.4.49) for the octant, |error| <= 2e-8 radians. A division good to 2.5 ulp, and a unit each for the
// nine steps of the sum, weighted by what they add, come to no more than 12 units of 2^-24 of at most 1/8
// turn; the subtractions from 1/4 and 1/2 round to 2^-26. Together: below 2^-23 turns.
float turnsOf(float y, float x) {
    float ax = abs(x);
    float ay = abs(y);
    float longer = ax > ay ? ax : ay;
    float shorter = ax > ay ? ay : ax;
    precise float r = longer > 0.0 ? quotient(shorter, longer) : 0.0;
    precise float s = r * r;
    precise float sum = 0.0028662257 * s - 0.0161657367;
    sum = sum * s + 0.0429096138;
    sum = sum * s - 0.0752896400;
    sum = sum * s + 0.1065626393;
    sum = sum * s - 0.1420889944;
    sum = sum * s + 0.1999355085;
    sum = sum * s - 0.3333314528;
    sum = sum * s + 1.0;
    precise float turns = r * sum * 0.159154943;
    precise float quarter = ay > ax ? 0.25 - turns : turns;
    precise float half_ = x < 0.0 ? 0.5 - quarter : quarter;
    return y < 0.0 ? -half_ : half_;
}

// Latitude and longitude of a direction of any length, y up: u = 1/2 at +z, growing towards +x; v = 0
// straight down, 1 straight up.
vec2 latitudeLongitude(vec3 d) {
    precise float ring = squareRoot(d.x * d.x + d.z * d.z);
    precise float u = 0.5 + turnsOf(d.x, d.z);
    precise float v = 0.5 + 2.0 * turnsOf(d.y, ring);
    return vec2(u, v);
}

// Texture coordinates of primitives other than triangles, by the object's frame (kUv...); (0, 0) in a scene
// without textures.
vec2 objectUv(uint object, vec3 position, vec3 outward) {
    vec2 uv = vec2(0.0);
    uint index = object < loadEnvironment(0u).frameCount ? object : kNone;
    if (index != kNone) {
        ObjectFrame frame = loadObjectFrame(index);
        precise vec3 direction =
            vec3(dot(frame.toObjectX, outward), dot(frame.toObjectY, outward), dot(frame.toObjectZ, outward));
        precise float u = dot(frame.toU, position) + frame.offsetU;
        precise float v = dot(frame.toV, position) + frame.offsetV;
        precise float w = dot(frame.toW, position) + frame.offsetW;
        bool axial = FEATURE_QUADRICS && frame.uvKind == kUvAxial;
        bool round_ = FEATURE_QUADRICS && frame.uvKind == kUvRound;
        vec2 around = latitudeLongitude(axial || round_ ? vec3(u, v, w) : direction);
        // A cap lies at 0 or 1 up to rounding: a repeated image would begin anew on one pixel of it and not
        // on the next.
        float height = clamp(v, 0.0, kBelowOne);
        uv = frame.uvKind == kUvFlat ? vec2(u, v) : vec2(around.x, axial ? height : around.y);
    }
    return uv;
}

// The weighted sum of three rows' components of a triangle's vertices.
float weigh(vec3 weights, vec3 values) {
    precise float sum = weights.x * values.x + weights.y * values.y + weights.z * values.z;
    return sum;
}

#endif
