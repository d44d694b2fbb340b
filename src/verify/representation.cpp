#include "verify/representation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "reference/truth/truth.h"
#include "verify/ceiling.h"
#include "verify/certificate.h"
#include "verify/verify.h"

namespace glint::verify {

namespace {

// Scenes whose numbers are moved by up to one unit each, as packing moves them. Where more pixels are in
// doubt than may be explained, and three times as many scenes do not halve them, they are a defect.
constexpr uint64_t kMovedScenes = 24, kFirstScenes = 8;
// For the few pixels that these leave, where no more are left than rounding may change. At an edge one scene
// in dozens takes the packed one's path, and of what that may show (a face's normal, where its corners' last
// places are a thousandth of it) two or three scenes make no box.
constexpr uint64_t kLastScenes = 1024;
// How many times its own size a class's box may be missed by: what packing has made of the numbers is one
// more of the random moves, and of two such moves one is 5 times as long as the other in one case of ten, of
// ten the longest hardly ever.
constexpr double kMoveGain = 4;

double greatestDifference(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z});
}

bool isSameSurface(const reference::PixelRecord& a, const reference::PixelRecord& b) {
    if (a.bounces != b.bounces || a.hit.has_value() != b.hit.has_value()) return false;
    return !a.hit ||
           (a.surface->object == b.surface->object && a.surface->primitive == b.surface->primitive &&
            a.surface->material == b.surface->material);
}

}  // namespace

RepresentationCheck::RepresentationCheck(const Scene& read, const PackedScene& packed,
                                         const reference::Tracer& rounded, const shared::Camera& camera,
                                         const Options& options)
    : packed_(packed),
      options_(options),
      radianceBound_(radianceBoundOf(packed, options)),
      model_(std::make_shared<const reference::Model>(reference::truthOf(read, packed.origin))),
      truth_(model_, options, radianceBound_),
      camera_(reference::truthCamera(read.camera, options.width, options.height, packed.origin)),
      rounded_(rounded),
      roundedCamera_(camera),
      rows_(static_cast<size_t>(options.height)) {
    double asked = static_cast<double>(options.width) * options.height;
    if (asked > kSmallPicture) asked /= 4;
    probeStep_ = static_cast<int>(std::ceil(std::sqrt(asked * options.samples.round / kMaxKappaPixels)));
}

bool RepresentationCheck::asks(int x, int y, uint32_t sample) const {
    const size_t pixels = static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height);
    if (pixels <= kSmallPicture) return true;
    const auto column = static_cast<size_t>(x / 2), row = static_cast<size_t>(y / 2);
    const size_t columns = static_cast<size_t>(options_.width) / 2 + 1;
    const glm::ivec2 place = placeInCell((sample * pixels + row) * columns + column, 2);
    return place == glm::ivec2(x % 2, y % 2);
}

reference::Ray RepresentationCheck::rayOf(const reference::Tracer& tracer,
                                          const reference::rows::Camera& camera, int x, int y,
                                          const reference::FilmSample& film) const {
    return tracer.cameraRay(camera, x + film.offset.x, y + film.offset.y, film.lens);
}

void RepresentationCheck::compare(int x, int y, uint32_t sample, const reference::FilmSample& s,
                                  const reference::PixelRecord& rounded) {
    if (!asks(x, y, sample)) return;
    Row& row = rows_[static_cast<size_t>(y)];
    Doubt doubt{
        x, y,     sample, s, quantitiesOf(rounded, packed_.origin), rounded.pathHash, rounded.shadowBits,
        0, false, 0,      {}};
    const reference::Ray ray = rayOf(truth_, camera_, doubt);
    const reference::PixelRecord truth = truth_.trace(ray);
    const glm::dvec3 d = rounded.color - truth.color;
    doubt.difference = greatestDifference(rounded.color, truth.color);
    row.differences.push_back(static_cast<float>(doubt.difference));
    row.squares += glm::dot(d, d);
    // Some kMaxKappaPixels of those asked, at random.
    const size_t cell = (static_cast<size_t>(sample) * rows_.size() + static_cast<size_t>(y)) *
                            static_cast<size_t>(options_.width) +
                        static_cast<size_t>(x);
    if (placeInCell(cell, probeStep_) == glm::ivec2(0)) row.probed.push_back({x, y, s});
    doubt.decisions = truth.decisions;
    doubt.samePath = truth.pathHash == rounded.pathHash;
    if (doubt.samePath) {
        if (!isSameSurface(truth, rounded)) {
            doubt.state = Doubt::State::Unexplained;
            row.doubts.push_back(std::move(doubt));
            return;
        }
        const Hull hull(quantitiesOf(truth, packed_.origin));
        const bool sameShadows = truth.shadowBits == rounded.shadowBits;
        if (sameShadows && hull.contains(doubt.rounded, floorsOf(packed_, truth, ray), 0)) return;
        doubt.classes.push_back({truth.decisions, hull, 1});
    }
    row.doubts.push_back(std::move(doubt));
}

