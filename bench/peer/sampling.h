// Where the samples of a pixel lie: the same places as glint's (docs/guide/sampling.md), so that pictures can
// be compared.
#pragma once

#include <glm/glm.hpp>

#include "trace/request.h"

namespace glint::bench::peer {

struct FilmSample {
    glm::vec2 offset{0.5f};  // pixels from the pixel's left and upper edge
    glm::vec2 lens{0};       // on the unit disc
    float weight = 1;
};
FilmSample filmSample(const PackedSamples& samples, uint32_t index, uint32_t x, uint32_t y);

}  // namespace glint::bench::peer
