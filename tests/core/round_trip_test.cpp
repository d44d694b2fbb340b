// Writes and reads an image in every format, and an image with several layers.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "core/image_io.h"
#include "core/quantize.h"
#include "support/support.h"

namespace glint::round_trip_test {
using test::errorOf;
using test::readBytes;

class RoundTrip : public test::FolderTest {};

// A PNG's 8-bit samples, and its colour type: 0 grey, 2 RGB, 6 RGBA. Its header begins with both sizes, the
// bits of a sample and that type (W3C, PNG Second Edition, 11.2.2). quantize_test.cpp and
// picture_kinds_test.cpp show that decoding and encoding are inverse and right.
struct PngFile {
    int colorType = 0;
    std::vector<uint8_t> samples;
};
PngFile readPng(const std::filesystem::path& path) {
    const std::vector<uint8_t> bytes = readBytes(path);
    EXPECT_EQ(bytes.at(24), 8) << "bits of a sample";
    return {bytes.at(25), quantizeColor(readImage(path))};
}

Image imageOf(int width, int height, int channels, std::vector<float> samples) {
    Image image(width, height, channels);
    image.pixels = std::move(samples);
    return image;
}

// Values from -0.5 to some 3, different in every sample, so that a transposed or flipped picture is noticed.
Image ramp(int width, int height, int channels) {
    Image image(width, height, channels);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = -0.5f + 3.5f * static_cast<float>(i) / static_cast<float>(image.pixels.size());
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
    ASSERT_TRUE(test::sameBytes(actual.pixels, expected.pixels));
}

TEST_F(RoundTrip, PfmAndExrKeepEveryBit) {
    for (const auto& [name, channels] :
         {std::pair{"a.pfm", 1}, {"a.pfm", 3}, {"a.exr", 1}, {"a.exr", 3}, {"a.exr", 4}}) {
        const Image image = specials(channels);
        writeImage(file(name), image);
        expectSameBits(readImage(file(name)), image);
    }
    EXPECT_EQ(names(), (std::set<std::string>{"a.pfm", "a.exr"}));
}

TEST_F(RoundTrip, ExrOfManySizes) {
    // The format cuts pictures into blocks of scanlines; sizes around them, flat (compresses) and not.
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
    writeImage(file("a.pfm"), imageOf(1, 2, 3, {1, 2, 3, 4, 5, 6}));
    std::vector<uint8_t> expected;
    for (char c : std::string("PF\n1 2\n-1.0\n")) expected.push_back(static_cast<uint8_t>(c));
    for (float value : {4.0f, 5.0f, 6.0f, 1.0f, 2.0f, 3.0f}) {  // the bottom row comes first
        const auto bits = std::bit_cast<uint32_t>(value);
        for (int shift : {0, 8, 16, 24}) expected.push_back(static_cast<uint8_t>(bits >> shift));
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
    writeImage(file("a.png"), imageOf(3, 2, 3,
                                      {0.5f, 0.18f, 0.001f, 0, 0, 0, 1, 1, 1, 7.0f, -1.0f, 0.5f, 0, 1, 0,
                                       0.5f, 0.5f, 0.5f}));
    const PngFile png = readPng(file("a.png"));
    EXPECT_EQ(readImage(file("a.png")).width, 3);
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
        // Half a level of alpha, or where the decoding curve is steepest (slope 2.4 / 1.055).
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
        for (float& sample : image.pixels) sample = std::abs(sample) * 1000.0f;
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
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    writeImage(
        file("a.hdr"),
        imageOf(4, 1, 3, {1.0f, 0.5f, 0.25f, 192.0f, 64.0f, 3.0f, -1.0f, nan, 0.0f, infinity, 0.0f, 0.0f}));
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
              bmp + ": unknown image format .bmp (use .png, .exr, .pfm or .hdr)");
    const std::string bare = file("a").string();
    EXPECT_EQ(errorOf(ErrorKind::Argument, [&] { writeImage(bare, image); }),
              bare + ": no file name extension (use .png, .exr, .pfm or .hdr)");
    EXPECT_TRUE(names().empty());
}

// Several layers of one picture: channels of an EXR file, files of the other formats.

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Layers : public test::FolderTest {};

// A 2 x 1 picture with every number of channels a layer can have; sample c of pixel x is base + 10 c + x.
Layer layer(const std::string& name, int channels, float base) {
    Layer result{name, Image(2, 1, channels)};
    for (int x = 0; x < 2; ++x) {
        for (int c = 0; c < channels; ++c)
            result.image.at(x, 0, c) = base + 10.0f * static_cast<float>(c) + static_cast<float>(x);
    }
    return result;
}

struct ExrFile {
    std::vector<std::string> order;  // channels as they stand in the file
    std::map<std::string, std::vector<float>> planes;
    std::vector<Imf::PixelType> types;
};

ExrFile readExr(const std::filesystem::path& path) {
    ExrFile result;
    Imf::InputFile file(path.c_str());
    const auto& window = file.header().dataWindow();
    const auto width = static_cast<size_t>(window.max.x + 1), height = static_cast<size_t>(window.max.y + 1);
    Imf::FrameBuffer target;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        result.order.emplace_back(channel.name());
        result.types.push_back(channel.channel().type);
        std::vector<float>& plane = result.planes[channel.name()];
        plane.resize(width * height);
        target.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()),
                                                 sizeof(float), sizeof(float) * width));
    }
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);
    return result;
}

