#include "verify/verify.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <future>
#include <limits>
#include <mutex>
#include <tuple>

#include "core/parallel.h"
#include "core/vectors.h"
#include "reference/sampling.h"
#include "verify/certificate.h"
#include "verify/film.h"

namespace glint::verify {

namespace {

constexpr float kDifferenceGain = 64;

// Steps of the reference for certificates: for each of its rays, and for each sample.
constexpr uint64_t kStepsOfRay = 3, kLeastSteps = 1'000'000;
// Pixels that are certified at a time, before the steps left are counted.
constexpr size_t kCertifiedAtOnce = 64;
// Pixels that are compared at a time, and whose rays are stored; fewer if paths are deep.
constexpr int kPixelsAtOnce = 1 << 15;

// Whole tiles: the same packets of rays as in the whole image.
int rowsOfPart(const Options& options, uint32_t maxDepth) {
    constexpr int kTile = shared::kTileSize;
    const int pixels = kPixelsAtOnce / (1 + static_cast<int>(maxDepth) / 32);
    return std::max(1, pixels / (options.width * kTile)) * kTile;
}

// True if the pixel's alpha is the sample's weight at a hit, and 0 at a miss. The weight, the inverse of the
// count and their product are rounded.
bool isCovered(float alpha, const PixelData& data, double weight) {
    const double expected = data.object == PixelData::kNoIndex ? 0 : weight;
    return std::abs(static_cast<double>(alpha) - expected) <= 4 * kFloatUnit * std::abs(expected);
}

// False for a miss with a layer of a hit.
bool isBlankIfMiss(const PixelData& d) {
    const PixelData miss;
    const auto layers = [](const PixelData& p) {
        return std::tuple(p.depth, p.position, p.normal, p.geometricNormal, p.u, p.v, p.primitive, p.material,
                          p.clearance);
    };
    return d.object != PixelData::kNoIndex || layers(d) == layers(miss);
}

bool worseThan(const DifferingPixel& a, const DifferingPixel& b) {
    const auto rank = [](const DifferingPixel& pixel) {
        return std::tuple(pixel.reason != Reason::Unexplained, -pixel.difference, pixel.y, pixel.x);
    };
    return rank(a) < rank(b);
}

// Counts a pixel, and paints it in the image of differences.
void addDiffering(Report& report, DifferingPixel&& pixel) {
    using Entry = std::pair<uint64_t&, glm::vec3>;
    const Entry entries[] = {{report.edges, {1, 0.8f, 0}},
                             {report.roundings, {0.1f, 0.8f, 0.2f}},
                             {report.undecided, {0.8f, 0, 0.8f}},
                             {report.unexplained, {1, 0, 0}}};
    const auto& [count, color] = entries[static_cast<size_t>(pixel.reason) - 1];
    ++count;
    for (int c = 0; pixel.sample == 0 && c < 3; ++c) report.difference.at(pixel.x, pixel.y, c) = color[c];
    report.worst.push_back(std::move(pixel));
}

class Verification {
  public:
    Verification(render::Renderer& renderer, const PackedScene& scene, const Options& options,
                 const Scene* read, Report& report)
        : renderer_(renderer),
          scene_(scene),
          camera_(cameraOf(scene, options)),
          options_(options),
          samples_(options.samples),
          rounds_(firstRounds(options.samples)),
          context_{.cancelled = options.cancelled},
          tracer_(scene, options),
          report_(report),
          account_(static_cast<double>(tracer_.environment().radianceBound)),
          steps_(kLeastSteps * samples_.round) {
        if (read != nullptr) representation_.emplace(*read, scene, tracer_, camera_, options);
    }

    // Throws Cancelled.
    void run();

  private:
    Picture rendered(const Region& part, const PackedSamples& samples,
                     std::vector<Trail>* trails = nullptr) const;
    reference::PixelSample sampleAt(uint32_t sample, int x, int y) const {
        return reference::pixelSample(tracer_, camera_, samples_, sample, x, y);
    }
    // True if nothing else matters.
    bool isConvicted(uint64_t unexplained) const {
        return options_.verdictAlone && unexplained > options_.allowedUnexplained;
    }

