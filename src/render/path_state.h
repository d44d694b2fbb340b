// The state of all paths of a slice, on the device and as the host reads it back.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/device_layout.h"
#include "gpu/compute.h"
#include "render/kernels.h"
#include "trace/picture.h"

namespace glint::render {

// The tiles of a region that a slice covers, and the pixel of each of its paths: the host's side of pixelOf
// in shaders/storage.glsl. Tiles are dealt to `interleave` runs of workgroups.
struct Slice {
    Region region = {};
    uint32_t firstTile = 0;
    uint32_t tileCount = 0;
    uint32_t interleave = 1;

    static uint32_t tilesIn(const Region& region);
    uint32_t run() const;     // workgroups in each run
    uint32_t groups() const;  // workgroups to dispatch, at least tileCount
    // The tile of a workgroup, counted from firstTile; at least tileCount if it has none.
    uint32_t tileOf(uint32_t group) const { return group % run() * interleave + group / run(); }
    uint32_t paths() const { return groups() * shared::kWorkgroupSize; }
    // False for a path without a pixel (a tile past the end, or past the region's edge).
    bool pixelOf(uint32_t path, glm::ivec2& pixel) const;
    // Index of the pixel in arrays of the region's size.
    size_t indexOf(const glm::ivec2& pixel) const {
        return static_cast<size_t>(pixel.y - region.y0) * region.width() + (pixel.x - region.x0);
    }
};

// One 16-byte row entry of the path state.
union RowEntry {
    float f[4];
    uint32_t u[4];
};
static_assert(sizeof(RowEntry) == 16);

class PathState {
  public:
    PathState() = default;
    // Room for `capacity` paths of `rows` rows. Keeps a reference to `device`. Throws Error(Device) if that
    // does not fit.
    PathState(const gpu::Device& device, gpu::Access access, uint32_t capacity, uint32_t rows,
              gpu::MemoryKind memory = gpu::MemoryKind::Device);

    uint32_t capacity() const { return capacity_; }
    uint32_t rows() const { return rows_; }
    const gpu::Buffer& buffer() const { return paths_; }
    uint64_t rowBytes() const { return uint64_t{capacity_} * sizeof(RowEntry); }
    // The first `count` entries of a row; they may go on into the next rows.
    std::vector<RowEntry> readRow(uint32_t row, size_t count) const;
    void writeRow(uint32_t row, const std::vector<RowEntry>& entries) const;
    // Writes all rows of one workgroup's paths, for a dispatch with that capacity: ended, no hit, 0
    // elsewhere.
    void writeEnded() const;

  private:
    const gpu::Device* device_ = nullptr;
    gpu::Buffer paths_;
    uint32_t capacity_ = 0;
    uint32_t rows_ = 0;
};

// ---- Reading back a slice's pixels ----

// Fills color, done, notFinite and, if adaptive, samples of the slice's pixels.
void readFilm(const PathState& paths, const Slice& slice, const TraceModes& modes, Picture& picture);

// Adds up Picture::losses, of the rows kTreeRowLost... from `firstRow` on.
void readLosses(const PathState& paths, const Slice& slice, const TraceModes& modes, uint32_t firstRow,
                Picture& picture);

// Fills data.
void readData(const PathState& paths, const Slice& slice, const glm::dvec3& origin, Picture& picture);

// The layers of the first `count` paths, as read back (kRowAov...).
struct AovRows {
    std::vector<RowEntry> position, normal, indices, counts, geometry;

    AovRows(const PathState& paths, uint32_t count);
    PixelData at(uint32_t path, const glm::dvec3& origin) const;
};

// Adds the rays of a bounce to their pixels' trails, after its closest hits and before its shading. The rows
// must hold AOVs.
void addRays(const PathState& paths, const Slice& slice, std::vector<Trail>& trails);

}  // namespace glint::render