TEST_F(Layers, ExrChannelNames) {
    Layer depth = layer("depth", 1, 5);
    depth.image.at(1, 0, 0) = kInfinity;
    const std::vector<Layer> layers = {layer("color", 3, 0), layer("alpha", 1, 100), depth,
                                       layer("normal", 3, 200), layer("uv", 2, 300)};
    EXPECT_EQ(writeLayers(file("a.exr"), layers), std::vector<std::filesystem::path>{file("a.exr")});
    const ExrFile exr = readExr(file("a.exr"));
    const std::vector<std::string> order = {"A",        "B",        "G",        "R",    "depth.Y",
                                            "normal.X", "normal.Y", "normal.Z", "uv.U", "uv.V"};
    EXPECT_EQ(exr.order, order);
    EXPECT_EQ(exr.types, std::vector<Imf::PixelType>(order.size(), Imf::FLOAT));
    const std::map<std::string, std::vector<float>> planes = {{"R", {0, 1}},
                                                              {"G", {10, 11}},
                                                              {"B", {20, 21}},
                                                              {"A", {100, 101}},
                                                              {"depth.Y", {5, kInfinity}},
                                                              {"normal.X", {200, 201}},
                                                              {"normal.Y", {210, 211}},
                                                              {"normal.Z", {220, 221}},
                                                              {"uv.U", {300, 301}},
                                                              {"uv.V", {310, 311}}};
    EXPECT_EQ(exr.planes, planes);
}

TEST_F(Layers, AlphaLayerReplacesTheFourthChannel) {
    writeLayers(file("a.exr"), {layer("normal", 3, 200), layer("color", 4, 0), layer("alpha", 1, 100)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{0, 10, 20, 100, 1, 11, 21, 101}));
    Layer color{"color", Image(1, 1, 4, 1.0f)};
    writeLayers(file("a.png"), {color, {"alpha", Image(1, 1, 1, 0.5f)}});
    EXPECT_EQ(readPng(file("a.png")).samples, (std::vector<uint8_t>{255, 255, 255, 128}));
}

TEST_F(Layers, ExrWithOneLayerOfData) {
    writeLayers(file("a.exr"), {layer("normal", 3, 7)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{7, 17, 27, 8, 18, 28}));
    writeLayers(file("a.exr"), {layer("depth", 1, 7)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{7, 8}));
}

TEST_F(Layers, ExrWithoutColorCannotBeReadAsOnePicture) {
    const std::string path = file("a.exr").string();
    writeLayers(path, {layer("normal", 3, 7), layer("depth", 1, 7)});
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { readImage(path); }),
              path +
                  ": the EXR file has neither R, G, B nor Y, and more than one layer (channels depth.Y, "
                  "normal.X, normal.Y, normal.Z)");
}

