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

// Which tiles of a region a slice covers, and which pixel each of its paths belongs to: the host's side of
// pixelOf in shaders/storage.glsl.
struct Slice {
    Region region;
    uint32_t firstTile = 0;
    uint32_t tileCount = 0;
    uint32_t interleave = 1;

    static uint32_t tilesIn(const Region& region);
    uint32_t run() const;     // workgroups in each of the `interleave` runs
    uint32_t groups() const;  // workgroups to dispatch, at least tileCount
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
    // Room for `capacity` paths of `rows` rows. Throws Error(Device) if that does not fit.
    PathState(const gpu::Device& device, gpu::Access access, uint32_t capacity, uint32_t rows);

    uint32_t capacity() const { return capacity_; }
    uint32_t rows() const { return rows_; }
    const gpu::Buffer& buffer() const { return paths_; }
    std::vector<RowEntry> readRow(const gpu::Device& device, uint32_t row, uint32_t count) const;
    void writeRow(const gpu::Device& device, uint32_t row, const std::vector<RowEntry>& entries) const;
    // All rows of the paths of one workgroup, as a dispatch whose capacity these are finds them: ended, with
    // nothing hit, and all else 0.
    void writeEnded(const gpu::Device& device) const;

  private:
    gpu::Buffer paths_;
    uint32_t capacity_ = 0;
    uint32_t rows_ = 0;
};

// All paths of a slice until one has ended, then the paths in the list that `shade` wrote.
class LivePaths {
  public:
    explicit LivePaths(uint32_t paths) : running_(paths) {}

    // Call after each bounce; `alive` paths continue.
    void bounced(uint32_t alive);
    // Workgroups to dispatch.
    uint32_t groups() const;
    // Writes the arguments that select these paths in the kernels.
    void writeTo(shared::Dispatch& dispatch) const;

  private:
    uint32_t running_;  // invocations that have a path, alive or not
    bool listed_ = false;
    uint32_t list_ = 0;  // the list that is read, if listed
};

// ---- Reading back a slice's pixels ----

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
