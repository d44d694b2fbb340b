#include "verify/verify.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <mutex>
#include <span>
#include <tuple>

#include "core/parallel.h"
#include "core/vectors.h"
#include "reference/sampling.h"
#include "verify/certificate.h"
#include "verify/film.h"

namespace glint::verify {

namespace {

constexpr float kDifferenceGain = 64;

// Steps of the reference that certificates of a sample may take: as many times its own, and some for small
// images.
constexpr uint64_t kStepsOfRay = 3, kLeastSteps = 1'000'000;
// Pixels that are certified between two looks at the steps left, and whose trails are held at a time.
constexpr size_t kCertifiedAtOnce = 64, kTrailsAtOnce = 256 * kCertifiedAtOnce;

// Sums over a row's pixels. Rows are added in order, so that results do not depend on the threads.
struct Row {
    explicit Row(double radianceBound) : account(radianceBound) {}
    Account account;
    double squares = 0, squaresSamePath = 0, maxSamePath = 0;
    uint64_t samePath = 0, rays = 0;
    std::vector<DifferingPixel> differing;
};

// True if the pixel's alpha is the sample's weight where the device has hit anything, and 0 elsewhere. The
// weight is rounded once, and so are the inverse of the count and the product with it.
bool isCovered(float alpha, const PixelData& data, double weight) {
    const double expected = data.object == PixelData::kNoIndex ? 0 : weight;
    return std::abs(static_cast<double>(alpha) - expected) <= 4 * kFloatUnit * std::abs(expected);
}

bool worseThan(const DifferingPixel& a, const DifferingPixel& b) {
    const auto rank = [](const DifferingPixel& pixel) {
        return std::tuple(pixel.reason != Reason::Unexplained, -pixel.difference, pixel.y, pixel.x);
    };
    return rank(a) < rank(b);
}

// Counts a pixel, and paints it in the image of differences.
void addDiffering(Report& report, DifferingPixel&& pixel) {
    struct Entry {
        uint64_t Report::*count;
        glm::vec3 color;
    };
    static const Entry entries[] = {{&Report::edges, {1, 0.8f, 0}},
                                    {&Report::roundings, {0.1f, 0.8f, 0.2f}},
                                    {&Report::undecided, {0.8f, 0, 0.8f}},
                                    {&Report::unexplained, {1, 0, 0}}};
    const Entry& entry = entries[static_cast<size_t>(pixel.reason)];
    ++(report.*entry.count);
    for (int c = 0; pixel.sample == 0 && c < 3; ++c)
        report.difference.at(pixel.x, pixel.y, c) = entry.color[c];
    report.worst.push_back(std::move(pixel));
}

class Verification {
  public:
    Verification(render::Renderer& renderer, const PackedScene& scene, const shared::Camera& camera,
                 const Options& options, const Scene* read, Report& report)
        : renderer_(renderer),
          scene_(scene),
          camera_(camera),
          options_(options),
          samples_(options.samples),
          context_{.cancelled = options.cancelled},
          tracer_(scene, options),
          report_(report) {
        if (read != nullptr) representation_.emplace(*read, scene, tracer_, camera, options);
    }

    // Throws Cancelled.
    void run();

  private:
    Request requestFor(const PackedSamples& samples) const;
    Picture rendered(const Request& request) const;
    reference::PixelSample sampleAt(uint32_t sample, int x, int y) const {
        return reference::pixelSample(tracer_, camera_, samples_, sample, x, y);
    }
    // True if nothing else matters.
    bool isConvicted() const { return options_.verdictAlone && report_.unexplained > 0; }

    void compareSample(uint32_t sample, const Request& request, const Picture& device);
    void comparePixel(int x, int y, uint32_t sample, const Picture& device, Row& row);
    void addColors(const DifferingPixel& pixel, Row& row);
    void certifyDoubts(std::vector<DifferingPixel>& differing, const Request& request, uint64_t steps) const;
    std::vector<Trail> trailsOf(std::span<DifferingPixel* const> pixels, const Request& request) const;
    void certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t& steps) const;
    bool decidesAlike(const reference::Ray& ray, const Certificate& certificate) const;
    std::vector<size_t> plainDifferences(const Picture& device) const;
    std::vector<size_t> filmDifferences(const PackedSamples& rounds, Film& film) const;
    uint64_t countSettled(uint32_t first, uint32_t end, const std::vector<size_t>& pixels) const;

