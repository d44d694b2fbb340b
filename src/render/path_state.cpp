#include "render/path_state.h"

#include <algorithm>
#include <limits>

namespace glint::render {

namespace {

uint32_t divideUp(uint32_t a, uint32_t b) {
    return (a + b - 1) / b;
}

// The bits of `lane` at positions 0, 2, 4 (Morton order), gathered.
uint32_t evenBits(uint32_t lane) {
    return (lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u);
}

glm::dvec3 vectorOf(const RowEntry& entry) {
    return {entry.f[0], entry.f[1], entry.f[2]};
}

// Calls visit(path, pixel) for each path that has a pixel.
template <typename Visit>
void eachPixel(const Slice& slice, const Visit& visit) {
    for (uint32_t path = 0; path < slice.paths(); ++path) {
        glm::ivec2 pixel;
        if (slice.pixelOf(path, pixel)) visit(path, pixel);
    }
}

}  // namespace

uint32_t Slice::tilesIn(const Region& region) {
    return divideUp(region.width(), shared::kTileSize) * divideUp(region.height(), shared::kTileSize);
}

uint32_t Slice::run() const {
    return std::max(1u, divideUp(tileCount, interleave));
}

uint32_t Slice::groups() const {
    return run() * interleave;
}

bool Slice::pixelOf(uint32_t path, glm::ivec2& pixel) const {
    const uint32_t lane = path % shared::kWorkgroupSize;
    const uint32_t offset = tileOf(path / shared::kWorkgroupSize);
    if (offset >= tileCount) return false;
    const uint32_t tile = firstTile + offset;
    const uint32_t tilesX = divideUp(region.width(), shared::kTileSize);
    const int x = static_cast<int>(tile % tilesX * shared::kTileSize + evenBits(lane));
    const int y = static_cast<int>(tile / tilesX * shared::kTileSize + evenBits(lane >> 1));
    pixel = {region.x0 + x, region.y0 + y};
    return x < region.width() && y < region.height();
}

PathState::PathState(const gpu::Device& device, gpu::Access access, uint32_t capacity, uint32_t rows,
                     gpu::MemoryKind memory)
    : device_(&device),
      paths_(device, "path state", uint64_t{capacity} * rows * sizeof(RowEntry), access, memory),
      capacity_(capacity),
      rows_(rows) {}

std::vector<RowEntry> PathState::readRow(uint32_t row, size_t count) const {
    std::vector<RowEntry> entries(count);
    gpu::download(*device_, paths_, std::as_writable_bytes(std::span(entries)), row * rowBytes());
    return entries;
}

void PathState::writeRow(uint32_t row, const std::vector<RowEntry>& entries) const {
    gpu::upload(*device_, paths_, std::as_bytes(std::span(entries)), row * rowBytes());
}

void PathState::writeEnded() const {
    constexpr size_t kPaths = shared::kWorkgroupSize;
    std::vector<RowEntry> entries(rows_ * kPaths, RowEntry{{0, 0, 0, 0}});
    for (size_t path = 0; path < kPaths; ++path) {
        entries[shared::kRowDirection * kPaths + path].f[3] = shared::kInfinity;
        entries[shared::kRowHit * kPaths + path].u[3] = shared::kNone;
    }
    writeRow(0, entries);
}

void readFilm(const PathState& paths, const Slice& slice, const TraceModes& modes, Picture& picture) {
    const uint32_t row = modes.adaptive ? shared::kRowFilm : shared::kRowRadiance;
    const std::vector<RowEntry> sums = paths.readRow(row, slice.paths());
    std::vector<RowEntry> means;
    if (modes.adaptive) means = paths.readRow(shared::kRowMean, slice.paths());
    eachPixel(slice, [&](uint32_t path, const glm::ivec2& pixel) {
        const size_t index = slice.indexOf(pixel);
        const uint32_t taken = modes.adaptive ? means[path].u[3] : picture.samplesPerPixel;
        const float scale = 1.0f / static_cast<float>(taken);
        float* color = &picture.color.pixels[index * 4];
        for (int c = 0; c < 3; ++c) color[c] = sums[path].f[c] * scale;
        color[3] = (modes.scattered ? sums[path].f[3] : static_cast<float>(sums[path].u[3])) * scale;
        picture.done[index] = 1;
        if (modes.adaptive) picture.samples[index] = taken;
        picture.checkFinite(pixel.x, pixel.y);
    });
}

void readData(const PathState& paths, const Slice& slice, const glm::dvec3& origin, Picture& picture) {
    const AovRows rows(paths, slice.paths());
    eachPixel(slice, [&](uint32_t path, const glm::ivec2& pixel) {
        picture.data[slice.indexOf(pixel)] = rows.at(path, origin);
    });
}

void readLosses(const PathState& paths, const Slice& slice, const TraceModes& modes, uint32_t firstRow,
                Picture& picture) {
    TreeLosses& losses = picture.losses;
    const auto sums = paths.readRow(firstRow + shared::kTreeRowLost, slice.paths());
    const auto counts = paths.readRow(firstRow + shared::kTreeRowLostCounts, slice.paths());
    eachPixel(slice, [&](uint32_t path, const glm::ivec2& pixel) {
        const uint32_t taken =
            modes.adaptive ? picture.samples[slice.indexOf(pixel)] : picture.samplesPerPixel;
        const double scale = 1.0 / std::max(taken, 1u);
        LostBranches* const kinds[] = {&losses.cut, &losses.depth, &losses.room};
        for (int kind = 0; kind < 3; ++kind) {
            const double bound = sums[path].f[kind];
            kinds[kind]->add(counts[path].u[kind], bound < shared::kInfinity
                                                       ? bound * scale
                                                       : std::numeric_limits<double>::infinity());
        }
        losses.crowdedMedia += counts[path].u[3];
    });
}

AovRows::AovRows(const PathState& paths, uint32_t count)
    : position(paths.readRow(shared::kRowAovPosition, count)),
      normal(paths.readRow(shared::kRowAovNormal, count)),
      indices(paths.readRow(shared::kRowAovIndices, count)),
      counts(paths.readRow(shared::kRowAovCounts, count)),
      geometry(paths.readRow(shared::kRowAovGeometry, count)) {}

PixelData AovRows::at(uint32_t path, const glm::dvec3& origin) const {
    PixelData data;
    data.object = indices[path].u[2];
    data.primitive = indices[path].u[3];
    if (data.object != shared::kNone) {
        data.position = origin + vectorOf(position[path]);
        data.depth = position[path].f[3];
    }
    data.normal = vectorOf(normal[path]);
    data.geometricNormal = vectorOf(geometry[path]);
    data.clearance = geometry[path].f[3];
    data.material = normal[path].u[3];
    data.u = indices[path].f[0];
    data.v = indices[path].f[1];
    data.bounces = counts[path].u[0];
    data.cost = counts[path].u[1];
    data.shadowBits = counts[path].u[2];
    data.pathHash = counts[path].u[3];
    return data;
}

void addRays(const PathState& paths, const Slice& slice, std::vector<Trail>& trails) {
    const auto row = [&](uint32_t index) { return paths.readRow(index, slice.paths()); };
    const auto origins = row(shared::kRowOrigin), directions = row(shared::kRowDirection),
               hits = row(shared::kRowHit), throughputs = row(shared::kRowThroughput),
               sums = row(shared::kRowRadiance), walks = row(shared::kRowWalk);
    eachPixel(slice, [&](uint32_t path, const glm::ivec2& pixel) {
        // A path that has ended keeps a ray whose interval is empty.
        if (!(directions[path].f[3] < shared::kInfinity)) return;
        TrailRay& ray = trails[slice.indexOf(pixel)].emplace_back();
        ray.origin = vectorOf(origins[path]);
        ray.direction = vectorOf(directions[path]);
        if (hits[path].u[3] != shared::kNone) {
            ray.t = hits[path].f[0];
            ray.id = walks[path].u[1];
        }
        ray.throughput = vectorOf(throughputs[path]);
        ray.sum = vectorOf(sums[path]);
    });
}

}  // namespace glint::render
