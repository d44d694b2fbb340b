// Renders an image to a given error: takes samples until the image's root mean square error is at most the
// target, with a stated confidence. docs/design/error-targets.md states the promise, its proof and its
// limits.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "converge/replicates.h"
#include "scene/scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint {
struct PackedScene;
}

namespace glint::converge {

struct Result : State {
    // All samples together. `errors`: each pixel's standard error from its two replicates (a map, no bound).
    Picture picture;
};

// A tracer. It must honour Request::samples, region, ledger and cancelled.
using Draw = std::function<Picture(const Request&)>;

struct Job {
    // The image, with a depth and a sampler that is no grid. Its samples are ignored, and its progress gets
    // an estimate after each round.
    Request request;
    Target target;
    double rounding = 0;    // ErrorBudget::rounding
    bool inDouble = false;  // the tracer computes in double precision; for advice
    // No channel of a pixel exceeds it; for State::unseen.
    double radianceBound = std::numeric_limits<double>::infinity();
};

// The job of an image that is requested as for one render. Its request is like those of its batches: not
// adaptive, no grid, with losses and the depth of the scene. `rounding` and what follows is left to the
// caller.
Job jobFor(const PackedScene& packed, const Request& wanted, const Target& target);

// True if an image of this depth may lack reflections that its losses do not count, because kernels without
// reflections record none.
bool missesReflections(const Scene& scene, uint32_t depth);

// Throws Error(Argument), with advice, if no number of samples can reach the target; one sample of each pixel
// decides this.
Result converge(const Draw& draw, const Job& job);

}  // namespace glint::converge
