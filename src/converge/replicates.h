// Running sums of an image. A replicate is a sequence of samples with a seed of its own.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "converge/converge.h"
#include "converge/looks.h"
#include "pack/pack_samples.h"

namespace glint::converge {

// The first `count` samples of a replicate.
PackedSamples samplesOf(const ImageSettings& image, uint32_t number, uint32_t count);

class Replicate {
  public:
    Replicate(const ImageSettings& image, uint32_t number);

    // Takes `count` more samples of every pixel. If the tracer was cancelled, adds nothing and returns false.
    bool take(const Draw& draw, const Request& request, uint32_t count);
    // The same in three steps: begin() returns the samples to take, add() is called until it has had each
    // pixel of `whole` once, and end() counts them.
    PackedSamples begin(uint32_t count);
    void add(const Picture& part, const Region& whole);
    void end();

    uint32_t count() const { return count_; }
    const std::vector<glm::dvec3>& means() const { return means_; }  // of all samples so far, by pixel
    const std::vector<double>& alphas() const { return alphas_; }

  private:
    SampleSequence sequence_;
    uint32_t count_ = 0, taking_ = 0;
    std::vector<glm::dvec3> means_;
    std::vector<double> alphas_;
};

// Losses and faults of all batches, and the AOVs of the first batch.
class Ledger {
  public:
    void add(const Picture& picture, uint32_t count);
    void add(const TreeLosses& losses, size_t pixels, uint32_t count);
    // Root mean squares of the losses.
    void writeTo(ErrorBudget& budget) const;
    // All but the color.
    void writeTo(Picture& picture) const;
    double depth() const;

  private:
    TreeLosses losses_;  // sums weighted by samples
    uint64_t samples_ = 0;
    uint64_t notFinite_ = 0;
    glm::ivec2 firstNotFinite_{-1};
    size_t pixels_ = 0;
    std::vector<PixelData> data_;
};

// The two replicates of an image, its losses, and the decision to stop.
struct Replicates {
    Replicates(const ImageSettings& image, const Target& target)
        : first(image, 0), second(image, 1), looks(target) {}

    // Call with equal counts of both replicates: writes budget, estimate, rounds and samples into the state.
    // True if the target is reached. `rounding`: ErrorBudget::rounding.
    bool look(const Target& target, double rounding, State& state);
    // Writes colors, alpha, errors and samples.
    void writeTo(Picture& picture) const;

    Replicate first, second;
    Ledger ledger;
    Looks looks;
};

// Throws if the fixed parts leave nothing of the target; tries greater depths by `draw` for the advice.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget);

}  // namespace glint::converge
