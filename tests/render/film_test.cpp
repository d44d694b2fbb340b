// The sum of a pixel's samples, by itself: how far from their mean a picture may be.
#include "verify/film.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::verify {
namespace {

// Four samples, each of a hit that one light shines on: eight additions, so 20 units of 2^-24.
TEST(FilmTest, AMeanErrsByItsAdditionsAlone) {
    const PackedSamples samples = PackedSamples::fixed(std::vector<glm::dvec2>(4, {0.5, 0.5}));
    ASSERT_EQ(samples.round, 4u);
    Film film(samples, 1, 1, 1);
    Picture sample;
    sample.color = Image(1, 1, 4);
    sample.data.resize(1);
    for (uint32_t i = 0; i < 4; ++i) {
        for (int c = 0; c < 4; ++c) sample.color.at(0, 0, c) = 0.25f * static_cast<float>(i + 1);
        film.add(i, sample);
    }
    Picture whole = sample;
    whole.samplesPerPixel = 4;
    const auto differing = [&](double error) {
        for (int c = 0; c < 4; ++c) whole.color.at(0, 0, c) = static_cast<float>(0.625 * (1 + error));
        return film.differing(whole).size();
    };
    EXPECT_EQ(differing(0), 0u);
    for (const double sign : {-1.0, 1.0}) {
        EXPECT_EQ(differing(sign * 0x1p-20), 0u);
        EXPECT_EQ(differing(sign * 0x1p-19), 1u);
    }
    whole.samplesPerPixel = 3;
    EXPECT_EQ(differing(0), 1u);
}

// A thousandth of the least normal number, or what a device makes of that: light through thick dark glass.
TEST(FilmTest, SubnormalMeansErrByMore) {
    const PackedSamples samples = PackedSamples::fixed(std::vector<glm::dvec2>(5, {0.5, 0.5}));
    Film film(samples, 1, 1, 1);
    Picture sample;
    sample.color = Image(1, 1, 4);
    sample.data.resize(1);
    for (int c = 0; c < 4; ++c) sample.color.at(0, 0, c) = 0x1p-147f;
    for (uint32_t i = 0; i < 5; ++i) film.add(i, sample);
    Picture whole = sample;
    whole.samplesPerPixel = 5;
    for (const float seen : {0x1p-147f, 0x1.4p-147f, 0.0f}) {
        for (int c = 0; c < 4; ++c) whole.color.at(0, 0, c) = seen;
        EXPECT_EQ(film.differing(whole).size(), 0u) << seen;
    }
    for (int c = 0; c < 4; ++c) whole.color.at(0, 0, c) = 0x1p-119f;
    EXPECT_EQ(film.differing(whole).size(), 1u);
}

}  // namespace
}  // namespace glint::verify
