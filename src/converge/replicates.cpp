#include "converge/replicates.h"

#include <algorithm>
#include <cmath>

namespace glint::converge {

namespace {

// Replicate 0 has the user's own seed.
ImageSettings settingsOf(const ImageSettings& image, uint32_t number) {
    ImageSettings settings = image;
    settings.seed += 0x9e3779b9u * number;  // 2^32 over the golden ratio: no two of many numbers come near
    return settings;
}

// The root mean square over the pixels of bounds that sum to `sum`, each at most `greatest`, is largest if as
// many pixels as possible have the greatest.
double boundOf(const LostBranches& lost, size_t pixels, uint64_t samples) {
    if (lost.count == 0 || samples == 0) return 0;
    const double taken = static_cast<double>(samples);
    return std::sqrt(lost.greatest / taken * (lost.sum / taken) / static_cast<double>(pixels));
}

void addWeighted(LostBranches& sum, const LostBranches& batch, double weight) {
    sum.count += batch.count;
    sum.sum += batch.sum * weight;
    sum.greatest += batch.greatest * weight;
}

// The first `count` samples of a replicate.
PackedSamples samplesOf(const ImageSettings& image, uint32_t number, uint32_t count) {
    return SampleSequence(settingsOf(image, number)).next(count);
}

}  // namespace

Replicates::Replicates(const ImageSettings& image, const Target& target, bool knowsDepth)
    : first{SampleSequence(settingsOf(image, 0))},
      second{SampleSequence(settingsOf(image, 1))},
      looks(target.confidence),
      image_(image),
      target_(target),
      knowsDepth_(knowsDepth) {}

PackedSamples Replicates::begin(uint32_t count) {
    taking_ = count;
    flaws_ = {};
    return fewer().sequence.next(count);
}

void Replicates::add(const Picture& part, const Region& whole) {
    Replicate& replicate = fewer();
    replicate.means.resize(whole.pixels(), glm::dvec3(0));
    replicate.alphas.resize(whole.pixels(), 0.0);
    const double share = static_cast<double>(taking_) / static_cast<double>(replicate.count + taking_);
    const float* pixel = part.color.pixels.data();
    for (int y = part.region.y0; y < part.region.y1; ++y) {
        size_t at = static_cast<size_t>(y - whole.y0) * static_cast<size_t>(whole.width()) +
                    static_cast<size_t>(part.region.x0 - whole.x0);
        for (int x = part.region.x0; x < part.region.x1; ++x, ++at, pixel += 4) {
            glm::dvec3& mean = replicate.means[at];
            mean += share * (glm::dvec3(pixel[0], pixel[1], pixel[2]) - mean);
            replicate.alphas[at] += share * (pixel[3] - replicate.alphas[at]);
        }
    }
    flaws_.add(part);
}

void Replicates::end() {
    Replicate& replicate = fewer();
    ledger.add(flaws_, replicate.means.size(), taking_);
    replicate.count += taking_;
}

// Each row of samples has its own seed, so that two sequences can stand one behind the other.
PackedSamples Replicates::taken() const {
    PackedSamples all;
    for (uint32_t number = 0; number < 2; ++number) {
        const uint32_t count = (number == 0 ? first : second).count;
        if (count == 0) continue;
        const PackedSamples part = samplesOf(image_, number, count);
        all.rows.insert(all.rows.end(), part.rows.begin() + (all.rows.empty() ? 0 : shared::kFirstSample),
                        part.rows.end());
    }
    all.round = all.count();
    return all;
}

void Replicates::look(double rounding) {
    ++state.rounds;
    state.samplesPerPixel = 2 * first.count;
    ErrorBudget& budget = state.budget;
    budget.rounding = rounding;
    budget.depthCounts = target_.depthCounts;
    ledger.writeTo(budget);
    if (!knowsDepth_) budget.depth = std::numeric_limits<double>::infinity();
    // Slightly less, so that the rounded sum of all parts is at most the target.
    const double allowed = (target_.error - budget.fixed()) * (1 - 1e-15);
    const bool reached = looks.look(meanSquareOf(first.means, second.means), first.count, allowed);
    budget.sampling = looks.bound();
    state.estimate = looks.estimate();
    if (reached)
        state.stop = Stop::Reached;
    else if (budget.fixed() >= target_.error)
        state.stop = Stop::Fixed;
    else if (state.samplesPerPixel + 2 * leastSamples(image_.filter) > target_.maxSamples)
        state.stop = Stop::Samples;
}

void Replicates::writeTo(Picture& picture) const {
    static_cast<PictureFlaws&>(picture) = ledger.flaws();
    picture.samples.assign(picture.done.size(), first.count + second.count);
    picture.errors.resize(picture.done.size());
    // After an interrupt the second replicate may have fewer samples than the first.
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const glm::dvec3 a = first.means[i], b = second.means[i], error = glm::abs(a - b) / 2.0;
        for (int c = 0; c < 3; ++c) picture.color.pixels[4 * i + c] = static_cast<float>((a[c] + b[c]) / 2);
        picture.color.pixels[4 * i + 3] = static_cast<float>((first.alphas[i] + second.alphas[i]) / 2);
        picture.errors[i] = static_cast<float>(std::max({error.x, error.y, error.z}));
    }
}

void Ledger::add(const PictureFlaws& flaws, size_t pixels, uint32_t count) {
    const double weight = count;
    addWeighted(flaws_.losses.cut, flaws.losses.cut, weight);
    addWeighted(flaws_.losses.depth, flaws.losses.depth, weight);
    addWeighted(flaws_.losses.room, flaws.losses.room, weight);
    flaws_.losses.crowdedMedia += flaws.losses.crowdedMedia;
    flaws_.notFinite = std::max(flaws_.notFinite, flaws.notFinite);
    if (flaws_.firstNotFinite.x < 0) flaws_.firstNotFinite = flaws.firstNotFinite;
    samples_ += count;
    pixels_ = pixels;
}

double Ledger::depth() const {
    return boundOf(flaws_.losses.depth, pixels_, samples_);
}

void Ledger::writeTo(ErrorBudget& budget) const {
    budget.depth = depth();
    budget.cut =
        boundOf(flaws_.losses.cut, pixels_, samples_) + boundOf(flaws_.losses.room, pixels_, samples_);
}

PictureFlaws Ledger::flaws() const {
    const double taken = static_cast<double>(std::max<uint64_t>(samples_, 1));
    PictureFlaws mean = flaws_;
    for (LostBranches* lost : {&mean.losses.cut, &mean.losses.depth, &mean.losses.room}) {
        lost->sum /= taken;
        lost->greatest /= taken;
    }
    return mean;
}

}  // namespace glint::converge
