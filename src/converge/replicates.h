// Running sums of pictures: one replicate is a sequence of samples with a seed of its own.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "converge/converge.h"
#include "pack/pack_samples.h"

namespace glint::converge {

// Seed of replicate `number`; number 0 has the user's own.
uint32_t seedOf(uint32_t seed, uint32_t number);

class Replicate {
  public:
    Replicate(const ImageSettings& image, uint32_t number);

    // Takes `count` more samples of every pixel. False if the tracer was cancelled: nothing is added then.
    bool take(const Draw& draw, const Request& request, uint32_t count);

    uint32_t count() const { return count_; }
    const std::vector<glm::dvec3>& means() const { return means_; }  // of all samples so far, each pixel
    const std::vector<double>& alphas() const { return alphas_; }

  private:
    SampleSequence sequence_;
    uint32_t count_ = 0;
    std::vector<glm::dvec3> means_;
    std::vector<double> alphas_;
};

// What the pictures of all batches have in common: losses, faults, and the data of the first one.
class Ledger {
  public:
    void add(const Picture& picture, uint32_t count);
    // Into the budget: root mean squares of what was lost (Measure::Rmse), or the greatest of a pixel.
    void writeTo(ErrorBudget& budget, Measure measure) const;
    // Into the picture, whose colour is made by the caller.
    void writeTo(Picture& picture) const;
    double depth(Measure measure) const;

  private:
    TreeLosses losses_;  // sums weighted by samples
    uint64_t samples_ = 0;
    uint64_t notFinite_ = 0;
    glm::ivec2 firstNotFinite_{-1};
    size_t pixels_ = 0;
    std::vector<PixelData> data_;
};

// Throws if the fixed parts leave nothing of the target; tries what depth would do by `draw`.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget);

}  // namespace glint::converge
