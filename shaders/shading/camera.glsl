// The camera's rays (Shirley & Marschner, Fundamentals of Computer Graphics, ch. 4). The host has worked
// every kind of camera into steps, see Camera in shared/layout.h.
#ifndef GLINT_CAMERA_GLSL
#define GLINT_CAMERA_GLSL

#include "traversal/ray.glsl"
#include "shading/sample.glsl"

// The ray of the sample at hand through a pixel, and what it counts by.
Ray cameraRay(uvec2 pixel, out vec3 weight) {
    Camera camera = loadCamera(0u);
    vec2 offset = dispatch.sampleOffset.xy;
    weight = vec3(1.0);
    vec2 lens = vec2(0.0);
    if (MODE_SCATTERED) {
        Sample s = loadSample(kFirstSample + dispatch.sampleIndex);
        uvec2 film = samplePair(s, dispatch.sampleIndex, pixel, kPairFilm);
        offset = vec2(filmOffset(film.x, s.tableX), filmOffset(film.y, s.tableY));
        weight = s.weight;
        if (FEATURE_THIN_LENS) lens = concentricDisc(samplePair(s, dispatch.sampleIndex, pixel, kPairLens));
    }
    // Measured from the picture's centre: the offsets are small where a telephoto lens needs them exact.
    precise float x = (float(pixel.x) - camera.halfWidth) + offset.x;
    precise float y = (float(pixel.y) - camera.halfHeight) + offset.y;
    precise vec3 direction = camera.center + (x * camera.stepX + y * camera.stepY);
    vec3 origin = camera.eye;
    if (FEATURE_PARALLEL_CAMERA) {
        precise vec3 moved = camera.eye + (x * camera.originStepX + y * camera.originStepY);
        origin = moved;
    }
    if (FEATURE_THIN_LENS) {
        precise vec3 aside = lens.x * camera.lensX + lens.y * camera.lensY;
        precise vec3 moved = origin + aside;
        precise vec3 turned = direction - camera.inverseFocus * aside;
        origin = moved;
        direction = turned;
    }
    precise vec3 unit = quotient(direction, length(direction));
    return Ray(origin, unit, camera.nearT, camera.farT, kNone, kNone);
}

#endif
