#include "verify/verify.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <mutex>
#include <span>

#include "core/parallel.h"
#include "reference/sampling.h"
#include "verify/account.h"
#include "verify/ceiling.h"
#include "verify/certificate.h"
#include "verify/film.h"

namespace glint::verify {

namespace {

// Sums over pixels, one row at a time so that the result does not depend on the threads.
struct RowSums {
    explicit RowSums(double radianceBound) : account(radianceBound) {}
    Account account;
    double squares = 0, squaresSamePath = 0, maxSamePath = 0;
    uint64_t samePath = 0, idsDiffer = 0, rays = 0;
    std::vector<DifferingPixel> differing;
    std::vector<glm::vec3> device, reference;  // colours by pixel
    std::vector<float> differences;            // by pixel, infinite where the device's colour is not finite
    std::vector<float> floors;                 // by pixel, greatest channel of PixelRecord::rounding
};

constexpr float kDifferenceGain = 64;

// Steps of the reference that certificates of a sample may take: as many times its own, and some for small
// images.
constexpr uint64_t kStepsOfRay = 3, kLeastSteps = 1'000'000;
// Pixels whose trails are held at a time, and that are certified between two looks at the steps left.
constexpr size_t kTrailsAtOnce = 16'384, kCertifiedAtOnce = 64;

class Comparison {
  public:
    Comparison(const PackedScene& scene, const shared::Camera& camera, const Options& options,
               const Picture& device, const PackedSamples& samples, uint32_t sample,
               const reference::Tracer& tracer, RepresentationCheck* representation)
        : tracer_(tracer),
          scene_(scene),
          camera_(camera),
          options_(options),
          device_(device),
          samples_(samples),
          sample_(sample),
          representation_(representation) {}

    // Decides about a pixel of this sample that is in doubt. True if it is within its predicted error after
    // all: each ray of the reference's own path is predicted.
    bool certifyPixel(DifferingPixel& pixel, const Trail& trail, uint64_t& steps) const {
        const reference::FilmSample s = filmSampleAt(pixel.x, pixel.y);
        SeenPath seen;
        seen.trail = &trail;
        seen.first = quantitiesOf(pixel.deviceColor, pixel.device);
        seen.weight = s.weight;
        const Certificate certificate =
            certify(tracer_, scene_, rayThrough(pixel.x, pixel.y, s), seen, steps);
        steps = certificate.steps;
        pixel.ulps = certificate.units;
        pixel.openDecisions = certificate.openDecisions;
        if (certificate.verdict == Certificate::Verdict::Fails) return false;
        if (certificate.verdict == Certificate::Verdict::Undecided) {
            pixel.reason = Reason::Undecided;
            return false;
        }
        const bool samePath = pixel.device.pathHash == pixel.reference.pathHash;
        pixel.reason = samePath ? Reason::Rounding : Reason::Edge;
        if (!samePath || certificate.openDecisions > 0) return false;
        // Predicted step by step, unless the device's rays decide otherwise than the reference's.
        const reference::Ray ray = rayThrough(pixel.x, pixel.y, s);
        const reference::PixelRecord still = tracer_.trace(ray, {}, true);
        const Trail own = trailOf(still);
        SeenPath itself;
        itself.trail = &own;
        itself.first = quantitiesOf(still, scene_.origin);
        itself.fromDevice = false;
        const bool alike =
            certify(tracer_, scene_, ray, itself, kMostStepsOfPixel).decisions == certificate.decisions;
        if (!alike) pixel.reason = Reason::Edge;
        return alike;
    }

    double radianceBound() const { return static_cast<double>(tracer_.environment().radianceBound); }
    // False without secondary rays: the device then has no code for mirrors and does not count omitted
    // branches.
    bool countsBranches() const { return tracer_.environment().maxDepth > 0; }

    RowSums row(int y) const {
        RowSums sums(radianceBound());
        for (int x = 0; x < options_.width; ++x) comparePixel(x, y, sums);
        return sums;
    }

