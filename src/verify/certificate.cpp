#include "verify/certificate.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <memory>
#include <vector>

#include "core/vectors.h"
#include "reference/numbers.h"
#include "reference/scatter.h"

namespace glint::verify {

namespace {

using glm::dvec3;
using reference::Branch;
using reference::Jitter;
using reference::Step;

// Sizes of moves in rotation, as parts of kStepUnits: narrow gaps need small moves.
constexpr double kSizes[] = {1, 0.25, 1.0 / 34};
constexpr int kMovesAtOnce = 48, kTurns = 32;
// Least number of members of a class whose box may be missed by its own size; smaller classes may miss it by
// 4 times their size.
constexpr size_t kEnoughMembers = 8;
// Rays that one thread follows: each is deeper in the recursion, and a thread's stack of 8 MB is full after
// 2,350. Six overlapping glass balls make 2,800.
constexpr size_t kRaysOfThread = 256;

// Outcomes of one step that decide alike.
struct Outcome {
    Step step;      // of the first member
    Box box;        // Quantities, then origin, direction and throughput of each further ray
    Jitter jitter;  // of the first member
    size_t members = 1;
    size_t tried = 0;  // members when the rest of the path last began with this outcome
    double stretch = 0;
};

bool decideAlike(const Step& a, const Step& b) {
    return a.record.decisions == b.record.decisions && a.next.size() == b.next.size();
}

// Adds an answer to the class that decides alike, or as a new class.
void addTo(std::vector<std::shared_ptr<Outcome>>& outcomes, const std::shared_ptr<Outcome>& moved) {
    const auto at = std::find_if(outcomes.begin(), outcomes.end(), [&](const auto& outcome) {
        return decideAlike(outcome->step, moved->step);
    });
    if (at == outcomes.end()) {
        outcomes.push_back(moved);
        return;
    }
    (*at)->box.include(moved->box);
    ++(*at)->members;
    (*at)->jitter.ulps = std::min((*at)->jitter.ulps, moved->jitter.ulps);
}

bool takesHit(const Step& step, const TrailRay& ray) {
    return (step.record.hit ? step.record.hit->id : shared::kNone) == ray.id;
}

class Certifier {
  public:
    Certifier(const reference::Tracer& tracer, const PackedScene& scene, const SeenPath& seen,
              uint64_t mostSteps)
        : tracer_(tracer),
          scene_(scene),
          seen_(seen),
          trail_(*seen.trail),
          mostSteps_(mostSteps),
          lookups_(!tracer.model().textures.empty()) {}

    Certificate run(const reference::Ray& cameraRay) {
        pending_.push_back({tracer_.firstBranch(cameraRay), nullptr, 0});
        const bool holds = follow();
        result_.verdict = holds                         ? Certificate::Verdict::Holds
                          : result_.steps >= mostSteps_ ? Certificate::Verdict::Undecided
                                                        : Certificate::Verdict::Fails;
        return result_;
    }

  private:
    // A ray to follow, the step that produced it, and its index among the rays of that step.
    struct Pending {
        Branch branch;
        std::shared_ptr<Outcome> from;
        size_t number;
        Branch parent = {};
    };

    Step stepOf(const Branch& branch, const Jitter& jitter) {
        ++result_.steps;
        return tracer_.step(branch, jitter);
    }
    Box boxOf(const Branch& branch, const Step& step) const;
    // Follows the rest of the path, from the ray at cursor_.
    bool follow();
    bool startsAs(Pending& pending, const TrailRay& ray);
    bool startsWithin(const Pending& pending, const TrailRay& ray) const;
    bool explore(Branch branch, const TrailRay& ray);
    std::shared_ptr<Outcome> outcomeOf(const Branch& branch, Step step, const Jitter& jitter) const {
        Box box = boxOf(branch, step);
        return std::make_shared<Outcome>(Outcome{std::move(step), std::move(box), jitter});
    }
    // Tries the step without moves, with one order of surfaces in one place.
    bool exploreStill(const Branch& branch, const TrailRay& ray, const std::shared_ptr<Outcome>& still);
    bool exploreMoved(Branch branch, const TrailRay& ray, const Outcome& still);
    bool matches(const Outcome& outcome, const TrailRay& ray) const;
    bool widen(const Branch& branch, Outcome& still, const TrailRay* untilMatched);
    bool advance(const Branch& branch, const std::shared_ptr<Outcome>& outcome);
    dvec3 lightOf(size_t ray) const;
    bool exhausted() const { return failed_ || result_.steps >= mostSteps_; }

