// How often stopping by looks ends with more error than was asked for, by many trials.
#include "converge/looks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace glint::converge::looks_test {
namespace {

// Mean squares of one look: as two replicates of `count` samples show it, and as it is.
struct MeanSquares {
    std::vector<glm::dvec3> first, second;
    double realized = 0;
};

// Pixels whose errors are normal and fall by a power of the samples, but to no less than a floor. From look
// to look they keep a part of what they were, as means of samples that share a part do.
class Film {
  public:
    Film(size_t pixels, double power, double floor, uint32_t seed)
        : power_(power), floor_(floor), random_(seed), first_(pixels), second_(pixels) {
        for (size_t i = 0; i < pixels; ++i) first_[i] = normal_(random_), second_[i] = normal_(random_);
    }

    MeanSquares at(uint32_t count) {
        const double kept = last_ > 0 ? std::pow(last_ / count, power_) : 1,
                     other = std::sqrt(1 - kept * kept);
        last_ = count;
        // Of a replicate; of their mean it is less by the root of 2.
        const double size = std::sqrt(2.0) * std::max(std::pow(2.0 * count, -power_), floor_);
        MeanSquares all;
        double squares = 0;
        for (size_t i = 0; i < first_.size(); ++i) {
            first_[i] = kept * first_[i] + other * normal_(random_);
            second_[i] = kept * second_[i] + other * normal_(random_);
            all.first.emplace_back(size * first_[i]);
            all.second.emplace_back(size * second_[i]);
            squares += std::pow(size * (first_[i] + second_[i]) / 2, 2);
        }
        all.realized = std::sqrt(squares / static_cast<double>(first_.size()));
        return all;
    }

  private:
    double power_, floor_, last_ = 0;
    std::mt19937 random_;
    std::normal_distribution<double> normal_;
    std::vector<double> first_, second_;
};

struct Trials {
    int wrong = 0, ended = 0;
    double samples = 0;  // over those that one sequence would have taken, in the mean
};

// `floor`: of the error asked for, what no number of samples goes below.
Trials trialsOf(size_t pixels, double power, double floor, int count) {
    Trials trials;
    for (int i = 0; i < count; ++i) {
        // Targets at all places between two powers of 2.
        const double fewest = 40 * std::exp2((i % 16) / 16.0);
        Target target;
        target.error = std::pow(fewest, -power);
        Film film(pixels, power, floor * target.error, static_cast<uint32_t>(i));
        Looks looks(target);
        for (uint32_t samples = 1; samples < 4000; samples = looks.next()) {
            const MeanSquares seen = film.at(samples);
            const bool holds = looks.look(meanSquareOf(seen.first, seen.second), samples, target.error);
            // What is shown holds at every look, and is the target at the last one.
            trials.wrong += seen.realized > looks.bound() ? 1 : 0;
            if (!holds) continue;
            EXPECT_LE(looks.bound(), target.error);
            ++trials.ended;
            trials.samples += 2 * samples / fewest / count;
            break;
        }
    }
    return trials;
}

// 5 % may be wrong, by chance a few more: 4 standard deviations of the binomial.
void expectKept(size_t pixels, double power, double floor) {
    constexpr int kTrials = 800;
    constexpr double kTail = 0.05;
    const Trials trials = trialsOf(pixels, power, floor, kTrials);
    EXPECT_LE(trials.wrong, kTrials * kTail + 4 * std::sqrt(kTrials * kTail * (1 - kTail)))
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

}  // namespace
}  // namespace glint::converge::looks_test
