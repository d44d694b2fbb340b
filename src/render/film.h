// Colours, losses and layers of a slice's pixels, and rays of chosen pixels, from the path state.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "render/kernels.h"
#include "render/path_state.h"
#include "trace/trail.h"

namespace glint::render {

// Fills color, done, notFinite and, if adaptive, samples of the slice's pixels.
void readFilm(const PathState& paths, const gpu::Device& device, const Slice& slice, const TraceModes& modes,
              Picture& picture);

// Adds up Picture::losses, of the rows kTreeRowLost... from `firstRow` on.
void readLosses(const PathState& paths, const gpu::Device& device, const Slice& slice,
                const TraceModes& modes, uint32_t firstRow, Picture& picture);

// Fills data.
void readData(const PathState& paths, const gpu::Device& device, const Slice& slice, const glm::dvec3& origin,
              Picture& picture);

// The layers of the first `count` paths, as read back (kRowAov...).
struct AovRows {
    std::vector<RowEntry> position, normal, indices, counts, geometry;

    AovRows(const PathState& paths, const gpu::Device& device, uint32_t count);
    PixelData at(uint32_t path, const glm::dvec3& origin) const;
};

// Reads back the rays of chosen pixels after each bounce.
class TrailRecorder {
  public:
    TrailRecorder(const std::vector<glm::ivec2>& pixels, const Region& region);
    // Narrows a slice of the region to the next tiles that hold chosen pixels; a tile's rays are the same
    // packets in each slice. False if no tile is left.
    bool narrow(Slice& slice) const;
    // Call after the closest hits of a bounce and before its shading; the rows must hold AOVs.
    void add(const PathState& paths, const gpu::Device& device, const Slice& slice);
    std::vector<Trail> take() { return std::move(trails_); }

  private:
    std::map<std::pair<int, int>, size_t> places_;  // in the trails, of (x, y)
    std::set<uint32_t> tiles_;                      // tiles that hold the pixels
    std::vector<Trail> trails_;
};

}  // namespace glint::render
