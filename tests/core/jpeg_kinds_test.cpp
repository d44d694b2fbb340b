// JPEG files as other programs write them: progressive, grey, inks.
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE

#include <jpeglib.h>

#include <cmath>
#include <cstdlib>

#include "core/codecs.h"
#include "core/quantize.h"
#include "support/support.h"

namespace glint::jpeg_kinds_test {
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

}  // namespace glint::jpeg_kinds_test
