#include "view/error_goal.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/text_file.h"

namespace glint::view {

ErrorGoal::ErrorGoal(const converge::Target& target, const ImageSettings& image, const Region& region,
                     bool knowsDepth)
    : target_(target), image_(image), region_(region), knowsDepth_(knowsDepth), both_(image_, target_) {}

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
    facts_.bounds.push_back(state.budget.total());
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

std::string inWords(const GoalFacts& facts, double error) {
    const converge::ErrorBudget& budget = facts.state.budget;
    const uint32_t samples = facts.state.samplesPerPixel;
    const double other = budget.rounding + budget.cut;
    char text[160];
    if (facts.bounds.empty())
        std::snprintf(text, sizeof(text), "error not known yet; until %.3g", error);
    else if (!facts.stop)
        std::snprintf(text, sizeof(text), "error <= %.3g after %u; until %.3g", budget.total(), samples,
                      error);
    else if (facts.stop != converge::Stop::Fixed)
        std::snprintf(text, sizeof(text), "error <= %.3g, %s", budget.total(),
                      counted(samples, "sample").c_str());
    else if (budget.depthCounts && !std::isfinite(budget.depth))
        return "out of reach: with depth 0 no bound on reflections is known";
    else if (budget.depthCounts && budget.depth > other)
        std::snprintf(text, sizeof(text), "out of reach: beyond the depth there may be %.2g", budget.depth);
    else
        std::snprintf(text, sizeof(text), "out of reach: rounding and cuts may take %.2g", other);
    return text;
}

}  // namespace glint::view
