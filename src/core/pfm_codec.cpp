// PFM: "PF" (colour) or "Pf" (grey), width, height, a scale whose sign gives the byte order (negative: little
// endian), then raw floats, bottom row first (P. Debevec, "PFM Portable FloatMap Image Format").
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/codecs.h"

namespace glint {
namespace {

static_assert(std::endian::native == std::endian::little, "encodePfm copies floats in the host's byte order");

// Reads the header's words, which any white space separates; exactly one character of it follows the last
// word.
class HeaderReader {
  public:
    explicit HeaderReader(ByteView file) : file_(file) {}

    std::string word() {
        while (position_ < file_.size() && isSpace()) {
            ++position_;
        }
        std::string text;
        while (position_ < file_.size() && !isSpace()) {
            text += static_cast<char>(file_[position_++]);
        }
        return text;
    }

    template <typename Number>
    Number number(const char* what) {
        const std::string text = word();
        Number value{};
        const char* end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data(), end, value);
        if (error != std::errc{} || rest != end) {
            throw CodecError(std::string("the PFM header has no valid ") + what);
        }
        return value;
    }

    ByteView rest() const { return file_.subspan(std::min(position_ + 1, file_.size())); }

  private:
    bool isSpace() const { return std::isspace(file_[position_]) != 0; }

    ByteView file_;
    size_t position_ = 0;
};

float decodeFloat(const uint8_t* bytes, bool bigEndian) {
    uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) {
        bits |= static_cast<uint32_t>(bytes[i]) << (bigEndian ? 24 - 8 * i : 8 * i);
    }
    return std::bit_cast<float>(bits);
}

}  // namespace

Bytes encodePfm(const Image& image) {
    const int kept = image.channels == 1 ? 1 : 3;
    const std::string header = std::string(kept == 1 ? "Pf" : "PF") + "\n" + std::to_string(image.width) +
                               " " + std::to_string(image.height) + "\n-1.0\n";
    Bytes file(header.begin(), header.end());
    const size_t rowBytes = static_cast<size_t>(image.width) * kept * sizeof(float);
    file.reserve(file.size() + rowBytes * image.height);
    std::vector<float> row;
    for (int y = image.height - 1; y >= 0; --y) {
        row.clear();
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < kept; ++c) {
                row.push_back(image.at(x, y, c));
            }
        }
        const auto* bytes = reinterpret_cast<const uint8_t*>(row.data());
        file.insert(file.end(), bytes, bytes + rowBytes);
    }
    return file;
}

Image decodePfm(ByteView file, uint64_t mostPixels) {
    HeaderReader header(file);
    const int channels = header.word() == "PF" ? 3 : 1;
    const int width = header.number<int>("width");
    const int height = header.number<int>("height");
    const double scale = header.number<double>("scale");
    if (width <= 0 || height <= 0 || !std::isfinite(scale) || scale == 0) {
        throw CodecError("the PFM header has a size or a scale that makes no sense");
    }
    const ByteView data = header.rest();
    const size_t rowSamples = static_cast<size_t>(width) * channels;
    if (data.size() / sizeof(float) / rowSamples < static_cast<size_t>(height)) {
        throw CodecError("the file is truncated");
    }
    if (static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > mostPixels) {
        throw CodecError("the picture has " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels, the limit is " + std::to_string(mostPixels));
    }
    Image image(width, height, channels);
    const uint8_t* next = data.data();
    for (int y = height - 1; y >= 0; --y) {
        for (size_t i = 0; i < rowSamples; ++i, next += sizeof(float)) {
            image.pixels[static_cast<size_t>(y) * rowSamples + i] = decodeFloat(next, scale > 0);
        }
    }
    // The scale's size is the unit of the samples; programs that have none write 1.
    if (std::abs(scale) != 1.0) {
        for (float& sample : image.pixels) {
            sample = static_cast<float>(sample * std::abs(scale));
        }
    }
    return image;
}

}  // namespace glint
