#include "reference/render.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "core/parallel.h"
#include "reference/rounding.h"
#include "reference/sampling.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// Between two looks at `cancelled`: 64 pixels take well below a tenth of a second.
constexpr int kPixelsPerPoll = 64;
constexpr size_t kRaysPerTurn = 256;  // that a thread takes at a time

PixelData dataOf(const dvec3& origin, const PixelRecord& record) {
    PixelData data;
    data.bounces = record.bounces;
    data.cost = static_cast<uint32_t>(
        std::min<uint64_t>(record.cost(), std::numeric_limits<decltype(data.cost)>::max()));
    data.pathHash = record.pathHash;
    data.shadowBits = record.shadowBits;
    if (!record.hit) return data;
    data.depth = record.hit->t;
    const glm::vec2 uv(record.hit->isTriangle() ? glm::dvec2(record.hit->u, record.hit->v)
                                                : record.surface->uv);
    data.u = uv.x;
    data.v = uv.y;
    data.position = origin + record.surface->position;
    data.normal = glm::vec3(record.surface->shadingNormal);
    data.geometricNormal = glm::vec3(record.surface->geometricNormal);
    data.clearance = static_cast<float>(clearanceOf(record.surface->error, record.surface->geometricNormal));
    data.object = record.surface->object;
    data.primitive = record.surface->primitive;
    data.material = record.surface->material;
    return data;
}

// Bounds are of the mean of the samples.
TreeLosses lossesOf(const TreeLosses& pixel, double taken) {
    TreeLosses losses;
    losses.cut.add(pixel.cut.count, pixel.cut.sum / taken);
    losses.depth.add(pixel.depth.count, pixel.depth.sum / taken);
    losses.room.add(pixel.room.count, pixel.room.sum / taken);
    losses.crowdedMedia = pixel.crowdedMedia;
    return losses;
}

// Fills a pixel, which any thread may do. Everything but colour, alpha and the losses comes from the first
// sample.
TreeLosses renderPixel(const Tracer& tracer, const rows::Camera& camera, const PackedSamples& samples, int x,
                       int y, Picture& picture) {
    const size_t index = picture.indexOf(x, y);
    dvec3 color(0);
    double alpha = 0;
    TreeLosses lost;
    std::vector<dvec3> colors;  // of an adaptive pixel
    uint32_t taken = 0;
    while (taken < samples.count()) {
        const auto [weight, ray] = pixelSample(tracer, camera, samples, taken, x, y);
        const PixelRecord record = tracer.trace(ray);
        color += weight * record.color;
        alpha += weight * record.alpha;
        lost.add(record.lost);
        if (taken == 0 && !picture.data.empty()) picture.data[index] = dataOf(tracer.model().origin, record);
        ++taken;
        if (!samples.threshold) continue;
        colors.push_back(record.color);
        if (taken % samples.round == 0 && !needsMore(colors, *samples.threshold)) break;
    }
    const double count = std::max(taken, 1u);
    const glm::dvec4 mean(color / count, alpha / count);
    for (int c = 0; c < 4; ++c) picture.color.pixels[index * 4 + c] = static_cast<float>(mean[c]);
    if (!picture.exact.empty()) picture.exact[index] = mean;
    if (!picture.samples.empty()) picture.samples[index] = taken;
    return lossesOf(lost, count);
}

// Clears a row that a cancelled render had begun.
void clearRow(Picture& picture, int y) {
    const auto first = static_cast<std::ptrdiff_t>(picture.indexOf(picture.region.x0, y));
    const std::ptrdiff_t width = picture.region.width();
    std::fill_n(picture.color.pixels.begin() + first * 4, width * 4, 0.0f);
    if (!picture.data.empty()) std::fill_n(picture.data.begin() + first, width, PixelData());
    if (!picture.exact.empty()) std::fill_n(picture.exact.begin() + first, width, glm::dvec4(0));
    if (!picture.samples.empty()) std::fill_n(picture.samples.begin() + first, width, 0u);
}

