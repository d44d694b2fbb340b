#include "converge/replicates.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/format.h"
#include "core/stopwatch.h"
#include "scene/limits.h"

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

// The greatest depth that is tried for advice; deeper paths carry light only between lossless mirrors.
constexpr uint32_t kDeepestAdvice = 127;
static_assert(kDeepestAdvice <= kMaxBounces);

constexpr double kAdviceSeconds = 2;

std::string number(double value) {
    return format("%.2g", value);
}

// Finds a depth that leaves out less than `allowed`, by one sample of each pixel.
std::string depthAdvice(const Draw& draw, const Job& job, double allowed) {
    const Stopwatch watch;
    Request request = job.request;
    request.data = request.cost = false;
    request.cancelled = [&] {
        return watch.seconds() > kAdviceSeconds || (job.request.cancelled && job.request.cancelled());
    };
    uint32_t depth = job.request.limits.depth.value();
    while (depth < kDeepestAdvice) {
        depth = std::min<uint32_t>(2 * depth + 1, kDeepestAdvice);
        request.limits.depth = depth;
        Ledger ledger;
        const uint32_t count = leastSamples(job.request.image.filter);
        const Draw counted = [&](const Request& r) {
            Picture picture = draw(r);
            ledger.add(picture, count);
            return picture;
        };
        if (!Replicate(job.request.image, 0).take(counted, request, count))
            return "maxDepth " + std::to_string(depth) + " takes too long to try";
        if (ledger.depth() < allowed) return "--max-depth " + std::to_string(depth) + " would do";
    }
    return "no maxDepth up to " + std::to_string(kDeepestAdvice) + " would do";
}

// Half an ulp at 1 of the fp32 that images store.
constexpr double kStored = 0x1p-24;

std::string roundingAdvice(const Job& job, double rounding) {
    if (job.inDouble) return " though computed in double, as pixels are stored as floats";
    const double inDouble = kStored + (rounding - kStored) * 0x1p-29;  // 2^-53 instead of 2^-24
    if (inDouble < job.target.error) return " on this device; --backend cpu computes in double";
    return " on this device, and " + number(inDouble) + " in double precision";
}

}  // namespace

PackedSamples samplesOf(const ImageSettings& image, uint32_t number, uint32_t count) {
    return SampleSequence(settingsOf(image, number)).next(count);
}

Replicate::Replicate(const ImageSettings& image, uint32_t number) : sequence_(settingsOf(image, number)) {}

PackedSamples Replicate::begin(uint32_t count) {
    taking_ = count;
    return sequence_.next(count);
}

void Replicate::add(const Picture& part, const Region& whole) {
    const uint64_t pixels = whole.pixels();
    means_.resize(pixels, glm::dvec3(0));
    alphas_.resize(pixels, 0.0);
    const double share = static_cast<double>(taking_) / static_cast<double>(count_ + taking_);
    const float* pixel = part.color.pixels.data();
    for (int y = part.region.y0; y < part.region.y1; ++y) {
        size_t at = static_cast<size_t>(y - whole.y0) * static_cast<size_t>(whole.width()) +
                    static_cast<size_t>(part.region.x0 - whole.x0);
        for (int x = part.region.x0; x < part.region.x1; ++x, ++at, pixel += 4) {
            means_[at] += share * (glm::dvec3(pixel[0], pixel[1], pixel[2]) - means_[at]);
            alphas_[at] += share * (pixel[3] - alphas_[at]);
        }
    }
}

void Replicate::end() {
    count_ += taking_;
    taking_ = 0;
}

bool Replicate::take(const Draw& draw, const Request& request, uint32_t count) {
    Request batch = request;
    batch.samples = begin(count);
    const Picture picture = draw(batch);
    if (!picture.complete) return false;
    add(picture, picture.region);
    end();
    return true;
}

bool Replicates::look(const Target& target, double rounding, State& state) {
    ++state.rounds;
    state.samplesPerPixel = 2 * first.count();
    state.budget.rounding = rounding;
    state.budget.depthCounts = target.depthCounts;
    ledger.writeTo(state.budget);
    // Slightly less, so that the rounded sum of all parts is at most the target.
    const double allowed = (target.error - state.budget.fixed()) * (1 - 1e-15);
    const bool reached = looks.look(meanSquareOf(first.means(), second.means()), first.count(), allowed);
    state.budget.sampling = looks.bound();
    state.estimate = looks.estimate();
    return reached;
}

void Replicates::writeTo(Picture& picture) const {
    picture.samples.assign(picture.done.size(), first.count() + second.count());
    picture.errors.resize(picture.done.size());
    // After an interrupt the second replicate may have fewer samples than the first.
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const glm::dvec3 a = first.means()[i], b = second.means()[i], error = glm::abs(a - b) / 2.0;
        for (int c = 0; c < 3; ++c) picture.color.pixels[4 * i + c] = static_cast<float>((a[c] + b[c]) / 2);
        picture.color.pixels[4 * i + 3] = static_cast<float>((first.alphas()[i] + second.alphas()[i]) / 2);
        picture.errors[i] = static_cast<float>(std::max({error.x, error.y, error.z}));
    }
}

void Ledger::add(const TreeLosses& losses, size_t pixels, uint32_t count) {
    const double weight = count;
    addWeighted(losses_.cut, losses.cut, weight);
    addWeighted(losses_.depth, losses.depth, weight);
    addWeighted(losses_.room, losses.room, weight);
    losses_.crowdedMedia += losses.crowdedMedia;
    samples_ += count;
    pixels_ = pixels;
}

void Ledger::add(const Picture& picture, uint32_t count) {
    add(picture.losses, picture.done.size(), count);
    notFinite_ = std::max(notFinite_, picture.notFinite);
    if (firstNotFinite_.x < 0) firstNotFinite_ = picture.firstNotFinite;
    if (data_.empty()) data_ = picture.data;
}

double Ledger::depth() const {
    return boundOf(losses_.depth, pixels_, samples_);
}

void Ledger::writeTo(ErrorBudget& budget) const {
    budget.depth = depth();
    budget.cut = boundOf(losses_.cut, pixels_, samples_) + boundOf(losses_.room, pixels_, samples_);
}

void Ledger::writeTo(Picture& picture) const {
    const double taken = static_cast<double>(std::max<uint64_t>(samples_, 1));
    picture.losses = losses_;
    for (LostBranches* lost : {&picture.losses.cut, &picture.losses.depth, &picture.losses.room}) {
        lost->sum /= taken;
        lost->greatest /= taken;
    }
    picture.notFinite = notFinite_;
    picture.firstNotFinite = firstNotFinite_;
    picture.data = data_;
}

void checkReachable(const Draw& draw, const Job& job, const ErrorBudget& budget) {
    const double wanted = job.target.error;
    if (budget.fixed() < wanted) return;
    const std::string start = "an error of " + number(wanted) + " is out of reach: ";
    if (budget.rounding >= wanted)
        throw Error(ErrorKind::Argument, start + "rounding alone may take " + number(budget.rounding) +
                                             roundingAdvice(job, budget.rounding));
    if (budget.rounding + budget.cut >= wanted)
        throw Error(ErrorKind::Argument, start + "branches that were cut may have added " +
                                             number(budget.cut) + "; use a lower --min-contribution");
    throw Error(ErrorKind::Argument, start + "reflections and refractions beyond maxDepth may add " +
                                         number(budget.depth) + "; " +
                                         depthAdvice(draw, job, wanted / 2 - budget.rounding - budget.cut) +
                                         "; --within-depth counts nothing beyond maxDepth");
}

}  // namespace glint::converge
