#include "verify/representation.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "core/vectors.h"
#include "reference/sampling.h"
#include "reference/sensitivity.h"
#include "reference/truth/truth.h"
#include "verify/certificate.h"

namespace glint::verify {

namespace {

// In larger images one random pixel of each 2 x 2 is examined.
constexpr size_t kSmallImage = 4096;
// Scenes with each number moved by up to one unit, as by packing: for all pixels, and for the few that are
// left and have no certificate (kFewPixels and one in kFewPixels of those examined). More are a defect,
// unless mayLeave allows them.
constexpr uint64_t kMovedScenes = 24, kLastScenes = 1024;
constexpr size_t kFewPixels = 64;
// Scenes in place of the packed one. One number that decides many pixels may decide none of them in half of
// the scenes.
constexpr uint64_t kStandIns = 8;
// A class's box may be missed by this many times its size. Packing is one more random move of the numbers. Of
// two random moves one is 5 times as long as the other in one case of ten; it is hardly ever that much longer
// than the longest of ten.
constexpr double kMoveGain = 4;

// True if a box has the quantities of a pixel, other than those that depend on packing.
bool containsScene(const Box& box, const Quantities& quantities, double stretch) {
    return box.contains(0, std::span(quantities).first<kSceneQuantities>(), stretch);
}

// The points that packing measures surfaces from.
reference::Anchors anchorsOf(const PackedScene& packed) {
    reference::Anchors anchors;
    for (const shared::Quadric& quadric : packed.quadrics) anchors[quadric.object] = quadric.point;
    for (const shared::Plane& plane : packed.planes) anchors[plane.object] = plane.point;
    return anchors;
}

}  // namespace

RepresentationCheck::RepresentationCheck(const Scene& read, const PackedScene& packed,
                                         const reference::Tracer& rounded, const shared::Camera& camera,
                                         const Request& request)
    : packed_(packed),
      request_(request),
      radianceBound_(radianceBoundOf(packed, request)),
      model_(std::make_shared<const reference::Model>(
          reference::truthOf(read, packed.origin, anchorsOf(packed)))),
      truth_(model_, request, radianceBound_),
      camera_(reference::truthCamera(read.camera, request.width, request.height, packed.origin)),
      rounded_(rounded),
      roundedCamera_(camera),
      rows_(static_cast<size_t>(request.height)) {}

bool RepresentationCheck::examines(int x, int y, uint32_t sample) const {
    const auto width = static_cast<size_t>(request_.width), height = static_cast<size_t>(request_.height);
    if (width * height <= kSmallImage) return true;
    const size_t row = sample * height + static_cast<size_t>(y / 2);
    return reference::placeInCell(row * width + static_cast<size_t>(x / 2), 2) == glm::ivec2(x % 2, y % 2);
}

reference::Ray RepresentationCheck::rayOf(const reference::Tracer& tracer,
                                          const reference::rows::Camera& camera, const Doubt& doubt) const {
    return reference::pixelSample(tracer, camera, request_.samples, doubt.sample, doubt.x, doubt.y).ray;
}

std::vector<RepresentationCheck::Doubt*> RepresentationCheck::doubtsOf(std::vector<Row>& rows) {
    std::vector<Doubt*> doubts;
    for (Row& row : rows)
        for (Doubt& doubt : row.doubts) doubts.push_back(&doubt);
    return doubts;
}

void RepresentationCheck::compare(int x, int y, uint32_t sample, const reference::PixelRecord& rounded) {
    if (examines(x, y, sample))
        compareIn(rows_[static_cast<size_t>(y)], {.x = x, .y = y, .sample = sample}, rounded);
}

void RepresentationCheck::compareIn(Row& row, Doubt doubt, const reference::PixelRecord& rounded) const {
    const reference::Ray ray = rayOf(truth_, camera_, doubt);
    const reference::PixelRecord truth = truth_.trace(ray);
    const glm::dvec3 d = rounded.color - truth.color;
    doubt.pathHash = rounded.pathHash;
    doubt.difference = greatestMagnitude(d);
    row.differences.push_back(static_cast<float>(doubt.difference));
    row.squares += glm::dot(d, d);
    doubt.rounded = quantitiesOf(rounded, packed_.origin);
    if (truth.pathHash == rounded.pathHash) {
        const Box box(quantitiesOf(truth, packed_.origin), floorsOf(packed_, truth, ray));
        if (containsScene(box, doubt.rounded, 0)) return;
        doubt.decisions = truth.decisions;
        doubt.classes.push_back({truth.decisions, box, 1});
    }
    row.doubts.push_back(std::move(doubt));
}

RepresentationCheck::Moved RepresentationCheck::moved(uint64_t seed) const {
    const reference::rows::Camera camera = reference::disturbed(camera_, seed, 1);
    const auto model = std::make_shared<reference::Model>(reference::disturbed(*model_, seed, 1));
    reference::setEye(*model, camera.eye);  // it may lie on the other side of a glass surface
    return {reference::Tracer(model, request_, radianceBound_), camera};
}

// Traces all doubtful pixels in scenes with moved numbers, and removes those that these explain.
void RepresentationCheck::draw(uint64_t first, uint64_t last, std::vector<Doubt*>& open) const {
    for (uint64_t seed = first; seed <= last && !open.empty(); ++seed) {
        const Moved scene = moved(seed);
        parallelFor({.cancelled = request_.cancelled}, open.size(), [&](size_t i) {
            Doubt& doubt = *open[i];
            const reference::Ray ray = rayOf(scene.tracer, scene.camera, doubt);
            const reference::PixelRecord record = scene.tracer.trace(ray);
            if (record.pathHash != doubt.pathHash) return;
            const Box box(quantitiesOf(record, packed_.origin), floorsOf(packed_, record, ray));
            auto at = std::find_if(doubt.classes.begin(), doubt.classes.end(),
                                   [&](const Class& c) { return c.decisions == record.decisions; });
            if (at == doubt.classes.end()) at = doubt.classes.insert(at, {record.decisions, box, 0});
            at->box.include(box);
            ++at->members;
            if (!containsScene(at->box, doubt.rounded, at->members > 1 ? kMoveGain : 0)) return;
            const bool alike = doubt.decisions == record.decisions;
            doubt.state = alike ? Doubt::State::Predicted : Doubt::State::Explained;
        });
        std::erase_if(open, [](const Doubt* doubt) { return doubt->state != Doubt::State::Open; });
    }
}

// After many bounces a few moved scenes do not reproduce the path. The truth must then give each ray's hit
// and light for roundings of that ray.
void RepresentationCheck::certifyDoubt(Doubt& doubt) const {
    const Trail trail = trailOf(rounded_.trace(rayOf(rounded_, roundedCamera_, doubt), {}, true));
    const SeenPath seen{&trail, doubt.rounded, 1, false};
    const Certificate certificate =
        certify(truth_, packed_, rayOf(truth_, camera_, doubt), seen, kMostStepsOfPixel);
    if (certificate.verdict == Certificate::Verdict::Holds) doubt.state = Doubt::State::Explained;
}

// True if one of kStandIns moved scenes, in place of the packed one, leaves half as many pixels in doubt.
bool RepresentationCheck::mayLeave(size_t doubts) const {
    for (uint64_t seed = kLastScenes + 1; seed <= kLastScenes + kStandIns; ++seed) {
        const Moved scene = moved(seed);
        std::vector<Row> rows(rows_.size());
        parallelFor({.cancelled = request_.cancelled}, rows.size(), [&](size_t row) {
            for (uint32_t sample = 0; sample < request_.samples.round; ++sample)
                for (int x = 0, y = static_cast<int>(row); x < request_.width; ++x) {
                    const Doubt doubt{.x = x, .y = y, .sample = sample};
                    if (!examines(x, y, sample)) continue;
                    compareIn(rows[row], doubt, scene.tracer.trace(rayOf(scene.tracer, scene.camera, doubt)));
                }
        });
        std::vector<Doubt*> open = doubtsOf(rows);
        draw(1, kMovedScenes, open);
        if (2 * open.size() >= doubts) return true;
    }
    return false;
}

// Leaves doubts open that nothing explains, or whose search would be too long.
void RepresentationCheck::search(std::vector<Doubt*> open, size_t examined) const {
    draw(1, kMovedScenes, open);
    const size_t few = kFewPixels + examined / kFewPixels;
    if (open.size() > few && !mayLeave(open.size())) return;
    parallelFor({.cancelled = request_.cancelled}, open.size(), [&](size_t i) { certifyDoubt(*open[i]); });
    std::erase_if(open, [](const Doubt* doubt) { return doubt->state != Doubt::State::Open; });
    if (open.size() <= few) draw(kMovedScenes + 1, kLastScenes, open);
}

Representation RepresentationCheck::judge(size_t worstCount) {
    Representation result;
    std::vector<float> differences;
    double squares = 0;
    for (const Row& row : rows_) {
        differences.insert(differences.end(), row.differences.begin(), row.differences.end());
        squares += row.squares;
    }
    std::vector<Doubt*> doubts = doubtsOf(rows_);
    result.asked = differences.size();
    for (const float d : differences) result.greatest = std::max(result.greatest, static_cast<double>(d));
    result.rmse = std::sqrt(squares / (3 * static_cast<double>(std::max<uint64_t>(result.asked, 1))));
    result.p99 = reference::percentile99(std::move(differences));
    search(doubts, result.asked);
    std::erase_if(doubts, [](const Doubt* doubt) { return doubt->state == Doubt::State::Predicted; });
    const auto rank = [](const Doubt* doubt) {
        return std::tuple(doubt->state != Doubt::State::Open, -doubt->difference, doubt->y, doubt->x);
    };
    std::sort(doubts.begin(), doubts.end(),
              [&](const Doubt* a, const Doubt* b) { return rank(a) < rank(b); });
    for (const Doubt* doubt : doubts) {
        const bool explained = doubt->state == Doubt::State::Explained;
        ++(explained ? result.explained : result.unexplained);
        if (result.worst.size() == worstCount) continue;
        result.worst.push_back({doubt->x, doubt->y, doubt->sample, explained, doubt->difference,
                                truth_.trace(rayOf(truth_, camera_, *doubt)),
                                rounded_.trace(rayOf(rounded_, roundedCamera_, *doubt))});
    }
    return result;
}

}  // namespace glint::verify