    const reference::Tracer& tracer_;
    const PackedScene& scene_;
    const SeenPath& seen_;
    const Trail& trail_;
    uint64_t mostSteps_;
    bool lookups_;  // the scene has textures: the next ray shows which texel the device has seen
    Certificate result_;
    size_t cursor_ = 0;
    std::vector<Pending> pending_;  // the next ray last
    uint32_t decisions_ = 0;        // of the steps so far
    // Beyond cursor_: some rounding of this step gives the device's hit and light, with lookups_ also its
    // next ray.
    size_t reached_ = 0;
    bool failed_ = false;  // no rounding of a step does
};

// The light that ray `ray` of the trail adds, without the sample's weight.
dvec3 Certifier::lightOf(size_t ray) const {
    const dvec3 all(seen_.first[0], seen_.first[1], seen_.first[2]);
    const dvec3 after = ray + 1 < trail_.size() ? trail_[ray + 1].sum / seen_.weight : all;
    return after - trail_[ray].sum / seen_.weight;
}

Box Certifier::boxOf(const Branch& branch, const Step& step) const {
    const auto& record = step.record;
    Quantities floors = floorsOf(scene_, record, branch.ray);
    // Differences of sums: each addition rounds the sum so far.
    const double sums = 8.0 * static_cast<double>(tracer_.lights().size() + 2) * kFloatUnit;
    const dvec3 before = trail_[cursor_].sum / seen_.weight;
    for (size_t i = 0; i < 3; ++i)
        floors[i] += sums * (std::abs(before[static_cast<int>(i)]) + std::abs(seen_.first[i]));
    Box box(quantitiesOf(record, scene_.origin), floors);
    if (step.next.empty()) return box;
    const double turn = 4 * reachOf(scene_, record, branch.ray).turn * kFloatUnit;
    for (const Branch& next : step.next) {
        const double way = kStepUnits * kFloatUnit * next.scale + 2 * next.clearance;
        box.add(next.ray.origin, dvec3(way));
        box.add(glm::normalize(next.ray.direction), dvec3(turn));
        const auto& [throughput, error] = next.throughput;
        box.add(throughput, kFloatUnit * (error + 8.0 * throughput) + kUnderflow);
    }
    return box;
}

bool Certifier::startsWithin(const Pending& pending, const TrailRay& ray) const {
    if (!pending.from) {
        if (!seen_.fromDevice) return true;
        const auto& camera = pending.branch.ray;
        const double way = 8 * kFloatUnit * std::max(greatestMagnitude(camera.origin), camera.originScale);
        return ray.throughput == dvec3(seen_.weight) && ray.sum == dvec3(0) &&
               greatestMagnitude(ray.origin - camera.origin) <= way &&
               greatestMagnitude(glm::normalize(ray.direction) - glm::normalize(camera.direction)) <=
                   16 * kFloatUnit * camera.directionScale;
    }
    const Outcome& from = *pending.from;
    const size_t at = kQuantities + 9 * pending.number;
    if (!from.box.contains(at + 6, ray.throughput / seen_.weight, from.stretch)) return false;
    return !seen_.fromDevice || (from.box.contains(at, ray.origin, from.stretch) &&
                                 from.box.contains(at + 3, glm::normalize(ray.direction), from.stretch));
}

bool Certifier::startsAs(Pending& pending, const TrailRay& ray) {
    if (startsWithin(pending, ray)) return true;
    if (!pending.from || pending.from->stretch > 0) return false;
    widen(pending.parent, *pending.from, nullptr);
    return startsWithin(pending, ray);
}

// Adds the response to moves of one unit that decide alike. untilMatched: ends once that ray's hit and light
// lie within.
bool Certifier::widen(const Branch& branch, Outcome& still, const TrailRay* untilMatched) {
    const bool instance = still.step.record.meetsInstance;
    still.stretch = kResponseGain * (instance ? 1 + scene_.instanceGain : 1);
    Jitter move = still.jitter;
    move.ulps = 1;
    for (uint64_t seed = 1; seed <= 2 * kResponseMoves; ++seed) {
        move.seed = seed;
        const Step step = stepOf(branch, move);
        if (!decideAlike(step, still.step)) continue;
        still.box.include(boxOf(branch, step));
        if (untilMatched && matches(still, *untilMatched)) return true;
    }
    return false;
}

bool Certifier::matches(const Outcome& outcome, const TrailRay& ray) const {
    const bool first = cursor_ == 0, hit = ray.id != shared::kNone;
    Quantities device = seen_.first;
    const dvec3 light = lightOf(cursor_);
    for (int i = 0; i < 3; ++i) device[static_cast<size_t>(i)] = light[i];
    if (!first && hit) device[kColorQuantities] = ray.t;
    const size_t ofFirst = seen_.fromDevice ? kQuantities : kSceneQuantities;
    const size_t count = first ? ofFirst : kColorQuantities + (hit ? 1 : 0);
    return outcome.box.contains(0, std::span(device).first(count), outcome.stretch);
}

bool Certifier::advance(const Branch& branch, const std::shared_ptr<Outcome>& outcome) {
    const size_t waiting = pending_.size();
    for (size_t i = outcome->step.next.size(); i-- > 0;)
        pending_.push_back({outcome->step.next[i], outcome, i, branch});
    const uint32_t before = decisions_;
    decisions_ = reference::addDecisions(before, outcome->step.record.decisions);
    ++cursor_;
    if (outcome->step.next.empty()) reached_ = cursor_;
    const bool holds = cursor_ % kRaysOfThread != 0
                           ? follow()
                           : std::async(std::launch::async, [this] { return follow(); }).get();
    if (holds) return true;
    --cursor_;
    decisions_ = before;
    pending_.resize(waiting);
    return false;
}

bool Certifier::follow() {
    if (pending_.empty()) {
        result_.decisions = decisions_;
        return cursor_ == trail_.size();
    }
    if (cursor_ == trail_.size() || exhausted()) return false;
    Pending& next = pending_.back();
    const TrailRay& ray = trail_[cursor_];
    if (!startsAs(next, ray)) return false;
    const Pending kept = next;
    Branch branch = kept.branch;
    branch.ray.origin = ray.origin;
    branch.ray.direction = ray.direction;
    // Without textures the noise of the ray before stays: unmoved rays that touch a quadric need it.
    if (lookups_) branch.ray.noise = {};
    branch.throughput.value = ray.throughput / seen_.weight;
    branch.throughput.error = dvec3(0);
    pending_.pop_back();
    if (explore(std::move(branch), ray)) return true;
    pending_.push_back(kept);
    return false;
}

bool Certifier::exploreStill(const Branch& branch, const TrailRay& ray,
                             const std::shared_ptr<Outcome>& still) {
    if (!takesHit(still->step, ray)) return false;
    if (!matches(*still, ray) && !widen(branch, *still, &ray)) return false;
    if (!lookups_) reached_ = cursor_ + 1;
    return advance(branch, still);
}

bool Certifier::explore(Branch branch, const TrailRay& ray) {
    reached_ = cursor_;
    const auto still = outcomeOf(branch, stepOf(branch, {}), {});
    if (exploreStill(branch, ray, still)) return true;
    ++result_.openDecisions;
    for (const double slips : {1.0, 0.0, reference::kMostSlips}) {
        if (exhausted()) return false;
        const Jitter rule{.slips = slips, .hit = ray.id};
        const auto open = outcomeOf(branch, stepOf(branch, rule), rule);
        if (!decideAlike(open->step, still->step) && exploreStill(branch, ray, open)) return true;
    }
    --result_.openDecisions;
    return !exhausted() && exploreMoved(std::move(branch), ray, *still);
}

// Tries moves of this step whose decisions differ from the reference's, or whose answer changes more than its
// response to one unit.
bool Certifier::exploreMoved(Branch branch, const TrailRay& ray, const Outcome& still) {
    std::vector<std::shared_ptr<Outcome>> outcomes;
    // Moves that take the hit, at t from lo to hi on each of its sides. Each move serves for several lookups:
    // it may be one of few that pass the masks before the hit.
    std::vector<Jitter> taken;
    glm::dvec2 lo(std::numeric_limits<double>::infinity()), hi(0);
    uint64_t seed = 0;
    const double gain = scene_.instances.empty() ? 1 : 1 + scene_.instanceGain;
    if (const auto& surface = still.step.record.surface)
        branch.scale = std::max(branch.scale, surface->scale);
    for (int turn = 0; turn < kTurns && !exhausted(); ++turn) {
        // Every other turn adds the error of an instance's transform.
        const bool wide = gain > 1 && turn % 2 == 1;
        for (int i = 0; i < kMovesAtOnce; ++i) {
            const double units = kStepUnits * kSizes[i % 3] * (wide ? gain : 1);
            Jitter move{
                .seed = ++seed, .ulps = units, .formulas = true, .hit = ray.id, .t = lookups_ ? ray.t : 0};
            const bool again = lookups_ && i % 2 == 1 && !taken.empty();
            if (again) move = taken[seed % taken.size()];
            move.hidden = static_cast<uint32_t>(seen_.first[kShadows]);
            move.lookup = seen_.fromDevice ? 2 + seed / 2 : 2 * seed + 1;
            Step step = stepOf(branch, move);
            if (!takesHit(step, ray)) continue;
            if (wide && !step.record.meetsInstance && !still.step.record.meetsInstance) continue;
            if (!again) taken.push_back(move);
            lo[step.enters] = std::min(lo[step.enters], step.t);
            hi[step.enters] = std::max(hi[step.enters], step.t);
            if (step.record.surface) branch.scale = std::max(branch.scale, step.record.surface->scale);
            addTo(outcomes, outcomeOf(branch, std::move(step), move));
        }
        for (size_t i = 0; i < outcomes.size() && !exhausted(); ++i) {
            Outcome& outcome = *outcomes[i];
            if (outcome.members == outcome.tried) continue;
            outcome.stretch = outcome.members >= kEnoughMembers ? 1 : outcome.members > 1 ? 4 : 0;
            outcome.box.lo[kColorQuantities] = lo[outcome.step.enters];
            outcome.box.hi[kColorQuantities] = hi[outcome.step.enters];
            if (!matches(outcome, ray)) continue;
            if (!lookups_) reached_ = cursor_ + 1;
            outcome.tried = outcome.members;
            const double before = result_.units;
            result_.units = std::max(result_.units, outcome.jitter.ulps);
            ++result_.openDecisions;
            if (advance(branch, outcomes[i])) return true;
            --result_.openDecisions;
            result_.units = before;
        }
        // If rounding gives this hit, light and next ray, but not the rest, more moves do not help.
        if (reached_ > cursor_ && turn >= 3) break;
    }
    failed_ = failed_ || reached_ <= cursor_;
    return false;
}

}  // namespace

Trail trailOf(const reference::PixelRecord& record) {
    Trail trail;
    dvec3 sum(0);
    for (const reference::Bounce& bounce : record.path) {
        const reference::Hit hit = bounce.hit.value_or(reference::Hit{.id = shared::kNone});
        trail.push_back({bounce.ray.origin, bounce.ray.direction, hit.t, hit.id, bounce.throughput, sum});
        sum += bounce.light;
    }
    return trail;
}

Certificate certify(const reference::Tracer& tracer, const PackedScene& scene,
                    const reference::Ray& cameraRay, const SeenPath& seen, uint64_t mostSteps) {
    return Certifier(tracer, scene, seen, mostSteps).run(cameraRay);
}

}  // namespace glint::verify