    render::Renderer& renderer_;
    const PackedScene& scene_;
    const shared::Camera& camera_;
    const Options& options_;
    const PackedSamples& samples_;
    Context context_;
    reference::Tracer tracer_;
    std::optional<RepresentationCheck> representation_;
    Report& report_;
    uint64_t samePath_ = 0;  // pixels
    // By sample and pixel: the colour's difference, infinite where the device's is not finite.
    std::vector<float> differences_;
};

void Verification::run() {
    for (Image* image : {&report_.device, &report_.reference, &report_.difference})
        *image = Image(options_.width, options_.height, 3);
    report_.allowedUnexplained = options_.allowedUnexplained;
    report_.pixels = static_cast<uint64_t>(options_.width) * options_.height * samples_.round;
    report_.sensitivity = sensitivityOf(tracer_, camera_, options_.width, options_.height, samples_);
    differences_.resize(report_.pixels);
    const PackedSamples rounds = firstRounds(samples_);
    Film film(rounds, options_.width, options_.height, scene_.lights.size());
    for (uint32_t sample = 0; sample < samples_.round; ++sample) {
        Request request = requestFor(samples_.only(sample));
        request.data = true;
        request.ledger = scene_.features.mirrors || scene_.features.transmission;
        const Picture device = rendered(request);
        compareSample(sample, request, device);
        if (options_.plainToo && sample == 0 && !isConvicted())
            report_.plainDiffers = countSettled(0, 1, plainDifferences(device));
        if (rounds.count() > 1) film.add(sample, device);
    }
    if (rounds.count() > 1 && !isConvicted())
        report_.filmDiffers = countSettled(0, rounds.count(), filmDifferences(rounds, film));
    // A few thousand pixels tell little of what seldom happens: before they fail an image, ask more.
    const bool tooMany = report_.explained() + report_.undecided > report_.allowedExplained();
    if (tooMany && report_.unexplained == 0)
        report_.sensitivity = sensitivityOf(tracer_, camera_, options_.width, options_.height, samples_, 3,
                                            16 * kMaxKappaPixels);
    if (representation_) report_.representation = representation_->judge(options_.worstCount);
    report_.p99 = percentile99(std::move(differences_));
    const auto rootOfMean = [](double squares, uint64_t pixels) {
        return std::sqrt(squares / (3.0 * static_cast<double>(std::max<uint64_t>(pixels, 1))));
    };
    report_.rmse = rootOfMean(report_.rmse, report_.pixels);
    report_.rmseSamePath = rootOfMean(report_.rmseSamePath, samePath_);
}

// The whole view, in colour alone.
Request Verification::requestFor(const PackedSamples& samples) const {
    Request request = options_;
    request.region = {};
    request.samples = samples;
    request.data = request.ledger = false;
    request.progress = {};
    return request;
}

Picture Verification::rendered(const Request& request) const {
    Picture picture = renderer_.render(camera_, request);
    if (!picture.complete) throw Cancelled();
    return picture;
}

void Verification::compareSample(uint32_t sample, const Request& request, const Picture& device) {
    const auto radianceBound = static_cast<double>(tracer_.environment().radianceBound);
    std::vector<Row> rows(static_cast<size_t>(options_.height), Row(radianceBound));
    std::mutex mutex;
    size_t finished = size_t{sample} * rows.size();
    parallelFor(context_, rows.size(), [&](size_t y) {
        for (int x = 0; x < options_.width; ++x)
            comparePixel(x, static_cast<int>(y), sample, device, rows[y]);
        const std::lock_guard lock(mutex);
        ++finished;
        if (options_.progress)
            options_.progress(static_cast<double>(finished) /
                              (static_cast<double>(rows.size()) * samples_.round));
    });
    Row all(radianceBound);
    for (Row& row : rows) {
        all.account.add(row.account);
        all.rays += row.rays;
        samePath_ += row.samePath;
        report_.rmse += row.squares;
        report_.rmseSamePath += row.squaresSamePath;
        report_.maxSamePath = std::max(report_.maxSamePath, row.maxSamePath);
        std::move(row.differing.begin(), row.differing.end(), std::back_inserter(all.differing));
    }
    certifyDoubts(all.differing, request, kStepsOfRay * all.rays + kLeastSteps);
    for (DifferingPixel& pixel : all.differing) addDiffering(report_, std::move(pixel));
    // Without secondary rays the device has no code for mirrors, and counts no omitted branches.
    const bool countsBranches = tracer_.environment().maxDepth > 0;
    if (countsBranches && !all.account.agrees(device.losses, report_.allowedExplained()))
        ++report_.lossesDiffer;
    const size_t kept = std::min(report_.worst.size(), options_.worstCount);
    const auto end = report_.worst.begin() + static_cast<std::ptrdiff_t>(kept);
    std::partial_sort(report_.worst.begin(), end, report_.worst.end(), worseThan);
    report_.worst.resize(kept);
}

void Verification::comparePixel(int x, int y, uint32_t sample, const Picture& device, Row& row) {
    const auto [weight, ray] = sampleAt(sample, x, y);
    DifferingPixel pixel{
        .x = x, .y = y, .sample = sample, .device = device.at(x, y), .reference = tracer_.trace(ray)};
    const reference::PixelRecord& expected = pixel.reference;
    const PixelData& data = pixel.device;
    for (int c = 0; c < 3; ++c) pixel.deviceColor[c] = device.color.at(x, y, c) / static_cast<float>(weight);
    const glm::dvec3 difference = glm::dvec3(pixel.deviceColor) - expected.color;
    const bool finite = isFinite(difference);
    pixel.difference = finite ? greatestMagnitude(difference) : std::numeric_limits<double>::infinity();
    addColors(pixel, row);
    if (representation_) representation_->compare(x, y, sample, expected);
    const bool samePath = data.pathHash == expected.pathHash;
    const bool alike = samePath && data.bounces == expected.bounces;
    if (alike)
        row.account.addAlike(expected.lost, std::abs(weight));
    else
        row.account.addOther(data.bounces, std::abs(weight));
    const bool judged = finite && isCovered(device.color.at(x, y, 3), data, weight);
    if (judged && alike && isPredicted(tracer_, ray, expected, scene_, quantitiesOf(pixel.deviceColor, data)))
        return;
    pixel.inDoubt = judged && (alike || !samePath);
    row.differing.push_back(std::move(pixel));
}

void Verification::addColors(const DifferingPixel& pixel, Row& row) {
    const reference::PixelRecord& expected = pixel.reference;
    const size_t index = (pixel.sample * static_cast<size_t>(options_.height) + pixel.y) *
                             static_cast<size_t>(options_.width) +
                         pixel.x;
    differences_[index] = static_cast<float>(pixel.difference);
    row.rays += expected.bounces + 1;
    if (std::isfinite(pixel.difference)) {
        const glm::dvec3 d = glm::dvec3(pixel.deviceColor) - expected.color;
        row.squares += glm::dot(d, d);
        if (pixel.device.pathHash == expected.pathHash) {
            row.squaresSamePath += glm::dot(d, d);
            row.maxSamePath = std::max(row.maxSamePath, pixel.difference);
            ++row.samePath;
        }
    }
    for (int c = 0; pixel.sample == 0 && c < 3; ++c) {
        report_.difference.at(pixel.x, pixel.y, c) = std::min(differences_[index] * kDifferenceGain, 1.0f);
        report_.device.at(pixel.x, pixel.y, c) = pixel.deviceColor[c];
        report_.reference.at(pixel.x, pixel.y, c) = static_cast<float>(expected.color[c]);
    }
}

// Certifies the pixels in doubt, in order, as long as there are steps left; the others are undecided. Drops
// those that lie within their predicted error after all. Deterministic: the steps are counted between
// batches.
void Verification::certifyDoubts(std::vector<DifferingPixel>& differing, const Request& request,
                                 uint64_t steps) const {
    std::vector<DifferingPixel*> doubts;
    for (DifferingPixel& pixel : differing)
        if (pixel.inDoubt) doubts.push_back(&pixel);
    uint64_t unexplained = 0;
    std::vector<Trail> trails;
    const auto from = [&](size_t first, size_t count) {
        return std::span(doubts).subspan(first, std::min(count, doubts.size() - first));
    };
    for (size_t first = 0; first < doubts.size(); first += kCertifiedAtOnce) {
        const auto batch = from(first, kCertifiedAtOnce);
        if (steps == 0 || (options_.verdictAlone && unexplained > report_.allowedExplained())) {
            for (DifferingPixel* pixel : batch) {
                pixel->inDoubt = false;
                pixel->reason = Reason::Undecided;
            }
            continue;
        }
        const size_t trail = first % kTrailsAtOnce;
        if (trail == 0) trails = trailsOf(from(first, kTrailsAtOnce), request);
        std::vector<uint64_t> taken(batch.size(), std::min(steps, kMostStepsOfPixel));
        parallelFor(context_, batch.size(),
                    [&](size_t i) { certifyPixel(*batch[i], trails[trail + i], taken[i]); });
        for (const uint64_t count : taken) steps -= std::min(steps, count);
        for (const DifferingPixel* pixel : batch) unexplained += pixel->reason == Reason::Unexplained;
    }
    std::erase_if(differing, [](const DifferingPixel& pixel) { return pixel.inDoubt; });
}

std::vector<Trail> Verification::trailsOf(std::span<DifferingPixel* const> pixels,
                                          const Request& request) const {
    std::vector<glm::ivec2> places;
    for (const DifferingPixel* pixel : pixels) places.emplace_back(pixel->x, pixel->y);
    return renderer_.trails(camera_, request, places);
}

// steps: most that it may take, then those that it took. A pixel stays in doubt if it is within its predicted
// error after all: each ray of the reference's own path is predicted.
void Verification::certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t& steps) const {
    const auto [weight, ray] = sampleAt(pixel.sample, pixel.x, pixel.y);
    const SeenPath seen{&trail, quantitiesOf(pixel.deviceColor, pixel.device), weight};
    const Certificate certificate = certify(tracer_, scene_, ray, seen, steps);
    steps = certificate.steps;
    pixel.ulps = certificate.units;
    pixel.openDecisions = certificate.openDecisions;
    pixel.inDoubt = false;
    if (certificate.verdict == Certificate::Verdict::Fails) return;
    if (certificate.verdict == Certificate::Verdict::Undecided) {
        pixel.reason = Reason::Undecided;
        return;
    }
    const bool samePath = pixel.device.pathHash == pixel.reference.pathHash;
    pixel.inDoubt = samePath && certificate.openDecisions == 0 && decidesAlike(ray, certificate);
    pixel.reason = samePath && certificate.openDecisions > 0 ? Reason::Rounding : Reason::Edge;
}

