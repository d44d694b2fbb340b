// Pictures to a given error, drawn by a tracer whose truth is known.
#include "converge/converge.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "converge/replicates.h"
#include "core/error.h"
#include "falling_film.h"
#include "known_film.h"
#include "support/support.h"

namespace glint::converge::converge_test {
double realizedOf(const Film& film, const Picture& picture) {
    double squares = 0;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const double d = picture.color.pixels[picture.indexOf(x, y) * 4] - film.truth(x, y);
            squares += d * d;
        }
    }
    return std::sqrt(squares / (kSide * kSide));
}

TEST(ConvergeTest, TheErrorIsWhatWasAskedFor) {
    const Film film = edgeFilm();
    constexpr int kSeeds = 60;
    int above = 0;
    double ratios = 0, drift = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
        const Result result = converge(drawOf(film), jobOf(0.02, seed));
        ASSERT_TRUE(result.reached());
        EXPECT_LE(result.budget.total(), 0.02);
        const double realized = realizedOf(film, result.picture);
        above += realized > 0.02 ? 1 : 0;
        ratios += realized / 0.02 / kSeeds;
        for (int y = 0; y < kSide; ++y)
            drift += (result.picture.color.pixels[result.picture.indexOf(8, y) * 4] - 0.3) / kSeeds / kSide;
    }
    EXPECT_LE(above, 7);     // 3 expected; P(more than 7 of 60) is below 1 %
    EXPECT_GE(ratios, 0.7);  // and not far more samples than that took
    EXPECT_NEAR(drift, 0, 4 * 0.02 * std::sqrt(8.0) / std::sqrt(kSeeds * kSide));  // stopping does not bias
}

// Batches do not report: each would begin at 0.
TEST(ConvergeTest, ProgressRisesFromRoundToRound) {
    Job job = jobOf(0.02);
    std::vector<double> told;
    job.request.progress = [&](double done) { told.push_back(done); };
    const Film film = edgeFilm();
    const Draw batch = [&](const Request& request) {
        EXPECT_FALSE(request.progress);
        return drawn(film, request);
    };
    const Result result = converge(batch, job);
    EXPECT_EQ(told.size(), result.rounds);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GT(told.front(), 0);
    EXPECT_LE(told.back(), 0.99);
}

// Three tenths of each lit pixel are 1, all else is 0.
Film litFilm(bool (*isLit)(int x, int y)) {
    return {[=](int x, int y) { return isLit(x, y) ? 0.3 : 0.0; },
            [=](int x, int y, double random) { return isLit(x, y) && random < 0.3 ? 1.0 : 0.0; }};
}

// Renders with many seeds: few images end with more error than was asked for. Calls `check` for each.
void expectSeldomWrong(const Film& film, double error, uint32_t maxSamples,
                       const std::function<void(const Result&)>& check) {
    constexpr int kSeeds = 200;
    int wrong = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
        Job job = jobOf(error, seed);
        job.target.maxSamples = maxSamples;
        const Result result = converge(drawOf(film), job);
        wrong += result.reached() && realizedOf(film, result.picture) > error ? 1 : 0;
        check(result);
    }
    EXPECT_LE(wrong, mostWrong(kSeeds));
}

// Samples that all miss the one lit pixel agree, and so do those that all hit it. Either would end 58 % of
// the images after two samples, with twice the error asked for or more.
TEST(ConvergeTest, SamplesThatAgreeMayHaveMissedSomething) {
    expectSeldomWrong(
        litFilm([](int x, int y) { return x == 13 && y == 17; }), 0.003, 64, [](const Result& result) {
            EXPECT_GE(result.budget.sampling, unseenBound(kSide * kSide, result.samplesPerPixel, 0.0501));
        });
}

// Four pixels have all of the error. Their bound is wide, so the image takes more samples; it still holds.
TEST(ConvergeTest, TheBoundHoldsIfFewPixelsHaveAllOfTheError) {
    const Film film = litFilm([](int x, int y) { return (x == 13 || x == 14) && (y == 17 || y == 18); });
    int reached = 0;
    expectSeldomWrong(film, 0.01, 256, [&](const Result& result) {
        reached += result.reached() ? 1 : 0;
        for (const uint32_t n : result.picture.samples) EXPECT_LE(n, 256u);
    });
    EXPECT_GT(reached, 0);
}

TEST(ConvergeTest, TheSameSeedDrawsTheSamePicture) {
    const Film film = edgeFilm();
    const Result a = converge(drawOf(film), jobOf(0.05, 3)), b = converge(drawOf(film), jobOf(0.05, 3));
    EXPECT_EQ(a.picture.color.pixels, b.picture.color.pixels);
    EXPECT_EQ(a.samplesPerPixel, b.samplesPerPixel);
    EXPECT_EQ(a.picture.samples, std::vector<uint32_t>(kSide * kSide, a.samplesPerPixel));
    EXPECT_NE(a.picture.color.pixels, converge(drawOf(film), jobOf(0.05, 4)).picture.color.pixels);
}

