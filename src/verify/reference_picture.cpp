#include "verify/reference_picture.h"

#include <algorithm>

#include "core/parallel.h"
#include "reference/render.h"

namespace glint::verify {

namespace {

PixelData toData(const reference::PixelResult& pixel) {
    PixelData data;
    data.position = pixel.position;
    data.depth = pixel.depth;
    data.normal = glm::vec3(pixel.normal);
    data.geometricNormal = glm::vec3(pixel.normal);
    data.u = static_cast<float>(pixel.u);
    data.v = static_cast<float>(pixel.v);
    data.object = static_cast<uint32_t>(pixel.object);
    data.primitive = static_cast<uint32_t>(pixel.primitive);
    data.material = static_cast<uint32_t>(pixel.material);
    data.bounces = pixel.bounces;
    data.cost = static_cast<uint32_t>(std::min<uint64_t>(pixel.cost, 0xffffffffu));
    data.pathHash = pixel.pathHash;
    data.shadowBits = pixel.shadowBits;
    return data;
}

// Rows as many as make 64 k pixels, 17 MiB of results: beyond 32 MiB the allocator would hand the memory back
// to the system after each band, and page faults took a quarter of a simple picture's time. But enough that
// no thread waits long for the last row of a band.
int bandRows(int width) {
    constexpr int kBandPixels = 1 << 16;
    return std::max(kBandPixels / std::max(width, 1), static_cast<int>(4 * defaultThreadCount()));
}

void keepBand(const reference::RenderResult& band, size_t first, Picture& picture) {
    for (size_t i = 0; i < band.pixels.size(); ++i) {
        if (!band.rowsDone[i / band.width]) continue;
        const reference::PixelResult& pixel = band.pixels[i];
        float* color = &picture.color.pixels[(first + i) * 4];
        for (int c = 0; c < 3; ++c) color[c] = static_cast<float>(pixel.color[c]);
        color[3] = static_cast<float>(pixel.alpha);
        picture.losses.cut.add(pixel.lost.cut.count, pixel.lost.cut.bound);
        picture.losses.depth.add(pixel.lost.depth.count, pixel.lost.depth.bound);
        picture.losses.room.add(pixel.lost.room.count, pixel.lost.room.bound);
        picture.losses.crowdedMedia += pixel.lost.crowdedMedia;
        picture.checkFinite(band.x0 + static_cast<int>(i % band.width),
                            band.y0 + static_cast<int>(i / band.width));
        picture.done[first + i] = 1;
        if (!picture.samples.empty()) picture.samples[first + i] = pixel.samples;
        if (!picture.data.empty()) picture.data[first + i] = toData(pixel);
    }
}

}  // namespace

Picture renderReference(const PackedScene& scene, const shared::Camera& camera,
                        const render::RenderSettings& settings) {
    const Region region =
        settings.region.width() > 0 ? settings.region : Region{0, 0, settings.width, settings.height};
    const size_t pixels = static_cast<size_t>(region.width()) * region.height();
    Picture picture;
    picture.region = region;
    picture.color = Image(region.width(), region.height(), 4);
    picture.done.assign(pixels, 0);
    if (settings.data || settings.cost) picture.data.resize(pixels);
    reference::RenderOptions options;
    options.x0 = region.x0;
    options.x1 = region.x1;
    options.sampleOffsets = settings.sampleOffsets;
    options.samples = settings.samples;
    picture.samplesPerPixel =
        settings.samples ? settings.samples->count() : static_cast<uint32_t>(settings.sampleOffsets.size());
    if (settings.samples && settings.samples->threshold) picture.samples.assign(pixels, 0);
    options.aovs = !picture.data.empty();
    options.cancelled = settings.cancelled;
    const int rows = bandRows(region.width());
    for (int y = region.y0; y < region.y1 && picture.complete; y += rows) {
        options.y0 = y;
        options.y1 = std::min(y + rows, region.y1);
        if (settings.progress) {
            options.progress = [&](double fraction) {
                const double rowsDone = y - region.y0 + fraction * (options.y1 - options.y0);
                settings.progress(rowsDone / region.height());
            };
        }
        const reference::RenderResult band =
            reference::render(scene, camera, settings.width, settings.height, options);
        keepBand(band, static_cast<size_t>(y - region.y0) * region.width(), picture);
        picture.complete = band.complete;
    }
    return picture;
}

}  // namespace glint::verify
