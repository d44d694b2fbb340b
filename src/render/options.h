// Settings of the device alone. Settings of an image are in Request.
#pragma once

#include <cstdint>
#include <optional>

#include "gpu/compute.h"
#include "render/kernel_choice.h"

namespace glint::render {

struct Options {
    double sliceSeconds = 0.1;    // target for the longest single submission
    uint32_t maxSlicePixels = 0;  // most pixels of a slice; 0: chosen
    uint32_t tripBudget = 0;      // loop trips of a ray in one dispatch; 0: derived from the device
    bool leaveOut = true;         // false: the full pipeline, with the code of every feature
    SceneFeatures also = {};      // features that the pipeline has code for though the scene lacks them
    bool profile = false;         // times the generation of camera rays separately (KernelTimes)
    std::optional<gpu::Access> access = {};  // empty: chooseAccess (scene_buffers.h)
    Traversal traversal = Traversal::Auto;
    // Auto: where one kernel pays, unless `profile`, packets or `kernels` require a kernel for each step.
    WholePaths wholePaths = WholePaths::Auto;
    // Uses the quotients and square roots of shaders/arithmetic.glsl even if the device rounds correctly.
    bool ownArithmetic = false;
    const KernelCode* kernels = nullptr;  // instead of the embedded ones
    // The first image: its kernels are translated while the arrays are uploaded. Need not outlive the
    // constructor.
    const Request* expected = nullptr;
    // Camera rays of all images, 0 if unknown. For few rays, kernels with a short translation are better than
    // those that trace faster (wholePathsPay). The bits are the same.
    uint64_t cameraRays = 0;
};

}  // namespace glint::render