  private:
    reference::FilmSample filmSampleAt(int x, int y) const {
        return reference::filmSample(samples_, sample_, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
    }

    reference::Ray rayThrough(int x, int y, const reference::FilmSample& s) const {
        return tracer_.cameraRay(camera_, x + s.offset.x, y + s.offset.y, s.lens);
    }

    void comparePixel(int x, int y, RowSums& sums) const {
        const reference::FilmSample s = filmSampleAt(x, y);
        const reference::Ray ray = rayThrough(x, y, s);
        const reference::PixelRecord expected = tracer_.trace(ray);
        sums.rays += expected.bounces + 1;
        if (representation_ != nullptr) representation_->compare(x, y, sample_, s, expected);
        const PixelData& data = device_.at(x, y);
        const glm::vec3 weighted(device_.color.at(x, y, 0), device_.color.at(x, y, 1),
                                 device_.color.at(x, y, 2));
        const glm::vec3 color = weighted / static_cast<float>(s.weight);
        const glm::dvec3 d = glm::abs(glm::dvec3(color) - expected.color);
        const bool finite = std::isfinite(d.x + d.y + d.z);
        const double difference =
            finite ? std::max({d.x, d.y, d.z}) : std::numeric_limits<double>::infinity();
        const bool samePath = data.pathHash == expected.pathHash;
        sums.device.push_back(color);
        sums.reference.push_back(glm::vec3(expected.color));
        sums.differences.push_back(static_cast<float>(difference));
        if (finite) {
            sums.squares += glm::dot(d, d);
            if (samePath) {
                sums.squaresSamePath += glm::dot(d, d);
                sums.maxSamePath = std::max(sums.maxSamePath, difference);
                ++sums.samePath;
            }
        }
        const glm::dvec3 rounding = expected.rounding;
        sums.floors.push_back(static_cast<float>(std::max({rounding.x, rounding.y, rounding.z})));
        const Quantities seen = quantitiesOf(color, data);
        const double weight = std::abs(s.weight);
        if (samePath && isSameHit(data, expected))
            sums.account.addAlike(expected.lost, weight);
        else
            sums.account.addOther(data.bounces, weight);
        const bool covered = isCovered(x, y, s.weight);
        const bool predicted = finite && covered && isPredictedHit(ray, expected, data, seen);
        if (predicted && beginsClear(scene_, expected, ray, data)) return;
        DifferingPixel pixel;
        pixel.x = x;
        pixel.y = y;
        pixel.sample = sample_;
        pixel.difference = difference;
        pixel.deviceColor = color;
        pixel.device = data;
        pixel.reference = expected;
        // Rounding of a ray cannot explain a pixel that is wrong only in the starts of its rays or in the
        // indices of a hit.
        pixel.inDoubt = covered && finite && !predicted && (!samePath || isSameHit(data, expected));
        sums.idsDiffer += samePath ? 0 : 1;
        sums.differing.push_back(std::move(pixel));
    }

    bool isPredictedHit(const reference::Ray& ray, const reference::PixelRecord& expected,
                        const PixelData& data, const Quantities& seen) const {
        return data.pathHash == expected.pathHash && isSameHit(data, expected) &&
               isPredicted(tracer_, ray, expected, scene_, seen);
    }

    // The picture's alpha is the sample's weight where the device has hit anything, and 0 elsewhere. The
    // weight is rounded once, and so are the inverse of the count and the product with it.
    bool isCovered(int x, int y, double weight) const {
        const double expected = device_.at(x, y).object == PixelData::kNoIndex ? 0 : weight;
        return std::abs(static_cast<double>(device_.color.at(x, y, 3)) - expected) <=
               4 * kFloatUnit * std::abs(expected);
    }

    // True if the device's layers of the first hit agree with the reference path.
    static bool isSameHit(const PixelData& data, const reference::PixelRecord& expected) {
        if (data.bounces != expected.bounces) return false;
        if (!expected.hit) return data.object == PixelData::kNoIndex;
        const reference::Surface& surface = *expected.surface;
        return data.object == surface.object && data.primitive == surface.primitive &&
               data.material == surface.material;
    }

    const reference::Tracer& tracer_;
    const PackedScene& scene_;
    const shared::Camera& camera_;
    const Options& options_;
    const Picture& device_;
    const PackedSamples& samples_;
    uint32_t sample_;
    RepresentationCheck* representation_;  // or null
};

void paint(Image& image, const DifferingPixel& pixel) {
    static const float colors[4][3] = {{1, 0.8f, 0}, {0.1f, 0.8f, 0.2f}, {0.8f, 0, 0.8f}, {1, 0, 0}};
    for (int c = 0; c < 3; ++c) image.at(pixel.x, pixel.y, c) = colors[static_cast<int>(pixel.reason)][c];
}

bool worseThan(const DifferingPixel& a, const DifferingPixel& b) {
    const bool ua = a.reason == Reason::Unexplained, ub = b.reason == Reason::Unexplained;
    if (ua != ub) return ua;
    if (a.difference != b.difference) return a.difference > b.difference;
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
}

uint64_t& countOf(Report& report, Reason reason) {
    switch (reason) {
        case Reason::Edge:
            return report.edges;
        case Reason::Rounding:
            return report.roundings;
        case Reason::Undecided:
            return report.undecided;
        case Reason::Unexplained:
            break;
    }
    return report.unexplained;
}

// The pixels that differ are counted once they are certified.
void addRow(RowSums& row, int y, Report& report, size_t sample) {
    for (int x = 0; sample == 0 && x < static_cast<int>(row.differences.size()); ++x) {
        const float grey = std::min(row.differences[x] * kDifferenceGain, 1.0f);
        for (int c = 0; c < 3; ++c) {
            report.difference.at(x, y, c) = grey;
            report.device.at(x, y, c) = row.device[x][c];
            report.reference.at(x, y, c) = row.reference[x][c];
        }
    }
    report.idsDiffer += row.idsDiffer;
    report.rmse += row.squares;
    report.rmseSamePath += row.squaresSamePath;
    report.maxSamePath = std::max(report.maxSamePath, row.maxSamePath);
}

// Certifies the pixels in doubt, in order, as long as there are steps left; drops those that turn out to lie
// within their predicted error. Deterministic: the steps left are looked at between batches.
class DoubtCheck {
  public:
    using Trails = std::function<std::vector<Trail>(const std::vector<glm::ivec2>&)>;

