// The figures of a comparison, against cases computed by hand.
#include "core/image_diff.h"

#include <cmath>
#include <limits>

#include "support/support.h"

namespace glint::image_diff_test {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kInfinityF = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image picture(int width, int height, int channels, std::vector<float> samples) {
    Image image(width, height, channels);
    image.pixels = std::move(samples);
    return image;
}

TEST(CompareImages, EqualPictures) {
    const Image image = picture(2, 1, 3, {0, 0.25f, 0.5f, 1, 2, 3});
    const ImageDifference difference = compareImages(image, image, 0.0);
    EXPECT_EQ(difference.rmse, 0);
    EXPECT_EQ(difference.psnr, kInfinity);
    EXPECT_EQ(difference.max, 0);
    EXPECT_EQ(difference.mean, 0);
    EXPECT_EQ(difference.pixels, 2u);
    EXPECT_EQ(difference.above, 0u);
    EXPECT_EQ(difference.notFinite, 0u);
    EXPECT_TRUE(difference.worst.empty());
}

TEST(CompareImages, FiguresByHand) {
    const Image a(2, 1, 3, 0.0f);
    const Image b = picture(2, 1, 3, {0.5f, 0, 0, -0.25f, 0.25f, 0});
    const ImageDifference difference = compareImages(a, b, 0.3);
    // squares 1/4 + 1/16 + 1/16 = 3/8 over 6 samples: 1/16
    EXPECT_DOUBLE_EQ(difference.rmse, 0.25);
    EXPECT_DOUBLE_EQ(difference.psnr, 20.0 * std::log10(4.0));
    EXPECT_DOUBLE_EQ(difference.relMse, 0.0625 / 0.01);  // A is black
    EXPECT_DOUBLE_EQ(compareImages(b, a, 0.3).relMse, (0.25 / 0.26 + 2 * 0.0625 / 0.0725) / 6);
    EXPECT_DOUBLE_EQ(difference.max, 0.5);
    EXPECT_DOUBLE_EQ(difference.mean, 0.5 / 6);  // b - a: 0.5 - 0.25 + 0.25
    EXPECT_EQ(difference.above, 1u);
    ASSERT_EQ(difference.worst.size(), 2u);
    EXPECT_EQ(difference.worst[0].x, 0);
    EXPECT_EQ(difference.worst[0].difference, 0.5f);
    EXPECT_EQ(difference.worst[1].x, 1);
    EXPECT_EQ(difference.worst[1].difference, 0.25f);
    EXPECT_DOUBLE_EQ(compareImages(b, a, 0.3).mean, -0.5 / 6);
}

TEST(CompareImages, ToleranceIsInclusive) {
    const Image a(1, 1, 1, 0.0f);
    const Image b(1, 1, 1, 0.25f);
    EXPECT_EQ(compareImages(a, b, 0.25).above, 0u);
    EXPECT_EQ(compareImages(a, b, 0.2499).above, 1u);
}

TEST(CompareImages, ErrorsBeyondFloatPrecisionAreKept) {
    // One ulp at 1e6 is 0.0625; float sums would lose it among ten million samples.
    Image a(1000, 1000, 1, 1.0e6f);
    Image b = a;
    b.at(999, 999, 0) += 0.0625f;
    const ImageDifference difference = compareImages(a, b, 0.0);
    EXPECT_DOUBLE_EQ(difference.rmse, 0.0625 / 1000);
    EXPECT_DOUBLE_EQ(difference.mean, 0.0625 / 1e6);
    EXPECT_EQ(difference.above, 1u);
}

TEST(CompareImages, NotFiniteInOnePicture) {
    const Image a = picture(3, 1, 1, {kNan, 0, 1});
    const Image b = picture(3, 1, 1, {0, kInfinityF, 1.5f});
    const ImageDifference difference = compareImages(a, b, 1.0);
    EXPECT_EQ(difference.notFinite, 2u);
    EXPECT_EQ(difference.above, 2u);
    EXPECT_EQ(difference.max, kInfinity);
    EXPECT_DOUBLE_EQ(difference.rmse, 0.5);  // of the one pixel that is finite in both
    EXPECT_DOUBLE_EQ(difference.mean, 0.5);
    EXPECT_EQ(difference.worst[0].difference, kInfinityF);
}

TEST(CompareImages, NotFiniteInTheSameWayIsEqual) {
    const Image a = picture(3, 1, 1, {kNan, kInfinityF, -kInfinityF});
    const ImageDifference same = compareImages(a, a, 0.0);
    EXPECT_EQ(same.above, 0u);
    EXPECT_EQ(same.notFinite, 0u);
    EXPECT_EQ(same.max, 0);
    EXPECT_TRUE(same.worst.empty());
    const Image b = picture(3, 1, 1, {kInfinityF, -kInfinityF, kNan});
    const ImageDifference other = compareImages(a, b, 0.0);
    EXPECT_EQ(other.above, 3u);
    EXPECT_EQ(other.notFinite, 0u);
    EXPECT_EQ(other.max, kInfinity);
}

TEST(CompareImages, GreyAgainstColor) {
    const Image grey(1, 1, 1, 0.5f);
    const Image color = picture(1, 1, 3, {0.5f, 1.0f, 0.25f});
    const ImageDifference difference = compareImages(grey, color, 0.0);
    EXPECT_DOUBLE_EQ(difference.mean, (0.5 - 0.25) / 3);
    EXPECT_DOUBLE_EQ(difference.rmse, std::sqrt((0.25 + 0.0625) / 3));
    EXPECT_DOUBLE_EQ(compareImages(color, grey, 0.0).mean, -(0.5 - 0.25) / 3);
}

TEST(CompareImages, AlphaIsNotCompared) {
    const Image a = picture(1, 1, 4, {0.1f, 0.2f, 0.3f, 1.0f});
    const Image b = picture(1, 1, 4, {0.1f, 0.2f, 0.3f, 0.0f});
    EXPECT_EQ(compareImages(a, b, 0.0).max, 0);
    EXPECT_EQ(compareImages(a, picture(1, 1, 3, {0.1f, 0.2f, 0.3f}), 0.0).max, 0);
}

TEST(CompareImages, WorstPixelsAreOrderedByDifferenceThenRowThenColumn) {
    const Image a(3, 2, 1, 0.0f);
    const Image b = picture(3, 2, 1, {1, 2, 0, 2, 3, 1});
    const ImageDifference difference = compareImages(a, b, 0.0, 4);
    ASSERT_EQ(difference.worst.size(), 4u);
    const int expected[4][3] = {{1, 1, 3}, {1, 0, 2}, {0, 1, 2}, {0, 0, 1}};  // x, y, difference
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(difference.worst[i].x, expected[i][0]) << i;
        EXPECT_EQ(difference.worst[i].y, expected[i][1]) << i;
        EXPECT_EQ(difference.worst[i].difference, static_cast<float>(expected[i][2])) << i;
    }
    EXPECT_TRUE(compareImages(a, b, 0.0, 0).worst.empty());
}

