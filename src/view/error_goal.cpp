#include "view/error_goal.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace glint::view {

namespace {

// --error does not work with the grid sampler; `glint render --error` replaces it too.
ImageSettings withoutGrid(ImageSettings image) {
    if (image.sampler == Sampler::Grid) image.sampler = Sampler::LowDiscrepancy;
    return image;
}

converge::Target targetOf(const ErrorSetting& setting) {
    converge::Target target;
    target.error = setting.error;
    target.confidence = setting.confidence;
    target.depthCounts = !setting.withinDepth;
    return target;
}

}  // namespace

ErrorGoal::ErrorGoal(const ErrorSetting& setting, const ImageSettings& image, const Region& region,
                     bool knowsDepth)
    : target_(targetOf(setting)),
      image_(withoutGrid(image)),
      region_(region),
      knowsDepth_(knowsDepth),
      both_(image_, target_) {}

PackedSamples ErrorGoal::begin() {
    turn_ = both_.first.count() > both_.second.count() ? &both_.second : &both_.first;
    losses_ = {};
    return turn_->begin(leastSamples(image_.filter));
}

void ErrorGoal::add(const Picture& band) {
    turn_->add(band, region_);
    losses_.add(band.losses);
}

void ErrorGoal::end() {
    const uint32_t before = turn_->count();
    turn_->end();
    both_.ledger.add(losses_, turn_->means().size(), turn_->count() - before);
}

bool ErrorGoal::looks() const {
    return !over() && both_.first.count() == both_.second.count() &&
           both_.first.count() >= both_.looks.next();
}

void ErrorGoal::look(double rounding) {
    converge::State& state = facts_.state;
    const bool reached = both_.look(target_, rounding, state);
    if (!knowsDepth_) state.budget.depth = std::numeric_limits<double>::infinity();
    facts_.looks.push_back({static_cast<int>(state.samplesPerPixel), state.budget.total()});
    if (state.budget.fixed() >= target_.error)
        facts_.stop = converge::Stop::Fixed;
    else if (reached)
        facts_.stop = converge::Stop::Reached;
    else if (state.samplesPerPixel >= target_.maxSamples)
        facts_.stop = converge::Stop::Samples;
}

// Each row of samples has its own seed, so that two sequences can stand one behind the other.
PackedSamples ErrorGoal::taken() const {
    PackedSamples all;
    for (uint32_t number = 0; number < 2; ++number) {
        const uint32_t count = (number == 0 ? both_.first : both_.second).count();
        if (count == 0) continue;
        const PackedSamples part = converge::samplesOf(image_, number, count);
        all.rows.insert(all.rows.end(), part.rows.begin() + (all.rows.empty() ? 0 : shared::kFirstSample),
                        part.rows.end());
    }
    all.round = all.count();
    return all;
}

std::string inWords(const GoalFacts& facts, const ErrorSetting& setting) {
    const converge::ErrorBudget& budget = facts.state.budget;
    char text[160];
    if (facts.looks.empty()) {
        std::snprintf(text, sizeof(text), "error not known yet; until %.3g", setting.error);
    } else if (facts.stop == converge::Stop::Fixed) {
        const double other = budget.rounding + budget.cut;
        if (budget.depthCounts && !std::isfinite(budget.depth))
            return "out of reach: with depth 0 nobody knows what mirrors would show";
        if (budget.depthCounts && budget.depth > other)
            std::snprintf(text, sizeof(text), "out of reach: beyond the depth there may be %.2g",
                          budget.depth);
        else
            std::snprintf(text, sizeof(text), "out of reach: rounding and cuts may take %.2g", other);
    } else {
        const uint32_t samples = facts.state.samplesPerPixel;
        std::snprintf(text, sizeof(text), "error <= %.3g, %u sample%s", budget.total(), samples,
                      samples == 1 ? "" : "s");
        if (!facts.stop)
            std::snprintf(text, sizeof(text), "error <= %.3g after %u; until %.3g", budget.total(), samples,
                          setting.error);
    }
    return text;
}

}  // namespace glint::view
