// Pictures to a given error: samples are taken until the error of the picture is at most what was asked for,
// with a stated confidence. docs/design/error-targets.md says what is promised, why it holds, and what it
// cannot see.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/enum_names.h"
#include "scene/scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::converge {

// What is to be at most Target::error, in linear radiance (full scale 1).
enum class Measure {
    Rmse,  // the root mean square over all pixels and channels of picture - truth
    Pixel  // |picture - truth| of every channel of every pixel by itself, each with the stated confidence
};
constexpr auto entriesOf(Measure) {
    return std::to_array<EnumEntry<Measure>>({{Measure::Rmse, "rmse"}, {Measure::Pixel, "pixel"}});
}

struct Target {
    double error = 1e-2;       // positive, finite
    double confidence = 0.95;  // in (0.5, 1)
    Measure measure = Measure::Rmse;
    double maxSeconds = std::numeric_limits<double>::infinity();  // of rendering
    uint32_t maxSamples = 65536;                                  // of a pixel, 2 and more
    // The truth is the picture without any limit of depth; or, if false, the one that ends at maxDepth, and
    // what may lie beyond is told, not counted.
    bool depthCounts = true;
};

// Bounds of the parts of the error. Their sum bounds the whole, by the triangle inequality.
struct ErrorBudget {
    double sampling = std::numeric_limits<double>::infinity();  // with Target::confidence
    double rounding = 0;                                        // the scene's condition number times the unit
    double cut = 0;    // branches below Request::minContribution, or that found no room
    double depth = 0;  // branches beyond maxDepth
    bool depthCounts = true;
    // What more samples do not mend.
    double fixed() const { return rounding + cut + (depthCounts ? depth : 0); }
    double total() const { return sampling + fixed(); }
};

// Why no more samples were taken.
// Fixed: what samples do not mend came to more than the target in later rounds than the first.
enum class Stop { Reached, Samples, Seconds, Fixed, Interrupted };
constexpr auto entriesOf(Stop) {
    return std::to_array<EnumEntry<Stop>>({{Stop::Reached, "reached"},
                                           {Stop::Samples, "samples"},
                                           {Stop::Seconds, "seconds"},
                                           {Stop::Fixed, "fixed"},
                                           {Stop::Interrupted, "interrupted"}});
}

struct State {
    ErrorBudget budget;
    uint32_t samplesPerPixel = 0;  // of the pixel that took the most
    uint32_t leastSamples = 0;     // Measure::Rmse: of most pixels, where few have more (converge/spots.h)
    uint32_t rounds = 0;
    double estimate = 0;  // Measure::Rmse: the sampling error as the replicates show it; no bound
    // Measure::Rmse: what one detail as bright as the scene can have may add with the confidence, though no
    // sample of its pixel hit it. No part of the budget, whose sampling allows for full scale alone.
    double unseen = std::numeric_limits<double>::infinity();
    double unsettled = 1;  // Measure::Pixel: the share of pixels whose half width is above the target
};

struct Result : State {
    // All samples together. `samples` says how many each pixel took. `errors`: with Rmse the standard error
    // of each pixel as its two replicates show it (one number of few degrees of freedom: a map, no bound);
    // with Pixel the half width of its interval, greatest channel, without the fixed parts.
    Picture picture;
    Stop stop = Stop::Reached;
    bool reached() const { return stop == Stop::Reached; }
};

// Draws what the request asks for: a tracer. It must honour Request::samples, region, ledger and cancelled.
using Draw = std::function<Picture(const Request&)>;

struct Job {
    Request request;      // of the picture; its samples are not looked at
    ImageSettings image;  // sampler (no grid), filter, seed
    Target target;
    double rounding = 0;    // ErrorBudget::rounding
    bool inDouble = false;  // of a tracer in double precision, for advice
    // No channel of a pixel exceeds it (PackedScene's radiance bound). Measure::Pixel goes by it, and it is
    // what State::unseen is of.
    double radianceBound = std::numeric_limits<double>::infinity();
    // The depth that the request leaves to the scene, for advice.
    uint32_t maxDepth = 0;
    std::function<void(const State&)> report;  // after each round; may be empty
};

// Throws Error(Argument) if the target is out of reach whatever the number of samples, with what would help:
// after one sample of each pixel, which is when the fixed parts are known.
Result converge(const Draw& draw, const Job& job);

}  // namespace glint::converge
