// Pictures whose errors are known at every look, for trials of when to stop.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "converge/looks.h"

namespace glint::converge {

// Mean squares of one look: as two replicates of `count` samples show it, and as it is.
struct MeanSquares {
    std::vector<glm::dvec3> first, second;
    double realized = 0;
};

// Pixels whose errors are normal and fall by a power of the samples, but to no less than a floor. From look
// to look they keep a part of what they were, as means of samples that share a part do.
class FallingFilm {
  public:
    FallingFilm(size_t pixels, double power, double floor, uint32_t seed)
        : power_(power), floor_(floor), random_(seed), first_(pixels), second_(pixels) {
        for (size_t i = 0; i < pixels; ++i) first_[i] = normal_(random_), second_[i] = normal_(random_);
    }

    MeanSquares at(uint32_t count) {
        const double kept = last_ > 0 ? std::pow(last_ / count, power_) : 1,
                     other = std::sqrt(1 - kept * kept);
        last_ = count;
        // The error of a replicate; that of their mean is less by the root of 2.
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
    int wrong = 0;  // that ended with more than was asked for, or showed a bound that did not hold
    int ended = 0;
    double samples = 0;  // over those that one sequence would have taken, in the mean
};

// This share of the trials may be wrong, by chance a few more: 4 standard deviations of the binomial.
inline constexpr double kTail = 0.05;
inline double mostWrong(int trials) {
    return trials * kTail + 4 * std::sqrt(trials * kTail * (1 - kTail));
}

// `floor`: of the error asked for, what no number of samples goes below.
inline Trials trialsOf(size_t pixels, double power, double floor, int count) {
    Trials trials;
    for (int i = 0; i < count; ++i) {
        // Targets at all places between two powers of 2.
        const double fewest = 40 * std::exp2((i % 16) / 16.0);
        const double error = std::pow(fewest, -power);
        FallingFilm film(pixels, power, floor * error, static_cast<uint32_t>(i));
        Looks looks(1 - kTail);
        bool wrong = false;
        for (uint32_t samples = 1; samples < 4000; samples = looks.next()) {
            const MeanSquares seen = film.at(samples);
            const bool holds = looks.look(meanSquareOf(seen.first, seen.second), samples, error);
            // The bound holds at every look, and is the target at the last one.
            wrong = wrong || seen.realized > looks.bound();
            if (!holds) continue;
            EXPECT_LE(looks.bound(), error);
            ++trials.ended;
            trials.samples += 2 * samples / fewest / count;
            break;
        }
        trials.wrong += wrong ? 1 : 0;
    }
    return trials;
}

}  // namespace glint::converge
