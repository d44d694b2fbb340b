#include "converge/replicates.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/stopwatch.h"
#include "scene/limits.h"

namespace glint::converge {

namespace {

ImageSettings settingsOf(const ImageSettings& image, uint32_t number) {
    ImageSettings settings = image;
    settings.seed = seedOf(image.seed, number);
    return settings;
}

// The root mean square over the pixels of bounds that sum to `sum`, none above `greatest`, is largest where
// as many pixels as possible have the greatest.
double boundOf(const LostBranches& lost, size_t pixels, uint64_t samples, Measure measure) {
    if (lost.count == 0 || samples == 0) return 0;
    const double taken = static_cast<double>(samples);
    const double greatest = lost.greatest / taken;
    if (measure == Measure::Pixel) return greatest;
    return std::sqrt(greatest * (lost.sum / taken) / static_cast<double>(pixels));
}

void addWeighted(LostBranches& sum, const LostBranches& batch, double weight) {
    sum.count += batch.count;
    sum.sum += batch.sum * weight;
    sum.greatest += batch.greatest * weight;
}

// Deeper than this is not tried for advice: paths that still carry light are those of mirrors that lose none.
constexpr uint32_t kDeepestAdvice = 127;
static_assert(kDeepestAdvice <= kMaxBounces);

constexpr double kAdviceSeconds = 2;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.2g", value);
    return text;
}

// Which depth leaves out less than `allowed`: tried by a sample of each pixel. What lies beyond falls with
// the depth in most scenes; mirrors that lose nothing keep all of it, and trees of rays may grow too large to
// try.
std::string depthAdvice(const Draw& draw, const Job& job, double allowed) {
    const Stopwatch watch;
    Request request = job.request;
    request.data = request.cost = false;
    request.cancelled = [&] {
        return watch.seconds() > kAdviceSeconds || (job.request.cancelled && job.request.cancelled());
    };
    uint32_t depth = job.request.maxDepth.value_or(job.maxDepth);
    while (depth < kDeepestAdvice) {
        depth = std::min<uint32_t>(2 * depth + 1, kDeepestAdvice);
        request.maxDepth = depth;
        Ledger ledger;
        const uint32_t count = leastSamples(job.image.filter);
        const Draw counted = [&](const Request& r) {
            Picture picture = draw(r);
            ledger.add(picture, count);
            return picture;
        };
        if (!Replicate(job.image, 0).take(counted, request, count))
            return "maxDepth " + std::to_string(depth) + " takes too long to try";
        if (ledger.depth(job.target.measure) < allowed)
            return "--max-depth " + std::to_string(depth) + " would do";
    }
    return "no maxDepth up to " + std::to_string(kDeepestAdvice) + " would do";
}

// Pixels are stored as fp32, whatever computes them: half of its last digit is left of any picture.
constexpr double kStored = 0x1p-24;

std::string roundingAdvice(const Job& job, double rounding) {
    if (job.inDouble) return " though computed in double, as pixels are stored as floats";
    const double inDouble = kStored + (rounding - kStored) * 0x1p-29;  // 2^-53 instead of 2^-24
    if (inDouble < job.target.error) return " on this device; --backend cpu computes in double";
    return " on this device, and " + number(inDouble) + " in double precision";
}

}  // namespace

uint32_t seedOf(uint32_t seed, uint32_t number) {
    return seed + 0x9e3779b9u * number;  // 2^32 over the golden ratio: no two of many numbers come near
}

PackedSamples samplesOf(const ImageSettings& image, uint32_t number, uint32_t count) {
    return SampleSequence(settingsOf(image, number)).next(count);
}

Replicate::Replicate(const ImageSettings& image, uint32_t number) : sequence_(settingsOf(image, number)) {}

PackedSamples Replicate::begin(uint32_t count) {
    taking_ = count;
    return sequence_.next(count);
}

void Replicate::add(const Picture& part, const Region& whole) {
    const size_t pixels = static_cast<size_t>(whole.width()) * static_cast<size_t>(whole.height());
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

Sums::Sums(const ImageSettings& image, uint32_t number, SpotPlan spotPlan) : Sums(image, number) {
    plan = std::move(spotPlan);
    for (const Region& region : plan.regions) {
        spots.push_back({region, {}});
        for (uint32_t i = 0; i < plan.replicates; ++i)
            spots.back().replicates.emplace_back(image, number + 2 + i);
    }
}

namespace {

// Of the places of `region` in `whole`, and in itself.
template <class Use>
void eachPixel(const Region& region, const Region& whole, Use&& use) {
    size_t i = 0;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x, ++i)
            use(static_cast<size_t>(y - whole.y0) * static_cast<size_t>(whole.width()) +
                    static_cast<size_t>(x - whole.x0),
                i);
}

// Mean of the replicates' means of a pixel, and the mean square of its error by channel.
struct PixelError {
    glm::dvec3 mean{0}, square{0};
};

PixelError errorOf(const std::vector<Replicate>& replicates, size_t pixel) {
    const auto count = static_cast<double>(replicates.size());
    PixelError error;
    for (const Replicate& r : replicates) error.mean += r.means()[pixel] / count;
    for (const Replicate& r : replicates) {
        const glm::dvec3 away = r.means()[pixel] - error.mean;
        error.square += away * away / (count * (count - 1));
    }
    return error;
}

}  // namespace

