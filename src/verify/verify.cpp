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
#include <unordered_map>

#include "core/parallel.h"
#include "core/vectors.h"
#include "reference/sampling.h"
#include "verify/certificate.h"
#include "verify/film.h"

namespace glint::verify {

namespace {

constexpr float kDifferenceGain = 64;

// Steps of the reference that certificates may take: as many for each of its rays, and some more for each
// sample.
constexpr uint64_t kStepsOfRay = 3, kLeastSteps = 1'000'000;
// Pixels that are certified between two looks at the steps left.
constexpr size_t kCertifiedAtOnce = 64;
// Pixels that are compared at a time, whose rays are held; fewer where paths are deep.
constexpr int kPixelsAtOnce = 1 << 15;

// Sums over a row's pixels. Rows are added in order, so that results do not depend on the threads.
struct Row {
    explicit Row(double radianceBound) : account(radianceBound) {}
    Account account;
    double squares = 0, squaresSamePath = 0, maxSamePath = 0;
    uint64_t samePath = 0, rays = 0;
    std::vector<DifferingPixel> differing;

    // Adds the sums alone.
    void add(const Row& row) {
        account.add(row.account);
        squares += row.squares;
        squaresSamePath += row.squaresSamePath;
        maxSamePath = std::max(maxSamePath, row.maxSamePath);
        samePath += row.samePath;
    }
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
          rounds_(firstRounds(options.samples)),
          context_{.cancelled = options.cancelled},
          tracer_(scene, options),
          report_(report),
          sums_(radianceBound()),
          steps_(kLeastSteps * samples_.round) {
        if (read != nullptr) representation_.emplace(*read, scene, tracer_, camera, options);
    }

    // Throws Cancelled.
    void run();

  private:
    double radianceBound() const { return static_cast<double>(tracer_.environment().radianceBound); }
    Picture rendered(const Region& part, const PackedSamples& samples,
                     std::vector<PixelRay>* rays = nullptr) const;
    reference::PixelSample sampleAt(uint32_t sample, int x, int y) const {
        return reference::pixelSample(tracer_, camera_, samples_, sample, x, y);
    }
    // True if nothing else matters.
    bool isConvicted() const { return options_.verdictAlone && report_.unexplained > 0; }

    void verifyPart(const Region& part);
    void compareSample(uint32_t sample, const Picture& device, const std::vector<PixelRay>& rays);
    void comparePixel(int x, int y, uint32_t sample, const Picture& device, Row& row);
    void addColors(const DifferingPixel& pixel, Row& row);
    void certifyDoubts(std::vector<DifferingPixel>& differing, const Picture& device,
                       const std::vector<PixelRay>& rays);
    uint64_t certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t mostSteps) const;
    std::vector<size_t> plainDifferences(const Picture& device) const;
    uint64_t countSettled(const Region& part, uint32_t end, const std::vector<size_t>& pixels) const;
    void conclude();

