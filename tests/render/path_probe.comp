#version 450
#extension GL_GOOGLE_include_directive : require
// What a kernel that may run over a list knows of its path: the path's column, its pixel, and pairs of
// dimensions of its sample. GLINT_PROBE_WORDS words for each invocation.
#include "path_rows.glsl"
#include "shading/camera.glsl"

layout(set = 0, binding = GLINT_BINDING_COUNT, std430) writeonly buffer WordsBlock {
    uint words[];
};

void main() {
    bool present;
    uint path = listedPath(present);
    uvec2 pixel;
    bool inside = pixelOf(path, pixel);
    uint first = pathIndex() * GLINT_PROBE_WORDS;
    words[first] = present ? 1u : 0u;
    words[first + 1u] = path;
    words[first + 2u] = inside ? 1u : 0u;
    words[first + 3u] = pixel.x;
    words[first + 4u] = pixel.y;
    Sample s = loadSample(kFirstSample + dispatch.sampleIndex);
    for (uint pair = 0u; 2u * pair + 6u < GLINT_PROBE_WORDS; ++pair) {
        uvec2 at = samplePair(s, pixel, pair);
        words[first + 2u * pair + 5u] = at.x;
        words[first + 2u * pair + 6u] = at.y;
    }
}
