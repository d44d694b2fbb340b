#include "core/similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"

namespace glint {

namespace {

constexpr int kWindow = 11;
constexpr double kDeviation = 1.5, kFirst = 0.01, kSecond = 0.03;

// IEC 61966-2-1:1999, section 5.2.
double encoded(double linear) {
    const double c = std::isfinite(linear) ? std::clamp(linear, 0.0, 1.0) : 0;
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
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
                       encoded(static_cast<double>(image.at(x, y, image.channels < 3 ? 0 : c)));
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
        throw Error(ErrorKind::Failed, "the pictures differ in size");
    const int across = a.width - kWindow + 1, down = a.height - kWindow + 1;
    if (across < 1 || down < 1) return std::numeric_limits<double>::quiet_NaN();
    constexpr int kBand = 64;  // rows at a time, for little memory
    double sum = 0;
    for (int y = 0; y < down; y += kBand) sum += sumOverWindows(a, b, y, std::min(y + kBand, down));
    return sum / (static_cast<double>(across) * down);
}

}  // namespace glint
