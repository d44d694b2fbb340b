// The bytes of a PNG: sRGB curve, rounding, what becomes of values that have no place in it.
#include "core/quantize.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace glint::quantize_test {
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// IEC 61966-2-1:1999, equations 5.2.1.
double encodeSrgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

int expectedByte(float linear) {
    return static_cast<int>(std::lround(255.0 * encodeSrgb(static_cast<double>(linear))));
}

TEST(SrgbByte, ClampsAndMapsNanToZero) {
    EXPECT_EQ(srgbByte(-0.25f), 0);
    EXPECT_EQ(srgbByte(7.0f), 255);
    EXPECT_EQ(srgbByte(kInfinity), 255);
    EXPECT_EQ(srgbByte(-kInfinity), 0);
    EXPECT_EQ(srgbByte(kNan), 0);
    EXPECT_EQ(srgbByte(std::nextafter(1.0f, 0.0f)), 255);
    EXPECT_EQ(srgbByte(std::numeric_limits<float>::denorm_min()), 0);
}

TEST(SrgbByte, IsTheRoundedCurveForFloatsOfEveryMagnitude) {
    // The bit patterns of [0, 1] in steps of a prime: a million values from denormals to 1.
    for (uint32_t bits = 0; bits <= std::bit_cast<uint32_t>(1.0f); bits += 1009) {
        const float linear = std::bit_cast<float>(bits);
        ASSERT_EQ(srgbByte(linear), expectedByte(linear)) << linear;
    }
}

TEST(SrgbByte, RoundsToTheNearestAtEveryStep) {
    for (int k = 0; k < 255; ++k) {
        const auto step = static_cast<float>(linearFromSrgb((k + 0.5) / 255.0));
        for (float linear : {std::nextafter(step, 0.0f), step, std::nextafter(step, 1.0f)})
            ASSERT_EQ(srgbByte(linear), expectedByte(linear)) << linear;
        ASSERT_EQ(srgbByte(std::nextafter(step, 0.0f) - 1e-7f), k);
        ASSERT_EQ(srgbByte(std::nextafter(step, 1.0f) + 1e-7f), k + 1);
    }
}

TEST(LinearFromSrgb, InvertsTheCurve) {
    EXPECT_DOUBLE_EQ(linearFromSrgb(0.0), 0.0);
    EXPECT_DOUBLE_EQ(linearFromSrgb(1.0), 1.0);
    EXPECT_DOUBLE_EQ(linearFromSrgb(0.02), 0.02 / 12.92);
    for (int k = 0; k <= 255; ++k) {
        // The two published branches meet only to some 1e-8 (0.0031308 is 0.04045 / 12.92 rounded).
        EXPECT_NEAR(encodeSrgb(linearFromSrgb(k / 255.0)), k / 255.0, 1e-7);
        EXPECT_EQ(srgbByte(static_cast<float>(linearFromSrgb(k / 255.0))), k);
    }
}

TEST(LinearByte, RoundsAndClamps) {
    EXPECT_EQ(linearByte(0.5), 128);  // 127.5 rounds up
    EXPECT_EQ(linearByte(0.25), 64);  // 63.75
    EXPECT_EQ(linearByte(-1.0), 0);
    EXPECT_EQ(linearByte(2.0), 255);
    EXPECT_EQ(linearByte(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(QuantizeData, ScalesTheFiniteRangeOfAllChannelsTogether) {
    Image image(2, 1, 3);
    image.pixels = {-1.0f, 0.0f, 3.0f, kNan, kInfinity, -kInfinity};
    // (-1, 0, 3) -> (0, 1/4, 1) * 255
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{0, 64, 255, 0, 255, 0}));
}

TEST(QuantizeData, OneDistanceIsBlackAndInfinityWhite) {
    Image image(2, 1, 1, 7.0f);
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{0, 0}));
    image.pixels[1] = kInfinity;
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{0, 255}));
    image.pixels[0] = kInfinity;  // a view without any object
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{255, 255}));
    image.pixels = {-kInfinity, kNan};
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{0, 0}));
}

TEST(QuantizeData, RangeBeyondFloat) {
    Image image(3, 1, 1);
    image.pixels = {-std::numeric_limits<float>::max(), 0.0f, std::numeric_limits<float>::max()};
    EXPECT_EQ(quantizeData(image), (std::vector<uint8_t>{0, 128, 255}));
}

}  // namespace glint::quantize_test
