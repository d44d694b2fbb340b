#include "core/image_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "core/error.h"

namespace glint {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string sizeText(const Image& image) {
    return std::to_string(image.width) + "x" + std::to_string(image.height);
}

// The channels to compare; throws if the two pictures cannot be compared at all.
int comparedChannels(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) {
        throw Error(ErrorKind::Failed, "the pictures differ in size: " + sizeText(a) + " and " + sizeText(b));
    }
    const int channelsA = std::min(3, a.channels);
    const int channelsB = std::min(3, b.channels);
    if (channelsA != channelsB && channelsA != 1 && channelsB != 1) {
        throw Error(ErrorKind::Failed, "the pictures differ in channels: " + std::to_string(a.channels) +
                                           " and " + std::to_string(b.channels));
    }
    return std::max(channelsA, channelsB);
}

float sample(const Image& image, int x, int y, int channel) {
    return image.at(x, y, image.channels == 1 ? 0 : channel);
}

// |a - b|. Two samples of the same kind of not finite (both NaN, or the same infinity) are equal.
double sampleDifference(float a, float b) {
    if (std::isfinite(a) && std::isfinite(b)) {
        return std::abs(static_cast<double>(a) - static_cast<double>(b));
    }
    const bool same = (std::isnan(a) && std::isnan(b)) || a == b;
    return same ? 0.0 : kInfinity;
}

struct PixelSums {
    double difference = 0;  // greatest
    double signedSum = 0;   // of b - a
    double squareSum = 0;
    double relativeSum = 0;
    bool finiteA = true;
    bool finiteB = true;
};

PixelSums comparePixel(const Image& a, const Image& b, int x, int y, int channels) {
    PixelSums sums;
    for (int c = 0; c < channels; ++c) {
        const float sampleA = sample(a, x, y, c);
        const float sampleB = sample(b, x, y, c);
        const double delta = static_cast<double>(sampleB) - static_cast<double>(sampleA);
        sums.difference = std::max(sums.difference, sampleDifference(sampleA, sampleB));
        sums.signedSum += delta;
        sums.squareSum += delta * delta;
        const auto truth = static_cast<double>(sampleA);
        sums.relativeSum += delta * delta / (truth * truth + kRelativeFloor);
        sums.finiteA = sums.finiteA && std::isfinite(sampleA);
        sums.finiteB = sums.finiteB && std::isfinite(sampleB);
    }
    return sums;
}

bool isWorse(const PixelDifference& a, const PixelDifference& b) {
    return std::make_tuple(-a.difference, a.y, a.x) < std::make_tuple(-b.difference, b.y, b.x);
}

// Keeps the `count` worst, worst first.
void keepWorst(std::vector<PixelDifference>& differences, size_t count) {
    const auto kept = static_cast<std::ptrdiff_t>(std::min(count, differences.size()));
    std::partial_sort(differences.begin(), differences.begin() + kept, differences.end(), isWorse);
    differences.resize(static_cast<size_t>(kept));
    differences.shrink_to_fit();
}

}  // namespace

ImageDifference compareImages(const Image& a, const Image& b, double tolerance, size_t worstCount) {
    const int channels = comparedChannels(a, b);
    ImageDifference result;
    double signedSum = 0;
    double squareSum = 0;
    double relativeSum = 0;
    uint64_t finiteSamples = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const PixelSums sums = comparePixel(a, b, x, y, channels);
            result.max = std::max(result.max, sums.difference);
            result.above += sums.difference > tolerance ? 1 : 0;
            result.notFinite += sums.finiteA != sums.finiteB ? 1 : 0;
            if (sums.finiteA && sums.finiteB) {
                signedSum += sums.signedSum;
                squareSum += sums.squareSum;
                relativeSum += sums.relativeSum;
                finiteSamples += static_cast<uint64_t>(channels);
            }
            if (sums.difference > 0) {
                result.worst.push_back({x, y, static_cast<float>(sums.difference)});
            }
        }
    }
    result.pixels = static_cast<uint64_t>(a.width) * static_cast<uint64_t>(a.height);
    if (finiteSamples > 0) {
        result.rmse = std::sqrt(squareSum / static_cast<double>(finiteSamples));
        result.relMse = relativeSum / static_cast<double>(finiteSamples);
        result.mean = signedSum / static_cast<double>(finiteSamples);
    }
    result.psnr = result.rmse > 0 ? -20.0 * std::log10(result.rmse) : kInfinity;
    keepWorst(result.worst, worstCount);
    return result;
}

Image differenceImage(const Image& a, const Image& b, float gain) {
    const int channels = comparedChannels(a, b);
    Image result(a.width, a.height, 3);
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const int from = channels == 1 ? 0 : c;
                if (from < channels) {
                    const double difference = sampleDifference(sample(a, x, y, from), sample(b, x, y, from));
                    result.at(x, y, c) = static_cast<float>(difference * static_cast<double>(gain));
                }
            }
        }
    }
    return result;
}

}  // namespace glint
