#include "converge/spots.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "converge/bounds.h"

namespace glint::converge {

namespace {

// Degrees of freedom below which spots are looked for, and which the other pixels are to have.
constexpr double kFew = 12, kEnough = 32;
// No more pixels than these are taken for the cause of it, and regions than a device draws one by one with
// profit; they may hold this share of the picture.
constexpr size_t kMostPixels = 64, kMostRegions = 8;
constexpr size_t kShare = 16;
// What a spot's error is to come to: a part of the others', or of the target where that is more.
constexpr double kPartOfOthers = 0.4, kPartOfTarget = 0.2;
constexpr double kPower =
    1.5;  // of the samples, by which a mean square falls as a rule (docs/lab/accuracy.md)
constexpr uint32_t kMostTimes = 64;

size_t areaOf(const Region& r) {
    return static_cast<size_t>(r.width()) * static_cast<size_t>(r.height());
}

Region unionOf(const Region& a, const Region& b) {
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

bool meet(const Region& a, const Region& b) {
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

// Regions that overlap become one, and so do those that are hardly larger together.
void merge(std::vector<Region>& regions) {
    for (bool merged = true; merged;) {
        merged = false;
        for (size_t i = 0; i < regions.size() && !merged; ++i) {
            for (size_t k = i + 1; k < regions.size() && !merged; ++k) {
                const Region both = unionOf(regions[i], regions[k]);
                if (!meet(regions[i], regions[k]) &&
                    2 * areaOf(both) > 3 * (areaOf(regions[i]) + areaOf(regions[k])))
                    continue;
                regions[i] = both;
                regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(k));
                merged = true;
            }
        }
    }
}

// A pixel and its neighbours, which see the same thing.
Region around(const Region& whole, size_t pixel) {
    const auto width = static_cast<size_t>(whole.width());
    const int x = whole.x0 + static_cast<int>(pixel % width), y = whole.y0 + static_cast<int>(pixel / width);
    return {std::max(x - 1, whole.x0), std::max(y - 1, whole.y0), std::min(x + 2, whole.x1),
            std::min(y + 2, whole.y1)};
}

// The squares without those of the spots there are, and their sum.
struct Others {
    std::vector<double> squares;
    double inSpots = 0;
};

Others othersOf(const SpotFacts& facts) {
    Others others{{facts.squares.begin(), facts.squares.end()}, 0};
    for (double& square : others.squares)
        if (!std::isfinite(square)) square = 0;
    for (const Region& r : facts.now.regions) {
        for (int y = r.y0; y < r.y1; ++y) {
            for (int x = r.x0; x < r.x1; ++x) {
                double& square = others.squares[static_cast<size_t>(y - facts.whole.y0) *
                                                    static_cast<size_t>(facts.whole.width()) +
                                                static_cast<size_t>(x - facts.whole.x0)];
                others.inSpots += square;
                square = 0;
            }
        }
    }
    return others;
}

// The pixels with the greatest squares, without which the others tell enough or matter little; `left`: what
// the others come to. Empty if there would be too many.
std::vector<size_t> heaviest(const std::vector<double>& squares, double matters, double& left) {
    const size_t most = std::min(kMostPixels + 1, squares.size());
    std::vector<size_t> order(squares.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(),
                      [&](size_t a, size_t b) { return squares[a] > squares[b]; });
    double second = 0;
    left = 0;
    for (const double s : squares) left += s, second += s * s;
    std::vector<size_t> taken;
    for (size_t i = 0; i < most; ++i) {
        const double s = squares[order[i]];
        if (left <= matters || 2 * left * left - 2 * second >= kEnough * second) return taken;
        taken.push_back(order[i]);
        left = std::max(left - s, 0.0);
        second = std::max(second - s * s, 0.0);
    }
    return {};
}

}  // namespace

std::optional<SpotPlan> spotsFor(const SpotFacts& facts) {
    MeanSquareSum sum;
    for (const double s : facts.squares) sum.add(s, 2);
    const MeanSquare all = sum.result();
    if (!(all.value > 0) || all.freedom >= kFew || !(facts.allowed > 0)) return std::nullopt;
    const Others others = othersOf(facts);
    const double target = facts.allowed * facts.allowed * static_cast<double>(all.pixels);
    double left = 0;
    const std::vector<size_t> pixels = heaviest(others.squares, kPartOfTarget / 10 * target, left);
    SpotPlan plan = facts.now;
    for (const size_t pixel : pixels) plan.regions.push_back(around(facts.whole, pixel));
    merge(plan.regions);
    size_t area = 0;
    for (const Region& r : plan.regions) area += areaOf(r);
    if (plan.regions.empty() || plan.regions.size() > kMostRegions || kShare * area > facts.squares.size())
        return std::nullopt;

    // Beside enough of others, two replicates tell enough of them and err least. Alone they must tell it all.
    const bool alone = left < kPartOfTarget * target;
    if (alone) plan.replicates = kMostSpotReplicates;
    // Of spots that there are, `inSpots` is what they come to already.
    const SpotPlan& now = facts.now;
    double heavy =
        others.inSpots * (now.regions.empty() ? 1 : now.replicates / 2.0 * std::pow(now.times, kPower));
    for (const size_t pixel : pixels) heavy += others.squares[pixel];
    const double wanted = std::max(kPartOfOthers * left, kPartOfTarget * target);
    const double times = std::pow(heavy / (plan.replicates / 2.0 * wanted), 1 / kPower);
    // Spots take no more of the work than the rest of the picture does.
    const double worth = 2 * static_cast<double>(facts.squares.size()) / static_cast<double>(area);
    const double most = std::min({std::min(worth, facts.mostSamples) / plan.replicates, double{kMostTimes}});
    if (most < 1) return std::nullopt;
    while (plan.times < times && 2 * plan.times <= most) plan.times *= 2;
    const bool same = plan.times == now.times && plan.replicates == now.replicates;
    if (!now.regions.empty() && pixels.empty() && same) return std::nullopt;
    return plan;
}

}  // namespace glint::converge
