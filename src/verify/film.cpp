#include "verify/film.h"

#include <algorithm>
#include <cmath>

#include "core/device_layout.h"
#include "core/vectors.h"
#include "reference/sampling.h"
#include "verify/quantities.h"

namespace glint::verify {

PackedSamples firstRounds(const PackedSamples& samples) {
    if (!samples.threshold) return samples;
    PackedSamples few = samples;
    const uint32_t count = std::min(samples.count(), 2 * samples.round);
    if (samples.scattered())
        few.rows.resize(shared::kFirstSample + count);
    else
        few.offsets.resize(count);
    return few;
}

Film::Film(const PackedSamples& samples, const Region& region, size_t lights)
    : samples_(samples), region_(region), lights_(static_cast<double>(lights)) {
    if (samples.count() == 1) return;
    first_.resize(static_cast<size_t>(region.width()) * region.height());
    if (samples.threshold) colors_.resize(first_.size());
}

void Film::add(uint32_t index, const Picture& sample) {
    if (index == samples_.round) all_ = first_;
    std::vector<Pixel>& pixels = index < samples_.round ? first_ : all_;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const float* color = &sample.color.pixels[4 * i];
        const glm::dvec4 taken(color[0], color[1], color[2], color[3]);
        Pixel& pixel = pixels[i];
        pixel.sum += taken;
        pixel.magnitudes += glm::abs(taken);
        // Adaptive images add whole samples; others add each light, and the hit's own light.
        pixel.additions += samples_.threshold ? 1 : (sample.data[i].bounces + 1) * (lights_ + 1);
        if (!samples_.threshold || index >= samples_.round) continue;
        const glm::ivec2 at = pixelAt(region_, i);
        const double weight = reference::filmSample(samples_, index, at.x, at.y).weight;
        colors_[i].push_back(glm::dvec3(taken) / weight);
    }
}

// True if a pixel of an adaptive image may take a further round, or may end. The device's sums are fp32:
// deviations, and so their root mean square, err by a few units of the greatest colour. If the standard error
// is that near to the threshold, both are right.
bool Film::mayTake(size_t pixel, bool further) const {
    double greatest = 0;
    for (const glm::dvec3& color : colors_[pixel]) greatest = std::max(greatest, greatestMagnitude(color));
    const double threshold = *samples_.threshold, least = threshold * shared::kDarkestMean;
    const double slack = 8 * kFloatUnit * samples_.round * (1 + greatest / least);
    return reference::needsMore(colors_[pixel], threshold * (further ? 1 - slack : 1 + slack)) == further;
}

// Each addition errs by a unit of the sum so far, within samples and over all samples; the count's inverse
// and the product add two more. Subnormal numbers err by more, and devices may flush them to 0.
bool Film::isMean(const Pixel& pixel, const float* color, uint32_t taken) const {
    const double units = kFloatUnit * (2 * pixel.additions + 4);
    const glm::dvec4 error =
        glm::abs(glm::dvec4(color[0], color[1], color[2], color[3]) * static_cast<double>(taken) - pixel.sum);
    return glm::all(glm::lessThanEqual(error, units * pixel.magnitudes + kUnderflow * taken));
}

std::vector<size_t> Film::differing(const Picture& whole) const {
    std::vector<size_t> pixels;
    for (size_t i = 0; i < first_.size(); ++i) {
        const uint32_t taken = whole.samples.empty() ? whole.samplesPerPixel : whole.samples[i];
        const bool further = taken > samples_.round;
        const bool sound = taken == (further ? samples_.count() : samples_.round) &&
                           (samples_.count() == samples_.round || mayTake(i, further)) &&
                           isMean(further ? all_[i] : first_[i], &whole.color.pixels[4 * i], taken);
        if (!sound) pixels.push_back(i);
    }
    return pixels;
}

void Account::addAlike(const TreeLosses& lost, double weight) {
    alike_.add(lost, weight);
    greatestWeight_ = std::max(greatestWeight_, weight);
}

void Account::addOther(uint32_t bounces, double weight) {
    const uint64_t branches = 2 * (uint64_t{bounces} + 1);
    other_.add(branches, static_cast<double>(branches) * radianceBound_ * weight);
    greatestWeight_ = std::max(greatestWeight_, weight);
}

// Counts are exact, except for pixels that decide differently. Bounds are products of weights: their sum must
// be right to a 256th, and each bound to a 16,384th of the greatest possible one. Near the greatest float the
// device may report infinity.
bool Account::agrees(const LostBranches& alike, const LostBranches& device, uint64_t otherwise) const {
    const uint64_t most = alike.count + other_.count + otherwise;
    if (device.count + otherwise < alike.count || device.count > most) return false;
    const double greatest = radianceBound_ * greatestWeight_;
    if (!(greatest * static_cast<double>(most) < 0x1p120)) return true;
    const double room = alike.sum / 256 + greatest * (0x1p-14 * static_cast<double>(device.count) +
                                                      static_cast<double>(otherwise));
    return device.sum >= alike.sum - room && device.sum <= alike.sum + room + other_.sum &&
           device.sum <= 1.001 * greatest * static_cast<double>(device.count);
}

bool Account::agrees(const TreeLosses& device, uint64_t otherwise) const {
    const uint64_t branches = 2 * otherwise;
    return agrees(alike_.cut, device.cut, branches) && agrees(alike_.depth, device.depth, branches) &&
           agrees(alike_.room, device.room, branches) &&
           device.crowdedMedia + otherwise >= alike_.crowdedMedia &&
           device.crowdedMedia <= alike_.crowdedMedia + other_.count / 2 + otherwise;
}

}  // namespace glint::verify
