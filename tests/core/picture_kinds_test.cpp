// Kinds of JPEG and PNG files that libjpeg and zlib write here.
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE
#include <cstdlib>

#include <jpeglib.h>
#include <zlib.h>

#include "core/codecs.h"
#include "core/quantize.h"
#include "support/support.h"

namespace glint::picture_kinds_test {

// JPEG files as other programs write them: progressive, grey, inks.

struct Kind {
    J_COLOR_SPACE given = JCS_RGB;
    J_COLOR_SPACE stored = JCS_YCbCr;
    bool progressive = false;
};

// One colour all over, at the best quality: a block's mean is kept to a rounding.
std::vector<uint8_t> flatJpeg(const Kind& kind, const std::vector<uint8_t>& pixel) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &memory, &size);
    info.image_width = info.image_height = 20;
    info.input_components = static_cast<int>(pixel.size());
    info.in_color_space = kind.given;
    jpeg_set_defaults(&info);
    jpeg_set_colorspace(&info, kind.stored);
    jpeg_set_quality(&info, 100, TRUE);
    if (kind.progressive) jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    std::vector<uint8_t> row;
    for (int x = 0; x < 20; ++x) row.insert(row.end(), pixel.begin(), pixel.end());
    for (uint8_t* at = row.data(); info.next_scanline < 20;) jpeg_write_scanlines(&info, &at, 1);
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    std::vector<uint8_t> file(memory, memory + size);
    std::free(memory);
    return file;
}

void expectFlat(const Image& image, const std::vector<double>& codes) {
    ASSERT_EQ(image.width, 20);
    ASSERT_EQ(image.height, 20);
    ASSERT_EQ(static_cast<size_t>(image.channels), codes.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const double code = codes[i % codes.size()];
        const double low = linearFromSrgb(std::max(code - 2.5, 0.0) / 255),
                     high = linearFromSrgb(std::min(code + 2.5, 255.0) / 255);
        ASSERT_GE(image.pixels[i], low) << i;
        ASSERT_LE(image.pixels[i], high) << i;
    }
}

TEST(JpegKinds, ColourBaselineAndProgressive) {
    for (const bool progressive : {false, true})
        expectFlat(decodeJpeg(flatJpeg({JCS_RGB, JCS_YCbCr, progressive}, {200, 100, 50})), {200, 100, 50});
    expectFlat(decodeJpeg(flatJpeg({JCS_RGB, JCS_RGB, false}, {200, 100, 50})), {200, 100, 50});
    expectFlat(decodeJpeg(flatJpeg({JCS_GRAYSCALE, JCS_GRAYSCALE, true}, {90})), {90});
}

TEST(JpegKinds, InksBecomeRgb) {
    // libjpeg writes Adobe's marker for both: 255 is no ink. 255 and 128 of black: 128 / 255 of 200 is 100.4.
    for (const auto stored : {JCS_CMYK, JCS_YCCK})
        expectFlat(decodeJpeg(flatJpeg({JCS_CMYK, stored, false}, {200, 100, 50, 128})), {100.4, 50.2, 25.1});
}

TEST(JpegKinds, ScansWithoutEndAreRefused) {
    std::vector<uint8_t> file = flatJpeg({JCS_GRAYSCALE, JCS_GRAYSCALE, true}, {90});
    // The last scan, again and again: from its marker (ff da) to the end marker.
    size_t scan = 0;
    for (size_t i = 0; i + 1 < file.size(); ++i)
        if (file[i] == 0xff && file[i + 1] == 0xda) scan = i;
    const std::vector<uint8_t> last(file.begin() + static_cast<std::ptrdiff_t>(scan), file.end() - 2);
    file.resize(file.size() - 2);
    for (int i = 0; i < 1000; ++i) file.insert(file.end(), last.begin(), last.end());
    file.insert(file.end(), {0xff, 0xd9});
    EXPECT_THROW(decodeJpeg(file), CodecError);
}

// PNG files of other programs: few bits, transparency, interlaced; and damage that a checksum shows. Made
// from the specification (W3C, PNG Second Edition, 2003) with zlib alone, as the decoder is libpng.

struct PngParts {
    uint32_t width, height;
    uint8_t bits, colorType, interlace;
    std::vector<uint8_t> rows;  // with the filter's byte before each
    std::vector<std::pair<std::string, std::vector<uint8_t>>> chunks = {};
};

