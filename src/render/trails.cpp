#include "render/trails.h"

namespace glint::render {

namespace {

glm::dvec3 vectorOf(const RowEntry& entry) {
    return {entry.f[0], entry.f[1], entry.f[2]};
}

}  // namespace

uint64_t TrailRecorder::keyOf(const glm::ivec2& pixel) {
    return static_cast<uint64_t>(static_cast<uint32_t>(pixel.y)) << 32 | static_cast<uint32_t>(pixel.x);
}

TrailRecorder::TrailRecorder(const std::vector<glm::ivec2>& pixels) : trails_(pixels.size()) {
    for (size_t i = 0; i < pixels.size(); ++i) places_[keyOf(pixels[i])] = i;
}

void TrailRecorder::add(const PathState& paths, const gpu::Device& device, const Slice& slice) {
    const auto row = [&](uint32_t index) { return paths.readRow(device, index, slice.paths()); };
    const auto origins = row(shared::kRowOrigin), directions = row(shared::kRowDirection),
               hits = row(shared::kRowHit), throughputs = row(shared::kRowThroughput),
               sums = row(shared::kRowRadiance), walks = row(shared::kRowWalk);
    for (uint32_t path = 0; path < slice.paths(); ++path) {
        glm::ivec2 pixel;
        // A path that has ended keeps a ray whose interval is empty.
        if (!(directions[path].f[3] < shared::kInfinity) || !slice.pixelOf(path, pixel)) continue;
        const auto place = places_.find(keyOf(pixel));
        if (place == places_.end()) continue;
        TrailRay ray;
        ray.origin = vectorOf(origins[path]);
        ray.direction = vectorOf(directions[path]);
        ray.hit = hits[path].u[3] != shared::kNone;
        ray.t = hits[path].f[0];
        ray.id = walks[path].u[1];
        ray.throughput = vectorOf(throughputs[path]);
        ray.sum = vectorOf(sums[path]);
        trails_[place->second].push_back(ray);
    }
}

}  // namespace glint::render
