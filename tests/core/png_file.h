// Reads PNG files of stb_image_write and core/png_rows.cpp with libpng. Makes PNG files for the decoder,
// which is libpng, from the specification (W3C, PNG Second Edition, 2003) with zlib alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace glint::test {

struct PngFile {
    int width = 0;
    int height = 0;
    int bitDepth = 8;
    int colorType = 2;                  // 0 grey, 2 RGB, 4 grey and alpha, 6 RGBA
    std::vector<uint8_t> samples = {};  // rows from the top, 16-bit samples big endian
};

PngFile readPng(const std::filesystem::path& path);

struct PngParts {
    uint32_t width, height;
    uint8_t bits, colorType, interlace;
    std::vector<uint8_t> rows;  // with the filter's byte before each
    std::vector<std::pair<std::string, std::vector<uint8_t>>> chunks = {};
};

std::vector<uint8_t> pngBytes(const PngParts& png);

}  // namespace glint::test