// Asks a scene with moved numbers about all pixels in doubt, and leaves those that it says nothing of.
void RepresentationCheck::draw(uint64_t seed, double units, std::vector<Doubt*>& open) const {
    const auto moved = std::make_shared<const reference::Model>(reference::disturbed(*model_, seed, units));
    const reference::Tracer tracer(moved, options_, radianceBound_);
    const reference::rows::Camera camera = reference::disturbed(camera_, seed, units);
    constexpr size_t kTurn = 64;
    parallelFor((open.size() + kTurn - 1) / kTurn, [&](size_t turn) {
        for (size_t i = turn * kTurn; i < std::min(open.size(), (turn + 1) * kTurn); ++i) {
            Doubt& doubt = *open[i];
            const reference::Ray ray = rayOf(tracer, camera, doubt);
            const reference::PixelRecord record = tracer.trace(ray);
            if (record.pathHash != doubt.pathHash || record.shadowBits != doubt.shadowBits) continue;
            const Quantities q = quantitiesOf(record, packed_.origin);
            auto at = std::find_if(doubt.classes.begin(), doubt.classes.end(),
                                   [&](const Class& c) { return c.decisions == record.decisions; });
            if (at == doubt.classes.end()) at = doubt.classes.insert(at, {record.decisions, Hull(q), 0});
            at->hull.include(q);
            ++at->members;
            if (!at->hull.contains(doubt.rounded, floorsOf(packed_, record, ray),
                                   at->members > 1 ? kMoveGain : 0))
                continue;
            const bool alike = doubt.samePath && record.decisions == doubt.decisions;
            doubt.state = alike ? Doubt::State::Predicted : Doubt::State::Explained;
        }
    });
    std::erase_if(open, [](const Doubt* doubt) { return doubt->state != Doubt::State::Open; });
}

// Behind many bounces a handful of moved scenes does not take the path in question: then the truth must give
// each ray's hit and light for roundings of that ray.
void RepresentationCheck::searchOn(Doubt& doubt) const {
    const reference::PixelRecord rounded = rounded_.trace(rayOf(rounded_, roundedCamera_, doubt), {}, true);
    const Trail trail = trailOf(rounded);
    SeenPath seen;
    seen.trail = &trail;
    seen.first = doubt.rounded;
    seen.fromDevice = false;
    const Certificate certificate =
        certify(truth_, packed_, rayOf(truth_, camera_, doubt), seen, kMostStepsOfPixel);
    if (certificate.verdict == Certificate::Verdict::Holds) doubt.state = Doubt::State::Explained;
}

// Share of pixels that change when the scene's numbers are moved. It may exceed the share for moved rays. On
// facets a hundredth of the scene in size, the last places of the corners turn each normal by a hundred
// units. A ray continues behind each facet.
double RepresentationCheck::changedShare() const {
    std::vector<Place> places;
    for (const Row& row : rows_) places.insert(places.end(), row.probed.begin(), row.probed.end());
    std::vector<reference::PixelRecord> still(places.size());
    parallelFor(places.size(), [&](size_t i) {
        still[i] = truth_.trace(rayOf(truth_, camera_, places[i].x, places[i].y, places[i].film));
    });
    Sensitivity sensitivity;
    sensitivity.tried = places.size();
    for (const bool widely : {false, true}) {
        std::atomic<uint64_t> changed = 0;
        const double units = widely ? kWideUnits : 1;
        for (uint64_t seed = 1; seed <= kFirstScenes; ++seed) {
            const auto moved =
                std::make_shared<const reference::Model>(reference::disturbed(*model_, seed, units));
            const reference::Tracer tracer(moved, options_, radianceBound_);
            const reference::rows::Camera camera = reference::disturbed(camera_, seed, units);
            parallelFor(places.size() / kFirstScenes + 1, [&](size_t turn) {
                const size_t i = turn * kFirstScenes + seed - 1;
                if (i >= places.size()) return;
                const reference::Ray ray = rayOf(tracer, camera, places[i].x, places[i].y, places[i].film);
                changed += isOtherwise(still[i], tracer.trace(ray));
            });
        }
        (widely ? sensitivity.changedWidely : sensitivity.changed) = changed;
    }
    return sensitivity.explainedShare();
}

