// Two replicates of an image, sequences of samples with a seed each, and the decision to stop.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "converge/looks.h"
#include "core/enum_names.h"
#include "pack/pack_samples.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::converge {

struct Target {
    // Root mean square over all pixels and channels of image - truth, in linear radiance (full scale 1);
    // positive, finite.
    double error = 1e-2;
    double confidence = 0.95;                                     // in (0.5, 1)
    double maxSeconds = std::numeric_limits<double>::infinity();  // of rendering
    uint32_t maxSamples = 65536;                                  // of a pixel, at least 2
    // True: the truth has no limit of depth. False: it ends at the depth of the request, and what may lie
    // beyond is reported but not counted.
    bool depthCounts = true;
    bool operator==(const Target&) const = default;
};

// Bounds of the parts of the error. Their sum bounds the whole, by the triangle inequality.
struct ErrorBudget {
    double sampling = std::numeric_limits<double>::infinity();  // with Target::confidence
    double rounding = 0;                                        // the scene's condition number times the ulp
    double cut = 0;    // branches below PathLimits::minContribution, or without room on the stack
    double depth = 0;  // branches beyond the depth
    bool depthCounts = true;
    // The part that more samples do not reduce.
    double fixed() const { return rounding + cut + (depthCounts ? depth : 0); }
    double total() const { return sampling + fixed(); }
};

// The reason to stop. Fixed: after the first round, ErrorBudget::fixed() grew above the target.
enum class Stop { Reached, Samples, Seconds, Fixed, Interrupted };
constexpr auto entriesOf(Stop) {
    return std::to_array<EnumEntry<Stop>>(
        {{Stop::Reached, "reached"},
         {Stop::Samples, "samples", "--max-spp"},
         {Stop::Seconds, "seconds", "--max-seconds"},
         {Stop::Fixed, "fixed", "more would not help: cuts and rounding alone exceed the target"},
         {Stop::Interrupted, "interrupted"}});
}

struct State {
    ErrorBudget budget;
    uint32_t samplesPerPixel = 0;
    uint32_t rounds = 0;
    double estimate = 0;  // the sampling error that the replicates show; no bound
    // The error, with the confidence, of one detail as bright as the scene allows that all samples of its
    // pixel missed. The budget's sampling part allows for full scale only.
    double unseen = std::numeric_limits<double>::infinity();
    std::optional<Stop> stop;  // empty while samples are taken
    bool reached() const { return stop == Stop::Reached; }
};

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

}  // namespace glint::converge
