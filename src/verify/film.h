// Compares a device's totals of an image: the sum of its samples, and the branches that it did not follow.
#pragma once

#include <vector>

#include "render/renderer.h"
#include "trace/picture.h"

namespace glint::verify {

// The first round of samples; of adaptive images the first two, enough to check which pixels take another
// round.
PackedSamples firstRounds(const PackedSamples& samples);

// The pixel of an index into arrays of the region's size.
inline glm::ivec2 pixelAt(const Region& region, size_t index) {
    const auto width = static_cast<size_t>(region.width());
    return {region.x0 + static_cast<int>(index % width), region.y0 + static_cast<int>(index / width)};
}

// Adds samples up in double precision, pixel by pixel.
class Film {
  public:
    // `region`: its pixels. lights: at most so many add to a sample at each hit.
    Film(const PackedSamples& samples, const Region& region, size_t lights);

    // In the order of the indices; samples of the first round with data.
    void add(uint32_t index, const Picture& sample);

    // Indices of the pixels of `whole`, rendered with the constructor's samples, that took a wrong number of
    // samples or differ from their mean.
    std::vector<size_t> differing(const Picture& whole) const;

  private:
    struct Pixel {
        glm::dvec4 sum{0}, magnitudes{0};
        double additions = 0;  // that the device makes for the sum
    };
    bool mayTake(size_t pixel, bool further) const;
    bool isMean(const Pixel& pixel, const float* color, uint32_t taken) const;

    const PackedSamples& samples_;
    Region region_;
    double lights_;
    std::vector<Pixel> first_, all_;               // after one round, and after all
    std::vector<std::vector<glm::dvec3>> colors_;  // of the first round, of adaptive pictures
};

// Account of the losses of an image's rays: branches that were not followed, and media for which a ray had no
// room. The device reports the sum over all pixels.
class Account {
  public:
    // radianceBound: Environment::radianceBound, the scale of branches' bounds.
    explicit Account(double radianceBound) : radianceBound_(radianceBound) {}

    // Adds a pixel whose rays hit the same primitives on device and reference: it loses the same branches.
    void addAlike(const TreeLosses& lost, double weight);
    // Adds a pixel whose rays hit others. Each hit loses at most two branches, and one medium.
    void addOther(uint32_t bounces, double weight);

    // otherwise: number of pixels alike whose branches may differ from the reference's, at the limit of total
    // reflection or the edge of a mirroring square of a checker.
    bool agrees(const TreeLosses& device, uint64_t otherwise) const;

  private:
    bool agrees(const LostBranches& alike, const LostBranches& device, uint64_t otherwise) const;

    double radianceBound_;
    TreeLosses alike_;
    LostBranches other_;  // at most, of any kind
    double greatestWeight_ = 0;
};

}  // namespace glint::verify
