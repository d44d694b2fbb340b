#version 450
#extension GL_GOOGLE_include_directive : require
// Starts a sample: the camera ray of each pixel of the slice (Shirley & Marschner, Fundamentals of Computer Graphics, ch. 4). The
// host has worked every kind of camera into steps, see Camera in shared/layout.h.
#include "path.glsl"
#include "tree.glsl"

void main() {
    uint path = pathIndex();
    uvec2 pixel;
    bool inside = pixelOf(pixel);
    Camera camera = loadCamera(0u);
    // Measured from the picture's centre: the offsets are small where a telephoto lens needs them exact.
    precise float x = (float(pixel.x) - camera.halfWidth) + dispatch.sampleOffset.x;
    precise float y = (float(pixel.y) - camera.halfHeight) + dispatch.sampleOffset.y;
    precise vec3 direction = camera.center + (x * camera.stepX + y * camera.stepY);
    precise vec3 unit = direction / length(direction);
    vec3 origin = camera.eye;
    if (FEATURE_PARALLEL_CAMERA) {
        precise vec3 moved = camera.eye + (x * camera.originStepX + y * camera.originStepY);
        origin = moved;
    }
    storeRay(path, Ray(origin, unit, inside ? camera.nearT : kInfinity, camera.farT, kNone, kNone));
    storeRow(kRowThroughput, path, packRow(vec3(1.0), 2166136261u));
    storeRow(kRowWalk, path, uvec4(kNone, 0u, 0u, 0u));
    startTree(path, loadEnvironment(0u));
    if (dispatch.sampleIndex == 0u) storeRow(kRowRadiance, path, uvec4(0u));
}