// True if the device's path, of this certificate, takes the same decisions as the reference's.
bool Verification::decidesAlike(const reference::Ray& ray, const Certificate& certificate) const {
    const reference::PixelRecord still = tracer_.trace(ray, {}, true);
    const Trail own = trailOf(still);
    const SeenPath itself{&own, quantitiesOf(still, scene_.origin), 1, false};
    return certify(tracer_, scene_, ray, itself, kMostStepsOfPixel).decisions == certificate.decisions;
}

// Pixels of the first sample that have another colour in an image without layers.
std::vector<size_t> Verification::plainDifferences(const Picture& device) const {
    const Picture plain = rendered(requestFor(samples_.only(0)));
    std::vector<size_t> differing;
    for (size_t i = 0; i < device.done.size(); ++i)
        if (std::memcmp(&plain.color.pixels[4 * i], &device.color.pixels[4 * i], 4 * sizeof(float)) != 0)
            differing.push_back(i);
    return differing;
}

// Pixels of the image of all samples that differ from the mean of their samples. `film` has the first
// round's.
std::vector<size_t> Verification::filmDifferences(const PackedSamples& rounds, Film& film) const {
    for (uint32_t sample = samples_.round; sample < rounds.count(); ++sample)
        film.add(sample, rendered(requestFor(samples_.only(sample))));
    return film.differing(rendered(requestFor(rounds)));
}