    void verifyPart(const Region& part);
    void compareSample(uint32_t sample, const Picture& device, const std::vector<Trail>& trails);
    // Around an answer, with the floors of the reference's answer for the camera's ray.
    Box boxOf(const reference::PixelRecord& answer, const reference::PixelRecord& still,
              const reference::Ray& ray) const {
        return {quantitiesOf(answer, scene_.origin), floorsOf(scene_, still, ray)};
    }
    bool isResponse(const DifferingPixel& pixel, const reference::Ray& ray) const;
    DifferingPixel comparedPixel(int x, int y, uint32_t sample, const Picture& device);
    void add(const DifferingPixel& pixel);
    void certifyAll(const Picture& device, const std::vector<Trail>& trails);
    uint64_t certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t mostSteps) const;
    std::vector<size_t> plainDifferences(const Picture& device) const;
    uint64_t countSettled(const Region& part, uint32_t end, const std::vector<size_t>& pixels) const;
    void conclude();

    render::Renderer& renderer_;
    const PackedScene& scene_;
    const shared::Camera camera_;
    const Options& options_;
    const PackedSamples& samples_;
    const PackedSamples rounds_;
    Context context_;
    reference::Tracer tracer_;
    std::optional<RepresentationCheck> representation_;
    Report& report_;
    // Over all samples and pixels, in an order that does not depend on the threads.
    Account account_;
    TreeLosses losses_;  // the device's
    double squares_ = 0, squaresSamePath_ = 0;
    uint64_t samePath_ = 0;
    std::vector<float> differences_;
    uint64_t steps_;  // left to certificates
    size_t finishedRows_ = 0;
    // The pixels and trails of one part. The next part reuses them, because memory is expensive to obtain.
    std::vector<DifferingPixel> pixels_;
    std::vector<Trail> trails_[2];  // of even and odd samples
};

void Verification::run() {
    const int width = options_.width, height = options_.height;
    for (Image* image : {&report_.device, &report_.reference, &report_.difference})
        *image = Image(width, height, 3);
    report_.allowedUnexplained = options_.allowedUnexplained;
    report_.pixels = static_cast<uint64_t>(width) * height * samples_.round;
    report_.sensitivity = reference::sensitivityOf(tracer_, camera_, width, height, samples_, context_);
    differences_.reserve(report_.pixels);
    const int rows = rowsOfPart(options_, tracer_.environment().maxDepth);
    for (int y = 0; y < height; y += rows) verifyPart({0, y, width, std::min(y + rows, height)});
    conclude();
}

void Verification::verifyPart(const Region& part) {
    Film film(rounds_, part, scene_.lights.size());
    // The device renders a sample while the host compares the one before.
    const auto start = [&](uint32_t sample) {
        return std::async(std::launch::async, [this, &part, sample] {
            return rendered(part, samples_.only(sample), &trails_[sample % 2]);
        });
    };
    Picture first;
    std::future<Picture> next = start(0);
    for (uint32_t sample = 0; sample < samples_.round; ++sample) {
        Picture device = next.get();
        if (sample + 1 < samples_.round) next = start(sample + 1);
        compareSample(sample, device, trails_[sample % 2]);
        if (rounds_.count() > 1) film.add(sample, device);
        if (sample == 0) first = std::move(device);
    }
    if (isConvicted(report_.unexplained)) return;
    if (options_.plainToo) report_.plainDiffers += countSettled(part, 1, plainDifferences(first));
    if (rounds_.count() == 1) return;
    for (uint32_t sample = samples_.round; sample < rounds_.count(); ++sample)
        film.add(sample, rendered(part, samples_.only(sample)));
    const std::vector<size_t> differing = film.differing(rendered(part, rounds_));
    report_.filmDiffers += countSettled(part, rounds_.count(), differing);
}

void Verification::conclude() {
    // Without secondary rays the device has no code for mirrors, and counts no omitted branches.
    const bool countsBranches = tracer_.environment().maxDepth > 0;
    report_.lossesDiffer = countsBranches && !account_.agrees(losses_, report_.allowedExplained());
    // A few thousand pixels are a poor estimate of rare events: examine more before they fail an image.
    const bool tooMany = report_.explained() + report_.undecided > report_.allowedExplained();
    if (tooMany && report_.unexplained == 0)
        report_.sensitivity =
            reference::sensitivityOf(tracer_, camera_, options_.width, options_.height, samples_, context_, 3,
                                     16 * reference::kMaxKappaPixels);
    if (representation_) report_.representation = representation_->judge(options_.worstCount);
    report_.p99 = reference::percentile99(std::move(differences_));
    const auto rootOfMean = [](double squares, uint64_t pixels) {
        return std::sqrt(squares / (3.0 * static_cast<double>(std::max<uint64_t>(pixels, 1))));
    };
    report_.rmse = rootOfMean(squares_, report_.pixels);
    report_.rmseSamePath = rootOfMean(squaresSamePath_, samePath_);
}

// Colour alone, or with the record of rays the layers and the branches that are left out too.
Picture Verification::rendered(const Region& part, const PackedSamples& samples,
                               std::vector<Trail>* trails) const {
    Request request = options_;
    request.region = part;
    request.samples = samples;
    request.data = trails != nullptr;
    request.ledger = trails != nullptr && (scene_.features.mirrors || scene_.features.transmission);
    request.progress = {};
    Picture picture = renderer_.render(request, trails);
    if (!picture.complete) throw Cancelled();
    return picture;
}

void Verification::compareSample(uint32_t sample, const Picture& device, const std::vector<Trail>& trails) {
    pixels_.resize(device.done.size());
    std::mutex mutex;
    parallelFor(context_, static_cast<size_t>(device.region.height()), [&](size_t row) {
        const int y = device.region.y0 + static_cast<int>(row);
        for (int x = 0; x < options_.width; ++x)
            pixels_[device.indexOf(x, y)] = comparedPixel(x, y, sample, device);
        const std::lock_guard lock(mutex);
        ++finishedRows_;
        const double all = static_cast<double>(options_.height) * samples_.round;
        if (options_.progress) options_.progress(static_cast<double>(finishedRows_) / all);
    });
    losses_.add(device.losses);
    for (const DifferingPixel& pixel : pixels_) add(pixel);
    certifyAll(device, trails);
    for (DifferingPixel& pixel : pixels_) {
        if (pixel.reason == Reason::Predicted) continue;
        addDiffering(report_, std::move(pixel));
    }
    const size_t kept = std::min(report_.worst.size(), options_.worstCount);
    const auto end = report_.worst.begin() + static_cast<std::ptrdiff_t>(kept);
    std::partial_sort(report_.worst.begin(), end, report_.worst.end(), worseThan);
    report_.worst.resize(kept);
}

// True if the device's answer lies within kResponseGain times the reference's response to a few moves of one
// unit that decide alike.
bool Verification::isResponse(const DifferingPixel& pixel, const reference::Ray& ray) const {
    const reference::PixelRecord& still = pixel.reference;
    const double gain = kResponseGain * (still.meetsInstance ? 1 + scene_.instanceGain : 1);
    const Quantities seen = quantitiesOf(pixel.deviceColor, pixel.device);
    Box box = boxOf(still, still, ray);
    for (uint64_t seed = 1; seed <= kResponseMoves; ++seed) {
        const reference::PixelRecord moved = tracer_.trace(ray, {.seed = seed, .ulps = 1});
        if (moved.decisions == still.decisions) box.include(boxOf(moved, still, ray));
        if (box.contains(0, seen, gain)) return true;
    }
    return false;
}

// Undecided: to be certified.
DifferingPixel Verification::comparedPixel(int x, int y, uint32_t sample, const Picture& device) {
    const auto [weight, ray] = sampleAt(sample, x, y);
    DifferingPixel pixel{
        .x = x, .y = y, .sample = sample, .device = device.at(x, y), .reference = tracer_.trace(ray)};
    const float* color = &device.color.pixels[4 * device.indexOf(x, y)];
    for (int c = 0; c < 3; ++c) pixel.deviceColor[c] = color[c] / static_cast<float>(weight);
    const glm::dvec3 difference = glm::dvec3(pixel.deviceColor) - pixel.reference.color;
    const bool finite = isFinite(difference);
    pixel.difference = finite ? greatestMagnitude(difference) : std::numeric_limits<double>::infinity();
    if (representation_) representation_->compare(x, y, sample, pixel.reference);
    std::vector<std::string_view>& beyond = pixel.quantities;
    if (!isCovered(color[3], pixel.device, weight)) beyond = {"alpha"};
    if (!isBlankIfMiss(pixel.device)) beyond.push_back("layers of a miss");
    const bool valid = finite && beyond.empty();
    if (pixel.isSamePath()) {
        const Box box = boxOf(pixel.reference, pixel.reference, ray);
        const Quantities seen = quantitiesOf(pixel.deviceColor, pixel.device);
        for (size_t i = 0; i < kQuantities; ++i)
            if (!box.contains(i, seen[i], 0) && (beyond.empty() || beyond.back() != kQuantityNames[i]))
                beyond.push_back(kQuantityNames[i]);
        if (!pixel.isAlike()) beyond.push_back("bounces");
    } else {
        beyond = {"path"};
    }
    if (valid && (beyond.empty() || (pixel.isAlike() && isResponse(pixel, ray))))
        pixel.reason = Reason::Predicted;
    else if (valid && (pixel.isAlike() || !pixel.isSamePath()))
        pixel.reason = Reason::Undecided;
    return pixel;
}

void Verification::add(const DifferingPixel& pixel) {
    const double weight = std::abs(reference::filmSample(samples_, pixel.sample, pixel.x, pixel.y).weight);
    if (pixel.isAlike())
        account_.addAlike(pixel.reference.lost, weight);
    else
        account_.addOther(pixel.device.bounces, weight);
    steps_ += kStepsOfRay * (uint64_t{pixel.reference.bounces} + 1);
    differences_.push_back(static_cast<float>(pixel.difference));
    if (std::isfinite(pixel.difference)) {
        const glm::dvec3 d = glm::dvec3(pixel.deviceColor) - pixel.reference.color;
        squares_ += glm::dot(d, d);
        if (pixel.isSamePath()) {
            squaresSamePath_ += glm::dot(d, d);
            report_.maxSamePath = std::max(report_.maxSamePath, pixel.difference);
            ++samePath_;
        }
    }
    for (int c = 0; pixel.sample == 0 && c < 3; ++c) {
        report_.difference.at(pixel.x, pixel.y, c) = std::min(differences_.back() * kDifferenceGain, 1.0f);
        report_.device.at(pixel.x, pixel.y, c) = pixel.deviceColor[c];
        report_.reference.at(pixel.x, pixel.y, c) = static_cast<float>(pixel.reference.color[c]);
    }
}

// Certifies the undecided pixels in order, until the steps run out. Deterministic: the steps are counted
// between batches.
void Verification::certifyAll(const Picture& device, const std::vector<Trail>& trails) {
    std::vector<DifferingPixel*> doubts;
    for (DifferingPixel& pixel : pixels_)
        if (pixel.reason == Reason::Undecided) doubts.push_back(&pixel);
    uint64_t unexplained = report_.unexplained;
    for (size_t first = 0; first < doubts.size(); first += kCertifiedAtOnce) {
        const size_t count = std::min(kCertifiedAtOnce, doubts.size() - first);
        const uint64_t most = isConvicted(unexplained) ? 0 : std::min(steps_, kMostStepsOfPixel);
        std::vector<uint64_t> taken(count);
        parallelFor(context_, count, [&](size_t i) {
            DifferingPixel& pixel = *doubts[first + i];
            taken[i] = certifyPixel(pixel, trails[device.indexOf(pixel.x, pixel.y)], most);
        });
        for (size_t i = 0; i < count; ++i) {
            steps_ -= std::min(steps_, taken[i]);
            unexplained += doubts[first + i]->reason == Reason::Unexplained;
        }
    }
}

// Returns the number of steps. A pixel is within its predicted error after all if each ray of the reference's
// own path is predicted and decides as the reference's own ray.
uint64_t Verification::certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t mostSteps) const {
    const auto [weight, ray] = sampleAt(pixel.sample, pixel.x, pixel.y);
    const SeenPath seen{&trail, quantitiesOf(pixel.deviceColor, pixel.device), weight};
    const Certificate certificate = certify(tracer_, scene_, ray, seen, mostSteps);
    const bool open = certificate.openDecisions > 0;
    pixel.ulps = certificate.units;
    pixel.openDecisions = certificate.openDecisions;
    if (certificate.verdict == Certificate::Verdict::Fails)
        pixel.reason = Reason::Unexplained;
    else if (certificate.verdict == Certificate::Verdict::Holds && pixel.isSamePath() && open)
        pixel.reason = Reason::Rounding;
    else if (certificate.verdict == Certificate::Verdict::Holds)
        pixel.reason = pixel.isSamePath() && certificate.decisions == pixel.reference.decisions
                           ? Reason::Predicted
                           : Reason::Edge;
    return certificate.steps;
}

