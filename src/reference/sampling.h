// Sample positions of the reference, from the packed rows; written apart from shaders/shading/sampling.glsl.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/tracer.h"

namespace glint::reference {

struct FilmSample {
    glm::dvec2 offset{0.5};  // pixels from the pixel's left and upper edge; the device's, bit for bit
    glm::dvec2 lens{0};      // on the unit disc
    double weight = 1;
};

// A sample's point on the film (pair shared::kPairFilm) or the lens (kPairLens) for pixel (x, y) of the whole
// image, in units of 2^-32. s: the row of that sample.
std::array<uint32_t, 2> samplePair(const shared::Sample& s, uint32_t pair, uint32_t x, uint32_t y);

// Sample of pixel (x, y) of the whole image.
FilmSample filmSample(const PackedSamples& samples, uint32_t index, uint32_t x, uint32_t y);

// The camera ray of a sample.
struct PixelSample {
    double weight;
    Ray ray;
};
PixelSample pixelSample(const Tracer& tracer, const rows::Camera& camera, const PackedSamples& samples,
                        uint32_t index, int x, int y);

// The point of the unit disc that belongs to (a, b) of [0, 1]^2 (P. Shirley, K. Chiu 1997).
glm::dvec2 concentricDisc(double a, double b);

// True if a pixel whose samples so far have these colours takes another round (docs/guide/sampling.md).
bool needsMore(const std::vector<glm::dvec3>& colors, double threshold);

}  // namespace glint::reference
