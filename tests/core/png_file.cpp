#include "png_file.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <cstdio>
#include <memory>
#include <string>

namespace glint::test {
namespace {

void append32(std::vector<uint8_t>& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
}

uint32_t crcOf(const std::string& type, const std::vector<uint8_t>& data) {
    uLong crc = crc32(0, reinterpret_cast<const Bytef*>(type.data()), 4);
    crc = data.empty() ? crc : crc32(crc, data.data(), static_cast<uInt>(data.size()));
    return static_cast<uint32_t>(crc);
}

void appendChunk(std::vector<uint8_t>& file, const std::string& type, const std::vector<uint8_t>& data) {
    append32(file, static_cast<uint32_t>(data.size()));
    file.insert(file.end(), type.begin(), type.end());
    file.insert(file.end(), data.begin(), data.end());
    append32(file, crcOf(type, data));
}

}  // namespace

// libpng's own error handler ends the process.
PngFile readPng(const std::filesystem::path& path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    EXPECT_TRUE(file) << path;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file.get());
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    PngFile result{static_cast<int>(png_get_image_width(png, info)),
                   static_cast<int>(png_get_image_height(png, info)), png_get_bit_depth(png, info),
                   png_get_color_type(png, info)};
    for (int y = 0; y < result.height; ++y) {
        const uint8_t* const row = png_get_rows(png, info)[y];
        result.samples.insert(result.samples.end(), row, row + png_get_rowbytes(png, info));
    }
    png_destroy_read_struct(&png, &info, nullptr);
    return result;
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

}  // namespace glint::test
