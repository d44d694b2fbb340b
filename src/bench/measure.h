// Measures rays per second and the time of each stage, for `glint bench` and `glint report`.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/context.h"
#include "core/quartiles.h"
#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "reference/tracer.h"
#include "render/renderer.h"
#include "trace/methods.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::bench {

// Times of one image, in seconds.
struct Timing {
    double wall = 0;        // from the call to the end of the readback, without compiling
    double processors = 0;  // of all threads of the process together
    // Differences of the renderer's sums; `upload` and `longestSubmission` are the renderer's own. All 0 for
    // the reference.
    render::StageTimes stages;
};

// Calls `draw`, which renders one image with `renderer`, or with the reference if that is null.
Timing timeImage(const render::Renderer* renderer, const std::function<void()>& draw);

// Measurements of one scene. Seconds unless said otherwise.
struct Result {
    std::string scene;
    Backend backend = Backend::Gpu;
    std::string device, driver, traversal, access;  // the last two empty on the host
    int width = 0, height = 0, samples = 1, depth = 0, repeats = 0;
    size_t lights = 0, triangles = 0, primitives = 0;
    std::vector<std::string> used, also;  // features of the scene; further ones that there is code for

    render::RayCounts rays;  // of one image
    // Seconds for one image. The reference does not separate ray classes and fills `trace` only.
    Quartiles generate, primary, shadow, secondary, shade, trace, readback;
    // Processor seconds of all threads for one image with its readback. On a software device they depend less
    // than `trace` on other work of the machine.
    Quartiles processors;
    Quartiles mirrored, refracted;  // where an image has both: in dispatches of their own
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

struct Options {
    Request request;           // without adaptivity, see measure()
    render::Options renderer;  // `profile` is on in any case but WholePaths::On
    int repeats = 7;           // images that are timed
    bool everyWalk = false;    // each traversal alone too, see Result::walks
    Context context = {};
};

// Renders the scene's image on `device`, or by the reference if it is null. Every pixel takes the same
// samples, even if the scene requests adaptive sampling: pixels that stop early would distort the rays a
// second. `scene` becomes the name of the result; its `open` is left at 0. Throws Cancelled.
Result measure(const std::string& scene, const LoadedScene& loaded, const gpu::Device* device,
               const Options& options);

}  // namespace glint::bench
