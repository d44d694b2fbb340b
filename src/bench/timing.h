// The time of one image. `glint bench` and `glint report` measure with it.
#pragma once

#include <functional>

#include "render/renderer.h"
#include "trace/picture.h"

namespace glint::bench {

// Seconds.
struct Timing {
    double wall = 0;        // from the call to the end of the readback, without compiling
    double processors = 0;  // of all threads of the process together
    // Differences of the renderer's sums; `upload` and `longestSubmission` are the renderer's own. All 0 for
    // the reference.
    render::StageTimes stages;
};

// Calls `draw`, which renders one image with `renderer`, or with the reference if that is null.
Timing timeImage(const render::Renderer* renderer, const std::function<Picture()>& draw, Picture& picture);

}  // namespace glint::bench
