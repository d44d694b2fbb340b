#include "core/image_diff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "core/error.h"
#include "core/quantize.h"

namespace glint {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string sizeText(const Image& image) {
    return std::to_string(image.width) + "x" + std::to_string(image.height);
}

// The channels to compare; throws if the two images cannot be compared at all.
int comparedChannels(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) {
        throw Error(ErrorKind::Failed, "the images differ in size: " + sizeText(a) + " and " + sizeText(b));
    }
    const int channelsA = std::min(3, a.channels);
    const int channelsB = std::min(3, b.channels);
    if (channelsA != channelsB && channelsA != 1 && channelsB != 1) {
        throw Error(ErrorKind::Failed, "the images differ in channels: " + std::to_string(a.channels) +
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
    double signedSum = 0, squareSum = 0, relativeSum = 0;
    uint64_t finiteSamples = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            double difference = 0;  // greatest difference of the pixel
            bool finiteA = true, finiteB = true;
            for (int c = 0; c < channels; ++c) {
                const float sampleA = sample(a, x, y, c), sampleB = sample(b, x, y, c);
                difference = std::max(difference, sampleDifference(sampleA, sampleB));
                finiteA = finiteA && std::isfinite(sampleA);
                finiteB = finiteB && std::isfinite(sampleB);
            }
            result.max = std::max(result.max, difference);
            result.above += difference > tolerance ? 1 : 0;
            result.notFinite += finiteA != finiteB ? 1 : 0;
            if (difference > 0) result.worst.push_back({x, y, static_cast<float>(difference)});
            for (int c = 0; c < channels && finiteA && finiteB; ++c) {
                const auto truth = static_cast<double>(sample(a, x, y, c));
                const double delta = static_cast<double>(sample(b, x, y, c)) - truth;
                signedSum += delta;
                squareSum += delta * delta;
                relativeSum += delta * delta / (truth * truth + kRelativeFloor);
                ++finiteSamples;
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

namespace {

constexpr int kWindow = 11;
constexpr double kDeviation = 1.5, kFirst = 0.01, kSecond = 0.03;

// The linear value that a screen shows.
double shownOf(float linear) {
    return std::isfinite(linear) ? std::clamp(static_cast<double>(linear), 0.0, 1.0) : 0;
}

using Plane = std::vector<double>;  // row by row

// Luma of rows y0 <= y < y1.
Plane lumaOf(const Image& image, int y0, int y1) {
    constexpr std::array kShares = {0.299, 0.587, 0.114};
    Plane luma;
    luma.reserve(static_cast<size_t>(image.width) * static_cast<size_t>(y1 - y0));
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < image.width; ++x) {
            double sum = 0;
            for (int c = 0; c < 3; ++c)
                sum += kShares[static_cast<size_t>(c)] *
                       srgbFromLinear(shownOf(image.at(x, y, image.channels < 3 ? 0 : c)));
            luma.push_back(sum);
        }
    }
    return luma;
}

std::array<double, kWindow> weights() {
    std::array<double, kWindow> all{};
    double sum = 0;
    for (int i = 0; i < kWindow; ++i)
        sum += all[static_cast<size_t>(i)] = std::exp(-std::pow((i - kWindow / 2) / kDeviation, 2) / 2);
    for (double& w : all) w /= sum;
    return all;
}

// The weighted means of all windows inside: first along rows, then along columns.
Plane windowMeans(const Plane& plane, int width, int height) {
    const std::array<double, kWindow> w = weights();
    const int across = width - kWindow + 1, down = height - kWindow + 1;
    const auto at = [](int x, int y, int stride) {
        return static_cast<size_t>(y) * static_cast<size_t>(stride) + static_cast<size_t>(x);
    };
    Plane rows(at(0, height, across)), means(at(0, down, across));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < across; ++x)
            for (int i = 0; i < kWindow; ++i)
                rows[at(x, y, across)] += w[static_cast<size_t>(i)] * plane[at(x + i, y, width)];
    for (int y = 0; y < down; ++y)
        for (int i = 0; i < kWindow; ++i)
            for (int x = 0; x < across; ++x)
                means[at(x, y, across)] += w[static_cast<size_t>(i)] * rows[at(x, y + i, across)];
    return means;
}

Plane product(const Plane& a, const Plane& b) {
    Plane all(a.size());
    for (size_t i = 0; i < a.size(); ++i) all[i] = a[i] * b[i];
    return all;
}

// Over the windows whose first rows are y0 <= y < y1.
double sumOverWindows(const Image& a, const Image& b, int y0, int y1) {
    const int rows = y1 - y0 + kWindow - 1;
    const Plane x = lumaOf(a, y0, y0 + rows), y = lumaOf(b, y0, y0 + rows);
    const auto means = [&](const Plane& plane) { return windowMeans(plane, a.width, rows); };
    const Plane mx = means(x), my = means(y);
    const Plane xx = means(product(x, x)), yy = means(product(y, y)), xy = means(product(x, y));
    constexpr double c1 = kFirst * kFirst, c2 = kSecond * kSecond;
    double sum = 0;
    for (size_t i = 0; i < mx.size(); ++i) {
        const double both = mx[i] * my[i], squares = mx[i] * mx[i] + my[i] * my[i];
        sum +=
            (2 * both + c1) * (2 * (xy[i] - both) + c2) / ((squares + c1) * (xx[i] + yy[i] - squares + c2));
    }
    return sum;
}

}  // namespace

double structuralSimilarity(const Image& a, const Image& b) {
    if (b.width != a.width || b.height != a.height)
        throw Error(ErrorKind::Failed, "the images differ in size");
    const int across = a.width - kWindow + 1, down = a.height - kWindow + 1;
    if (across < 1 || down < 1) return std::numeric_limits<double>::quiet_NaN();
    constexpr int kBand = 64;  // rows at a time, for little memory
    double sum = 0;
    for (int y = 0; y < down; y += kBand) sum += sumOverWindows(a, b, y, std::min(y + kBand, down));
    return sum / (static_cast<double>(across) * down);
}

}  // namespace glint
