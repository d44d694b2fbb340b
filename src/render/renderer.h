// Renders a packed scene on a device: uploads what the scene has, builds pipelines of what it uses,
// dispatches slices bounded by measured time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/options.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::render {

// Seconds of the device, between timestamps around what each kernel was submitted for (wall time without
// timestamps), further dispatches for unfinished rays included. `primary` holds `generate` too unless
// Options::profile; `shadow` is the kernel that also shades what its light reaches; `secondary`: reflected
// and refracted rays together; `mirrored` and `refracted`: apart, each in dispatches of its own, of pictures
// with Request::tally whose pipeline knows transmission. `whole`: all of those that one kernel draws.
struct KernelTimes {
    double generate = 0, primary = 0, shadow = 0, secondary = 0, shade = 0, adapt = 0, whole = 0;
    double mirrored = 0, refracted = 0;
};

// Rays that were cast, of complete pictures with Request::tally.
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
    // Paths of the dispatches that these were traced in, resume dispatches aside: those that have ended and
    // the rest of the last workgroup too. Those of whole.comp once a sample.
    uint64_t invocations = 0;
    KernelTimes kernels;
};

class Renderer {
  public:
    // Keeps references to `device` and `scene`. Throws Error(Device) for arrays that do not fit, naming array
    // and both sizes.
    Renderer(const gpu::Device& device, const PackedScene& scene, const Options& options = {});

    // A cancelled render returns with complete = false and what was finished by then. Throws
    // std::invalid_argument for a parallel camera if the pipeline leaves it out: neither the scene's features
    // nor Options::also have it.
    // trails: becomes the rays that the device follows from the eye and from surfaces, by pixel of the
    // region, for requests with one sample and layers.
    Picture render(const shared::Camera& camera, const Request& request,
                   std::vector<Trail>* trails = nullptr);

    // Data at the centre of pixel (x, y) of the requested image, as the device computes it.
    PixelData pixel(const shared::Camera& camera, Request request, int x, int y);

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