void append32(std::vector<uint8_t>& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

void appendChunk(std::vector<uint8_t>& file, const std::string& type, const std::vector<uint8_t>& data) {
    append32(file, static_cast<uint32_t>(data.size()));
    const size_t start = file.size();
    file.insert(file.end(), type.begin(), type.end());
    file.insert(file.end(), data.begin(), data.end());
    append32(file,
             static_cast<uint32_t>(crc32(0, file.data() + start, static_cast<uInt>(file.size() - start))));
}

std::vector<uint8_t> pngBytes(const PngParts& png) {
    std::vector<uint8_t> file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header;
    append32(header, png.width);
    append32(header, png.height);
    header.insert(header.end(), {png.bits, png.colorType, 0, 0, png.interlace});
    appendChunk(file, "IHDR", header);
    for (const auto& [type, data] : png.chunks) appendChunk(file, type, data);
    uLongf size = compressBound(static_cast<uLong>(png.rows.size()));
    std::vector<uint8_t> packed(size);
    EXPECT_EQ(compress(packed.data(), &size, png.rows.data(), static_cast<uLong>(png.rows.size())), Z_OK);
    packed.resize(size);
    appendChunk(file, "IDAT", packed);
    appendChunk(file, "IEND", {});
    return file;
}

float linear(double code, double greatest) {
    return static_cast<float>(linearFromSrgb(code / greatest));
}

TEST(PngKinds, BecomeLinearSamples) {
    const float grey = linear(7, 255), wide = linear(0x8001, 65535);
    const std::vector<uint8_t> gamma = {0, 1, 0x86, 0xa0};  // 1.0
    const struct {
        const char* name;
        PngParts png;
        std::vector<float> pixels;
    } kinds[] = {{"1 bit: 10110000", {4, 1, 1, 0, 0, {0, 0xb0}}, {1, 0, 1, 1}},
                 {"2 bits: 00011011", {4, 1, 2, 0, 0, {0, 0x1b}}, {0, linear(1, 3), linear(2, 3), 1}},
                 {"4 bits", {2, 1, 4, 0, 0, {0, 0x4f}}, {linear(4, 15), 1}},
                 {"16 bits", {2, 1, 16, 0, 0, {0, 0x80, 0x01, 0xff, 0xff}}, {wide, 1}},
                 {"palette without alpha",
                  {3, 1, 8, 3, 0, {0, 1, 0, 1}, {{"PLTE", {255, 0, 0, 0, 255, 255}}}},
                  {0, 1, 1, 1, 0, 0, 0, 1, 1}},
                 {"alpha: 51 / 255, without curve", {1, 1, 8, 4, 0, {0, 255, 51}}, {1, 1, 1, 0.2f}},
                 {"a transparent grey",
                  {2, 1, 8, 0, 0, {0, 255, 7}, {{"tRNS", {0, 7}}}},
                  {1, 1, 1, 1, grey, grey, grey, 0}},
                 {"palette with alpha",
                  {2, 1, 8, 3, 0, {0, 0, 1}, {{"PLTE", {255, 0, 0, 0, 255, 0}}, {"tRNS", {51}}}},
                  {1, 0, 0, 0.2f, 0, 1, 0, 1}},
                 {"profiles and gamma do not count",
                  {1, 1, 8, 0, 0, {0, 128}, {{"gAMA", gamma}, {"tEXt", {'a', 0, 'b'}}}},
                  {linear(128, 255)}}};
    for (const auto& kind : kinds) EXPECT_EQ(decodePng(pngBytes(kind.png)).pixels, kind.pixels) << kind.name;
    EXPECT_NE(wide, linear(0x8000, 65535));
}

TEST(PngKinds, Interlaced) {
    // Adam7 of 3 x 3 (PNG Second Edition, 8.2): the passes have the pixels (0,0); none; none; (2,0); (0,2)
    // (2,2); (1,0) (1,2); row 1.
    const PngParts png = {3, 3, 8, 0, 1, {0, 10, 0, 30, 0, 70, 90, 0, 20, 0, 80, 0, 40, 50, 60}};
    const Image image = decodePng(pngBytes(png));
    ASSERT_EQ(image.pixels.size(), 9u);
    for (int i = 0; i < 9; ++i)
        EXPECT_EQ(image.pixels[static_cast<size_t>(i)], linear(10 * (i + 1), 255)) << i;
}

TEST(PngKinds, ChecksumsCount) {
    std::vector<uint8_t> file = pngBytes({2, 1, 8, 0, 0, {0, 1, 2}});
    file[file.size() - 12 - 5] ^= 1;  // within the checksum of IDAT
    EXPECT_THROW(decodePng(file), CodecError);
}

TEST(PngKinds, SizesAreLookedAtBeforeMemoryIsTaken) {
    EXPECT_THROW(decodePng(pngBytes({60000, 60000, 8, 6, 0, {0, 1, 2, 3, 4}})), CodecError);
    EXPECT_THROW(decodePng(pngBytes({8000, 8000, 8, 6, 1, {0, 1, 2, 3, 4}})), CodecError);
}

}  // namespace glint::picture_kinds_test
