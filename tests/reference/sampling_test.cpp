// Sample points, filters, the disc map and the lens against their papers' formulas.
#include "reference/sampling.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/integer.hpp>
#include <numbers>
#include <set>

#include "core/device_layout.h"
#include "pack/pack_samples.h"
#include "pack/packed_scene.h"
#include "reference/tracer.h"

namespace glint::reference::sampling_test {
ImageSettings settingsOf(Sampler sampler, Filter filter, double radius, int spp) {
    return {.samplesPerPixel = spp, .sampler = sampler, .filter = filter, .filterRadius = radius, .seed = 7};
}

Camera lensCamera() {
    Camera camera;
    camera.lensRadius = 1;
    return camera;
}

// pcg4d as printed by Jarzynski and Olano (JCGT 9(3), 2020), statement by statement.
std::array<uint32_t, 4> paperPcg4d(uint32_t x, uint32_t y, uint32_t z, uint32_t w) {
    x = x * 1664525u + 1013904223u;
    y = y * 1664525u + 1013904223u;
    z = z * 1664525u + 1013904223u;
    w = w * 1664525u + 1013904223u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    return {x, y, z, w};
}

// nested_uniform_scramble of Burley (JCGT 9(4), 2020), with N. Vegdahl's constants.
uint32_t paperScramble(uint32_t x, uint32_t seed) {
    x = glm::bitfieldReverse(x);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return glm::bitfieldReverse(x);
}

// The same, with the high bits of each word upon its low ones, which the paper's own words are bad in.
std::array<uint32_t, 4> evenPcg4d(uint32_t x, uint32_t y, uint32_t z, uint32_t w) {
    auto words = paperPcg4d(x, y, z, w);
    for (uint32_t& word : words) word ^= word >> 16;
    return words;
}

// Points of film and lens, scrambled as in Burley's listing.
TEST(Sampling, ScrambledPairsAreThePapers) {
    const PackedSamples samples =
        packSamples(settingsOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, 64), lensCamera());
    for (uint32_t index = 0; index < 64; ++index) {
        const shared::Sample& row = samples.rows[shared::kFirstSample + index];
        for (uint32_t x = 0; x < 60; x += 3) {
            const uint32_t y = 100 - x;
            const auto seeds = evenPcg4d(x, y, row.key, row.seed);
            const std::array<uint32_t, 2> film = {paperScramble(row.x, seeds[0]),
                                                  paperScramble(row.y, seeds[1])};
            const std::array<uint32_t, 2> lens = {paperScramble(row.lensX, seeds[2]),
                                                  paperScramble(row.lensY, seeds[3])};
            EXPECT_EQ(samplePair(row, shared::kPairFilm, x, y), film) << index;
            EXPECT_EQ(samplePair(row, shared::kPairLens, x, y), lens) << index;
        }
    }
}

// One cell as wide as the pixel: the place is the hash, cut to the 22 bits that the filter's table uses.
TEST(Sampling, JitterIsThePapersHash) {
    const PackedSamples samples = packSamples(settingsOf(Sampler::Jittered, Filter::Box, 0.5, 1), Camera{});
    for (uint32_t y = 0; y < 40; ++y)
        for (uint32_t x = 0; x < 40; ++x) {
            const auto random = paperPcg4d(x, y, 0, samples.rows[shared::kFirstSample].seed);
            // The cell is 2^32 - 1 wide, so the place is within one unit below the hash.
            const FilmSample s = filmSample(samples, 0, x, y);
            EXPECT_NEAR(s.offset.x, random[0] * 0x1p-32, 0x1p-18 + 0x1p-22);
            EXPECT_NEAR(s.offset.y, random[1] * 0x1p-32, 0x1p-18 + 0x1p-22);
        }
}

// S. Joe, F. Y. Kuo's web page, first points of their four-dimensional example.
TEST(Sampling, SobolsFirstPoints) {
    constexpr uint32_t half = 0x80000000u, quarter = 0x40000000u, three = 0xc0000000u;
    EXPECT_EQ(sobolPoint(0), (FixedPoint{0, 0, 0, 0}));
    EXPECT_EQ(sobolPoint(1), (FixedPoint{half, half, half, half}));
    EXPECT_EQ(sobolPoint(3), (FixedPoint{three, quarter, quarter, quarter}));
    EXPECT_EQ(sobolPoint(2), (FixedPoint{quarter, three, three, three}));
}

// Scrambled or not, 2^m points have one in each elementary interval of the film: 2^a columns, 2^(m-a) rows.
TEST(Sampling, LowDiscrepancyStratifies) {
    constexpr int m = 6;
    const PackedSamples samples =
        packSamples(settingsOf(Sampler::LowDiscrepancy, Filter::Box, 0.5, 1 << m), Camera{});
    for (uint32_t pixel = 0; pixel < 50; ++pixel)
        for (int a = 0; a <= m; ++a) {
            std::set<std::pair<int, int>> cells;
            for (uint32_t i = 0; i < 1u << m; ++i) {
                const glm::dvec2 p = filmSample(samples, i, pixel, 3 * pixel).offset;
                cells.insert(
                    {static_cast<int>(std::ldexp(p.x, a)), static_cast<int>(std::ldexp(p.y, m - a))});
            }
            EXPECT_EQ(cells.size(), 1u << m) << pixel << ' ' << a;
        }
}

