// The samples of a picture's pixels from its settings (docs/guide/sampling.md).
#pragma once

#include <memory>

#include "scene/scene.h"
#include "trace/packed_samples.h"
#include "trace/request.h"

namespace glint {

// The samples that valid settings ask for; `lens`: the camera has one. A regular grid under the box filter of
// radius 0.5 comes as offsets, anything else as rows.
PackedSamples packSamples(const ImageSettings& image, bool lens);

// The samples of a picture piece by piece, for whoever finds out on the way how many it takes. Nothing but
// `next` says how many there are: samplesPerPixel and adaptive of `image` are not looked at.
class SampleSequence {
  public:
    // Throws std::invalid_argument for a grid, which has no further samples; Auto is LowDiscrepancy.
    explicit SampleSequence(const ImageSettings& image);
    ~SampleSequence();
    SampleSequence(SampleSequence&&) noexcept;
    SampleSequence& operator=(SampleSequence&&) noexcept;

    // `count` samples of each pixel that no earlier call gave, whose weights sum to count; with
    // LowDiscrepancy the sequence goes on. At least leastSamples(image.filter).
    PackedSamples next(uint32_t count);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// How few samples have weights at all: a filter with negative parts takes some of each.
uint32_t leastSamples(Filter filter);

// The whole picture that these settings ask for; everything else is the default.
Request requestOf(const ImageSettings& image, bool lens);

}  // namespace glint