TEST(CompareImages, PicturesThatDoNotFit) {
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { compareImages(Image(4, 3, 3), Image(5, 3, 3), 0.0); }),
              "the pictures differ in size: 4x3 and 5x3");
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { differenceImage(Image(4, 3, 3), Image(4, 2, 3)); }),
              "the pictures differ in size: 4x3 and 4x2");
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { compareImages(Image(1, 1, 2), Image(1, 1, 3), 0.0); }),
              "the pictures differ in channels: 2 and 3");
}

TEST(DifferenceImage, IsTheScaledMagnitude) {
    const Image a = picture(2, 1, 4, {0, 0, 0, 1, 1, 1, 1, 1});
    const Image b = picture(2, 1, 3, {0.5f, 0, 0.25f, 1, 0.5f, 2});
    const Image difference = differenceImage(a, b, 4.0f);
    EXPECT_EQ(difference.channels, 3);
    EXPECT_EQ(difference.pixels, (std::vector<float>{2, 0, 1, 0, 2, 4}));
}

TEST(DifferenceImage, GreyPicturesGiveGreyInThreeChannels) {
    const Image difference = differenceImage(Image(1, 1, 1, 0.25f), Image(1, 1, 1, 1.0f));
    EXPECT_EQ(difference.pixels, (std::vector<float>{0.75f, 0.75f, 0.75f}));
}

TEST(DifferenceImage, MarksWhatIsNotFiniteInOneOnly) {
    const Image difference = differenceImage(picture(2, 1, 1, {kNan, kNan}), picture(2, 1, 1, {0.0f, kNan}));
    EXPECT_EQ(difference.pixels, (std::vector<float>{kInfinityF, kInfinityF, kInfinityF, 0, 0, 0}));
}

}  // namespace glint::image_diff_test
