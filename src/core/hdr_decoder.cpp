// Radiance images (G. Ward, "Real Pixels", Graphics Gems II, 1991; the Radiance reference manual, "File
// Formats"): a text header that an empty line ends, a line with the size, then scanlines of RGBE pixels,
// either with each byte of the four in runs of its own, or plain with runs of whole pixels.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kLeastRunWidth = 8, kMostRunWidth = 32767;
constexpr double kMostExposure = 1e30, kMostUnit = 1e36;  // 256 of the latter are a float

class HdrReader {
  public:
    HdrReader(ByteView file, uint64_t mostPixels, const Context& context)
        : file_(file), mostPixels_(mostPixels), context_(context) {}

    Image read() {
        readHeader();
        makeUnits();
        readSize();
        // A run of 127 bytes takes two, and a pixel has four. Of a row in older runs two pixels are stored at
        // least; beyond 1024, of any other format, no file is believed.
        const double perByte = std::clamp(static_cast<double>(width_) / 8, 127.0 / 8, 1024.0);
        checkDeclaredSize(width_, height_, file_.size(), perByte, mostPixels_);
        RowCollector rows(context_, static_cast<int>(width_), static_cast<int>(height_), 3);
        std::vector<uint8_t> pixels(4 * width_);
        for (size_t y = 0; y < height_; ++y) {
            if (isRunLengthEncoded())
                readRuns(pixels);
            else
                readPlain(pixels);
            convert(pixels, rows.next());
        }
        return upright(rows.take());
    }

  private:
    std::string_view line() {
        const std::string_view text(reinterpret_cast<const char*>(file_.data()), file_.size());
        const size_t end = text.find('\n', position_);
        if (end == std::string_view::npos) throw CodecError("the file is truncated");
        const std::string_view found = text.substr(position_, end - position_);
        position_ = end + 1;
        return found;
    }

    void readHeader() {
        const std::string_view magic = line();
        if (magic != "#?RADIANCE" && magic != "#?RGBE") failDamaged("not HDR");
        for (std::string_view text = line(); !text.empty(); text = line()) {
            if (text.starts_with("FORMAT=") && text.substr(7) != "32-bit_rle_rgbe")
                failDamaged("unsupported format");
            // Factors that multiplied the samples; several multiply together.
            if (text.starts_with("EXPOSURE=")) exposure_ *= numberAt(text.substr(9));
        }
        if (!(exposure_ > 0 && exposure_ < kMostExposure && 1 / exposure_ < kMostExposure))
            throw CodecError("the file is damaged (EXPOSURE is no number or out of range)");
    }

    static double numberAt(std::string_view text) {
        const size_t start = text.find_first_not_of(" \t");
        double value = 0;
        if (start != text.npos) std::from_chars(text.data() + start, text.data() + text.size(), value);
        return value;
    }

    // "-Y HEIGHT +X WIDTH" is left to right from the top. The axis that comes first is that of the scanlines;
    // X counts to the right, Y upwards.
    void readSize() {
        const std::string text(line());
        size_t sizes[2] = {};
        char axes[2] = {}, signs[2] = {}, more = 0;
        bool good = std::sscanf(text.c_str(), "%c%c %zu %c%c %zu%c", &signs[0], &axes[0], &sizes[0],
                                &signs[1], &axes[1], &sizes[1], &more) == 6;
        for (const char sign : signs) good = good && (sign == '+' || sign == '-');
        turned_ = axes[0] == 'X';
        if (!good || axes[turned_ ? 1 : 0] != 'Y' || axes[turned_ ? 0 : 1] != 'X')
            failDamaged("unsupported data layout");
        height_ = sizes[0];
        width_ = sizes[1];
        upwards_ = signs[turned_ ? 1 : 0] == '+';
        leftwards_ = signs[turned_ ? 0 : 1] == '-';
    }

