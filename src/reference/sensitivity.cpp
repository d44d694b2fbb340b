#include "reference/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "reference/numbers.h"
#include "reference/sampling.h"

namespace glint::reference {

namespace {

// The chance that a Poisson variable is at most `count`, by its terms; above a mean of a thousand by Wilson's
// and Hilferty's cube root ("The Distribution of Chi-Square", PNAS 17, 1931), good to 1e-3 of the tail there.
double chanceUpTo(uint64_t count, double mean) {
    if (mean <= 0) return 1;
    if (mean > 1000) {
        const double n = static_cast<double>(count) + 1;
        const double z = 3 * std::sqrt(n) * (1 - 1 / (9 * n) - std::cbrt(mean / n));
        return 0.5 * std::erfc(-z / std::sqrt(2.0));
    }
    double term = std::exp(-mean), sum = term;
    for (uint64_t i = 1; i <= count; ++i) {
        term *= mean / static_cast<double>(i);
        sum += term;
    }
    return sum;
}

double greatestChange(const PixelRecord& a, const PixelRecord& b) {
    const glm::dvec3 d = glm::abs(a.color - b.color);
    const double change = std::max({d.x, d.y, d.z});
    return std::isfinite(change) ? change : std::numeric_limits<double>::max();
}

// True if a compared value of a pixel changes: the path, or the decisions together with colour or hidden
// lights.
bool isOtherwise(const PixelRecord& still, const PixelRecord& moved) {
    if (still.pathHash != moved.pathHash) return true;
    if (still.decisions == moved.decisions) return false;
    if (still.shadowBits != moved.shadowBits) return true;
    const glm::dvec3 d = glm::abs(still.color - moved.color);
    return glm::any(glm::greaterThan(d, still.rounding));
}

// True if any ray leaves a surface.
bool leaves(const PixelRecord& record) {
    uint64_t rays = 0;
    for (const RayTally& tally : record.tally) rays += tally.rays;
    return rays > 1;
}

// Returns the greatest change by one unit. Changed decisions are counted for rays that also start as far from
// their surfaces as the device's rays: between curved mirrors this distance counts many times as much as the
// rounding of points. The wide move omits it, because at 32 times the distance a ray starts beyond thin
// objects.
double moveOne(const Tracer& tracer, const Ray& ray, uint64_t seed, int seeds, Sensitivity& counts) {
    const PixelRecord still = tracer.trace(ray);
    double change = 0;
    for (int i = 1; i <= seeds; ++i) {
        Jitter one{.seed = seed + static_cast<uint64_t>(i), .ulps = 1};
        PixelRecord moved = tracer.trace(ray, one);
        change = std::max(change, greatestChange(still, moved));
        one.clears = true;
        if (leaves(moved)) moved = tracer.trace(ray, one);
        counts.changed += isOtherwise(still, moved);
    }
    counts.changedWidely += isOtherwise(still, tracer.trace(ray, {seed, kWideUnits}));
    counts.open += isOpen(tracer, ray, still, {}, &change);
    return change;
}

}  // namespace

double greatestMean(uint64_t count) {
    double low = static_cast<double>(count), high = 2 * low + 20;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (chanceUpTo(count, middle) > 1 - kConfidence ? low : high) = middle;
    }
    return high;
}

uint64_t greatestCount(double mean) {
    uint64_t low = 0, high = static_cast<uint64_t>(2 * mean) + 40;
    while (low < high) {
        const uint64_t middle = (low + high) / 2;
        if (chanceUpTo(middle, mean) >= kConfidence)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

double percentile99(std::vector<float> values) {
    if (values.empty()) return 0;
    const double last = static_cast<double>(values.size() - 1);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * last + 1e-9);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

bool isOpen(const Tracer& tracer, const Ray& ray, const PixelRecord& still, Jitter move, double* change) {
    bool open = false;
    for (const double slips : {0.0, kMostSlips}) {
        move.slips = slips;
        const PixelRecord other = tracer.trace(ray, move);
        if (!isOtherwise(still, other)) continue;
        open = true;
        if (change) *change = std::max(*change, greatestChange(still, other));
    }
    return open;
}

glm::ivec2 placeInCell(size_t cell, int step) {
    uint64_t state = static_cast<uint64_t>(cell) * kUniformStride;
    const uint64_t word = randomWord(state), side = static_cast<uint64_t>(step);
    return {static_cast<int>(word % side), static_cast<int>((word >> 32) % side)};
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

Sensitivity sensitivityOf(const Tracer& tracer, const shared::Camera& camera, int width, int height,
                          const PackedSamples& samples, const Context& context, int seeds,
                          size_t mostPixels) {
    const double pixels = static_cast<double>(width) * height;
    const int step =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / static_cast<double>(mostPixels)))));
    const size_t columns = static_cast<size_t>((width + step - 1) / step);
    const size_t rows = static_cast<size_t>((height + step - 1) / step);
    std::vector<float> changes(columns * rows);
    std::vector<Sensitivity> counts(rows);
    parallelFor(context, rows, [&](size_t row) {
        for (size_t column = 0; column < columns; ++column) {
            const size_t index = row * columns + column;
            const glm::ivec2 inCell = placeInCell(index, step);
            const int x = std::min(static_cast<int>(column) * step + inCell.x, width - 1);
            const int y = std::min(static_cast<int>(row) * step + inCell.y, height - 1);
            const auto sample = static_cast<uint32_t>(index % samples.round);
            const Ray ray = pixelSample(tracer, camera, samples, sample, x, y).ray;
            const double change = moveOne(tracer, ray, 977u * index, seeds, counts[row]);
            changes[index] = static_cast<float>(std::min<double>(change, std::numeric_limits<float>::max()));
        }
    });
    Sensitivity result;
    result.tried = changes.size();
    result.moves = static_cast<uint64_t>(seeds);
    for (const Sensitivity& row : counts) {
        result.changed += row.changed;
        result.changedWidely += row.changedWidely;
        result.open += row.open;
    }
    result.kappa = percentile99(std::move(changes)) / kFloatUnit;
    return result;
}

double conditionNumber(const PackedScene& scene, const Request& request, int seeds) {
    return sensitivityOf(Tracer(scene, request), cameraOf(scene, request), request.width, request.height,
                         PackedSamples::fixed({{0.5, 0.5}}), {}, seeds)
        .kappa;
}

double roundingError(const PackedScene& scene, const Request& request, double unit) {
    return conditionNumber(scene, request, 1) * unit + kFloatUnit;
}

}  // namespace glint::reference
