#include "scene/sampling.h"

#include <algorithm>
#include <cmath>

#include "scene/limits.h"

namespace glint {

namespace {

double radicalInverse2(uint32_t i) {
    double value = 0;
    for (double digit = 0.5; i != 0; i >>= 1, digit *= 0.5) value += (i & 1) ? digit : 0.0;
    return value;
}

}  // namespace

Sampler samplerOf(const ImageSettings& image) {
    if (image.sampler != Sampler::Auto) return image.sampler;
    const bool many = image.samplesPerPixel >= kLeastLowDiscrepancySamples;
    return many || image.adaptive ? Sampler::LowDiscrepancy : Sampler::Grid;
}

double defaultRadius(Filter filter) {
    constexpr double kRadii[] = {0.5, 1, 1.5, 2};  // in the order of Filter
    return kRadii[static_cast<size_t>(filter)];
}

std::string samplingConflict(const ImageSettings& image) {
    const std::string samples = std::to_string(image.samplesPerPixel);
    if (image.filter == Filter::Mitchell && image.samplesPerPixel < kMinMitchellSamples)
        return "the mitchell filter needs samplesPerPixel of " + std::to_string(kMinMitchellSamples) +
               " or more, for its negative lobes (got " + samples + ")";
    if (!image.adaptive) return "";
    if (samplerOf(image) == Sampler::Grid)
        return "adaptive sampling needs the sampler \"jittered\" or \"lowDiscrepancy\": on the grid further "
               "samples fall on the first ones";
    if (image.samplesPerPixel < 2)
        return "adaptive sampling needs samplesPerPixel of 2 or more, to compare them (got " + samples + ")";
    if (image.adaptive->maxSamples < image.samplesPerPixel)
        return "adaptive sampling needs maxSamples of at least samplesPerPixel, which is " + samples +
               " (got " + std::to_string(image.adaptive->maxSamples) + ")";
    return "";
}

std::vector<glm::dvec2> sampleOffsets(int samplesPerPixel) {
    const int n = std::max(samplesPerPixel, 1);
    const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(n))));
    std::vector<glm::dvec2> offsets;
    offsets.reserve(n);
    for (int i = 0; i < n; ++i) {
        if (side * side == n) {
            offsets.emplace_back((i % side + 0.5) / side, (i / side + 0.5) / side);
        } else {
            offsets.emplace_back((i + 0.5) / n, radicalInverse2(static_cast<uint32_t>(i)) + 0.5 / n);
        }
    }
    return offsets;
}

}  // namespace glint
