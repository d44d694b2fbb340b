// Camera rays (Shirley & Marschner, Fundamentals of Computer Graphics, ch. 4). The host computes the steps of
// every kind of camera (shared/layout.h).
#ifndef GLINT_CAMERA_GLSL
#define GLINT_CAMERA_GLSL

#include "shading/sampling.glsl"
#include "traversal/ray.glsl"

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
    // Measured from the image's centre: the offsets are small where a telephoto lens needs them exact.
    precise float x = (float(pixel.x) - camera.halfWidth) + offset.x;
    precise float y = (float(pixel.y) - camera.halfHeight) + offset.y;
    precise vec3 direction = camera.center + (x * camera.stepX + y * camera.stepY);
    precise vec3 origin = camera.eye;
    if (FEATURE_PARALLEL_CAMERA) origin += x * camera.originStepX + y * camera.originStepY;
    if (FEATURE_THIN_LENS) {
        precise vec3 aside = lens.x * camera.lensX + lens.y * camera.lensY;
        origin += aside;
        direction -= camera.inverseFocus * aside;
        direction *= unitOf(direction);
    }
    return Ray(origin, quotient(direction, length(direction)), camera.nearT, camera.farT, kNone, kNone);
}

#endif