TEST(ConvergeTest, LimitsEndItWithTheBestPicture) {
    const Film film = edgeFilm();
    Job job = jobOf(1e-4);
    job.target.maxSamples = 64;
    const Result few = converge(drawOf(film), job);
    EXPECT_EQ(few.stop, Stop::Samples);
    EXPECT_EQ(few.samplesPerPixel, 64u);
    EXPECT_TRUE(few.picture.complete);
    EXPECT_LE(realizedOf(film, few.picture), few.budget.total());
    job.target.maxSamples = 65536;
    job.target.maxSeconds = 0.05;
    const Draw slow = [&](const Request& request) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return drawn(film, request);
    };
    EXPECT_EQ(converge(slow, job).stop, Stop::Seconds);
}

TEST(ConvergeTest, AnInterruptedRoundIsNotCounted) {
    const Film film = edgeFilm();
    int calls = 0;
    const Draw breaking = [&](const Request& request) {
        Picture picture = drawn(film, request);
        if (++calls == 4) picture.complete = false;
        return picture;
    };
    const Result result = converge(breaking, jobOf(1e-3));
    EXPECT_EQ(result.stop, Stop::Interrupted);
    EXPECT_EQ(result.rounds, 1u);
    EXPECT_TRUE(result.picture.complete);
    calls = 3;
    EXPECT_FALSE(converge(breaking, jobOf(1e-3)).picture.complete);
}

std::string refusalOf(const Draw& draw, const Job& job) {
    return glint::test::errorOf(ErrorKind::Argument, [&] { converge(draw, job); });
}

TEST(ConvergeTest, WhatNoSampleMendsIsRefusedWithAdvice) {
    const Film film = edgeFilm();
    // Each further reflection loses half of the light.
    const Draw mirrors = [&](const Request& request) {
        Picture picture = drawn(film, request);
        const double bound = std::ldexp(1.0, -static_cast<int>(request.limits.depth.value_or(2)));
        for (size_t i = 0; i < picture.done.size(); ++i) picture.losses.depth.add(1, bound);
        return picture;
    };
    Job job = jobOf(0.01);
    job.request.limits.depth = 2;
    const std::string deeper = refusalOf(mirrors, job);
    EXPECT_HAS(deeper, "beyond maxDepth may add 0.25; --max-depth 11 would do; --within-depth");
    job.request.limits.depth = 11;
    EXPECT_TRUE(converge(mirrors, job).reached());

    job = jobOf(0.01);
    job.rounding = 0.02;
    const std::string rounding = refusalOf(drawOf(film), job);
    EXPECT_HAS(rounding, "rounding alone may take 0.02 on this device; --backend cpu computes in double");
    // Advice that would not help is not given.
    job.target.error = 1e-300;
    EXPECT_HAS(refusalOf(drawOf(film), job), "0.02 on this device, and 6e-08 in double precision");
    job.inDouble = true;
    EXPECT_LACKS(refusalOf(drawOf(film), job), "--backend");
}

// Each round estimates the light beyond the depth from its own samples, and may exceed the first estimate.
TEST(ConvergeTest, WhatSamplesDoNotMendEndsItWhenItGrows) {
    const Film film = edgeFilm();
    int calls = 0;
    const Draw growing = [&](const Request& request) {
        Picture picture = drawn(film, request);
        const double bound = ++calls <= 2 ? 0.001 : 0.1;
        for (size_t i = 0; i < picture.done.size(); ++i) picture.losses.depth.add(1, bound);
        return picture;
    };
    const Result result = converge(growing, jobOf(0.01));
    EXPECT_EQ(result.stop, Stop::Fixed);
    EXPECT_TRUE(result.picture.complete);
}

TEST(ConvergeTest, PiecesOfASequenceAreTheSequence) {
    for (const Filter filter : {Filter::Box, Filter::Mitchell}) {
        ImageSettings image;
        image.filter = filter;
        image.sampler = Sampler::LowDiscrepancy;
        image.samplesPerPixel = 8;
        image.adaptive = AdaptiveSampling{};
        image.adaptive->maxSamples = 16;
        const PackedSamples whole = packSamples(image, Camera{});
        SampleSequence pieces(image);
        for (uint32_t piece = 0; piece < 2; ++piece) {
            const PackedSamples part = pieces.next(8);
            ASSERT_EQ(part.count(), 8u);
            for (uint32_t i = 0; i < 8; ++i) {
                const shared::Sample& a = part.rows[shared::kFirstSample + i];
                const shared::Sample& b = whole.rows[shared::kFirstSample + 8 * piece + i];
                EXPECT_TRUE(a.x == b.x && a.y == b.y && a.weight == b.weight && a.key == b.key);
            }
        }
        image.sampler = Sampler::Grid;
        EXPECT_THROW(SampleSequence{image}, std::invalid_argument);
    }
}

}  // namespace glint::converge::converge_test
