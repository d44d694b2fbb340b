// Files from other programs: all kinds that a reader supports, and damaged ones.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <algorithm>
#include <cmath>

#include "core/codecs.h"
#include "core/image_io.h"
#include "core/quantize.h"
#include "support/support.h"

#if GLINT_WEBP
#include <webp/encode.h>
#endif

namespace glint::decode_test {

using test::errorOf;
using test::writeBytes;

class Decode : public test::FolderTest {};

std::string readError(const std::filesystem::path& path) {
    return errorOf(ErrorKind::Failed, [&] { readImage(path); });
}

std::vector<uint8_t> textBytes(const std::string& text) {
    return {text.begin(), text.end()};
}

// An 8 x 8 grey JPEG (ITU-T T.81) by hand: one block, all quantisers 1, one Huffman code of one bit in each
// table. DC = 8 (188 - 128) = 480 has category 9, so the data are: code 0, 480 in 9 bits, end of block 0,
// ones to pad: 0 111100000 0 11111 = 78 1f. The inverse DCT of a DC alone is DC / 8 in every pixel: 188.
std::vector<uint8_t> greyJpeg() {
    std::vector<uint8_t> file(7 + 64, 1);  // 64 quantisers
    const uint8_t start[7] = {0xff, 0xd8, 0xff, 0xdb, 0, 67, 0};
    std::copy(std::begin(start), std::end(start), file.begin());
    const std::vector<uint8_t> rest = {
        0xff, 0xc0, 0, 11, 8,    0, 8, 0, 8,  1, 1,    0x11, 0,  // 8 bits, 8 x 8, 1 component
        0xff, 0xc4, 0, 20, 0x00, 1, 0, 0, 0,  0, 0,    0,    0,    0,
        0,    0,    0, 0,  0,    0, 0, 9,  // DC: 0 -> category 9
        0xff, 0xc4, 0, 20, 0x10, 1, 0, 0, 0,  0, 0,    0,    0,    0,
        0,    0,    0, 0,  0,    0, 0, 0,  // AC: 0 -> end of block
        0xff, 0xda, 0, 8,  1,    1, 0, 0, 63, 0, 0x78, 0x1f, 0xff, 0xd9};
    file.insert(file.end(), rest.begin(), rest.end());
    return file;
}

TEST_F(Decode, Jpeg) {
    writeBytes(file("a.jpg"), greyJpeg());
    const Image image = readImage(file("a.jpg"));
    EXPECT_EQ(image.width, 8);
    EXPECT_EQ(image.height, 8);
    EXPECT_EQ(image.channels, 1);
    const float expected = std::pow((188.0f / 255.0f + 0.055f) / 1.055f, 2.4f);
    for (float sample : image.pixels) EXPECT_NEAR(sample, expected, 1e-6);
}

TEST_F(Decode, TheContentsCountAndNotTheName) {
    writeImage(file("a.pfm"), Image(2, 2, 1, 0.5f));
    std::filesystem::rename(file("a.pfm"), file("a.png"));
    EXPECT_EQ(readImage(file("a.png")).pixels, std::vector<float>(4, 0.5f));
}

TEST_F(Decode, PfmByteOrderAndScale) {
    std::vector<uint8_t> bytes = textBytes("Pf\n1 2\n2.0\n");
    // 1.0f is 3f800000, 0.5f is 3f000000; a positive scale means big endian, its size is the unit.
    bytes.insert(bytes.end(), {0x3f, 0x80, 0, 0, 0x3f, 0, 0, 0});
    writeBytes(file("a.pfm"), bytes);
    EXPECT_EQ(readImage(file("a.pfm")).pixels,
              (std::vector<float>{1.0f, 2.0f}));  // the bottom row comes first
    bytes.insert(bytes.begin() + 10, '\r');
    writeBytes(file("a.pfm"), bytes);
    EXPECT_EQ(readImage(file("a.pfm")).pixels, (std::vector<float>{1.0f, 2.0f}));
}

TEST_F(Decode, PfmHeadersThatMakeNoSense) {
    const std::string path = file("a.pfm").string();
    writeBytes(path, textBytes("PF\nx 2\n-1.0\n"));
    EXPECT_EQ(readError(path), path + ": the PFM header has no valid width");
    for (const char* header : {"PF\n0 2\n-1.0\n", "PF\n2 -2\n-1.0\n", "PF\n2 2\n0\n", "PF\n2 2\nnan\n"}) {
        writeBytes(path, textBytes(header));
        EXPECT_EQ(readError(path), path + ": the PFM header has a size or a scale that makes no sense");
    }
    writeBytes(path, textBytes("PF4\n1 1\n-1.0\nabcd"));
    EXPECT_EQ(readError(path), path + ": the PFM header begins neither with PF nor Pf");
    // Memory must not be requested for sizes that exceed any memory.
    writeBytes(path, textBytes("PF\n2147483647 2147483647\n-1.0\nabcdefghijkl"));
    EXPECT_STARTS(readError(path), path + ": the image has 2147483647 x 2147483647 pixels, the limit is ");
}

TEST_F(Decode, FilesThatAreNoPictures) {
    const std::string path = file("a.png").string();
    EXPECT_EQ(readError(path), path + ": no such file");
    writeBytes(path, {});
    EXPECT_EQ(readError(path), path + ": the file is empty");
    writeBytes(path, textBytes("solid cube"));
    EXPECT_EQ(readError(path), path + ": not an image of a known kind (PNG, JPEG, EXR, PFM, HDR or WebP)");
    EXPECT_EQ(readError(folder_), folder_.string() + ": is a folder, not a file");
}

TEST_F(Decode, PipesAndDevicesAreNotWaitedFor) {
    const std::string pipe = file("pipe.png").string();
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(readError(pipe), pipe + ": is not a regular file");
    EXPECT_EQ(readError("/dev/zero"), "/dev/zero: is not a regular file");
}

// Every shortened version of a file must be refused, and none may hang or crash the decoder.
template <typename Decoder>
void expectEveryPrefixRefused(const std::vector<uint8_t>& whole, Decoder decoder) {
    ASSERT_NO_THROW(decoder(ByteView(whole), kMostPixels, {}));
    for (size_t length = 0; length < whole.size(); ++length) {
        // A copy of its own, so that a sanitizer detects a read past its end.
        const std::vector<uint8_t> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        ASSERT_THROW(decoder(ByteView(part), kMostPixels, {}), CodecError)
            << "cut to " << length << " of " << whole.size();
    }
}

Image varied(int width, int height) {
    Image image(width, height, 3);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = static_cast<float>(i * 7919 % 256) / 255.0f;
    return image;
}

TEST(Truncated, EveryPrefixIsRefused) {
    expectEveryPrefixRefused(encodePng(20, 10, 3, quantizeColor(varied(20, 10))), decodePng);
    expectEveryPrefixRefused(greyJpeg(), decodeJpeg);
    expectEveryPrefixRefused(encodePfm(varied(5, 4)), decodePfm);
    expectEveryPrefixRefused(encodeHdr(varied(5, 4)), decodeHdr);  // narrow pictures are stored without runs
    Image image = varied(40, 6);
    for (int x = 10; x < 30; ++x) image.at(x, 3, 0) = 0.5f;
    expectEveryPrefixRefused(encodeHdr(image), decodeHdr);
    Image noise(6, 60, 1);
    noise.pixels = varied(6, 20).pixels;
    expectEveryPrefixRefused(encodeExr({{"color", noise}}), decodeExr);
    expectEveryPrefixRefused(encodeExr({{"color", Image(40, 20, 3, 0.5f)}}), decodeExr);
}

std::string reasonOf(const std::vector<uint8_t>& file, Image (*decoder)(ByteView, uint64_t, const Context&)) {
    try {
        decoder(ByteView(file), kMostPixels, {});
    } catch (const CodecError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(Damaged, ExrWhoseHeaderDoesNotFit) {
    Image grey(2, 2, 1);
    grey.pixels = {1, 2, 3, 4};
    const std::vector<uint8_t> whole = encodeExr({{"color", grey}});
    std::vector<uint8_t> file = whole;
    file[5] |= 0x02;  // bit 9 of the version: tiled
    const std::string tiled = reasonOf(file, decodeExr);
    EXPECT_HAS(tiled, "the EXR file is truncated or damaged");
    file[5] = 0x08;  // bit 11: not an image
    EXPECT_EQ(reasonOf(file, decodeExr), "EXR files with deep pixels are not supported");
    // An attribute more, behind magic number and version, whose size is 2^31 - 1: no memory may be taken.
    file = whole;
    const std::string attribute("owner\0string\0\xff\xff\xff\x7f", 17);
    file.insert(file.begin() + 8, attribute.begin(), attribute.end());
    EXPECT_EQ(reasonOf(file, decodeExr), "the file is truncated");
}

#if GLINT_WEBP

Bytes webpOf(int width, int height, bool alpha) {
    Bytes samples;
    const int channels = alpha ? 4 : 3;
    for (int i = 0; i < width * height * channels; i++) samples.push_back(static_cast<uint8_t>(7 * i));
    uint8_t* encoded = nullptr;
    const size_t size = alpha ? WebPEncodeLosslessRGBA(samples.data(), width, height, 4 * width, &encoded)
                              : WebPEncodeLosslessRGB(samples.data(), width, height, 3 * width, &encoded);
    Bytes bytes(encoded, encoded + size);
    WebPFree(encoded);
    return bytes;
}

TEST(Webp, LosslessPictures) {
    const Image image = decodeWebp(webpOf(5, 3, false));
    ASSERT_EQ(image.width, 5);
    ASSERT_EQ(image.height, 3);
    ASSERT_EQ(image.channels, 3);
    const std::vector<float> linear = linearOfCodes(256);
    for (size_t i = 0; i < 45; i++) EXPECT_EQ(image.pixels[i], linear[7 * i % 256]);
    const Image clear = decodeWebp(webpOf(2, 2, true));
    ASSERT_EQ(clear.channels, 4);
    EXPECT_EQ(clear.at(1, 0, 3), 49 / 255.0f) << "alpha is linear";
}

TEST(Webp, DamageIsRefused) {
    expectEveryPrefixRefused(webpOf(5, 3, false), decodeWebp);
    EXPECT_THROW(decodeWebp(webpOf(5, 3, false), 14), CodecError) << "a pixel too many";
}

#else

TEST(Webp, IsNotReadByThisBuild) {
    EXPECT_HAS(reasonOf(textBytes("RIFF"), decodeWebp), "libwebp-dev");
}

#endif

// Two rows of three pixels: exponent 129 makes the mantissa 128 a 1.
Image hdrOf(const std::string& header, const std::string& size, const std::string& pixels) {
    return decodeHdr(textBytes("#?RADIANCE\n" + header + "\n" + size + "\n" + pixels));
}
std::string hdrPixels(const std::string& reds) {
    std::string bytes;
    for (const char red : reds) bytes += {red, '\0', '\0', '\x81'};
    return bytes;
}

TEST(Hdr, OrientationsAreTurnedUpright) {
    const float expected[2][3] = {{0.125f, 0.25f, 0.375f}, {0.5f, 0.625f, 0.75f}};
    const std::pair<const char*, const char*> kinds[] = {
        {"-Y 2 +X 3", "\x10\x20\x30\x40\x50\x60"}, {"+Y 2 +X 3", "\x40\x50\x60\x10\x20\x30"},
        {"-Y 2 -X 3", "\x30\x20\x10\x60\x50\x40"}, {"+Y 2 -X 3", "\x60\x50\x40\x30\x20\x10"},
        {"+X 3 -Y 2", "\x10\x40\x20\x50\x30\x60"}, {"+X 3 +Y 2", "\x40\x10\x50\x20\x60\x30"},
        {"-X 3 -Y 2", "\x30\x60\x20\x50\x10\x40"}, {"-X 3 +Y 2", "\x60\x30\x50\x20\x40\x10"}};
    for (const auto& [size, reds] : kinds) {
        const Image image = hdrOf("", size, hdrPixels(reds));
        ASSERT_EQ(image.width, 3) << size;
        ASSERT_EQ(image.height, 2) << size;
        for (int y = 0; y < 2; y++)
            for (int x = 0; x < 3; x++) EXPECT_EQ(image.at(x, y, 0), expected[y][x]) << size << x << y;
    }
    for (const char* size : {"-Y 2 +Y 3", "-Z 2 +X 3", "-Y 2", "-Y 2 +X 3 4", "Y 2 X 3"})
        EXPECT_THROW(hdrOf("", size, hdrPixels("123456")), CodecError) << size;
}

TEST(Hdr, ExposuresAreDividedOut) {
    const std::string pixels = hdrPixels("\x40\x40\x40\x40\x40\x40");
    EXPECT_EQ(hdrOf("EXPOSURE=2\n", "-Y 2 +X 3", pixels).at(0, 0, 0), 0.25f);
    EXPECT_EQ(hdrOf("EXPOSURE= 2\nEXPOSURE=4e0\n", "-Y 2 +X 3", pixels).at(2, 1, 0), 0.0625f);
    for (const char* bad :
         {"EXPOSURE=0\n", "EXPOSURE=x\n", "EXPOSURE=-1\n", "EXPOSURE=1e300\n", "FORMAT=32-bit_rle_xyze\n"})
        EXPECT_THROW(hdrOf(bad, "-Y 2 +X 3", pixels), CodecError) << bad;
}

TEST(Hdr, RunsOfWholePixels) {
    const std::string one = hdrPixels("\x40"), other = hdrPixels("\x20");
    const auto run = [](int n) { return std::string("\1\1\1") + static_cast<char>(n); };
    // 1 + 3 and 2 + 2 pixels; then 1 + 1 + 256 * 2.
    const Image small = hdrOf("", "-Y 2 +X 4", one + run(3) + other + run(1) + one + run(1));
    EXPECT_EQ(small.at(3, 0, 0), 0.5f);
    EXPECT_EQ(small.at(1, 1, 0), 0.25f);
    EXPECT_EQ(small.at(2, 1, 0), 0.5f);
    const Image wide = hdrOf("", "-Y 1 +X 514", one + run(1) + run(2));
    EXPECT_EQ(wide.at(513, 0, 0), 0.5f);
    EXPECT_THROW(hdrOf("", "-Y 1 +X 4", one + run(4)), CodecError) << "beyond the row";
    EXPECT_THROW(hdrOf("", "-Y 1 +X 4", run(4)), CodecError) << "nothing to repeat";
    EXPECT_THROW(hdrOf("", "-Y 1 +X 4", one), CodecError) << "truncated";
}

TEST(Damaged, HdrWithoutPixels) {
    EXPECT_EQ(reasonOf(textBytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 0\n"), decodeHdr),
              "the file is damaged or of a kind that is not supported (no pixels)");
}

}  // namespace glint::decode_test