    DoubtCheck(const Comparison& comparison, const Options& options, const Report& report, uint64_t steps)
        : comparison_(comparison), options_(options), report_(report), stepsLeft_(steps) {}

    void run(std::vector<DifferingPixel>& differing, const Trails& trailsOf) {
        std::vector<DifferingPixel*> doubts;
        for (DifferingPixel& pixel : differing)
            if (pixel.inDoubt) doubts.push_back(&pixel);
        for (size_t first = 0; first < doubts.size(); first += kTrailsAtOnce) {
            const size_t count = std::min(kTrailsAtOnce, doubts.size() - first);
            certifyAll(std::span(doubts).subspan(first, count), trailsOf);
        }
        std::erase_if(differing, [](const DifferingPixel& pixel) { return pixel.inDoubt; });
    }

  private:
    void certifyAll(std::span<DifferingPixel*> doubts, const Trails& trailsOf) {
        std::vector<glm::ivec2> places;
        for (const DifferingPixel* pixel : doubts) places.emplace_back(pixel->x, pixel->y);
        if (isOver()) {
            leave(doubts);
            return;
        }
        const std::vector<Trail> trails = trailsOf(places);
        for (size_t first = 0; first < doubts.size(); first += kCertifiedAtOnce) {
            const size_t count = std::min(kCertifiedAtOnce, doubts.size() - first);
            const auto some = doubts.subspan(first, count);
            if (isOver()) {
                leave(some);
                continue;
            }
            std::vector<uint64_t> steps(count, std::min(stepsLeft_, kMostStepsOfPixel));
            parallelFor(Context{}, count, [&](size_t i) {
                DifferingPixel& pixel = *some[i];
                pixel.inDoubt = comparison_.certifyPixel(pixel, trails[first + i], steps[i]);
            });
            for (const uint64_t taken : steps) stepsLeft_ -= std::min(stepsLeft_, taken);
            for (const DifferingPixel* pixel : some) unexplained_ += pixel->reason == Reason::Unexplained;
        }
    }
    bool isOver() const {
        return stepsLeft_ == 0 || (options_.cancelled && options_.cancelled()) ||
               (options_.verdictAlone && unexplained_ > report_.allowedExplained());
    }
    static void leave(std::span<DifferingPixel*> doubts) {
        for (DifferingPixel* pixel : doubts) {
            pixel->inDoubt = false;
            pixel->reason = Reason::Undecided;
        }
    }

