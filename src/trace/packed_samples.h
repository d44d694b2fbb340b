// The samples of a picture's pixels, as both tracers read them (docs/guide/sampling.md).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/device_layout.h"

namespace glint {

struct PackedSamples {
    // All pixels take the same samples, each of weight 1: their places in the pixel, in [0, 1)^2. Empty if
    // `rows` says what to take.
    std::vector<glm::dvec2> offsets;
    // Two filter tables in place of the first shared::kFirstSample, then the samples.
    std::vector<shared::Sample> rows;
    // Samples are taken in whole rounds of so many, and after each one a pixel stops unless `threshold` says
    // to go on. Not adaptive: one round.
    uint32_t round = 1;
    std::optional<float> threshold;

    uint32_t count() const;  // of samples, if adaptive at the most
    bool scattered() const { return !rows.empty(); }
    // Sample `index` alone, with its weight, not adaptive.
    PackedSamples only(uint32_t index) const;
    // The same places in all pixels.
    static PackedSamples fixed(std::vector<glm::dvec2> offsets);
};

}  // namespace glint