// Pixels of a part's first sample that have another colour in an image without layers.
std::vector<size_t> Verification::plainDifferences(const Picture& device) const {
    const Picture plain = rendered(device.region, samples_.only(0));
    std::vector<size_t> differing;
    for (size_t i = 0; i < device.done.size(); ++i)
        if (std::memcmp(&plain.color.pixels[4 * i], &device.color.pixels[4 * i], 4 * sizeof(float)) != 0)
            differing.push_back(i);
    return differing;
}

// True if the ray, or one that rounding may make of it, hits surfaces whose coincidence depends on fp32's
// errors. The order of the traversal, and so the kernel, may then decide which of them is hit.
bool isOrderOpen(const reference::Tracer& tracer, const reference::Ray& ray) {
    constexpr uint64_t kMoves = 64;
    for (uint64_t seed = 0; seed <= kMoves; ++seed) {
        const reference::Jitter move{.seed = seed, .ulps = seed == 0 ? 0 : kStepUnits};
        if (reference::isOpen(tracer, ray, tracer.trace(ray, move), move)) return true;
    }
    return false;
}

// Counts those pixels of a part for which the order of surfaces is open in none of the first `end` samples.
uint64_t Verification::countSettled(const Region& part, uint32_t end,
                                    const std::vector<size_t>& pixels) const {
    std::atomic<uint64_t> settled = 0;
    parallelFor(context_, pixels.size(), [&](size_t i) {
        const glm::ivec2 at = pixelAt(part, pixels[i]);
        for (uint32_t sample = 0; sample < end; ++sample)
            if (isOrderOpen(tracer_, sampleAt(sample, at.x, at.y).ray)) return;
        ++settled;
    });
    return settled;
}

}  // namespace

uint64_t Report::allowedExplained() const {
    return reference::greatestCount(sensitivity.explainedShare() * static_cast<double>(pixels));
}

uint64_t bytesPerPixel(const Options& options, uint32_t maxDepth) {
    constexpr uint64_t kOfSample = sizeof(Trail) + sizeof(TrailRay) + sizeof(PixelData) + 4 * sizeof(float);
    constexpr uint64_t kOfPart = 2 * kOfSample + sizeof(PixelData) + sizeof(DifferingPixel);
    const auto height = static_cast<uint64_t>(options.height);
    const uint64_t rows = std::min(height, static_cast<uint64_t>(rowsOfPart(options, maxDepth)));
    return sizeof(float) * (3 * 3 + uint64_t{options.samples.round}) + (kOfPart * rows + height - 1) / height;
}

Report verify(render::Renderer& renderer, const PackedScene& scene, const Options& options,
              const Scene* read) {
    Report report;
    try {
        Verification(renderer, scene, options, read, report).run();
    } catch (const Cancelled&) {
        report.interrupted = true;
    }
    return report;
}

}  // namespace glint::verify
