// The bias of an image's mean if its own samples decide when to stop, over a thousand seeds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "falling_film.h"
#include "known_film.h"

namespace glint::converge::slow_test {
// The table of docs/lab/error-targets.md: pixels, how errors fall, and how often a run ended with more than
// was asked for or showed a bound that did not hold.
TEST(ConvergeSlow, LooksAreSeldomWrong) {
    const auto row = [](size_t pixels, double power, double floor, int count) {
        const Trials trials = trialsOf(pixels, power, floor, count);
        std::printf("| %zu | %g | %s | %d | %.1f %% | %.2f |\n", pixels, power,
                    floor > 0 ? std::to_string(floor).substr(0, 4).c_str() : "none", count,
                    100.0 * trials.wrong / count, floor > 0 ? 0 : trials.samples);
        EXPECT_LE(trials.wrong, mostWrong(count));
    };
    for (const size_t pixels : {16u, 100u, 1000u}) {
        const int count = pixels < 1000 ? 10000 : 2000;
        for (const double power : {0.5, 0.7, 1.0}) row(pixels, power, 0, count);
        for (const double floor : {0.9, 0.97, 1.05}) row(pixels, 0.7, floor, count);
    }
}

// Samples that show less variance stop sooner. In pixels that are bright in few samples (1 in 30 % here),
// these are the darker ones. The bias is at most a fiftieth of the target, as the error itself stops no run.
TEST(ConvergeSlow, StoppingHardlyBiasesAPicture) {
    constexpr uint32_t kSeeds = 1000;
    constexpr double kTarget = 0.05;
    const Film film = edgeFilm();
    double sum = 0, squares = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
        const Result result = converge(drawOf(film), jobOf(kTarget, seed));
        EXPECT_TRUE(result.reached());
        double mean = 0;  // of this picture's pixels, which share its stopping
        int count = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; x += 8, ++count)
                mean += result.picture.color.pixels[result.picture.indexOf(x, y) * 4] - 0.3;
        sum += mean / count;
        squares += mean / count * mean / count;
    }
    const double drift = sum / kSeeds, deviation = std::sqrt((squares / kSeeds - drift * drift) / kSeeds);
    std::printf("drift over the error asked for: %.4f +- %.4f\n", drift / kTarget, deviation / kTarget);
    EXPECT_LE(std::abs(drift), 0.02 * kTarget + 4 * deviation);
    EXPECT_LE(deviation, 0.01 * kTarget) << "too few seeds for a verdict";
}

}  // namespace glint::converge::slow_test
