#include "report/measures.h"

#include <algorithm>
#include <cmath>

#include "core/image_diff.h"
#include "verify/stiffness.h"

namespace glint::report {

ErrorMeasures measureError(const Image& picture, std::span<const glm::dvec3> truth,
                           std::span<const uint8_t> counts) {
    ErrorMeasures m;
    std::vector<float> greatest;
    greatest.reserve(truth.size());
    uint64_t visible = 0, small = 0;
    double squares = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        if (!counts.empty() && counts[i] == 0) continue;
        const float* pixel = &picture.pixels[i * static_cast<size_t>(picture.channels)];
        const glm::dvec3 d = glm::dvec3(pixel[0], pixel[1], pixel[2]) - truth[i];
        if (!std::isfinite(d.x + d.y + d.z)) {
            ++m.notFinite;
            continue;
        }
        const glm::dvec3 size = glm::abs(d);
        const double largest = std::max({size.x, size.y, size.z});
        ++m.pixels;
        const double square = glm::dot(d, d) / 3;
        m.rmse += square;
        squares += square * square;
        for (int c = 0; c < 3; ++c) m.relMse += d[c] * d[c] / (truth[i][c] * truth[i][c] + kRelativeFloor);
        m.bias += d.x + d.y + d.z;
        m.max = std::max(m.max, largest);
        visible += largest > 1.0 / 255 ? 1 : 0;
        small += largest > 1e-3 ? 1 : 0;
        greatest.push_back(static_cast<float>(largest));
    }
    if (m.pixels == 0) return m;
    const double pixels = static_cast<double>(m.pixels);
    const double mean = m.rmse / pixels;
    m.rmse = std::sqrt(mean);
    if (m.pixels > 1 && mean > 0) {
        const double variance = std::max(0.0, (squares / pixels - mean * mean) * pixels / (pixels - 1));
        m.rmseError = std::sqrt(variance / pixels) / (2 * m.rmse);
    }
    m.relMse /= 3 * pixels;
    m.bias /= 3 * pixels;
    m.p99 = verify::percentile99(std::move(greatest));
    m.percentVisible = 100 * static_cast<double>(visible) / pixels;
    m.percentSmall = 100 * static_cast<double>(small) / pixels;
    return m;
}

ArithmeticError measureArithmetic(const Image& picture, std::span<const uint32_t> paths,
                                  std::span<const glm::dvec3> truth, std::span<const uint32_t> truthPaths) {
    std::vector<uint8_t> same(truth.size()), other(truth.size());
    for (size_t i = 0; i < truth.size(); ++i) {
        same[i] = paths[i] == truthPaths[i] ? 1 : 0;
        other[i] = 1 - same[i];
    }
    return {measureError(picture, truth), measureError(picture, truth, same),
            measureError(picture, truth, other)};
}

}  // namespace glint::report
