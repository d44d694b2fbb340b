#include "verify/stiffness.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "reference/sampling.h"
#include "verify/ceiling.h"

namespace glint::verify {

namespace {

double greatestChange(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = glm::abs(a - b);
    const double change = std::max({d.x, d.y, d.z});
    return std::isfinite(change) ? change : std::numeric_limits<double>::max();
}

}  // namespace

bool isOtherwise(const reference::PixelRecord& still, const reference::PixelRecord& moved) {
    if (still.pathHash != moved.pathHash) return true;
    if (still.decisions == moved.decisions) return false;
    const glm::dvec3 d = glm::abs(still.color - moved.color);
    return glm::any(glm::greaterThan(d, still.rounding));
}

bool isOpen(const reference::Tracer& tracer, const reference::Ray& ray, const reference::PixelRecord& still,
            reference::Jitter move, double* change) {
    bool open = false;
    for (const double slips : {0.0, reference::kMostSlips}) {
        move.slips = slips;
        const reference::PixelRecord other = tracer.trace(ray, move);
        if (!isOtherwise(still, other)) continue;
        open = true;
        if (change) *change = std::max(*change, greatestChange(still.color, other.color));
    }
    return open;
}

double percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    const double last = static_cast<double>(values.size() - 1);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(share, 1.0) * last + 1e-9);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double percentile99(std::vector<float> values) {
    return percentile(std::move(values), 0.99);
}

double conditionNumber(const reference::Tracer& tracer, const shared::Camera& camera, int width, int height,
                       int seeds) {
    return sensitivityOf(tracer, camera, width, height, PackedSamples::fixed({{0.5, 0.5}}), seeds).kappa;
}

namespace {

// Counts of a row of pixels.
struct RowCounts {
    uint64_t changed = 0, changedWidely = 0, open = 0;
};

// True if any ray leaves a surface.
bool leaves(const reference::PixelRecord& record) {
    uint64_t rays = 0;
    for (const reference::RayTally& tally : record.tally) rays += tally.rays;
    return rays > 1;
}

// The greatest change of one unit. What is decided otherwise is counted for rays that moreover begin as far
// from the surfaces that they leave as the device's do: between curved mirrors that is many times what the
// rounding of their points adds. Not so of the wide move: thirty times as far a ray is past thin things.
double moveOne(const reference::Tracer& tracer, const reference::Ray& ray, uint64_t seed, int seeds,
               RowCounts& counts) {
    const reference::PixelRecord still = tracer.trace(ray);
    double change = 0;
    for (int i = 1; i <= seeds; ++i) {
        const reference::Jitter one{.seed = seed + static_cast<uint64_t>(i), .ulps = 1};
        reference::PixelRecord moved = tracer.trace(ray, one);
        change = std::max(change, greatestChange(still.color, moved.color));
        if (leaves(moved)) moved = tracer.trace(ray, {.seed = one.seed, .ulps = 1, .clears = true});
        counts.changed += isOtherwise(still, moved);
    }
    counts.changedWidely += isOtherwise(still, tracer.trace(ray, {seed, kWideUnits}));
    counts.open += isOpen(tracer, ray, still, {}, &change);
    return change;
}

}  // namespace

// A pixel of a cell of `step` x `step` at random: what hangs on rounding often lies along one row or column
// of the picture (a symmetric object's axis, a horizon), which a regular grid meets always or never.
// splitmix64 (Steele, Lea, Flood 2014).
glm::ivec2 placeInCell(size_t cell, int step) {
    uint64_t z = (static_cast<uint64_t>(cell) + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    const auto side = static_cast<uint64_t>(step);
    return {static_cast<int>(z % side), static_cast<int>((z >> 32) % side)};
}

double Sensitivity::explainedShare() const {
    if (tried == 0) return 0;
    const double byWidth = greatestMean(changedWidely) / kWideUnits;
    const double atOne = greatestMean(changed) / static_cast<double>(moves);
    const bool chaotic = changedByOne() > byWidth;
    const double inOnePlace = open == 0 ? 0 : greatestMean(open);
    const double moved = kShareOfPrediction * (chaotic ? atOne : byWidth);
    return std::min((moved + inOnePlace) / static_cast<double>(tried), 1.0);
}

Sensitivity sensitivityOf(const reference::Tracer& tracer, const shared::Camera& camera, int width,
                          int height, const PackedSamples& samples, int seeds, size_t mostPixels) {
    const double pixels = static_cast<double>(width) * height;
    const int step =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / static_cast<double>(mostPixels)))));
    const size_t columns = static_cast<size_t>((width + step - 1) / step);
    const size_t rows = static_cast<size_t>((height + step - 1) / step);
    std::vector<float> changes(columns * rows);
    std::vector<RowCounts> counts(rows);
    parallelFor(Context{}, rows, [&](size_t row) {
        for (size_t column = 0; column < columns; ++column) {
            const size_t index = row * columns + column;
            const glm::ivec2 inCell = placeInCell(index, step);
            const int x = std::min(static_cast<int>(column) * step + inCell.x, width - 1);
            const int y = std::min(static_cast<int>(row) * step + inCell.y, height - 1);
            const reference::FilmSample s =
                reference::filmSample(samples, static_cast<uint32_t>(index % samples.round),
                                      static_cast<uint32_t>(x), static_cast<uint32_t>(y));
            const reference::Ray ray = tracer.cameraRay(camera, x + s.offset.x, y + s.offset.y, s.lens);
            const double change = moveOne(tracer, ray, 977u * index, seeds, counts[row]);
            changes[index] = static_cast<float>(std::min<double>(change, std::numeric_limits<float>::max()));
        }
    });
    Sensitivity result;
    result.tried = changes.size();
    result.moves = static_cast<uint64_t>(seeds);
    for (const RowCounts& row : counts) {
        result.changed += row.changed;
        result.changedWidely += row.changedWidely;
        result.open += row.open;
    }
    // The count of pixels beyond the percentile scatters by sqrt(n 0.99 0.01): 3.1 times that up.
    const double n = static_cast<double>(changes.size());
    const double limit = 0.99 + 3.1 * std::sqrt(0.99 * 0.01 / std::max(n, 1.0));
    result.kappaLimit = percentile(changes, limit) / kFloatUnit;
    result.kappa = percentile(std::move(changes), 0.99) / kFloatUnit;
    return result;
}

double roundingError(const reference::Tracer& tracer, const shared::Camera& camera, int width, int height,
                     double unit) {
    return conditionNumber(tracer, camera, width, height, 1) * unit + kFloatUnit;
}

StiffnessClass classOf(double kappa) {
    if (kappa < 1e2) return StiffnessClass::NonStiff;
    return kappa <= 1e5 ? StiffnessClass::Stiff : StiffnessClass::BeyondFp32;
}

}  // namespace glint::verify
