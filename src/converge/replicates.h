// Running sums of pictures: one replicate is a sequence of samples with a seed of its own.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "converge/converge.h"
#include "converge/looks.h"
#include "pack/pack_samples.h"

namespace glint::converge {

// Seed of replicate `number`; number 0 has the user's own.
uint32_t seedOf(uint32_t seed, uint32_t number);

// The first `count` samples of a replicate.
PackedSamples samplesOf(const ImageSettings& image, uint32_t number, uint32_t count);

class Replicate {
  public:
    Replicate(const ImageSettings& image, uint32_t number);

    // Takes `count` more samples of every pixel. False if the tracer was cancelled: nothing is added then.
    bool take(const Draw& draw, const Request& request, uint32_t count);
    // The same in pieces, for who draws: samples to take of every pixel; what that gave, each pixel of
    // `whole` once; and then they count.
    PackedSamples begin(uint32_t count);
    void add(const Picture& part, const Region& whole);
    void end();

    uint32_t count() const { return count_; }
    const std::vector<glm::dvec3>& means() const { return means_; }  // of all samples so far, each pixel
    const std::vector<double>& alphas() const { return alphas_; }

  private:
    SampleSequence sequence_;
    uint32_t count_ = 0, taking_ = 0;
    std::vector<glm::dvec3> means_;
    std::vector<double> alphas_;
};

// What the pictures of all batches have in common: losses, faults, and the data of the first one.
class Ledger {
  public:
    void add(const Picture& picture, uint32_t count);
    void add(const TreeLosses& losses, size_t pixels, uint32_t count);
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

// The picture that two replicates make, what it lacks, and when it is good enough.
struct Replicates {
    Replicates(const ImageSettings& image, const Target& target)
        : first(image, 0), second(image, 1), looks(target) {}

    // After as many samples of either: budget, estimate, rounds and samples into the state. True if the
    // target is reached. `rounding`: ErrorBudget::rounding.
    bool look(const Target& target, double rounding, State& state);

    Replicate first, second;
    Ledger ledger;
    Looks looks;
};

// Throws if the fixed parts leave nothing of the target; tries what depth would do by `draw`.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget);

}  // namespace glint::converge
