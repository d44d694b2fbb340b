// One picture out and in again, in every format.
#include <bit>
#include <cmath>
#include <limits>

#include "core/image_io.h"
#include "core/quantize.h"
#include "png_file.h"
#include "support/support.h"

namespace glint::round_trip_test {
using test::errorOf;
using test::readBytes;
using test::readPng;

class RoundTrip : public test::FolderTest {};

// Values from -0.5 to some 3, different in every sample, so that a transposed or flipped picture is noticed.
Image ramp(int width, int height, int channels) {
    Image image(width, height, channels);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = -0.5f + 3.5f * static_cast<float>(i) / static_cast<float>(image.pixels.size());
    }
    return image;
}

// All kinds of float: the formats for floats must keep every bit.
Image specials(int channels) {
    Image image = ramp(5, 3, channels);
    image.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
    image.at(1, 0, 0) = std::numeric_limits<float>::infinity();
    image.at(2, 0, 0) = -std::numeric_limits<float>::infinity();
    image.at(3, 0, 0) = std::numeric_limits<float>::denorm_min();
    image.at(4, 0, 0) = -0.0f;
    image.at(0, 1, 0) = std::numeric_limits<float>::max();
    return image;
}

void expectSameBits(const Image& actual, const Image& expected) {
    ASSERT_EQ(actual.width, expected.width);
    ASSERT_EQ(actual.height, expected.height);
    ASSERT_EQ(actual.channels, expected.channels);
    for (size_t i = 0; i < expected.pixels.size(); ++i) {
        ASSERT_EQ(std::bit_cast<uint32_t>(actual.pixels[i]), std::bit_cast<uint32_t>(expected.pixels[i]))
            << i;
    }
}

TEST_F(RoundTrip, PfmAndExrKeepEveryBit) {
    for (const char* name : {"a.pfm", "a.exr"}) {
        for (int channels : {1, 3}) {
            const Image image = specials(channels);
            writeImage(file(name), image);
            expectSameBits(readImage(file(name)), image);
        }
    }
    EXPECT_EQ(names(), (std::set<std::string>{"a.pfm", "a.exr"}));
}

TEST_F(RoundTrip, ExrKeepsAlpha) {
    const Image image = specials(4);
    writeImage(file("a.exr"), image);
    expectSameBits(readImage(file("a.exr")), image);
}

TEST_F(RoundTrip, ExrOfManySizes) {
    // The format cuts pictures into blocks of scanlines; sizes around them, flat (compresses) and not (does
    // not).
    for (int height : {1, 15, 16, 17, 33}) {
        for (int width : {1, 2, 31}) {
            const Image image = ramp(width, height, 3);
            writeImage(file("a.exr"), image);
            expectSameBits(readImage(file("a.exr")), image);
            const Image flat(width, height, 3, 0.25f);
            writeImage(file("b.exr"), flat);
            expectSameBits(readImage(file("b.exr")), flat);
        }
    }
}

TEST_F(RoundTrip, PfmBytesAsSpecified) {
    Image image(1, 2, 3);
    image.pixels = {1, 2, 3, 4, 5, 6};
    writeImage(file("a.pfm"), image);
    std::vector<uint8_t> expected;
    for (char c : std::string("PF\n1 2\n-1.0\n")) {
        expected.push_back(static_cast<uint8_t>(c));
    }
    for (float value : {4.0f, 5.0f, 6.0f, 1.0f, 2.0f, 3.0f}) {  // the bottom row comes first
        const auto bits = std::bit_cast<uint32_t>(value);
        for (int shift : {0, 8, 16, 24}) {
            expected.push_back(static_cast<uint8_t>(bits >> shift));
        }
    }
    EXPECT_EQ(readBytes(file("a.pfm")), expected);
}

TEST_F(RoundTrip, PfmAndHdrDropAlpha) {
    const Image image = ramp(4, 2, 4);
    writeImage(file("a.pfm"), image);
    writeImage(file("a.hdr"), image);
    for (const char* name : {"a.pfm", "a.hdr"}) {
        const Image back = readImage(file(name));
        ASSERT_EQ(back.channels, 3);
        const float expected = image.at(3, 1, 2);
        EXPECT_NEAR(back.at(3, 1, 2), expected, expected / 128) << name;
    }
}

TEST_F(RoundTrip, PngBytesAreTheSrgbCurve) {
    Image image(3, 2, 3);
    image.pixels = {0.5f, 0.18f, 0.001f, 0, 0, 0, 1, 1, 1, 7.0f, -1.0f, 0.5f, 0, 1, 0, 0.5f, 0.5f, 0.5f};
    writeImage(file("a.png"), image);
    const test::PngFile png = readPng(file("a.png"));
    EXPECT_EQ(png.width, 3);
    EXPECT_EQ(png.height, 2);
    EXPECT_EQ(png.bitDepth, 8);
    EXPECT_EQ(png.colorType, 2);
    // 255 (1.055 v^(1/2.4) - 0.055): 0.5 -> 187.52, 0.18 -> 117.6; 255 * 12.92 * 0.001 = 3.29
    const std::vector<uint8_t> expected = {188, 118, 3,   0, 0,   0, 255, 255, 255,
                                           255, 0,   188, 0, 255, 0, 188, 188, 188};
    EXPECT_EQ(png.samples, expected);
}