TEST(Sampling, JitterStratifies) {
    const PackedSamples samples = packSamples(settingsOf(Sampler::Jittered, Filter::Box, 0.5, 25), Camera{});
    for (uint32_t pixel = 0; pixel < 200; ++pixel) {
        std::set<std::pair<int, int>> cells;
        for (uint32_t i = 0; i < 25; ++i) {
            const glm::dvec2 p = filmSample(samples, i, pixel, 9).offset;
            cells.insert({static_cast<int>(p.x * 5 + 1e-5), static_cast<int>(p.y * 5 + 1e-5)});
        }
        EXPECT_EQ(cells.size(), 25u) << pixel;
    }
}

// Cells of any number of samples have equal areas, to the rounding of 2^-32 on each side.
TEST(Sampling, CellsFillTheSquare) {
    for (const uint32_t count : {1u, 2u, 3u, 7u, 12u, 13u, 101u}) {
        const auto cells = stratifiedCells(count, 1);
        ASSERT_EQ(cells.size(), count);
        for (const FixedCell& c : cells)
            EXPECT_NEAR(std::ldexp(double(c.width[0]) * double(c.width[1]), -64), 1.0 / count, 0x1p-30);
    }
}

// Places of one sample, film and lens, in a square of pixels; mean 0 and variance 1 if they are uniform.
constexpr int kSide = 64;
// Standard deviations of a mean of products of such numbers.
constexpr double kSigma = 1.0 / kSide;

std::vector<glm::dvec4> placesOf(Sampler sampler, uint32_t seed, uint32_t index) {
    ImageSettings image = settingsOf(sampler, Filter::Box, 0.5, 4);
    image.seed = seed;
    const PackedSamples samples = packSamples(image, lensCamera());
    const shared::Sample& row = samples.rows[shared::kFirstSample + index];
    std::vector<glm::dvec4> places;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const auto film = samplePair(row, shared::kPairFilm, i % kSide, i / kSide);
        const auto lens = samplePair(row, shared::kPairLens, i % kSide, i / kSide);
        const glm::dvec4 place(film[0], film[1], lens[0], lens[1]);
        places.push_back((place * 0x1p-32 - 0.5) * std::sqrt(12.0));
    }
    return places;
}

// Seeds that differ in one bit, whichever it is, scatter the same sample independently of each other.
TEST(Sampling, SeedsAreIndependent) {
    for (uint32_t bit = 0; bit < 32; ++bit) {
        const auto one = placesOf(Sampler::LowDiscrepancy, 7, 1);
        const auto other = placesOf(Sampler::LowDiscrepancy, 7 ^ (1u << bit), 1);
        glm::dvec4 products(0);
        for (size_t i = 0; i < one.size(); ++i) products += one[i] * other[i] / double(one.size());
        for (int d = 0; d < 4; ++d) EXPECT_NEAR(products[d], 0, 4 * kSigma) << bit << ' ' << d;
    }
}

// Error targets require pixels that are independent of each other, and uniform scrambled places.
TEST(Sampling, PixelsAreIndependent) {
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const auto places = placesOf(Sampler::LowDiscrepancy, seed, 3);
        glm::dvec4 means(0), right(0), below(0);
        for (size_t i = 0; i < places.size(); ++i) {
            means += places[i] / double(places.size());
            if (i % kSide + 1 < kSide) right += places[i] * places[i + 1] / double(places.size());
            if (i + kSide < places.size()) below += places[i] * places[i + kSide] / double(places.size());
        }
        for (int d = 0; d < 4; ++d)
            for (const double mean : {means[d], right[d], below[d]})
                EXPECT_NEAR(mean, 0, 4 * kSigma) << seed << ' ' << d;
    }
}

// The mean of x^2 over the samples, weighted, is the filter's second moment: box r^2/3, tent r^2/6;
// Mitchell's is (B-dependent) r^2/4 * 2 * integral of x^2 k(x), here by Simpson's rule. 64 x 64 grid points:
// a midpoint rule, good to 1e-3 r^2.
TEST(Sampling, FiltersHaveTheirMoments) {
    for (const Filter filter : {Filter::Box, Filter::Tent, Filter::Gaussian, Filter::Mitchell}) {
        const double r = 1.7;
        double mass = 0, second = 0;
        constexpr int n = 6000;
        for (int i = 0; i <= n; ++i) {
            const double x = r * (2.0 * i / n - 1), w = (i == 0 || i == n ? 1 : i % 2 ? 4 : 2);
            mass += w * filterValue(filter, x, r);
            second += w * x * x * filterValue(filter, x, r);
        }
        const PackedSamples samples = packSamples(settingsOf(Sampler::Grid, filter, r, 4096), lensCamera());
        double weights = 0, moment = 0, mean = 0;
        for (uint32_t i = 0; i < samples.count(); ++i) {
            const FilmSample s = filmSample(samples, i, 0, 0);
            weights += s.weight;
            mean += s.weight * (s.offset.x - 0.5);
            moment += s.weight * (s.offset.x - 0.5) * (s.offset.x - 0.5);
        }
        EXPECT_NEAR(weights / 4096, 1, 1e-5);
        EXPECT_NEAR(mean / 4096, 0, 2e-3 * r);
        EXPECT_NEAR(moment / 4096, second / mass, 2e-3 * r * r) << static_cast<int>(filter);
    }
}