    const Comparison& comparison_;
    const Options& options_;
    const Report& report_;
    uint64_t stepsLeft_;
    uint64_t unexplained_ = 0;
};

void keepWorst(Report& report, size_t count) {
    const size_t kept = std::min(count, report.worst.size());
    std::partial_sort(report.worst.begin(), report.worst.begin() + static_cast<std::ptrdiff_t>(kept),
                      report.worst.end(), worseThan);
    report.worst.resize(kept);
}

}  // namespace

uint64_t Report::allowedExplained() const {
    return greatestCount(sensitivity.explainedShare() * static_cast<double>(pixels));
}

double Report::allowedP99() const {
    return kResponseGain * sensitivity.kappaLimit * kFloatUnit + floorP99;
}

namespace {

// Values gathered over the samples.
struct Gathered {
    std::vector<float> differences, floors;
    uint64_t samePath = 0;
};

// False if it was interrupted.
bool addSample(const Comparison& comparison, const Picture& device, const Options& options, uint32_t sample,
               const DoubtCheck::Trails& trailsOf, Report& report, Gathered& all) {
    const auto isInterrupted = [&] { return !device.complete || (options.cancelled && options.cancelled()); };
    std::vector<RowSums> rows(options.height, RowSums(comparison.radianceBound()));
    std::mutex mutex;
    size_t finished = size_t{sample} * options.height;
    parallelFor(Context{}, static_cast<size_t>(options.height), [&](size_t y) {
        if (isInterrupted()) return;
        rows[y] = comparison.row(static_cast<int>(y));
        const std::lock_guard lock(mutex);
        ++finished;
        if (options.progress)
            options.progress(static_cast<double>(finished) /
                             (static_cast<double>(options.height) * options.samples.round));
    });
    if (isInterrupted()) return false;
    Account account(comparison.radianceBound());
    uint64_t rays = 0;
    std::vector<DifferingPixel> differing;
    for (int y = 0; y < options.height; ++y) {
        account.add(rows[y].account);
        addRow(rows[y], y, report, sample);
        all.differences.insert(all.differences.end(), rows[y].differences.begin(), rows[y].differences.end());
        all.floors.insert(all.floors.end(), rows[y].floors.begin(), rows[y].floors.end());
        all.samePath += rows[y].samePath;
        rays += rows[y].rays;
        std::move(rows[y].differing.begin(), rows[y].differing.end(), std::back_inserter(differing));
    }
    DoubtCheck(comparison, options, report, kStepsOfRay * rays + kLeastSteps).run(differing, trailsOf);
    if (isInterrupted()) return false;
    for (DifferingPixel& pixel : differing) {
        ++countOf(report, pixel.reason);
        if (sample == 0) paint(report.difference, pixel);
        report.worst.push_back(std::move(pixel));
    }
    if (comparison.countsBranches() && !account.agrees(device.losses, report.allowedExplained()))
        ++report.lossesDiffer;
    keepWorst(report, options.worstCount);
    return true;
}

// True if some ray as near as roundings move it meets surfaces of which fp32's errors decide whether they are
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
uint64_t countSettled(const reference::Tracer& tracer, const shared::Camera& camera,
                      const PackedSamples& samples, uint32_t first, uint32_t end, int width,
                      const std::vector<size_t>& pixels) {
    std::atomic<uint64_t> settled = 0;
    parallelFor(Context{}, pixels.size(), [&](size_t i) {
        const auto x = static_cast<uint32_t>(pixels[i] % width), y = static_cast<uint32_t>(pixels[i] / width);
        for (uint32_t sample = first; sample < end; ++sample) {
            const reference::FilmSample s = reference::filmSample(samples, sample, x, y);
            const reference::Ray ray = tracer.cameraRay(camera, x + s.offset.x, y + s.offset.y, s.lens);
            if (isOrderOpen(tracer, ray)) return;
        }
        ++settled;
    });
    return settled;
}

// Pixels of which the same request without data has another colour. What is verified must be what people get.
std::vector<size_t> plainDifferences(render::Renderer& renderer, const shared::Camera& camera,
                                     Request request, const Picture& device, Report& report) {
    request.data = request.ledger = false;
    const Picture plain = renderer.render(camera, request);
    report.interrupted = report.interrupted || !plain.complete;
    std::vector<size_t> differing;
    for (size_t i = 0; i < device.done.size(); ++i)
        if (std::memcmp(&plain.color.pixels[4 * i], &device.color.pixels[4 * i], 4 * sizeof(float)) != 0)
            differing.push_back(i);
    return differing;
}

// Pixels of the picture of all samples that are not what those demand which `film` has. It has the first
// round's.
std::vector<size_t> filmDifferences(render::Renderer& renderer, const shared::Camera& camera, Request request,
                                    Film& film, Report& report) {
    const PackedSamples samples = request.samples;
    request.data = request.ledger = false;
    request.progress = {};
    for (uint32_t sample = samples.round; sample < samples.count(); ++sample) {
        request.samples = samples.only(sample);
        film.add(sample, renderer.render(camera, request));
    }
    request.samples = samples;
    const Picture whole = renderer.render(camera, request);
    report.interrupted = report.interrupted || !whole.complete;
    return film.differing(whole);
}

}  // namespace

Report verify(render::Renderer& renderer, const PackedScene& scene, const shared::Camera& camera,
              const Options& options, const Scene* read) {
    Report report;
    for (Image* image : {&report.device, &report.reference, &report.difference})
        *image = Image(options.width, options.height, 3);
    report.allowedUnexplained = options.allowedUnexplained;
    const PackedSamples& samples = options.samples;
    report.pixels = static_cast<uint64_t>(options.width) * options.height * samples.round;
    const reference::Tracer tracer(scene, options);
    report.sensitivity = sensitivityOf(tracer, camera, options.width, options.height, samples);
    std::optional<RepresentationCheck> representation;
    if (read != nullptr) representation.emplace(*read, scene, tracer, camera, options);
    Gathered all;
    Request request = options;
    request.region = {};
    const bool branches = scene.features.mirrors || scene.features.transmission;
    const PackedSamples rounds = firstRounds(samples);
    Film film(rounds, options.width, options.height, scene.lights.size());
    for (uint32_t sample = 0; sample < samples.round; ++sample) {
        request.samples = samples.only(sample);
        request.data = true;
        request.ledger = branches;
        request.progress = {};
        const Picture device = renderer.render(camera, request);
        const Comparison comparison(scene, camera, options, device, samples, sample, tracer,
                                    representation ? &*representation : nullptr);
        const auto trailsOf = [&](const std::vector<glm::ivec2>& pixels) {
            return renderer.trails(camera, request, pixels);
        };
        if (!addSample(comparison, device, options, sample, trailsOf, report, all)) {
            report.interrupted = true;
            return report;
        }
        const bool convicted = options.verdictAlone && report.unexplained > 0;
        if (options.plainToo && !convicted)
            report.plainDiffers += countSettled(tracer, camera, samples, sample, sample + 1, options.width,
                                                plainDifferences(renderer, camera, request, device, report));
        if (report.interrupted) return report;
        if (rounds.count() > 1) film.add(sample, device);
    }
    if (options.filmToo && rounds.count() > 1 && !(options.verdictAlone && report.unexplained > 0)) {
        request.samples = rounds;
        report.filmDiffers = countSettled(tracer, camera, rounds, 0, rounds.count(), options.width,
                                          filmDifferences(renderer, camera, request, film, report));
        if (report.interrupted) return report;
    }
    // A few thousand pixels tell little of what seldom happens: before they fail an image, ask more.
    const bool tooMany = report.explained() + report.undecided > report.allowedExplained();
    if (tooMany && report.unexplained == 0)
        report.sensitivity =
            sensitivityOf(tracer, camera, options.width, options.height, samples, 3, 16 * kMaxKappaPixels);
    if (representation) report.representation = representation->judge(options.worstCount);
    report.p99 = percentile99(std::move(all.differences));
    report.floorP99 = percentile99(std::move(all.floors));
    report.rmse = std::sqrt(report.rmse / (3.0 * static_cast<double>(report.pixels)));
    report.rmseSamePath =
        all.samePath ? std::sqrt(report.rmseSamePath / (3.0 * static_cast<double>(all.samePath))) : 0.0;
    return report;
}

}  // namespace glint::verify
