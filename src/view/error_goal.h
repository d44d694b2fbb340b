// The picture of the window until its error is small enough: `glint render --error`, a sample at a time.
#pragma once

#include <optional>
#include <vector>

#include "converge/replicates.h"
#include "view/settings.h"

namespace glint::view {

// Progress of the goal, for the panel.
struct GoalFacts {
    std::vector<double> bounds;          // of the error, by each look so far
    converge::State state;               // of the last look
    std::optional<converge::Stop> stop;  // Reached, Fixed or Samples; empty: it goes on
};

class ErrorGoal {
  public:
    // `image`: sampler (no grid), filter and seed; `region`: the whole picture.
    // `knowsDepth`: the pictures tell what lies beyond the depth.
    ErrorGoal(const converge::Target& target, const ImageSettings& image, const Region& region,
              bool knowsDepth);

    // Samples of the next pass over the picture, which goes to the two replicates in turns; its bands, each
    // once; its end.
    PackedSamples begin();
    void add(const Picture& band);
    void end();

    // The replicates have as many samples as the next look is worth, which needs ErrorBudget::rounding.
    bool looks() const;
    void look(double rounding);

    // All samples of both replicates.
    PackedSamples taken() const;
    const GoalFacts& facts() const { return facts_; }
    bool over() const { return facts_.stop.has_value(); }

  private:
    converge::Target target_;
    ImageSettings image_;
    Region region_;
    bool knowsDepth_;
    converge::Replicates both_;
    converge::Replicate* turn_ = nullptr;  // that takes the pass at hand
    TreeLosses losses_;                    // of the pass at hand
    GoalFacts facts_;
};

// One line for the panel: "error <= 0.012, 24 samples; until 0.003".
std::string inWords(const GoalFacts& facts, double error);

}  // namespace glint::view
