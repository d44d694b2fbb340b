// PNG files as other programs write them: few bits, transparency, interlaced; and damage that a checksum
// shows.
#include <zlib.h>

#include "core/codecs.h"
#include "core/quantize.h"
#include "support/support.h"

namespace glint::png_kinds_test {
using Bytes8 = std::vector<uint8_t>;

void append32(Bytes8& file, uint32_t number) {
    for (const int shift : {24, 16, 8, 0}) file.push_back(static_cast<uint8_t>(number >> shift));
}

void appendChunk(Bytes8& file, const std::string& type, const Bytes8& data) {
    append32(file, static_cast<uint32_t>(data.size()));
    Bytes8 body(type.begin(), type.end());
    body.insert(body.end(), data.begin(), data.end());
    file.insert(file.end(), body.begin(), body.end());
    append32(file, static_cast<uint32_t>(crc32(0, body.data(), static_cast<uInt>(body.size()))));
}

struct Png {
    uint32_t width, height;
    uint8_t bits, colorType, interlace;
    Bytes8 rows;  // with the filter's byte before each
    std::vector<std::pair<std::string, Bytes8>> chunks = {};
};

Bytes8 bytesOf(const Png& png) {
    Bytes8 file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header;
    append32(header, png.width);
    append32(header, png.height);
    header.insert(header.end(), {png.bits, png.colorType, 0, 0, png.interlace});
    appendChunk(file, "IHDR", header);
    for (const auto& [type, data] : png.chunks) appendChunk(file, type, data);
    uLongf size = compressBound(png.rows.size());
    Bytes8 packed(size);
    compress(packed.data(), &size, png.rows.data(), png.rows.size());
    packed.resize(size);
    appendChunk(file, "IDAT", packed);
    appendChunk(file, "IEND", {});
    return file;
}

float linear(double code, double greatest) {
    return static_cast<float>(linearFromSrgb(code / greatest));
}

TEST(PngKinds, FewBitsOfGrey) {
    // 0b10110000 of one bit, 0b00011011 of two, 0x4f of four
    EXPECT_EQ(decodePng(bytesOf({4, 1, 1, 0, 0, {0, 0xb0}})).pixels, (std::vector<float>{1, 0, 1, 1}));
    EXPECT_EQ(decodePng(bytesOf({4, 1, 2, 0, 0, {0, 0x1b}})).pixels,
              (std::vector<float>{0, linear(1, 3), linear(2, 3), 1}));
    EXPECT_EQ(decodePng(bytesOf({2, 1, 4, 0, 0, {0, 0x4f}})).pixels, (std::vector<float>{linear(4, 15), 1}));
}

TEST(PngKinds, TransparentColours) {
    const Image grey = decodePng(bytesOf({2, 1, 8, 0, 0, {0, 255, 7}, {{"tRNS", {0, 7}}}}));
    EXPECT_EQ(grey.pixels,
              (std::vector<float>{1, 1, 1, 1, linear(7, 255), linear(7, 255), linear(7, 255), 0}));
    const Image palette =
        decodePng(bytesOf({2, 1, 8, 3, 0, {0, 0, 1}, {{"PLTE", {255, 0, 0, 0, 255, 0}}, {"tRNS", {51}}}}));
    EXPECT_EQ(palette.pixels, (std::vector<float>{1, 0, 0, 0.2f, 0, 1, 0, 1}));
}

TEST(PngKinds, ProfilesAndGammaDoNotCount) {
    const Bytes8 gamma = {0, 1, 0x86, 0xa0};  // 1.0
    EXPECT_EQ(
        decodePng(bytesOf({1, 1, 8, 0, 0, {0, 128}, {{"gAMA", gamma}, {"tEXt", {'a', 0, 'b'}}}})).pixels,
        (std::vector<float>{linear(128, 255)}));
}

TEST(PngKinds, Interlaced) {
    // Adam7 of 3 x 3 (PNG Second Edition, 8.2): the passes have the pixels (0,0); none; none; (2,0); (0,2)
    // (2,2); (1,0) (1,2); row 1.
    const Png png = {3, 3, 8, 0, 1, {0, 10, 0, 30, 0, 70, 90, 0, 20, 0, 80, 0, 40, 50, 60}};
    const Image image = decodePng(bytesOf(png));
    ASSERT_EQ(image.pixels.size(), 9u);
    for (int i = 0; i < 9; ++i)
        EXPECT_EQ(image.pixels[static_cast<size_t>(i)], linear(10 * (i + 1), 255)) << i;
}

TEST(PngKinds, ChecksumsCount) {
    Bytes8 file = bytesOf({2, 1, 8, 0, 0, {0, 1, 2}});
    file[file.size() - 12 - 5] ^= 1;  // within the checksum of IDAT
    EXPECT_THROW(decodePng(file), CodecError);
}

TEST(PngKinds, SizesAreLookedAtBeforeMemoryIsTaken) {
    EXPECT_THROW(decodePng(bytesOf({60000, 60000, 8, 6, 0, {0, 1, 2, 3, 4}})), CodecError);
    EXPECT_THROW(decodePng(bytesOf({8000, 8000, 8, 6, 1, {0, 1, 2, 3, 4}})), CodecError);
}

}  // namespace glint::png_kinds_test
