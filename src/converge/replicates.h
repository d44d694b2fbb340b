// Running sums of pictures: one replicate is a sequence of samples with a seed of its own.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "converge/converge.h"
#include "converge/looks.h"
#include "converge/spots.h"
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
    // Of a part of the picture, whose losses others stand for.
    void addFaults(const Picture& picture);
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

// Pixels that more replicates draw than the two of the picture, whose own they take the place of.
struct Spot {
    Region region;
    std::vector<Replicate> replicates;
};

// The sums that a picture is made of.
struct Sums {
    // Replicates of the numbers from `number` on.
    Sums(const ImageSettings& image, uint32_t number) : first(image, number), second(image, number + 1) {}
    // And spots, of the numbers after these.
    Sums(const ImageSettings& image, uint32_t number, SpotPlan plan);

    // Of a pixel of a spot if there is any, else of any pixel, for each sample of `first`.
    uint32_t mostEach() const { return plan.regions.empty() ? 2 : plan.replicates * plan.times; }
    // Mean square error of each pixel, and of all of them.
    std::vector<double> squares(const Region& whole) const;
    MeanSquare estimate(const Region& whole) const;
    // Colours, alpha, errors and samples.
    void writeTo(Picture& picture) const;

    Replicate first, second;
    SpotPlan plan;
    std::vector<Spot> spots;
};

// The picture that they make, what it lacks, and when it is good enough.
struct Replicates : Sums {
    Replicates(const ImageSettings& image, const Target& target) : Sums(image, 0), looks(target) {}

    // After as many samples of either: budget, estimate, rounds and samples into the state. True if the
    // target is reached. `rounding`: ErrorBudget::rounding.
    bool look(const Target& target, double rounding, const Region& whole, State& state);
    // From here on by other sums, which have drawn as much.
    void goOnWith(Sums&& other);

    Ledger ledger;
    Looks looks;
};

// Throws if the fixed parts leave nothing of the target; tries what depth would do by `draw`.
void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget);

}  // namespace glint::converge
