// The figures of a comparison, against cases computed by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/image_diff.h"
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
    EXPECT_EQ(difference.worst, (std::vector<PixelDifference>{{0, 0, 0.5f}, {1, 0, 0.25f}}));
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
    EXPECT_EQ(compareImages(a, b, 0.0, 4).worst,
              (std::vector<PixelDifference>{{1, 1, 3}, {1, 0, 2}, {0, 1, 2}, {0, 0, 1}}));
    EXPECT_TRUE(compareImages(a, b, 0.0, 0).worst.empty());
}

TEST(CompareImages, PicturesThatDoNotFit) {
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { compareImages(Image(4, 3, 3), Image(5, 3, 3), 0.0); }),
              "the images differ in size: 4x3 and 5x3");
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { differenceImage(Image(4, 3, 3), Image(4, 2, 3)); }),
              "the images differ in size: 4x3 and 4x2");
    EXPECT_EQ(test::errorOf(ErrorKind::Failed, [] { compareImages(Image(1, 1, 2), Image(1, 1, 3), 0.0); }),
              "the images differ in channels: 2 and 3");
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

// SSIM against values of another program, and cases that follow by hand.

struct Pair {
    Image a, b;
};

Pair wavesOf(int width, int height, double change) {
    Pair pair{Image(width, height, 3), Image(width, height, 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double a = 0.5 + 0.45 * std::sin(0.7 * x + 0.3 * y + c);
                const double b = a + change * std::cos(1.3 * x) * std::sin(0.9 * y - c) + 0.1 * change;
                pair.a.at(x, y, c) = static_cast<float>(a);
                pair.b.at(x, y, c) = static_cast<float>(b);
            }
        }
    }
    return pair;
}

// The values of scikit-image 0.19.3 (Debian 12): structural_similarity(X, Y, gaussian_weights=True,
// sigma=1.5, use_sample_covariance=False, data_range=1) of the encoded pictures' luma. At 0.6 much is cut
// off.
TEST(StructuralSimilarity, IsThatOfScikitImage) {
    const struct {
        double change, ssim;
    } table[] = {{0, 1}, {0.02, 0.998713679500}, {0.1, 0.968213670519}, {0.6, 0.583539853361}};
    for (const auto& row : table) {
        const Pair pair = wavesOf(24, 20, row.change);
        EXPECT_NEAR(structuralSimilarity(pair.a, pair.b), row.ssim, 1e-9) << row.change;
        EXPECT_NEAR(structuralSimilarity(pair.b, pair.a), row.ssim, 1e-9) << row.change;
    }
}

// More rows of windows than are worked on at a time: 192, in three bands.
TEST(StructuralSimilarity, BandsAreOnePicture) {
    const Pair tall = wavesOf(12, 202, 0.1);
    const auto part = [&](const Image& whole, int y0, int y1) {
        Image image(whole.width, y1 - y0, 3);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < whole.width; ++x)
                for (int c = 0; c < 3; ++c) image.at(x, y - y0, c) = whole.at(x, y, c);
        return image;
    };
    // Windows 0 to 95 and 96 to 191.
    const double upper = structuralSimilarity(part(tall.a, 0, 106), part(tall.b, 0, 106));
    const double lower = structuralSimilarity(part(tall.a, 96, 202), part(tall.b, 96, 202));
    EXPECT_NEAR(structuralSimilarity(tall.a, tall.b), (upper + lower) / 2, 1e-12);
}

// Flat pictures have no structure: (2 x y + C1) / (x^2 + y^2 + C1) of their luma x and y.
TEST(StructuralSimilarity, OfFlatPicturesByHand) {
    const Image black(11, 11, 1, 0.0f), white(11, 11, 4, 1.0f), brighter(11, 11, 3, 7.0f);
    EXPECT_NEAR(structuralSimilarity(black, white), 1e-4 / (1 + 1e-4), 1e-12);
    EXPECT_NEAR(structuralSimilarity(brighter, white), 1, 1e-12) << "cut off at 1";
    Image hole = white;
    hole.at(5, 5, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_LT(structuralSimilarity(hole, white), 0.9);
    EXPECT_TRUE(std::isnan(structuralSimilarity(Image(10, 11, 3), Image(10, 11, 3))));
    EXPECT_THROW(structuralSimilarity(black, Image(12, 11, 3)), Error);
}

// The hash of a picture's bits.

Image ramp() {
    Image image(3, 2, 4);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.25f * static_cast<float>(i);
    return image;
}

// The value that XXH3's own tests state for no input at all.
TEST(PictureHash, IsXxh3) {
    EXPECT_EQ(pictureHash(Image(0, 0, 4)), "2d06800538d394c2");
}

TEST(PictureHash, ChangesWithAnyBitOfAColour) {
    const Image image = ramp();
    const std::string hash = pictureHash(image);
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(pictureHash(ramp()), hash);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (i % 4 == 3) continue;
        Image other = image;
        other.pixels[i] = std::nextafter(other.pixels[i], 1e9f);
        EXPECT_NE(pictureHash(other), hash) << i;
    }
    Image negativeZero = image;
    negativeZero.pixels[0] = -0.0f;
    EXPECT_NE(pictureHash(negativeZero), hash);
}

TEST(PictureHash, AlphaDoesNotCount) {
    Image other = ramp();
    Image three(3, 2, 3);
    for (size_t pixel = 0; pixel < 6; ++pixel) {
        for (size_t c = 0; c < 3; ++c) three.pixels[3 * pixel + c] = other.pixels[4 * pixel + c];
        other.pixels[4 * pixel + 3] = -1;
    }
    EXPECT_EQ(pictureHash(other), pictureHash(ramp()));
    EXPECT_EQ(pictureHash(three), pictureHash(ramp()));
}

TEST(PictureHash, OrderOfPixelsCounts) {
    Image turned = ramp();
    std::swap_ranges(turned.pixels.begin(), turned.pixels.begin() + 12, turned.pixels.begin() + 12);
    EXPECT_NE(pictureHash(turned), pictureHash(ramp()));
}

}  // namespace glint::image_diff_test