std::vector<double> Sums::squares(const Region& whole) const {
    std::vector<double> all(first.means().size());
    for (size_t i = 0; i < all.size(); ++i) {
        const glm::dvec3 half = (first.means()[i] - second.means()[i]) / 2.0;
        all[i] = glm::dot(half, half) / 3;
    }
    for (const Spot& spot : spots)
        eachPixel(spot.region, whole, [&](size_t at, size_t i) {
            const glm::dvec3 square = errorOf(spot.replicates, i).square;
            all[at] = (square.x + square.y + square.z) / 3;
        });
    return all;
}

MeanSquare Sums::estimate(const Region& whole) const {
    const std::vector<double> all = squares(whole);
    std::vector<uint32_t> replicates(all.size(), 2);
    for (const Spot& spot : spots)
        eachPixel(spot.region, whole, [&](size_t at, size_t) { replicates[at] = plan.replicates; });
    MeanSquareSum sum;
    for (size_t i = 0; i < all.size(); ++i) sum.add(all[i], replicates[i]);
    return sum.result();
}

void Sums::writeTo(Picture& picture) const {
    const auto write = [&](size_t at, const glm::dvec3& mean, double alpha, const glm::dvec3& error) {
        float* pixel = &picture.color.pixels[at * 4];
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(mean[c]);
        pixel[3] = static_cast<float>(alpha);
        picture.errors[at] = static_cast<float>(std::max({error.x, error.y, error.z}));
    };
    picture.samples.assign(picture.done.size(), first.count() + second.count());
    picture.errors.resize(picture.done.size());
    // Interrupted between the replicates, the second is behind; the first's sums went on.
    for (size_t i = 0; i < picture.done.size(); ++i) {
        const glm::dvec3 a = first.means()[i], b = second.means()[i];
        write(i, (a + b) / 2.0, (first.alphas()[i] + second.alphas()[i]) / 2, glm::abs(a - b) / 2.0);
    }
    for (const Spot& spot : spots) {
        uint32_t taken = 0;
        for (const Replicate& r : spot.replicates) taken += r.count();
        eachPixel(spot.region, picture.region, [&](size_t at, size_t i) {
            double alpha = 0;
            for (const Replicate& r : spot.replicates) alpha += r.alphas()[i] / plan.replicates;
            const PixelError error = errorOf(spot.replicates, i);
            write(at, error.mean, alpha, glm::sqrt(error.square));
            picture.samples[at] = taken;
        });
    }
}

bool Replicates::look(const Target& target, double rounding, const Region& whole, State& state) {
    ++state.rounds;
    state.samplesPerPixel = mostEach() * first.count();
    state.leastSamples = 2 * first.count();
    state.budget.rounding = rounding;
    state.budget.depthCounts = target.depthCounts;
    ledger.writeTo(state.budget, Measure::Rmse);
    // So little less that the sum of all parts, rounded, is not above the target.
    const double allowed = (target.error - state.budget.fixed()) * (1 - 1e-15);
    const bool reached = looks.look(estimate(whole), first.count(), allowed);
    state.budget.sampling = looks.bound();
    state.estimate = looks.estimate();
    return reached;
}

void Replicates::goOnWith(Sums&& other) {
    static_cast<Sums&>(*this) = std::move(other);
    looks.startAnew();
}

void Ledger::addFaults(const Picture& picture) {
    notFinite_ = std::max(notFinite_, picture.notFinite);
    if (firstNotFinite_.x < 0) firstNotFinite_ = picture.firstNotFinite;
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
    addFaults(picture);
    if (data_.empty()) data_ = picture.data;
}

double Ledger::depth(Measure measure) const {
    return boundOf(losses_.depth, pixels_, samples_, measure);
}

void Ledger::writeTo(ErrorBudget& budget, Measure measure) const {
    budget.depth = depth(measure);
    budget.cut =
        boundOf(losses_.cut, pixels_, samples_, measure) + boundOf(losses_.room, pixels_, samples_, measure);
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
                                             number(budget.cut) + "; ask for a lower --min-contribution");
    throw Error(ErrorKind::Argument,
                start + "reflections and refractions beyond maxDepth may add " + number(budget.depth) + "; " +
                    depthAdvice(draw, job, wanted / 2 - budget.rounding - budget.cut) +
                    "; --within-depth takes the depth as it is, and counts nothing beyond it");
}

}  // namespace glint::converge