// True if some ray as near as roundings move it hits surfaces of which fp32's errors decide whether they are
// in one place. Which of them is hit may then depend on the order of the traversal, and so on the kernel.
bool isOrderOpen(const reference::Tracer& tracer, const reference::Ray& ray) {
    constexpr uint64_t kMoves = 64;
    for (uint64_t seed = 0; seed <= kMoves; ++seed) {
        const reference::Jitter move{.seed = seed, .ulps = seed == 0 ? 0 : kStepUnits};
        if (isOpen(tracer, ray, tracer.trace(ray, move), move)) return true;
    }
    return false;
}

// How many of these pixels have no such rays in samples `first` to `end` - 1.
uint64_t Verification::countSettled(uint32_t first, uint32_t end, const std::vector<size_t>& pixels) const {
    std::atomic<uint64_t> settled = 0;
    parallelFor(context_, pixels.size(), [&](size_t i) {
        const auto [y, x] = std::div(static_cast<int64_t>(pixels[i]), static_cast<int64_t>(options_.width));
        for (uint32_t sample = first; sample < end; ++sample) {
            const reference::Ray ray = sampleAt(sample, static_cast<int>(x), static_cast<int>(y)).ray;
            if (isOrderOpen(tracer_, ray)) return;
        }
        ++settled;
    });
    return settled;
}

}  // namespace

uint64_t Report::allowedExplained() const {
    return greatestCount(sensitivity.explainedShare() * static_cast<double>(pixels));
}

Report verify(render::Renderer& renderer, const PackedScene& scene, const shared::Camera& camera,
              const Options& options, const Scene* read) {
    Report report;
    try {
        Verification(renderer, scene, camera, options, read, report).run();
    } catch (const Cancelled&) {
        report.interrupted = true;
    }
    return report;
}

}  // namespace glint::verify
