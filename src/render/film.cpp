#include "render/film.h"

#include <cmath>

namespace glint::render {

void readFilm(const PathState& paths, const gpu::Device& device, const Slice& slice, const TraceModes& modes,
              Picture& picture) {
    const uint32_t row = modes.adaptive ? shared::kRowFilm : shared::kRowRadiance;
    const std::vector<RowEntry> sums = paths.readRow(device, row, slice.paths());
    std::vector<RowEntry> means;
    if (modes.adaptive) means = paths.readRow(device, shared::kRowMean, slice.paths());
    for (uint32_t path = 0; path < slice.paths(); ++path) {
        glm::ivec2 pixel;
        if (!slice.pixelOf(path, pixel)) continue;
        const size_t index = slice.indexOf(pixel);
        const uint32_t taken = modes.adaptive ? means[path].u[3] : picture.samplesPerPixel;
        const float scale = 1.0f / static_cast<float>(taken);
        float* color = &picture.color.pixels[index * 4];
        for (int c = 0; c < 3; ++c) color[c] = sums[path].f[c] * scale;
        color[3] = (modes.scattered ? sums[path].f[3] : static_cast<float>(sums[path].u[3])) * scale;
        picture.done[index] = 1;
        if (modes.adaptive) picture.samples[index] = taken;
        picture.checkFinite(pixel.x, pixel.y);
    }
}

}  // namespace glint::render