RepresentedPixel RepresentationCheck::pixelOf(const Doubt& doubt) const {
    RepresentedPixel pixel;
    pixel.x = doubt.x;
    pixel.y = doubt.y;
    pixel.sample = doubt.sample;
    pixel.explained = doubt.state == Doubt::State::Explained;
    pixel.difference = doubt.difference;
    pixel.truth = truth_.trace(rayOf(truth_, camera_, doubt));
    pixel.rounded = rounded_.trace(rayOf(rounded_, roundedCamera_, doubt));
    return pixel;
}

// Leaves in `open` what nothing explains, or what is not worth a longer search.
void RepresentationCheck::search(std::vector<Doubt*>& open,
                                 const std::function<bool(size_t)>& areTooMany) const {
    uint64_t drawn = 0;
    const auto drawUpTo = [&](uint64_t last) {
        while (drawn < last && !open.empty()) draw(++drawn, 1, open);
    };
    // All pixels see the same few moves, so that many in doubt may be one number's.
    size_t before = 0;
    drawUpTo(kFirstScenes);
    do {
        before = open.size();
        drawUpTo(std::max(kMovedScenes, 3 * drawn));
    } while (areTooMany(open.size()) && 2 * open.size() <= before && drawn < kLastScenes);
    if (!areTooMany(open.size())) {
        parallelFor(open.size(), [&](size_t i) { searchOn(*open[i]); });
        std::erase_if(open, [](const Doubt* doubt) { return doubt->state != Doubt::State::Open; });
        drawUpTo(kLastScenes);
    }
}

Representation RepresentationCheck::judge(const Sensitivity& sensitivity, size_t worstCount) {
    Representation result;
    std::vector<float> differences;
    std::vector<Doubt*> open, all;
    double squares = 0;
    for (Row& row : rows_) {
        differences.insert(differences.end(), row.differences.begin(), row.differences.end());
        squares += row.squares;
        for (Doubt& doubt : row.doubts) {
            all.push_back(&doubt);
            if (doubt.state == Doubt::State::Open) open.push_back(&doubt);
        }
    }
    result.asked = differences.size();
    for (const float d : differences) result.greatest = std::max(result.greatest, static_cast<double>(d));
    result.rmse = std::sqrt(squares / (3 * static_cast<double>(std::max<uint64_t>(result.asked, 1))));
    result.p99 = percentile99(std::move(differences));
    result.allowed = greatestCount(sensitivity.explainedShare() * static_cast<double>(result.asked));
    bool probed = false;
    const auto areTooMany = [&](size_t count) {
        if (count <= result.allowed || std::exchange(probed, true)) return count > result.allowed;
        const double changed = changedShare() * static_cast<double>(result.asked);
        result.allowed = std::max(result.allowed, greatestCount(changed));
        return count > result.allowed;
    };
    search(open, areTooMany);
    std::vector<const Doubt*> shown;
    for (Doubt* doubt : all) {
        if (doubt->state == Doubt::State::Open) doubt->state = Doubt::State::Unexplained;
        result.explained += doubt->state == Doubt::State::Explained;
        result.unexplained += doubt->state == Doubt::State::Unexplained;
        if (doubt->state != Doubt::State::Predicted) shown.push_back(doubt);
    }
    areTooMany(result.explained);  // asks for a limit of its own if need be
    std::sort(shown.begin(), shown.end(), [](const Doubt* a, const Doubt* b) {
        if (a->state != b->state) return a->state == Doubt::State::Unexplained;
        return std::tuple(-a->difference, a->y, a->x) < std::tuple(-b->difference, b->y, b->x);
    });
    shown.resize(std::min(shown.size(), worstCount));
    for (const Doubt* doubt : shown) result.worst.push_back(pixelOf(*doubt));
    return result;
}

}  // namespace glint::verify
