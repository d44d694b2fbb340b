// Two replicates of an image, sequences of samples with a seed each, and the decision to stop.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "converge/converge.h"
#include "converge/looks.h"
#include "pack/pack_samples.h"

namespace glint::converge {

struct Replicate {
    SampleSequence sequence;
    uint32_t count = 0;                  // samples so far
    std::vector<glm::dvec3> means = {};  // of all samples so far, by pixel
    std::vector<double> alphas = {};
};

// Losses and faults of all batches.
class Ledger {
  public:
    // The flaws of an image of so many pixels, each with `count` samples.
    void add(const PictureFlaws& flaws, size_t pixels, uint32_t count);
    // Root mean squares of the losses.
    void writeTo(ErrorBudget& budget) const;
    // Those of one sample per pixel.
    PictureFlaws flaws() const;
    double depth() const;

  private:
    PictureFlaws flaws_;  // losses: sums weighted by samples
    uint64_t samples_ = 0;
    size_t pixels_ = 0;
};

class Replicates {
  public:
    // `knowsDepth`: false if the losses lack branches beyond the depth, see missesReflections().
    Replicates(const ImageSettings& image, const Target& target, bool knowsDepth = true);

    // Takes a batch of samples, for the replicate that has fewer: begin() returns `count` of them, add() is
    // called until it has had each pixel of `whole` once, and end() counts them.
    PackedSamples begin(uint32_t count);
    void add(const Picture& part, const Region& whole);
    void end();
    // The samples of all batches.
    PackedSamples taken() const;

    // True if both replicates have as many samples as the next look is worth.
    bool isDue() const { return first.count == second.count && first.count >= looks.next(); }
    // Call with equal counts of both replicates: writes all of the state but `unseen`. `rounding`:
    // ErrorBudget::rounding.
    void look(double rounding);
    // Writes colors, alpha, errors, samples and flaws.
    void writeTo(Picture& picture) const;

    State state;
    Replicate first, second;
    Ledger ledger;
    Looks looks;

  private:
    Replicate& fewer() { return second.count < first.count ? second : first; }

    const ImageSettings image_;
    const Target target_;
    const bool knowsDepth_;
    uint32_t taking_ = 0;  // samples of the current batch
    PictureFlaws flaws_;   // of its finished parts
};

// Throws if the fixed parts leave nothing of the target; tries greater depths by `draw` for the advice.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget);

}  // namespace glint::converge
