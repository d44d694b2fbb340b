#include "verify/representation.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "reference/truth/truth.h"
#include "verify/certificate.h"
#include "verify/verify.h"

namespace glint::verify {

namespace {

// Scenes whose numbers are moved by up to one unit each, as packing moves them: three times as many as long
// as that halves the pixels in doubt.
constexpr uint64_t kMovedScenes = 24, kFirstScenes = 8;
// For the few pixels that these leave: at most kFewPixels, and one in kFewPixels of those asked. More are a
// defect. At an edge one scene in dozens takes the packed one's path, and of what that may show (a face's
// normal, where its corners' last places are a thousandth of it) two or three scenes make no box.
constexpr uint64_t kLastScenes = 1024;
constexpr size_t kFewPixels = 64;
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
      rows_(static_cast<size_t>(options.height)) {}

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
    doubt.decisions = truth.decisions;
    doubt.samePath = truth.pathHash == rounded.pathHash;
    if (doubt.samePath) {
        if (!isSameSurface(truth, rounded)) {
            doubt.state = Doubt::State::Unexplained;
            row.doubts.push_back(std::move(doubt));
            return;
        }
        const Box box(quantitiesOf(truth, packed_.origin), floorsOf(packed_, truth, ray));
        const bool sameShadows = truth.shadowBits == rounded.shadowBits;
        if (sameShadows && box.contains(0, doubt.rounded, 0)) return;
        doubt.classes.push_back({truth.decisions, box, 1});
    }
    row.doubts.push_back(std::move(doubt));
}

// Asks a scene with moved numbers about all pixels in doubt, and leaves those that it says nothing of.
void RepresentationCheck::draw(uint64_t seed, std::vector<Doubt*>& open) const {
    const auto moved = std::make_shared<const reference::Model>(reference::disturbed(*model_, seed, 1));
    const reference::Tracer tracer(moved, options_, radianceBound_);
    const reference::rows::Camera camera = reference::disturbed(camera_, seed, 1);
    constexpr size_t kTurn = 64;
    parallelFor(Context{}, (open.size() + kTurn - 1) / kTurn, [&](size_t turn) {
        for (size_t i = turn * kTurn; i < std::min(open.size(), (turn + 1) * kTurn); ++i) {
            Doubt& doubt = *open[i];
            const reference::Ray ray = rayOf(tracer, camera, doubt);
            const reference::PixelRecord record = tracer.trace(ray);
            if (record.pathHash != doubt.pathHash || record.shadowBits != doubt.shadowBits) continue;
            const Box box(quantitiesOf(record, packed_.origin), floorsOf(packed_, record, ray));
            auto at = std::find_if(doubt.classes.begin(), doubt.classes.end(),
                                   [&](const Class& c) { return c.decisions == record.decisions; });
            if (at == doubt.classes.end()) at = doubt.classes.insert(at, {record.decisions, box, 0});
            at->box.include(box);
            ++at->members;
            if (!at->box.contains(0, doubt.rounded, at->members > 1 ? kMoveGain : 0)) continue;
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
void RepresentationCheck::search(std::vector<Doubt*>& open, size_t asked) const {
    uint64_t drawn = 0;
    const auto drawUpTo = [&](uint64_t last) {
        while (drawn < last && !open.empty()) draw(++drawn, open);
    };
    // All pixels see the same few moves, so that many in doubt may be one number's.
    drawUpTo(kFirstScenes);
    size_t before = 0;
    do {
        before = open.size();
        drawUpTo(std::max(kMovedScenes, 3 * drawn));
    } while (!open.empty() && 2 * open.size() <= before && drawn < kLastScenes);
    if (open.size() > kFewPixels + asked / kFewPixels) return;
    parallelFor(Context{}, open.size(), [&](size_t i) { searchOn(*open[i]); });
    std::erase_if(open, [](const Doubt* doubt) { return doubt->state != Doubt::State::Open; });
    drawUpTo(kLastScenes);
}

Representation RepresentationCheck::judge(size_t worstCount) {
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
    search(open, result.asked);
    std::vector<const Doubt*> shown;
    for (Doubt* doubt : all) {
        if (doubt->state == Doubt::State::Open) doubt->state = Doubt::State::Unexplained;
        result.explained += doubt->state == Doubt::State::Explained;
        result.unexplained += doubt->state == Doubt::State::Unexplained;
        if (doubt->state != Doubt::State::Predicted) shown.push_back(doubt);
    }
    std::sort(shown.begin(), shown.end(), [](const Doubt* a, const Doubt* b) {
        if (a->state != b->state) return a->state == Doubt::State::Unexplained;
        return std::tuple(-a->difference, a->y, a->x) < std::tuple(-b->difference, b->y, b->x);
    });
    shown.resize(std::min(shown.size(), worstCount));
    for (const Doubt* doubt : shown) result.worst.push_back(pixelOf(*doubt));
    return result;
}

}  // namespace glint::verify
