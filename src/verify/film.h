// The picture of all samples together, against what its samples demand of it that were drawn one by one.
#pragma once

#include <vector>

#include "render/renderer.h"

namespace glint::verify {

// The first round of samples, and of adaptive pictures the second: enough to see who takes one and who does
// not, without drawing all that a few pixels may take.
PackedSamples firstRounds(const PackedSamples& samples);

// Adds samples up in double precision, pixel by pixel, and says which pixels of a picture are not their mean.
class Film {
  public:
    // lights: how many may add to a sample at each of its hits.
    Film(const PackedSamples& samples, int width, int height, size_t lights);

    // Sample `index`, drawn for all pixels, in the order of the indices; those of the first round with data.
    void add(uint32_t index, const Picture& sample);

    // Bytes per pixel that a film needs, including the colours of adaptive images.
    static uint64_t bytesPerPixel(const PackedSamples& samples);

    // Pixels of `whole`, drawn with the samples of the constructor, that took others than they had to, or
    // show another mean than of those.
    std::vector<size_t> differing(const Picture& whole) const;

  private:
    struct Pixel {
        glm::dvec4 sum{0};
        glm::dvec3 magnitudes{0};
        double alphas = 0;     // magnitudes, too
        double additions = 0;  // by which the device came to the sum
    };
    enum class Further { No, Yes, Either };
    Further furtherAt(size_t pixel) const;
    bool isMean(const Pixel& pixel, const float* color, uint32_t taken) const;

    const PackedSamples& samples_;
    int width_;
    double lights_;
    std::vector<Pixel> first_, all_;               // after one round, and after all
    std::vector<std::vector<glm::dvec3>> colors_;  // of the first round, of adaptive pictures
};

}  // namespace glint::verify
