#version 450
#extension GL_GOOGLE_include_directive : require
// Starts a sample: the camera ray of each pixel of the slice.
#include "shading/camera.glsl"
#include "path_rows.glsl"
#include "shading/scatter.glsl"

void main() {
    uint path = pathIndex();
    uvec2 pixel;
    bool inside = pixelOf(path, pixel);
    vec3 weight;
    Ray ray = cameraRay(pixel, weight);
    bool takes = inside;
    if (MODE_ADAPTIVE && dispatch.sampleIndex != 0u) takes = loadRow(kRowSpread, path).w == 1u;
    if (!takes) ray.tMin = kInfinity;
    storeRay(path, ray);
    storeRow(kRowThroughput, path, packRow(weight, kHashStart));
    storeRow(kRowWalk, path, uvec4(kNone, 0u, 0u, 0u));
    if (dispatch.sampleIndex == 0u) storeLedger(path, emptyLedger());
    if (FEATURE_TRANSMISSION) {
        storeRow(treeRow(kTreeRowMedia), path, eyeMedia(loadEnvironment(0u)));
        storeRow(treeRow(kTreeRowBranch), path, uvec4(0u));
    }
    if (MODE_ADAPTIVE || dispatch.sampleIndex == 0u) storeRow(kRowRadiance, path, uvec4(0u));
}