    Image upright(Image stored) const {
        if (!turned_ && !upwards_ && !leftwards_) return stored;
        Image image(turned_ ? stored.height : stored.width, turned_ ? stored.width : stored.height, 3);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const int column = leftwards_ ? image.width - 1 - x : x;
                const int row = upwards_ ? image.height - 1 - y : y;
                for (int c = 0; c < 3; ++c)
                    image.at(x, y, c) = turned_ ? stored.at(row, column, c) : stored.at(column, row, c);
            }
        }
        return image;
    }

    void need(size_t bytes) const {
        if (file_.size() - position_ < bytes) throw CodecError("the file is truncated");
    }

    // Two bytes of 2, then the width: plain pixels that begin so would not be normalised.
    bool isRunLengthEncoded() const {
        if (width_ < kLeastRunWidth || width_ > kMostRunWidth) return false;
        need(4);
        const uint8_t* head = file_.data() + position_;
        return head[0] == 2 && head[1] == 2 && (head[2] & 0x80) == 0;
    }

    // The pixel (1, 1, 1, n), which is not normalised, stands for n more of the one before it; of several in
    // a row each counts 256 times as much as the one before.
    void readPlain(std::vector<uint8_t>& pixels) {
        constexpr uint8_t kRun[] = {1, 1, 1};
        size_t scale = 1;
        for (size_t x = 0; x < width_;) {
            need(4);
            const uint8_t* pixel = file_.data() + position_;
            position_ += 4;
            const bool run = std::equal(kRun, kRun + 3, pixel);
            const size_t count = run ? pixel[3] * scale : 1;
            if (count > width_ - x || (run && x == 0)) failDamaged("bad RLE data");
            for (size_t i = 0; i < count; ++i, ++x)
                std::copy_n(run ? &pixels[4 * (x - 1)] : pixel, 4, &pixels[4 * x]);
            scale = run ? std::min<size_t>(scale * 256, 1 << 24) : 1;
        }
    }

    void readRuns(std::vector<uint8_t>& pixels) {
        const size_t declared = static_cast<size_t>(file_[position_ + 2]) << 8 | file_[position_ + 3];
        if (declared != width_) failDamaged("scanline length");
        position_ += 4;
        for (size_t channel = 0; channel < 4; ++channel) {
            for (size_t x = 0; x < width_;) {
                need(2);  // a count, and a byte at least
                const uint8_t count = file_[position_++];
                const bool run = count > 128;
                const size_t length = run ? count - 128u : count;
                if (length == 0 || length > width_ - x) failDamaged("bad RLE data");
                need(run ? 1 : length);
                for (size_t i = 0; i < length; ++i)
                    pixels[4 * (x + i) + channel] = file_[position_ + (run ? 0 : i)];
                position_ += run ? 1 : length;
                x += length;
            }
        }
    }

    void convert(const std::vector<uint8_t>& pixels, float* samples) const {
        for (size_t x = 0; x < width_; ++x) {
            // The mantissas are 256ths, and 128 is the exponent of 1.
            const float unit = units_[pixels[4 * x + 3]];
            for (size_t c = 0; c < 3; ++c) samples[3 * x + c] = static_cast<float>(pixels[4 * x + c]) * unit;
        }
    }

    void makeUnits() {
        for (int e = 1; e < 256; ++e)  // exponent 0 is black
            units_[static_cast<size_t>(e)] =
                static_cast<float>(std::min(std::ldexp(1 / exposure_, e - 136), kMostUnit));
    }

    ByteView file_;
    uint64_t mostPixels_;
    const Context& context_;
    size_t position_ = 0;
    size_t width_ = 0, height_ = 0;
    double exposure_ = 1;
    bool turned_ = false, upwards_ = false, leftwards_ = false;
    std::array<float, 256> units_{};
};

}  // namespace

Image decodeHdr(ByteView file, uint64_t mostPixels, const Context& context) {
    return HdrReader(file, mostPixels, context).read();
}

}  // namespace glint
