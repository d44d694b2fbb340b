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

constexpr size_t kMostBlockBytes = 1 << 20;  // of rows alike that are written at once

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

std::string headerOf(int width, int height, int channels) {
    return std::string(channels == 1 ? "Pf" : "PF") + "\n" + std::to_string(width) + " " +
           std::to_string(height) + "\n-1.0\n";
}

// One row with `kept` channels; a missing one is 0.
void appendRow(const Image& image, int y, int kept, Bytes& bytes) {
    std::vector<float> row;
    row.reserve(static_cast<size_t>(image.width) * kept);
    for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < kept; ++c) row.push_back(c < image.channels ? image.at(x, y, c) : 0.0f);
    }
    const auto* from = reinterpret_cast<const uint8_t*>(row.data());
    bytes.insert(bytes.end(), from, from + row.size() * sizeof(float));
}

class PfmRows : public RowEncoder {
  public:
    PfmRows(ByteSink& sink, int width, int height, int channels, std::string name)
        : sink_(sink), name_(std::move(name)), width_(width), kept_(channels == 1 ? 1 : 3), left_(height) {
        const std::string header = headerOf(width, height, kept_);
        sink_.write(ByteView(reinterpret_cast<const uint8_t*>(header.data()), header.size()), 0);
        first_ = header.size();
    }

    void add(const std::vector<Layer>& rows) override { add(findLayer(rows, name_)->image); }
    // The file's rows go from the bottom to the top.
    void add(const Image& rows) {
        Bytes bytes;
        for (int y = rows.height - 1; y >= 0; --y) appendRow(rows, y, kept_, bytes);
        left_ -= rows.height;
        sink_.write(bytes, positionOf(left_));
    }

    void fill(int, const std::vector<Layer>& layers) override {
        if (left_ == 0) return;
        const Image& row = findLayer(layers, name_)->image;
        add(row);  // by which the file has its size, even if it is the first
        Bytes bytes;
        appendRow(row, 0, kept_, bytes);
        if (std::all_of(bytes.begin(), bytes.end(), [](uint8_t byte) { return byte == 0; })) left_ = 0;
        const size_t rowBytes = bytes.size();
        const int inBlock = std::min(left_, static_cast<int>(kMostBlockBytes / rowBytes) + 1);
        for (int y = 1; y < inBlock; ++y) appendRow(row, 0, kept_, bytes);
        while (left_ > 0) {
            const int rows = std::min(left_, inBlock);
            left_ -= rows;
            sink_.write(ByteView(bytes).first(static_cast<size_t>(rows) * rowBytes), positionOf(left_));
        }
    }
    void finish() override {}

  private:
    uint64_t positionOf(int rowsBelow) const {
        return first_ + static_cast<uint64_t>(rowsBelow) * static_cast<uint64_t>(width_) *
                            static_cast<uint64_t>(kept_) * sizeof(float);
    }

    ByteSink& sink_;
    std::string name_;
    int width_, kept_, left_;  // rows that are still to come
    uint64_t first_ = 0;       // byte behind the header
};

}  // namespace

std::unique_ptr<RowEncoder> pfmRows(ByteSink& sink, int width, int height, const Layer& shape) {
    return std::make_unique<PfmRows>(sink, width, height, shape.image.channels, shape.name);
}

Bytes encodePfm(const Image& image) {
    MemorySink sink;
    PfmRows(sink, image.width, image.height, image.channels, "").add(image);
    return std::move(sink.bytes);
}

Image decodePfm(ByteView file, uint64_t mostPixels, const Context&) {
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
