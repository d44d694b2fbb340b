// Quantiles against printed tables, and bounds against what they promise, by many trials.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "converge/bounds.h"
#include "falling_film.h"

namespace glint::converge::bounds_test {

TEST(BoundsTest, QuantilesAreThoseOfTheTables) {
    EXPECT_NEAR(normalQuantile(0.025), 1.959964, 1e-6);
    EXPECT_NEAR(normalQuantile(0.5), 0, 1e-9);
    EXPECT_NEAR(normalQuantile(1e-6), 4.753424, 1e-5);
    // Abramowitz and Stegun 1964, table 26.9; the approximation is good to about 1 %.
    EXPECT_NEAR(fisherQuantile(0.05, 10, 10), 2.98, 0.02);
    EXPECT_NEAR(fisherQuantile(0.05, 30, 30), 1.84, 0.01);
    EXPECT_NEAR(fisherQuantile(0.01, 10, 10), 4.85, 0.06);
    EXPECT_NEAR(fisherQuantile(0.01, 120, 120), 1.53, 0.01);
    EXPECT_NEAR(fisherQuantile(0.05, 6, 6), 4.28, 0.05);
    EXPECT_TRUE(std::isinf(fisherQuantile(0.05, 1, 1)));
}

struct Trial {
    double realized = 0;
    MeanSquare estimate;
};

// Two replicates of pixels of mean 0 with a distribution of each kind, and the realised error of their mean.
template <class Distribution>
Trial trialOf(std::mt19937& random, size_t pixels, Distribution&& draw) {
    std::vector<glm::dvec3> a(pixels), b(pixels);
    double squares = 0;
    for (size_t i = 0; i < pixels; ++i) {
        a[i] = glm::dvec3(draw(i, random));
        b[i] = glm::dvec3(draw(i, random));
        const glm::dvec3 mean = (a[i] + b[i]) / 2.0;
        squares += glm::dot(mean, mean) / 3;
    }
    return {std::sqrt(squares / static_cast<double>(pixels)), meanSquareOf(a, b)};
}

template <class Distribution>
void expectCovered(const char* name, size_t pixels, Distribution&& draw) {
    constexpr int kTrials = 2000;
    std::mt19937 random(11);
    int above = 0;
    for (int i = 0; i < kTrials; ++i) {
        const Trial trial = trialOf(random, pixels, draw);
        above += trial.realized > rootMeanSquareBound(trial.estimate, kTail) ? 1 : 0;
    }
    EXPECT_LE(above, mostWrong(kTrials)) << name;
}

TEST(BoundsTest, TheRealizedErrorIsBelowItsBound) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    for (const size_t pixels : {16u, 100u, 1000u}) {
        expectCovered("normal", pixels, [&](size_t, auto& r) { return normal(r); });
        expectCovered("one pixel in ten", pixels,
                      [&](size_t i, auto& r) { return i % 10 == 0 ? normal(r) : 0.01 * normal(r); });
        // An edge: a sample is on one side or the other.
        expectCovered("coins", pixels, [&](size_t, auto& r) { return uniform(r) < 0.3 ? 0.7 : -0.3; });
    }
}

// Claims of one error that was given before: false in no more than a twentieth of the trials, however the
// picture's true error lies to it, and in nearly as many where that is worst.
TEST(BoundsTest, ClaimsAreFalseAsSeldomAsTheySay) {
    constexpr int kTrials = 2000;
    std::normal_distribution<double> normal;
    double most = 0;
    for (const double asked : {0.9, 0.95, 1.0, 1.05, 1.1, 1.15}) {  // the true error is 1
        std::mt19937 random(17);
        int wrong = 0;
        for (int i = 0; i < kTrials; ++i) {
            const Trial trial =
                trialOf(random, 100, [&](size_t, auto& r) { return std::sqrt(2.0) * normal(r); });
            wrong +=
                trial.realized > asked && rootMeanSquareBound(trial.estimate, tailOfClaim(kTail)) <= asked;
        }
        EXPECT_LE(wrong, mostWrong(kTrials)) << asked;
        most = std::max(most, static_cast<double>(wrong) / kTrials);
    }
    EXPECT_GT(most, kTail / 4) << "gives away too much";
}

// The bound falls towards the error itself as pixels become many: no room is given away.
TEST(BoundsTest, TheBoundIsTight) {
    std::normal_distribution<double> normal;
    std::mt19937 random(3);
    const Trial trial = trialOf(random, 100000, [&](size_t, auto& r) { return normal(r); });
    EXPECT_NEAR(rootMeanSquareBound(trial.estimate, 0.05) / trial.realized, 1, 0.05);
}

TEST(BoundsTest, PixelsThatAgreeHaveNoError) {
    const std::vector<glm::dvec3> same(10, glm::dvec3(0.3));
    EXPECT_EQ(rootMeanSquareBound(meanSquareOf(same, same), 0.05), 0);
}

// A detail of that size is missed by all samples with that probability.
TEST(BoundsTest, WhatNoSampleHitsIsSmall) {
    for (const double samples : {2.0, 16.0, 1000.0}) {
        const double covers = unseenBound(100, samples, 0.05) * 10;  // of one pixel among 100
        EXPECT_NEAR(std::pow(1 - covers, samples), 0.05, 1e-12) << samples;
    }
    EXPECT_NEAR(unseenBound(1, 1e9, 0.05), -std::log(0.05) / 1e9, 1e-15) << "no cancellation";
    EXPECT_EQ(unseenBound(0, 2, 0.05), 0);
}

TEST(BoundsTest, WhatIsNotFiniteIsLeftOut) {
    std::vector<glm::dvec3> a(100, glm::dvec3(1)), b(100, glm::dvec3(0));
    a[7].y = NAN;
    EXPECT_DOUBLE_EQ(meanSquareOf(a, b).value, 0.25);
}

// How often stopping by looks ends with more error than was asked for, by many trials.

void expectKept(size_t pixels, double power, double floor) {
    constexpr int kTrials = 800;
    const Trials trials = trialsOf(pixels, power, floor, kTrials);
    EXPECT_LE(trials.wrong, mostWrong(kTrials))
        << pixels << " pixels, power " << power << ", floor " << floor;
    // With few pixels a claim has few degrees of freedom, and may come late.
    EXPECT_TRUE(floor > 0 || pixels < 100 || trials.ended == kTrials);
}

TEST(LooksTest, TheErrorAskedForIsKept) {
    for (const size_t pixels : {16u, 100u})
        for (const double power : {0.5, 0.7, 1.0}) expectKept(pixels, power, 0);
}

// The worst that can be: an error that stays for ever where a false claim is likeliest.
TEST(LooksTest, AnErrorThatFallsNoFurtherIsNotClaimedAway) {
    for (const size_t pixels : {16u, 100u})
        for (const double floor : {0.9, 0.97, 1.05}) expectKept(pixels, 0.7, floor);
}

// And little is given away: in an image of many pixels, of which two replicates of half the samples err by
// 2^0.2 more than one sequence, 1.22 times the samples are needed.
TEST(LooksTest, FewSamplesMoreThanTheFewestAreTaken) {
    const Trials trials = trialsOf(5000, 0.7, 0, 32);
    EXPECT_EQ(trials.ended, 32);
    EXPECT_LT(trials.samples, 1.35);
}

}  // namespace glint::converge::bounds_test
