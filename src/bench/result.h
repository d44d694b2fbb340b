// Measurements of one scene.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/quartiles.h"
#include "reference/tracer.h"
#include "render/renderer.h"
#include "trace/backend.h"

namespace glint::bench {

// Seconds unless said otherwise.
struct Result {
    std::string scene;
    Backend backend = Backend::Gpu;
    std::string device, driver, traversal, access;  // the last two empty on the host
    int width = 0, height = 0, samples = 1, depth = 0, repeats = 0;
    size_t lights = 0, triangles = 0, primitives = 0;
    std::vector<std::string> used, also;  // features of the scene; further ones that there is code for

    render::RayCounts rays;  // of one picture
    // Seconds for one image. The reference does not separate ray classes and fills `trace` only.
    Quartiles generate, primary, shadow, secondary, shade, trace, readback;
    // Processor seconds of all threads for one image with its readback. On a software device they depend less
    // than `trace` on other work of the machine.
    Quartiles processors;
    Quartiles mirrored, refracted;  // where a picture has both: in dispatches of their own
    // The reference's rays, by RayClass: of the first sample of a grid of pixels; on the host, of all.
    std::array<reference::RayTally, reference::kRayClasses> counted;
    uint64_t countedPixels = 0;

    // For one image, over all bounces: living paths, and paths that the kernels ran over.
    uint64_t livePaths = 0, invocations = 0;

    double open = 0, load = 0, build = 0, pack = 0, upload = 0, compile = 0;
    unsigned threads = 1;
    uint64_t hostPeakBytes = 0;  // of the process so far
    uint64_t deviceBytes = 0;
    uint64_t codeBytes = 0;  // SPIR-V that the driver was given
    std::string picture;     // hash of the colours
    // With --traversal all: each way to find hits that device and scene have, measured in turns.
    std::vector<Result> walks;
};

// Rays cast and the time they took, in the order that they are shown.
struct Rate {
    const char* key;   // in JSON
    const char* name;  // in the table
    uint64_t rays = 0;
    Quartiles seconds;       // all 0: not measured apart
    double testsPerRay = 0;  // boxes and primitives
};
std::vector<Rate> ratesOf(const Result& result);

}  // namespace glint::bench