TEST_F(Layers, PfmGetsAFileForEachLayer) {
    const std::vector<Layer> layers = {layer("color", 3, 0), layer("alpha", 1, 100), layer("uv", 2, 300)};
    const std::vector<std::filesystem::path> expected = {file("a.01.pfm"), file("a.01.alpha.pfm"),
                                                         file("a.01.uv.pfm")};
    EXPECT_EQ(writeLayers(file("a.01.pfm"), layers), expected);
    EXPECT_EQ(names(), (std::set<std::string>{"a.01.pfm", "a.01.alpha.pfm", "a.01.uv.pfm"}));
    EXPECT_EQ(readImage(file("a.01.pfm")).pixels, layers[0].image.pixels);
    EXPECT_EQ(readImage(file("a.01.alpha.pfm")).pixels, (std::vector<float>{100, 101}));
    EXPECT_EQ(readImage(file("a.01.uv.pfm")).pixels, (std::vector<float>{300, 310, 0, 301, 311, 0}));
}

TEST_F(Layers, PngPutsAlphaIntoThePicture) {
    const Layer color{"color", Image(2, 1, 3, 0.5f)};
    const Layer alpha{"alpha", imageOf(2, 1, 1, {0.25f, 1.0f})};
    EXPECT_EQ(writeLayers(file("a.png"), {alpha, color}), std::vector<std::filesystem::path>{file("a.png")});
    const PngFile png = readPng(file("a.png"));
    EXPECT_EQ(png.colorType, 6);
    // 0.25 * 255 = 63.75, without the sRGB curve
    EXPECT_EQ(png.samples, (std::vector<uint8_t>{188, 188, 188, 64, 188, 188, 188, 255}));
}

TEST_F(Layers, PngScalesData) {
    writeLayers(file("a.png"), {{"depth", imageOf(4, 1, 1, {10.0f, 20.0f, 50.0f, kInfinity})}});
    // (v - 10) / 40 * 255; infinity, a miss, is white
    EXPECT_EQ(readPng(file("a.depth.png")).samples, (std::vector<uint8_t>{0, 64, 255, 255}));
    EXPECT_EQ(readPng(file("a.depth.png")).colorType, 0);
    writeLayers(file("a.png"), {{"uv", imageOf(2, 1, 2, {1.0f, 2.0f, 3.0f, 5.0f})}});
    // (v - 1) / 4 * 255, then a third channel of 0
    EXPECT_EQ(readPng(file("a.uv.png")).samples, (std::vector<uint8_t>{0, 64, 0, 128, 255, 0}));
}

TEST_F(Layers, PngOfAlphaAloneIsNotScaled) {
    const Layer alpha{"alpha", imageOf(2, 1, 1, {0.25f, 0.5f})};
    EXPECT_EQ(writeLayers(file("a.png"), {alpha}), std::vector<std::filesystem::path>{file("a.alpha.png")});
    EXPECT_EQ(readPng(file("a.alpha.png")).samples, (std::vector<uint8_t>{64, 128}));
}

TEST_F(Layers, HdrOfTwoChannelsIsPadded) {
    writeLayers(file("a.hdr"), {{"uv", imageOf(1, 1, 2, {0.5f, 1.0f})}});
    EXPECT_EQ(readImage(file("a.uv.hdr")).pixels, (std::vector<float>{0.5f, 1.0f, 0.0f}));
}

TEST_F(Layers, LayersThatDoNotFit) {
    const std::pair<std::vector<Layer>, const char*> cases[] = {
        {{}, "there is no layer to write"},
        {{layer("color", 3, 0), {"depth", Image(3, 1, 1)}},
         "the layers \"color\" and \"depth\" differ in size"},
        {{layer("alpha", 3, 0)}, "the layer \"alpha\" must have one channel"},
        {{layer("normal", 4, 0)}, "a layer \"normal\" of 2x1 pixels with 4 channels cannot be written"},
        {{{"color", Image(0, 4, 3)}}, "a layer \"color\" of 0x4 pixels with 3 channels cannot be written"},
        {{{"color", Image(4, 4, 2)}}, "a layer \"color\" of 4x4 pixels with 2 channels cannot be written"}};
    for (const std::string path : {file("a.exr"), file("a.png")}) {
        for (const auto& c : cases)
            EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeLayers(path, c.first); }),
                      path + ": " + c.second);
    }
    EXPECT_TRUE(names().empty());
}

}  // namespace glint::round_trip_test
