// How often stopping by looks ends with more error than was asked for, by many trials.
#include <gtest/gtest.h>

#include "falling_film.h"

namespace glint::converge::looks_test {
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

// And little is given away: in a picture of many pixels, of which two replicates of half the samples err by
// 2^0.2 more than one sequence, 1.22 times the samples are needed.
TEST(LooksTest, FewSamplesMoreThanTheFewestAreTaken) {
    const Trials trials = trialsOf(5000, 0.7, 0, 32);
    EXPECT_EQ(trials.ended, 32);
    EXPECT_LT(trials.samples, 1.35);
}

}  // namespace glint::converge::looks_test
