// Result of a tracer: colour for each pixel and, on request, layers of the pixel's first sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "core/device_layout.h"
#include "core/enum_names.h"
#include "core/image.h"

namespace glint {

// The pixels x0 <= x < x1, y0 <= y < y1, from the top left corner.
struct Region {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    uint64_t pixels() const { return static_cast<uint64_t>(width()) * static_cast<uint64_t>(height()); }
};

// Layers of a pixel's first sample (docs/reference/shading.md). On a miss indices are kNoIndex, depth is
// infinite and everything else 0.
struct PixelData {
    static constexpr uint32_t kNoIndex = 0xffffffffu;
    glm::dvec3 position{0};  // world
    double depth = std::numeric_limits<double>::infinity();
    glm::vec3 normal{0};           // outward shading normal
    glm::vec3 geometricNormal{0};  // outward
    float u = 0, v = 0;
    float clearance = 0;  // how far from the point, along its geometric normal, rays begin that leave it
    uint32_t object = kNoIndex;
    uint32_t primitive = kNoIndex;
    uint32_t material = kNoIndex;
    uint32_t bounces = 0;
    uint32_t cost = 0;
    uint32_t pathHash = 0;
    uint32_t shadowBits = 0;
};

// Branches of one kind that were not followed. Bounds are of the light that they could have added to the
// pixels, in any channel; infinite if no bound is known.
struct LostBranches {
    uint64_t count = 0;
    double sum = 0;       // over all pixels
    double greatest = 0;  // in one pixel
    void add(uint64_t branches, double bound) {
        count += branches;
        sum += bound;
        greatest = std::max(greatest, bound);
    }
    // Adds the counts of other pixels, whose bounds count `weight` times.
    void add(const LostBranches& other, double weight = 1) {
        count += other.count;
        sum += other.sum * weight;
        greatest = std::max(greatest, other.greatest * weight);
    }
};

// Branches of the ray tree that the image omits.
struct TreeLosses {
    LostBranches cut;    // below the request's least contribution
    LostBranches depth;  // beyond the depth limit
    LostBranches room;   // more than could wait at a time
    // Surfaces that a ray passed as if they were not there: it was in too many media.
    uint64_t crowdedMedia = 0;
    // Adds the counts of other pixels, whose bounds count `weight` times.
    void add(const TreeLosses& other, double weight = 1) {
        cut.add(other.cut, weight);
        depth.add(other.depth, weight);
        room.add(other.room, weight);
        crowdedMedia += other.crowdedMedia;
    }
};

// Flaws of an image's pixels.
struct PictureFlaws {
    uint64_t notFinite = 0;  // pixels whose colour is NaN or infinite
    // The first of them in reading order, in coordinates of the whole image; -1: none.
    glm::ivec2 firstNotFinite{-1};
    TreeLosses losses;  // of a device only if requested

    // Adds the flaws of other pixels.
    void add(const PictureFlaws& other);
};

struct Picture : PictureFlaws {
    Region region;
    Image color;                  // region-sized, 4 channels: linear radiance and alpha
    std::vector<PixelData> data;  // region-sized, rows top to bottom; empty unless requested
    // The reference's colours and alpha before rounding to `color`; empty unless requested (Request::exact).
    std::vector<glm::dvec4> exact;
    std::vector<uint8_t> done;  // per pixel: finished; all 1 unless the render was cancelled
    bool complete = true;
    std::vector<uint32_t> samples;  // per pixel, taken; empty if all pixels took samplesPerPixel
    uint32_t samplesPerPixel = 1;
    // Per pixel, of the greatest channel: its error by converge/converge.h; empty without one.
    std::vector<float> errors;

    // Counts the pixel if its colour is not finite.
    void checkFinite(int x, int y);

    // Array index of a pixel of the whole image.
    size_t indexOf(int x, int y) const {
        return static_cast<size_t>(y - region.y0) * region.width() + (x - region.x0);
    }
    const PixelData& at(int x, int y) const { return data[indexOf(x, y)]; }
    glm::dvec3 exactAt(int x, int y) const { return glm::dvec3(exact[indexOf(x, y)]); }
};

// Turns colours that are not finite black, whole pixels, so that no file holds NaN or infinity for a colour.
// Alpha, the count and the place stay.
void blackenNotFinite(Picture& picture);

// Layers of an image (docs/reference/shading.md).
enum class Aov {
    Radiance,
    Alpha,
    Depth,
    Position,
    Normal,
    Uv,
    ObjectId,
    PrimitiveId,
    MaterialId,
    Bounces,
    Cost,
    Error,
    Samples
};
constexpr auto entriesOf(Aov) {
    return std::to_array<EnumEntry<Aov>>({{Aov::Radiance, "color"},
                                          {Aov::Alpha, "alpha"},
                                          {Aov::Depth, "depth"},
                                          {Aov::Position, "position"},
                                          {Aov::Normal, "normal"},
                                          {Aov::Uv, "uv"},
                                          {Aov::ObjectId, "object"},
                                          {Aov::PrimitiveId, "primitive"},
                                          {Aov::MaterialId, "material"},
                                          {Aov::Bounces, "bounces"},
                                          {Aov::Cost, "cost"},
                                          {Aov::Error, "error"},
                                          {Aov::Samples, "samples"}});
}

// Radiance, Alpha and Samples are in every image, Error in one that was rendered to a given error; all others
// come from Picture::data.
constexpr bool needsData(Aov aov) {
    return aov != Aov::Radiance && aov != Aov::Alpha && aov != Aov::Error && aov != Aov::Samples;
}

// Layers of an image, under the names of the AOVs; black where it has no data for them.
std::vector<Layer> makeLayers(const Picture& picture, std::span<const Aov> aovs);

// ---- Paths

// A ray of one path, in local coordinates.
struct TrailRay {
    glm::dvec3 origin{0}, direction{0};
    double t = 0;                 // of the hit
    uint32_t id = shared::kNone;  // of the primitive; kNone: a miss
    glm::dvec3 throughput{1};     // before the ray, with the sample's weight
    glm::dvec3 sum{0};            // radiance of all earlier rays, with the sample's weight
};
using Trail = std::vector<TrailRay>;  // in the order in which a tracer followed them

}  // namespace glint
