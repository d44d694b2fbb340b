// Renders images of a packed scene on a device, in slices bounded by measured time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/options.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::render {

// Seconds of the device for each kernel, resume dispatches included: between timestamps, or wall time on
// devices without them.
// - `primary` includes `generate` unless Options::profile is set.
// - `shadow` includes shading by the lights.
// - `secondary` counts reflected and refracted rays together. Images with Request::tally and transmission
//   trace them in separate dispatches instead: `mirrored` and `refracted`.
// - `whole` is whole.comp.
struct KernelTimes {
    double generate = 0, primary = 0, shadow = 0, secondary = 0, shade = 0, adapt = 0, whole = 0;
    double mirrored = 0, refracted = 0;
};

// Rays of complete images with Request::tally.
struct RayCounts {
    uint64_t primary = 0, shadow = 0, mirrored = 0, refracted = 0;
};

// Seconds. `trace` is the wall time of all submissions, `device` the part of it between timestamps (0
// without).
struct StageTimes {
    double upload = 0, compile = 0, trace = 0, device = 0, readback = 0;
    double longestSubmission = 0;
    uint64_t submissions = 0, slices = 0, resumes = 0;
    uint64_t pathRays = 0;  // camera, mirrored and refracted rays
    // Invocations that traced pathRays, without resume dispatches. Ended paths and the rest of the last
    // workgroup count; whole.comp counts once a sample.
    uint64_t invocations = 0;
    KernelTimes kernels;
};

class Renderer {
  public:
    // Keeps references to `device` and `scene`. Throws Error(Device) for an array that does not fit, with its
    // name and both sizes.
    Renderer(const gpu::Device& device, const PackedScene& scene, const Options& options = {});

    // A cancelled render returns the finished part with complete = false. Throws std::invalid_argument for a
    // parallel camera that neither the scene's features nor Options::also have, and for more lights than the
    // scene has; Error(Device) if the device fails or has too little memory.
    // trails: receives the camera, reflected and refracted rays of each pixel of the region, for requests
    // with one sample and layers.
    Picture render(const Request& request, std::vector<Trail>* trails = nullptr);

    // The layers at the centre of pixel (x, y) of the requested image.
    PixelData pixel(Request request, int x, int y);

    const StageTimes& times() const;  // of construction and all renders since
    const RayCounts& rays() const;
    gpu::Access access() const;
    // Traversal of requests with these methods.
    TraversalChoice traversal(const Methods& methods = {}) const;
    uint64_t deviceBytes() const;
    uint64_t codeBytes() const;  // SPIR-V of the kernels used so far

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace glint::render
