// PFM: "PF" (colour) or "Pf" (grey), width, height, a scale whose sign gives the byte order (negative: little
// endian), then raw floats, bottom row first (P. Debevec, "PFM Portable FloatMap Image Format").
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>

#include "core/binary_numbers.h"
#include "core/codecs.h"

namespace glint {
namespace {

static_assert(std::endian::native == std::endian::little, "encodePfm copies floats in the host's byte order");

// The next word of the header at `position`, which then follows the word. White space separates words.
std::string nextWord(ByteView file, size_t& position) {
    const auto isSpace = [&] { return std::isspace(file[position]) != 0; };
    while (position < file.size() && isSpace()) ++position;
    std::string text;
    for (; position < file.size() && !isSpace(); ++position) text += static_cast<char>(file[position]);
    return text;
}

template <typename Number>
Number nextNumber(ByteView file, size_t& position, const char* what) {
    const std::string text = nextWord(file, position);
    Number value{};
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || rest != end)
        throw CodecError(std::string("the PFM header has no valid ") + what);
    return value;
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
        : sink_(sink), name_(std::move(name)), kept_(channels == 1 ? 1 : 3), left_(height) {
        const std::string header = std::string(kept_ == 1 ? "Pf" : "PF") + "\n" + std::to_string(width) +
                                   " " + std::to_string(height) + "\n-1.0\n";
        sink_.write(ByteView(reinterpret_cast<const uint8_t*>(header.data()), header.size()), 0);
        first_ = header.size();
        rowBytes_ = static_cast<uint64_t>(width) * static_cast<uint64_t>(kept_) * sizeof(float);
    }

    void add(const std::vector<Layer>& rows) override { add(findLayer(rows, name_)->image); }
    // The file's rows go from the bottom to the top.
    void add(const Image& rows) {
        Bytes bytes;
        for (int y = 0; y < rows.height; ++y) {
            bytes.clear();
            appendRow(rows, y, kept_, bytes);
            sink_.write(bytes, positionOf(--left_));
        }
    }

    void fill(int, const std::vector<Layer>& layers) override {
        if (left_ == 0) return;
        const Image& row = findLayer(layers, name_)->image;
        add(row);  // by which the file has its size, even if it is the first
        Bytes bytes;
        appendRow(row, 0, kept_, bytes);
        // A file is 0 where nothing was written.
        if (std::all_of(bytes.begin(), bytes.end(), [](uint8_t byte) { return byte == 0; })) left_ = 0;
        while (left_ > 0) sink_.write(bytes, positionOf(--left_));
    }
    void finish() override {}

  private:
    uint64_t positionOf(int rowsBelow) const { return first_ + static_cast<uint64_t>(rowsBelow) * rowBytes_; }

    ByteSink& sink_;
    std::string name_;
    int kept_, left_;     // channels; rows that are still to come
    uint64_t first_ = 0;  // byte behind the header
    uint64_t rowBytes_ = 0;
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
    size_t position = 0;
    const std::string kind = nextWord(file, position);
    if (kind != "PF" && kind != "Pf") throw CodecError("the PFM header begins neither with PF nor Pf");
    const int channels = kind == "PF" ? 3 : 1;
    const int width = nextNumber<int>(file, position, "width");
    const int height = nextNumber<int>(file, position, "height");
    const double scale = nextNumber<double>(file, position, "scale");
    if (width <= 0 || height <= 0 || !std::isfinite(scale) || scale == 0)
        throw CodecError("the PFM header has a size or a scale that makes no sense");
    checkDeclaredSize(static_cast<uint64_t>(width), static_cast<uint64_t>(height), file.size(), 1,
                      mostPixels);
    ByteView data = file.subspan(std::min(position + 1, file.size()));  // behind one white space
    const size_t rowSamples = static_cast<size_t>(width) * channels;
    const size_t bytes = rowSamples * static_cast<size_t>(height) * sizeof(float);
    if (data.size() < bytes) throw CodecError("the file is truncated");
    if (data.size() == bytes + 1 && file[position] == '\r') data = data.subspan(1);  // behind a DOS line end
    Image image(width, height, channels);
    const char* next = reinterpret_cast<const char*>(data.data());
    const double unit = std::abs(scale);  // of the samples; programs without a scale write 1
    for (int y = height - 1; y >= 0; --y) {
        for (size_t i = 0; i < rowSamples; ++i, next += sizeof(float)) {
            const auto sample = loadNumber<float>(next, scale > 0 ? std::endian::big : std::endian::little);
            image.pixels[static_cast<size_t>(y) * rowSamples + i] =
                unit == 1 ? sample : static_cast<float>(sample * unit);
        }
    }
    return image;
}

}  // namespace glint