TEST_F(RoundTrip, PngColorTypesFollowTheChannels) {
    for (const auto& [channels, colorType] : {std::pair{1, 0}, {3, 2}, {4, 6}}) {
        writeImage(file("a.png"), ramp(7, 5, channels));
        EXPECT_EQ(readPng(file("a.png")).colorType, colorType);
        EXPECT_EQ(readImage(file("a.png")).channels, channels);
    }
}

TEST_F(RoundTrip, PngComesBackAsTheNearestOfItsLevels) {
    const Image image = ramp(64, 16, 4);
    writeImage(file("a.png"), image);
    const Image back = readImage(file("a.png"));
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const float clamped = std::clamp(image.pixels[i], 0.0f, 1.0f);
        // Half a level: on the alpha's straight line, on the steepest part of the decoding curve (slope 2.4 /
        // 1.055).
        const double bound = (i % 4 == 3 ? 1.0 : 2.4 / 1.055) * 0.5 / 255.0 + 1e-7;
        ASSERT_NEAR(back.pixels[i], clamped, bound) << i;
    }
    // A second round changes nothing any more.
    writeImage(file("b.png"), back);
    EXPECT_EQ(readBytes(file("b.png")), readBytes(file("a.png")));
}

TEST_F(RoundTrip, HdrStaysWithinItsPrecision) {
    // Widths below 8 are stored flat, others run-length encoded.
    for (int width : {1, 7, 8, 200}) {
        Image image = ramp(width, 9, 3);
        for (float& sample : image.pixels) {
            sample = std::abs(sample) * 1000.0f;
        }
        writeImage(file("a.hdr"), image);
        const Image back = readImage(file("a.hdr"));
        ASSERT_EQ(back.pixels.size(), image.pixels.size());
        for (size_t i = 0; i < image.pixels.size(); ++i) {
            const size_t pixel = i / 3 * 3;
            const float greatest =
                std::max({image.pixels[pixel], image.pixels[pixel + 1], image.pixels[pixel + 2]});
            // Eight bits of the greatest channel, cut off (Ward, "Real Pixels", Graphics Gems II, 1991).
            ASSERT_LE(back.pixels[i], image.pixels[i]);
            ASSERT_GE(back.pixels[i], image.pixels[i] - greatest / 128.0f);
        }
    }
}

TEST_F(RoundTrip, HdrKeepsWhatFitsEightBitsAndTamesTheRest) {
    Image image(4, 1, 3);
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    image.pixels = {1.0f, 0.5f, 0.25f, 192.0f, 64.0f, 3.0f, -1.0f, nan, 0.0f, infinity, 0.0f, 0.0f};
    writeImage(file("a.hdr"), image);
    const std::vector<float> expected = {
        1.0f, 0.5f, 0.25f, 192.0f, 64.0f, 3.0f, 0, 0, 0, std::ldexp(255.0f, 119), 0, 0};
    EXPECT_EQ(readImage(file("a.hdr")).pixels, expected);
}

TEST_F(RoundTrip, ExtensionsInAnyCase) {
    EXPECT_TRUE(isWritableImagePath("a/b.PNG"));
    EXPECT_TRUE(isWritableImagePath("b.Exr"));
    EXPECT_TRUE(isWritableImagePath("b.pfm"));
    EXPECT_TRUE(isWritableImagePath("b.hdr"));
    EXPECT_FALSE(isWritableImagePath("b.jpg"));
    EXPECT_FALSE(isWritableImagePath("png"));
    EXPECT_FALSE(isWritableImagePath(".png"));
    writeImage(file("a.PNG"), Image(1, 1, 3, 1.0f));
    EXPECT_EQ(readPng(file("a.PNG")).samples, (std::vector<uint8_t>{255, 255, 255}));
}

TEST_F(RoundTrip, UnknownExtensionsAreUsageErrors) {
    const Image image(1, 1, 3);
    const std::string bmp = file("a.bmp").string();
    EXPECT_EQ(errorOf(ErrorKind::Argument, [&] { writeImage(bmp, image); }),
              bmp + ": unknown picture format .bmp (use .png, .exr, .pfm or .hdr)");
    const std::string bare = file("a").string();
    EXPECT_EQ(errorOf(ErrorKind::Argument, [&] { writeImage(bare, image); }),
              bare + ": no file name extension (use .png, .exr, .pfm or .hdr)");
    EXPECT_TRUE(names().empty());
}

TEST_F(RoundTrip, PicturesThatCannotBeWritten) {
    const std::string path = file("a.png").string();
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeImage(path, Image(0, 4, 3)); }),
              path + ": a picture of 0x4 pixels with 3 channels cannot be written");
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeImage(path, Image(4, 4, 2)); }),
              path + ": a picture of 4x4 pixels with 2 channels cannot be written");
    EXPECT_TRUE(names().empty());
}

}  // namespace glint::round_trip_test