    render::Renderer& renderer_;
    const PackedScene& scene_;
    const shared::Camera& camera_;
    const Options& options_;
    const PackedSamples& samples_;
    const PackedSamples rounds_;
    Context context_;
    reference::Tracer tracer_;
    std::optional<RepresentationCheck> representation_;
    Report& report_;
    Row sums_;
    TreeLosses losses_;  // the device's
    uint64_t steps_;     // left to certificates
    size_t finishedRows_ = 0;
    // By sample and pixel: the colour's difference, infinite where the device's is not finite.
    std::vector<float> differences_;
};

void Verification::run() {
    const int width = options_.width, height = options_.height;
    for (Image* image : {&report_.device, &report_.reference, &report_.difference})
        *image = Image(width, height, 3);
    report_.allowedUnexplained = options_.allowedUnexplained;
    report_.pixels = static_cast<uint64_t>(width) * height * samples_.round;
    report_.sensitivity = sensitivityOf(tracer_, camera_, width, height, samples_);
    differences_.resize(report_.pixels);
    // Whole tiles: the same packets of rays as in the whole image.
    constexpr int kTile = shared::kTileSize;
    const int pixels = kPixelsAtOnce / (1 + static_cast<int>(tracer_.environment().maxDepth) / 32);
    const int rows = std::max(1, pixels / (width * kTile)) * kTile;
    for (int y = 0; y < height; y += rows) verifyPart({0, y, width, std::min(y + rows, height)});
    conclude();
}

void Verification::verifyPart(const Region& part) {
    Film film(rounds_, part, scene_.lights.size());
    std::vector<PixelRay> rays;
    for (uint32_t sample = 0; sample < samples_.round; ++sample) {
        const Picture device = rendered(part, samples_.only(sample), &rays);
        compareSample(sample, device, rays);
        if (options_.plainToo && sample == 0 && !isConvicted())
            report_.plainDiffers += countSettled(part, 1, plainDifferences(device));
        if (rounds_.count() > 1) film.add(sample, device);
    }
    if (rounds_.count() == 1 || isConvicted()) return;
    for (uint32_t sample = samples_.round; sample < rounds_.count(); ++sample)
        film.add(sample, rendered(part, samples_.only(sample)));
    const std::vector<size_t> differing = film.differing(rendered(part, rounds_));
    report_.filmDiffers += countSettled(part, rounds_.count(), differing);
}

void Verification::conclude() {
    // Without secondary rays the device has no code for mirrors, and counts no omitted branches.
    const bool countsBranches = tracer_.environment().maxDepth > 0;
    report_.lossesDiffer = countsBranches && !sums_.account.agrees(losses_, report_.allowedExplained());
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
    report_.rmse = rootOfMean(sums_.squares, report_.pixels);
    report_.rmseSamePath = rootOfMean(sums_.squaresSamePath, sums_.samePath);
    report_.maxSamePath = sums_.maxSamePath;
}

// Colour alone, or with the record of rays the layers and the branches that are left out too.
Picture Verification::rendered(const Region& part, const PackedSamples& samples,
                               std::vector<PixelRay>* rays) const {
    Request request = options_;
    request.region = part;
    request.samples = samples;
    request.data = rays != nullptr;
    request.ledger = rays != nullptr && (scene_.features.mirrors || scene_.features.transmission);
    request.progress = {};
    Picture picture = renderer_.render(camera_, request, rays);
    if (!picture.complete) throw Cancelled();
    return picture;
}

void Verification::compareSample(uint32_t sample, const Picture& device, const std::vector<PixelRay>& rays) {
    std::vector<Row> rows(static_cast<size_t>(device.region.height()), Row(radianceBound()));
    std::mutex mutex;
    parallelFor(context_, rows.size(), [&](size_t row) {
        for (int x = 0; x < options_.width; ++x)
            comparePixel(x, device.region.y0 + static_cast<int>(row), sample, device, rows[row]);
        const std::lock_guard lock(mutex);
        ++finishedRows_;
        const double all = static_cast<double>(options_.height) * samples_.round;
        if (options_.progress) options_.progress(static_cast<double>(finishedRows_) / all);
    });
    std::vector<DifferingPixel> differing;
    for (Row& row : rows) {
        sums_.add(row);
        steps_ += kStepsOfRay * row.rays;
        std::move(row.differing.begin(), row.differing.end(), std::back_inserter(differing));
    }
    losses_.add(device.losses);
    certifyDoubts(differing, device, rays);
    for (DifferingPixel& pixel : differing) addDiffering(report_, std::move(pixel));
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
    const float* color = &device.color.pixels[4 * device.indexOf(x, y)];
    for (int c = 0; c < 3; ++c) pixel.deviceColor[c] = color[c] / static_cast<float>(weight);
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
    const bool judged = finite && isCovered(color[3], data, weight);
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
// those that lie within their predicted error. Deterministic: the steps are counted between batches.
void Verification::certifyDoubts(std::vector<DifferingPixel>& differing, const Picture& device,
                                 const std::vector<PixelRay>& rays) {
    std::vector<DifferingPixel*> doubts;
    std::unordered_map<size_t, Trail> trails;
    for (DifferingPixel& pixel : differing) {
        if (!pixel.inDoubt) continue;
        doubts.push_back(&pixel);
        trails[device.indexOf(pixel.x, pixel.y)] = {};
    }
    for (const PixelRay& one : rays)
        if (const auto trail = trails.find(one.pixel); trail != trails.end())
            trail->second.push_back(one.ray);
    uint64_t unexplained = 0;
    for (size_t first = 0; first < doubts.size(); first += kCertifiedAtOnce) {
        const size_t count = std::min(kCertifiedAtOnce, doubts.size() - first);
        const bool decided = options_.verdictAlone && unexplained > report_.allowedExplained();
        const uint64_t most = decided ? 0 : std::min(steps_, kMostStepsOfPixel);
        std::vector<uint64_t> taken(count);
        parallelFor(context_, count, [&](size_t i) {
            DifferingPixel& pixel = *doubts[first + i];
            taken[i] = certifyPixel(pixel, trails.at(device.indexOf(pixel.x, pixel.y)), most);
        });
        for (size_t i = 0; i < count; ++i) {
            steps_ -= std::min(steps_, taken[i]);
            const DifferingPixel& pixel = *doubts[first + i];
            unexplained += !pixel.inDoubt && pixel.reason == Reason::Unexplained;
        }
    }
    std::erase_if(differing, [](const DifferingPixel& pixel) { return pixel.inDoubt; });
}

// Returns the steps that it took. A pixel stays in doubt if it is within its predicted error after all: each
// ray of the reference's own path is predicted, and takes the decisions of the reference's own ray.
uint64_t Verification::certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t mostSteps) const {
    const auto [weight, ray] = sampleAt(pixel.sample, pixel.x, pixel.y);
    const SeenPath seen{&trail, quantitiesOf(pixel.deviceColor, pixel.device), weight};
    const Certificate certificate = certify(tracer_, scene_, ray, seen, mostSteps);
    const bool holds = certificate.verdict == Certificate::Verdict::Holds;
    const bool open = certificate.openDecisions > 0;
    const bool samePath = pixel.device.pathHash == pixel.reference.pathHash;
    pixel.inDoubt = holds && samePath && !open && certificate.decisions == pixel.reference.decisions;
    pixel.ulps = certificate.units;
    pixel.openDecisions = certificate.openDecisions;
    if (holds)
        pixel.reason = samePath && open ? Reason::Rounding : Reason::Edge;
    else if (certificate.verdict == Certificate::Verdict::Undecided)
        pixel.reason = Reason::Undecided;
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

// How many of these pixels of a part have no such rays in samples 0 to `end` - 1.
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
