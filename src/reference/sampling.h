// Where the reference's samples lie, from the packed rows; written apart from shaders/sample.glsl.
#pragma once

#include <glm/glm.hpp>

#include "pack/pack_samples.h"

namespace glint::reference {

struct FilmSample {
    glm::dvec2 offset{0.5};  // pixels from the pixel's left and upper edge; the device's, bit for bit
    glm::dvec2 lens{0};      // on the unit disc
    double weight = 1;
};

// Of pixel (x, y) of the whole picture.
FilmSample filmSample(const PackedSamples& samples, uint32_t index, uint32_t x, uint32_t y);

// The point of the unit disc that belongs to (a, b) of [0, 1]^2 (P. Shirley, K. Chiu 1997).
glm::dvec2 concentricDisc(double a, double b);

// True if a pixel whose samples so far have these colours takes another round (docs/guide/sampling.md).
bool needsMore(const std::vector<glm::dvec3>& colors, double threshold);

}  // namespace glint::reference
