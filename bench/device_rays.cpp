#include "device_rays.h"

#include <algorithm>
#include <span>

#include "app/trace_batch.h"
#include "reference/tracer.h"
#include "render/path_state.h"

namespace glint::bench {
namespace {

render::KernelCode replace(render::KernelCode code, const Replacements& replaced) {
    const auto take = [](std::span<const uint32_t>& kernel, const std::vector<uint32_t>& other) {
        if (!other.empty()) kernel = other;
    };
    take(code[render::KernelId::Intersect], replaced.intersect);
    take(code[render::KernelId::IntersectAny], replaced.intersectAny);
    take(code[render::KernelId::PacketIntersect], replaced.packetIntersect);
    take(code[render::KernelId::PacketIntersectAny], replaced.packetIntersectAny);
    return code;
}

}  // namespace

DeviceRays::DeviceRays(const gpu::Device& device, const PackedScene& scene, render::Traversal traversal,
                       const Replacements& replaced)
    : scene_(scene),
      code_(replace(render::embeddedKernels(), replaced)),
      queries_(device, scene, traversal, code_) {}

Timing DeviceRays::trace(const std::vector<BenchRay>& rays, bool any, std::vector<BenchHit>& hits) {
    BatchTimes times;
    const std::vector<WorldHit> found = app::traceBatch(
        queries_, scene_, batchOf(rays, any ? HitDetail::Any : HitDetail::Nearest), true, &times);
    hits.assign(rays.size(), {});
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!found[i].hit) continue;
        hits[i] = {true, static_cast<float>(found[i].t), any ? 0 : idOf(found[i].packed)};
    }
    return {times.wall, times.processor};
}

std::vector<WorldHit> DeviceRays::surfaces(const std::vector<BenchRay>& rays) {
    return app::traceBatch(queries_, scene_, batchOf(rays, HitDetail::Surface), true);
}

RayBatch DeviceRays::batchOf(const std::vector<BenchRay>& rays, HitDetail detail) const {
    RayBatch batch;
    batch.detail = detail;
    for (const BenchRay& ray : rays) {
        WorldRay world = {scene_.origin + glm::dvec3(ray.origin), glm::dvec3(ray.direction), ray.tMin,
                          ray.tMax};
        if (ray.tMax < ray.tMin) world.direction = glm::dvec3(0);  // no ray
        batch.rays.push_back(world);
    }
    return batch;
}

uint32_t DeviceRays::idOf(uint32_t primitive) const {
    const uint32_t index = primitive & shared::kPrimitiveIndexMask;
    return primitive >> shared::kPrimitiveKindShift == shared::kKindSphere ? scene_.spheres[index].id
                                                                           : scene_.triangles[index].id;
}

std::vector<BenchRay> cameraRays(const PackedScene& scene, const shared::Camera& camera, int width,
                                 int height) {
    render::Slice slice;
    slice.region = {0, 0, width, height};
    slice.tileCount = render::Slice::tilesIn(slice.region);
    slice.interleave = 16;
    const reference::Tracer tracer(scene);
    std::vector<BenchRay> rays(slice.paths());
    for (uint32_t path = 0; path < slice.paths(); ++path) {
        glm::ivec2 pixel;
        if (!slice.pixelOf(path, pixel)) continue;
        const reference::Ray ray = tracer.cameraRay(camera, pixel.x + 0.5, pixel.y + 0.5);
        rays[path] = {glm::vec3(ray.origin), static_cast<float>(ray.tMin), glm::vec3(ray.direction),
                      static_cast<float>(std::min<double>(ray.tMax, shared::kInfinity))};
    }
    return rays;
}

std::vector<BenchRay> shadowRays(const std::vector<BenchRay>& rays, const std::vector<BenchHit>& hits,
                                 const shared::Light& light) {
    std::vector<BenchRay> shadows(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].hit) continue;
        const glm::vec3 point = rays[i].origin + hits[i].t * (1 - 1e-4f) * rays[i].direction;
        const bool directional = light.kind == shared::kLightDirectional;
        const glm::vec3 towards = directional ? light.position : light.position - point;
        shadows[i] = {point, 0, towards, directional ? shared::kInfinity : 1.0f};
    }
    return shadows;
}

bool hasPackets(const gpu::Device& device, const PackedScene& scene) {
    return render::runsPackets(device.info()) &&
           render::chooseTraversal(render::Traversal::Packet, device.info(), scene).packets;
}

}  // namespace glint::bench