// Row after row, so that sums do not depend on the threads.
void sumUp(const std::vector<TreeLosses>& rows, Picture& picture) {
    const Region& region = picture.region;
    for (int y = region.y0; y < region.y1; ++y) {
        if (!picture.done[picture.indexOf(region.x0, y)]) {
            picture.complete = false;
            clearRow(picture, y);
            continue;
        }
        picture.losses.add(rows[static_cast<size_t>(y - region.y0)]);
        for (int x = region.x0; x < region.x1; ++x) picture.checkFinite(x, y);
    }
}

}  // namespace

Picture render(const PackedScene& scene, const Request& request, const Context& context) {
    return render(Tracer(scene, request), cameraOf(scene, request), request, context);
}

Picture render(const Tracer& tracer, const rows::Camera& camera, const Request& request,
               const Context& context) {
    Picture picture = blankPicture(request);
    const Region region = picture.region;
    if (region.width() == 0) return picture;
    std::vector<TreeLosses> rows(static_cast<size_t>(region.height()));
    std::atomic<bool> stop{false};
    std::mutex progressMutex;
    int rowsFinished = 0;
    parallelFor(context, rows.size(), [&](size_t row) {
        const int y = region.y0 + static_cast<int>(row);
        for (int x = region.x0; x < region.x1; ++x) {
            const bool poll = (x - region.x0) % kPixelsPerPoll == 0;
            if (poll && request.cancelled && !stop && request.cancelled()) stop = true;
            if (stop) return;
            rows[row].add(renderPixel(tracer, camera, request.samples, x, y, picture));
        }
        std::fill_n(picture.done.begin() + static_cast<std::ptrdiff_t>(picture.indexOf(region.x0, y)),
                    region.width(), uint8_t{1});
        if (!request.progress) return;
        const std::lock_guard lock(progressMutex);
        request.progress(static_cast<double>(++rowsFinished) / region.height());
    });
    sumUp(rows, picture);
    return picture;
}

WorldHit worldHit(const Tracer& tracer, const Ray& ray, const Hit& hit) {
    const Surface surface = tracer.surfaceAt(ray, hit);
    WorldHit found;
    found.hit = true;
    found.t = hit.t;
    found.packed = hit.primitive;
    found.u = hit.u;
    found.v = hit.v;
    found.point = tracer.model().origin + surface.position;
    found.normal = surface.geometricNormal;
    found.object = surface.object;
    found.face = surface.primitive;
    found.material = surface.material;
    return found;
}

WorldHit trace(const Tracer& tracer, const Ray& ray, HitDetail detail) {
    WorldHit found;
    uint64_t cost = 0;
    if (detail == HitDetail::Any) {
        found.hit = tracer.occluded(ray, {}, &cost);
    } else if (const std::optional<Hit> hit = tracer.closest(ray, {}, &cost)) {
        found.hit = true;
        found.t = hit->t;
        found.packed = hit->primitive;
        if (detail == HitDetail::Surface) found = worldHit(tracer, ray, *hit);
    }
    found.cost = cost;
    return found;
}

std::vector<WorldHit> trace(const PackedScene& scene, const RayBatch& batch, const Context& context) {
    return trace(Tracer(scene, {.methods = batch.methods}), batch, context);
}

std::vector<WorldHit> trace(const Tracer& tracer, const RayBatch& batch, const Context& context) {
    const glm::dvec3 origin = tracer.model().origin;
    std::vector<WorldHit> hits(batch.rays.size());
    const auto one = [&](size_t i) {
        const LocalRay local = localRay(batch.rays[i], origin);
        hits[i] = trace(tracer, {local.origin, local.direction, local.tMin, local.tMax}, batch.detail);
        if (hits[i].hit) hits[i].t = local.worldT(hits[i].t);
    };
    parallelFor(context, (hits.size() + kRaysPerTurn - 1) / kRaysPerTurn, [&](size_t turn) {
        const size_t end = std::min((turn + 1) * kRaysPerTurn, hits.size());
        for (size_t i = turn * kRaysPerTurn; i < end; ++i) one(i);
    });
    return hits;
}

}  // namespace glint::reference