TEST(Sampling, MitchellWeighsWholeRounds) {
    for (const int spp : {4, 5, 16, 100}) {
        ImageSettings image = settingsOf(Sampler::Jittered, Filter::Mitchell, 2, spp);
        image.adaptive = AdaptiveSampling{3 * spp + 1, 0.1};
        const PackedSamples samples = packSamples(image, Camera{});
        ASSERT_EQ(samples.count(), 3u * spp);
        for (int round = 0; round < 3; ++round) {
            double sum = 0, least = 0;
            for (int i = 0; i < spp; ++i) {
                const double w = filmSample(samples, round * spp + i, 3, 4).weight;
                sum += w;
                least = std::min(least, w);
            }
            EXPECT_NEAR(sum, spp, 1e-5 * spp);
            EXPECT_LT(least, 0);
        }
    }
}

// Equal areas: rings and sectors of the disc get their share of a fine grid; the grid's edge effects are
// below 1 / side.
TEST(Sampling, DiscIsUniform) {
    constexpr int side = 512;
    std::array<int, 8> sectors{};
    std::array<int, 4> rings{};
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::dvec2 p = concentricDisc((x + 0.5) / side, (y + 0.5) / side);
            ASSERT_LE(glm::length(p), 1.0);
            ++rings[static_cast<size_t>(4 * glm::dot(p, p))];
            ++sectors[static_cast<size_t>((std::atan2(p.y, p.x) / std::numbers::pi + 1) * 4) % 8];
        }
    for (const int n : rings) EXPECT_NEAR(n * 4.0 / (side * side), 1, 4.0 * 4 / side);
    for (const int n : sectors) EXPECT_NEAR(n * 8.0 / (side * side), 1, 8.0 / side);
}

// All rays of a film point meet in the plane of focus, oblique camera or not, within the fp32 of the packed
// camera: 2^-24 of its numbers, twice for the sum, over the focus distance.
TEST(Sampling, RaysMeetInTheFocus) {
    for (const bool oblique : {false, true}) {
        Camera camera;
        camera.eye = {1, 2, 5};
        camera.target = {0, 0.5, -1};
        camera.lensRadius = 0.3;
        camera.focusDistance = 4;
        if (oblique) camera.planeNormal = {0, 0.3, 1};
        const shared::Camera packed = packCamera(camera, 64, 48, glm::dvec3(0));
        const PackedScene empty;
        const Tracer tracer(empty);
        const glm::dvec3 view = glm::normalize(camera.target - camera.eye);
        const glm::dvec3 normal = oblique ? glm::normalize(*camera.planeNormal) : -view;
        const glm::dvec3 onPlane = camera.eye + 4.0 * view;
        const auto meets = [&](const Ray& ray) {
            return ray.origin +
                   ray.direction * (glm::dot(onPlane - ray.origin, normal) / glm::dot(ray.direction, normal));
        };
        for (const double x : {0.0, 20.5, 63.9}) {
            const Ray middle = tracer.cameraRay(packed, x, 7);
            const glm::dvec3 focus = meets(middle);
            for (int i = 0; i < 12; ++i) {
                const glm::dvec2 lens(std::cos(i), std::sin(i));
                const Ray ray = tracer.cameraRay(packed, x, 7, lens);
                EXPECT_NEAR(glm::length(ray.origin - middle.origin), 0.3, 1e-6);
                EXPECT_NEAR(glm::dot(ray.origin - middle.origin, normal), 0, 1e-6);
                EXPECT_LT(glm::length(meets(ray) - focus), 4 * 4 * 0x1p-22);
            }
        }
    }
}

TEST(Sampling, NeedsMore) {
    const std::vector<glm::dvec3> even(4, glm::dvec3(0.5));
    EXPECT_FALSE(needsMore(even, 1e-6));
    // 0 and 1: mean 0.5, spread sqrt(1/2), standard error 0.5 = the mean.
    const std::vector<glm::dvec3> edge = {glm::dvec3(0), glm::dvec3(1)};
    EXPECT_TRUE(needsMore(edge, 0.999));
    EXPECT_FALSE(needsMore(edge, 1.001));
    // In the dark, of 0.125: 0 and 0.02 have a standard error of 0.01 = 0.08 x 0.125.
    const std::vector<glm::dvec3> dark = {glm::dvec3(0), glm::dvec3(0, 0.02, 0)};
    EXPECT_TRUE(needsMore(dark, 0.079));
    EXPECT_FALSE(needsMore(dark, 0.081));
}

}  // namespace glint::reference::sampling_test
