#include "core/quantize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glint {
namespace {

// pow() for every sample costs more than compressing the file, so the byte is looked up, exactly: byte k
// begins at the linear value decode((k - 0.5) / 255), and the bucket that a sample falls into names the byte
// at the bucket's start.
class SrgbTable {
  public:
    SrgbTable() {
        for (int k = 0; k <= 254; ++k) {
            upper_[static_cast<size_t>(k)] = linearFromSrgb((k + 0.5) / 255.0);
        }
        upper_[255] = std::numeric_limits<double>::infinity();
        int byte = 0;
        for (int bucket = 0; bucket < kBuckets; ++bucket) {
            byte = searchFrom(byte, static_cast<double>(bucket) / kBuckets);
            start_[static_cast<size_t>(bucket)] = static_cast<uint8_t>(byte);
        }
    }

    // For 0 <= linear < 1.
    uint8_t byte(double linear) const {
        const auto bucket = static_cast<size_t>(linear * kBuckets);
        return static_cast<uint8_t>(searchFrom(start_[bucket], linear));
    }

  private:
    // The curve's greatest slope is 12.92, at black: 255 * 12.92 / 4096 = 0.8 bytes per bucket, so a search
    // from the bucket's start takes one step at most.
    static constexpr int kBuckets = 4096;

    int searchFrom(int byte, double linear) const {
        while (linear >= upper_[static_cast<size_t>(byte)]) {
            ++byte;
        }
        return byte;
    }

    std::array<double, 256> upper_{};  // byte k ends here
    std::array<uint8_t, kBuckets> start_{};
};

struct Range {
    double min = 0;
    double max = 0;
};

Range finiteRange(const std::vector<float>& samples) {
    Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (float sample : samples) {
        if (std::isfinite(sample)) {
            range.min = std::min(range.min, static_cast<double>(sample));
            range.max = std::max(range.max, static_cast<double>(sample));
        }
    }
    return range;
}

}  // namespace

double linearFromSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgbFromLinear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

uint8_t srgbByte(float linear) {
    static const SrgbTable table;
    if (!(linear > 0.0f)) {  // NaN too
        return 0;
    }
    return linear >= 1.0f ? uint8_t{255} : table.byte(static_cast<double>(linear));
}

uint8_t linearByte(double value) {
    if (!(value > 0.0)) {  // NaN too
        return 0;
    }
    return static_cast<uint8_t>(std::lround(255.0 * std::min(value, 1.0)));
}

std::vector<uint8_t> quantizeColor(const Image& image) {
    std::vector<uint8_t> bytes(image.pixels.size());
    const auto channels = static_cast<size_t>(image.channels);
    for (size_t i = 0; i < bytes.size(); ++i) {
        const bool isAlpha = channels == 4 && i % 4 == 3;
        bytes[i] = isAlpha ? linearByte(static_cast<double>(image.pixels[i])) : srgbByte(image.pixels[i]);
    }
    return bytes;
}

std::vector<uint8_t> quantizeData(const Image& image) {
    Range range = finiteRange(image.pixels);
    if (range.min > range.max) range = {0, 0};  // no finite sample
    const double extent = range.max - range.min;
    const auto from = static_cast<size_t>(image.channels), to = from == 2 ? 3 : from;
    std::vector<uint8_t> bytes(image.pixels.size() / from * to, 0);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        bytes[i / from * to + i % from] =
            linearByte((static_cast<double>(image.pixels[i]) - range.min) / extent);
    return bytes;
}

}  // namespace glint
