#include "reference/render.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "core/parallel.h"
#include "reference/sampling.h"

namespace glint::reference {
namespace {

using glm::dvec3;

constexpr int kPixelsPerPoll =
    64;  // between two looks at `cancelled`: 64 pixels take well below a tenth of a second

void keepAovs(const PackedScene& scene, const PixelRecord& record, PixelResult& pixel) {
    pixel.bounces = record.bounces;
    pixel.cost = record.cost;
    pixel.pathHash = record.pathHash;
    pixel.shadowBits = record.shadowBits;
    pixel.hit = record.hit;
    if (!record.hit) return;
    pixel.depth = record.hit->t;
    pixel.u = record.hit->u;
    pixel.v = record.hit->v;
    pixel.position = scene.origin + record.surface->position;
    pixel.normal = record.surface->shadingNormal;
    pixel.object = static_cast<int32_t>(record.surface->object);
    pixel.primitive = static_cast<int32_t>(record.surface->primitive);
    pixel.material = static_cast<int32_t>(record.surface->material);
}

void addLosses(const Losses& sample, Losses& pixel) {
    for (const auto kind : {&Losses::cut, &Losses::depth, &Losses::room}) {
        (pixel.*kind).count += (sample.*kind).count;
        (pixel.*kind).bound += (sample.*kind).bound;
    }
    pixel.crowdedMedia += sample.crowdedMedia;
}

PixelResult renderPixel(const PackedScene& scene, const Tracer& tracer, const shared::Camera& camera, int x,
                        int y, const PackedSamples& samples, bool aovs) {
    PixelResult pixel;
    std::vector<dvec3> colors;  // of an adaptive pixel
    const uint32_t most = samples.count();
    while (pixel.samples < most) {
        const FilmSample s =
            filmSample(samples, pixel.samples, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
        const PixelRecord record =
            tracer.trace(tracer.cameraRay(camera, x + s.offset.x, y + s.offset.y, s.lens));
        pixel.color += s.weight * record.color;
        pixel.alpha += s.weight * record.alpha;
        addLosses(record.lost, pixel.lost);
        if (pixel.samples == 0 && aovs) keepAovs(scene, record, pixel);
        ++pixel.samples;
        if (!samples.threshold) continue;
        colors.push_back(record.color);
        if (pixel.samples % samples.round == 0 && !needsMore(colors, *samples.threshold)) break;
    }
    const double taken = std::max(pixel.samples, 1u);
    pixel.color /= taken;
    pixel.alpha /= taken;
    for (const auto kind : {&Losses::cut, &Losses::depth, &Losses::room}) (pixel.lost.*kind).bound /= taken;
    return pixel;
}

}  // namespace

RenderResult render(const PackedScene& scene, const shared::Camera& camera, int width, int height,
                    const RenderOptions& options) {
    RenderResult result;
    result.x0 = std::clamp(options.x0, 0, width);
    result.y0 = std::clamp(options.y0, 0, height);
    const int x1 = options.x1 < 0 ? width : std::clamp(options.x1, result.x0, width);
    const int y1 = options.y1 < 0 ? height : std::clamp(options.y1, result.y0, height);
    result.width = std::max(x1 - result.x0, 0);
    result.height = std::max(y1 - result.y0, 0);
    result.pixels.resize(static_cast<size_t>(result.width) * result.height);
    result.rowsDone.resize(result.height, 0);

    const Tracer tracer(scene);
    const PackedSamples samples =
        options.samples ? *options.samples : PackedSamples::fixed(options.sampleOffsets);
    std::atomic<bool> stop{false};
    std::mutex progressMutex;
    int rowsFinished = 0;
    parallelFor(
        static_cast<size_t>(result.height),
        [&](size_t row) {
            PixelResult* pixels = result.pixels.data() + row * result.width;
            for (int x = 0; x < result.width; ++x) {
                if (x % kPixelsPerPoll == 0 && options.cancelled && !stop && options.cancelled()) stop = true;
                if (stop) return;
                pixels[x] = renderPixel(scene, tracer, camera, result.x0 + x,
                                        result.y0 + static_cast<int>(row), samples, options.aovs);
            }
            result.rowsDone[row] = 1;
            if (!options.progress) return;
            const std::lock_guard lock(progressMutex);
            options.progress(static_cast<double>(++rowsFinished) / result.height);
        },
        options.threads);
    result.complete =
        std::all_of(result.rowsDone.begin(), result.rowsDone.end(), [](uint8_t done) { return done; });
    return result;
}

}  // namespace glint::reference
