// Renders an image to a given error: takes samples until the image's root mean square error is at most the
// target, with a stated confidence. docs/design/error-targets.md states the promise, its proof and its
// limits.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "core/enum_names.h"
#include "scene/scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint {
struct PackedScene;
}

namespace glint::converge {

struct Target {
    // Root mean square over all pixels and channels of image - truth, in linear radiance (full scale 1);
    // positive, finite.
    double error = 1e-2;
    double confidence = 0.95;                                     // in (0.5, 1)
    double maxSeconds = std::numeric_limits<double>::infinity();  // of rendering
    uint32_t maxSamples = 65536;                                  // of a pixel, at least 2
    // True: the truth has no limit of depth. False: it ends at the depth of the request, and what may lie
    // beyond is reported but not counted.
    bool depthCounts = true;
    bool operator==(const Target&) const = default;
};

// Bounds of the parts of the error. Their sum bounds the whole, by the triangle inequality.
struct ErrorBudget {
    double sampling = std::numeric_limits<double>::infinity();  // with Target::confidence
    double rounding = 0;                                        // the scene's condition number times the ulp
    double cut = 0;    // branches below PathLimits::minContribution, or without room on the stack
    double depth = 0;  // branches beyond the depth
    bool depthCounts = true;
    // The part that more samples do not reduce.
    double fixed() const { return rounding + cut + (depthCounts ? depth : 0); }
    double total() const { return sampling + fixed(); }
};

// The reason to stop. Fixed: after the first round, ErrorBudget::fixed() grew above the target.
enum class Stop { Reached, Samples, Seconds, Fixed, Interrupted };
constexpr auto entriesOf(Stop) {
    return std::to_array<EnumEntry<Stop>>(
        {{Stop::Reached, "reached"},
         {Stop::Samples, "samples", "--max-spp"},
         {Stop::Seconds, "seconds", "--max-seconds"},
         {Stop::Fixed, "fixed", "more would not help: cuts and rounding alone exceed the target"},
         {Stop::Interrupted, "interrupted"}});
}

struct State {
    ErrorBudget budget;
    uint32_t samplesPerPixel = 0;
    uint32_t rounds = 0;
    double estimate = 0;  // the sampling error that the replicates show; no bound
    // The error, with the confidence, of one detail as bright as the scene allows that all samples of its
    // pixel missed. The budget's sampling part allows for full scale only.
    double unseen = std::numeric_limits<double>::infinity();
    std::optional<Stop> stop;  // empty while samples are taken
    bool reached() const { return stop == Stop::Reached; }
};

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
