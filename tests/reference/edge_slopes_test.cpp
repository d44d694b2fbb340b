// How fast the error of an edge falls with the samples, by the dimensions that it lies across: film alone, or
// film and lens (docs/lab/accuracy.md).
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <random>

#include "pack/packed_scene.h"
#include "reference/sampling.h"
#include "shared/shading.h"

namespace glint::reference::edge_slopes_test {
namespace {

enum class Points { Sobol, Pairs, Random };

// A half space, sum of slope[i] x[i] < end.
struct Edge {
    std::array<double, 4> slope{};
    double end = 0;
};

// Across the first `dimensions`, through a random place of the unit cube.
Edge randomEdge(int dimensions, std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    Edge edge;
    for (int d = 0; d < dimensions; ++d) {
        do edge.slope[d] = normal(random);
        while (std::abs(edge.slope[d]) < 0.03);  // or the volume's digits cancel
        edge.end += edge.slope[d] * uniform(random);
    }
    return edge;
}

// Of the unit cube: sum over its corners c with c . slope < end of (-1)^|c| (end - c . slope)^d, over d! and
// the product of the slopes, which must be positive; x -> 1 - x makes them so.
double volume(const Edge& edge, int dimensions) {
    std::array<long double, 4> slope{};
    long double end = edge.end, divisor = 1;
    for (int d = 0; d < dimensions; ++d) {
        slope[d] = std::abs(edge.slope[d]);
        if (edge.slope[d] < 0) end += slope[d];
        divisor *= slope[d] * (d + 1);
    }
    long double sum = 0;
    for (unsigned corner = 0; corner < 1u << dimensions; ++corner) {
        long double left = end;
        for (int d = 0; d < dimensions; ++d)
            if (corner >> d & 1) left -= slope[d];
        if (left > 0) sum += (std::popcount(corner) % 2 == 0 ? 1 : -1) * std::pow(left, dimensions);
    }
    return static_cast<double>(sum / divisor);
}

std::array<double, 4> placeOf(Points points, const shared::Sample& row, uint32_t index, uint32_t pixel,
                              std::mt19937& random) {
    if (points == Points::Random) {
        std::uniform_real_distribution<double> uniform;
        return {uniform(random), uniform(random), uniform(random), uniform(random)};
    }
    const uint32_t lens = points == Points::Sobol ? shared::kPairLens : shared::kFirstPaddedPair;
    const auto a = samplePair(row, index, shared::kPairFilm, pixel, 0);
    const auto b = samplePair(row, index, lens, pixel, 0);
    const auto unit = [](uint32_t x) { return (x + 0.5) * 0x1p-32; };
    return {unit(a[0]), unit(a[1]), unit(b[0]), unit(b[1])};
}

// Of edges in so many pixels.
double errorOf(Points points, int dimensions, int count) {
    constexpr uint32_t kPixels = 4000;
    ImageSettings image;
    image.sampler = Sampler::LowDiscrepancy;
    image.samplesPerPixel = count;
    const PackedSamples samples = packSamples(image, true);
    std::mt19937 random(7);
    double squares = 0;
    for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        const Edge edge = randomEdge(dimensions, random);
        int inside = 0;
        for (uint32_t i = 0; i < samples.count(); ++i) {
            const auto place = placeOf(points, samples.rows[shared::kFirstSample + i], i, pixel, random);
            double at = 0;
            for (int d = 0; d < dimensions; ++d) at += edge.slope[d] * place[d];
            inside += at < edge.end ? 1 : 0;
        }
        const double error = static_cast<double>(inside) / count - volume(edge, dimensions);
        squares += error * error / kPixels;
    }
    return std::sqrt(squares);
}

// No points do better than the power -(d + 1) / 2d for half spaces in d dimensions (R. Alexander,
// Combinatorica 10, 1990), and those of the default sampler do as well. Pairs of dimensions that know nothing
// of each other are no better across both than random points.
TEST(EdgeSlopes, AreTheBestThatPointsCanHave) {
    constexpr int kFew = 16, kMany = 256;
    for (const Points points : {Points::Sobol, Points::Pairs, Points::Random}) {
        for (const int d : {2, 3, 4}) {
            const double few = errorOf(points, d, kFew), many = errorOf(points, d, kMany);
            const double slope = std::log(many / few) / std::log(double(kMany) / kFew);
            const bool even = points == Points::Sobol || (points == Points::Pairs && d == 2);
            const double expected = even ? -(d + 1) / (2.0 * d) : -0.5;
            std::printf("| %s | %d | %.4f | %.4f | %.3f | %.3f |\n",
                        points == Points::Sobol   ? "Sobol's four dimensions"
                        : points == Points::Pairs ? "shuffled pairs"
                                                  : "random",
                        d, few, many, slope, expected);
            // Deviations of a mean of 4,000 squares come to 0.01; pairs are a bit better than random.
            EXPECT_NEAR(slope, expected, 0.03) << d;
        }
    }
}

}  // namespace
}  // namespace glint::reference::edge_slopes_test
