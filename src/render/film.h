// Colours, losses, layers and rays of a slice's pixels, from the path state.
#pragma once

#include <vector>

#include "render/kernels.h"
#include "render/path_state.h"
#include "trace/picture.h"

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

// Adds the rays of a bounce to their pixels' trails, after its closest hits and before its shading. The rows
// must hold AOVs.
void addRays(const PathState& paths, const gpu::Device& device, const Slice& slice,
             std::vector<Trail>& trails);

}  // namespace glint::render
