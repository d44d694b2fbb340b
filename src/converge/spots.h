// Few pixels that have nearly all of a picture's error: a sun in a mirror, a small ball on black. Two
// replicates of each tell too little of it for a bound that is worth anything, and drawing all of the picture
// for their sake is dear. They are drawn by more replicates and with more samples, apart from the others.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trace/picture.h"

namespace glint::converge {

// Where they are, by how many replicates they are drawn, and how many samples each of these takes for one of
// a picture's replicate.
struct SpotPlan {
    std::vector<Region> regions;  // apart from each other, in the whole picture's coordinates
    uint32_t replicates = 2, times = 1;
};

inline constexpr uint32_t kMostSpotReplicates = 8;

// What is known when they are looked for.
struct SpotFacts {
    Region whole;
    std::span<const double> squares;  // MeanSquareSum::add's, each pixel of `whole`
    double allowed = 0;               // of the target, what is left for sampling
    double mostSamples = 1;  // of a pixel, for each of a picture's replicate: what a limit of them leaves
    SpotPlan now;            // the spots that there are, which are kept
};

// Spots worth having: few pixels without which the others' error has degrees of freedom enough. Nothing if
// there are none, or too many for spots. Who takes one must draw all of the picture anew, by other seeds:
// pixels left out because their samples happened to agree would be thought better than they are.
std::optional<SpotPlan> spotsFor(const SpotFacts& facts);

}  // namespace glint::converge
