// Radiance pictures (G. Ward, "Real Pixels", Graphics Gems II, 1991; the Radiance reference manual, "File
// Formats"): a text header that an empty line ends, a line with the size, then scanlines from the top of RGBE
// pixels, plain or with each byte of the four in runs of its own. The older runs, of whole pixels, are not
// read: no program of this century writes them, and plain pixels may look like them.
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/codecs.h"

namespace glint {
namespace {

constexpr size_t kLeastRunWidth = 8, kMostRunWidth = 32767;

class HdrReader {
  public:
    HdrReader(ByteView file, uint64_t mostPixels) : file_(file), mostPixels_(mostPixels) {}

    Image read() {
        readHeader();
        readSize();
        // A run of 127 bytes takes two, and a pixel has four.
        checkDeclaredSize(width_, height_, file_.size(), 127.0 / 8, mostPixels_);
        RowCollector rows(static_cast<int>(width_), static_cast<int>(height_), 3);
        std::vector<uint8_t> pixels(4 * width_);
        for (size_t y = 0; y < height_; ++y) {
            if (isRunLengthEncoded())
                readRuns(pixels);
            else
                readPlain(pixels);
            convert(pixels, rows.next());
        }
        return rows.take();
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
        if (magic != "#?RADIANCE" && magic != "#?RGBE")
            throw CodecError("the file is damaged or of a kind that is not supported (not HDR)");
        bool known = false;
        for (std::string_view text = line(); !text.empty(); text = line())
            known = known || text == "FORMAT=32-bit_rle_rgbe";
        if (!known)
            throw CodecError("the file is damaged or of a kind that is not supported (unsupported format)");
    }

    // Left to right, from the top; pictures that are stored turned or mirrored are refused.
    void readSize() {
        const std::string_view text = line();
        const char* at = text.data();
        const char* const end = at + text.size();
        const auto number = [&](std::string_view axis, size_t& value) {
            if (std::string_view(at, static_cast<size_t>(end - at)).substr(0, axis.size()) != axis)
                return false;
            const auto [stop, error] = std::from_chars(at + axis.size(), end, value);
            at = stop;
            return error == std::errc{};
        };
        if (!number("-Y ", height_) || !number(" +X ", width_) || at != end)
            throw CodecError(
                "the file is damaged or of a kind that is not supported (unsupported data layout)");
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

    void readPlain(std::vector<uint8_t>& pixels) {
        need(pixels.size());
        const auto begin = file_.begin() + static_cast<std::ptrdiff_t>(position_);
        std::copy(begin, begin + static_cast<std::ptrdiff_t>(pixels.size()), pixels.begin());
        position_ += pixels.size();
    }

    void readRuns(std::vector<uint8_t>& pixels) {
        const size_t declared = static_cast<size_t>(file_[position_ + 2]) << 8 | file_[position_ + 3];
        if (declared != width_)
            throw CodecError("the file is damaged or of a kind that is not supported (scanline length)");
        position_ += 4;
        for (size_t channel = 0; channel < 4; ++channel) {
            for (size_t x = 0; x < width_;) {
                need(2);  // a count, and a byte at least
                const uint8_t count = file_[position_++];
                const bool run = count > 128;
                const size_t length = run ? count - 128u : count;
                if (length == 0 || length > width_ - x)
                    throw CodecError("the file is damaged or of a kind that is not supported (bad RLE data)");
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

    static std::array<float, 256> makeUnits() {
        std::array<float, 256> units{};  // exponent 0 is black
        for (int e = 1; e < 256; ++e) units[static_cast<size_t>(e)] = std::ldexp(1.0f, e - 136);
        return units;
    }

    ByteView file_;
    uint64_t mostPixels_;
    size_t position_ = 0;
    size_t width_ = 0, height_ = 0;
    std::array<float, 256> units_ = makeUnits();
};

}  // namespace

Image decodeHdr(ByteView file, uint64_t mostPixels) {
    return HdrReader(file, mostPixels).read();
}

}  // namespace glint
