#include "device_rays.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace glint::bench {

using render::KernelId;
using render::RowEntry;

namespace {

// As the renderer's for llvmpipe: spreads the picture over the driver's threads.
constexpr uint32_t kInterleave = 16;

render::Slice wholePicture(int width, int height) {
    render::Slice slice;
    slice.region = {0, 0, width, height};
    slice.tileCount = render::Slice::tilesIn(slice.region);
    slice.interleave = kInterleave;
    return slice;
}

render::KernelCode replace(render::KernelCode code, const Replacements& replaced) {
    const auto take = [](std::span<const uint32_t>& kernel, const std::vector<uint32_t>& other) {
        if (!other.empty()) kernel = other;
    };
    take(code.intersect, replaced.intersect);
    take(code.intersectAny, replaced.intersectAny);
    take(code.packetIntersect, replaced.packetIntersect);
    take(code.packetIntersectAny, replaced.packetIntersectAny);
    return code;
}

uint32_t idOf(const PackedScene& scene, uint32_t primitive) {
    const uint32_t index = primitive & shared::kPrimitiveIndexMask;
    return primitive >> shared::kPrimitiveKindShift == shared::kKindSphere ? scene.spheres[index].id
                                                                           : scene.triangles[index].id;
}

}  // namespace

DeviceRays::DeviceRays(const gpu::Device& device, const PackedScene& scene, int width, int height,
                       const Replacements& replaced)
    : device_(device),
      scene_(scene),
      access_(render::chooseAccess(device.info(), render::largestArray(scene))),
      slice_(wholePicture(width, height)),
      buffers_(device, scene, access_, {.packets = true, .reason = {}}),
      paths_(device, access_, slice_.paths(), shared::kPathRows),
      counters_(device, "counters", shared::kCounterCount * sizeof(uint32_t), gpu::Access::StorageBuffer,
                gpu::MemoryKind::Host),
      code_(replace(render::embeddedKernels(access_), replaced)),
      pipelines_(device, code_, access_, scene.features, scene.methods),
      submission_(device),
      packets_(render::chooseTraversal(render::Traversal::Auto, device.info(), scene).packets) {
    pipelines_.bind(counters_, paths_.buffer(), buffers_);
}

Timing DeviceRays::run(KernelId kernel, const render::TraceModes& modes, uint32_t groups) {
    shared::Dispatch dispatch;
    dispatch.firstTile = slice_.firstTile;
    dispatch.tileCount = slice_.tileCount;
    dispatch.interleave = slice_.interleave;
    dispatch.run = slice_.run();
    dispatch.regionWidth = static_cast<uint32_t>(slice_.region.width());
    dispatch.regionHeight = static_cast<uint32_t>(slice_.region.height());
    dispatch.capacity = paths_.capacity();
    dispatch.tripBudget = render::deriveTripBudget(device_.info());
    submission_.dispatch(pipelines_.get(kernel, modes), groups,
                         std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
    const Timer timer;
    submission_.submit();
    return timer.elapsed();
}

std::vector<BenchRay> DeviceRays::cameraRays(const shared::Camera& camera) {
    buffers_.setCamera(device_, camera);
    run(KernelId::Generate, {}, slice_.groups());
    const auto origins = paths_.readRow(device_, shared::kRowOrigin, slice_.paths());
    const auto directions = paths_.readRow(device_, shared::kRowDirection, slice_.paths());
    const auto hits = paths_.readRow(device_, shared::kRowHit, slice_.paths());
    std::vector<BenchRay> rays(slice_.paths());
    for (size_t i = 0; i < rays.size(); ++i) {
        const RowEntry &o = origins[i], &d = directions[i];
        rays[i] = {{o.f[0], o.f[1], o.f[2]}, d.f[3], {d.f[0], d.f[1], d.f[2]}, hits[i].f[0]};
        if (d.f[3] == shared::kInfinity) rays[i].tMax = -1;
    }
    return rays;
}

void DeviceRays::write(const std::vector<BenchRay>& rays) {
    if (rays.size() > slice_.paths()) throw std::invalid_argument("more rays than the picture has");
    const RowEntry zero = {{0, 0, 0, 0}};
    std::vector<RowEntry> origin(slice_.paths(), zero), direction = origin, hit = origin, walk = origin;
    for (size_t i = 0; i < slice_.paths(); ++i) {
        const BenchRay ray = i < rays.size() ? rays[i] : BenchRay{};
        origin[i] = {{ray.origin.x, ray.origin.y, ray.origin.z, 0}};
        origin[i].u[3] = shared::kNone;
        direction[i] = {{ray.direction.x, ray.direction.y, ray.direction.z,
                         ray.tMax < ray.tMin ? shared::kInfinity : ray.tMin}};
        hit[i].f[0] = ray.tMax;
        hit[i].u[3] = shared::kNone;
        walk[i].u[0] = shared::kNone;
    }
    paths_.writeRow(device_, shared::kRowOrigin, origin);
    paths_.writeRow(device_, shared::kRowDirection, direction);
    paths_.writeRow(device_, shared::kRowHit, hit);
    paths_.writeRow(device_, shared::kRowWalk, walk);
}

Timing DeviceRays::trace(const std::vector<BenchRay>& rays, bool any, KernelId kernel,
                         std::vector<BenchHit>& hits) {
    write(rays);
    const uint32_t perGroup = shared::kWorkgroupSize * raysOfLane(kernel);
    const uint32_t groups = (static_cast<uint32_t>(rays.size()) + perGroup - 1) / perGroup;
    auto* const counters = static_cast<uint32_t*>(counters_.mapped());
    std::fill_n(counters, shared::kCounterCount, 0u);
    Timing timing = run(kernel, {}, groups);
    render::TraceModes resume;
    resume.resume = true;
    while (counters[shared::kCounterUnfinished] != 0) {
        counters[shared::kCounterUnfinished] = 0;
        const Timing more = run(any ? KernelId::IntersectAny : KernelId::Intersect, resume, slice_.groups());
        timing.wall += more.wall;
        timing.cpu += more.cpu;
    }
    const auto found = paths_.readRow(device_, shared::kRowHit, slice_.paths());
    hits.assign(rays.size(), {});
    for (size_t i = 0; i < rays.size(); ++i) {
        if (found[i].u[3] != shared::kNone) hits[i] = {true, found[i].f[0], idOf(scene_, found[i].u[3])};
    }
    return timing;
}

uint64_t DeviceRays::countTests(const std::vector<BenchRay>& rays, KernelId kernel) {
    write(rays);
    render::TraceModes modes;
    modes.cost = true;
    const uint32_t perGroup = shared::kWorkgroupSize * raysOfLane(kernel);
    run(kernel, modes, (static_cast<uint32_t>(rays.size()) + perGroup - 1) / perGroup);
    const auto walk = paths_.readRow(device_, shared::kRowWalk, static_cast<uint32_t>(rays.size()));
    uint64_t sum = 0;
    for (size_t i = 0; i < rays.size(); ++i) sum += rays[i].tMax > rays[i].tMin ? walk[i].u[2] : 0;
    return sum;
}

}  // namespace glint::bench
