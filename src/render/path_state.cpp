#include "render/path_state.h"

#include <algorithm>

namespace glint::render {

namespace {

uint32_t divideUp(uint32_t a, uint32_t b) {
    return (a + b - 1) / b;
}

// The bits of `lane` at positions 0, 2, 4 (Morton order), gathered.
uint32_t evenBits(uint32_t lane) {
    return (lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u);
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
    const uint32_t group = path / shared::kWorkgroupSize;
    const uint32_t lane = path % shared::kWorkgroupSize;
    const uint32_t offset = (group % run()) * interleave + group / run();
    if (offset >= tileCount) return false;
    const uint32_t tile = firstTile + offset;
    const uint32_t tilesX = divideUp(region.width(), shared::kTileSize);
    const int x = static_cast<int>(tile % tilesX * shared::kTileSize + evenBits(lane));
    const int y = static_cast<int>(tile / tilesX * shared::kTileSize + evenBits(lane >> 1));
    pixel = {region.x0 + x, region.y0 + y};
    return x < region.width() && y < region.height();
}

PathState::PathState(const gpu::Device& device, gpu::Access access, uint32_t capacity, uint32_t rows)
    : paths_(device, "path state", static_cast<uint64_t>(capacity) * rows * sizeof(RowEntry), access,
             gpu::MemoryKind::Device),
      capacity_(capacity),
      rows_(rows) {}

std::vector<RowEntry> PathState::readRow(const gpu::Device& device, uint32_t row, uint32_t count) const {
    std::vector<RowEntry> entries(count);
    gpu::download(device, paths_, std::as_writable_bytes(std::span(entries)),
                  static_cast<uint64_t>(row) * capacity_ * sizeof(RowEntry));
    return entries;
}

void PathState::writeRow(const gpu::Device& device, uint32_t row,
                         const std::vector<RowEntry>& entries) const {
    gpu::upload(device, paths_, std::as_bytes(std::span(entries)),
                static_cast<uint64_t>(row) * capacity_ * sizeof(RowEntry));
}

void PathState::writeEnded(const gpu::Device& device) const {
    constexpr size_t kPaths = shared::kWorkgroupSize;
    std::vector<RowEntry> entries(rows_ * kPaths, RowEntry{{0, 0, 0, 0}});
    for (size_t path = 0; path < kPaths; ++path) {
        entries[shared::kRowDirection * kPaths + path].f[3] = shared::kInfinity;
        entries[shared::kRowHit * kPaths + path].u[3] = shared::kNone;
    }
    gpu::upload(device, paths_, std::as_bytes(std::span(entries)));
}

void LivePaths::bounced(uint32_t alive) {
    if (alive >= running_) return;
    list_ ^= 1u;
    listed_ = true;
    running_ = alive;
}

uint32_t LivePaths::groups() const {
    return divideUp(running_, shared::kWorkgroupSize);
}

void LivePaths::writeTo(shared::Dispatch& dispatch) const {
    dispatch.listed = listed_ ? running_ : 0;
    dispatch.listRead = list_;
}

}  // namespace glint::render
