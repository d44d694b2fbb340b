#include "png_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "support/support.h"

namespace glint::test {
namespace {

void append32(std::vector<uint8_t>& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<uint8_t>(value >> shift));
    }
}

uint32_t read32(const uint8_t* bytes) {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | uint32_t{bytes[3]};
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

void unfilter(const std::vector<uint8_t>& rows, PngFile& png) {
    const size_t rowSize = static_cast<size_t>(png.width) * png.bytesPerPixel();
    ASSERT_EQ(rows.size(), (rowSize + 1) * png.height);
    png.samples.assign(rowSize * png.height, 0);
    for (size_t y = 0; y < static_cast<size_t>(png.height); ++y) {
        const uint8_t* source = &rows[y * (rowSize + 1)];
        const uint8_t filter = *source++;
        ASSERT_LE(filter, 2) << "row " << y;
        for (size_t x = 0; x < rowSize; ++x) {
            const auto pixel = static_cast<size_t>(png.bytesPerPixel());
            const uint8_t left = x >= pixel ? png.samples[y * rowSize + x - pixel] : uint8_t{0};
            const uint8_t above = y > 0 ? png.samples[(y - 1) * rowSize + x] : uint8_t{0};
            const uint8_t prediction = filter == 1 ? left : filter == 2 ? above : uint8_t{0};
            png.samples[y * rowSize + x] = static_cast<uint8_t>(source[x] + prediction);
        }
    }
}

}  // namespace

int PngFile::bytesPerPixel() const {
    const int channels[] = {1, 0, 3, 1, 2, 0, 4};
    return channels[colorType] * bitDepth / 8;
}

PngFile readPng(const std::filesystem::path& path) {
    const std::vector<uint8_t> file = readBytes(path);
    PngFile png;
    std::vector<uint8_t> compressed;
    std::string types;
    for (size_t position = 8; position + 12 <= file.size();) {
        const size_t length = read32(&file[position]);
        const std::string type(file.begin() + position + 4, file.begin() + position + 8);
        const std::vector<uint8_t> data(file.begin() + position + 8, file.begin() + position + 8 + length);
        EXPECT_EQ(read32(&file[position + 8 + length]), crcOf(type, data)) << type;
        if (type == "IHDR") {
            png.width = static_cast<int>(read32(&data[0]));
            png.height = static_cast<int>(read32(&data[4]));
            png.bitDepth = data[8];
            png.colorType = data[9];
        } else if (type == "IDAT") {
            compressed.insert(compressed.end(), data.begin(), data.end());
        }
        types += type + " ";
        position += 12 + length;
    }
    EXPECT_EQ(types.rfind("IHDR ", 0), 0u) << path;
    EXPECT_TRUE(types.ends_with("IEND ")) << path;
    std::vector<uint8_t> rows((static_cast<size_t>(png.width) * png.bytesPerPixel() + 1) * png.height);
    uLongf size = static_cast<uLongf>(rows.size());
    EXPECT_EQ(uncompress(rows.data(), &size, compressed.data(), static_cast<uLong>(compressed.size())), Z_OK);
    rows.resize(size);
    unfilter(rows, png);
    return png;
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
